"""`wiggleroom tighten`."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import Running, TimeLimit, unless_stopped

_NONE_ASKED, _NO_OUTPUTS, _HERE, _ENDLESS = QuestionOptions(), StudyOutputs(), Running(), TimeLimit()


def tighten(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: StudyOutputs = _NO_OUTPUTS,
    running: Running = _HERE,
    time: TimeLimit = _ENDLESS,
    parts: Annotated[int | None, Parameter(name=("--parts", "-k"))] = None,
    limit: float | None = None,
    to: float | None = None,
    draws: int = 50,
    seed: int = 0,
) -> int:
    """Say which parts to make tighter for the least motion, or the fewest that keep it below a limit.

    Example: wiggleroom tighten frame.json --parts 11 --picture tighter.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    parts
        How many parts to choose.
    limit
        Or: choose as few as keep the motion below this [mm, turns in rad].
    to
        Gap that a tightened part aims at [mm]: it is made larger until its own half of the gap is half of this. By
        default a tenth of the gap. Joints with a larger gap of their own keep what theirs is more.
    draws
        Choices at random to compare with.
    seed
        Same seed, same choices at random.
    """
    from wiggleroom.cli.in_space import read_question
    from wiggleroom.cli.watch import bar, interruptible
    from wiggleroom.errors import InputError

    outputs.check(file)
    if draws < 0 or seed < 0:
        wrong = f"--draws {draws} --seed {seed}: both must be 0 or more"
        raise InputError(wrong)
    command = command_line()
    options = running.options()
    with interruptible(time.time) as stop, unless_stopped(stop), bar("choices at random") as show:
        assembly = read_question(file, asked, stop=stop)

        from wiggleroom.gap_questions import tighten as work_out

        found = work_out(
            assembly, parts=parts, limit=limit, gap=to, draws=draws, seed=seed, stop=stop, progress=show, **options
        )
        cut = stop.is_set()
    from wiggleroom.report.results.study_results import tighten_result, tighten_table

    tell(
        outputs,
        lambda: tighten_result(found, command),
        lambda: tighten_table(found),
        found,
        command,
    )
    return 0 if found.reached and not cut else 3
