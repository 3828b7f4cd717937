"""One iterate of the interior-point method, and the Newton direction from it; slacks and multipliers are eliminated."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.row_operations import dot, step_length

Floats = NDArray[np.float64]

MIN_SHIFT = 1e-11
"""Added to the diagonal always."""


@dataclass(eq=False)
class Iterate:
    """Iterate of the method; `s` are slacks of the rows, `growth` is the share by which the last step raised the objective."""

    u: Floats
    s: Floats
    lam: Floats
    at: Linearised
    unit: float
    move: Floats
    proximal_share: float
    shift: float = MIN_SHIFT
    stride: float = 1.0
    growth: float = 0.0
    path: list[Floats] = field(default_factory=list)

    def residuals(self) -> tuple[Floats, float, float]:
        """Dual residual, complementarity, and value in units of the objective's largest derivative."""
        dual_residual = (
            self.proximal_weight * self.u - self.at.gradient / self.unit - self.at.transposed_jacobian_product(self.lam)
        )
        return dual_residual, dot(self.s, self.lam), self.at.value / self.unit

    @property
    def proximal_weight(self) -> float:
        """Weight of the proximal term, half the squared motion: so small that it decides only between equally good motions."""
        return self.proximal_share * max(abs(self.at.value) / self.unit, 1.0) / max(dot(self.u, self.u), 1.0)


@dataclass(frozen=True, eq=False)
class Direction:
    """Changes of variables `u` (3F,), slacks `s` (R,) and multipliers `lam` (R,), and the longest steps that keep these positive.

    `primal_step` is that of the slacks, `dual_step` that of the multipliers, both in [0, 1].
    """

    u: Floats
    s: Floats
    lam: Floats
    primal_step: float
    dual_step: float


def newton(state: Iterate, matrix: Factor, dual_residual: Floats, goal: Floats, share: float = 1.0) -> Direction:
    """The direction that changes s * lam by `goal`, and removes the dual residual and a share of the primal one, s - h, to first order."""
    s, lam, at = state.s, state.lam, state.at
    du = matrix.solve(at.eliminated_product(s, lam, goal, share) - dual_residual)
    return Direction(du, *at.eliminated_changes(du, s, lam, goal, share))


def max_step(x: Floats, dx: Floats) -> float:
    """Largest step in [0, 1] that keeps x + step * dx >= 0, for x > 0."""
    return step_length(x, dx)
