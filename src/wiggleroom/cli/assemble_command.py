"""`wiggleroom assemble`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import check, write_picture, write_result
from wiggleroom.report.file_endings import STILLS

if TYPE_CHECKING:
    pass


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
    """Put the plates of a flat cutting sheet together in space, by the joints that their outlines show.

    Example: wiggleroom assemble box.svg --thickness 3 --picture box.png -o box.json

    Exit code 0: every panel is placed; 3: some are not, what is placed is written all the same. Whether the result is
    sure is said: it is only where every flank meets another and no other assembly does as well.

    Parameters
    ----------
    file
        The sheet (.svg, .dxf, .lbrn2).
    output
        The assembly file to write (.json): plates as cut, in space.
    thickness
        Of the material [mm], for which joints are drawn. NAME:2.8 gives the real thickness of one panel. May repeat.
    burn
        By how much outlines are drawn larger than they come out [mm], half the width of the cut. By default what the
        sheet itself says, else 0.
    hints
        A TOML file with what is known: thickness, burn, groups, joins, plates.
    unit
        Unit of the drawing, in place of the file's.
    time
        Processor time [s] after which no wider search is begun.
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
    from wiggleroom.mating.plates_writer import write_plates
    from wiggleroom.report.sheet_picture import sheet_picture
    from wiggleroom.report.sheet_record import assemble_record, sheet_page

    check(file, {"-o": (output, (".json",)), "--json": (json, ()), "--picture": (picture, STILLS)})
    said = read_hints(hints) if hints else Hints()
    common, single = _thicknesses(thickness)
    said = replace(said, thicknesses=said.thicknesses | single)
    common = common if common is not None else said.thickness
    if common is None:
        message = f"{file}: the thickness of the material is not known; give it, such as --thickness 3"
        raise InputError(message)
    if burn is not None and burn < 0:
        message = f"--burn {burn:g}: it must be 0 mm or more"
        raise InputError(message)
    if not time > 0:
        message = f"--time {time:g}: it must be more than 0 s"
        raise InputError(message)
    command = shlex.join(["wiggleroom", *sys.argv[1:]])
    found = assemble_sheet(read_sheet(Path(file), unit=unit), common, burn=burn, hints=said, seconds=time)
    if json is not None:
        write_result(assemble_record(found, command=command), json)
    if json != "-":
        show(sheet_page(found))
    for line in found.notes:
        note(line)
    if picture is not None:
        write_picture(sheet_picture(found, command=command), picture)
    write_whole(output, write_plates(found))
    note(f"{sum(len(body.rows) for body in found.bodies)} of {len(found.plates)} panels: {output}")
    return 3 if found.unplaced else 0


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
