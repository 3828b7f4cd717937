"""Write a cut-ready SVG in millimetres."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, floor, log10, sin
from xml.sax.saxutils import quoteattr

import numpy as np

from wiggleroom.drawing.model import Drawing, Part, Points, Region
from wiggleroom.drawing.strokes.layers import is_engraved
from wiggleroom.drawing.writers.glue_groups import glued_names
from wiggleroom.drawing.writers.lettering import Label, labels_of, lettered


def write_svg(drawing: Drawing | Sequence[Part], labels: Sequence[Label] | None = None) -> str:
    """Text of an SVG with one path a part, which reads back as the same drawing.

    Names stand in a layer `labels` of their own, as strokes, to be engraved or left out.

    The page begins at the origin and is as large as the parts need; a drawing that reaches below zero is moved so that
    nothing lies off the page.

    Parameters
    ----------
    drawing : Drawing or sequence of Part
        Only a drawing carries glue.
    labels : sequence of Label, optional
        What is engraved; by default every part's name.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> part = Part("a", (Region(np.array([[0.0, 0], [2, 0], [2, 1]])),), fixed=True)
    >>> print(write_svg([part], labels=()))
    <svg xmlns="http://www.w3.org/2000/svg" width="2mm" height="1mm" viewBox="0 0 2 1">
    <g fill="none" stroke="black" stroke-width="0.004" fill-rule="evenodd">
    <path id="a" fill="red" d="M0 1L2 1L2 0z"/>
    </g>
    </svg>
    <BLANKLINE>
    """
    parts = drawing.parts if isinstance(drawing, Drawing) else tuple(drawing)
    placed = {part.name: [ring for region in part.regions for ring in placed_rings(part, region)] for part in parts}
    corners = np.vstack([ring for rings in placed.values() for ring in rings])
    shift = np.maximum(0.0, -corners.min(axis=0))
    width, height = corners.max(axis=0) + shift
    lines = {part.name: _path(part, [ring + shift for ring in placed[part.name]], height) for part in parts}
    names = [
        _label(label, shift, height) for label in (labels_of(parts) if labels is None else labels) if label.text.strip()
    ]
    groups = glued_names(drawing.glue if isinstance(drawing, Drawing) else ())
    body: list[str] = []
    for name in list(lines):
        group = next((members for members in groups if name in members), [name])
        if name in lines and len(group) > 1:
            members = [lines.pop(member) for member in group]
            body += [f'<g id="glue-{groups.index(group) + 1}">', *members, "</g>"]
        elif name in lines:
            body.append(lines.pop(name))
    size = f'width="{_number(width)}mm" height="{_number(height)}mm" viewBox="0 0 {_number(width)} {_number(height)}"'
    line = f'stroke-width="{_stroke(width, height)}"'
    style = f'fill="none" stroke="black" {line} fill-rule="evenodd"'
    inkscape = ' xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"' if names else ""
    head = f'<svg xmlns="http://www.w3.org/2000/svg"{inkscape} {size}>\n<g {style}>'
    if names:
        layer = f'<g inkscape:groupmode="layer" inkscape:label="labels" fill="none" stroke="blue" {line}>'
        names = [layer, *names, "</g>"]
    return "\n".join([head, *body, "</g>", *names, "</svg>", ""])


def placed_rings(part: Part, region: Region) -> list[Points]:
    """Outer outline and holes of one piece of a part, where it lies (n, 2) [mm]."""
    x, y, angle = part.at
    turn = np.array([[cos(angle), sin(angle)], [-sin(angle), cos(angle)]])
    return [ring @ turn + (x, y) for ring in (region.outer, *region.holes)]


def _label(label: Label, shift: Points, bottom: float) -> str:
    """Strokes of a label, to a ten-thousandth of its height."""
    digits = max(0, 4 - floor(log10(label.height))) if label.height > 0 else 4
    strokes = [np.round(stroke + shift, digits) for stroke in lettered(label)]
    data = "".join(_data(stroke, round(bottom, digits)).rstrip("z") for stroke in strokes)
    return f'<path d="{data}"/>'


def _path(part: Part, rings: list[Points], bottom: float) -> str:
    colour = ' fill="red"' if part.fixed else ""
    colour += f' data-pieces="{len(part.regions)}"' if len(part.regions) > 1 or is_engraved(part.name) else ""
    data = "".join(_data(ring, bottom) for ring in rings)
    return f'<path id={quoteattr(part.name)}{colour} d="{data}"/>'


def _data(ring: Points, bottom: float) -> str:
    return "M" + "L".join(f"{_number(x)} {_number(bottom - y)}" for x, y in ring.tolist()) + "z"


def _number(value: float) -> str:
    """Nine decimals, no trailing zeros, no minus before a zero."""
    return f"{round(value, 9) + 0.0:.9f}".rstrip("0").rstrip(".")


def _stroke(width: float, height: float) -> str:
    """Thin on a page of any size."""
    return f"{min(0.1, max(width, height) / 500):.3g}"
