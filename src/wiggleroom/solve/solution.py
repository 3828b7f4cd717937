"""Where a solver ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a solver ended.

    Parameters
    ----------
    u : (3F,) float64
        Scaled variables.
    lam : (R,) float64
        Multipliers of the rows: objective [mm] per unit of `program.length`, scaled so that the largest derivative of the objective is 1.
    status : SolverStatus
    iterations : int
    inner : (3F,) float64
        A point well inside all rows on the way, from which the next program can start.
    inner_mu : float
        Mean complementarity there, as a share of the objective's largest derivative.
    path : tuple of (3F,) float64
        Points inside all rows on the way from the start.
    error : float
        Largest of complementarity, violation and dual residual, in units of the objective.
    inner_lam : (R,) float64, optional
        Multipliers at the inner point, scaled as `lam`.
    """

    u: Floats
    lam: Floats
    status: SolverStatus
    iterations: int
    inner: Floats
    inner_mu: float
    path: tuple[Floats, ...] = ()
    error: float = 0.0
    inner_lam: Floats | None = None
