"""Centrality correctors: they move products of slack and multiplier that fall out of line towards their mean, so that steps become longer.

Each costs one more solution with the same factor. Source: Gondzio 1996; the share of a corrector that is used: Colombo and Gondzio 2008.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import Direction, Iterate, max_step, newton
from wiggleroom.solve.row_operations import add_share, centring_goal, step_length

Floats = NDArray[np.float64]

MAX_CORRECTORS = 4
ASPIRED_STEP = 0.3
"""A corrector aims at steps that are longer by this."""
NARROWEST, WIDEST = 0.1, 10.0
"""Products between these multiples of their mean are in line."""
SHARES = 1.0, 0.6, 0.3
"""Shares of a corrector that are tried."""
MIN_LONGER = 0.01
"""Both steps together must become longer by this."""
LONG = 0.99
"""Steps that are longer than this need no corrector."""


def corrected(state: Iterate, matrix: Factor, direction: Direction, mean: float) -> Direction:
    """The direction (du, ds, dlam), changed so that longer steps are possible along it; products should come near `mean`."""
    s, lam = state.s, state.lam
    du, ds, dl = direction
    goal, none = np.empty_like(s), np.zeros_like(s)
    far, dfar = max_step(s, ds), max_step(lam, dl)
    for _ in range(MAX_CORRECTORS):
        if min(far, dfar) > LONG:
            break
        aspired, dual_aspired = min(1.0, far + ASPIRED_STEP), min(1.0, dfar + ASPIRED_STEP)
        centring_goal(s, ds, lam, dl, aspired, dual_aspired, NARROWEST * mean, WIDEST * mean, goal)
        more, more_s, more_lam = newton(state, matrix, none, np.zeros_like(du), goal)
        trials = [(step_length(s, ds, more_s, share), step_length(lam, dl, more_lam, share)) for share in SHARES]
        best = int(np.argmax([sum(steps) for steps in trials]))
        if sum(trials[best]) < far + dfar + MIN_LONGER:
            break
        far, dfar = trials[best]
        for whole, part in ((du, more), (ds, more_s), (dl, more_lam)):
            add_share(whole, part, SHARES[best])
    return du, ds, dl
