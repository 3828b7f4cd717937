"""Fallback: a feasible monotone barrier method. Every iterate is feasible, and every step makes the barrier function smaller.

The default method lets slacks differ from the values of their rows and catch up later. Where that cycles, or a body moves so far that
the rows no longer describe it, this method takes over from the last feasible point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import MIN_SHIFT, Iterate, newton
from wiggleroom.solve.row_operations import dot

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BarrierSettings:
    """Parameters of the method.

    Parameters
    ----------
    fraction_to_boundary : float in (0, 1)
        Share of the step to the nearest bound that is taken.
    barrier_reduction : float in (0, 1)
        mu becomes this share of itself when the subproblem at one mu is solved.
    subproblem_tolerance : float > 1
        A subproblem is solved when its residual is below this multiple of mu.
    armijo_share : float in (0, 1)
        Share of the predicted decrease that a step must bring.
    max_multiplier_ratio : float > 1
        A multiplier may differ from mu / slack by this factor.
    max_backtracks : int
        Halvings of one step.
    max_extension : float > 1
        Longest multiple of a step that is tried where a strengthened diagonal keeps it short.
    min_kept_shift : float > 0
        A shift of the diagonal up to this is not kept for the next step. A larger one is divided by `shift_decay`.
    shift_decay, shift_growth : float > 1
        By how much a shift becomes smaller for the next step, and larger while the matrix is not positive definite.
    definite_shift : float > 0
        First shift after the least one where the matrix is not positive definite.
    max_free_shift : float > 0
        A diagonal strengthened by more than this keeps steps short.
    """

    fraction_to_boundary: float = 0.995
    barrier_reduction: float = 0.2
    subproblem_tolerance: float = 10.0
    armijo_share: float = 1e-4
    max_multiplier_ratio: float = 1e8
    max_backtracks: int = 40
    max_extension: float = 1024.0
    min_kept_shift: float = 1e-8
    shift_decay: float = 3.0
    shift_growth: float = 8.0
    definite_shift: float = 1e-5
    max_free_shift: float = 1e-3


SETTINGS = BarrierSettings()


class MonotoneBarrier:
    """Steps from a feasible state to another one, with a mu that only falls.

    Parameters
    ----------
    matrix, retraction : Factor, Retraction
        Of the program.
    mu : float
        Complementarity to begin with.
    farthest : float
        No body moves further in one step [program.length].

    Source: the monotone mode of Wachter and Biegler 2006 (IPOPT), with slacks that are the rows themselves.
    """

    def __init__(self, matrix: Factor, retraction: Retraction, mu: float, farthest: float) -> None:
        self._matrix, self._retraction, self._mu, self._farthest = matrix, retraction, mu, farthest
        self._shift = MIN_SHIFT

    def advance(self, state: Iterate, dual_residual: Floats, least: float) -> bool:
        """Improve the state by one step; False where nothing does. mu stays above `least`."""
        s, lam, at = state.s, state.lam, state.at
        wrong = float(np.abs(dual_residual).max(initial=0.0))
        while (
            self._mu > least
            and max(wrong, np.abs(s * lam - self._mu).max(initial=0.0)) < SETTINGS.subproblem_tolerance * self._mu
        ):
            self._mu = max(SETTINGS.barrier_reduction * self._mu, least)
        mu, shift = self._mu, self._shift
        data = at.condensed(lam / s, lam, self._retraction.balance(dual_residual, at), 1.0 / state.unit)
        while not self._matrix.update(data, shift + state.proximal_weight):
            shift = max(SETTINGS.shift_growth * shift, SETTINGS.definite_shift)
        step = newton(state, self._matrix, dual_residual, mu - s * lam)
        far = float(np.abs(step.u).max(initial=0.0))
        share = min(_step_to_boundary(s, step.s), 1.0, self._farthest / far if far > 0 else 1.0)
        if not _line_search(state, self._retraction, step.u, share, mu, strides=shift > SETTINGS.max_free_shift):
            return False
        lam = lam + (SETTINGS.fraction_to_boundary * step.dual_step if step.dual_step < 1 else 1.0) * step.lam
        state.lam = np.clip(
            lam, mu / (SETTINGS.max_multiplier_ratio * state.s), SETTINGS.max_multiplier_ratio * mu / state.s
        )
        state.move = step.u
        self._shift = MIN_SHIFT if shift <= SETTINGS.min_kept_shift else shift / SETTINGS.shift_decay
        return True


def _step_to_boundary(s: Floats, ds: Floats) -> float:
    """Share of a step that leads up to the nearest bound, as the rows' derivatives foresee it."""
    shrinking = ds < 0
    return SETTINGS.fraction_to_boundary * float((-s[shrinking] / ds[shrinking]).min()) if shrinking.any() else np.inf


def _line_search(state: Iterate, retraction: Retraction, du: Floats, share: float, mu: float, strides: bool) -> bool:
    """Move along `du`: as far as `share`, less where that is infeasible or brings too little, more where it pays; False in vain."""
    here, weight = state.at, state.proximal_weight
    now = _barrier(here, state.u, mu, state.unit, weight)
    slope = dot(weight * state.u - here.gradient / state.unit - here.transposed_jacobian_product(mu / here.h), du)
    for _ in range(SETTINGS.max_backtracks):
        u = retraction.step(state.u, share * du, here)
        at = here.program.linearise(u)
        after = _barrier(at, u, mu, state.unit, weight)
        if after <= now + SETTINGS.armijo_share * share * min(slope, 0.0) + 1e-13 * abs(now):
            break
        share /= 2
    else:
        return False
    longer = 4 * share
    while strides and longer <= SETTINGS.max_extension:
        v = retraction.step(state.u, longer * du, here)
        further = here.program.linearise(v)
        value = _barrier(further, v, mu, state.unit, weight)
        if not value < after:
            break
        u, at, after, longer = v, further, value, 4 * longer
    state.u, state.at, state.s = u, at, at.h.copy()
    return True


def _barrier(at: Linearised, u: Floats, mu: float, unit: float, weight: float) -> float:
    """Barrier function at a point, infinite outside the rows."""
    if at.h.min(initial=np.inf) <= 0:
        return np.inf
    return -at.value / unit - mu * float(np.log(at.h).sum()) + weight / 2 * dot(u, u)
