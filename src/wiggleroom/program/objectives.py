"""What is made as large as possible: small classes that return value, gradient and Hessian over the motions of bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Closer, Goal, Pull, Towards, Translation, Turn, W, part_of
from wiggleroom.errors import InputError
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.program import material_points as kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Objective(Protocol):
    """What a solver needs to know of an objective; `motion` is (n, 3) [mm, mm, rad], pose minus rest pose of every body.

    `couples` are the pairs of bodies i < j (k,) and (k,), each pair once, whose motions it multiplies with each other.
    """

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """Pairs of bodies with a block of second derivatives."""

    def value(self, motion: Floats) -> float:
        """Objective, larger is better."""

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Bodies (k,) and their blocks (k, 3, 3), which add up, and blocks (c, 3, 3) of the coupled pairs, rows of the first body."""


_EMPTY = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Points:
    """Material points of bodies: `body` (k,) and `arm` (k, 2) [mm], from the body's origin to the point at rest."""

    body: Ints
    arm: Floats

    def turned(self, motion: Floats) -> Floats:
        """Arms (k, 2) [mm] as they lie after the motion."""
        out = np.empty((len(self.body), 2))
        kernel.turned_arms(self.body, self.arm, motion, out)
        return out

    def moved(self, motion: Floats) -> Floats:
        """Displacements (k, 2) [mm]."""
        out = np.empty((len(self.body), 2))
        kernel.point_displacements(self.body, self.arm, motion, out)
        return out

    def slopes(self, motion: Floats) -> Floats:
        """Derivatives (k, 2, 3) of the displacements by the body's motion."""
        out = np.zeros((len(self.body), 2, 3))
        arm = self.turned(motion)
        out[:, 0, 0] = out[:, 1, 1] = 1.0
        out[:, 0, 2], out[:, 1, 2] = -arm[:, 1], arm[:, 0]
        return out


@dataclass(frozen=True, eq=False)
class PointMotion:
    """Sum over k of direction . displacement of a material point + turn * angle of a body.

    Parameters
    ----------
    body : (k,) int64
    direction : (k, 2) float64
        Fixed in the world; its length is the weight.
    arm : (k, 2) float64 [mm]
        From the body's origin to the point, at rest.
    turn : (k,) float64
        Weight of the body's angle [rad].
    """

    body: Ints
    direction: Floats
    arm: Floats
    turn: Floats

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """None: every body for itself."""
        return _EMPTY, _EMPTY

    @property
    def points(self) -> Points:
        """The pulled points."""
        return Points(self.body, self.arm)

    def value(self, motion: Floats) -> float:
        """Objective [mm], turns in [rad]."""
        return kernel.pulled_value(self.body, self.direction, self.arm, self.turn, motion)

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""
        return self._derivatives(motion)[0]

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Bodies (k,), blocks (k, 3, 3), and no coupled ones."""
        blocks = np.zeros((len(self.body), 3, 3))
        blocks[:, 2, 2] = self._derivatives(motion)[1]
        return self.body, blocks, np.zeros((0, 3, 3))

    def _derivatives(self, motion: Floats) -> tuple[Floats, Floats]:
        """Derivatives (n, 3), and the second ones by the angle of each pulled body (k,)."""
        out, curvature = np.zeros(motion.shape), np.empty(len(self.body))
        kernel.pulled_derivatives(self.body, self.direction, self.arm, self.turn, motion, out, curvature)
        return out, curvature


ZERO_MOTION = PointMotion(_EMPTY, np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))
"""Asks for nothing: for programs whose rows alone are of interest."""


@dataclass(frozen=True, eq=False)
class SquaredTravel:
    """Weight times the sum of the squared displacements [mm2] of material points.

    Source: Mind the Gap, section 4.4: maximise the translations' sum of squares.
    """

    points: Points
    weight: float = 1.0

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """None: every body for itself."""
        return _EMPTY, _EMPTY

    def value(self, motion: Floats) -> float:
        """Objective [mm2]."""
        return self.weight * float((self.points.moved(motion) ** 2).sum())

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""
        out = np.zeros_like(motion)
        slope = np.einsum("ki,kij->kj", self.points.moved(motion), self.points.slopes(motion))
        np.add.at(out, self.points.body, 2 * self.weight * slope)
        return out

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Bodies (k,), blocks (k, 3, 3), and no coupled ones."""
        slope = self.points.slopes(motion)
        blocks = np.einsum("kij,kil->kjl", slope, slope)
        blocks[:, 2, 2] -= (self.points.moved(motion) * self.points.turned(motion)).sum(1)
        return self.points.body, 2 * self.weight * blocks, np.zeros((0, 3, 3))


