"""Centrality correctors: they move products of slack and multiplier that fall out of line towards their mean, so that steps become longer.

Each costs one more solution with the same factor. Source: Gondzio 1996; the share of a corrector that is used: Colombo and Gondzio 2008.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import Iterate, max_step

Floats = NDArray[np.float64]
Direction = tuple[Floats, Floats, Floats]

MAX_CORRECTORS = 2
ASPIRED_STEP = 0.3
"""A corrector aims at steps that are longer by this."""
NARROWEST, WIDEST = 0.1, 10.0
"""Products between these multiples of their mean are in line."""
SHARES = 1.0, 0.6, 0.3
"""Shares of a corrector that are tried."""
MIN_LONGER = 0.02
"""Both steps together must become longer by this."""
LONG = 0.95
"""Steps that are longer than this need no corrector."""


def corrected(state: Iterate, matrix: Factor, direction: Direction, mean: float) -> Direction:
    """A direction (du, ds, dlam) along which longer steps are possible, or the same; products should come near `mean`."""
    s, lam, at = state.s, state.lam, state.at
    du, ds, dl = direction
    far, dfar = max_step(s, ds), max_step(lam, dl)
    for _ in range(MAX_CORRECTORS):
        if min(far, dfar) > LONG:
            break
        product = (s + min(1.0, far + ASPIRED_STEP) * ds) * (lam + min(1.0, dfar + ASPIRED_STEP) * dl)
        goal = np.maximum(np.clip(product, NARROWEST * mean, WIDEST * mean) - product, -WIDEST * mean)
        more = matrix.solve(at.against(goal / s))
        more_s = at.along(more)
        more_lam = (goal - lam * more_s) / s
        trials = [(share, max_step(s, ds + share * more_s), max_step(lam, dl + share * more_lam)) for share in SHARES]
        share, longer, dual_longer = max(trials, key=lambda trial: trial[1] + trial[2])
        if longer + dual_longer < far + dfar + MIN_LONGER:
            break
        far, dfar = longer, dual_longer
        du, ds, dl = du + share * more, ds + share * more_s, dl + share * more_lam
    return du, ds, dl
