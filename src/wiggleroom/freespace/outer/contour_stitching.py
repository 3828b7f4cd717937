"""Joining two loops by tracks such that between neighbouring tracks one named pair of chords crosses at every angle."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import njit
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MAX_LOOP_CORNERS = 400
"""Corners of one loop at most: with more the surface would be slow to check."""
CORNER_TOLERANCE = 1e-5
"""Corners nearer than this share of their side are one."""


@dataclass(frozen=True, eq=False)
class Loop:
    """Closed polygon of translations `at` (n, 2) [mm] at one turn `angle` [rad]."""

    at: Floats
    angle: float


@dataclass(frozen=True, eq=False)
class Seam:
    """Tracks (k + 1, 2): corners of both loops, the last is the first again. Chords (k, 2) of A and B between them."""

    tracks: Ints
    chords: Ints

    def reversed(self) -> Seam:
        """The same seen from the second loop."""
        return Seam(self.tracks[:, ::-1], self.chords)


@dataclass(frozen=True, eq=False)
class Crossings:
    """Chords (n, 2, 2) of A and (m, 2, 2) of B [mm], B's as at rest."""

    a: Floats
    b: Floats

    def at(self, angle: float, low: Floats, high: Floats) -> Depths:
        """Where chords cross, for the pairs that cross somewhere in the box from `low` to `high`."""
        b = rotated(self.b.reshape(-1, 2), np.full(2 * len(self.b), angle)).reshape(-1, 2, 2)
        fits = np.ones((len(self.a), len(b)), dtype=bool)
        for k in (0, 1):
            fits &= self.a[:, None, :, k].min(2) - b[None, :, :, k].max(2) <= high[k]
            fits &= self.a[:, None, :, k].max(2) - b[None, :, :, k].min(2) >= low[k]
        i, j = np.nonzero(fits)
        return Depths(i, j, self.a[i], b[j])

    def both(self, one: float, two: float, low: Floats, high: Floats) -> tuple[Depths, Depths]:
        """The same pairs at two angles, those that cross somewhere in the box at both."""
        here, there = self.at(one, low, high), self.at(two, low, high)
        count = len(self.b)
        _, k, m = np.intersect1d(here.i * count + here.j, there.i * count + there.j, return_indices=True)
        return here.only(k), there.only(m)


@dataclass(frozen=True, eq=False)
class Depths:
    """Pairs of chords, and how deep inside the parallelogram of translations at which they cross something lies."""

    i: Ints
    j: Ints
    a: Floats
    b: Floats

    def forms(self) -> tuple[Floats, Floats]:
        """Normals (E, 4, 2) and levels (E, 4) [mm]: the chords cross where normal . tau + level > 0, all four."""
        go, on = self.a[:, 1] - self.a[:, 0], self.b[:, 1] - self.b[:, 0]
        size, length = np.hypot(*go.T), np.hypot(*on.T)
        orientation = self.orientation
        p, q = (orientation / size)[:, None] * go, (orientation / length)[:, None] * on
        left, right = np.column_stack([-p[:, 1], p[:, 0]]), np.column_stack([-q[:, 1], q[:, 0]])
        normal = np.stack([-left, left, -right, right], 1)
        level = np.stack(
            [
                -_cross(p, self.b[:, 0] - self.a[:, 0]),
                _cross(p, self.b[:, 1] - self.a[:, 0]),
                _cross(q, self.a[:, 0] - self.b[:, 0]),
                -_cross(q, self.a[:, 1] - self.b[:, 0]),
            ],
            1,
        )
        return normal, level

    @property
    def orientation(self) -> Floats:
        """1 where B's chord passes A's to the left, -1 to the right (E,)."""
        return np.where(_cross(self.a[:, 1] - self.a[:, 0], self.b[:, 1] - self.b[:, 0]) >= 0, 1.0, -1.0)

    def only(self, which: Ints | Bools) -> Depths:
        """Some of the pairs."""
        return Depths(self.i[which], self.j[which], self.a[which], self.b[which])


def _cross(p: Floats, q: Floats) -> Floats:
    return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]


