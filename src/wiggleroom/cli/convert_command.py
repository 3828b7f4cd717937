"""`wiggleroom convert`."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import Force, check_outputs

_NONE_ASKED = QuestionOptions()


def convert(file: str, out: Path, /, *, asked: QuestionOptions = _NONE_ASKED, force: Force = False) -> int:
    """Write a drawing as an assembly file, or ready to cut.

    Example: wiggleroom convert puzzle.svg puzzle.json --gap 0.2 --fix p1 --pull p20:+x

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).
    out
        .json: curves flattened for the gap, which the file carries, so that flex on it equals flex on the drawing.
        .svg, .dxf: the outlines as they are cut, gap and offsets applied, and the names in a layer of their own,
        labels, to engrave or leave out.
    force
        Write over a file that was not made by this program, or was changed since.
    """
    from wiggleroom.cli.say import note
    from wiggleroom.drawing import write_drawing

    check_outputs(file, {"OUT": (out, (".json", ".svg", ".dxf"))}, force)
    assembly = read(file, asked)
    drawing = assembly.drawing if out.suffix.lower() == ".json" else assembly.as_cut()
    write_drawing(drawing, out)
    note(f"{len(drawing.parts)} parts: {out}")
    return 0
