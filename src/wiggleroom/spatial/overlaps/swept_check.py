"""Whether a path is free: all parts, all pairs of their pieces, and every moment between two waypoints.

Nothing is taken from the program: axes are found anew, and between two moments a bound of the acceleration of corners, seen from the other
part, shows that the pieces stay apart, or the time between is halved.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.drawing.model import ConvexPiece
from wiggleroom.errors import Stop, is_asked
from wiggleroom.spatial.bodies.rotations import exponential, logarithm
from wiggleroom.spatial.overlaps.overlap_check import free_pairs
from wiggleroom.spatial.solids.separating_axis import candidate_axes, extent, separation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AT_ONCE = 2000
"""Boxes that are compared with all others together."""
MAX_HALVINGS = 14
"""The time between two waypoints is halved at most this many times."""


class SweptCheck:
    """Pieces of all parts about their reference points, ready to be swept.

    Parameters
    ----------
    assembly : Assembly
    """

    def __init__(self, assembly: Assembly) -> None:
        pieces: list[ConvexPiece] = []
        part: list[int] = []
        reference = assembly.reference
        for k, (p, made) in enumerate(zip(assembly.parts, assembly.solids, strict=True)):
            placed = [piece.placed(p.R, p.at - reference[k]) for piece in made.pieces]
            pieces += placed
            part += [k] * len(placed)
        self._reference, self._part = reference, np.array(part, dtype=np.int64)
        self._pieces_of = np.searchsorted(self._part, np.arange(len(reference)))
        self._pieces = pieces
        self._corners = np.vstack([p.corners for p in pieces])
        count = np.array([len(p.corners) for p in pieces])
        self._first, self._part_of_corner = np.cumsum(count) - count, np.repeat(self._part, count)
        self._radius = np.maximum.reduceat(np.linalg.norm(self._corners, axis=1), self._first)
        self._allowed = free_pairs(assembly)
        self._fixed = np.array([p.fixed for p in assembly.parts])

    def overlaps(self, start: Floats, end: Floats) -> bool:
        """True where parts may overlap between two motions (n, 6) [mm, rad].

        Positions of the reference points go straight, turns about one constant axis.
        """
        return bool(len(self.doubtful(start, end, first=True)))

    def doubtful(
        self,
        start: Floats,
        end: Floats,
        first: bool = False,
        only: Iterable[int] | None = None,
        stop: Stop | None = None,
    ) -> list[tuple[int, int]]:
        """Pairs of parts for which it is not certain that they stay apart between two motions.

        Where asked the first one is enough, and only pairs with exactly one of some parts are looked at. Once it was asked to stop all
        others are uncertain.
        """
        T0, T1 = self._reference + start[:, :3], self._reference + end[:, :3]
        R0, R1 = exponential(start[:, 3:]), exponential(end[:, 3:])
        turn = logarithm(np.einsum("nji,njk->nik", R0, R1))
        found: set[tuple[int, int]] = set()
        for (a, b), pieces in self._near(T0, T1, R0, R1, turn, only):
            if is_asked(stop):
                return self._all_pairs(only)
            if (a, b) in found:
                continue
            at = T0[a], T1[a], R0[a], turn[a], T0[b], T1[b], R0[b], turn[b]
            if any(is_asked(stop) or not self._stay_apart(i, j, at) for i, j in pieces.tolist()):
                found.add((a, b))
                if first:
                    break
        return sorted(found)

    def _all_pairs(self, only: Iterable[int] | None) -> list[tuple[int, int]]:
        """All pairs of parts that must stay apart; where asked, with exactly one of some."""
        one, other = np.triu_indices(len(self._reference), 1)
        keep = ~(self._fixed[one] & self._fixed[other])
        if only is not None:
            some = np.isin(np.arange(len(self._reference)), list(only))
            keep &= some[one] != some[other]
        pairs = zip(one[keep].tolist(), other[keep].tolist(), strict=True)
        return [pair for pair in pairs if pair not in self._allowed]

    def _stay_apart(self, i: int, j: int, at: tuple[Floats, ...]) -> bool:
        P, Q = self._pieces[i], self._pieces[j]
        return bool(stay_apart(P.corners, P.normals, P.edges, Q.corners, Q.normals, Q.edges, *at))

    def room(
        self, motion: Floats, only: Iterable[int], direction: Floats, most: float, stop: Stop | None = None
    ) -> float:
        """How far some parts can go along a direction (3,) from a motion (n, 6) before they meet others [mm]; `most` where further.

        0 where it was asked to stop before that was known.
        """
        ahead, mine = motion.copy(), np.zeros(len(motion), dtype=bool)
        mine[list(only)] = True
        ahead[mine, :3] += most * direction
        T, R = self._reference + motion[:, :3], exponential(motion[:, 3:])
        posed: dict[int, ConvexPiece] = {}
        near = self._near(T, self._reference + ahead[:, :3], R, R, np.zeros_like(T), np.flatnonzero(mine))
        for (a, b), pieces in near:
            toward = direction if mine[b] else -direction
            for i, j in pieces.tolist():
                if is_asked(stop):
                    return 0.0
                P, Q = (posed.setdefault(k, self._pieces[k].placed(R[p], T[p])) for k, p in ((i, a), (j, b)))
                far = free_distance(P.corners, P.normals, P.edges, Q.corners, Q.normals, Q.edges, toward)
                most = min(most, far)
        return most

    def _near(
        self, T0: Floats, T1: Floats, R0: Floats, R1: Floats, turn: Floats, only: Iterable[int] | None
    ) -> Iterator[tuple[tuple[int, int], Ints]]:
        """Two parts that must stay apart, and pairs of their pieces (k, 2) whose swept boxes meet; the same two may come again."""
        part = self._part
        angle = np.linalg.norm(turn, axis=1)[part]
        bulge = self._radius * (1 - np.cos(np.minimum(angle, np.pi) / 2))  # how far an arc leaves its chord
        owner = self._part_of_corner
        one, other = ((R[owner] @ self._corners[:, :, None])[:, :, 0] + T[owner] for T, R in ((T0, R0), (T1, R1)))
        low = np.minimum.reduceat(np.minimum(one, other), self._first) - bulge[:, None]
        high = np.maximum.reduceat(np.maximum(one, other), self._first) + bulge[:, None]
        parts = np.minimum.reduceat(low, self._pieces_of), np.maximum.reduceat(high, self._pieces_of)
        near = np.zeros(len(self._reference), dtype=bool)
        for pair, _ in self._meeting(*parts, np.arange(len(near)), only):
            near[list(pair)] = True
        rows = np.flatnonzero(near[part])
        yield from ((pair, rows[found]) for pair, found in self._meeting(low[rows], high[rows], part[rows], only))

    def _meeting(
        self, low: Floats, high: Floats, part: Ints, only: Iterable[int] | None
    ) -> Iterator[tuple[tuple[int, int], Ints]]:
        """Two parts that must stay apart, and pairs of their boxes (n, 3) that meet, sorted by parts, some boxes at a time."""
        import shapely

        some = np.isin(np.arange(len(self._reference)), [] if only is None else list(only))
        flat = shapely.box(*low[:, :2].T, *high[:, :2].T)
        tree = shapely.STRtree(flat)
        for k in range(0, len(flat), AT_ONCE):
            i, j = tree.query(flat[k : k + AT_ONCE])
            i += k
            a, b = part[i], part[j]
            keep = (a < b) & (low[i, 2] <= high[j, 2]) & (low[j, 2] <= high[i, 2]) & ~(self._fixed[a] & self._fixed[b])
            if only is not None:
                keep &= some[a] != some[b]
            order = np.flatnonzero(keep)[np.lexsort((j[keep], i[keep], b[keep], a[keep]))]
            changes = np.flatnonzero(np.diff(a[order]) | np.diff(b[order])) + 1
            for rows in np.split(order, changes) if len(order) else ():
                pair = int(a[rows[0]]), int(b[rows[0]])
                if pair not in self._allowed:
                    yield pair, np.column_stack([i[rows], j[rows]])


@njit(**OPTIONS)
def rotation(w, t):
    """Rotation matrix of t times the rotation vector w (3,)."""
    R = np.eye(3)
    angle = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if angle * t == 0.0:
        return R
    x, y, z = w[0] / angle, w[1] / angle, w[2] / angle
    s, h = np.sin(angle * t), np.sin(angle * t / 2)
    c = 2 * h * h
    R[0, 0], R[0, 1], R[0, 2] = 1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    R[1, 0], R[1, 1], R[1, 2] = c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x
    R[2, 0], R[2, 1], R[2, 2] = c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)
    return R


@njit(**OPTIONS)
def seen(V, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, t, with_shift):
    """Points or directions V (k, 3) of B at time t, in A's frame."""
    Ra, Rb = Ra0 @ rotation(wa, t), Rb0 @ rotation(wb, t)
    shift = np.zeros(3)
    if with_shift:
        shift = Ra.T @ (Tb0 + t * (Tb1 - Tb0) - Ta0 - t * (Ta1 - Ta0))
    Psi = Ra.T @ Rb
    out = np.empty_like(V)
    for k in range(len(V)):
        for i in range(3):
            out[k, i] = Psi[i, 0] * V[k, 0] + Psi[i, 1] * V[k, 1] + Psi[i, 2] * V[k, 2] + shift[i]
    return out


