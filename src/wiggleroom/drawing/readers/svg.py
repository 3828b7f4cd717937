"""Read an SVG drawing: closed outlines become parts [mm], y points up."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.drawing.limits import check_options
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.outlines.file_reading import sound
from wiggleroom.drawing.outlines.parts import reading_of
from wiggleroom.drawing.readers.source import Source, load
from wiggleroom.drawing.readers.svg_page import page_map
from wiggleroom.drawing.readers.svg_walk import SvgWalk
from wiggleroom.drawing.readers.xmltree import parse_xml
from wiggleroom.drawing.strokes.elements import Artwork
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError, Stop

_BOXES = "Created with Boxes.py"


def svg_artwork(source: str | Path, unit: str | None = None, stop: Stop | None = None) -> Artwork:
    """Strokes and texts of an SVG drawing.

    Parameters
    ----------
    source : str or Path
        Path of the file, or its text.
    unit : str, optional
        What one user unit is (mm, cm, m, in, px, pt, or units an inch as "90dpi"), whatever the file says.
    stop : optional
        Asked before every element.

    Raises
    ------
    InputError
        If the text is no SVG.
    """
    return walked_svg(load(source, opening="<", name="drawing"), unit, stop)[1]


def walked_svg(text: Source, unit: str | None = None, stop: Stop | None = None) -> tuple[SvgWalk, Artwork]:
    """The same with where in the text every stroke comes from; see `svg_artwork`."""
    root = parse_xml(text)
    if root.tag != "svg":
        message = f"{text.name}: is not an SVG drawing; its outermost element must be svg"
        raise InputError(message)
    matrix, port, notes = page_map(root, unit, text.name, text.text)
    walk = SvgWalk(text.name, root, stop)
    walk.run(matrix, port)
    if walk.repeated:
        named = ", ".join(walk.repeated[:3]) + (", ..." if len(walk.repeated) > 3 else "")
        notes = (*notes, f"{text.name}: ids that are used more than once: {named}; parts are told apart by a number")
    if walk.clipped:
        notes = (*notes, f"{text.name}: {walk.clipped} elements are clipped (clip-path or mask); they are read whole")
    if walk.not_followed:
        named = ", ".join(dict.fromkeys(walk.not_followed))
        notes = (
            *notes,
            f"{text.name}: style rules are followed where they name elements, classes and ids alone, not: {named}",
        )
    low = matrix.point(complex(port.x, port.y + port.height))
    view = (low.real, low.imag, matrix.a * port.width, -matrix.d * port.height)
    artwork = Artwork(
        file=text.name,
        strokes=tuple(walk.strokes),
        texts=tuple(walk.texts),
        notes=notes,
        findings=tuple(walk.findings),
        left_out=tuple(walk.left_out.items()),
        view=view if min(view[2:]) > 0 else None,
        program="boxes.py" if _BOXES in text.text else "",
    )
    return walk, artwork


def read_svg(
    source: str | Path,
    *,
    unit: str | None = None,
    flatten: float | None = None,
    gap: float | None = None,
    options: ReadOptions | None = None,
) -> Drawing:
    """Parts of an SVG drawing.

    Parameters
    ----------
    source : str or Path
        Path of the file, or its text.
    unit : str, optional
        What one user unit is (mm, cm, m, in, px, pt, or units an inch as "90dpi"), whatever the file says.
    flatten : float [mm], optional
        Chord error of curves at every gap; by default `chord_error` of the gap.
    gap : float [mm], optional
        Clearance across every joint; a drawing itself has none.
    options : ReadOptions, optional

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
    options = options or ReadOptions()
    return sound(reading_of(svg_artwork(source, unit, options.stop), options, flatten=flatten, gap=gap))
