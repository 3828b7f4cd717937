"""Quick upper bound by weak duality: the contact forces of the motion found serve as multipliers.

At the end of a search forces balance on every body. With the force w and the moment m that each pair of bodies holds there,

    what is asked = what is asked - sum of w . E + sum of m (phi - t_b + t_a),

as E = x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) p - R(t_a) tau vanishes (arms p, q to the pivot of a pair, tau and phi its relative
motion). As forces balance, all shifts x drop out. What is left falls into a part alpha cos t + beta sin t + gamma t of each body, whose
largest value over the range of its turn is known, and a part w . R(t_a) tau + m phi of each pair, whose largest value over its
pocket is taken at a corner. Any forces give a valid bound, and those of the true optimum a near one. It is the whole bound where a
linear program would take longer than the search did; else that comes nearer, see `tightened`.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.bound.branch_and_bound import MANY_BODIES
from wiggleroom.bound.congruent_joints import CONGRUENCE_TOLERANCE, CONGRUENCE_WORK, Congruence, KnownJoints
from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints, first_ranges, turn_differences
from wiggleroom.bound.joint_multipliers import goal_weights
from wiggleroom.bound.joint_ranges import InfeasibleRanges, RegionCuts
from wiggleroom.bound.neighbourhood_tightening import neighbourhood_cuts
from wiggleroom.bound.outer_regions import JointPlacement, links_about, material_of, placement
from wiggleroom.bound.trigonometric_envelopes import support
from wiggleroom.bound.turn_tightening import Cutoff, Linkage, RelaxationInRanges, after_cuts, dominating
from wiggleroom.bound.window_bounds import bounded_windows
from wiggleroom.deadline import WorkBudget
from wiggleroom.errors import Stop
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion, NearSides, local_outer_region
from wiggleroom.freespace.outer.outer_facets import COARSE_NORMALS
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.answer import MAX_BOUND_RATIO, PROVEN_WITHIN, Answer, Bound, with_bound
from wiggleroom.search.incumbent import Incumbent

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ACTIVE_MULTIPLIER, MAX_OMITTED_FORCE = 1e-7, 0.01
"""Pairs count with at least this share of the largest force; with that share of all forces they must have a pocket."""
MANY_JOINTS = 60
"""Where so many pairs, those with the largest forces, each had a joint of its own, all others are taken to have one too."""
ROUNDING_MARGIN = 1e-11
"""The bound is larger by this share of all that it is summed up from."""

PROVEN = PROVEN_WITHIN - 1
"""A bound that lies no further above the motion found than this share proves it."""
NEAR = 0.03
"""One no further above it than this share is near enough, where another round would not prove it."""
MANY_NEAR = 0.1
"""The same where there are many bodies."""
HOPS = 2
"""Turns of bodies this many joints apart are tightened."""
MIN_GAIN = 0.1
"""It ends where the bound's distance from the motion found falls by less than this share."""


def with_quick_bound(answer: Answer, stop: Stop | None = None, least_work: float = 0.0) -> Answer:
    """The answer with a bound, where that says something and takes less work than the answer did, or than `least_work`.

    It is worked out once, if not asked to stop.
    """
    began = time.perf_counter()
    found: Incumbent | None = answer.warm_start
    told = answer.bound is not None and answer.bound.at_most is not None
    if told or "bound" in answer.seconds or not answer.objective or not answer.verdict.ends:
        return answer
    if found is None or not isinstance(found.program.objective, PointMotion):
        return answer
    # where outlines were searched with fewer corners, the bound is about those that were drawn
    drawn = None if answer.bound is None else bodies(answer.assembly)
    work = max(least_work, work_of_search(answer, found))
    if drawn is not None:
        work += _work_of_corners(drawn, found.program.cells.a, found.program.cells.b)
    most = quick_bound(found, found.program.objective, work, drawn, WorkBudget(stop=stop))
    spent = time.perf_counter() - began
    seconds = {k: v for k, v in answer.seconds.items() if k != "total"} | {"bound": spent}
    seconds["total"] = answer.seconds["total"] + spent
    if most is None or not answer.objective <= most <= MAX_BOUND_RATIO * answer.objective:
        return replace(answer, seconds=seconds)
    bound = Bound(most, most / answer.objective - 1, spent, kind="quick")
    return with_bound(replace(answer, seconds=seconds), bound)


