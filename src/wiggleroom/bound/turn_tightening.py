"""Tightening of turns: the least and largest turn of some bodies that motions worth enough, or any motions, can have.

Programs differ in their cost alone. They are asked in an order in which neighbours follow each other, in two chains at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import (
    AngleRanges,
    JointConstraints,
    TurnDifferences,
    narrowed,
    propagated,
)
from wiggleroom.bound.joint_multipliers import TURN, LagrangianBound
from wiggleroom.bound.joint_ranges import JointRanges, RegionCuts, joint_ranges
from wiggleroom.bound.linear_relaxation import LinearRelaxation, relaxation
from wiggleroom.bound.proof_steps import TurnCuts, rounded
from wiggleroom.deadline import WorkBudget
from wiggleroom.solve.dual_linear_program import DualLinearProgram

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CHAINS = 2
"""Number of chains of programs that are solved at once."""
RANGE_MARGIN = 1e-4
"""Ranges stay wider by this share, so that facets, which can be refined, are active and not the ranges themselves."""


@dataclass(frozen=True, eq=False)
class Linkage:
    """Bodies, some of which stand, and the joints that hold them.

    Parameters
    ----------
    fixed : (n,) bool
    radius : (n,) float64 [mm]
    place : (n, 2) float64 [mm]
        Where bodies lie at rest.
    joints : JointConstraints
    turns : TurnDifferences
        Of the joints first.
    unit : float [mm]
        A typical clearance.
    deviation : float [mm]
        The equation of a joint holds up to this.
    """

    fixed: Bools
    radius: Floats
    place: Floats
    joints: JointConstraints
    turns: TurnDifferences
    unit: float
    deviation: float = 0.0


@dataclass(frozen=True, eq=False)
class Cutoff:
    """Only motions count whose weights (5 n,) . (x, y, C - 1, S, t) are at least `worth`."""

    weights: Floats
    worth: float


class RelaxationInRanges:
    """The linear program of a linkage within some ranges.

    Raises
    ------
    InfeasibleRanges
        If these leave a pair no turn at all.
    """

    def __init__(self, linkage: Linkage, regions: RegionCuts, ranges: AngleRanges) -> None:
        self.linkage, self.ranges = linkage, ranges
        self.at: JointRanges = joint_ranges(linkage.joints, regions, ranges, linkage.turns)
        self.linear: LinearRelaxation = relaxation(
            linkage.fixed, linkage.radius, linkage.joints, self.at, ranges, linkage.unit
        )
        self.lagrangian = LagrangianBound(linkage.fixed, linkage.joints, self.at, ranges, linkage.deviation)

    def largest(
        self, weights: Floats, budget: WorkBudget, *, interior: bool = False
    ) -> tuple[float, Floats, Floats, Floats]:
        """Bound of weights (5 n,) . (x, y, C - 1, S, t), multipliers (P, 8) that prove it, those of rows, and where it is taken.

        By an `interior`-point method large programs are quicker, and `turn_cuts` with a cutoff has nothing to begin from.
        """
        linear = self.linear
        self.program = program = self._program(budget)
        y = program.ask(linear.cost(weights), interior=interior)
        multipliers = rounded(linear.multipliers(y[None]))
        most = self.lagrangian.most(weights[None], np.zeros(1), multipliers)
        return float(most[0]), multipliers[0], y, program.x * linear.unit

    def _program(self, budget: WorkBudget) -> DualLinearProgram:
        linear = self.linear
        return DualLinearProgram(linear.rows, linear.low, linear.high, linear.least, linear.most, budget)

    def turn_cuts(self, bodies: Ints, cutoff: Cutoff | None, budget: WorkBudget, chains: int = CHAINS) -> TurnCuts:
        """Ends of the turns of some bodies, as far as they are news; with a cutoff after `largest` of it, from where that ended."""
        asked = [(int(b), sign) for sign in (1, -1) for b in bodies[::sign]]
        half = -(-len(asked) // chains)
        groups = [asked[k : k + half] for k in range(0, len(asked), half)]
        if len(groups) > 1:
            done = list(budget.in_order(lambda group, own: self._chain(group, cutoff, own), groups, len(groups)))
        else:
            done = [self._chain(group, cutoff, budget) for group in groups]
        found = [one for chain in done for one in chain]
        return self._proven([one[0] for one in found], np.array([one[1] for one in found]), cutoff)

    def _chain(
        self, asked: list[tuple[int, int]], cutoff: Cutoff | None, budget: WorkBudget
    ) -> list[tuple[tuple[int, int], Floats]]:
        """Multipliers of rows for one question after the other, until it is over."""
        linear = self.linear
        if cutoff is None:
            program = self._program(budget)
        else:
            cost = linear.cost(cutoff.weights)
            scale = 1.0 / max(float(np.abs(cost).max()), 1e-300)
            program = self.program.with_row(cost * scale, cutoff.worth * scale, budget)
        found = []
        for body, sign in asked:
            if budget.is_set():
                break
            cost = np.zeros(len(linear.unit))
            column = linear.column[body] + 2
            cost[column] = sign * linear.unit[column]
            y = program.ask(cost)
            if cutoff is not None:
                y[-1] *= scale
            found.append(((body, sign), y))
        return found

    def _proven(self, asked: list[tuple[int, int]], y: Floats, cutoff: Cutoff | None) -> TurnCuts:
        """What multipliers of rows really prove."""
        body, sign = np.array(asked, dtype=np.int64).reshape(-1, 2).T
        count = len(body)
        if not count:
            return TurnCuts(body, sign, np.zeros(0), np.zeros(0), (), ())
        weights, constant, goal = np.zeros((count, 5 * len(self.linkage.fixed))), np.zeros(count), np.zeros(count)
        weights[np.arange(count), 5 * body + TURN] = sign
        if cutoff is not None:
            goal = np.maximum(-y[:, -1], 0.0)
            weights, constant, y = weights + goal[:, None] * cutoff.weights, -goal * cutoff.worth, y[:, :-1]
        multipliers = rounded(self.linear.multipliers(y))
        most = self.lagrangian.most(weights, constant, multipliers)
        joints = [np.flatnonzero(m.any(1)) for m in multipliers]
        made = TurnCuts(
            body, sign, most, goal, tuple(joints), tuple(m[p] for m, p in zip(multipliers, joints, strict=True))
        )
        return news(made, self.ranges)


def news(found: TurnCuts, ranges: AngleRanges) -> TurnCuts:
    """Of largest values of sign times turn those that cut a range, with the ends that they cut."""
    body, sign = found.body, found.sign
    width = ranges.high[body] - ranges.low[body]
    end = sign * (found.end + 1e-12 + RANGE_MARGIN * width)
    some = np.flatnonzero(np.where(sign > 0, end < ranges.high[body], end > ranges.low[body]))
    joints, multipliers = tuple(found.joints[k] for k in some), tuple(found.multipliers[k] for k in some)
    return TurnCuts(body[some], sign[some], end[some], found.goal[some], joints, multipliers, found.base)


def after_cuts(ranges: AngleRanges, cuts: TurnCuts, turns: TurnDifferences) -> AngleRanges:
    """What cuts leave of some ranges, also of other bodies' turns."""
    low, high = ranges.low.copy(), ranges.high.copy()
    up = cuts.sign > 0
    np.minimum.at(high, cuts.body[up], cuts.end[up])
    np.maximum.at(low, cuts.body[~up], cuts.end[~up])
    return propagated(narrowed(ranges, low, high), turns)


