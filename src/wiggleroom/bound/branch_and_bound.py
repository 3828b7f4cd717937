"""Branch and bound from outer regions: tighten, refine and split until nothing above the motion found is left, or the time is up.

The relaxation is asked for its best value. Then the range of every body's turn is cut to what motions worth at least `cut`, a little more
than the witness, can have. That makes the relaxation tighter, again and again. Intervals of turns that hold it up are made narrower. Where
it stalls, the range of the turn that errs most is halved, and both halves go on for themselves; the bound is the larger of theirs.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.bound.linear_relaxation import (
    AngleRanges,
    InfeasibleRelaxation,
    JointConstraints,
    LinearRelaxation,
    narrowed,
    relaxation,
)
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.deadline import Deadline
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.outer_facets import holding
from wiggleroom.freespace.outer.outer_region import OuterRegion, refined
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.prepare import Survey
from wiggleroom.solve.safe_dual_bound import LinearBounds

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINEST_BLUR = 0.004
"""Intervals of turns are made narrower until they blur by this share of the clearance."""
ACTIVE_MULTIPLIER = 1e-3
"""A facet holds the program up where its multiplier is at least this share of the largest."""
RANGE_MARGIN = 1e-4
"""Ranges stay wider by this share, so that facets, which can be refined, hold the program up and not the ranges themselves."""
MIN_REDUCTION = 0.1
"""A sweep that cuts no turn, nor the bound's distance from `cut`, by this share leads to a split."""
MAX_PROOF_DEPTH = 200
"""So many steps may follow each other in a proof that is kept: beyond, it is the regions that are too large."""


