"""Centrality correctors: they move products of slack and multiplier that fall out of line towards their mean, so that steps become longer.

Each costs one more solution with the same factor. Source: Gondzio 1996; the share of a corrector that is used: Colombo and Gondzio 2008.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import Direction, Iterate, newton
from wiggleroom.solve.row_operations import add_share, centring_goal, step_lengths

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
    """The direction, changed in place so that longer steps are possible along it; products should come near `mean`."""
    s, lam = state.s, state.lam
    goal, none, shares = np.empty_like(s), np.zeros_like(s), np.array(SHARES)
    still, steps, dual_steps = np.zeros_like(direction.u), np.empty(len(SHARES)), np.empty(len(SHARES))
    for _ in range(MAX_CORRECTORS):
        far, dfar = direction.primal, direction.dual
        if min(far, dfar) > LONG:
            break
        aspired, dual_aspired = min(1.0, far + ASPIRED_STEP), min(1.0, dfar + ASPIRED_STEP)
        centring_goal(s, direction.s, lam, direction.lam, aspired, dual_aspired, NARROWEST * mean, WIDEST * mean, goal)
        more = newton(state, matrix, none, still, goal)
        step_lengths(s, direction.s, more.s, shares, steps)
        step_lengths(lam, direction.lam, more.lam, shares, dual_steps)
        best = int(np.argmax(steps + dual_steps))
        if steps[best] + dual_steps[best] < far + dfar + MIN_LONGER:
            break
        for whole, part in ((direction.u, more.u), (direction.s, more.s), (direction.lam, more.lam)):
            add_share(whole, part, SHARES[best])
        del more, whole, part  # in assemblies of a million parts these arrays count
        direction = replace(direction, primal=float(steps[best]), dual=float(dual_steps[best]))
    return direction
