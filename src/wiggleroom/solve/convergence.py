"""Convergence tests at every iterate, and the points from which the next program can start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.solve.interior_point_settings import SETTINGS, settings_for, warm_start_gap
from wiggleroom.solve.newton_step import Iterate
from wiggleroom.solve.row_operations import farthest_pulled, residual_work, violation
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]


@dataclass(eq=False)
class ConvergenceMonitor:
    """Convergence tests at every iterate, and what the next program needs to start from."""

    tolerance: float
    horizon: float
    enough: float
    balanced: bool
    stop: Stop | None
    progress: Callable[[int, float], None] | None
    reached: Callable[[Floats], None] | None
    begin: Floats
    first_mu: float
    iterations: int = 0
    error: float = np.inf
    mu: float = 0.0
    infeasible: float = 0.0
    infeasibility_ratio: float = 0.0
    imbalance_ratio: float = 0.0
    feasible: tuple[Floats, float, Floats | None] | None = None
    path: list[Floats] = field(default_factory=list)
    inner: tuple[Floats, float, Floats | None] = field(init=False)

    def __post_init__(self) -> None:
        """Begin with the start as the inner point."""
        self.inner = self.begin, self.first_mu, None

    def rewind_to_inner(self) -> None:
        """Forget the iterates past the inner point."""
        last = next((k for k, u in enumerate(self.path) if u is self.inner[0]), -1)
        del self.path[last + 1 :]

    def follow(self, state: Iterate, advance: Callable[[Iterate, Floats, float], bool], most: int) -> SolverStatus:
        """Advance the state until it is converged, stopped or escaping, or until that fails."""
        before, best, since = np.inf, np.inf, 0
        for k in range(most + 1):
            dual_residual, gap, value = state.residuals()
            status = self._judge(state, dual_residual, gap, value, before, k)
            if status is not None:
                return status
            best, since = (self.error, 0) if self.error < 0.9 * best else (best, since + 1)
            target = 0.2 * self.tolerance * max(abs(value), 1.0) / max(len(state.s), 1)
            if k == most or since > SETTINGS.max_stalled_iterations or not advance(state, dual_residual, target):
                break
            before = value
            self.iterations += 1
        return SolverStatus.FAILED

    def _judge(
        self,
        state: Iterate,
        dual_residual: Floats,
        gap: float,
        value: float,
        before: float,
        k: int,
    ) -> SolverStatus | None:
        """Measure an iterate; the status to end with, or nothing."""
        if self.progress is not None:
            self.progress(self.iterations, state.at.value)
        self.mu = gap / max(len(state.s), 1)
        self.infeasible = violation(state.lam, state.s, state.at.h)
        step_work, dual_displacement = residual_work(dual_residual, state.move, state.u, self.begin)
        wrong = step_work if k else 0.0
        settings, whole = settings_for(len(state.u)), max(abs(value), 1.0)
        dual_error = (
            settings.dual_error_ratio * (dual_displacement - settings.dual_error_allowance * whole)
            if dual_displacement > settings.dual_error_floor * whole
            else 0.0
        )
        self.infeasibility_ratio = max(self.infeasible, wrong) / gap if gap > 0 else 0.0
        self.imbalance_ratio = dual_error / gap if gap > 0 else 0.0
        self.error = max(gap, self.infeasible, wrong, abs(value - before)) / max(abs(value), 1.0)
        inside = state.at.h.min(initial=np.inf) > 0
        if inside:
            self.feasible = state.u, self.mu, state.lam
            self.path.append(state.u)
            if k == 0 or gap > warm_start_gap(len(state.u), self.tolerance) * max(abs(value), 1.0):
                self.inner = state.u, self.mu, state.lam
                if self.reached is not None:
                    self.reached(state.u)
            if state.at.value >= self.enough:
                return SolverStatus.ENOUGH
        if (
            k >= SETTINGS.min_iterations
            and self.error < self.tolerance
            and (not self.balanced or self._in_balance(dual_residual, dual_displacement, whole))
        ):
            return SolverStatus.CONVERGED
        if self.stop is not None and self.stop.is_set():
            return SolverStatus.STOPPED
        far = farthest_pulled(state.at.gradient, state.u) * state.at.program.length > self.horizon
        return (SolverStatus.ESCAPING if inside else SolverStatus.FAILED) if far else None

    def _in_balance(self, dual_residual: Floats, displacement: float, whole: float) -> bool:
        """True where the multipliers balance the objective."""
        return bool(
            displacement < np.sqrt(self.tolerance) * whole
            and np.abs(dual_residual).max() < max(10 * self.tolerance, SETTINGS.dual_tolerance)
        )
