"""`wiggleroom convert`."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.cli.options import QuestionOptions, read, read_options
from wiggleroom.cli.outputs import Force, check_outputs

_NONE_ASKED = QuestionOptions()


def convert(
    file: str, out: Path, /, *, asked: QuestionOptions = _NONE_ASKED, kerf: float = 0.0, force: Force = False
) -> int:
    """Write a drawing as an assembly file, or ready to cut.

    Example: wiggleroom convert puzzle.svg puzzle.json --gap 0.2 --fix p1 --pull p20:+x

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).
    out
        .json: curves flattened for the gap, which the file contains, so that flex on it equals flex on the drawing.
        .svg, .dxf: the outlines as cut, gap and offsets applied. If FILE has the same format, everything else in it
        stays: page, units, places, layers, colours, engraving. Otherwise the names are in a layer of their own, labels,
        to engrave or leave out. .lbrn2, .lbrn: the same if FILE is such a LightBurn project.
    kerf
        Width of the cut [mm], for cutters that follow the lines: every outline moves outward by half of it.
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.cli.say import note
    from wiggleroom.drawing import write_drawing, write_in_place
    from wiggleroom.errors import InputError

    own = tuple(kind for kind in (".lbrn2", ".lbrn") if Path(file).suffix.lower() == kind)
    check_outputs(file, {"OUT": (out, (".json", ".svg", ".dxf", *own))}, force)
    kind = out.suffix.lower()
    if kerf and kind == ".json":
        raise InputError(
            "--kerf is for outlines that are cut, in SVG or DXF; an assembly file holds parts as they are drawn"
        )
    assembly = read(file, asked)
    if kind == ".json":
        write_drawing(assembly.drawing, out)
    else:
        from wiggleroom.assembly.kerf import compensated

        made = compensated(assembly, kerf)
        if kind == Path(file).suffix.lower():
            how = read_options(asked)
            write_in_place(
                file, out, assembly.drawing, made.parts, unit=asked.length_unit, flatten=asked.flatten, options=how
            )
        else:
            write_drawing(made, out)
    note(f"{len(assembly.parts)} parts: {out}")
    return 0
