"""Local windows: small sub-assemblies in which turns are bounded against one of their bodies, whatever the rest does.

What joints of a few neighbours allow is less than what turns add up to along ways: rings of bodies have to close. So in every
motion of the whole, one body of a window turns against another one within a range that a small program finds, in which that other
one stands. Congruent windows share it, body by body: the range belongs to a pair of places in the window.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import JointConstraints, TurnDifferences
from wiggleroom.geometry.relative_pose import turn

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SPANS = (2, 4, 6)
"""Windows hold all shortest ways between two bodies so many joints apart."""
MAX_BODIES = 16
"""Larger windows cost more than they tell."""
CONGRUENCE_TOLERANCE = 1e-10
"""Windows are congruent where their bodies agree to this share of their radius; what that leaves open is `deviation`."""
ROUNDING_MARGIN = 1e-13
"""Lengths are worked out to this share."""


@dataclass(frozen=True, eq=False)
class Window:
    """Some bodies, one of which stands, and all places where the same ones lie in the same way.

    Parameters
    ----------
    bodies : (w,) int64
        The first one stands.
    joints : (k,) int64
        Joints between them.
    placements : (m, w) int64
        Bodies of every window congruent to this one, itself first.
    placed_joints : (m, k) int64
        Their joints.
    """

    bodies: Ints
    joints: Ints
    placements: Ints
    placed_joints: Ints


def windows(shape: Ints, rest: Floats, radius: Floats, joints: JointConstraints, span: int) -> Iterator[Window]:
    """Windows of a span whose joints form rings and that stand more than once, those that do so most often first.

    Bodies have a `shape` (n,) each and rest at `rest` (n, 3) [mm, mm, rad].
    """
    n = len(rest)
    near = _neighbours(n, joints)
    away = [_distances(near, k, span) for k in range(n)]
    number = {(int(a), int(b)): k for k, (a, b) in enumerate(zip(joints.a, joints.b, strict=True))}
    places = _Places(shape, rest, radius)
    done: set[tuple[int, ...]] = set()
    found: list[Window] = []
    for root in range(n):
        for end, d in away[root].items():
            if d != span:
                continue
            inside = sorted(
                (k for k, e in away[root].items() if k in away[end] and e + away[end][k] == span),
                key=lambda k: (away[root][k], k),
            )
            key = (root, *sorted(inside))
            own = [number[p] for p in ((a, b) for a in inside for b in near[a] if b in inside) if p in number]
            if key in done or len(inside) > MAX_BODIES or len(own) < len(inside) or len(inside) == n:
                continue
            made = _placed(places, np.array(inside), np.array(sorted(own)), joints, number)
            # what the last body turns against the first one the first one turns against the last one
            done |= {(int(row[k]), *sorted(row.tolist())) for row in made.placements for k in (0, -1)}
            if len(made.placements) > 1:
                found.append(made)
    return iter(sorted(found, key=lambda w: -len(w.placements)))


def _neighbours(n: int, joints: JointConstraints) -> list[list[int]]:
    near: list[list[int]] = [[] for _ in range(n)]
    for a, b in zip(joints.a.tolist(), joints.b.tolist(), strict=True):
        near[a].append(b)
        near[b].append(a)
    return near


def _distances(near: list[list[int]], start: int, most: int) -> dict[int, int]:
    """Bodies no more than so many joints away, and how many."""
    found, todo = {start: 0}, deque([start])
    while todo:
        k = todo.popleft()
        if found[k] < most:
            for other in near[k]:
                if other not in found:
                    found[other] = found[k] + 1
                    todo.append(other)
    return found


class _Places:
    """Bodies by shape and place."""

    def __init__(self, shape: Ints, rest: Floats, radius: Floats) -> None:
        from scipy.spatial import KDTree  # slow to load

        self.shape, self.rest = shape, rest
        self.near = CONGRUENCE_TOLERANCE * radius
        self.tree = KDTree(rest[:, :2])

    def moved(self, bodies: Ints, to: int) -> Ints | None:
        """The bodies that lie where some would lie if the first of them were moved onto another one; None where one is missing."""
        angle = float(self.rest[to, 2] - self.rest[bodies[0], 2])
        at = turn(self.rest[bodies, :2] - self.rest[bodies[0], :2], angle) + self.rest[to, :2]
        away, which = self.tree.query(at)
        same = (away <= self.near[bodies]) & (self.shape[which] == self.shape[bodies])
        turned = self.rest[which, 2] - self.rest[bodies, 2] - angle
        same &= np.abs(np.remainder(turned + np.pi, 2 * np.pi) - np.pi) <= CONGRUENCE_TOLERANCE
        return which.astype(np.int64) if same.all() else None


def _placed(
    places: _Places, bodies: Ints, own: Ints, joints: JointConstraints, number: dict[tuple[int, int], int]
) -> Window:
    """A window with all its placements."""
    rows, mine = [bodies], [own]
    place = {int(b): k for k, b in enumerate(bodies)}
    for other in np.flatnonzero(places.shape == places.shape[bodies[0]]):
        at = None if other == bodies[0] else places.moved(bodies, int(other))
        if at is None:
            continue
        found = [
            number.get((int(at[place[int(joints.a[p])]]), int(at[place[int(joints.b[p])]])), -1) for p in own.tolist()
        ]
        if min(found) >= 0 and (joints.kind[found] == joints.kind[own]).all():
            rows.append(at)
            mine.append(np.array(found))
    return Window(bodies, own, np.array(rows), np.array(mine))


def window_joints(window: Window, joints: JointConstraints) -> JointConstraints:
    """Joints of a window, its bodies numbered by their place in it."""
    place = {int(b): k for k, b in enumerate(window.bodies)}
    some = joints.some(window.joints)
    renamed = [np.array([place[int(k)] for k in v], dtype=np.int64) for v in (some.a, some.b)]
    return JointConstraints(renamed[0], renamed[1], some.kind, some.arm_a, some.arm_b, some.axes)


def window_turns(window: Window, turns: TurnDifferences) -> TurnDifferences:
    """What is known of turns between the bodies of a window: of its joints first."""
    place = {int(b): k for k, b in enumerate(window.bodies)}
    more = [
        k
        for k, (a, b) in enumerate(zip(turns.a.tolist(), turns.b.tolist(), strict=True))
        if a in place and b in place and k not in set(window.joints.tolist())
    ]
    which = np.concatenate([window.joints, np.array(more, dtype=np.int64)])
    a, b = (np.array([place[int(k)] for k in v[which]], dtype=np.int64) for v in (turns.a, turns.b))
    return TurnDifferences(a, b, turns.low[which], turns.high[which])


def deviation(window: Window, joints: JointConstraints, far: Floats) -> float:
    """How much the equations of a joint differ at most between congruent windows, each seen in the axes of its own first joint [mm].

    `far` (P,) is the largest motion of each joint's pivot [mm]. Congruent windows agree up to a tolerance only. A pivot at p from
    an origin moves by (R - 1) p: an arm that differs by d changes that by at most 2 d.
    """
    own, placed = window.joints, window.placed_joints
    angle = (joints.axes[placed[:, 0]] - joints.axes[own[0]])[:, None]
    away = np.abs(2 * np.sin((joints.axes[placed] - joints.axes[own] - angle) / 2)) * far[own]
    size = np.zeros(placed.shape)
    for arm in (joints.arm_a, joints.arm_b):
        away += 2 * np.hypot(*np.moveaxis(turn(arm[own], angle) - arm[placed], -1, 0))
        size += np.hypot(*arm[placed].T).T
    return float((away + ROUNDING_MARGIN * (size + far[own])).max())


def with_window(
    turns: TurnDifferences, joints: JointConstraints, window: Window, low: Floats, high: Floats
) -> TurnDifferences:
    """What is known of turns and, in every placement, the ranges (w,) of the window's bodies against its first one."""
    count = len(window.placements)
    a = np.repeat(window.placements[:, 0], len(window.bodies) - 1)
    b = window.placements[:, 1:].ravel()
    return merged(turns, len(joints.a), a, b, np.tile(low[1:], count), np.tile(high[1:], count))


def merged(turns: TurnDifferences, keep: int, a: Ints, b: Ints, low: Floats, high: Floats) -> TurnDifferences:
    """All of both, one for each pair of bodies; the first `keep` stay in their order and get narrower."""
    a, b = np.concatenate([turns.a, a]), np.concatenate([turns.b, b])
    low, high = np.concatenate([turns.low, low]), np.concatenate([turns.high, high])
    swap = a > b
    one, two = np.where(swap, b, a), np.where(swap, a, b)
    least, most = np.where(swap, -high, low), np.where(swap, -low, high)
    key = one * (int(max(a.max(), b.max())) + 1) + two
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    lowest, highest = np.full(len(first), -np.inf), np.full(len(first), np.inf)
    np.maximum.at(lowest, group, least)
    np.minimum.at(highest, group, most)
    every = np.concatenate([np.arange(keep), np.setdiff1d(first, np.arange(keep))])
    least, most, turned = lowest[group[every]], highest[group[every]], swap[every]
    return TurnDifferences(a[every], b[every], np.where(turned, -most, least), np.where(turned, -least, most))
