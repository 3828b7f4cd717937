"""Local windows: small sub-assemblies in which turns are bounded against one of their bodies, whatever the rest does.

What joints of a few neighbours allow is less than what turns add up to along paths: rings of bodies have to close. So in every
motion of the whole, one body of a window turns against another one within a range that a small program finds, in which that other
one stands. Congruent windows share it, body by body: the range belongs to a pair of places in the window.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import JointConstraints, TurnDifferences
from wiggleroom.deadline import WorkBudget
from wiggleroom.errors import Stop
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SPANS, WIDE_SPANS = (2, 4, 6), (2, 4, 6, 8, 10)
"""A window holds all shortest paths between two bodies that are this many joints apart; the wide ones pay in very large assemblies."""
MAX_BODIES = 16
"""Of other windows than those that are square in a grid, larger ones cost more than they tell."""
CONGRUENCE_TOLERANCE = 1e-4
"""Windows are congruent where pivots agree to this share of the clearance; what that leaves open is `deviation`."""
ANGLE_TOLERANCE = 1e-6
"""The same for the angles of joints [rad]."""
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


def windows(
    place: Floats, joints: JointConstraints, clearance: float, span: int, stop: Stop | None = None
) -> list[Window]:
    """Windows of a span whose joints form rings, those that stand most often first; origins of bodies rest at `place` (n, 2) [mm].

    A request to `stop` ends the search with the windows found before.
    """
    stop = stop or WorkBudget()
    n = len(place)
    near = _neighbours(n, joints)
    number = {(int(a), int(b)): k for k, (a, b) in enumerate(zip(joints.a, joints.b, strict=True))}
    places = _Places(place, joints, CONGRUENCE_TOLERANCE * clearance)
    done: set[tuple[int, ...]] = set()
    found: list[Window] = []
    most = max(MAX_BODIES, (span // 2 + 1) ** 2)
    away: list[dict[int, int]] = []
    for k in range(n):
        if stop.is_set():
            return []
        away.append(_distances(near, k, span))
    for root in range(n):
        for end, d in away[root].items():
            if stop.is_set():
                return found
            if d != span:
                continue
            inside = sorted(
                (k for k, e in away[root].items() if k in away[end] and e + away[end][k] == span),
                key=lambda k: (away[root][k], k),
            )
            key = (root, *sorted(inside))
            if key in done or len(inside) > most or len(inside) == n:
                continue
            own = [number[p] for p in ((a, b) for a in inside for b in near[a] if b in inside) if p in number]
            if len(own) < len(inside):
                continue
            made = places.window(np.array(inside), np.array(sorted(own)))
            # what the last body turns against the first one the first one turns against the last one
            done |= {(int(row[k]), *sorted(row.tolist())) for row in made.placements for k in (0, -1)}
            found.append(made)
    return sorted(found, key=lambda w: -len(w.placements))


def _neighbours(n: int, joints: JointConstraints) -> list[list[int]]:
    near: list[list[int]] = [[] for _ in range(n)]
    for a, b in zip(joints.a.tolist(), joints.b.tolist(), strict=True):
        near[a].append(b)
        near[b].append(a)
    return near


def _distances(near: list[list[int]], start: int, most: int) -> dict[int, int]:
    """Bodies no more than `most` joints away, and how many joints that is."""
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
    """Joints by place: windows are congruent where their joints are, whatever the outlines of their bodies."""

    def __init__(self, place: Floats, joints: JointConstraints, tolerance: float) -> None:
        self.joints, self.tolerance = joints, tolerance
        self.pivot = place[joints.a] + joints.arm_a
        self.tree = shapely.STRtree(shapely.points(self.pivot))

    def window(self, bodies: Ints, own: Ints) -> Window:
        """A window of some bodies and their joints, with all its placements."""
        rows, mine = [bodies], [own]
        for found in self._joints_at(own):
            at = self._bodies_of(bodies, own, found)
            if at is not None:
                rows.append(at)
                mine.append(found)
        return Window(bodies, own, np.array(rows), np.array(mine))

    def _joints_at(self, own: Ints) -> Ints:
        """Joints (m, k) that lie elsewhere as `own` (k,) lie here: each row where they would lie if the first were moved onto another."""
        axes, kind = self.joints.axes, self.joints.kind
        first = np.flatnonzero(kind == kind[own[0]])
        first = first[first != own[0]]
        angle = axes[first] - axes[own[0]]
        found = first[:, None]
        for joint in own[1:].tolist():  # what lacks one is not looked at any further
            at = rotated(self.pivot[joint] - self.pivot[own[0]], angle) + self.pivot[found[:, 0]]
            (_, which), away = self.tree.query_nearest(shapely.points(at), return_distance=True, all_matches=False)
            turned = np.remainder(axes[which] - axes[joint] - angle + np.pi, 2 * np.pi) - np.pi
            same = (away <= self.tolerance) & (kind[which] == kind[joint]) & (np.abs(turned) <= ANGLE_TOLERANCE)
            found, angle = np.column_stack([found, which])[same], angle[same]
        return np.asarray(found, dtype=np.int64)

    def _bodies_of(self, bodies: Ints, own: Ints, found: Ints) -> Ints | None:
        """The bodies (w,) that joints `found` join as the joints `own` do `bodies`; None where they join others."""
        other: dict[int, int] = {}
        for end in (self.joints.a, self.joints.b):
            for one, two in zip(end[own].tolist(), end[found].tolist(), strict=True):
                if other.setdefault(one, two) != two:
                    return None
        return np.array([other[k] for k in bodies.tolist()]) if len(set(other.values())) == len(bodies) else None


def _arms(window: Window, joints: JointConstraints, which: Ints) -> tuple[Floats, Floats]:
    """Arms (k, 2) of the window's joints, or of those `which` (k,) that stand for them, from the first pivot of each body in the window.

    So it does not matter where bodies have their origin, which their outlines decide.
    """
    own, arms = window.joints, []
    first: dict[int, Floats] = {}
    for p, q in zip(own.tolist(), which.tolist(), strict=True):
        first.setdefault(int(joints.a[p]), joints.arm_a[q])
        first.setdefault(int(joints.b[p]), joints.arm_b[q])
    for end, arm in ((joints.a, joints.arm_a), (joints.b, joints.arm_b)):
        arms.append(arm[which] - np.array([first[int(k)] for k in end[own]]))
    return arms[0], arms[1]


def window_joints(window: Window, joints: JointConstraints) -> JointConstraints:
    """Joints of a window, its bodies numbered by their place in it, their origins where their first pivots are."""
    place = {int(b): k for k, b in enumerate(window.bodies)}
    some = joints.some(window.joints)
    renamed = [np.array([place[int(k)] for k in v], dtype=np.int64) for v in (some.a, some.b)]
    return JointConstraints(renamed[0], renamed[1], some.kind, *_arms(window, joints, window.joints), some.axes)


def window_turns(window: Window, turns: TurnDifferences) -> TurnDifferences:
    """What is known of turns between bodies of a window in all its placements: of its joints first.

    What only some placements know, from neighbours that others lack, does not count: the window's ranges hold in all of them.
    """
    mine = window.placed_joints
    n = int(max(turns.a.max(), turns.b.max(), window.placements.max())) + 1
    swap = turns.a > turns.b
    key = np.where(swap, turns.b * n + turns.a, turns.a * n + turns.b)
    order = np.argsort(key)
    one, two = np.triu_indices(len(window.bodies), 1)
    a, b = window.placements[:, one], window.placements[:, two]
    wanted = np.minimum(a, b) * n + np.maximum(a, b)
    found = order[np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)]
    more = (key[found] == wanted).all(0) & ~np.isin(found[0], mine[0])
    found, other = found[:, more], swap[found[:, more]] != (a > b)[:, more]
    low = np.where(other, -turns.high[found], turns.low[found]).min(0)
    high = np.where(other, -turns.low[found], turns.high[found]).max(0)
    place = {int(k): i for i, k in enumerate(window.bodies)}
    ends = [np.array([place[int(k)] for k in v[mine[0]]], dtype=np.int64) for v in (turns.a, turns.b)]
    return TurnDifferences(
        np.concatenate([ends[0], one[more]]),
        np.concatenate([ends[1], two[more]]),
        np.concatenate([turns.low[mine].min(0), low]),
        np.concatenate([turns.high[mine].max(0), high]),
    )


def deviation(window: Window, joints: JointConstraints, far: Floats) -> float:
    """How much the equations of a joint differ at most between congruent windows, each seen in the axes of its own first joint [mm].

    `far` (P,) is the largest motion of each joint's pivot [mm]. Congruent windows agree up to a tolerance only. A pivot at p from
    an origin moves by (R - 1) p: an arm that differs by d changes that by at most 2 d.
    """
    own, most = window.joints, 0.0
    size = np.hypot(*joints.arm_a.T) + np.hypot(*joints.arm_b.T)
    arms = _arms(window, joints, own)
    for placed in window.placed_joints:
        angle = float(joints.axes[placed[0]] - joints.axes[own[0]])
        away = np.abs(2 * np.sin((joints.axes[placed] - joints.axes[own] - angle) / 2)) * far[own]
        for arm, other in zip(arms, _arms(window, joints, placed), strict=True):
            away += 2 * np.hypot(*(rotated(arm, angle) - other).T)
        # of an arm, and of the one to the first pivot that is taken from it
        rounded = 2 * (size[own].max() + size[placed].max()) + far[own]
        most = max(most, float((away + ROUNDING_MARGIN * rounded).max()))
    return most


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
