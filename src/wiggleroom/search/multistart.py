"""Where to start an objective that rest gives no direction: at the ends of pulls that move everything one way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies
from wiggleroom.program.objectives import Objective, PointMotion

Floats = NDArray[np.float64]

GRADIENT_TOLERANCE = 1e-9
"""An objective whose derivatives at rest are below this share of what a motion by one clearance makes them is at rest there."""
LARGE_ASSEMBLY = 300
"""Assemblies of more bodies get fewer starts."""
WEIGHT_DEVIATION = 0.2
"""Standard deviation of the weights of the pulls, so that no start is a symmetric one."""


def pulls(bodies: Bodies, objective: Objective, clearance: float) -> tuple[PointMotion, ...]:
    """Pulls to begin with; none where the objective itself shows a direction at rest.

    A sum of squares has no slope at rest, and many local optima. The ends of pulls that move everything along x or y, turn everything, or
    pull every body in a direction of its own are good places to begin; the best end is kept.
    """
    still = np.zeros((len(bodies.fixed), 3))
    moved = np.where(bodies.fixed[:, None], 0.0, [[clearance, clearance, 0.0]])
    if np.abs(objective.gradient(still)).max() > GRADIENT_TOLERANCE * np.abs(objective.gradient(moved)).max():
        return ()
    random = np.random.default_rng(0)
    free = np.flatnonzero(~bodies.fixed)
    directions = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    found = [_pull(bodies, free, np.tile(direction, (len(free), 1)), 0.0, random) for direction in directions]
    if len(free) <= LARGE_ASSEMBLY:
        found += [_pull(bodies, free, np.zeros((len(free), 2)), sense, random) for sense in (1.0, -1.0)]
        found += [_pull(bodies, free, random.standard_normal((len(free), 2)), 0.0, random) for _ in range(2)]
    return tuple(found)


def _pull(
    bodies: Bodies, free: NDArray[np.int64], direction: Floats, turn: float, random: np.random.Generator
) -> PointMotion:
    weight = 1.0 + WEIGHT_DEVIATION * random.standard_normal(len(free))
    lever = turn * weight * bodies.radius[free]
    return PointMotion(free, direction * weight[:, None], np.zeros((len(free), 2)), lever)
