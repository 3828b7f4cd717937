"""`wiggleroom assemble`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

from cyclopts import Parameter

from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import Force, check_outputs, command_line, write_picture, write_result
from wiggleroom.cli.sheet_options import SheetOptions, assembled_sheet
from wiggleroom.report.pictures.file_endings import STILLS

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Group

    from wiggleroom.mating.assembled_sheet import AssembledSheet
    from wiggleroom.mating.cutting_sheet import CuttingSheet
    from wiggleroom.schema.listing_schema import AssembleResult

_NO_SHEET = SheetOptions()


def assemble(
    file: str,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    sheet: SheetOptions = _NO_SHEET,
    unit: Literal["mm", "cm", "m", "in", "px", "pt"] | None = None,
    dpi: float | None = None,
    only: Many = (),
    skip: Many = (),
    join: float | None = None,
    solid: Many = (),
    hole: Many = (),
    json: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    picture: Path | None = None,
    force: Force = False,
) -> int:
    """Assemble the parts of a flat cutting sheet: plates in space, or without --thickness a puzzle in the plane.

    Example: wiggleroom assemble box.svg --thickness 3 --picture box.png -o box.json

    Example: wiggleroom assemble puzzle.svg -o puzzle.json

    Exit code 0: every panel is placed; 3: some are not, and the file holds the others. The result is sure only if
    everything fits in one way. Without --thickness parts stay in the plane, turned and shifted until their outlines
    fit, never turned over.

    Parameters
    ----------
    file
        The sheet (.svg, .dxf, .lbrn2).
    output
        The assembly file to write (.json): plates as cut, in space.
    unit
        Unit of the drawing. Replaces the file's.
    dpi
        Units of the drawing per inch, such as 90 or 72. Replaces the file's.
    only
        Read only these layers, colours or names of a drawing: A,B. May repeat.
    skip
        Leave out these layers, colours or names: A,B. May repeat.
    join
        Join open ends nearer than this [mm]. Default: 0.2.
    solid
        Outlines inside others to read as parts, not holes: NAME, @x,y for the one around a point, or all. May repeat.
    hole
        Outlines to cut out of the parts around or under them: NAME, @x,y or all. May repeat.
    json
        Write joints, unmatched flanks and unplaced panels as JSON to this file; - is stdout, which then holds nothing else.
    picture
        The sheet with its joints coloured and named, beside the result: .svg or .png.
    force
        Overwrite files that this program did not make, or that were changed since.
    """
    import math

    from wiggleroom.cli.asking import split_words
    from wiggleroom.cli.say import note, show
    from wiggleroom.drawing.strokes.read_options import ReadOptions
    from wiggleroom.drawing.units import unit_of
    from wiggleroom.errors import InputError
    from wiggleroom.files import write_whole

    check_outputs(file, {"-o": (output, (".json",)), "--json": (json, ()), "--picture": (picture, STILLS)}, force)
    sheet.check(file, in_plane=True)
    command = command_line()
    if join is not None and not 0 <= join < math.inf:
        message = f"--join {join:g}: it must be 0 or more"
        raise InputError(message)
    options = ReadOptions(
        only=tuple(split_words(only)),
        skip=tuple(split_words(skip)),
        join=join,
        solid=tuple(split_words(solid)),
        hole=tuple(split_words(hole)),
    )
    if sheet.given:
        done = _in_space(assembled_sheet(file, sheet, unit=unit_of(unit, dpi), options=options), command)
    else:
        from wiggleroom.mating.cutting_sheet import read_sheet

        done = _in_plane(read_sheet(Path(file), unit=unit_of(unit, dpi), options=options), sheet.burn, command)
    if json is not None:
        write_result(done.record, json)
    if json != "-":
        show(done.page)
    for line in done.record.notes:
        note(line)
    if picture is not None:
        write_picture(done.picture(), picture)
    write_whole(output, done.text)
    note(f"{done.record.placed} of {done.record.panels} panels: {output}")
    return 3 if done.record.unplaced else 0


class _Done(NamedTuple):
    """What is written: the record, the page on the terminal, the picture when it is asked for, the assembly file."""

    record: AssembleResult
    page: Group
    picture: Callable[[], str]
    text: str


def _in_plane(sheet: CuttingSheet, burn: float | None, command: str) -> _Done:
    from wiggleroom.drawing.writers.assembly_writer import write_assembly
    from wiggleroom.mating.planar_assembly import assemble_plane
    from wiggleroom.report.sheets.planar_picture import planar_picture
    from wiggleroom.report.sheets.planar_record import planar_page, planar_record

    found = assemble_plane(sheet, burn=burn)
    record = planar_record(found, command=command)
    return _Done(
        record, planar_page(found), lambda: planar_picture(found, command=command), write_assembly(found.drawing())
    )


def _in_space(found: AssembledSheet, command: str) -> _Done:
    from wiggleroom.mating.plates_writer import write_plates
    from wiggleroom.report.sheets.sheet_picture import sheet_picture
    from wiggleroom.report.sheets.sheet_record import assemble_record, sheet_page

    record = assemble_record(found, command=command)
    return _Done(record, sheet_page(found), lambda: sheet_picture(found, command=command), write_plates(found))
