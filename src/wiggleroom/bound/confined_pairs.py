"""Pairs that do not close round each other, but are kept near by what holds their bodies elsewhere: parts side by side in a tray.

Every body that a joint holds to something fixed stays in a box of shifts and a range of turns. Two such bodies confine each other: their
relative motion stays in the difference of both boxes, and inside it the walls between them cut off what they cannot reach. With these walls
a linear program knows better how far the pair can get, so the box shrinks, more walls hold, and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.bound.congruent_joints import Congruence
from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints, turn_differences
from wiggleroom.bound.joint_ranges import InfeasibleRanges, RegionCuts
from wiggleroom.bound.outer_regions import PAIR_WORK, JointPlacement, links_about, material_of, placement
from wiggleroom.bound.turn_tightening import Linkage, RelaxationInRanges, after_cuts
from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.outer_region import Confinement, OuterRegion, confined_region
from wiggleroom.freespace.outer.outer_slices import PairMaterial
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MAX_ROUNDS = 8
"""Number of times boxes shrink, at most."""
MIN_SHRINKAGE = 0.1
"""A region is worked out again where its box loses this share of its width, height or turns."""
MAX_CONFINED_TURN = 1.0
"""Pairs that can turn further against each other [rad] are left out: hardly a wall holds at all these turns."""


@dataclass(frozen=True, eq=False)
class ShiftBoxes:
    """Where the origins of bodies can be.

    Parameters
    ----------
    low, high : (n, 2) float64 [mm]
        Least and greatest shift since rest along the world's axes; infinite where nothing is known.
    """

    low: Floats
    high: Floats


def shift_boxes(
    fixed: Bools, joints: JointConstraints, regions: Sequence[OuterRegion], ranges: AngleRanges
) -> ShiftBoxes:
    """Boxes of all bodies: from the joints that hold them to fixed ones, and from how far they get at most."""
    far = np.where(fixed, 0.0, ranges.far)[:, None]
    low, high = np.repeat(-far, 2, axis=1), np.repeat(far, 2, axis=1)
    for k in np.flatnonzero(fixed[joints.a] != fixed[joints.b]).tolist():
        a, b = int(joints.a[k]), int(joints.b[k])
        body, arm, sign = (b, joints.arm_b[k], 1.0) if fixed[a] else (a, joints.arm_a[k], -1.0)
        region = regions[int(joints.kind[k])]
        tau = sign * rotated(region.corner[:, :2], np.full(len(region.corner), joints.axes[k]))
        # the pivot's shift; seen from a body that turns itself, it lies in axes that have turned
        slack = _swing(np.zeros(2), ranges, body) if fixed[a] else _swing(np.abs(tau).max(0), ranges, body)
        slack = slack + _swing(arm, ranges, body) + 4 * region.material.margin
        low[body] = np.maximum(low[body], tau.min(0) - slack)
        high[body] = np.minimum(high[body], tau.max(0) + slack)
    return ShiftBoxes(low, high)


def _swing(arm: Floats, ranges: AngleRanges, body: int) -> Floats:
    """Largest change along x and y (2,) [mm] of an arm that turns with a body."""
    widest = min(max(-float(ranges.low[body]), float(ranges.high[body])), np.pi)
    across, back = np.sin(min(widest, np.pi / 2)), 1 - np.cos(widest)
    x, y = np.abs(arm)
    return np.array([back * x + across * y, back * y + across * x])


@dataclass(frozen=True, eq=False)
class _OpenPair:
    """Neighbours that no joint keeps together; `link` is the joint that they would have, alone."""

    a: int
    b: int
    material: PairMaterial
    lever: float
    place: JointPlacement
    link: JointConstraints


def _open_pairs(surveyed: Survey, joints: JointConstraints, known: Bools, budget: WorkBudget) -> list[_OpenPair]:
    """Neighbours that are known to stay somewhere, and have no region yet."""
    them, near = surveyed.bodies, surveyed.near
    closed = {frozenset(pair) for pair in zip(joints.a.tolist(), joints.b.tolist(), strict=True)}
    found = []
    for a, b, clearance in zip(near.a.tolist(), near.b.tolist(), near.clearance.tolist(), strict=True):
        if frozenset((a, b)) in closed or not (known[a] and known[b]) or budget.spend(PAIR_WORK):
            continue
        material, pivot, lever = material_of(them, surveyed.geometry, a, b, clearance)
        place = placement(them, a, b, pivot, Congruence(0, False, 0.0, np.zeros(2)))
        link = links_about(them, np.array([a]), np.array([b]), np.zeros(1, dtype=np.int64), [place])
        found.append(_OpenPair(a, b, material, lever, place, link))
    return found


def _confinement(pair: _OpenPair, least: Floats, most: Floats, ranges: AngleRanges) -> Confinement | None:
    """From the least and greatest shift (2,) of the pivot along the world's axes; None where the pair can turn too far for it to help."""
    turns = float(ranges.low[pair.b] - ranges.high[pair.a]), float(ranges.high[pair.b] - ranges.low[pair.a])
    if not max(-turns[0], turns[1]) <= MAX_CONFINED_TURN:
        return None
    # seen in the axes of the first body, which turns too
    slack = _swing(np.maximum(np.abs(least), np.abs(most)), ranges, pair.a) + 4 * pair.material.margin
    box = shapely.box(*(least - slack), *(most + slack))
    axes = float(pair.link.axes[0])
    return Confinement(shapely.transform(box, lambda p: rotated(p, np.full(len(p), -axes))), *turns)


