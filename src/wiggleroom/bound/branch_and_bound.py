"""Branch and bound from outer regions: tighten, refine and split until nothing above the motion found is left, or the work is spent.

The relaxation is asked for its best value. Then the range of every body's turn is cut to what motions worth at least `cut`, a little more
than the witness, can have. That makes the relaxation tighter, again and again. At first only some bodies are asked about, the
others follow from what is known of turns between them. Intervals of turns of regions that hold it up are made narrower. Where
it stalls, the range of the turn that errs most is halved, and both halves go on for themselves; the bound is the larger of theirs.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import (
    AngleRanges,
    JointConstraints,
    first_ranges,
    narrowed,
    turn_differences,
)
from wiggleroom.bound.joint_multipliers import goal_weights
from wiggleroom.bound.joint_ranges import InfeasibleRanges, RegionCuts
from wiggleroom.bound.local_windows import SPANS, WIDE_SPANS
from wiggleroom.bound.neighbourhood_tightening import neighbourhood_cuts
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.bound.turn_tightening import Cutoff, Linkage, RelaxationInRanges, after_cuts, dominating
from wiggleroom.bound.window_bounds import WindowProof, bounded_windows
from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.outer_facets import COARSE_NORMALS, FINE_NORMALS, intervals_at_facets
from wiggleroom.freespace.outer.outer_region import REFINEMENT_FACTOR, OuterRegion, slice_work, with_narrower_intervals
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINEST_BLUR = 0.004
"""Intervals of turns are made narrower until they blur by this share of the clearance."""
ACTIVE_MULTIPLIER = 1e-3
"""A facet is active where its multiplier is at least this share of the largest."""
MIN_REDUCTION = 0.1
"""A sweep that cuts no turn, nor the bound's distance from `cut`, by this share leads to narrower intervals or to a split."""
MAX_PROOF_DEPTH = 200
"""Most steps after each other in a proof that is kept: where there are more, the regions are too large."""
MANY_BODIES = 60
"""With more bodies than this local windows pay, and only some bodies are asked about at first."""
WINDOWS_SHARE = 0.4
"""They may take this share of the work that is left: where few of them are congruent there are very many."""
MAX_WHOLE_BODIES = 300
"""With more bodies than this programs of the whole take too long, and turns are tightened a neighbourhood at a time."""
FIRST_HOPS, MIN_GAIN = 2, 0.5
"""Joints between bodies asked about at first; nearer ones are asked where the bound's distance from `cut` falls by less than this share."""


