"""How near bodies come to each other on a path."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.swept_distance import swept_distance
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.neighbours import ignored_matrix

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def least_distances(bodies: Bodies, path: Floats, there: Bools, ignored: Ints, most: float) -> Floats:
    """Least distances (n, n) of bodies on a path [mm], of which only those below `most` are worked out; others are `most`.

    Parameters
    ----------
    bodies : Bodies
    path : (k, n, 3) float64 [mm, mm, rad]
        Motions of the bodies, straight in between. What moves on no piece of it against another body is not looked at.
    there : (n,) bool
        Bodies that count.
    ignored : (k,) int64
        Keys a * n + b of pairs that never collide.
    most : float [mm]
    """
    n, shapes, radius = len(there), bodies.shapes, bodies.radius
    found = np.full((n, n), most)
    never = ignored_matrix(ignored, n)
    poses = np.ascontiguousarray(bodies.rest + path)
    for begin, end in pairwise(poses):
        moving = (begin != end).any(axis=1)
        change = end - begin
        low, high = np.minimum(begin, end)[:, :2] - radius[:, None], np.maximum(begin, end)[:, :2] + radius[:, None]
        for a in np.flatnonzero(there):
            for b in np.flatnonzero(there[a + 1 :]) + a + 1:
                together = not change[a, 2] and (change[a] == change[b]).all()
                if never[a, b] or together or not (moving[a] or moving[b]):
                    continue
                if (low[a] > high[b] + most).any() or (low[b] > high[a] + most).any():
                    continue
                found[a, b] = found[b, a] = swept_distance(
                    shapes.corner, shapes.after, shapes.first, bodies.shape, radius, a, b, begin, end, found[a, b],
                )  # fmt: skip
    return found
