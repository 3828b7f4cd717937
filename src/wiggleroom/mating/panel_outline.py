"""Outlines of panels: moved inward, with corners in place of what a cutter rounds, without reliefs; and which of them are the same."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.polygon import orient

Floats = NDArray[np.float64]

SAME_OUTLINE = 0.02
"""Outlines are the same where nothing wider than twice this [mm] lies in one of them alone."""


def inset(polygon: shapely.Polygon, distance: float) -> shapely.Polygon:
    """Polygon with every edge moved inward by `distance` [mm] and sharp corners; the largest piece of what is left.

    Examples
    --------
    >>> inset(shapely.box(0, 0, 4, 3), 0.5).area
    6.0
    """
    moved = polygon.buffer(-distance, join_style="mitre", mitre_limit=5.0) if distance else polygon
    pieces = shapely.get_parts(moved)
    if not len(pieces):
        return polygon
    return orient(max(pieces, key=lambda piece: piece.area))


def sharpened(polygon: shapely.Polygon, reach: float) -> shapely.Polygon:
    """Polygon with corners in place of the tiny edges that a cutter's rounding leaves.

    Parameters
    ----------
    polygon : shapely.Polygon [mm]
    reach : float [mm]
        Edges shorter than this between two that are longer give way to the crossing of those, where it is that near.

    Examples
    --------
    >>> len(sharpened(shapely.box(0, 0, 9, 9).buffer(0.05), 0.2).exterior.coords) - 1
    4
    """
    exterior, *holes = (_sharp_ring(ring, reach) for ring in (polygon.exterior, *polygon.interiors))
    sharp = _from_a_corner(shapely.Polygon(exterior, holes)).simplify(1e-3)
    near = sharp.is_valid and sharp.geom_type == "Polygon" and len(sharp.interiors) == len(polygon.interiors)
    return orient(sharp) if near else orient(polygon.simplify(2e-3))


def _from_a_corner(polygon: shapely.Polygon) -> shapely.Polygon:
    """Polygon whose rings begin at their points furthest from the centroid: simplification keeps where they begin."""
    rings = []
    for ring in (polygon.exterior, *polygon.interiors):
        points = shapely.get_coordinates(ring)[:-1]
        first = int(np.argmax(((points - points.mean(axis=0)) ** 2).sum(axis=1)))
        rings.append(np.roll(points, -first, axis=0))
    return shapely.Polygon(rings[0], rings[1:])


def _sharp_ring(ring: shapely.LinearRing, reach: float) -> Floats:
    points = shapely.get_coordinates(ring)[:-1]
    long = np.hypot(*(np.roll(points, -1, axis=0) - points).T) > reach
    rows = np.flatnonzero(long)
    if len(rows) < 3:
        return points
    result = []
    for row, following in zip(rows, np.roll(rows, -1), strict=True):
        between = (np.arange(row + 1, row + 1 + (following - row) % len(points))) % len(points)
        corner = _crossing(
            points[row], points[(row + 1) % len(points)], points[following], points[(following + 1) % len(points)]
        )
        if len(between) == 1 or corner is None or np.hypot(*(points[between] - corner).T).max() > reach:
            result += list(points[between])
        else:
            result.append(corner)
    return np.array(result)


def _crossing(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats | None:
    """Where the line through a and b crosses that through c and d; None where they run nearly alike."""
    u, v = b - a, d - c
    turn = u[0] * v[1] - u[1] * v[0]
    if abs(turn) < 0.2 * float(np.hypot(*u) * np.hypot(*v)):
        return None
    return a + u * ((c - a)[0] * v[1] - (c - a)[1] * v[0]) / turn


def without_reliefs(polygon: shapely.Polygon, radius: float) -> shapely.Polygon:
    """Close notches and holes narrower than twice `radius`; other edges stay where they are."""
    grown = polygon.buffer(radius, join_style="mitre", mitre_limit=5.0).simplify(0.005)
    closed = grown.buffer(-radius, join_style="mitre", mitre_limit=5.0).simplify(0.005)
    return orient(closed) if closed.geom_type == "Polygon" else orient(polygon.simplify(0.005))


def same_outline(a: shapely.Polygon, b: shapely.Polygon) -> bool:
    """Whether two outlines are the same where they lie.

    Examples
    --------
    >>> same_outline(shapely.box(0, 0, 9, 9), shapely.box(0, 0, 9, 9.01)), same_outline(shapely.box(0, 0, 9, 9), shapely.box(0, 0, 9, 9.1))
    (True, False)
    """
    near = abs(a.area - b.area) < 0.02 * a.length and abs(a.length - b.length) < 0.002 * a.length
    if not near or len(a.interiors) != len(b.interiors):
        return False
    return bool(a.symmetric_difference(b).buffer(-SAME_OUTLINE, quad_segs=1).is_empty)