def with_bound_by_work(answer: Answer, work: float, stop: Stop | None = None) -> Answer:
    """The answer with the best bound that some work finds, or until one is near enough; the same where there is none or one already.

    Of large assemblies small windows are looked at first, which takes seconds.
    """
    began = time.perf_counter()
    found: Incumbent | None = answer.warm_start
    known = answer.bound is not None and answer.bound.at_most is not None
    if known or not answer.objective or not answer.verdict.ends or found is None:
        return answer
    if not isinstance(found.program.objective, PointMotion):
        return answer
    drawn = None if answer.bound is None else bodies(answer.assembly)
    most = quick_bound(found, found.program.objective, np.inf, drawn, WorkBudget(work, stop))
    if stop is not None and stop.is_set():
        return answer
    if most is None or not answer.objective <= most <= MAX_BOUND_RATIO * answer.objective:
        return answer
    return with_bound(answer, Bound(most, most / answer.objective - 1, time.perf_counter() - began, kind="quick"))


def quick_bound(
    found: Incumbent, goal: PointMotion, work: float, drawn: Bodies | None = None, budget: WorkBudget | None = None
) -> float | None:
    """Value that no motion exceeds, from the end of a search; None where it would take too long, joints do not close or it is to stop.

    It is about the bodies that were searched, or about others, `drawn`, that lie at the same places. It may cost some `work`, about as
    many milliseconds; infinite where only the `budget` ends it.
    """
    budget = budget or WorkBudget()
    them, cells = drawn or found.program.bodies, found.program.cells
    wrench = _wrenches(found)
    force = np.hypot(wrench[:, 0], wrench[:, 1])
    first, label = congruence_classes(
        them, cells.a, cells.b, relative_pose(them, cells.a, cells.b), CONGRUENCE_TOLERANCE
    )
    by_class = np.bincount(label, force, len(first))
    wanted = np.argsort(-by_class)[: np.count_nonzero(by_class > ACTIVE_MULTIPLIER * by_class.max())]
    known_joints, pivots = KnownJoints(), np.zeros((len(first), 2))
    held: list[Congruence] = []
    near: list[NearSides] = []
    all_work = work
    for c in wanted:
        if budget.spend(CONGRUENCE_WORK):
            return None
        a, b = int(cells.a[first[c]]), int(cells.b[first[c]])
        geometry = placed(them, only=np.array([a, b]))
        material, pivots[c], _ = material_of(them, geometry, a, b, float(shapely.distance(geometry[a], geometry[b])))
        held.append(known_joints.congruence(material))
        work -= CONGRUENCE_WORK
        if held[-1].joint == len(near):
            near.append(NearSides(known_joints.joints[-1].strips))
            work -= near[-1].work
        if work < 0 or (
            len(held) == len(near) == MANY_JOINTS and work < (len(wanted) / MANY_JOINTS - 1) * (all_work - work)
        ):
            return None
    joints = known_joints.joints
    carried = np.bincount([one.joint for one in held], by_class[wanted], len(joints)) / by_class.sum()
    made: list[LocalOuterRegion | None] = []
    for sides, share in zip(near, carried, strict=True):
        if budget.spend(sides.work):
            return None
        made.append(local_outer_region(sides))
        if made[-1] is None and share > MAX_OMITTED_FORCE:
            return None
    pockets = [m for m in made if m is not None]
    number = np.cumsum([m is not None for m in made]) - 1
    kind = np.full(len(first), -1, dtype=np.int64)
    places: dict[int, JointPlacement] = {}
    for c, one in zip(wanted.tolist(), held, strict=True):
        if made[one.joint] is not None:
            kind[c] = number[one.joint]
            places[c] = placement(them, int(cells.a[first[c]]), int(cells.b[first[c]]), pivots[c], one)
    known = np.flatnonzero(kind[label] >= 0)
    label = label[known]
    links = links_about(them, cells.a[known], cells.b[known], kind[label], [places[c] for c in label.tolist()])
    ranges = first_ranges(them.fixed, links, pockets)
    forces = _forces_of(them, links, cells.a[known], cells.b[known], wrench[known], found.motion)
    most = _value(them, goal, links, pockets, ranges, forces, found.motion)
    if most is None or found.value <= 0 or find_spec("highspy") is None:
        return most
    from wiggleroom.bound.dual_bound import tightened  # slow to import, and not always needed

    return min(most, tightened(them, goal, links, pockets, found.value, work, budget))


