"""Cells of relative poses of two bodies, and the cover of those that may be reached from rest (compiled).

A cell is a box of translations times a box on one of four cubes of quaternions: the quaternion whose component f is 1 and whose three
others are in the box, made a unit. The four cubes hold every rotation once, and meet each other at their faces. A cell is blocked where two
convex pieces overlap at all its poses: their Minkowski difference at the middle, worn away by the box in which corners move within
the cell, still holds the origin. What is not blocked counts as free.

Source: approximate cell decomposition, Brooks and Lozano-Pérez 1983; that no path exists, Zhang, Kim and Manocha, "Efficient cell
labelling and path non-existence computation using C-obstacle query" (2008); cubes of quaternions, LaValle, "Planning Algorithms",
section 4.2.2.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import OPTIONS, njit

OPEN, BLOCKED, REACHED, SPLIT = 0, 1, 2, 3
"""States of a cell."""
CLOSED, LEAVES, SPENT, PAUSED = 0, 1, 2, 3
"""How a cover ended: with no way on, outside the box of translations, without room for more cells, or to go on."""
PARTS = 3
"""A cell is split into so many: rest is the middle of the first, and stays the middle of one."""
FACES = 12
BEYOND = 1e-10
"""A neighbour is looked for so far beyond a face, as a share of the width of everything."""
PARALLEL_EDGES = 1e-8
DEPTH = 4096
"""Most cells of the tree that wait while those at a face are looked for: far more than its depth times those of a split."""


@njit(**OPTIONS)
def rotation_of(q):
    """Rotation matrix (3, 3) of a unit quaternion (4,)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    R = np.empty((3, 3))
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


@njit(**OPTIONS)
def quaternion_of(cube, c, q):
    """The unit quaternion of a point c (3,) of a cube."""
    j = 0
    length = 1.0
    for k in range(4):
        if k == cube:
            q[k] = 1.0
        else:
            q[k] = c[j]
            length += c[j] * c[j]
            j += 1
    q /= np.sqrt(length)


@njit(**OPTIONS)
def turned_within(cube, low, high, q0, turn):
    """Largest components of the rotation vectors [rad], in the body's frame, from the middle q0 of a cell to any rotation in it.

    Tangents of half of them are quotients of linear functions: they are largest at a corner of the cell.
    """
    q, c = np.empty(4), np.empty(3)
    turn[:] = 0.0
    for corner in range(8):
        for k in range(3):
            c[k] = high[3 + k] if (corner >> k) & 1 else low[3 + k]
        quaternion_of(cube, c, q)
        w = q0[0] * q[0] + q0[1] * q[1] + q0[2] * q[2] + q0[3] * q[3]
        x = q0[0] * q[1] - q0[1] * q[0] - q0[2] * q[3] + q0[3] * q[2]
        y = q0[0] * q[2] + q0[1] * q[3] - q0[2] * q[0] - q0[3] * q[1]
        z = q0[0] * q[3] - q0[1] * q[2] + q0[2] * q[1] - q0[3] * q[0]
        if w <= 0.0:
            turn[:] = np.pi
            return
        turn[0] = max(turn[0], 2 * abs(x / w))
        turn[1] = max(turn[1], 2 * abs(y / w))
        turn[2] = max(turn[2], 2 * abs(z / w))
    for k in range(3):
        turn[k] = min(turn[k], np.pi)


@njit(**OPTIONS)
def turn_along(cube, low, high, axis, q0, turn):
    """Components of the rotation vector [rad] from the middle q0 of a cell to the middle of its side across one axis of the cube."""
    q, c = np.empty(4), np.empty(3)
    for k in range(3):
        c[k] = (low[3 + k] + high[3 + k]) / 2
    c[axis] = high[3 + axis]
    quaternion_of(cube, c, q)
    turn[0] = 2 * abs(q0[0] * q[1] - q0[1] * q[0] - q0[2] * q[3] + q0[3] * q[2])
    turn[1] = 2 * abs(q0[0] * q[2] + q0[1] * q[3] - q0[2] * q[0] - q0[3] * q[1])
    turn[2] = 2 * abs(q0[0] * q[3] - q0[1] * q[2] + q0[2] * q[1] - q0[3] * q[0])


