"""What is made as large as possible: small classes that return value, gradient and Hessian over the motions of bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Goal, Pull, Turn, W
from wiggleroom.errors import InputError
from wiggleroom.pairs.shapes import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Objective(Protocol):
    """What a solver needs to know of an objective; `motion` is (n, 3) [mm, mm, rad], pose minus rest pose of every body."""

    def value(self, motion: Floats) -> float:
        """Objective, larger is better."""

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""

    def hessian(self, motion: Floats) -> tuple[Ints, Floats]:
        """Bodies (k,) and their blocks (k, 3, 3); blocks of one body add up."""


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

    def _turned(self, motion: Floats) -> Floats:
        c, s = np.cos(motion[self.body, 2]), np.sin(motion[self.body, 2])
        x, y = self.arm.T
        return np.column_stack([c * x - s * y, s * x + c * y])

    def value(self, motion: Floats) -> float:
        """Objective [mm], turns in [rad]."""
        # (R - I) arm through half angles: no cancellation at small turns
        half = motion[self.body, 2] / 2
        c, s = np.cos(half), np.sin(half)
        x, y = self.arm.T
        shift = 2 * s[:, None] * np.column_stack([-s * x - c * y, c * x - s * y])
        moved = motion[self.body, :2] + shift
        return float((self.direction * moved).sum() + self.turn @ motion[self.body, 2])

    def gradient(self, motion: Floats) -> Floats:
        """Derivatives (n, 3)."""
        arm = self._turned(motion)
        out = np.zeros_like(motion)
        lever = self.direction[:, 1] * arm[:, 0] - self.direction[:, 0] * arm[:, 1] + self.turn
        np.add.at(out, self.body, np.column_stack([self.direction, lever]))
        return out

    def hessian(self, motion: Floats) -> tuple[Ints, Floats]:
        """Bodies (k,) and blocks (k, 3, 3)."""
        blocks = np.zeros((len(self.body), 3, 3))
        blocks[:, 2, 2] = -(self.direction * self._turned(motion)).sum(1)
        return self.body, blocks


def objective(assembly: Assembly, bodies: Bodies, goals: Sequence[Goal]) -> PointMotion:
    """Weighted sum of the goals.

    Raises
    ------
    InputError
        If a goal names an unknown part.

    Source: Mind the Gap, section 4.4; pulls of material points are exact in the angle instead of linear.
    """
    index = {name: k for k, name in enumerate(assembly.names)}
    unknown = [
        f'"{g.part}" is not a part of {assembly.drawing.source or "the assembly"}' for g in goals if g.part not in index
    ]
    if unknown:
        raise InputError(unknown)
    rows = []
    for goal in goals:
        part = index[goal.part]
        body = int(bodies.body_of[part])
        direction, point, turn = TERMS[type(goal)](goal)
        spot = assembly.parts[part].at[:2] if point is None else point
        rows.append(
            (
                body,
                *(goal.weight * np.asarray(direction)),
                *(np.asarray(spot) - bodies.rest[body, :2]),
                goal.weight * turn,
            )
        )
    table = np.array(rows, dtype=float).reshape(-1, 6)
    return PointMotion(table[:, 0].astype(np.int64), table[:, 1:3], table[:, 3:5], table[:, 5])


def _pull(goal: Pull) -> tuple[Sequence[float], Sequence[float] | None, float]:
    return np.asarray(goal.direction, dtype=float) / np.hypot(*goal.direction), goal.point, 0.0


def _turn(goal: Turn) -> tuple[Sequence[float], Sequence[float] | None, float]:
    return (0.0, 0.0), None, 1.0 if goal.sense == "ccw" else -1.0


def _w(goal: W) -> tuple[Sequence[float], Sequence[float] | None, float]:
    return goal.w[:2], None, goal.w[2]


TERMS: dict[type, Callable[..., tuple]] = {Pull: _pull, Turn: _turn, W: _w}
"""Registry of goals: direction, point (None: the reference point) and weight of the turn of each kind."""
