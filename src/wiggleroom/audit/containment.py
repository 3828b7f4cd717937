"""Whether one part lies inside another, by winding numbers.

Source: Sunday, Inclusion of a Point in a Polygon (2001).
"""

from __future__ import annotations

import numpy as np

from wiggleroom.audit.moving_edges import BACK_X, BACK_Y, COS, SIN, X, Y, relative
from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit


@njit(**COMPILED_CALLERS_ONLY)
def winding(x, y, own, first, corner, after):
    """How often the outlines of a shape go round a point of its frame."""
    turns = 0
    for e in range(first[own], first[own + 1]):
        x0, y0, x1, y1 = corner[e, 0], corner[e, 1], corner[after[e], 0], corner[after[e], 1]
        if (y0 <= y) == (y1 <= y):
            continue
        left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
        if y0 <= y and left > 0.0:
            turns += 1
        elif y1 <= y and left < 0.0:
            turns -= 1
    return turns


@njit(**OPTIONS)
def inside_each_other(pair_a, pair_b, pose, shape, first, corner, after, ring, first_ring, out):
    """Mark the pairs of which a ring of one begins inside the other, at poses (n, 3)."""
    at = np.empty(6)
    for pair in range(len(pair_a)):
        relative(pose[pair_a[pair]], pose[pair_b[pair]], at)
        a, b = shape[pair_a[pair]], shape[pair_b[pair]]
        c, s = at[COS], at[SIN]
        for r in range(first_ring[b], first_ring[b + 1]):
            v = ring[r]
            x = c * corner[v, 0] - s * corner[v, 1] + at[X]
            y = s * corner[v, 0] + c * corner[v, 1] + at[Y]
            out[pair] |= winding(x, y, a, first, corner, after) != 0
        for r in range(first_ring[a], first_ring[a + 1]):
            v = ring[r]
            x = c * corner[v, 0] + s * corner[v, 1] + at[BACK_X]
            y = -s * corner[v, 0] + c * corner[v, 1] + at[BACK_Y]
            out[pair] |= winding(x, y, b, first, corner, after) != 0
