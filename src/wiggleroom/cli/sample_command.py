"""`wiggleroom sample`."""

from __future__ import annotations

from typing import Literal

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import Running, TimeLimit, unless_stopped

_NONE_ASKED, _NO_OUTPUTS, _HERE, _ENDLESS = QuestionOptions(), StudyOutputs(), Running(), TimeLimit()


def sample(
    file: str,
    /,
    *,
    spread: float,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: StudyOutputs = _NO_OUTPUTS,
    running: Running = _HERE,
    time: TimeLimit = _ENDLESS,
    kind: Literal["normal", "uniform", "truncated"] = "normal",
    sheet: float = 0.0,
    bias: float = 0.0,
    draws: int = 1000,
    seed: int = 0,
    limit: float | None = None,
) -> int:
    """Find the motion when the gap round every part varies at random.

    Says mean, quantiles, worst case, which parts contribute, and how many keep a limit.

    Example: wiggleroom sample puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --spread 0.02 --limit 5
        --picture draws.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    spread
        How much the gap round one part varies [mm]: standard deviation; half of the range where it is uniform.
    kind
        Distribution: normal, uniform, or truncated (normal, cut at two standard deviations).
    sheet
        Correlation of all parts, as when the kerf of a sheet drifts: 0 each by itself, 1 all alike.
    bias
        Mean of the extra gap [mm].
    draws
        Assemblies drawn at random.
    seed
        Same seed, same draws.
    limit
        Largest motion that is wanted [mm, turns in rad].
    """
    from wiggleroom.cli.in_space import read_question, refuse_page
    from wiggleroom.cli.watch import bar, interruptible
    from wiggleroom.errors import InputError

    outputs.check(file)
    refuse_page(file, outputs.picture)
    if seed < 0:
        wrong = f"--seed {seed}: it must be 0 or more"
        raise InputError(wrong)
    command = command_line()
    options = running.options()
    with interruptible(time.time) as stop, unless_stopped(stop), bar("draws") as show:
        from wiggleroom.sensitivity.gap_distribution import Spread

        distribution = Spread(spread, kind, sheet, bias)
        assembly = read_question(file, asked, stop=stop)

        from wiggleroom.gap_questions import sample as work_out

        found = work_out(
            assembly, distribution, draws=draws, seed=seed, limit=limit, stop=stop, progress=show, **options
        )
    from wiggleroom.report.results.study_results import sample_result, sample_table

    tell(
        outputs,
        lambda: sample_result(found, command),
        lambda: sample_table(found),
        found,
        command,
    )
    return 3 if len(found.value) < draws else 0