@dataclass(eq=False)
class BranchAndBound:
    """State of the loop: outer regions, and the ranges of turns that may still hold motions worth more than `cut`."""

    ground: Survey
    links: JointConstraints
    regions: list[OuterRegion | CagingSurface]
    goal: PointMotion
    cut: float
    clock: Deadline
    tell: Callable[[float], None]
    proof: ProofNode | None = None

    def run(self, ranges: AngleRanges, enough: float) -> float:
        """Value that no motion within `ranges` exceeds; ends where that is at most `enough`."""
        number = itertools.count()
        best = np.inf
        todo = [(-np.inf, next(number), ranges, np.inf, self.proof)]
        while todo:
            value = min(best, -todo[0][0])
            best = max(value, self.cut)
            self.tell(best)
            if best <= enough or self.clock.is_set():
                return best
            _, _, ranges, before, step = heapq.heappop(todo)
            if step is not None and step.depth > MAX_PROOF_DEPTH:
                return best
            for part, most in self._worked(ranges, before, step):
                heapq.heappush(todo, (-min(most, value), next(number), part, min(most, value), step and step.follow()))
        return self.cut

    def _worked(self, ranges: AngleRanges, before: float, step: ProofNode | None) -> list[tuple[AngleRanges, float]]:
        """What is left of `ranges`, in one or two pieces, and what motions in them are worth at most."""
        ground, unit = self.ground, self.ground.clearance
        try:
            linear = relaxation(ground.bodies, self.links, self.regions, ranges, self.goal, unit, ground.size)
        except InfeasibleRelaxation as nothing:
            if step is not None:
                step.empty = nothing.pair
            return []
        solver, scale = _asked(linear, self.clock.left)
        most = solver.most_of(linear.cost)
        value = min(before, most)
        if step is not None:
            step.ask(linear, solver.y, most)
        if value <= self.cut:
            return []
        x, y = solver.x, solver.y
        solver.change_row(len(linear.low), self.cut * scale, np.inf)
        cut, gained = self._tightened(linear, solver, ranges, scale, step)
        if np.any(cut.low > cut.high):
            if step is not None:
                step.nothing_left = True
            return []
        gain = (before - value) / (before - self.cut) if np.isfinite(before) else np.inf
        if max(gain, gained) > MIN_REDUCTION or self.clock.is_set() or self._sharpen(linear, y):
            return [(cut, value)]
        body, middle, halves = self._halves(linear, x, cut)
        if step is not None:
            step.split = body, middle
        return [(part, value) for part in halves]

    def _tightened(
        self, linear: LinearRelaxation, solver: LinearBounds, ranges: AngleRanges, scale: float, step: ProofNode | None
    ) -> tuple[AngleRanges, float]:
        """Cut every body's turn to what the program leaves it; also the largest share that was cut off."""
        low, high = ranges.low.copy(), ranges.high.copy()
        held = np.flatnonzero(linear.turn >= 0)
        for body in held:
            if self.clock.is_set():
                break
            cost = np.zeros(len(linear.cost))
            for sign, end in ((1.0, high), (-1.0, low)):
                cost[linear.turn[body]] = sign
                most = solver.most_of(cost) * linear.unit[linear.turn[body]]
                end[body] = sign * (most + 1e-12 + RANGE_MARGIN * (ranges.high[body] - ranges.low[body]))
                if step is not None:
                    step.cut(linear, solver.y, scale, int(body), sign, float(end[body]), ranges)
        cut = narrowed(ranges, low, high)
        share = (cut.high - cut.low)[held] / np.maximum((ranges.high - ranges.low)[held], 1e-300)
        return cut, float((1 - share).max(initial=0.0))

    def _sharpen(self, linear: LinearRelaxation, y: Floats) -> bool:
        """Make the intervals narrower whose facets hold the program up; False where all are narrow enough."""
        rows = y[-len(linear.facet) - 1 : -1]
        active = np.flatnonzero(np.abs(rows) > ACTIVE_MULTIPLIER * np.abs(y).max(initial=0.0))
        wanted: dict[int, list[Ints]] = {}
        for p in np.unique(linear.facet[active, 0]):
            which = linear.facet[active[linear.facet[active, 0] == p], 1]
            kind = int(self.links.kind[p])
            region = self.regions[kind]
            if isinstance(region, CagingSurface):  # sharp from the start
                continue
            accuracy = FINEST_BLUR * region.material.clearance
            wanted.setdefault(kind, []).append(holding(region, linear.cut[int(p)], which, accuracy))
        done = False
        for kind, found in wanted.items():
            these = np.unique(np.concatenate(found))
            region = self.regions[kind]
            if len(these) and isinstance(region, OuterRegion) and not self.clock.is_set():
                self.regions[kind] = refined(region, these)
                done = True
        return done

    def _halves(self, linear: LinearRelaxation, x: Floats, ranges: AngleRanges) -> tuple[int, float, list[AngleRanges]]:
        """Body, angle, and both halves of the turn that the linear program, at its best point, gets most wrong for its width."""
        held = np.flatnonzero(linear.turn >= 0)
        column = linear.turn[held]
        t, c, s = (x[column + k] * linear.unit[column + k] for k in range(3))
        wrong = np.hypot(c - (np.cos(t) - 1), s - np.sin(t)) * self.ground.bodies.radius[held]
        width = (ranges.high - ranges.low)[held]
        body = int(held[np.argmax((wrong + 1e-3 * width * self.ground.bodies.radius[held]) * width)])
        middle = float(ranges.low[body] + ranges.high[body]) / 2
        low, high = ranges.low.copy(), ranges.high.copy()
        low[body] = high[body] = middle
        return body, middle, [narrowed(ranges, ranges.low, high), narrowed(ranges, low, ranges.high)]


def _asked(linear: LinearRelaxation, limit: float) -> tuple[LinearBounds, float]:
    """The linear program with the goal as its last row, and the factor of that row."""
    scale = 1.0 / max(float(np.abs(linear.cost).max()), 1e-300)
    rows = sp.vstack([linear.rows, sp.csr_matrix(linear.cost * scale)]).tocsr()
    low, high = np.append(linear.low, -np.inf), np.append(linear.high, np.inf)
    return LinearBounds(rows, low, high, linear.least, linear.most, max(limit, 0.1)), scale
