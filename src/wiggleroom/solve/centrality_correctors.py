"""Centrality correctors: they move products of slack and multiplier that fall out of line towards their mean, so that steps become longer.

Each costs one more solution with the same factor. Source: Gondzio 1996; the share of a corrector that is used: Colombo and Gondzio 2008.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.parallel.batches import in_batches
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import Direction, Iterate, newton
from wiggleroom.solve.row_operations import add_share, centring_goal, step_lengths

Floats = NDArray[np.float64]

MAX_CORRECTORS = 4
"""Correctors of one step at most."""
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


def corrected(state: Iterate, matrix: Factor, direction: Direction, mean: float, goal: Floats) -> Direction:
    """The direction, changed in place so that longer steps are possible along it; products should come near `mean`.

    `goal` (R,) is worked in.
    """
    still = np.zeros_like(direction.u)
    for _ in range(MAX_CORRECTORS):
        if min(direction.primal_step, direction.dual_step) > LONG:
            break
        _aim(state, direction, mean, goal)
        longer = _with_corrector(state, direction, newton(state, matrix, still, goal, share=0.0))
        if longer is None:
            break
        direction = longer
    return direction


def _aim(state: Iterate, direction: Direction, mean: float, goal: Floats) -> None:
    """Fill `goal` (R,) with what brings products into line after steps a little longer than the direction allows."""
    s, lam, ds, dlam = state.s, state.lam, direction.s, direction.lam
    far, dual_far = min(1.0, direction.primal_step + ASPIRED_STEP), min(1.0, direction.dual_step + ASPIRED_STEP)
    least, most = NARROWEST * mean, WIDEST * mean

    def aim(some: slice) -> None:
        centring_goal(s[some], ds[some], lam[some], dlam[some], far, dual_far, least, most, goal[some])

    in_batches(len(s), state.at.program.batches, aim)


def _with_corrector(state: Iterate, direction: Direction, more: Direction) -> Direction | None:
    """The direction with the share of a corrector that allows the longest steps, changed in place; None where none is much longer."""
    s, lam, ds, dlam, batches = state.s, state.lam, direction.s, direction.lam, state.at.program.batches
    shares = np.array(SHARES)

    def lengths(some: slice) -> Floats:
        out = np.empty((2, len(SHARES)))
        step_lengths(s[some], ds[some], more.s[some], shares, out[0])
        step_lengths(lam[some], dlam[some], more.lam[some], shares, out[1])
        return out

    steps = np.min(in_batches(len(s), batches, lengths), axis=0)
    best = int(np.argmax(steps.sum(axis=0)))
    primal_step, dual_step = steps[:, best].tolist()
    if primal_step + dual_step < direction.primal_step + direction.dual_step + MIN_LONGER:
        return None

    def add(some: slice) -> None:
        add_share(ds[some], more.s[some], SHARES[best])
        add_share(dlam[some], more.lam[some], SHARES[best])

    in_batches(len(s), batches, add)
    add_share(direction.u, more.u, SHARES[best])
    return replace(direction, primal_step=primal_step, dual_step=dual_step)
