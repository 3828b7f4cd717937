"""`wiggleroom draw` and `wiggleroom parts`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions, inspect_file
from wiggleroom.cli.outputs import Force, Text, check_outputs, command_line, write_picture, write_result
from wiggleroom.report.pictures.file_endings import STILLS

if TYPE_CHECKING:
    from rich.table import Table

    from wiggleroom.assembly.inventory import InventoryRow

_NONE_ASKED = QuestionOptions()


def draw(file: str, out: Path, /, *, asked: QuestionOptions = _NONE_ASKED, force: Force = False) -> int:
    """Draw a file as it is read: parts at rest, gap applied, with faults, omissions and assumptions.

    Files with faults are drawn too: open ends, crossings and overlaps are marked, and a table lists the parts.

    Example: wiggleroom draw puzzle.svg parts.png --gap 0.2

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2), an assembly file (.json), also one in space, or a voxel puzzle (.puz, .xmpuzzle).
    out
        The picture: .svg or .png; in space also .glb.
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.assembly.inventory import size_lines
    from wiggleroom.cli.in_space import read_in_space
    from wiggleroom.cli.say import note, show
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.report.pictures.read_picture import picture_of_reading

    if is_spatial_file(file):
        from wiggleroom.report.solids.spatial_listing import draw_spatial_parts, drawn_parts, spatial_parts_table

        check_outputs(file, {"OUT": (out, (*STILLS, ".glb"))}, force)
        assembly = read_in_space(file, asked)
        draw_spatial_parts(assembly, out)
        note(f"picture: {out}")
        show(spatial_parts_table(drawn_parts(assembly.drawing)))
        return 0
    check_outputs(file, {"OUT": (out, STILLS)}, force)
    command = command_line()
    seen = inspect_file(file, asked)
    for line in (*size_lines(seen.assembly.drawing), *seen.assembly.drawing.notes, *seen.findings):
        note(line)
    write_picture(picture_of_reading(seen.assembly, seen.rows, seen.remarks, seen.findings, command=command), out)
    show(_table(seen.rows))
    return 0


def parts(file: str, /, *, asked: QuestionOptions = _NONE_ASKED, json: Text = None, force: Force = False) -> int:
    """List the parts of a file: name, size, place, holes and layer; of a mesh file the bodies, with volumes.

    Example: wiggleroom parts puzzle.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2), an assembly file (.json) of the plane or of space, or a mesh (.stl, .obj, .ply, .glb,
        .3mf, .step).
    json
        Write the list as JSON to this file; - is stdout, which then holds nothing else.
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.assembly.inventory import size_lines, size_of
    from wiggleroom.cli.in_space import draw_in_space
    from wiggleroom.cli.say import note, show
    from wiggleroom.drawing.dimension import is_mesh_file, is_spatial_file
    from wiggleroom.report.results.listing import parts_result

    check_outputs(file, {"--json": (json, ())}, force)
    if is_mesh_file(file) or is_spatial_file(file):
        from wiggleroom.report.solids.spatial_listing import (
            drawn_bodies,
            drawn_parts,
            spatial_parts_result,
            spatial_parts_table,
        )

        if is_mesh_file(file):
            entries, notes = drawn_bodies(Path(file), asked.unit)
            for line in notes:
                note(line)
        else:
            drawing = draw_in_space(file, asked)
            entries, notes = drawn_parts(drawing), list(drawing.notes)
        if json is not None:
            write_result(spatial_parts_result(entries, notes, command_line()), json)
        if json != "-":
            show(spatial_parts_table(entries))
        return 0
    seen = inspect_file(file, asked)
    for line in (*size_lines(seen.assembly.drawing), *seen.assembly.drawing.notes, *seen.findings):
        note(line)
    if json is not None:
        command = command_line()
        write_result(
            parts_result(
                seen.rows, seen.assembly.drawing.notes, seen.findings, command, size=size_of(seen.assembly.drawing)
            ),
            json,
        )
    if json != "-":
        show(_table(seen.rows))
    return 2 if seen.findings else 0


def _table(rows: tuple[InventoryRow, ...]) -> Table:
    """Parts as a plain table."""
    from wiggleroom.report.results.table import columns

    found = columns("part", "width mm", "height mm", "x mm", "y mm", "holes", words="layer")
    for row in rows:
        numbers = (f"{value:.2f}" for value in (row.width, row.height, row.x, row.y))
        found.add_row(row.name + (" (fixed)" if row.fixed else ""), *numbers, str(row.holes), row.layer)
    return found
