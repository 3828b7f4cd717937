"""Material made thicker by a radius: what it leaves free is where the middle of a disc of that radius may be."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]

GRID = 1e-10
"""Unions are rounded to this share of the largest coordinate: without a grid GEOS now and then loses whole pieces."""
CHORD_ANGLE = 0.01
"""Angle of the chords of arcs [rad]: they lie inside by at most the 1.25e-5th part of the radius."""


def inner_offset(wall: shapely.Geometry, radius: float) -> shapely.Geometry:
    """The wall made thicker by a radius [mm], or a little less: strips along its edges, and sectors with chords at its corners.

    The nearest point of a wall lies inside an edge, whose strip then counts, or at a corner, on the side to which that is pointed. So what
    is made thicker by `radius` / cos(CHORD_ANGLE / 2) covers all that is nearer than `radius`, but for three grids.
    """
    grid = grid_size(wall)
    pieces = [wall]
    for part in shapely.get_parts(wall):
        for ring in (part.exterior, *part.interiors):
            pieces += _along(shapely.get_coordinates(ring), radius - 2 * grid)
    return shapely.union_all(pieces, grid_size=grid)


def grid_size(wall: shapely.Geometry) -> float:
    """Grid of the corners [mm] of what is made thicker."""
    return GRID * float(np.abs(shapely.bounds(wall)).max())


def _along(ring: Floats, radius: float) -> list[shapely.Geometry]:
    """Strips and sectors of one ring (k, 2), whose last corner is the first again."""
    begin, end = ring[:-1], ring[1:]
    along = (end - begin) / np.hypot(*(end - begin).T)[:, None]
    left = radius * np.column_stack([-along[:, 1], along[:, 0]])
    found = [*shapely.polygons(np.stack([begin - left, end - left, end + left, begin + left], axis=1))]
    before = np.roll(left, 1, axis=0)  # of the edge that ends where this one begins
    turn = np.arctan2(before[:, 0] * left[:, 1] - before[:, 1] * left[:, 0], (before * left).sum(1))
    first = -np.copysign(1.0, turn)[:, None] * before
    last = -np.copysign(1.0, turn)[:, None] * left
    chords = np.maximum(np.ceil(np.abs(turn) / CHORD_ANGLE), 1).astype(np.int64)
    for count in np.unique(chords[turn != 0]).tolist():
        at = np.flatnonzero((chords == count) & (turn != 0))
        angle = turn[at, None] * np.arange(1, count) / count
        c, s = np.cos(angle), np.sin(angle)
        x, y = first[at, None, 0], first[at, None, 1]
        between = np.stack([c * x - s * y, s * x + c * y], axis=2)
        corner = begin[at, None]
        rim = np.concatenate([first[at, None], between, last[at, None]], axis=1)
        found += [*shapely.polygons(np.concatenate([corner, corner + rim], axis=1))]
    return found


def hole_round(wall: shapely.Geometry, point: Floats) -> shapely.Polygon | None:
    """The hole of the wall round a point (2,), or None."""
    rings = [ring for part in shapely.get_parts(wall) for ring in part.interiors]
    holes = shapely.polygons(rings) if rings else np.zeros(0, dtype=object)
    return min(holes[shapely.contains_xy(holes, *point)], key=shapely.area, default=None)