def loop_of(crossings: Crossings, ring: Floats, angle: float, deep: float, few: bool) -> Loop | None:
    """Loop with corners added so that along each of its sides one pair of chords crosses, `deep` [mm]; None where there is no such pair.

    A loop of `few` corners changes from one pair to another as seldom as it can; else it has a corner wherever some pair begins or ends.
    """
    normal, level = crossings.at(angle, ring.min(0), ring.max(0)).forms()
    corners: list[Floats] = []
    for start, end in zip(ring, np.roll(ring, -1, 0), strict=True):
        enter, leave = _crossed(normal, level - deep, start, end)
        some = enter < leave
        enter, leave = enter[some], leave[some]
        share = _changes(enter, leave) if few else _breaks(enter, leave)
        if share is None or len(corners) + len(share) > MAX_LOOP_CORNERS:
            return None
        corners += [start + k * (end - start) for k in share]
    return Loop(np.array(corners), angle)


@njit(cache=True)
def _crossed(normal: Floats, level: Floats, start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Shares of a side between which each pair of chords (E,) crosses; it does not where the first is not less."""
    enter, leave = np.full(len(level), -np.inf), np.full(len(level), np.inf)
    for e in range(len(level)):
        for k in range(4):
            value = normal[e, k, 0] * start[0] + normal[e, k, 1] * start[1] + level[e, k]
            slope = normal[e, k, 0] * (end[0] - start[0]) + normal[e, k, 1] * (end[1] - start[1])
            if slope > 0:
                enter[e] = max(enter[e], -value / slope)
            elif slope < 0:
                leave[e] = min(leave[e], -value / slope)
            elif value <= 0:
                leave[e] = -np.inf
            if enter[e] >= leave[e] or enter[e] > 1 or leave[e] < 0:
                leave[e] = -np.inf
                break
    return enter, leave


def _changes(enter: Floats, leave: Floats) -> Floats | None:
    """Shares of a side where the fewest pairs that cross all along it take turns; None where some of it has no pair."""
    found, reached = [0.0], 0.0
    while True:
        here = np.flatnonzero(enter <= found[-1])
        best = here[leave[here].argmax()] if len(here) else -1
        if best < 0 or leave[best] <= reached:
            return None
        reached = leave[best]
        if reached >= 1:
            return np.array(found)
        # within what both cover, whoever goes furthest next
        nxt = np.flatnonzero((enter < reached) & (leave > reached))
        if not len(nxt):
            return None
        k = nxt[leave[nxt].argmax()]
        found.append(float((max(enter[k], found[-1]) + reached) / 2))


def _breaks(enter: Floats, leave: Floats) -> Floats | None:
    """Shares of a side where a pair begins or ceases to cross, and the middles between; None where some of it has no pair."""
    some = (enter < leave) & (enter < 1) & (leave > 0)
    enter, leave = enter[some].clip(0, 1), leave[some].clip(0, 1)
    reached = 0.0
    for k in np.argsort(enter):
        if enter[k] > reached:
            return None
        reached = max(reached, leave[k])
    if reached < 1:
        return None
    ends = np.unique(np.concatenate([[0.0, 1.0], enter, leave]))
    ends = ends[np.concatenate([[True], np.diff(ends) > CORNER_TOLERANCE])]
    return np.unique(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2]))[:-1]


def deepest(crossings: Crossings, loop: Loop, angle: float) -> Floats | None:
    """Translation (2,) [mm] at which, at another angle, the pairs that cross along a loop all cross as deep as they can."""
    from scipy.optimize import linprog  # slow to load

    low, high = loop.at.min(0), loop.at.max(0)
    here, there = crossings.both(loop.angle, angle, low, high)
    if not len(here.i):
        return None
    depth = _values(here, loop.at).min(2)
    best = np.unique(np.minimum(depth, np.roll(depth, -1, 0)).argmax(1))
    normal, level = (v.reshape(-1, *v.shape[2:]) for v in there.only(best).forms())
    box = [(low[0], high[0]), (low[1], high[1]), (None, None)]
    found = linprog([0, 0, -1], np.column_stack([-normal, np.ones(len(level))]), level, bounds=box)
    return found.x[:2] if found.success and found.x[2] > 0 else None


def stitched(crossings: Crossings, one: Loop, two: Loop) -> Seam | None:
    """Seam of two loops; None where none was found."""
    both = np.vstack([one.at, two.at])
    low, high = both.min(0), both.max(0)
    here, there = crossings.both(one.angle, two.angle, low, high)
    same = here.orientation == there.orientation
    here, there = here.only(same), there.only(same)
    if not len(here.i):
        return None
    first, second = _values(here, one.at), _values(there, two.at)  # (corners, E, 4)
    some = np.flatnonzero((first.min(2) > 0).any(0) & (second.min(2) > 0).any(0))
    if not len(some):
        return None
    holds = _tracks(here.only(some), first[:, some], second[:, some], one, two)
    steps = _walk(holds, one, two)
    if steps is None:
        return None
    m, n = len(one.at), len(two.at)
    tracks: Ints = np.array(steps) % np.array([m, n])
    pairs = [int(np.argmax(holds[tuple(here_at)] & holds[tuple(next_at)])) for here_at, next_at in pairwise(tracks)]
    return Seam(tracks, np.column_stack([here.i[some][pairs], here.j[some][pairs]]))


def _values(depths: Depths, at: Floats) -> Floats:
    normal, level = depths.forms()
    return (at @ normal.reshape(-1, 2).T).reshape(len(at), *level.shape) + level


def _tracks(depths: Depths, first: Floats, second: Floats, one: Loop, two: Loop) -> Bools:
    """Which pairs of chords cross all along the track from corner i of one loop to corner j of the other (m, n, E)."""
    width = abs(two.angle - one.angle)
    go = two.at[None] - one.at[:, None]
    long = np.hypot(go[..., 0], go[..., 1])
    on = depths.b[:, 1] - depths.b[:, 0]
    on = on / np.hypot(*on.T)[:, None]
    arm = np.hypot(depths.b[..., 0], depths.b[..., 1])  # (E, 2)
    reach = max(np.hypot(*p.at.T).max() for p in (one, two))
    far = np.hypot(depths.a[..., 0], depths.a[..., 1]) + reach
    slide = np.abs(go @ on.T)
    bend = width * width / 8
    holds = np.ones((len(one.at), len(two.at), len(on)), dtype=bool)
    for k in range(4):
        slip = width / 4 * (slide + width * long[..., None]) if k >= 2 else 0.0
        short = slip + bend * (far[:, k - 2] if k >= 2 else arm[:, k])
        holds &= np.minimum(first[:, None, :, k], second[None, :, :, k]) > 1.001 * short + 1e-13 * far.max()
    return holds


def _walk(holds: Bools, one: Loop, two: Loop) -> list[tuple[int, int]] | None:
    """Steps from track to track once round both loops."""
    m, n, _ = holds.shape
    packed = np.packbits(holds, axis=2)
    good: Bools = np.asarray(packed.any(2))
    away = np.hypot(*(two.at[None] - one.at[:, None]).transpose(2, 0, 1))
    for j0 in np.argsort(away[0])[:4]:
        if good[0, j0]:
            came = _cheapest(packed, good, away, int(j0))
            if came[m, n] >= 0:
                steps = [(m, n)]
                while steps[-1] != (0, 0):
                    (i, j), how = steps[-1], came[steps[-1]]
                    steps.append((i - int(how != 1), j - int(how != 0)))
                return [(i, int(j0) + j) for i, j in reversed(steps)]
    return None


@njit(cache=True)
def _cheapest(packed: NDArray[np.uint8], good: Bools, away: Floats, j0: int) -> Ints:
    """How each track was reached on the shortest path: by a step on the first loop (0), the second (1) or both (2); -1 where it was not."""
    m, n, size = packed.shape
    cost = np.full((m + 1, n + 1), np.inf)
    came = np.full((m + 1, n + 1), -1)
    cost[0, 0], came[0, 0] = 0.0, 2
    for i in range(m + 1):
        for j in range(n + 1):
            p, q = i % m, (j0 + j) % n
            if not good[p, q]:
                continue
            for how in range(3):
                k, l = i - (how != 1), j - (how != 0)  # noqa: E741
                if k < 0 or l < 0 or cost[k, l] + away[p, q] >= cost[i, j]:
                    continue
                r, s = k % m, (j0 + l) % n
                for e in range(size):
                    if packed[p, q, e] & packed[r, s, e]:
                        cost[i, j], came[i, j] = cost[k, l] + away[p, q], how
                        break
    return came
