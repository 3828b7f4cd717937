"""`wiggleroom sweep`."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import TimeLimit
from wiggleroom.cli.sheet_options import SheetOptions

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS, _NO_SHEET = QuestionOptions(), StudyOutputs(), TimeLimit(), SheetOptions()


def sweep(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    sheet: SheetOptions = _NO_SHEET,
    outputs: StudyOutputs = _NO_OUTPUTS,
    time: TimeLimit = _ENDLESS,
    gaps: str | None = None,
    prove: float | None = None,
    html: Path | None = None,
) -> int:
    """Find the motion for several gaps, and the gap from which on nothing stops it.

    Example: wiggleroom sweep puzzle.svg --gaps 0.1:1:10 --fix p1 --pull p20:+x --picture curve.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    gaps
        Gaps in mm: a list 0.1,0.2,0.5, or from, to and how many as 0.1:1:10. By default nine, from a quarter of the
        gap to twice it.
    prove
        Prove a bound at every gap: that no motion is worth more than this share above the one found; 0.01 is one per
        cent. So the curve gets a band that the truth lies in. Needs the extra prove. A gap's proof takes at most 60 seconds.
    html
        Make the page too, where the picture is to be something else: the answer at every gap, with its film: .html.
    """
    from dataclasses import replace

    from wiggleroom.cli.in_space import read_question, refuse_page
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.say import note
    from wiggleroom.cli.watch import bar, interruptible

    outputs.check(file, **{"--html": (html, (".html",))})
    refuse_page(file, outputs.picture, html)
    wanted = None if gaps is None else _gaps(gaps)
    if prove is not None:
        from wiggleroom.cli.proving import check_proof
        from wiggleroom.drawing.dimension import is_spatial_file
        from wiggleroom.errors import InputError

        if is_spatial_file(file):
            wrong = f"--prove is for drawings; {file} is an assembly in space: leave it out"
            raise InputError(wrong)
        check_proof(prove, "walls")
    command = command_line()
    with interruptible(time.time) as stop, unless_stopped(stop), bar("gaps") as show:
        from wiggleroom.gap_questions import sweep as work_out

        sheet.check(file)
        if sheet.given:
            refuse_page(file, outputs.picture, html, spatial=True)
        assembly = read_question(file, asked, sheet, stop)
        found = work_out(assembly, wanted, prove=prove, stop=stop, progress=show)
        cut = stop.is_set()
    from wiggleroom.report.results.study_results import sweep_result, sweep_table

    shown = outputs if found.steps else replace(outputs, picture=None)  # stopped before there is a curve
    tell(shown, lambda: sweep_result(found, command), lambda: sweep_table(found), found, command)
    if html is not None and any(step.answer is not None for step in found.steps):
        from wiggleroom.report.write_picture import write_picture

        write_picture(found, html, command=command)
        note(f"page: {html}")
    return 3 if cut else 0


def _gaps(text: str) -> list[float]:
    """Gaps from "0.1,0.2" or "0.1:1:10".

    >>> _gaps("0.1,0.2"), _gaps("1:2:3")
    ([0.1, 0.2], [1.0, 1.5, 2.0])
    """
    import math

    from wiggleroom.errors import InputError

    try:
        if ":" in text:
            low, high, count = text.split(":")
            first, last, many = float(low), float(high), int(count)
            if many < 2 or not (math.isfinite(first) and math.isfinite(last)):
                raise ValueError
            return [first + (last - first) * k / (many - 1) for k in range(many)]
        return [float(piece) for piece in text.split(",")]
    except ValueError:
        wrong = f"--gaps {text}: write gaps in mm as 0.1,0.2,0.5, or from, to and how many as 0.1:1:10"
        raise InputError(wrong) from None
