"""Compiled: the material that two panels share whose planes cross."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import njit


@njit(cache=True)
def _chords(edges, nx, ny, ux, uy, offset, out):
    """Write where the line normal . x = offset crosses edges, ascending along u, and return how many times."""
    n = 0
    for k in range(len(edges)):
        a = nx * edges[k, 0] + ny * edges[k, 1] - offset
        b = nx * edges[k, 2] + ny * edges[k, 3] - offset
        if (a > 0) != (b > 0):
            s = a / (a - b)
            x = edges[k, 0] + s * (edges[k, 2] - edges[k, 0])
            y = edges[k, 1] + s * (edges[k, 3] - edges[k, 1])
            v = ux * x + uy * y
            i = n
            while i > 0 and out[i - 1] > v:
                out[i] = out[i - 1]
                i -= 1
            out[i] = v
            n += 1
    return n


@njit(cache=True)
def crossing_volume(ea, ha, eb, hb, turn, move, enough):
    """Volume [mm3] that two plates in planes which cross share, by chords along the crossing line; no more than `enough` is summed up.

    Parameters
    ----------
    ea, eb : (n, 4) float64 [mm]
        Edges of the outlines.
    ha, hb : float [mm]
        Half thicknesses.
    turn, move : (3, 3) and (3,) float64
        Pose of B in A's frame.

    Notes
    -----
    A point of both slabs has the heights p over A's plane and q over B's; for fixed p and q the points make a line
    along the crossing direction, which cuts each outline in chords. Three heights of each are enough to see an overlap.
    """
    cosine = turn[2, 2]
    sine = np.sqrt(max(0.0, 1.0 - cosine * cosine))
    # unit direction of the crossing line in A's frame: normal of A x normal of B
    ux, uy = -turn[1, 2] / sine, turn[0, 2] / sine
    nx, ny = turn[0, 2] / sine, turn[1, 2] / sine  # in A's plane, square to it
    wx = turn[0, 0] * ux + turn[1, 0] * uy
    wy = turn[0, 1] * ux + turn[1, 1] * uy  # the same direction in B's frame
    mx, my = turn[2, 0] / sine, turn[2, 1] / sine  # A's normal in B's plane
    along = ux * move[0] + uy * move[1]
    height_b = turn[0, 2] * move[0] + turn[1, 2] * move[1] + turn[2, 2] * move[2]
    a = np.empty(len(ea) + 1)
    b = np.empty(len(eb) + 1)
    total = 0.0
    unit = 4.0 * ha * hb / sine / 9.0
    for i in range(-1, 2):
        p = i * ha
        for j in range(-1, 2):
            q = j * hb
            # x in A: z = p and normal_b . x = q + height_b  ->  n . x = (q + height_b - cosine p) / sine
            count_a = _chords(ea, nx, ny, ux, uy, (q + height_b - cosine * p) / sine, a)
            if count_a < 2:
                continue
            # y in B: z = q and normal_a . (turn y + move) = p  ->  m . y = (p - move_z - cosine q) / sine
            count_b = _chords(eb, mx, my, wx, wy, (p - move[2] - cosine * q) / sine, b)
            s = t = 0
            while s + 1 < count_a and t + 1 < count_b:
                low = max(a[s], b[t] + along)
                high = min(a[s + 1], b[t + 1] + along)
                if high > low:
                    total += high - low
                if a[s + 1] < b[t + 1] + along:
                    s += 2
                else:
                    t += 2
            if total * unit > enough:
                return total * unit
    return total * unit
