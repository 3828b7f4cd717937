"""What looks odd about a drawing though nothing is wrong: a gap too large, a wrong unit, a sheet that is not an assembly."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.loops import placed_loops, polygons
from wiggleroom.drawing.model import Drawing, Pull

OUTSIDE = 0.1
"""A part pulled at a point further outside of it than this share of its size may be meant to be pulled elsewhere."""
LARGE_GAP = 0.1
"""A gap above this share of the smallest part is doubted."""
WIDE, NARROW = 5000.0, 1.0
"""A drawing wider or narrower than this [mm] is doubted."""
FAR = 0.02
"""A part is alone where the next one is further than this share of its own size, and than four gaps."""


def doubts(drawing: Drawing, *, drawn: bool = True) -> tuple[str, ...]:
    """One line for each number that looks as if something else was meant.

    Parameters
    ----------
    drawing : Drawing [mm]
        Sound, as from an assembly.
    drawn : bool
        False: outlines come from numbers that are meant; only the gap and points of pulls are doubted.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]]))
    >>> two = tuple(Part(name, (square,), at=(x, 0.0, 0.0)) for name, x in (("a", 0.0), ("b", 25.0)))
    >>> print(*doubts(Drawing(two, gap=4.0)), sep="; ")
    the gap of 4 mm is large beside part "a", 20 mm wide: is it in mm?
    >>> print(*doubts(Drawing(two)), sep="; ")
    these look like parts on a cutting sheet: 2 of 2 touch nothing; wiggleroom assemble puts a sheet's parts together
    """
    loops, region, owner = placed_loops(drawing.parts)
    low = np.full((len(drawing.parts), 2), np.inf)
    high = -low
    np.minimum.at(low, owner[region], np.minimum.reduceat(loops.points, loops.starts))
    np.maximum.at(high, owner[region], np.maximum.reduceat(loops.points, loops.starts))
    sizes = (high - low).min(axis=1)
    if not drawn:
        return (*_gap_doubts(drawing, sizes), *_point_doubts(drawing, low, high))
    return (
        *_size_doubts(float((high.max(axis=0) - low.min(axis=0)).max())),
        *_gap_doubts(drawing, sizes),
        *_sheet_doubts(drawing, polygons(loops, region), owner, (high - low).max(axis=1)),
    )


def _size_doubts(size: float) -> list[str]:
    if size > WIDE:
        return [f"the drawing is {size / 1000:.4g} m wide: is its unit right? --unit says another"]
    if size < NARROW:
        return [f"the drawing is {size:.3g} mm wide: is its unit right? --unit says another"]
    return []


def _gap_doubts(drawing: Drawing, sizes: NDArray[np.float64]) -> list[str]:
    least = int(np.argmin(sizes))
    if drawing.gap <= LARGE_GAP * sizes[least]:
        return []
    name, wide = drawing.parts[least].name, float(sizes[least])
    return [f'the gap of {drawing.gap:.4g} mm is large beside part "{name}", {wide:.4g} mm wide: is it in mm?']


def _point_doubts(drawing: Drawing, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[str]:
    """Parts pulled at a reference point that lies far outside: their turn moves it more than any of their own points."""
    pulled = {goal.part for goal in drawing.goals if isinstance(goal, Pull) and goal.point is None}
    lines = []
    for k, part in enumerate(drawing.parts):
        if part.name not in pulled:
            continue
        x, y, _ = part.at
        aside = float(np.hypot(*np.maximum(np.maximum(low[k] - (x, y), (x, y) - high[k]), 0.0)))
        if aside > OUTSIDE * float((high[k] - low[k]).max()):
            middle = (low[k] + high[k]) / 2
            lines.append(
                f'"{part.name}" is pulled at its reference point ({x:.4g}, {y:.4g}), {aside:.4g} mm outside of it; '
                f"a pull at a point of its own says how far it goes: @{middle[0]:.4g},{middle[1]:.4g}"
            )
    return lines


def _sheet_doubts(
    drawing: Drawing, shapes: NDArray[np.object_], owner: NDArray[np.int64], sizes: NDArray[np.float64]
) -> list[str]:
    """Most parts near nothing, and none of these inside another one's hull."""
    count = len(drawing.parts)
    if count < 2:
        return []
    room = np.maximum(FAR * sizes, 4 * drawing.gap)
    hulls = shapely.convex_hull(shapes)
    tree = shapely.STRtree(hulls)
    i, j = tree.query(shapely.box(*_grown(shapely.bounds(shapes), room[owner])))
    i, j = i[owner[i] != owner[j]], j[owner[i] != owner[j]]
    shapely.prepare(shapes)
    near = shapely.dwithin(shapes[i], shapes[j], room[owner[i]])
    near |= shapely.intersects(hulls[i], shapes[j]) | shapely.intersects(shapes[i], hulls[j])
    together = np.zeros(count, dtype=bool)
    together[owner[i[near]]] = True
    together[owner[j[near]]] = True
    names, glued = [part.name for part in drawing.parts], {name for group in drawing.glue for name in group}
    together |= np.array([name in glued for name in names])
    alone = int(count - together.sum())
    if 2 * alone < count or alone < 2:
        return []
    return [
        f"these look like parts on a cutting sheet: {alone} of {count} touch nothing; "
        "wiggleroom assemble puts a sheet's parts together"
    ]


def _grown(bounds: NDArray[np.float64], room: NDArray[np.float64]) -> NDArray[np.float64]:
    """Boxes (n, 4) larger by `room` (n,) on all sides, as rows of left, bottom, right, top (4, n)."""
    return (bounds + np.column_stack([-room, -room, room, room])).T
