"""`wiggleroom tolerances`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import TimeLimit, require_question

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS = QuestionOptions(), StudyOutputs(), TimeLimit()


def tolerances(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: StudyOutputs = _NO_OUTPUTS,
    time: TimeLimit = _ENDLESS,
    tolerances: Path | None = None,
    limit: float | None = None,
) -> int:
    """Find the worst and the best case within tolerances, and what each of them contributes.

    A tolerance says how far the outlines of a part, one outline, or the gap of a joint may lie from where it should. The
    worst case is where everything is as loose as allowed, and is solved there; --csv lists who contributes how much.

    Example: wiggleroom tolerances box.svg --gap 0.2 --fix box --pull lid:+x --tolerances sheet.csv --limit 0.5
        --csv contributors.csv

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), which may hold tolerances of its own.
    tolerances
        Table with the columns part, other, outline, nominal, plus, minus [mm]: .csv. In place of the file's.
    limit
        Largest motion that is wanted [mm, turns in rad].
    """
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible, progress

    outputs.check(file)
    command = command_line()
    with interruptible(time.time) as stop, unless_stopped(stop), progress() as show:
        assembly = require_question(read(file, asked, stop))
        if tolerances is not None:
            from wiggleroom.drawing.readers.tolerances import read_tolerances

            table = read_tolerances(tolerances)
            assembly = replace(assembly, drawing=replace(assembly.drawing, tolerances=table))

        from wiggleroom.sensitivity.worst_case import worst_case

        found = worst_case(assembly, limit=limit, stop=stop, progress=show)
    from wiggleroom.report.results.tolerance_results import tolerances_result, tolerances_table

    tell(outputs, lambda: tolerances_result(found, command), lambda: tolerances_table(found), found, command)
    return 3 if found.stopped else 0
