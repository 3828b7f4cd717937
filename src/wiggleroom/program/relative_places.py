"""Compiled sweeps over pairs for the retraction: where bodies are seen from each other, and how far they are from there."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit


@njit(**NO_ALLOCATION)
def predicted_places(g, turn, a, b, change, q):
    """Fill q (P, 2) with where bodies b are seen from bodies a after a straight change (n, 3) of all poses, to first order."""
    for p in range(len(a)):
        i, j = a[p], b[p]
        c, s, w = turn[p, 0], turn[p, 1], change[i, 2]
        dx, dy = change[j, 0] - change[i, 0], change[j, 1] - change[i, 1]
        q[p, 0] = g[p, 0] + c * dx + s * dy + w * g[p, 1]
        q[p, 1] = g[p, 1] - s * dx + c * dy - w * g[p, 0]


@njit(**NO_ALLOCATION)
def add_shortfalls(pose, a, b, slot, q, out):
    """Add to out (2, F) how far bodies at poses (n, 3) are from where pairs should see each other, q (P, 2); away from it for bodies a."""
    for p in range(len(a)):
        i, j = a[p], b[p]
        c, s = np.cos(pose[i, 2]), np.sin(pose[i, 2])
        x = c * q[p, 0] - s * q[p, 1] - (pose[j, 0] - pose[i, 0])
        y = s * q[p, 0] + c * q[p, 1] - (pose[j, 1] - pose[i, 1])
        i, j = slot[i], slot[j]
        if j >= 0:
            out[0, j] += x
            out[1, j] += y
        if i >= 0:
            out[0, i] -= x
            out[1, i] -= y


@njit(**NO_ALLOCATION)
def pair_differences(turn, a, b, slot, held, out):
    """Fill out (P, 2) with the differences of vectors held (2, F) between bodies b and a, in A's frame; fixed bodies have none."""
    for p in range(len(a)):
        i, j, x, y = slot[a[p]], slot[b[p]], 0.0, 0.0
        if j >= 0:
            x, y = held[0, j], held[1, j]
        if i >= 0:
            x, y = x - held[0, i], y - held[1, i]
        c, s = turn[p, 0], turn[p, 1]
        out[p, 0], out[p, 1] = c * x + s * y, -s * x + c * y
