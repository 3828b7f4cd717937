"""Compiled tests of two placed panels: which flanks meet, and which can meet nothing any more."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import njit

MAX_OPPOSED_COSINE = -0.98
"""Normals of two flanks that meet point against each other: the cosine of their angle is below this."""
MIN_UPRIGHT_COSINE = 0.98
"""A flank runs along the thickness of the other panel: the cosine of their angle is above this."""
LENGTH_TOLERANCE = 0.21
"""Lengths of flanks differ from the partner's thickness by at most this share."""

MET_TOLERANCE = 1.5
"""Flanks of placed panels count as met where their midpoints are nearer than this many tolerances: small errors add up."""


MAX_SQUARE_COSINE = 0.1
"""Planes with a larger cosine of the angle between them are not square to each other."""
MAX_ASKEW_COSINE = 0.95
"""And with a larger one than this they are too near to parallel for a joint."""
ASKEW_LENGTH_TOLERANCE = 0.05
"""Fingers for a known angle are as long as it asks for to this share of the thickness."""


@njit(cache=True)
def finger_length(cosine, thickness):
    """Length of fingers between plates that turn by an angle at their joint [mm]: so long that they end on the outer face.

    A blunter joint needs shorter ones; in a sharp one they are as long as the plate is thick.
    """
    return thickness * np.sqrt(1.0 - cosine * cosine) if cosine > 0 else thickness


@njit(cache=True)
def finger_setback(cosine, thickness):
    """How far the middle of a finger lies behind the line in which the middle planes of both plates cross [mm]."""
    corner = thickness * np.sqrt(
        (1.0 - cosine) / (1.0 + cosine)
    )  # from the inner corner to the outer one, in the plate
    return 0.5 * corner * cosine if cosine > 0 else 0.5 * (corner - thickness)


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
        if abs(turns[k, 2, 2]) > MAX_SQUARE_COSINE:
            continue
        met = meeting(fa, ta, fb, tb, turns[k], moves[k], tolerance, pairs)
        turn, move = turns[k].T.copy(), -turns[k].T @ moves[k]
        blocked = _blocked(fb, ta, oa, turns[k], moves[k], tolerance) - met
        blocked += _blocked(fa, tb, ob, turn, move, tolerance) - met
        found[k] = met**power - BLOCKED_PENALTY * max(0, blocked) ** power
    return found


@njit(cache=True)
def met_flags(fa, ta, fb, tb, turns, moves, tolerance):
    """Which flanks of A and B meet, for many poses of B in A's frame; arguments as in `scores`.

    Returns
    -------
    met_a, met_b : (k, n) bool
    """
    met_a = np.zeros((len(turns), len(fa)), dtype=np.bool_)
    met_b = np.zeros((len(turns), len(fb)), dtype=np.bool_)
    pairs = np.empty((len(fb) + 1, 2), dtype=np.int64)
    for k in range(len(turns)):
        for i in range(meeting(fa, ta, fb, tb, turns[k], moves[k], MET_TOLERANCE * tolerance, pairs)):
            met_a[k, pairs[i, 0]] = True
            met_b[k, pairs[i, 1]] = True
    return met_a, met_b


@njit(cache=True)
def masks(fa, ta, oa, na, fb, tb, ob, nb, turns, moves, tolerance):
    """Which flanks of A and B meet, and which needed ones the other's material leaves no partner for; arguments as in `scores`.

    Parameters
    ----------
    na, nb : (n,) bool
        Which flanks are needed.

    Returns
    -------
    met_a, met_b, blocked_a, blocked_b : (k, n) bool
    """
    count = len(turns)
    met_a, met_b = met_flags(fa, ta, fb, tb, turns, moves, tolerance)
    blocked_a = np.zeros((count, len(fa)), dtype=np.bool_)
    blocked_b = np.zeros((count, len(fb)), dtype=np.bool_)
    for k in range(count):
        if abs(turns[k, 2, 2]) > MAX_SQUARE_COSINE:
            continue
        back, shift = turns[k].T.copy(), -turns[k].T @ moves[k]
        for j in range(len(fb)):
            if nb[j] and not met_b[k, j]:
                blocked_b[k, j] = _is_blocked(fb[j], ta, oa, turns[k], moves[k], tolerance)
        for i in range(len(fa)):
            if na[i] and not met_a[k, i]:
                blocked_a[k, i] = _is_blocked(fa[i], tb, ob, back, shift, tolerance)
    return met_a, met_b, blocked_a, blocked_b


@njit(cache=True)
def line_shifts(a, sense_a, needed_a, b, sense_b, needed_b, tolerance):
    """Shifts of flanks on one line along flanks on another at which some meet and no more contradict.

    Parameters
    ----------
    a, b : (n,) float64 [mm]
        Places along the line, ascending.
    sense_a, sense_b : (n,) float64
        On which side of the flank material lies; flanks that meet have opposite ones.
    needed_a, needed_b : (n,) bool
        Whether a flank contradicts where it meets nothing in the stretch that both lines share.
    tolerance : float [mm]
        Flanks meet when they are nearer than this.

    Returns
    -------
    (k,) float64 [mm]
        Ascending.
    """
    asked = np.empty(len(a) * len(b))
    count = 0
    for i in range(len(a)):
        for j in range(len(b)):
            if sense_a[i] * sense_b[j] < 0:
                asked[count] = a[i] - b[j]
                count += 1
    asked = np.sort(asked[:count])
    found = np.empty(count)
    kept = 0
    first = 0
    while first < count:
        last = first
        total = 0.0
        while last < count and asked[last] - asked[first] <= tolerance:
            total += asked[last]
            last += 1
        shift = total / (last - first)
        votes = _contradiction(a, sense_a, needed_a, b + shift, sense_b, tolerance)
        against = _contradiction(b + shift, sense_b, needed_b, a, sense_a, tolerance)
        if votes[0] > 0 and votes[1] + against[1] <= 2 * votes[0]:
            found[kept] = shift
            kept += 1
        first = last
    return found[:kept]


