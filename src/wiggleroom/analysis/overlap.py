"""Exact overlap of moved bodies, by general polygon geometry that shares nothing with the walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.pairs.neighbours import placed
from wiggleroom.pairs.shapes import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAFE = 1e-9
"""Overlap that counts as none, as a share of the drawing's size."""


@dataclass(frozen=True, eq=False)
class Overlaps:
    """Pairs of bodies that share material: `a`, `b` (k,) and how deep (k,) [mm]."""

    a: Ints
    b: Ints
    depth: Floats

    @property
    def deepest(self) -> float:
        """Largest depth [mm], 0 where nothing overlaps."""
        return float(self.depth.max(initial=0.0))


def overlaps(bodies: Bodies, motion: Floats, barred: Ints) -> Overlaps:
    """Every pair of bodies that overlaps at `motion` (n, 3) [mm, mm, rad], apart from fixed with fixed and `barred` keys a * n + b.

    Depth is the smaller side of the smallest rectangle round the common material.
    """
    geometry = placed(bodies, motion)
    a, b = shapely.STRtree(geometry).query(geometry)
    keep = (a < b) & ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(a * len(geometry) + b, barred)
    a, b = a[keep], b[keep]
    hit = shapely.intersects(geometry[a], geometry[b])
    a, b = a[hit], b[hit]
    common = shapely.intersection(geometry[a], geometry[b])
    solid = shapely.area(common) > 0
    a, b, common = a[solid], b[solid], common[solid]
    return Overlaps(a, b, np.array([_depth(c) for c in common]))


def _depth(common: shapely.Geometry) -> float:
    """Width of the widest piece [mm]."""
    widest = 0.0
    for piece in shapely.get_parts(common):
        if piece.area <= 0:
            continue
        around = shapely.get_coordinates(shapely.minimum_rotated_rectangle(piece))
        if len(around) < 4:
            widest = max(widest, 2 * piece.area / piece.length)
        else:
            sides = np.hypot(*np.diff(around[:3], axis=0).T)
            widest = max(widest, float(sides.min()))
    return widest
