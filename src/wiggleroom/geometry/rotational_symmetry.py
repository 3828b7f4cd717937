"""Rotations of a shape about its centroid that bring it onto itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import BodyShapes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_ORDER = 720
"""Higher symmetries count as the highest of their parts up to this one."""


def symmetry_orders(shapes: BodyShapes, tolerance: float) -> Ints:
    """Order (S,) of the rotational symmetry of every shape: n where turns by 2 pi / n bring it onto itself, else 1.

    Parameters
    ----------
    shapes : BodyShapes
        Their frames have their origin at the centroid, which every symmetry keeps.
    tolerance : float [mm]
        However many of these turns follow each other, no corner lies further than this from the corner that it is brought onto.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> from wiggleroom.geometry.bodies import bodies
    >>> row = wr.patterns.chain(3, joint="tee", gap=0.01)
    >>> symmetry_orders(bodies(row).shapes, 1e-9).max()
    np.int64(1)
    """
    first = shapes.first
    pairs = [slice(int(begin), int(end)) for begin, end in pairwise(first)]
    return np.array([symmetry_order(shapes.corner[k], shapes.after[k] - k.start, tolerance) for k in pairs])


def symmetry_order(corner: Floats, after: Ints, tolerance: float) -> int:
    """Order of the symmetry about the origin of rings with some corners (N, 2) [mm], each followed by corner `after` (N,)."""
    radius = np.hypot(*corner.T)
    outermost = int((radius > radius.max() - tolerance).sum())  # such corners are brought onto each other
    tree = shapely.STRtree(shapely.points(corner))
    for n in range(min(outermost, MAX_ORDER), 1, -1):
        if outermost % n or len(corner) % n:
            continue
        turned = shapely.points(_turned(corner, 2 * np.pi / n))
        found, image = tree.query_nearest(turned, max_distance=tolerance, all_matches=False)
        onto = len(found) == len(corner)
        if onto and (after[image] == image[after]).all() and _spread(corner, image, n) <= tolerance:
            return n
    return 1


def _spread(corner: Floats, image: Ints, n: int) -> float:
    """Twice the largest distance of a corner's images under all turns by 2 pi / n, turned back, from their mean [mm].

    No two of them are further apart than that.
    """
    there, total, worst = np.arange(len(corner)), np.zeros_like(corner), np.zeros(len(corner))
    for turn in range(n):
        total += _turned(corner[there], -2 * np.pi * turn / n)
        there = image[there]
    for turn in range(n):
        away = _turned(corner[there], -2 * np.pi * turn / n) - total / n
        worst = np.maximum(worst, np.hypot(*away.T))
        there = image[there]
    return 2 * float(worst.max())


def _turned(points: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])