@dataclass(eq=False)
class BranchAndBound:
    """State of the loop: outer regions, and the ranges of turns that may still hold motions worth more than `cut`.

    Parameters
    ----------
    surveyed : Survey
    joints : JointConstraints
    regions : list
    goal : PointMotion
    cut : float
        Motions worth less do not matter.
    budget : WorkBudget
    tell : callable
        Told the bound so far and what is being done.
    proof : ProofNode, optional
        Where the proof is kept.
    windows : list of WindowProof
        What local windows have shown.
    """

    surveyed: Survey
    joints: JointConstraints
    regions: list[OuterRegion | CagingSurface]
    goal: PointMotion
    cut: float
    budget: WorkBudget
    tell: Callable[[float, str], None]
    proof: ProofNode | None = None
    windows: list[WindowProof] = field(default_factory=list)

    def __post_init__(self) -> None:
        bodies = self.surveyed.bodies
        held = bodies.fixed | np.isfinite(first_ranges(bodies.fixed, self.joints, self.regions).far)
        self.joints = self.joints.some(held[self.joints.a] & held[self.joints.b])
        self.cuts = RegionCuts([*self.regions])
        self.linkage = Linkage(
            bodies.fixed,
            bodies.radius,
            bodies.rest[:, :2],
            self.joints,
            turn_differences(self.joints, self.regions),
            self.surveyed.clearance,
        )
        self.weights = goal_weights(self.goal, len(bodies.fixed))
        self.cutoff = Cutoff(self.weights, self.cut)

    def first(self) -> AngleRanges:
        """Ranges at the start, after a look at local windows where there are many bodies."""
        bodies = self.surveyed.bodies
        ranges = first_ranges(bodies.fixed, self.joints, self.regions, self.linkage.turns)
        held = int(np.isfinite(ranges.far).sum())
        if held > MANY_BODIES:
            self.cuts.unlike = COARSE_NORMALS
            spans = WIDE_SPANS if held > MAX_WHOLE_BODIES else SPANS
            for linkage, proof in bounded_windows(self.linkage, self.cuts, self.budget.part(WINDOWS_SHARE), spans):
                self.linkage = linkage
                self.windows.append(proof)
                self.tell(np.nan, f"windows of {len(proof.window.bodies)} bodies")
            ranges = first_ranges(bodies.fixed, self.joints, self.regions, self.linkage.turns)
        return ranges

    def relaxed(self, ranges: AngleRanges) -> float:
        """Value that no motion within `ranges` exceeds, from one linear program."""
        self.cuts.unlike = COARSE_NORMALS
        try:
            return RelaxationInRanges(self.linkage, self.cuts, ranges).largest(self.weights, self.budget)[0]
        except InfeasibleRanges:
            return self.cut

    def run(self, ranges: AngleRanges, enough: float) -> float:
        """Value that no motion within `ranges` exceeds; ends where that is at most `enough`."""
        number = itertools.count()
        best = np.inf
        hops = FIRST_HOPS if np.isfinite(ranges.far).sum() > MANY_BODIES else 0
        todo = [(-np.inf, next(number), ranges, np.inf, hops, self.proof)]
        while todo:
            value = min(best, -todo[0][0])
            best = max(value, self.cut)
            self.tell(best, "linear program")
            if best <= enough or self.budget.is_set():
                return best
            _, _, ranges, before, hops, step = heapq.heappop(todo)
            if step is not None and step.depth > MAX_PROOF_DEPTH:
                return best
            for part, most, more in self._worked(ranges, before, hops, best, enough, step):
                heapq.heappush(
                    todo, (-min(most, value), next(number), part, min(most, value), more, step and step.follow())
                )
        return self.cut

    def _worked(
        self, ranges: AngleRanges, before: float, hops: int, best: float, enough: float, step: ProofNode | None
    ) -> list[tuple[AngleRanges, float, int]]:
        """What is left of `ranges`, in one or two pieces, what motions there are worth at most, and how far apart to ask next.

        Ranges in which nothing is worth more than `enough` stay as they are.
        """
        self.cuts.unlike = COARSE_NORMALS if hops else FINE_NORMALS
        try:
            program = RelaxationInRanges(self.linkage, self.cuts, ranges)
        except InfeasibleRanges as nothing:
            if step is not None:
                step.at(ranges, None)
                step.empty = nothing.pair
            return []
        held = np.flatnonzero(program.linear.column >= 0)
        many = len(held) > MAX_WHOLE_BODIES
        most, multipliers, y, x = program.largest(self.weights, self.budget, interior=many)
        value = min(before, most)
        if step is not None:
            step.at(ranges, program.at)
            step.best, step.value = multipliers, most
        if value <= self.cut:
            return []
        if value <= enough:
            return [(ranges, value, hops)]
        best = min(best, value) if np.isfinite(best) else value
        asked = dominating(self.linkage, held, hops)
        self.tell(max(best, self.cut), f"turns of {len(asked)} of {len(held)} bodies")
        if many:
            cuts = neighbourhood_cuts(program, multipliers, asked, self.cutoff, self.budget)
        else:
            cuts = program.turn_cuts(asked, self.cutoff, self.budget)
        left = after_cuts(ranges, cuts, self.linkage.turns)
        if step is not None:
            step.cuts = cuts
        if np.any(left.low > left.high):
            if step is not None:
                step.nothing_left = True
            return []
        gain = (before - value) / (before - self.cut) if np.isfinite(before) else np.inf
        share = (left.high - left.low)[held] / np.maximum((ranges.high - ranges.low)[held], 1e-300)
        if hops:
            return [(left, value, hops if gain > MIN_GAIN else hops - 1)]
        if max(gain, float((1 - share).max(initial=0.0))) > MIN_REDUCTION or self.budget.is_set():
            return [(left, value, 0)]
        if self._sharpen(program, y):
            return [(left, value, 0)]
        body, middle, halves = self._halves(program, x, left)
        if step is not None:
            step.split = body, middle
        return [(part, value, 0) for part in halves]

    def _sharpen(self, program: RelaxationInRanges, y: Floats) -> bool:
        """Make the intervals narrower whose facets hold the program up; False where all are narrow enough."""
        facet = program.linear.facet
        rows = y[-len(facet) :]
        active = np.flatnonzero(np.abs(rows) > ACTIVE_MULTIPLIER * np.abs(y).max(initial=0.0))
        if self._narrower(program, active):
            return True
        # Where the range of the only turn holds it up, a region that is too wide there shows in no multiplier.
        alone = int((program.linear.column >= 0).sum()) == 1
        return alone and self._narrower(program, np.arange(len(rows)))

    def _narrower(self, program: RelaxationInRanges, active: Ints) -> bool:
        """Make the intervals of some facets narrower; False where they are narrow enough."""
        facet = program.linear.facet
        wanted: dict[int, list[Ints]] = {}
        for p in np.unique(facet[active, 0]):
            which = facet[active[facet[active, 0] == p], 1]
            kind = int(self.joints.kind[p])
            region = self.cuts.regions[kind]
            if not isinstance(region, OuterRegion):  # sharp from the start
                continue
            accuracy = FINEST_BLUR * region.material.clearance
            wanted.setdefault(kind, []).append(intervals_at_facets(region, program.at.cuts[p], which, accuracy))
        done = False
        for kind, found in wanted.items():
            these = np.unique(np.concatenate(found))
            region = self.cuts.regions[kind]
            if not len(these) or not isinstance(region, OuterRegion):
                continue
            work = len(these) * REFINEMENT_FACTOR * slice_work(region.material.a, region.material.b)
            if not self.budget.spend(work):
                self.cuts.replace(kind, with_narrower_intervals(region, these))
                done = True
        return done

    def _halves(
        self, program: RelaxationInRanges, x: Floats, ranges: AngleRanges
    ) -> tuple[int, float, list[AngleRanges]]:
        """Body, angle, and both halves of the turn that the linear program, at its best point, gets most wrong for its width."""
        held = np.flatnonzero(program.linear.column >= 0)
        t, c, s = (x[program.linear.column[held] + k] for k in (2, 3, 4))
        radius = self.linkage.radius[held]
        wrong = np.hypot(c - (np.cos(t) - 1), s - np.sin(t)) * radius
        width = (ranges.high - ranges.low)[held]
        body = int(held[np.argmax((wrong + 1e-3 * width * radius) * width)])
        middle = float(ranges.low[body] + ranges.high[body]) / 2
        low, high = ranges.low.copy(), ranges.high.copy()
        low[body] = high[body] = middle
        return body, middle, [narrowed(ranges, ranges.low, high), narrowed(ranges, low, ranges.high)]