def joined_bodies(joints: JointConstraints, bodies: Ints) -> dict[int, list[int]]:
    """For each of some bodies those others of them that it is joined to."""
    near: dict[int, list[int]] = {int(b): [] for b in bodies}
    for a, b in zip(joints.a.tolist(), joints.b.tolist(), strict=True):
        if a in near and b in near:
            near[a].append(b)
            near[b].append(a)
    return near


def dominating(linkage: Linkage, bodies: Ints, hops: int) -> Ints:
    """Bodies such that every one lies no more than `hops` joints from one of them, neighbours one after the other."""
    near = joined_bodies(linkage.joints, bodies)
    chosen: list[int] = []
    left = set(near)
    # from the outside inwards: ends of paths matter most
    far = np.hypot(*(linkage.place[bodies] - linkage.place[linkage.fixed].mean(0)).T)
    for b in bodies[np.argsort(-far, kind="stable")].tolist():
        if b not in left:
            continue
        chosen.append(b)
        ball = {b}
        for _ in range(hops):
            ball |= {k for j in ball for k in near[j]}
        left -= ball
    return _chained(linkage.place, np.array(chosen, dtype=np.int64))


def _chained(place: Floats, bodies: Ints) -> Ints:
    """Bodies in an order in which the nearest one left follows."""
    if not len(bodies):
        return bodies
    order, left = [0], np.ones(len(bodies), dtype=bool)
    left[0] = False
    while left.any():
        rest = np.flatnonzero(left)
        away = np.hypot(*(place[bodies[rest]] - place[bodies[order[-1]]]).T)
        order.append(int(rest[away.argmin()]))
        left[order[-1]] = False
    return bodies[order]
