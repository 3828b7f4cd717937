"""Facets of the convex hull of an outer region: the inequalities that a linear program takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.outer_region import OuterRegion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NORMAL_TOLERANCE = 0.06
"""Facets of a hull whose normals differ by less [rad] are one; its support is worked out anew, so nothing is cut off."""
SUPPORT_TOLERANCE = 0.05
"""An interval holds a facet where it comes this near to it, as a share of its blur."""


@dataclass(frozen=True, eq=False)
class Facets:
    """normal . (tau, phi) <= offset for all that can be reached at turns between `low` and `high`, and a disc that holds tau.

    Parameters
    ----------
    normal : (m, 3) float64
    offset : (m,) float64 [mm]
    middle : (2,) float64 [mm]
    reach : float [mm]
    low, high : float [rad]
    """

    normal: Floats
    offset: Floats
    middle: Floats
    reach: float
    low: float
    high: float


def facets(outer: OuterRegion | CagingSurface, low: float, high: float) -> Facets | None:
    """Few facets round all that can be reached at turns between `low` and `high`; None where nothing can.

    Normals are those of a convex hull of extreme corners, alike ones merged. Offsets are the largest values at all
    corners of the polyhedra, so whatever the normals, nothing is cut off.
    """
    from scipy.spatial import ConvexHull, QhullError  # slow to load

    points, _ = outer.points(low, high)
    if not len(points):
        return None
    box = np.maximum(np.ptp(points, axis=0), 1e-12 * (1 + np.abs(points).max()))
    shape = points / box
    normal = np.vstack([np.eye(3), -np.eye(3)])
    outermost = np.unique((shape @ _DIRECTIONS.T).argmax(0))
    try:
        hull = ConvexHull(shape[outermost])
        corners = hull.points[hull.simplices]
        size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        normal = np.vstack([normal, _unlike(hull.equations[np.argsort(-size), :3])])
    except (QhullError, ValueError):
        pass  # flat or too few corners: the box alone
    normal = normal / box
    normal = normal / np.abs(normal[:, :2]).max(1, initial=0.0, keepdims=True).clip(1.0 / outer.material.radius)
    margin = 4 * outer.material.margin
    middle = (points[:, :2].min(0) + points[:, :2].max(0)) / 2
    reach = float(np.hypot(*(points[:, :2] - middle).T).max()) + margin
    offset = (points @ normal.T).max(0) + margin * (1 + np.abs(normal).max(1))
    return Facets(normal, offset, middle, reach, low, high)


def _sphere(n: int) -> Floats:
    """Directions (n, 3) all round."""
    z = 1 - (2 * np.arange(n) + 1) / n
    angle = np.arange(n) * np.pi * (3 - np.sqrt(5))
    return np.column_stack([np.sqrt(1 - z * z)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), z])


_DIRECTIONS = _sphere(400)


def _unlike(normals: Floats) -> Floats:
    """Normals that differ from all earlier ones."""
    kept: list[Floats] = []
    alike = np.cos(NORMAL_TOLERANCE)
    left = np.ones(len(normals), dtype=bool)
    for k, n in enumerate(normals):
        if left[k]:
            kept.append(n)
            left &= normals @ n < alike
    return np.array(kept)


def holding(outer: OuterRegion, found: Facets, which: Ints, accuracy: float) -> Ints:
    """Intervals that keep some facets (k,) of `found` where they are, and blur by more than `accuracy` [mm]."""
    points, interval = outer.points(found.low, found.high)
    blur, width = outer.blur[interval], (outer.high - outer.low)[interval]
    normal = found.normal[which]
    short = found.offset[which] - points @ normal.T
    near = blur[:, None] * np.hypot(*normal[:, :2].T) + width[:, None] * np.abs(normal[:, 2])
    return np.unique(interval[((short <= SUPPORT_TOLERANCE * near) & (blur[:, None] > accuracy)).any(1)])
