"""Escape from saddle points: the first-order conditions hold, but the objective curves upwards along the active walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Program
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import Iterate

Floats = NDArray[np.float64]

MIN_CURVATURE = 1e-4
"""Least positive curvature [objective's unit per clearance squared] that counts."""
POWER_ITERATIONS = 6
"""Of the inverse iteration; a rough direction is enough."""


def ascent_direction(state: Iterate, matrix: Factor, tolerance: float) -> Floats | None:
    """Direction (3F,) in which the objective curves upwards along the active walls, its largest entry 1; None at a true optimum.

    The condensed matrix is stiff across active walls, so it is positive definite where the second-order conditions hold; else the
    vector of its least eigenvalue runs along the walls.
    """
    data = state.at.condensed(state.lam / state.s, state.lam, share=1.0 / state.unit)
    shift = max(MIN_CURVATURE, 10 * tolerance * max(abs(state.at.value) / state.unit, 1.0))
    if matrix.update(data, shift):
        return None
    while not matrix.update(data, shift):
        shift *= 2
    v = np.random.default_rng(0).standard_normal(len(state.u))
    for _ in range(POWER_ITERATIONS):
        v = matrix.solve(v / np.abs(v).max())
    return v / np.abs(v).max()


def perturbed_start(program: Program, u: Floats, v: Floats) -> Floats:
    """A point on the better side of u along v, up to a clearance away and with at least half of the room to every wall."""
    room, share = program.values(u), 1.0
    while share > 1e-6:
        sides = [w for w in (u + share * v, u - share * v) if (program.values(w) > 0.5 * room).all()]
        if sides:
            return max(sides, key=lambda w: program.objective.value(program.motion(w)))
        share /= 2
    return u
