"""Parts that overlap at rest, and how deep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.loops import placed_regions
from wiggleroom.drawing.model import Drawing, Part
from wiggleroom.drawing.writers.glue_groups import collidable

OVERLAP_TOLERANCE = 1e-9
"""An overlap no deeper than this share of the drawing's size is rounding."""
CONTACT_TOLERANCE = 1e-6
"""A clearance below this share of the drawing's size counts as touching."""

CONVEX = 1e-6
"""A piece of overlap that fills its hull but for this share is convex."""
BISECTIONS = 20
"""The largest disc in a piece is found to this power of a half."""
MIDDLE_SHARE = 50
"""Where it lies is found to its diameter by this."""


def overlaps_at_rest(parts: Sequence[Part]) -> list[tuple[int, int, float]]:
    """Pairs of parts that overlap at rest, with depth [mm], in order.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> overlaps_at_rest([Part("a", (square,)), Part("b", (square,), at=(1.5, 0.0, 0.0))])
    [(0, 1, 0.5)]
    """
    if not parts:
        return []
    shapes, owner = placed_regions(parts)
    size = np.ptp(shapely.total_bounds(shapes).reshape(2, 2), axis=0).max()
    i, j = shapely.STRtree(shapes).query(shapes)
    i, j = i[owner[i] < owner[j]], j[owner[i] < owner[j]]
    shapely.prepare(shapes)  # each meets several others
    meet = shapely.intersects(shapes[i], shapes[j])
    i, j = i[meet], j[meet]
    meet = ~shapely.touches(shapes[i], shapes[j])
    i, j = i[meet], j[meet]
    common = shapely.intersection(shapes[i], shapes[j])
    deepest: dict[tuple[int, int], float] = {}
    for k in np.flatnonzero(shapely.area(common) > 0):
        pair = int(owner[i[k]]), int(owner[j[k]])
        depth = max(overlap_width(piece) for piece in shapely.get_parts(common[k]))
        if depth > OVERLAP_TOLERANCE * size:
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
    return [(a, b, depth) for (a, b), depth in sorted(deepest.items())]


def overlap_areas(drawing: Drawing, parts: Sequence[Part]) -> list[shapely.Geometry]:
    """Areas [mm] where two parts overlap at rest that are neither glued nor ignored; outlines that cross themselves are skipped.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> pair = (Part("a", (square,)), Part("b", (square,), at=(1.5, 0.0, 0.0)))
    >>> [area.area for area in overlap_areas(Drawing(pair), pair)]
    [1.0]
    """
    sound = [part for part in parts if shapely.is_valid(placed_regions([part])[0]).all()]
    collide = collidable(drawing.glue, drawing.ignore)
    found = []
    for i, j, _ in overlaps_at_rest(sound):
        a, b = sound[i], sound[j]
        if collide(a.name, b.name):
            found.append(shapely.intersection(*(shapely.union_all(placed_regions([part])[0]) for part in (a, b))))
    return found


@dataclass(frozen=True, eq=False)
class OverlapPiece:
    """A piece of the area that two parts share.

    Parameters
    ----------
    depth : float [mm]
        How wide it is, as `overlap_width` says.
    middle : (2,) float64 [mm]
        A point in it: of a convex piece the centroid, else where the largest disc lies.
    across : (2,) float64 or None
        Unit vector along which a convex piece is so wide, of either sign.
    """

    depth: float
    middle: NDArray[np.float64]
    across: NDArray[np.float64] | None


def deepest_piece(common: shapely.Geometry, least: float) -> OverlapPiece | None:
    """The widest piece of what two parts share; None where none is wider than this [mm].

    Examples
    --------
    >>> piece = deepest_piece(shapely.box(0, 0, 3, 0.5), 0.0)
    >>> piece.depth, piece.middle.tolist(), np.abs(piece.across).tolist()
    (0.5, [1.5, 0.25], [0.0, 1.0])
    """
    best, width = None, least
    for piece in shapely.get_parts(common):
        if piece.area > 0 and (found := overlap_width(piece)) > width:
            best, width = piece, found
    if best is None:
        return None
    hull = shapely.convex_hull(best)
    if best.area >= (1 - CONVEX) * hull.area:
        return OverlapPiece(width, shapely.get_coordinates(best.centroid)[0], _across(hull)[1])
    middle = shapely.get_coordinates(shapely.maximum_inscribed_circle(best, width / MIDDLE_SHARE))[0]
    return OverlapPiece(width, middle, None)


def overlap_width(shape: shapely.Geometry) -> float:
    """Width [mm] of a piece of overlap: the least of its hull where it is convex, else the diameter of the largest disc in it.

    So a ring or a bent strip is as wide as its material, however large it is.

    Examples
    --------
    >>> overlap_width(shapely.box(0, 0, 3, 0.5))
    0.5
    >>> frame = shapely.difference(shapely.box(0, 0, 3, 3), shapely.box(0.5, 0.5, 2.5, 2.5))
    >>> round(overlap_width(frame), 6)
    0.5
    """
    hull = shapely.convex_hull(shape)
    if hull.area <= 0:
        return 0.0
    return _across(hull)[0] if shape.area >= (1 - CONVEX) * hull.area else _largest_disc(shape)


def _across(hull: shapely.Polygon) -> tuple[float, NDArray[np.float64]]:
    """Least width of a convex polygon [mm], and the unit normal (2,) of the edge across which it is measured."""
    corners: NDArray[np.float64] = shapely.get_coordinates(hull)
    edges = np.diff(corners, axis=0)
    normals = np.column_stack([-edges[:, 1], edges[:, 0]]) / np.hypot(*edges.T)[:, None]
    widths = np.ptp(corners @ normals.T, axis=0)
    return float(widths.min()), normals[widths.argmin()]


def _largest_disc(shape: shapely.Geometry) -> float:
    """Diameter [mm] of the largest disc in a shape: it shrinks to nothing when its boundary moves inward by half of that."""
    low = float(shape.area / shape.length)  # no shape is thinner than that all along
    high = 2 * low
    while not shapely.buffer(shape, -high, join_style="mitre").is_empty:
        low, high = high, 2 * high
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if shapely.buffer(shape, -middle, join_style="mitre").is_empty:
            high = middle
        else:
            low = middle
    return low + high
