"""How long a user unit is to the program that wrote an SVG, where the file has no physical size."""

from __future__ import annotations

import re
from typing import NamedTuple

from wiggleroom.drawing.readers.xmltree import Element
from wiggleroom.drawing.strokes.transforms import Box

_PAPER = {
    "A0": (841.0, 1189.0), "A1": (594.0, 841.0), "A2": (420.0, 594.0), "A3": (297.0, 420.0), "A4": (210.0, 297.0),
    "Letter": (215.9, 279.4), "Legal": (215.9, 355.6), "Tabloid": (279.4, 431.8),
}  # fmt: skip
"""Sizes of paper [mm]."""
_RESOLUTIONS = (72, 90, 96, 300)
"""Units an inch in which programs write."""
_ROUNDING = 0.6
"""A page that misses a size of paper by no more than this [unit] is that paper."""
_OLD_INKSCAPE = (0, 92)
"""From this version on a pixel of Inkscape is 1/96 inch, before it was 1/90."""
_COREL = 0.01
"""User unit of CorelDRAW [mm]."""


class SvgProgram(NamedTuple):
    """How long a unit is to the program that wrote a file.

    Parameters
    ----------
    unit : float [mm]
    said : str
        The same in words.
    of_page : bool
        Whether it is the unit of the page's width and height, else that of the viewBox.
    """

    unit: float
    said: str
    of_page: bool = False


def program_of(root: Element, text: str, box: Box) -> SvgProgram | None:
    """What is known of the unit of an SVG by its program, or by the paper that its page is.

    Parameters
    ----------
    root : Element
        The outermost svg element.
    text : str
        The whole file, with its comments.
    box : Box
        The page in user units.

    Examples
    --------
    >>> program_of(Element("svg", {"inkscape:version": "0.48.1 r9760"}, 1), "", Box(0, 0, 9, 9)).said
    'written by Inkscape 0.48, whose pixel is 1/90 inch'
    >>> program_of(Element("svg", {}, 1), "", Box(0, 0, 595.28, 841.89)).said
    'a page of 595.28 x 841.89 units is A4 paper at 72 units an inch'
    """
    head = text[:4000]
    version = re.match(r"\s*(\d+)\.(\d+)", root.attributes.get("inkscape:version", ""))
    if version:
        number = (int(version.group(1)), int(version.group(2)))
        return _inches(90 if number < _OLD_INKSCAPE else 96, f"Inkscape {number[0]}.{number[1]}", "pixel")
    if "inkscape:version" not in root.attributes and "sodipodi:version" in root.attributes:
        return _inches(90, "Sodipodi", "pixel")
    if "Adobe Illustrator" in head or _is_illustrator_export(root, head):
        return _inches(72, "Adobe Illustrator", "unit")
    if "OpenSCAD" in head:
        return SvgProgram(1.0, "written by OpenSCAD, whose unit is the millimetre")
    if re.search(r"Creator:\s*Corel", head) or "xmlns:xodm" in root.attributes:
        return _corel(box)
    return _paper(box)


def _inches(count: int, name: str, what: str) -> SvgProgram:
    return SvgProgram(25.4 / count, f"written by {name}, whose {what} is 1/{count} inch", of_page=True)


def _is_illustrator_export(root: Element, head: str) -> bool:
    """Whether Illustrator wrote this for a screen: without a comment, but with its layers and classes."""
    return "data-name" in root.attributes or (
        re.fullmatch(r"(?:Layer|Ebene|Calque|Capa|Livello|Camada|Laag|Warstwa)_\d+", root.attributes.get("id", ""))
        is not None
        and (".cls-1" in head or ".st0" in head)
    )


def _corel(box: Box) -> SvgProgram:
    """Hundredths of a millimetre; thousandths of an inch where the page is then a paper of inches."""
    inches = sorted((box.width / 1000, box.height / 1000))
    if inches in ([8.5, 11.0], [8.5, 14.0], [11.0, 17.0]):
        return SvgProgram(0.0254, "written by CorelDRAW in thousandths of an inch")
    return SvgProgram(_COREL, "written by CorelDRAW, whose unit is 1/100 mm")


def _paper(box: Box) -> SvgProgram | None:
    for name, size in _PAPER.items():
        for count in _RESOLUTIONS:
            page = sorted((box.width, box.height))
            if all(abs(a - b / 25.4 * count) <= _ROUNDING for a, b in zip(page, size, strict=True)):
                said = f"a page of {box.width:g} x {box.height:g} units is {name} paper at {count} units an inch"
                return SvgProgram(25.4 / count, said)
    return None