def _wrenches(found: Incumbent) -> Floats:
    """Forces and moments (P, 3) with which every pair of the program pushes its second body from the first, in the axes of the first."""
    program = found.program
    at = program.linearise(found.solution.u)
    out = np.zeros((len(program.cells.a), 3))
    np.add.at(out, program.cells.pair, at.d * found.solution.lam[:, None])
    return out


def _forces_of(them: Bodies, links: JointConstraints, a: Ints, b: Ints, wrench: Floats, motion: Floats) -> Floats:
    """Forces and moments (P, 3) about the pivots of links, in the world's axes, from wrenches (P, 3) of pairs `a` and `b` (P,)."""
    pose = them.rest + motion
    point = pose[links.b, :2] + rotated(links.arm_b, motion[links.b, 2])
    w = rotated(-wrench[:, :2], pose[a, 2])
    moment = -wrench[:, 2] + _cross(pose[b, :2] - point, w)
    sign = np.where(links.a == a, 1.0, -1.0)
    return sign[:, None] * np.column_stack([w, moment])


def _value(
    them: Bodies,
    goal: PointMotion,
    links: JointConstraints,
    pockets: Sequence[LocalOuterRegion],
    ranges: AngleRanges,
    forces: Floats,
    motion: Floats,
) -> float | None:
    """What follows from forces and moments (P, 3) of the links, about a motion (n, 3) [mm, mm, rad].

    None where something counts that nothing holds.
    """
    a, b = links.a, links.b
    pose, turned = them.rest + motion, motion[:, 2]
    arm = rotated(links.arm_b, turned[b])
    tau = rotated(pose[b, :2] + arm - pose[a, :2], -turned[a]) - links.arm_a  # in the world's axes at rest
    w, moment = forces[:, :2], forces[:, 2]
    force = rotated(w, -links.axes - turned[a])
    parts = _Parts(len(motion))
    parts.add(goal.body, goal.direction, goal.arm, goal.turn)
    parts.add(b, -w, links.arm_b, -moment)
    parts.add(a, w, links.arm_a + tau, moment)
    counts = ~them.fixed & parts.some
    if not np.isfinite(ranges.far[counts]).all():
        return None
    terms = [(w * tau).sum(1), *parts.most(np.flatnonzero(counts), ranges)]
    # R(t_a) is taken at the motion's own turn; it errs by at most |tau - tau there| times this
    swing = np.where(them.fixed[a], 0.0, np.maximum(ranges.high[a] - turned[a], turned[a] - ranges.low[a]))
    astray = np.hypot(*w.T) * 2 * np.sin(np.minimum(swing, np.pi) / 2)
    own = rotated(tau, -links.axes)
    for kind, region in enumerate(pockets):
        mine = np.flatnonzero(links.kind == kind)
        away = region.corner[:, None, :2] - own[mine]
        gain = (away * force[mine]).sum(2) + region.corner[:, 2:] * moment[mine]
        terms.append((gain + astray[mine] * np.hypot(away[..., 0], away[..., 1])).max(0))
        # corners are rounded
        terms.append(
            4 * region.material.margin * (np.hypot(*w[mine].T) + np.abs(moment[mine]) / region.material.radius)
        )
    size = float(
        np.abs(links.arm_a).max(initial=0.0)
        + np.abs(links.arm_b).max(initial=0.0)
        + ranges.far[counts].max(initial=0.0)
    )
    everything = np.hypot(*w.T).sum() * size + np.abs(moment).sum() + sum(np.abs(t).sum() for t in terms)
    return float(sum(t.sum() for t in terms) + ROUNDING_MARGIN * everything)


class _Parts:
    """Of each body: weights of its shift, and of cos t - 1, sin t and t."""

    def __init__(self, n: int) -> None:
        self.shift, self.weight = np.zeros((n, 2)), np.zeros((n, 3))

    def add(self, body: Ints, force: Floats, arm: Floats, moment: Floats) -> None:
        """Add force . (shift + (R(t) - 1) arm) + moment t."""
        np.add.at(self.shift, body, force)
        np.add.at(self.weight, body, np.column_stack([(force * arm).sum(1), _cross(arm, force), moment]))

    @property
    def some(self) -> NDArray[np.bool_]:
        """Bodies that count at all."""
        return (self.shift != 0).any(1) | (self.weight != 0).any(1)

    def most(self, body: Ints, ranges: AngleRanges) -> list[Floats]:
        """Largest values within the ranges: of the turns, and of what is left of the shifts."""
        low, high = ranges.low[body], ranges.high[body]
        middle, half = (low + high) / 2, (high - low) / 2 * (1 + 1e-15) + 1e-15
        alpha, beta, gamma = self.weight[body].T
        c, s = np.cos(middle), np.sin(middle)
        top = support(alpha * c + beta * s, beta * c - alpha * s, gamma, half) + gamma * middle - alpha
        return [top, np.hypot(*self.shift[body].T) * ranges.far[body] * np.sqrt(2)]


