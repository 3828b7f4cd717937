"""`wiggleroom check`."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import EXIT_CODES, Outputs, command_line, tell, write_moved
from wiggleroom.cli.running import TimeLimit
from wiggleroom.cli.sheet_options import SheetOptions

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS, _NO_SHEET = QuestionOptions(), Outputs(), TimeLimit(), SheetOptions()


def check(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    sheet: SheetOptions = _NO_SHEET,
    outputs: Outputs = _NO_OUTPUTS,
    limit: TimeLimit = _ENDLESS,
    largest_gap: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Say whether it comes apart: whether some parts can be moved without limit away from the others.

    Says which parts leave, alone or together, in which order and along which path, every step checked for overlap; or
    that they interlock, proven or searched. Fixed parts stand; where none is fixed, the largest part stands. Turning in
    place is not coming apart. Exit code: 0 interlocked, 1 comes apart, 3 unknown.

    Example: wiggleroom check puzzle.svg --gap 0.2 --picture apart.gif

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    largest_gap
        Also find the gap at which it comes apart, to 0.1 %, with a verified state on both sides; wiggleroom gap --holds
        asks that alone.
    """
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.drawing.dimension import is_spatial_file

    sheet.check(file)
    if sheet.given or is_spatial_file(file):
        from wiggleroom.cli.in_space import check_in_space

        return check_in_space(file, asked, outputs, largest_gap, limit.time, sheet)
    outputs.check(file)
    command = command_line()
    with interruptible(limit.time) as stop, unless_stopped(stop), progress() as show:
        assembly = read(file, asked, stop)

        from wiggleroom.disassembly.interlock import check as work_out
        from wiggleroom.disassembly.largest_gap import largest_gap as search

        found = work_out(assembly, stop=stop, progress=show)
        border = search(assembly, stop=stop, progress=show) if largest_gap else None
    from wiggleroom.report.results.separability import Checked, check_result, check_table

    shown = Checked(found, border)
    tell(outputs, lambda: check_result(found, border, command), lambda: check_table(found, border), shown, command)
    if outputs.moved is not None:
        from wiggleroom.report.results.separability import as_answer

        write_moved(assembly, as_answer(found).motion, outputs.moved)
    return EXIT_CODES[found.verdict]