@dataclass(frozen=True, eq=False)
class Approach:
    """Weighted sum of what the squared distances [mm2] of material points from places lose: |at rest|^2 - |now|^2.

    Parameters
    ----------
    points : Points
    apart : (k, 2) float64 [mm]
        From the place to the point at rest.
    weight : (k,) float64
    zero : float [mm2]
        Taken off: where only what is gained from somewhere else than rest counts.
    """

    points: Points
    apart: Floats
    weight: Floats
    zero: float = 0.0

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """None: every body for itself."""
        return _EMPTY, _EMPTY

    def value(self, motion: Floats) -> float:
        """Objective [mm2]."""
        change = self.points.moved(motion)
        return -float(self.weight @ (change * (2 * self.apart + change)).sum(axis=1)) - self.zero

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""
        out = np.zeros_like(motion)
        slope = np.einsum("ki,kij->kj", self.apart + self.points.moved(motion), self.points.slopes(motion))
        np.add.at(out, self.points.body, -2 * self.weight[:, None] * slope)
        return out

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Bodies (k,), blocks (k, 3, 3), and no coupled ones."""
        slope = self.points.slopes(motion)
        blocks = -np.einsum("kij,kil->kjl", slope, slope)
        blocks[:, 2, 2] += ((self.apart + self.points.moved(motion)) * self.points.turned(motion)).sum(1)
        return self.points.body, 2 * self.weight[:, None, None] * blocks, np.zeros((0, 3, 3))


@dataclass(frozen=True, eq=False)
class Nearness:
    """Weight times what the squared distances [mm2] between pairs of material points lose: sum of |at rest|^2 - |now|^2.

    Parameters
    ----------
    one, other : Points
        Ends of each pair (k,); every pair of bodies i < j at most once.
    apart : (k, 2) float64 [mm]
        From the one to the other at rest.
    weight : float

    Source: Mind the Gap, section 4.4: minimise the squared distances between parts.
    """

    one: Points
    other: Points
    apart: Floats
    weight: float = 1.0

    @property
    def most(self) -> float:
        """What no motion exceeds [mm2]: all distances lost."""
        return self.weight * float((self.apart**2).sum()) if self.weight >= 0 else np.inf

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """The pairs themselves."""
        return self.one.body, self.other.body

    def value(self, motion: Floats) -> float:
        """Objective [mm2]."""
        change = self.other.moved(motion) - self.one.moved(motion)
        return 0.0 - self.weight * float((change * (2 * self.apart + change)).sum())

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""
        out = np.zeros_like(motion)
        difference = self.apart + self.other.moved(motion) - self.one.moved(motion)
        for points, sign in ((self.one, 2.0), (self.other, -2.0)):
            slope = np.einsum("ki,kij->kj", difference, points.slopes(motion))
            np.add.at(out, points.body, sign * self.weight * slope)
        return out

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Bodies (2k,), blocks (2k, 3, 3), and those of the pairs (k, 3, 3)."""
        difference = self.apart + self.other.moved(motion) - self.one.moved(motion)
        slopes = [points.slopes(motion) for points in (self.one, self.other)]
        own = [-np.einsum("kij,kil->kjl", slope, slope) for slope in slopes]
        own[0][:, 2, 2] -= (difference * self.one.turned(motion)).sum(1)
        own[1][:, 2, 2] += (difference * self.other.turned(motion)).sum(1)
        body = np.concatenate([self.one.body, self.other.body])
        coupled = np.einsum("kij,kil->kjl", *slopes)
        return body, 2 * self.weight * np.concatenate(own), 2 * self.weight * coupled


@dataclass(frozen=True, eq=False)
class Sum:
    """Several objectives that add up."""

    terms: tuple[Objective, ...]

    @property
    def couples(self) -> tuple[Ints, Ints]:
        """Of all terms; at most one of them couples bodies."""
        i, j = zip(*(term.couples for term in self.terms), strict=True)
        return np.concatenate(i), np.concatenate(j)

    def value(self, motion: Floats) -> float:
        """Sum of the values."""
        return sum(term.value(motion) for term in self.terms)

    def gradient(self, motion: Floats) -> Floats:
        """Sum of the derivatives (n, 3)."""
        return np.sum([term.gradient(motion) for term in self.terms], axis=0)

    def hessian(self, motion: Floats) -> tuple[Ints, Floats, Floats]:
        """Blocks of all terms."""
        body, own, coupled = zip(*(term.hessian(motion) for term in self.terms), strict=True)
        return np.concatenate(body), np.concatenate(own), np.concatenate(coupled)


