"""`wiggleroom assemble`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from cyclopts import Parameter

from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import check, write_picture, write_result
from wiggleroom.report.file_endings import STILLS

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Group

    from wiggleroom.mating.assembled_sheet import AssembledSheet
    from wiggleroom.mating.cutting_sheet import CuttingSheet


def assemble(
    file: str,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    thickness: Many = (),
    burn: float | None = None,
    hints: Path | None = None,
    unit: Literal["mm", "cm", "m", "in", "px"] | None = None,
    time: float = 60.0,
    json: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    picture: Path | None = None,
) -> int:
    """Put the parts of a flat cutting sheet together: plates in space, or without --thickness a puzzle in the plane.

    Examples: wiggleroom assemble box.svg --thickness 3 --picture box.png -o box.json
    wiggleroom assemble puzzle.svg -o puzzle.json

    Exit code 0: every panel is placed; 3: some are not, what is placed is written all the same. Whether the result is
    sure is said: it is only where everything fits and nothing else does as well.

    Parameters
    ----------
    file
        The sheet (.svg, .dxf, .lbrn2).
    output
        The assembly file to write (.json): plates as cut, in space.
    thickness
        Of the material [mm], for which joints are drawn. NAME:2.8 gives the real thickness of one panel. May repeat.
        Without it parts stay in the plane and are put where their outlines fit, turned and shifted, never turned over.
    burn
        By how much outlines are drawn larger than they come out [mm], half the width of the cut. By default what the
        sheet itself says, else 0.
    hints
        A TOML file with what is known of plates in space: thickness, burn, groups, joins, plates.
    unit
        Unit of the drawing, in place of the file's.
    time
        Processor time [s] after which no wider search for plates is begun.
    json
        Write joints, unmatched flanks and unplaced panels as JSON to this file; - is stdout, which then holds nothing else.
    picture
        The sheet with its joints coloured and named, beside the result: .svg or .png.
    """
    import shlex
    from dataclasses import replace

    from wiggleroom.cli.say import note, show
    from wiggleroom.errors import InputError
    from wiggleroom.files import write_whole
    from wiggleroom.mating.assembled_sheet import assemble_sheet
    from wiggleroom.mating.cutting_sheet import read_sheet
    from wiggleroom.mating.hints import Hints, read_hints

    check(file, {"-o": (output, (".json",)), "--json": (json, ()), "--picture": (picture, STILLS)})
    said = read_hints(hints) if hints else Hints()
    common, single = _thicknesses(thickness)
    said = replace(said, thicknesses=said.thicknesses | single)
    common = common if common is not None else said.thickness
    if common is None and (hints or single):
        message = f"{file}: the thickness of the material is not known; give it, such as --thickness 3"
        raise InputError(message)
    if burn is not None and burn < 0:
        message = f"--burn {burn:g}: it must be 0 mm or more"
        raise InputError(message)
    if not time > 0:
        message = f"--time {time:g}: it must be more than 0 s"
        raise InputError(message)
    command = shlex.join(["wiggleroom", *sys.argv[1:]])
    sheet = read_sheet(Path(file), unit=unit)
    if common is None:
        done = _in_plane(sheet, burn, command)
    else:
        done = _in_space(assemble_sheet(sheet, common, burn=burn, hints=said, seconds=time), command)
    if json is not None:
        write_result(done.record, json)
    if json != "-":
        show(done.page)
    for line in done.record["notes"]:
        note(line)
    if picture is not None:
        write_picture(done.picture(), picture)
    write_whole(output, done.text)
    note(f"{done.record['placed']} of {done.record['panels']} panels: {output}")
    return 3 if done.record["unplaced"] else 0


class _Done(NamedTuple):
    """What is written: the record, the page on the terminal, the picture when it is asked for, the assembly file."""

    record: dict[str, Any]
    page: Group
    picture: Callable[[], str]
    text: str


def _in_plane(sheet: CuttingSheet, burn: float | None, command: str) -> _Done:
    from wiggleroom.drawing.assembly_writer import write_assembly
    from wiggleroom.mating.planar_assembly import assemble_plane
    from wiggleroom.report.planar_picture import planar_picture
    from wiggleroom.report.planar_record import planar_page, planar_record

    found = assemble_plane(sheet, burn=burn)
    record = planar_record(found, command=command)
    return _Done(
        record, planar_page(found), lambda: planar_picture(found, command=command), write_assembly(found.drawing())
    )


def _in_space(found: AssembledSheet, command: str) -> _Done:
    from wiggleroom.mating.plates_writer import write_plates
    from wiggleroom.report.sheet_picture import sheet_picture
    from wiggleroom.report.sheet_record import assemble_record, sheet_page

    record = assemble_record(found, command=command)
    return _Done(record, sheet_page(found), lambda: sheet_picture(found, command=command), write_plates(found))


def _thicknesses(said: tuple[str, ...]) -> tuple[float | None, dict[str, float]]:
    """Thickness of the material and of single panels [mm]."""
    from wiggleroom.errors import InputError

    common, single = None, {}
    for text in said:
        name, _, number = text.rpartition(":")
        try:
            size = float(number)
        except ValueError:
            size = 0.0
        if not 0 < size < 1e6:
            message = f"--thickness {text}: it must be a length in mm larger than 0, or NAME:2.8"
            raise InputError(message)
        if name:
            single[name] = size
        else:
            common = size
    return common, single
