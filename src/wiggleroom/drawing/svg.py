"""Read an SVG drawing: closed outlines become parts [mm], y points up."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.drawing.limits import check_options
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.parts import drawing_of
from wiggleroom.drawing.source import load
from wiggleroom.drawing.svg_page import page_map
from wiggleroom.drawing.svg_walk import Walk
from wiggleroom.drawing.xmltree import parse_xml
from wiggleroom.errors import InputError


def read_svg(
    source: str | Path, *, unit: str | None = None, flatten: float | None = None, gap: float | None = None
) -> Drawing:
    """Parts of an SVG drawing.

    Parameters
    ----------
    source : str or Path
        Path of the file, or its text.
    unit : str, optional
        What one user unit is (mm, cm, m, in, px), whatever the file says.
    flatten : float [mm], optional
        Chord error of curves; by default gap / 50, or 1e-4 of the median part size where the gap is 0.
    gap : float [mm], optional
        Clearance across every joint; a drawing itself has none.

    Raises
    ------
    InputError
        With one line per finding.

    Examples
    --------
    >>> drawing = read_svg('<svg width="9mm" viewBox="0 0 9 9"><rect id="a" width="4" height="2"/></svg>')
    >>> drawing.parts[0].name, drawing.parts[0].at
    ('a', (2.0, 8.0, 0.0))
    """
    check_options(flatten=flatten, gap=gap)
    text = load(source, opening="<", name="drawing")
    root = parse_xml(text)
    if root.tag != "svg":
        message = f"{text.name}: is not an SVG drawing; its outermost element must be svg"
        raise InputError(message)
    matrix, port, notes = page_map(root, unit, text.name)
    walk = Walk(text.name, root)
    walk.run(matrix, port)
    return drawing_of(
        text.name, walk.shapes, walk.findings, notes=notes, left_out=walk.left_out, flatten=flatten, gap=gap
    )