def objective(
    assembly: Assembly, bodies: Bodies, goals: Sequence[Goal], neighbours: tuple[Ints, Ints] | None = None
) -> Objective:
    """Weighted sum of the goals.

    Parameters
    ----------
    assembly : Assembly
    bodies : Bodies
    goals : sequence of Pull, Turn, W, Towards, Translation or Closer
    neighbours : two (k,) int64, optional
        Pairs of bodies a < b that `Closer` brings together; by default all, but fixed with fixed.

    Raises
    ------
    InputError
        If a goal names an unknown part.

    Source: Mind the Gap, section 4.4; pulls of material points are exact in the angle instead of linear.
    """
    unknown = [
        f'"{name}" is not a part of {assembly.drawing.source or "the assembly"}'
        for g in goals
        if (name := part_of(g)) is not None and name not in assembly.names
    ]
    if unknown:
        raise InputError(unknown)
    kinds: dict[Callable[..., Objective], list[Goal]] = {}
    for goal in goals:
        kinds.setdefault(TERMS[type(goal)], []).append(goal)
    pairs = _all_pairs(bodies) if neighbours is None else neighbours
    terms = tuple(term(assembly, bodies, its, pairs) for term, its in kinds.items())
    return terms[0] if len(terms) == 1 else Sum(terms)


def _all_pairs(bodies: Bodies) -> tuple[Ints, Ints]:
    i, j = np.triu_indices(len(bodies.fixed), 1)
    free = ~(bodies.fixed[i] & bodies.fixed[j])
    return i[free], j[free]


def _pulled(assembly: Assembly, bodies: Bodies, goals: Sequence[Any], _: tuple[Ints, Ints]) -> PointMotion:
    """Pulls, turns and the paper's W, all in one."""
    rows = []
    for goal in goals:
        part = assembly.names.index(goal.part)
        body = int(bodies.body_of[part])
        direction, point, turn = _LINEAR_GOALS[type(goal)](goal)
        spot = assembly.parts[part].at[:2] if point is None else point
        arm = np.asarray(spot) - bodies.rest[body, :2]
        rows.append((body, *(goal.weight * np.asarray(direction)), *arm, goal.weight * turn))
    table = np.array(rows, dtype=float).reshape(-1, 6)
    return PointMotion(table[:, 0].astype(np.int64), table[:, 1:3].copy(), table[:, 3:5].copy(), table[:, 5].copy())


def _towards(assembly: Assembly, bodies: Bodies, goals: Sequence[Any], _: tuple[Ints, Ints]) -> Approach:
    """Points that come nearer to places."""
    part = [assembly.names.index(goal.part) for goal in goals]
    spot = np.array([assembly.rest[p, :2] if g.point is None else g.point for p, g in zip(part, goals, strict=True)])
    body = bodies.body_of[part]
    apart = spot - np.array([goal.target for goal in goals])
    return Approach(Points(body, spot - bodies.rest[body, :2]), apart, np.array([float(g.weight) for g in goals]))


def _travel(assembly: Assembly, bodies: Bodies, goals: Sequence[Any], _: tuple[Ints, Ints]) -> SquaredTravel:
    """Squared translations of the reference points of all parts."""
    body = bodies.body_of
    points = Points(body, assembly.rest[:, :2] - bodies.rest[body, :2])
    return SquaredTravel(points, sum(goal.weight for goal in goals))


def _nearness(assembly: Assembly, bodies: Bodies, goals: Sequence[Any], pairs: tuple[Ints, Ints]) -> Nearness:
    """Squared distances between neighbours: of their reference points, or of the centroid of parts that are glued."""
    single = np.array([len(m) == 1 for m in bodies.members])
    part = np.array([m[0] for m in bodies.members])
    arm = np.where(single[:, None], assembly.rest[part, :2] - bodies.rest[:, :2], 0.0)
    one, other = (Points(k, arm[k]) for k in pairs)
    place = bodies.rest[:, :2] + arm
    return Nearness(one, other, place[other.body] - place[one.body], sum(goal.weight for goal in goals))


def _pull(goal: Pull) -> tuple[Sequence[float], Sequence[float] | None, float]:
    x, y = goal.direction
    return np.array((x, y), dtype=float) / np.hypot(x, y), goal.point, 0.0


def _turn(goal: Turn) -> tuple[Sequence[float], Sequence[float] | None, float]:
    return (0.0, 0.0), None, 1.0 if goal.sense == "ccw" else -1.0


def _w(goal: W) -> tuple[Sequence[float], Sequence[float] | None, float]:
    return goal.w[:2], None, goal.w[2]


_LINEAR_GOALS: dict[type, Callable[..., tuple]] = {Pull: _pull, Turn: _turn, W: _w}

TERMS: dict[type, Callable[..., Objective]] = {
    Pull: _pulled, Turn: _pulled, W: _pulled, Towards: _towards, Translation: _travel, Closer: _nearness,
}  # fmt: skip
"""Registry: kind of goal, and what makes one objective of all goals of its kind."""