def _first_shift(pair: _OpenPair, boxes: ShiftBoxes, ranges: AngleRanges) -> tuple[Floats, Floats]:
    """Least and greatest shift (2,) of the pivot of B against that of A, from both boxes."""
    slack = _swing(pair.link.arm_a[0], ranges, pair.a) + _swing(pair.link.arm_b[0], ranges, pair.b)
    return boxes.low[pair.b] - boxes.high[pair.a] - slack, boxes.high[pair.b] - boxes.low[pair.a] + slack


def _proven_shift(
    pair: _OpenPair, program: RelaxationInRanges, fixed: Bools, budget: WorkBudget
) -> tuple[Floats, Floats]:
    """The same, from the linear program."""
    ends = []
    for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        weights = np.zeros((len(fixed), 5))
        for body, (p, q), sign in ((pair.b, pair.link.arm_b[0], 1.0), (pair.a, pair.link.arm_a[0], -1.0)):
            if not fixed[body]:
                weights[body] = sign * np.array([x, y, x * p + y * q, y * p - x * q, 0.0])
        ends.append(np.inf if budget.is_set() else program.largest(weights.ravel(), budget)[0])
    return -np.array(ends[2:]), np.array(ends[:2])


def _joined(
    surveyed: Survey,
    joints: JointConstraints,
    regions: Sequence[OuterRegion],
    found: Sequence[tuple[_OpenPair, OuterRegion]],
) -> tuple[JointConstraints, list[OuterRegion]]:
    """Joints and regions with those of some pairs."""
    if not found:
        return joints, list(regions)
    pairs = [pair for pair, _ in found]
    one, two = np.array([(pair.a, pair.b) for pair in pairs], dtype=np.int64).T
    more = links_about(surveyed.bodies, one, two, len(regions) + np.arange(len(found)), [pair.place for pair in pairs])
    both = {name: np.concatenate([getattr(joints, name), getattr(more, name)]) for name in vars(joints)}
    return JointConstraints(**both), [*regions, *(region for _, region in found)]


def confined_pairs(
    surveyed: Survey,
    joints: JointConstraints,
    regions: Sequence[OuterRegion],
    ranges: AngleRanges,
    budget: WorkBudget,
) -> tuple[JointConstraints, list[OuterRegion], AngleRanges]:
    """The joints and regions, and those of neighbours that other joints keep near each other, as far as the budget goes.

    The ranges are narrower where that is found on the way.
    """
    them = surveyed.bodies
    fixed = them.fixed
    ranges = replace(ranges, low=np.where(fixed, 0.0, ranges.low), high=np.where(fixed, 0.0, ranges.high))
    known = np.isfinite(np.where(fixed, 0.0, ranges.far)) & np.isfinite(ranges.high - ranges.low)
    joints = joints.some(known[joints.a] & known[joints.b])  # parts that fly off together bound nothing
    pairs = _open_pairs(surveyed, joints, known, budget)
    boxes = shift_boxes(fixed, joints, regions, ranges)
    shifts = [_first_shift(pair, boxes, ranges) for pair in pairs]
    found: dict[int, OuterRegion] = {}
    all_joints, all_regions = joints, list(regions)
    for _ in range(MAX_ROUNDS):
        changed = False
        for k, pair in enumerate(pairs):
            confinement = _confinement(pair, *shifts[k], ranges)
            if (
                confinement is None
                or budget.is_set()
                or (k in found and not _shrunk(found[k].confinement, confinement))
            ):
                continue
            region = confined_region(pair.material, pair.lever, confinement, budget)
            if region is not None:
                found[k] = region
                changed = True
        if not changed or budget.is_set():
            break
        all_joints, all_regions = _joined(surveyed, joints, regions, [(pairs[k], found[k]) for k in sorted(found)])
        turns = turn_differences(all_joints, all_regions)
        linkage = Linkage(fixed, them.radius, them.rest[:, :2], all_joints, turns, surveyed.clearance)
        try:
            program = RelaxationInRanges(linkage, RegionCuts([*all_regions]), ranges)
        except InfeasibleRanges:  # rest is always there: rounding
            break
        for k, pair in enumerate(pairs):
            least, most = _proven_shift(pair, program, fixed, budget)
            shifts[k] = np.maximum(shifts[k][0], least), np.minimum(shifts[k][1], most)
        cuts = program.turn_cuts(np.flatnonzero(known & ~fixed), None, budget)
        ranges = after_cuts(ranges, cuts, turns)
    return all_joints, all_regions, ranges


def _shrunk(before: Confinement | None, after: Confinement) -> bool:
    """Whether a confinement is so much smaller than before that its region is worth working out again."""
    if before is None:
        return True
    old, new = (
        np.array([*np.ptp(np.reshape(c.translations.bounds, (2, 2)), axis=0), c.high - c.low]) for c in (before, after)
    )
    return bool((new < (1 - MIN_SHRINKAGE) * old).any())