@njit(cache=True)
def _contradiction(a, sense_a, needed_a, b, sense_b, tolerance):
    """How many places of `a` meet one of `b`, and how many needed ones do not although `b` reaches beyond them."""
    met = against = 0
    j = 0
    for i in range(len(a)):
        while j < len(b) and b[j] < a[i] - tolerance:
            j += 1
        k = j
        partner = False
        while k < len(b) and b[k] <= a[i] + tolerance:
            if sense_a[i] * sense_b[k] < 0:
                partner = True
            k += 1
        if partner:
            met += 1
        elif needed_a[i] and b[0] - tolerance < a[i] < b[-1] + tolerance:
            against += 1
    return met, against


BLOCKED_PENALTY = 0.5
"""What a flank that can meet nothing any more takes off the score."""


@njit(cache=True)
def _blocked(flanks, thickness, outline, turn, move, tolerance):
    """How many flanks stand in the plane of another panel inside its filled outline; the pose is from theirs to its frame."""
    found = 0
    for j in range(len(flanks)):
        if _is_blocked(flanks[j], thickness, outline, turn, move, tolerance):
            found += 1
    return found


@njit(cache=True)
def _is_blocked(flank, thickness, outline, turn, move, tolerance):
    """Whether a flank stands in the plane of another panel inside its filled outline."""
    if abs(flank[6] - thickness) > LENGTH_TOLERANCE * thickness:
        return False
    x, y = flank[0], flank[1]
    if abs(turn[2, 0] * x + turn[2, 1] * y + move[2]) > tolerance:
        return False
    if abs(turn[2, 0] * flank[4] + turn[2, 1] * flank[5]) < MIN_UPRIGHT_COSINE:
        return False
    px = turn[0, 0] * x + turn[0, 1] * y + move[0]
    py = turn[1, 0] * x + turn[1, 1] * y + move[1]
    return _inside(outline, px, py)


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
    if abs(turn[2, 2]) > MAX_SQUARE_COSINE:
        return _meeting_askew(fa, ta, fb, tb, turn, move, tolerance, pairs)
    # Only flanks of A in the plane of B can meet one.
    near = np.empty(len(fa), dtype=np.int64)
    count = 0
    height = turn[0, 2] * move[0] + turn[1, 2] * move[1] + turn[2, 2] * move[2]
    for i in range(len(fa)):
        if abs(fa[i, 0] * turn[0, 2] + fa[i, 1] * turn[1, 2] - height) <= tolerance:
            near[count] = i
            count += 1
    found = 0
    for j in range(len(fb)):
        if count == 0:
            break
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
        for i in near[:count]:
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
def _meeting_askew(fa, ta, fb, tb, turn, move, tolerance, pairs):
    """The same for planes that are not square: fingers of both lie along the crossing line, a little behind it."""
    cosine = abs(turn[2, 2])
    if cosine > MAX_ASKEW_COSINE or abs(ta - tb) > 0.01 * ta:
        return 0
    sine = np.sqrt(1.0 - cosine * cosine)
    ex, ey = -turn[1, 2] / sine, turn[0, 2] / sine  # along the crossing line, in A's plane
    height = turn[0, 2] * move[0] + turn[1, 2] * move[1] + turn[2, 2] * move[2]
    found = 0
    for bend in (cosine, -cosine):
        length, back = finger_length(bend, ta), finger_setback(bend, ta)
        off = back * sine  # of a finger's middle from the other plate's middle plane
        for j in range(len(fb)):
            if abs(fb[j, 6] - length) > ASKEW_LENGTH_TOLERANCE * ta:
                continue
            x, y = fb[j, 0], fb[j, 1]
            if abs(abs(turn[2, 0] * x + turn[2, 1] * y + move[2]) - off) > tolerance:
                continue
            dx = turn[0, 0] * fb[j, 2] + turn[0, 1] * fb[j, 3]
            dy = turn[1, 0] * fb[j, 2] + turn[1, 1] * fb[j, 3]
            alignment = dx * ex + dy * ey
            if abs(alignment) < MIN_UPRIGHT_COSINE:
                continue
            px = turn[0, 0] * x + turn[0, 1] * y + move[0]
            py = turn[1, 0] * x + turn[1, 1] * y + move[1]
            best, nearest = -1, tolerance
            for i in range(len(fa)):
                if (
                    abs(fa[i, 6] - length) > ASKEW_LENGTH_TOLERANCE * ta
                    or (fa[i, 2] * ex + fa[i, 3] * ey) * alignment > 0
                ):
                    continue
                if abs(fa[i, 2] * ex + fa[i, 3] * ey) < MIN_UPRIGHT_COSINE:
                    continue
                if abs(abs(fa[i, 0] * turn[0, 2] + fa[i, 1] * turn[1, 2] - height) - off) > tolerance:
                    continue
                along = abs((fa[i, 0] - px) * ex + (fa[i, 1] - py) * ey)
                across = abs((fa[i, 1] - py) * ex - (fa[i, 0] - px) * ey)
                if along < nearest and across < 2.0 * abs(back) + 2.0 * tolerance:
                    best, nearest = i, along
            if best >= 0:
                taken = False
                for k in range(found):
                    if pairs[k, 0] == best:
                        taken = True
                if not taken and found < len(pairs):
                    pairs[found, 0], pairs[found, 1] = best, j
                    found += 1
    return found
