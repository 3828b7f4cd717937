"""Optimality conditions of an answer, checked from scratch whichever solver found it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised, Program

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Conditions:
    """How well the conditions of Karush, Kuhn and Tucker hold.

    Parameters
    ----------
    stationarity : float
        Largest unbalanced force, as a share of the largest derivative of the objective; near a maximum of its own, where all derivatives
        vanish, of what its curvature makes of them one length of the program away.
    violation : float [mm]
        Deepest violated row.
    complementarity : float
        Sum of multiplier times row, as a share of the objective.
    sign : float
        Most negative multiplier, as a share of the largest.
    """

    stationarity: float
    violation: float
    complementarity: float
    sign: float

    def hold(self, size: float) -> bool:
        """True where all hold as well as they can in double precision for a drawing of `size` [mm]."""
        return (
            self.stationarity < 1e-3
            and self.violation < 1e-9 * size
            and self.complementarity < 1e-4
            and self.sign > -1e-9
        )


def conditions(program: Program, u: Floats, lam: Floats) -> Conditions:
    """Check the optimality conditions at u (3F,) with multipliers lam (R,), by sums of its own over the forces on every body.

    Parameters
    ----------
    program : Program
    u : (3F,) float64
    lam : (R,) float64
        Derivative of the objective by each row, in units of the objective per `program.length`.
    """
    at = program.linearise(u)
    unit = max(float(np.abs(at.gradient).max()), _curvature(at)) or 1.0
    force = at.gradient + _forces(at, lam)
    value = max(abs(at.value), unit)
    return Conditions(
        float(np.abs(force).max(initial=0.0)) / unit,
        float(max(0.0, -at.h.min(initial=0.0))) * program.length,
        float(np.abs(lam * at.h).sum()) / value,
        float(lam.min(initial=0.0)) / max(float(lam.max(initial=0.0)), 1e-300),
    )


def _curvature(at: Linearised) -> float:
    """Largest curvature of the objective downwards, along any scaled variable."""
    P = at.program
    body, own, _ = P.objective.hessian(at.motion)
    diagonal = np.zeros((len(P.slot), 3))
    np.add.at(diagonal, body, own[:, [0, 1, 2], [0, 1, 2]])
    return float(-(diagonal[P.free].ravel() * P.scale**2).min(initial=0.0))


def _forces(at: Linearised, lam: Floats) -> Floats:
    """Forces (3F,) of all rows on the free bodies, per unit of their scaled variables."""
    P, pair = at.program, at.program.cells.pair
    count, bodies = len(P.cells.a), len(P.slot)
    x, y, moment = (np.bincount(pair, at.d[:, k] * lam, count) for k in range(3))
    c, s = at.turn.T
    across, along = c * x - s * y, s * x + c * y
    about_a = at.g[:, 1] * x - at.g[:, 0] * y - moment
    sums = [
        np.bincount(P.cells.b, of_b, bodies) + np.bincount(P.cells.a, of_a, bodies)
        for of_a, of_b in ((-across, across), (-along, along), (about_a, moment))
    ]
    return np.column_stack(sums)[P.free].ravel() * P.scale
