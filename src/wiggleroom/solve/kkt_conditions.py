"""Optimality conditions of an answer, checked from scratch whichever solver found it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Program

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Conditions:
    """How well the conditions of Karush, Kuhn and Tucker hold.

    Parameters
    ----------
    stationarity : float
        Largest unbalanced force, as a share of the largest derivative of the objective.
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
    """Check the optimality conditions at u (3F,) with multipliers lam (R,), with the explicit sparse Jacobian.

    Parameters
    ----------
    program : Program
    u : (3F,) float64
    lam : (R,) float64
        Derivative of the objective by each row, in units of the objective per `program.length`.
    """
    at = program.linearise(u)
    unit = float(np.abs(at.gradient).max()) or 1.0
    force = at.gradient + at.jacobian().T @ lam
    value = max(abs(at.value), unit)
    return Conditions(
        float(np.abs(force).max(initial=0.0)) / unit,
        float(max(0.0, -at.h.min(initial=0.0))) * program.length,
        float(np.abs(lam * at.h).sum()) / value,
        float(lam.min(initial=0.0)) / max(float(lam.max(initial=0.0)), 1e-300),
    )
