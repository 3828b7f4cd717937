"""Open slices made bounded and convex, as the paper does it: extend the nearby edges, or keep to the radius of its Lemma 1."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.slices import PairOutlines, Slice, parallelograms

Floats = NDArray[np.float64]

EDGE_REACH = 3.0
"""Edges of a slice no further from B's place than this multiple of the clearance are extended."""
AREA_TOLERANCE = 1e-9
"""Share of an area that rounding may add."""
TIE = 1e-9
"""Sides are equally near where their distances differ by less than this share of the window."""
BALL_CORNERS = 32
"""Corners of the polygon in the ball of Lemma 1."""


def bounded(pair: PairOutlines, one: Slice, spot: Floats, window: float) -> Slice:
    """Convex bounded part of an open slice round `spot` (2,) [mm], or round a point of the slice where it does not hold `spot`.

    The lines of the nearby edges cut the window; the piece that holds B is taken, unless it takes in forbidden space. Then the ball of
    Lemma 1 is, cut by the lines of the edges it could reach.

    Source: Mind the Gap, section 4.1; what counts as nearby, and the window, are ours.
    """
    region = one.region
    if not shapely.dwithin(region, shapely.Point(spot), AREA_TOLERANCE * window):
        spot = shapely.get_coordinates(shapely.point_on_surface(region))[0]
    piece = _extended(region, spot, EDGE_REACH * pair.clearance, window)
    if shapely.area(shapely.difference(piece, region)) > AREA_TOLERANCE * window**2 or not shapely.area(piece):
        piece = _ball(pair, one.angle, spot, window)
    return replace(one, region=piece, area=float(shapely.area(piece)))


def _extended(region: shapely.Geometry, spot: Floats, near: float, window: float) -> shapely.Polygon:
    """Piece of the window that holds `spot` between the lines of all edges nearby."""
    ring = _square(window)
    for part in shapely.get_parts(shapely.orient_polygons(region)):  # free space lies left of all edges
        for boundary in (part.exterior, *part.interiors):
            corners = shapely.get_coordinates(boundary)
            start, end = corners[:-1], corners[1:]
            rim = (np.abs(np.abs(start) - window) < AREA_TOLERANCE * window) & (
                np.abs(start - end) < AREA_TOLERANCE * window
            )
            lines = shapely.linestrings(np.stack([start, end], axis=1))
            solid = (
                np.hypot(*(end - start).T) > AREA_TOLERANCE * window
            )  # shorter edges are rounding and have no direction
            close = (shapely.distance(lines, shapely.Point(spot)) <= near) & ~rim.any(axis=1) & solid
            for k in np.flatnonzero(close):
                edge = end[k] - start[k]
                ring = _cut(ring, np.array([-edge[1], edge[0]]), start[k], spot)
    return shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon()


def _cut(ring: Floats, normal: Floats, at: Floats, spot: Floats) -> Floats:
    """What a line leaves of a convex polygon on the side of `spot`, or on the side of `normal` where the line meets `spot`."""
    size = np.hypot(*normal)
    if size == 0 or not len(ring):
        return ring
    n = normal / size
    if (spot - at) @ n < -1e-12 * max(1.0, np.abs(ring).max()):
        n = -n
    return clipped(ring, n, float(n @ at))


def clipped(ring: Floats, normal: Floats, off: float) -> Floats:
    """Part of a convex polygon (k, 2) where normal . x >= off."""
    height = ring @ normal - off
    after, rise = np.roll(ring, -1, axis=0), np.roll(height, -1)
    crosses = (height > 0) != (rise > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, height / (height - rise), 0.0)
    meets = ring + share[:, None] * (after - ring)
    rows = np.stack([ring, meets], axis=1).reshape(-1, 2)
    return rows[np.stack([height > 0, crosses], axis=1).ravel()]


def _ball(pair: PairOutlines, phi: float, spot: Floats, window: float) -> shapely.Polygon:
    """Ball of Lemma 1 round `spot`, cut by the line of the nearest side of every pair of edges.

    The radius is the least distance, over all pairs of edges, of an end of the side nearest to `spot`. Where a corner is nearest, both its
    sides are; the one whose line is further away is taken, as the other one may run through `spot` itself and leave nothing.
    """
    box = (*(spot - 2 * window), *(spot + 2 * window))
    quads = parallelograms(pair, phi, box)
    if not len(quads):
        return shapely.box(*(spot - window), *(spot + window))
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2)  # (k, 4, 2, 2)
    away = shapely.distance(shapely.linestrings(sides), shapely.Point(spot))
    along, to = np.moveaxis(sides[:, :, 1] - sides[:, :, 0], 2, 0), np.moveaxis(spot - sides[:, :, 0], 2, 0)
    beyond = np.abs(along[0] * to[1] - along[1] * to[0]) / np.hypot(*along)
    tied = away <= away.min(axis=1)[:, None] + TIE * window
    nearest = np.where(tied, beyond, -1.0).argmax(axis=1)
    side = sides[np.arange(len(quads)), nearest]
    radius = min(float(np.hypot(*(side - spot).transpose(2, 0, 1)).min()), window)
    angles = 2 * np.pi * np.arange(BALL_CORNERS) / BALL_CORNERS
    ring = spot + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    edge = side[:, 1] - side[:, 0]
    normal = np.column_stack([-edge[:, 1], edge[:, 0]]) / np.hypot(*edge.T)[:, None]
    off = (normal * side[:, 0]).sum(1)
    flip = (quads.mean(axis=1) * normal).sum(1) > off  # the pair meets on the other side
    normal[flip], off[flip] = -normal[flip], -off[flip]
    for k in np.flatnonzero(normal @ spot - off < radius):
        ring = clipped(ring, normal[k], float(off[k]))
    return (
        shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon(shapely.Point(spot).buffer(AREA_TOLERANCE * window))
    )


def _square(half: float) -> Floats:
    return half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
