"""Closed outlines as arrays of corners: clean, turn, measure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part, Points, Region

COINCIDENT_CORNERS = 1e-9
"""Corners closer together than this share of the outline's size are one corner."""
COLLINEAR_TOLERANCE = 1e-12
"""A corner nearer than this share of the size to the line of its neighbours is none."""
ROUNDING = 1e-15
"""The same as a share of the coordinates, which far from the origin are rounded more coarsely."""


def signed_area(ring: Points) -> float:
    """Enclosed area [mm2], positive where the corners `ring` (n, 2) [mm] run counter-clockwise.

    Examples
    --------
    >>> signed_area(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]))
    1.0
    """
    if len(ring) < 3:
        return 0.0
    x, y = (ring - ring[0]).T
    return float(0.5 * (x[:-1] @ y[1:] - y[:-1] @ x[1:]))  # the last edge ends at 0, 0


def extents_and_areas(rings: list[Points]) -> tuple[Points, NDArray[np.float64]]:
    """Width and height (k, 2) [mm] of many rings of at least three corners each, and their signed areas (k,) [mm2].

    Examples
    --------
    >>> extents_and_areas([np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])])
    (array([[2., 1.]]), array([1.]))
    """
    points, count = np.concatenate(rings), np.array([len(ring) for ring in rings])
    first = np.cumsum(count) - count
    extents = np.maximum.reduceat(points, first) - np.minimum.reduceat(points, first)
    after = np.arange(1, len(points) + 1)
    after[first + count - 1] = first
    x, y = (points - np.repeat(points[first], count, axis=0)).T
    return extents, np.add.reduceat(x * y[after] - y * x[after], first) / 2


def clean_ring(ring: Points, *, clockwise: bool = False) -> Points:
    """Corners without repeats and straight-on points, running counter-clockwise or clockwise.

    Parameters
    ----------
    ring : (n, 2) float64 [mm]
        Closed outline; the first corner may be repeated at the end.
    clockwise : bool
        The wanted sense, for holes.

    Returns
    -------
    (m, 2) float64 [mm]
        Fewer than three corners where the outline encloses nothing.

    Examples
    --------
    >>> clean_ring(np.array([[0.0, 0], [0, 1], [0, 1], [1, 1], [1, 0], [0.5, 0], [0, 0]]))
    array([[1., 0.],
           [1., 1.],
           [0., 1.],
           [0., 0.]])
    """
    if not len(ring):
        return ring
    if len(ring) > 1 and (ring[0] == ring[-1]).all():
        ring = ring[:-1]
    low, high = ring.min(axis=0), ring.max(axis=0)
    size, farthest = float((high - low).max()), max(*(-low).tolist(), *high.tolist())
    height = COLLINEAR_TOLERANCE * size + ROUNDING * farthest
    edges = _edges(ring)
    if not (np.hypot(*edges.T) > COINCIDENT_CORNERS * size).all() or _straight(edges, height).any():
        ring = _without_straight(_without_repeats(ring, COINCIDENT_CORNERS * size), height)
    if (signed_area(ring) < 0) != clockwise:
        ring = ring[::-1]
    return np.ascontiguousarray(ring)


def _without_repeats(ring: Points, least: float) -> Points:
    """Each corner must lie further than `least` from the last one kept; so must the last from the first."""
    if len(ring) < 2:
        return ring
    near = np.hypot(*_edges(ring).T) <= least
    if not near.any():
        return ring
    kept = [ring[0]]
    for point in ring[1:]:
        if np.hypot(*(point - kept[-1])) > least:
            kept.append(point)
    while len(kept) > 1 and np.hypot(*(kept[-1] - kept[0])) <= least:
        kept.pop()
    return np.array(kept)


def _without_straight(ring: Points, height: float) -> Points:
    while len(ring) >= 3:
        straight = _straight(_edges(ring), height)
        if not straight.any():
            return ring
        # Of two straight-on neighbours only one goes at a time, so that deviations cannot add up unseen.
        straight &= ~(np.roll(straight, 1) & (np.arange(len(ring)) % 2 == 1))
        ring = ring[~straight]
    return ring


def _straight(before: Points, height: float) -> NDArray[np.bool_]:
    """Corners at which the outline goes straight on, from the edges that end at each."""
    after = np.concatenate([before[1:], before[:1]])
    (x, y), (u, v) = before.T, after.T
    found = np.abs(x * v - y * u) <= height * np.hypot(x + u, y + v)
    return found & (x * u + y * v > 0) if found.any() else found


def _edges(ring: Points) -> Points:
    """Edges that end at each corner."""
    return ring - np.concatenate([ring[-1:], ring[:-1]])


def centroid(outers: list[Points]) -> tuple[float, float]:
    """Area centroid (x, y) [mm] of everything inside the outer outlines, holes not counted.

    Examples
    --------
    >>> centroid([np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])])
    (1.0, 0.5)
    """
    base = outers[0][0]
    area, moment = 0.0, np.zeros(2)
    for ring in outers:
        here, there = ring - base, np.roll(ring - base, -1, axis=0)
        cross = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
        area += float(cross.sum()) / 2
        moment += ((here + there) * cross[:, None]).sum(axis=0) / 6
    # Without area, as a bow tie can be, any point will do: validation names the part.
    centre = base + moment / area if area > 0 else np.vstack(outers).mean(axis=0)
    return float(centre[0]), float(centre[1])


def part_about_centroid(
    name: str, regions: list[Region], *, fixed: bool = False, aliases: tuple[str, ...] = ()
) -> Part:
    """Part whose reference point is the area centroid of its outer outlines `regions` [mm]."""
    x, y = centroid([region.outer for region in regions])
    here = np.array([x, y])
    moved = tuple(Region(region.outer - here, tuple(hole - here for hole in region.holes)) for region in regions)
    return Part(name=name, regions=moved, at=(x, y, 0.0), fixed=fixed, aliases=aliases)