@njit(**OPTIONS)
def between(n, P, X):
    """Room between two sets of points along n [mm]."""
    top, bottom = -1e300, 1e300
    for k in range(len(P)):
        top = max(top, n[0] * P[k, 0] + n[1] * P[k, 1] + n[2] * P[k, 2])
    for k in range(len(X)):
        bottom = min(bottom, n[0] * X[k, 0] + n[1] * X[k, 1] + n[2] * X[k, 2])
    return bottom - top


@njit(**OPTIONS)
def free_distance(P, NP, EP, Q, NQ, EQ, direction):
    """How far the convex piece Q can go straight before it meets P [mm], both in one frame.

    Along each axis of the theorem of separating axes they overlap from one distance to another; they meet where they do along all.
    """
    enter, leave = 0.0, np.inf
    for x in candidate_axes(NP, EP, NQ, EQ):
        plow, phigh = extent(P, x)
        qlow, qhigh = extent(Q, x)
        speed = x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]
        if abs(speed) < 1e-12:
            if qlow >= phigh or qhigh <= plow:
                return np.inf
            continue
        one, two = (plow - qhigh) / speed, (phigh - qlow) / speed
        enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
        if enter >= leave:
            return np.inf
    return enter


@njit(**OPTIONS)
def least(g0, g1, bend):
    """Least value in [0, 1] of a function that is g0 and g1 at the ends and whose second derivative is at most `bend`."""
    low = min(g0, g1)
    if bend > 0.0:
        x = min(max(0.5 - (g1 - g0) / bend, 0.0), 1.0)
        low = min(low, g0 + x * (g1 - g0) - bend * x * (1 - x) / 2)
    return low


