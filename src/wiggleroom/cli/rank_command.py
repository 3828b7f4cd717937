"""`wiggleroom rank`."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import Parameter

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import Running, TimeLimit, unless_stopped

_NONE_ASKED, _NO_OUTPUTS, _HERE, _ENDLESS = QuestionOptions(), StudyOutputs(), Running(), TimeLimit()


def rank(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: StudyOutputs = _NO_OUTPUTS,
    running: Running = _HERE,
    time: TimeLimit = _ENDLESS,
    by: Literal["duals", "differences"] = "duals",
    exact: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Say which parts' gaps, and which joints', matter most for the motion.

    Importance is mm of motion for each mm of extra gap round one part: its outline alone moves inward by half of it.

    Example: wiggleroom rank puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture blame.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    by
        duals: all parts from the forces of one solve. differences: solved again for every part, as a check.
    exact
        Solve again for the parts whose importance the forces leave open.
    """
    from wiggleroom.cli.in_space import read_question
    from wiggleroom.cli.watch import bar, interruptible

    outputs.check(file)
    command = command_line()
    options = running.options()
    with interruptible(time.time) as stop, unless_stopped(stop), bar("differences") as show:
        assembly = read_question(file, asked, stop=stop)

        from wiggleroom.gap_questions import rank as work_out

        ranking = work_out(assembly, by=by, exact=exact, stop=stop, progress=show, **options)
    from wiggleroom.report.results.rank_results import rank_result, rank_table

    tell(
        outputs,
        lambda: rank_result(ranking, command),
        lambda: rank_table(ranking),
        ranking,
        command,
    )
    return 0
