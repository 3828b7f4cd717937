"""Compiled tests of two placed panels: flanks that meet, and material that overlaps."""

from __future__ import annotations

import numpy as np

from wiggleroom.geometry.jit_options import njit

MAX_OPPOSED_COSINE = -0.98
"""Normals of two flanks that meet point against each other: the cosine of their angle is below this."""
MIN_UPRIGHT_COSINE = 0.98
"""A flank runs along the thickness of the other panel: the cosine of their angle is above this."""
LENGTH_TOLERANCE = 0.21
"""Lengths of flanks differ from the partner's thickness by at most this share."""


@njit(cache=True)
def scores(fa, ta, oa, fb, tb, ob, turns, moves, tolerance, power):
    """Pairs of flanks that meet less those flanks that the other panel leaves no partner for, for many poses of B in A's frame.

    Parameters
    ----------
    fa, fb : (n, 7) float64
        Midpoint, inward direction, own direction (x, y each) and length of every flank [mm].
    ta, tb : float [mm]
        Nominal thicknesses.
    oa, ob : (n, 4) float64 [mm]
        Edges of the outlines with the notches and holes of joints filled.
    turns, moves : (k, 3, 3) and (k, 3) float64
    tolerance : float [mm]
    power : float
        Of both numbers: below 1 several short joints say more than a long one.

    Returns
    -------
    (k,) float64
    """
    found = np.zeros(len(turns))
    pairs = np.empty((len(fb) + 1, 2), dtype=np.int64)
    for k in range(len(turns)):
        if abs(turns[k, 2, 2]) > 0.1:
            continue
        met = meeting(fa, ta, fb, tb, turns[k], moves[k], tolerance, pairs)
        turn, move = turns[k].T.copy(), -turns[k].T @ moves[k]
        blocked = _blocked(fb, ta, oa, turns[k], moves[k], tolerance) - met
        blocked += _blocked(fa, tb, ob, turn, move, tolerance) - met
        found[k] = met**power - BLOCKED_PENALTY * max(0, blocked) ** power
    return found


@njit(cache=True)
def blocked_pairs(fa, ta, oa, na, fb, tb, ob, nb, turns, moves, tolerance):
    """How many needed flanks of A and B each other's material leaves no partner for; arguments as in `scores`.

    Parameters
    ----------
    na, nb : (n,) bool
        Which flanks are needed.
    """
    found = np.zeros(len(turns), dtype=np.int64)
    pairs = np.empty((len(fb) + 1, 2), dtype=np.int64)
    for k in range(len(turns)):
        if abs(turns[k, 2, 2]) > 0.1:
            continue
        met = meeting(fa, ta, fb, tb, turns[k], moves[k], tolerance, pairs)
        left_a, left_b = na.copy(), nb.copy()
        for i in range(met):
            left_a[pairs[i, 0]] = False
            left_b[pairs[i, 1]] = False
        turn, move = turns[k].T.copy(), -turns[k].T @ moves[k]
        found[k] = _blocked(fb[left_b], ta, oa, turns[k], moves[k], tolerance)
        found[k] += _blocked(fa[left_a], tb, ob, turn, move, tolerance)
    return found


BLOCKED_PENALTY = 0.5
"""What a flank that can meet nothing any more takes off the score."""


@njit(cache=True)
def _blocked(flanks, thickness, outline, turn, move, tolerance):
    """How many flanks stand in the plane of another panel inside its filled outline; the pose is from theirs to its frame."""
    found = 0
    for j in range(len(flanks)):
        if abs(flanks[j, 6] - thickness) > LENGTH_TOLERANCE * thickness:
            continue
        x, y = flanks[j, 0], flanks[j, 1]
        if abs(turn[2, 0] * x + turn[2, 1] * y + move[2]) > tolerance:
            continue
        if abs(turn[2, 0] * flanks[j, 4] + turn[2, 1] * flanks[j, 5]) < MIN_UPRIGHT_COSINE:
            continue
        px = turn[0, 0] * x + turn[0, 1] * y + move[0]
        py = turn[1, 0] * x + turn[1, 1] * y + move[1]
        if _inside(outline, px, py):
            found += 1
    return found


@njit(cache=True)
def _inside(edges, x, y):
    """Whether a point lies inside an outline (ray casting)."""
    odd = False
    for k in range(len(edges)):
        if (edges[k, 1] > y) != (edges[k, 3] > y):
            s = (y - edges[k, 1]) / (edges[k, 3] - edges[k, 1])
            if edges[k, 0] + s * (edges[k, 2] - edges[k, 0]) > x:
                odd = not odd
    return odd


@njit(cache=True)
def meeting(fa, ta, fb, tb, turn, move, tolerance, pairs):
    """Write the pairs (flank of A, flank of B) that meet into `pairs`, and return how many there are."""
    if abs(turn[2, 2]) > 0.1:
        return 0
    found = 0
    for j in range(len(fb)):
        if abs(fb[j, 6] - ta) > LENGTH_TOLERANCE * ta:
            continue
        x, y = fb[j, 0], fb[j, 1]
        pz = turn[2, 0] * x + turn[2, 1] * y + move[2]
        if abs(pz) > tolerance:
            continue
        if abs(turn[2, 0] * fb[j, 4] + turn[2, 1] * fb[j, 5]) < MIN_UPRIGHT_COSINE:
            continue
        px = turn[0, 0] * x + turn[0, 1] * y + move[0]
        py = turn[1, 0] * x + turn[1, 1] * y + move[1]
        dx = turn[0, 0] * fb[j, 2] + turn[0, 1] * fb[j, 3]
        dy = turn[1, 0] * fb[j, 2] + turn[1, 1] * fb[j, 3]
        best, nearest = -1, tolerance * tolerance
        for i in range(len(fa)):
            ax, ay = fa[i, 0] - px, fa[i, 1] - py
            apart = ax * ax + ay * ay + pz * pz
            if apart >= nearest or abs(fa[i, 6] - tb) > LENGTH_TOLERANCE * tb:
                continue
            if fa[i, 2] * dx + fa[i, 3] * dy > MAX_OPPOSED_COSINE:
                continue
            if abs(fa[i, 4] * turn[0, 2] + fa[i, 5] * turn[1, 2]) < MIN_UPRIGHT_COSINE:
                continue
            best, nearest = i, apart
        if best >= 0:
            taken = False
            for k in range(found):
                if pairs[k, 0] == best:
                    taken = True
            if not taken:
                pairs[found, 0], pairs[found, 1] = best, j
                found += 1
    return found


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
def crossing_volume(ea, ha, eb, hb, turn, move):
    """Volume [mm3] that two plates in planes which cross share, by chords along the crossing line.

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
    return total / 9.0 * 4.0 * ha * hb / sine