@njit(**OPTIONS)
def stay_apart(P, NP, EP, Q, NQ, EQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb):
    """True where two convex pieces are certainly apart at all times from 0 to 1.

    A's piece P and B's piece Q with normals and edges, each in its own frame; positions go straight from T0 to T1, turns from R0 by t w.
    On the time [s, e] a plane whose normal goes straight from the best axis at s to the best at e, seen from A, parts them if the room,
    which is known at both ends, cannot be used up between: corners of Q accelerate by at most
    ta^2 D + 2 ta c + (ta + tb)^2 r, and a normal that changes by dn adds 2 |dn| times their speed.
    """
    ta = np.sqrt(wa[0] ** 2 + wa[1] ** 2 + wa[2] ** 2)
    tb = np.sqrt(wb[0] ** 2 + wb[1] ** 2 + wb[2] ** 2)
    d0, d1 = Tb0 - Ta0, Tb1 - Ta1
    D = max(np.sqrt((d0**2).sum()), np.sqrt((d1**2).sum()))
    c = np.sqrt(((d1 - d0) ** 2).sum())
    r = 0.0
    for k in range(len(Q)):
        r = max(r, np.sqrt(Q[k, 0] ** 2 + Q[k, 1] ** 2 + Q[k, 2] ** 2))
    bend = ta * ta * D + 2 * ta * c + (ta + tb) ** 2 * r
    ends = np.empty((MAX_HALVINGS + 3, 2))
    axes = np.empty((MAX_HALVINGS + 3, 2, 3))
    n0, n1 = np.empty(3), np.empty(3)
    X0 = seen(Q, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 0.0, True)
    X1 = seen(Q, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 1.0, True)
    N, E = (
        seen(NQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 0.0, False),
        seen(EQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 0.0, False),
    )
    if separation(P, NP, EP, X0, N, E, n0) <= 0:
        return False
    N, E = (
        seen(NQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 1.0, False),
        seen(EQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, 1.0, False),
    )
    if separation(P, NP, EP, X1, N, E, n1) <= 0:
        return False
    ends[0, 0], ends[0, 1] = 0.0, 1.0
    axes[0, 0], axes[0, 1] = n0, n1
    top, n = 0, np.empty(3)
    while top >= 0:
        s, e = ends[top, 0], ends[top, 1]
        n0[:], n1[:] = axes[top, 0], axes[top, 1]
        span = e - s
        X0 = seen(Q, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, s, True)
        X1 = seen(Q, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, e, True)
        far = 0.0
        for k in range(len(Q)):
            far = max(far, np.sqrt(((X1[k] - X0[k]) ** 2).sum()))
        curve = bend * span * span
        dn = np.sqrt(((n1 - n0) ** 2).sum())
        if (
            least(between(n0, P, X0), between(n1, P, X1), curve + 2 * dn * (far + curve)) > 0
            or least(between(n0, P, X0), between(n0, P, X1), curve) > 0
            or least(between(n1, P, X0), between(n1, P, X1), curve) > 0
        ):
            top -= 1
            continue
        if span < 0.5**MAX_HALVINGS * 1.5:
            return False
        m = (s + e) / 2
        X = seen(Q, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, m, True)
        N = seen(NQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, m, False)
        E = seen(EQ, Ta0, Ta1, Ra0, wa, Tb0, Tb1, Rb0, wb, m, False)
        if separation(P, NP, EP, X, N, E, n) <= 0:
            return False
        ends[top + 1, 0], ends[top + 1, 1] = s, m
        axes[top + 1, 0], axes[top + 1, 1] = n0, n
        ends[top, 0] = m
        axes[top, 0] = n
        top += 1
    return True
