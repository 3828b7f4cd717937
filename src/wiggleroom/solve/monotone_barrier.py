"""The slow and certain way: every iterate is legal, and every step makes the barrier function smaller.

Quick steps let slacks fall behind the true rows and catch up later. Where that goes round in circles, or a body flies off into the open
and leaves the rows behind, this takes over from the last legal point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import MIN_SHIFT, State, dot, longest, newton

Floats = NDArray[np.float64]

FRACTION_TO_BOUNDARY = 0.995
"""Share of the way to the nearest wall that a step may use."""
BARRIER_REDUCTION = 0.2
"""mu becomes this share of itself when the problem at one mu is solved."""
SUBPROBLEM_TOLERANCE = 10.0
"""A problem is solved when its residual is below this multiple of mu."""
ARMIJO_SHARE = 1e-4
"""Share of the foreseen descent that a step must bring."""
MAX_MULTIPLIER_RATIO = 1e8
"""A multiplier may differ from mu / slack by this factor."""
MAX_BACKTRACKS = 40
MAX_STRIDE = 1024.0
MAX_FREE_SHIFT = 1e-3
"""A diagonal strengthened by more than this keeps steps short; then longer ones are tried."""


class Careful:
    """Steps from a legal state to another one, with a mu that only falls.

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

    def advance(self, state: State, primal: Floats, dual: Floats, least: float) -> bool:
        """Improve the state by one step; False where nothing does. mu stays above `least`."""
        s, lam, at = state.s, state.lam, state.at
        wrong = float(np.abs(dual).max(initial=0.0))
        while (
            self._mu > least
            and max(wrong, np.abs(s * lam - self._mu).max(initial=0.0)) < SUBPROBLEM_TOLERANCE * self._mu
        ):
            self._mu = max(BARRIER_REDUCTION * self._mu, least)
        mu, shift = self._mu, self._shift
        data = at.condensed(lam / s, lam, self._retraction.balance(dual, at), 1.0 / state.unit)
        while not self._matrix.update(data, shift + state.pull_home):
            shift = max(8 * shift, 1e-5)
        du, ds, dlam = newton(state, self._matrix, primal, dual, mu - s * lam)
        far = float(np.abs(du).max(initial=0.0))
        share = min(_to_the_wall(s, ds), 1.0, self._farthest / far if far > 0 else 1.0)
        if not _descend(state, self._retraction, du, share, mu, strides=shift > MAX_FREE_SHIFT):
            return False
        reach = longest(lam, dlam)
        lam = lam + (FRACTION_TO_BOUNDARY * reach if reach < 1 else 1.0) * dlam
        state.lam = np.clip(lam, mu / (MAX_MULTIPLIER_RATIO * state.s), MAX_MULTIPLIER_RATIO * mu / state.s)
        state.move = du
        self._shift = MIN_SHIFT if shift <= 1e-8 else shift / 3
        return True


def _to_the_wall(s: Floats, ds: Floats) -> float:
    """Share of a step that uses up FRACTION of the room to the nearest wall, as the rows' derivatives foresee it."""
    shrinking = ds < 0
    return FRACTION_TO_BOUNDARY * float((-s[shrinking] / ds[shrinking]).min()) if shrinking.any() else np.inf


def _descend(state: State, retraction: Retraction, du: Floats, share: float, mu: float, strides: bool) -> bool:
    """Move along `du`: as far as `share`, less where that is illegal or brings too little, more where it pays; False in vain."""
    here, weight = state.at, state.pull_home
    now = _barrier(here, state.u, mu, state.unit, weight)
    slope = dot(weight * state.u - here.gradient / state.unit - here.against(mu / here.h), du)
    for _ in range(MAX_BACKTRACKS):
        u = retraction.step(state.u, share * du, here)
        at = here.program.linearise(u)
        after = _barrier(at, u, mu, state.unit, weight)
        if after <= now + ARMIJO_SHARE * share * min(slope, 0.0) + 1e-13 * abs(now):
            break
        share /= 2
    else:
        return False
    longer = 4 * share
    while strides and longer <= MAX_STRIDE:
        v = retraction.step(state.u, longer * du, here)
        further = here.program.linearise(v)
        value = _barrier(further, v, mu, state.unit, weight)
        if not value < after:
            break
        u, at, after, longer = v, further, value, 4 * longer
    state.u, state.at, state.s = u, at, at.h
    return True


def _barrier(at: Linearised, u: Floats, mu: float, unit: float, weight: float) -> float:
    """Barrier function at a point, infinite outside the rows."""
    if at.h.min(initial=np.inf) <= 0:
        return np.inf
    return -at.value / unit - mu * float(np.log(at.h).sum()) + weight / 2 * dot(u, u)
