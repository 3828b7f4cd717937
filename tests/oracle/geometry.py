"""Turning, and moving outlines inward with mitred corners."""

from __future__ import annotations

import numpy as np
import shapely


def turn(angle: float) -> np.ndarray:
    """Rotation matrix of `angle` [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def inset(ring: np.ndarray, distance: float) -> np.ndarray:
    """Corners of a counter-clockwise outline whose every edge moved inward by `distance`; never drops a corner.

    Exact as long as no edge vanishes; the caller checks that (`inset_polygon` does).
    """
    before = ring - np.roll(ring, 1, axis=0)
    after = np.roll(ring, -1, axis=0) - ring
    left = [np.column_stack([-e[:, 1], e[:, 0]]) / np.hypot(*e.T)[:, None] for e in (before, after)]
    bisector = (left[0] + left[1]) / (1 + np.sum(left[0] * left[1], axis=1))[:, None]
    return ring + distance * bisector


def inset_polygon(polygon: shapely.Polygon, distance: float) -> shapely.Polygon | None:
    """`polygon` with all its rings moved into the material; None where an edge or the part would vanish."""
    oriented = shapely.orient_polygons(polygon)
    rings = [shapely.get_coordinates(r)[:-1] for r in (oriented.exterior, *oriented.interiors)]
    moved = [inset(r, distance) for r in rings]
    for old, new in zip(rings, moved, strict=True):
        edges = [np.roll(r, -1, axis=0) - r for r in (old, new)]
        if np.min(np.sum(edges[0] * edges[1], axis=1)) <= 0:
            return None
    result = shapely.Polygon(moved[0], moved[1:])
    return result if result.is_valid else None