def _cross(p: Floats, q: Floats) -> Floats:
    return np.asarray(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])


# -- what it may cost ------------------------------------------------------------------------------------------------
# Work is counted, not timed, so that every machine gives the same answer; one unit is about a millisecond.


def work_of_search(answer: Answer, found: Incumbent) -> float:
    """Rather less than the search took: cells of pairs with many rows are grown slowly, in every round."""
    rows, pairs = found.program.rows, len(found.program.cells.a)
    return 14 + answer.iterations * (0.8 + 1.5e-4 * rows) + 5e-5 * answer.rounds * rows * rows / max(pairs, 1)


def _work_of_corners(them: Bodies, a: Ints, b: Ints) -> float:
    """Rather less than a search takes to choose among the contacts of pairs of many corners."""
    corners = np.diff(them.shapes.first)
    return float(0.01 * (corners[them.shape[a]] + corners[them.shape[b]]).sum())


def tightened(
    them: Bodies,
    goal: PointMotion,
    joints: JointConstraints,
    regions: Sequence[LocalOuterRegion],
    found: float,
    work: float,
    budget: WorkBudget,
) -> float:
    """Value that no motion exceeds, near `found`, the value of a motion; infinite where the work does not allow a program at all.

    Where the work is infinite and bodies are many, local windows come first, and neighbourhoods are tightened.
    """
    held = them.fixed | np.isfinite(first_ranges(them.fixed, joints, regions).far)
    joints = joints.some(held[joints.a] & held[joints.b])
    linkage = Linkage(
        them.fixed,
        them.radius,
        them.rest[:, :2],
        joints,
        turn_differences(joints, regions),
        min((region.material.clearance for region in regions), default=1.0),
    )
    cuts = RegionCuts([*regions])
    large = int(np.count_nonzero(held)) > MANY_BODIES
    many = large and bool(np.isinf(work))
    if many:
        cuts.unlike = COARSE_NORMALS
        for known, _ in bounded_windows(linkage, cuts, budget):
            linkage = known
    ranges = first_ranges(them.fixed, joints, regions, linkage.turns)
    weights = goal_weights(goal, len(held))
    cutoff = Cutoff(weights, (1 + PROVEN / 2) * found)
    bodies = np.flatnonzero(held & ~them.fixed)
    asked, near = dominating(linkage, bodies, HOPS), MANY_NEAR if many else NEAR
    first, again = _work_of_program(len(bodies), len(joints.a))
    best = np.inf
    while work >= first and not budget.is_set():
        try:
            program = RelaxationInRanges(linkage, cuts, ranges)
        except InfeasibleRanges:
            return cutoff.worth
        work -= first + 2 * len(asked) * again
        last = large and work < first  # nothing goes on from its basis
        value, multipliers, *_ = program.largest(weights, budget, interior=many or last)
        most = max(value, cutoff.worth if np.isfinite(best) else -np.inf)
        gain = (best - most) / (best - found) if np.isfinite(best) else 1.0
        best = min(best, most)
        away = best / found - 1
        hopeful = not many and away * (1 - gain) <= PROVEN  # falls by the same share again
        near_enough = away <= PROVEN or (away <= near and not hopeful)
        if near_enough or gain < MIN_GAIN or work < first or budget.is_set():
            break
        new = (
            neighbourhood_cuts(program, multipliers, asked, cutoff, budget)
            if many
            else program.turn_cuts(asked, cutoff, budget)
        )
        ranges = after_cuts(ranges, new, linkage.turns)
        if np.any(ranges.low > ranges.high):
            return cutoff.worth
    return float(best)


def _work_of_program(bodies: int, joints: int) -> tuple[float, float]:
    """Rather more than a linear program takes when it is solved first, and when it is asked again with another cost."""
    first = 80 * ((5 * bodies + 4 * joints) / 340) ** 2.1
    return first, 0.6 * first
