"""Closed outlines as arrays of corners: clean, turn, measure."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part, Points, Region

COINCIDENT_CORNERS = 1e-9
"""Corners closer together than this share of the outline's size are one corner."""
COLLINEAR_TOLERANCE = 1e-12
"""A corner nearer than this share of the size to the line of its neighbours is none."""
ROUNDING = 1e-15
"""The same as a share of the coordinates, which far from the origin are rounded more coarsely."""
CORNERS_AT_ONCE = 20_000
"""Number of corners that are worked on together: what fits into the processor's cache."""


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


def extents(rings: list[Points]) -> Points:
    """Width and height (k, 2) [mm] of many rings of at least one corner each.

    Examples
    --------
    >>> extents([np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])])
    array([[2., 1.]])
    """
    count = np.array([len(ring) for ring in rings])
    return np.concatenate([_extents(np.concatenate(rings[some]), count[some]) for some in _at_once(count)])


def _at_once(count: NDArray[np.int64]) -> list[slice]:
    """Rings with some numbers of corners, in runs that fit into the processor's cache."""
    cuts = np.flatnonzero(np.diff(np.cumsum(count) // CORNERS_AT_ONCE)) + 1
    return [slice(low, high) for low, high in pairwise([0, *cuts.tolist(), len(count)])]


def _extents(points: Points, count: NDArray[np.int64]) -> Points:
    """The same of rings one after the other."""
    first = np.cumsum(count) - count
    return np.maximum.reduceat(points, first) - np.minimum.reduceat(points, first)


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


def are_clean(rings: list[Points], clockwise: NDArray[np.bool_], most: float) -> NDArray[np.bool_]:
    """Whether `clean_ring` would certainly leave each of many rings as it is; rings that reach beyond `most` [mm] are not clean.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> are_clean([square, square[::-1], square[[0, 0, 1, 2, 3]]], np.zeros(3, dtype=bool), 1e3)
    array([ True, False, False])
    """
    count = np.array([len(ring) for ring in rings])
    clean, many = np.zeros(len(rings), dtype=bool), np.flatnonzero(count >= 3)
    for run in _at_once(count[many]) if len(many) else ():
        some = many[run]
        with np.errstate(over="ignore", invalid="ignore"):  # far beyond `most`
            clean[some] = _are_clean(np.concatenate([rings[k] for k in some]), count[some], clockwise[some], most)
    return clean


def _are_clean(
    points: Points, count: NDArray[np.int64], clockwise: NDArray[np.bool_], most: float
) -> NDArray[np.bool_]:
    """The same of rings of at least three corners each, one after the other."""
    first = np.cumsum(count) - count
    last = first + count - 1
    low, high = np.minimum.reduceat(points, first), np.maximum.reduceat(points, first)
    size, farthest = (high - low).max(axis=1), np.maximum(-low, high).max(axis=1)
    height = COLLINEAR_TOLERANCE * size + ROUNDING * farthest
    x, y = points.T
    u, v = np.empty_like(x), np.empty_like(y)  # edges that begin at each corner
    for along, at in ((u, x), (v, y)):
        along[:-1] = at[1:] - at[:-1]
        along[last] = at[first] - at[last]
    short = u * u + v * v <= np.repeat((COINCIDENT_CORNERS * size) ** 2, count)
    w, z = np.empty_like(u), np.empty_like(v)  # edges that end there
    for before, along in ((w, u), (z, v)):
        before[1:] = along[:-1]
        before[first] = along[last]
    turn, height = w * v - z * u, np.repeat(height, count)
    straight = (turn * turn <= height * height * ((u + w) ** 2 + (v + z) ** 2)) & (w * u + z * v > 0)
    wrong = np.logical_or.reduceat(short | straight, first)
    from_x, from_y = x - np.repeat(x[first], count), y - np.repeat(y[first], count)
    area = np.add.reduceat(from_x * v - from_y * u, first) * np.where(clockwise, -0.5, 0.5)
    return ~wrong & (area > COINCIDENT_CORNERS * size * size) & (farthest <= most)


def _without_repeats(ring: Points, least: float) -> Points:
    """Each corner must lie further than `least` from the last one kept; so must the last from the first."""
    if len(ring) < 2:
        return ring
    near = np.hypot(*_edges(ring).T) <= least
    if not near.any():
        return ring
    start, *rest = ring.tolist()
    kept = [start]
    for point in rest:
        if math.dist(point, kept[-1]) > least:
            kept.append(point)
    while len(kept) > 1 and math.dist(kept[-1], start) <= least:
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
