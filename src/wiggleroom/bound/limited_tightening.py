"""The linear relaxation of an assembly as a quick bound: solved and tightened as far as some work allows.

Work is counted from the size of programs, not timed, so that every machine gives the same answer; one unit is about a millisecond.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wiggleroom.bound.branch_and_bound import MANY_BODIES
from wiggleroom.bound.joint_constraints import JointConstraints, first_ranges, turn_differences
from wiggleroom.bound.joint_multipliers import goal_weights
from wiggleroom.bound.joint_ranges import InfeasibleRanges, RegionCuts
from wiggleroom.bound.neighbourhood_tightening import neighbourhood_cuts
from wiggleroom.bound.turn_tightening import Cutoff, Linkage, RelaxationInRanges, after_cuts, dominating
from wiggleroom.bound.window_bounds import bounded_windows
from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion
from wiggleroom.freespace.outer.outer_facets import COARSE_NORMALS
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.answer import PROVEN_WITHIN

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
