"""Facets of the convex hull of an outer region: the inequalities that a linear program takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.scipy_extensions import qhull
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion
from wiggleroom.freespace.outer.outer_region import OuterRegion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINE_NORMALS, COARSE_NORMALS = 0.12, 0.5
"""Facets of a hull whose normals differ by less [rad] are one; its support is worked out anew, so nothing is cut off."""
FINEST_INTERVAL = 1e-6
"""Narrower intervals [rad] are never cut again."""
SUPPORT_TOLERANCE = 0.05
"""An interval holds a facet where it comes this near to it, as a share of its blur."""


@dataclass(frozen=True, eq=False)
class Facets:
    """normal . (tau, phi) <= offset for all that can be reached at turns between `low` and `high`, and the corners of its hull.

    Parameters
    ----------
    normal : (m, 3) float64
    offset : (m,) float64 [mm]
    corner : (c, 3) float64 [mm, mm, rad]
        Each is rounded by at most `margin` and `angle_margin`.
    margin : float [mm]
    angle_margin : float [rad]
    low, high : float [rad]
    """

    normal: Floats
    offset: Floats
    corner: Floats
    margin: float
    angle_margin: float
    low: float
    high: float


def facets(
    outer: OuterRegion | CagingSurface | LocalOuterRegion, low: float, high: float, unlike: float = FINE_NORMALS
) -> Facets | None:
    """Few facets round all that can be reached at turns between `low` and `high`; None where nothing can.

    Normals are those of the convex hull, those that differ by less than `unlike` [rad] merged. Offsets are the largest values at all
    corners, so whatever the normals, nothing is cut off.
    """
    points, _ = outer.points(low, high)
    if not len(points):
        return None
    box = np.maximum(np.ptp(points, axis=0), 1e-12 * (1 + np.abs(points).max()))
    normal = np.vstack([np.eye(3), -np.eye(3)])
    try:
        hull = qhull().ConvexHull(points / box)
        corners = hull.points[hull.simplices]
        size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        normal = np.vstack([normal, _unlike(hull.equations[np.argsort(-size), :3], unlike)])
        points = points[hull.vertices]
    except (qhull().QhullError, ValueError):
        pass  # flat or too few corners: the box alone
    normal = normal / box
    normal = normal / np.abs(normal[:, :2]).max(1, initial=0.0, keepdims=True).clip(1.0 / outer.material.radius)
    margin = 4 * outer.material.margin
    angle_margin = margin / outer.material.radius
    offset = (points @ normal.T).max(0) + margin * np.hypot(*normal[:, :2].T) + angle_margin * np.abs(normal[:, 2])
    return Facets(normal, offset, points, margin, angle_margin, low, high)


def _unlike(normals: Floats, angle: float) -> Floats:
    """Normals that differ from all earlier ones by an angle [rad]."""
    kept: list[Floats] = []
    alike = np.cos(angle)
    left = np.ones(len(normals), dtype=bool)
    for k, n in enumerate(normals):
        if left[k]:
            kept.append(n)
            left &= normals @ n < alike
    return np.array(kept)


def intervals_at_facets(outer: OuterRegion, found: Facets, which: Ints, accuracy: float) -> Ints:
    """Intervals that keep some facets (k,) of `found` where they are, and are too wide.

    They are where they blur by more than `accuracy` [mm], and where they are wider than half of the turns that are looked at: what
    an interval holds at one turn it holds at all.
    """
    points, interval = outer.points(found.low, found.high)
    blur, width = outer.blur[interval], (outer.high - outer.low)[interval]
    normal = found.normal[which]
    short = found.offset[which] - points @ normal.T
    near = blur[:, None] * np.hypot(*normal[:, :2].T) + width[:, None] * np.abs(normal[:, 2])
    wide = (blur > accuracy) | (width > max((found.high - found.low) / 2, FINEST_INTERVAL))
    return np.unique(interval[((short <= SUPPORT_TOLERANCE * near) & wide[:, None]).any(1)])
