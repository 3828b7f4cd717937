"""A cutting sheet to begin with: the five panels of an open box with finger joints, side by side."""

from __future__ import annotations

import numpy as np
import shapely

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region

SIZE = (90.0, 60.0, 45.0)
"""Width, depth and height of the box [mm]."""
THICKNESS = 3.0
"""Of its panels, which the page asks for first [mm]."""
FINGERS = 5
"""Fingers and notches along an edge; odd, so that both ends are alike."""
APART = 8.0
"""Between two panels on the sheet [mm]."""

Sides = dict[str, str]
"""Which stretches a panel gives to its neighbours, by side: the "odd" ones, the "even" ones, or "none"."""


def panels() -> dict[str, shapely.Polygon]:
    """Outline of each panel, its lower left corner at the origin.

    Stretches of an edge count from 0: the floor keeps the odd ones of its edges, so its corners belong to walls; front and back keep
    the even ones of the upright edges.

    Examples
    --------
    >>> [round(panel.area) for panel in panels().values()]
    [4896, 3834, 3834, 2466, 2466]
    """
    wide, deep, high = SIZE
    floor = _panel(wide, deep, dict.fromkeys(("bottom", "top", "left", "right"), "even"))
    wall = _panel(wide, high, {"bottom": "odd", "left": "odd", "right": "odd"})
    end = _panel(deep, high, {"bottom": "odd", "left": "even", "right": "even"})
    return {"floor": floor, "front": wall, "back": wall, "left": end, "right": end}


def _panel(wide: float, tall: float, given: Sides) -> shapely.Polygon:
    """Rectangle without the stretches of its edges that are given to neighbours."""
    cut = []
    for side, which in given.items():
        steps = np.linspace(0.0, wide if side in ("bottom", "top") else tall, FINGERS + 1)
        for k in range(1 if which == "odd" else 0, FINGERS, 2):
            low, up = steps[k], steps[k + 1]
            at = {"bottom": 0.0, "left": 0.0, "top": tall - THICKNESS, "right": wide - THICKNESS}[side]
            along_x = side in ("bottom", "top")
            cut.append(
                shapely.box(low, at, up, at + THICKNESS) if along_x else shapely.box(at, low, at + THICKNESS, up)
            )
    return shapely.box(0, 0, wide, tall) - shapely.union_all(cut)


def sheet() -> Assembly:
    """The panels as they are cut, in two rows."""
    parts, x, y, row = [], 0.0, 0.0, 0.0
    for name, outline in panels().items():
        if x and x + outline.bounds[2] > 2.2 * SIZE[0]:
            x, y, row = 0.0, y + row + APART, 0.0
        region = Region(shapely.get_coordinates(shapely.normalize(outline).reverse().exterior)[:-1], ())
        parts.append(Part(name, (region,), (x, y, 0.0)))
        x, row = x + outline.bounds[2] + APART, max(row, outline.bounds[3])
    return assemble(Drawing(tuple(parts)))
