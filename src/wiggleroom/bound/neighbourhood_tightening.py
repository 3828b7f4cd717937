"""Turns of bodies in a large assembly, tightened a neighbourhood at a time.

Multipliers that bound what is asked for the whole assembly tell with which forces all other joints hold a neighbourhood. Those stay as
they are, times the weight of the cutoff, and only the multipliers of joints within the neighbourhood are asked for anew. So a program is
as small as the neighbourhood, and what follows is as safe: any multipliers give a bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints
from wiggleroom.bound.joint_multipliers import TURN, LagrangianBound
from wiggleroom.bound.linear_relaxation import relaxation
from wiggleroom.bound.proof_steps import TurnCuts, rounded
from wiggleroom.bound.turn_tightening import CHAINS, Cutoff, RelaxationInRanges, joined_bodies, news
from wiggleroom.deadline import WorkBudget
from wiggleroom.solve.dual_linear_program import DualLinearProgram

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

REACH, CORE = 4, 1
"""Joints between a neighbourhood's middle and its last bodies; and the last ones of which it tells the turns."""


@dataclass(frozen=True, eq=False)
class _Loads:
    """What multipliers (P, 8) of all joints give: their share of the bound by joint and by body, and what they sum up to."""

    multipliers: Floats
    joint: Floats
    body: Floats
    weights: Floats
    size: Floats


def neighbourhood_cuts(
    program: RelaxationInRanges, multipliers: Floats, bodies: Ints, cutoff: Cutoff, budget: WorkBudget
) -> TurnCuts:
    """Ends of the turns of some bodies, as far as they are news, about multipliers (P, 8) that bound what the cutoff is about."""
    lagrangian = program.lagrangian
    weights = cutoff.weights + lagrangian.loads @ multipliers.ravel()
    size = np.abs(cutoff.weights) + abs(lagrangian.loads) @ np.abs(multipliers.ravel())
    loads = _Loads(
        multipliers,
        lagrangian.of_joints(multipliers[None])[0],
        lagrangian.of_bodies(weights[None], size[None])[0],
        weights,
        size,
    )
    near = joined_bodies(program.linkage.joints, np.flatnonzero(program.linear.column >= 0))
    left, cores = set(bodies.tolist()), []
    for b in bodies.tolist():
        if b in left:
            cores.append((b, sorted(_ball(near, b, CORE) & left)))
            left -= set(cores[-1][1])

    def cut(part: tuple[int, list[int]], own: WorkBudget) -> TurnCuts:
        middle, core = part
        inside = _with_fixed(program, _ball(near, middle, REACH))
        return _Neighbourhood(program, loads, inside).cuts(core, cutoff, own)

    found = list(budget.in_order(cut, cores, CHAINS))
    if not found:
        return TurnCuts(bodies[:0], bodies[:0], np.zeros(0), np.zeros(0), (), (), multipliers)
    body, sign, end, goal = (np.concatenate([getattr(f, k) for f in found]) for k in ("body", "sign", "end", "goal"))
    joints, rows = (tuple(r for f in found for r in getattr(f, k)) for k in ("joints", "multipliers"))
    return news(TurnCuts(body, sign, end, goal, joints, rows, multipliers), program.ranges)


def _ball(near: dict[int, list[int]], middle: int, hops: int) -> set[int]:
    """Bodies no more than `hops` joints away from one."""
    found = {middle}
    for _ in range(hops):
        found |= {k for j in found for k in near[j]}
    return found


def _with_fixed(program: RelaxationInRanges, bodies: set[int]) -> Ints:
    """Some bodies and all fixed ones that they are joined to."""
    joints, fixed = program.linkage.joints, program.linkage.fixed
    inside = np.zeros(len(fixed), dtype=bool)
    inside[list(bodies)] = True
    for one, two in ((joints.a, joints.b), (joints.b, joints.a)):
        inside[two[fixed[two] & inside[one]]] = True
    return np.flatnonzero(inside)


class _Neighbourhood:
    """The linear program of the joints between some bodies, under the loads of all other joints."""

    def __init__(self, program: RelaxationInRanges, loads: _Loads, bodies: Ints) -> None:
        linkage, ranges, whole = program.linkage, program.ranges, program.linkage.joints
        place = np.full(len(linkage.fixed), -1, dtype=np.int64)
        place[bodies] = np.arange(len(bodies))
        self.joints = np.flatnonzero((place[whole.a] >= 0) & (place[whole.b] >= 0))
        some = whole.some(self.joints)
        joints = JointConstraints(place[some.a], place[some.b], some.kind, some.arm_a, some.arm_b, some.axes)
        at = program.at.some(self.joints)
        own = AngleRanges(ranges.low[bodies], ranges.high[bodies], ranges.far[bodies])
        fixed = linkage.fixed[bodies]
        self.place = place
        self.linear = relaxation(fixed, linkage.radius[bodies], joints, at, own, linkage.unit)
        self.lagrangian = LagrangianBound(fixed, joints, at, own, linkage.deviation)
        # what is left of the loads when the joints within are taken away, and what all else adds
        rows = (5 * bodies[:, None] + np.arange(5)).ravel()
        inner = loads.multipliers[self.joints].ravel()
        self.weights = loads.weights[rows] - self.lagrangian.loads @ inner
        self.size = loads.size[rows] + abs(self.lagrangian.loads) @ np.abs(inner)
        others, elsewhere = np.ones(len(whole.a), dtype=bool), np.ones(len(place), dtype=bool)
        others[self.joints] = elsewhere[bodies] = False
        self.rest = float(loads.joint[others].sum() + loads.body[elsewhere].sum())

    def cuts(self, core: list[int], cutoff: Cutoff, budget: WorkBudget) -> TurnCuts:
        """Largest values of sign times turn of the bodies in the core."""
        linear = self.linear
        program = DualLinearProgram(linear.rows, linear.low, linear.high, linear.least, linear.most, budget)
        cost = linear.cost(self.weights)
        program.ask(cost)
        scale = 1.0 / max(float(np.abs(cost).max()), 1e-300)
        program = program.with_row(cost * scale, (cutoff.worth - self.rest) * scale, budget)
        asked, found = [(b, sign) for sign in (1, -1) for b in core[::sign]], []
        for b, sign in asked:
            column = linear.column[self.place[b]] + 2
            one = np.zeros(len(linear.unit))
            one[column] = sign * linear.unit[column]
            found.append(program.ask(one))
        y = np.array(found)
        body, sign = np.array(asked, dtype=np.int64).T
        goal = np.maximum(-y[:, -1], 0.0) * scale
        multipliers = rounded(linear.multipliers(y[:, :-1]))
        weights, size = goal[:, None] * self.weights, goal[:, None] * self.size
        turn = 5 * self.place[body] + TURN
        weights[np.arange(len(y)), turn] += sign
        size[np.arange(len(y)), turn] += 1
        most = self.lagrangian.most(weights, goal * (self.rest - cutoff.worth), multipliers, size)
        most += 1e-14 * goal * (abs(self.rest) + abs(cutoff.worth))
        return TurnCuts(body, sign, most, goal, (self.joints,) * len(y), tuple(multipliers))