@njit(**OPTIONS)
def worn_overlap(P, NP, EP, Q, NQ, EQ, T, R, half, shift, above, axis):
    """Depth [mm] by which the pieces P and Q, Q turned by R and moved by T, overlap at all poses of a cell, less than 0 where not sure.

    `half` (3,) is half the box of translations, `shift` (3,) the box in which corners of Q move by turns, in its frame. The deepest axis is
    written to `axis`. Looked for only as long as it may be more than `above`.
    """
    nf, ng, ne = len(NP), len(NQ), len(EQ)
    n, m, e, f = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    least = 1e300
    for t in range(nf + ng + len(EP) * ne):
        if t < nf:
            n[:] = NP[t]
        elif t < nf + ng:
            m[:] = NQ[t - nf]
            for i in range(3):
                n[i] = R[i, 0] * m[0] + R[i, 1] * m[1] + R[i, 2] * m[2]
        else:
            e[:] = EP[(t - nf - ng) // ne]
            m[:] = EQ[(t - nf - ng) % ne]
            for i in range(3):
                f[i] = R[i, 0] * m[0] + R[i, 1] * m[1] + R[i, 2] * m[2]
            n[0] = e[1] * f[2] - e[2] * f[1]
            n[1] = e[2] * f[0] - e[0] * f[2]
            n[2] = e[0] * f[1] - e[1] * f[0]
            length = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
            if length < PARALLEL_EDGES:
                continue
            n /= length
        for i in range(3):
            m[i] = R[0, i] * n[0] + R[1, i] * n[1] + R[2, i] * n[2]
        at = n[0] * T[0] + n[1] * T[1] + n[2] * T[2]
        plow, phigh, qlow, qhigh = 1e300, -1e300, 1e300, -1e300
        for i in range(len(P)):
            s = P[i, 0] * n[0] + P[i, 1] * n[1] + P[i, 2] * n[2]
            plow, phigh = min(plow, s), max(phigh, s)
        for i in range(len(Q)):
            s = Q[i, 0] * m[0] + Q[i, 1] * m[1] + Q[i, 2] * m[2] + at
            qlow, qhigh = min(qlow, s), max(qhigh, s)
        worn = min(phigh - qlow, qhigh - plow)
        for i in range(3):
            worn -= abs(n[i]) * half[i] + abs(m[i]) * shift[i]
        if worn < least:
            least = worn
            axis[:] = n
            if least <= above:
                break
    return least


@njit(**OPTIONS)
def beyond_face(cube, low, high, side, half_box, box):
    """Write the box (12,) of poses just beyond a face of a cell, lower then upper ends; the cube in which they lie.

    Across the edge of a cube they lie in that of the component which becomes 1: a quaternion and its negative are one rotation.
    """
    k, up = side // 2, side % 2
    width = BEYOND * (half_box if k < 3 else 1.0)
    for d in range(6):
        inset = 10 * BEYOND * (high[d] - low[d])
        box[d], box[6 + d] = low[d] + inset, high[d] - inset
    edge = high[k] if up else low[k]
    if k < 3 or abs(edge) < 1 - width:
        box[k] = edge + width if up else edge - 2 * width
        box[6 + k] = edge + 2 * width if up else edge - width
        return cube
    sign = 1.0 if up else -1.0
    other = k - 3 if k - 3 < cube else k - 2
    for component in range(4):
        if component == other:
            continue
        d = 3 + (component if component < other else component - 1)
        if component == cube:
            one, two = sign * (1 - 2 * width), sign * (1 - width)
        else:
            source = 3 + (component if component < cube else component - 1)
            inset = 10 * BEYOND * (high[source] - low[source])
            one, two = sign * (low[source] + inset), sign * (high[source] - inset)
        box[d], box[6 + d] = min(one, two), max(one, two)
    return other


@njit(**OPTIONS)
def push(far, faces, count, distance, face):
    """Add a face to the heap of those that lie farthest out first; how many it holds."""
    k = count
    while k > 0:
        up = (k - 1) // 2
        if far[up] >= distance:
            break
        far[k], faces[k] = far[up], faces[up]
        k = up
    far[k], faces[k] = distance, face
    return count + 1


@njit(**OPTIONS)
def pop(far, faces, count):
    """Take away the first face of the heap; how many it still holds."""
    count -= 1
    distance, face = far[count], faces[count]
    k = 0
    while 2 * k + 1 < count:
        down = 2 * k + 1
        if down + 1 < count and far[down + 1] > far[down]:
            down += 1
        if distance >= far[down]:
            break
        far[k], faces[k] = far[down], faces[down]
        k = down
    far[k], faces[k] = distance, face
    return count


@njit(**OPTIONS)
def corner_shifts(turn, reach, shift):
    """Largest components (3,) [mm] of how far corners move, none further out than `reach` (3,), by rotation vectors within `turn` (3,).

    Rodrigues: R v - v = sin(t) / t w x v + (1 - cos(t)) / t^2 w x (w x v), where t = |w|; the factors are at most 1 and 1/2.
    """
    for j in range(3):
        i, k = (j + 1) % 3, (j + 2) % 3
        first = turn[i] * reach[k] + turn[k] * reach[i]
        second = turn[j] * (turn[i] * reach[i] + turn[k] * reach[k]) + reach[j] * (turn[i] ** 2 + turn[k] ** 2)
        shift[j] = first + second / 2


@njit(**OPTIONS)
def worn_by_pair(A, B, pair, T, R, half, turn, above, axis):
    """Overlap [mm] of a pair (2,) of packed pieces at all poses of a cell, see `worn_overlap`."""
    PC, PN, PE, pc, pn, pe, _, _, _ = A
    QC, QN, QE, qc, qn, qe, _, _, Qa = B
    i, j = pair[0], pair[1]
    shift = np.empty(3)
    corner_shifts(turn, Qa[j], shift)
    return worn_overlap(
        PC[pc[i] : pc[i + 1]], PN[pn[i] : pn[i + 1]], PE[pe[i] : pe[i + 1]],
        QC[qc[j] : qc[j + 1]], QN[qn[j] : qn[j + 1]], QE[qe[j] : qe[j + 1]], T, R, half, shift, above, axis,
    )  # fmt: skip


@njit(**OPTIONS)
def gains(B, j, cube, low, high, q0, R, half, axis, gain):
    """What the overlap of B's piece j along an axis (3,) loses across each axis of a cell: gain (6,) [mm]."""
    m, turn, shift = np.empty(3), np.empty(3), np.empty(3)
    for i in range(3):
        m[i] = abs(R[0, i] * axis[0] + R[1, i] * axis[1] + R[2, i] * axis[2])
        gain[i] = abs(axis[i]) * half[i]
    for d in range(3):
        turn_along(cube, low, high, d, q0, turn)
        corner_shifts(turn, B[8][j], shift)
        gain[3 + d] = m[0] * shift[0] + m[1] * shift[1] + m[2] * shift[2]


@njit(**OPTIONS)
def deepest_pair(A, B, allowed, T, R, half, turn, margin, last, axis):
    """Overlap [mm] at all poses of a cell of the pair of pieces that overlaps most, or of one by more than `margin`.

    A and B are packed pieces, `last` (2,) is the pair looked at first and becomes the one found; `axis` (3,) is where it overlaps least.
    """
    Pm, Pr, Qm, Qr = A[6], A[7], B[6], B[7]
    pair_now, tried = np.empty(2, dtype=np.int64), np.empty(3)
    best, first, count = -1e300, last[0] * len(Qm) + last[1], len(Pm) * len(Qm)
    for pair in range(-1, count):
        which = first if pair < 0 else pair
        i, j = which // len(Qm), which % len(Qm)
        if not allowed[i, j]:
            continue
        far = 0.0
        for k in range(3):
            c = R[k, 0] * Qm[j, 0] + R[k, 1] * Qm[j, 1] + R[k, 2] * Qm[j, 2] + T[k] - Pm[i, k]
            far += c * c
        if Pr[i] + Qr[j] - np.sqrt(far) <= best:
            continue
        pair_now[0], pair_now[1] = i, j
        worn = worn_by_pair(A, B, pair_now, T, R, half, turn, best, tried)
        if worn > best:
            best = worn
            last[0], last[1] = i, j
            axis[:] = tried
            if best > margin:
                break
    return best


@njit(**OPTIONS)
def cover(A, B, allowed, round_body, half_box, free_width, blocked_width, margin, tree, heap, counts, visits):
    """Go on covering the poses of B against A that may be reached from rest; how that ended.

    Parameters
    ----------
    A, B : packed pieces
        B's in its own frame, A's in the same frame at rest.
    allowed : (p, q) bool
        Pairs of pieces that block each other.
    round_body : bool
        B lies in itself however it turns about z: such turns are left out.
    half_box : float [mm]
        Bodies that lie further from rest along an axis are apart.
    free_width, blocked_width : float [mm]
        Cells are split until that is what they gain: those whose middle seems free, and those whose middle is blocked.
    margin : float [mm]
        An overlap is deeper: more than rounding, and than edges that count as parallel, may hide of bodies of that reach.
    tree : low (n, 6), high (n, 6), cube (n,), first child (n,), state (n,)
    heap : (12 n,) float64, (12 n,) int64
        Faces that are left to look beyond, as cell times 12 plus side, and how far out they are.
    counts : (4,) int64
        Cells, faces in the heap, and the pair of pieces that was last the deepest; all zero at the begin.
    visits : int
        Cells to look at before it pauses.
    """
    low, high, cube, kids, state = tree
    far, faces = heap
    most = len(cube)
    T, half, c, q0, turn, axis, gain = (
        np.empty(3), np.empty(3), np.empty(3), np.empty(4), np.empty(3), np.empty(3), np.empty(6),
    )  # fmt: skip
    none = np.zeros(3)
    box, waiting, last = np.empty(12), np.empty(DEPTH, dtype=np.int64), counts[2:4]
    if counts[0] == 0:
        for f in range(4):
            cube[f], kids[f], state[f] = f, -1, OPEN
            low[f, :3], high[f, :3], low[f, 3:], high[f, 3:] = -half_box, half_box, -1.0, 1.0
            if round_body:
                low[f, 5], high[f, 5] = 0.0, 0.0
        counts[0] = 4
        counts[1] = push(far, faces, 0, 0.0, -1)
    while counts[1] > 0:
        if visits <= 0:
            return PAUSED
        face = faces[0]
        counts[1] = pop(far, faces, counts[1])
        if face < 0:  # rest
            box[:] = 0.0
            waiting[0] = 0
        else:
            n = face // FACES
            waiting[0] = beyond_face(cube[n], low[n], high[n], face % FACES, half_box, box)
        top = 1
        while top > 0:
            top -= 1
            n = waiting[top]
            meets = state[n] == OPEN or state[n] == SPLIT
            for k in range(6):
                meets = meets and low[n, k] <= box[6 + k] and high[n, k] >= box[k]
            if not meets:
                continue
            if state[n] == SPLIT:
                for k in range(PARTS):
                    waiting[top + k] = kids[n] + k
                top += PARTS
                continue
            visits -= 1
            for k in range(3):
                T[k], half[k] = (low[n, k] + high[n, k]) / 2, (high[n, k] - low[n, k]) / 2
                c[k] = (low[n, 3 + k] + high[n, 3 + k]) / 2
            quaternion_of(cube[n], c, q0)
            R = rotation_of(q0)
            turned_within(cube[n], low[n], high[n], q0, turn)
            worn = deepest_pair(A, B, allowed, T, R, half, turn, margin, last, axis)
            if worn > margin:
                state[n] = BLOCKED
                continue
            gains(B, last[1], cube[n], low[n], high[n], q0, R, half, axis, gain)
            at_middle = worn + gain.sum()
            wide = blocked_width if at_middle > 0 else free_width
            if gain.max() <= wide or at_middle + gain.sum() <= 0:
                # it may be blocked by pieces that are deeper at the middle, and lose more on the way to the sides
                at_middle = deepest_pair(A, B, allowed, T, R, none, none, np.inf, last, axis)
                if at_middle > 0:
                    worn_by_pair(A, B, last, T, R, half, turn, -1e300, axis)
                gains(B, last[1], cube[n], low[n], high[n], q0, R, half, axis, gain)
                wide = blocked_width if at_middle > 0 else free_width
            k = int(gain.argmax())
            if gain[k] > wide and at_middle + gain.sum() > 0:
                y = counts[0]
                if y + PARTS > most:
                    return SPENT
                step = (high[n, k] - low[n, k]) / PARTS
                for part in range(PARTS):
                    low[y + part], high[y + part] = low[n], high[n]
                    cube[y + part], kids[y + part], state[y + part] = cube[n], -1, OPEN
                    if part > 0:
                        low[y + part, k] = low[n, k] + part * step
                        high[y + part - 1, k] = low[y + part, k]
                    waiting[top + part] = y + part
                kids[n], state[n] = y, SPLIT
                counts[0] += PARTS
                top += PARTS
                continue
            state[n] = REACHED
            distance = 0.0
            for k in range(3):
                distance = max(distance, abs(T[k]))
                if high[n, k] >= half_box or low[n, k] <= -half_box:
                    return LEAVES
            if round_body and cube[n] > 0 and low[n, 3] <= 0.0 and high[n, 3] >= 0.0:
                return LEAVES  # upside down, where turns about all axes meet
            for side in range(FACES - 2 if round_body else FACES):
                counts[1] = push(far, faces, counts[1], distance, n * FACES + side)
    return CLOSED
