"""One step of Mehrotra's predictor and corrector, and how much of it is taken."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.parallel.batches import in_batches
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.convergence import ConvergenceMonitor
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.interior_point_settings import SETTINGS, settings_for
from wiggleroom.solve.newton_step import MIN_SHIFT, Direction, Iterate, newton
from wiggleroom.solve.row_operations import (
    add_share,
    centring_goal,
    corrector_goal,
    dot,
    gap_after,
    step_lengths,
    stepped_slacks,
)

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


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """A direction, and how far to go along it.

    Parameters
    ----------
    u, s, lam : (3F,), (R,), (R,) float64
        Changes of variables, slacks and multipliers.
    primal_step, dual_step : float in [0, 1]
        Shares of the first two, and of the multipliers, that are taken.
    shift : float
        What strengthened the diagonal.
    """

    u: Floats
    s: Floats
    lam: Floats
    primal_step: float
    dual_step: float
    shift: float

    @classmethod
    def to_boundary(cls, direction: Direction, shift: float) -> NewtonStep:
        """All of a direction, or most of the way to where a slack or a multiplier becomes nothing."""
        share = SETTINGS.fraction_to_boundary
        primal_step = share * direction.primal_step if direction.primal_step < 1 else 1.0
        dual_step = share * direction.dual_step if direction.dual_step < 1 else 1.0
        return cls(direction.u, direction.s, direction.lam, primal_step, dual_step, shift)

    def capped(self, longest: float) -> NewtonStep:
        """The same, but no body moves further than `longest` [program.length] at once."""
        far = float(np.abs(self.u).max(initial=0.0))
        return self if self.primal_step * far <= longest else replace(self, primal_step=longest / far)


def predictor_corrector_step(
    state: Iterate,
    matrix: Factor,
    retraction: Retraction,
    dual_residual: Floats,
    watch: ConvergenceMonitor,
    least: float,
) -> NewtonStep | None:
    """The next step, and with it the barrier parameter.

    The predictor aims at mu = 0. The next mu is centring times mu, at least `least`, where centring is (mu after the predictor / mu)^3;
    where feasibility or balance falls behind complementarity it is no less than the ratio of the two, up to `max_centring`, and after a
    step that raised the objective much no less than `moving_centring`. The corrector then aims at the next mu. The diagonal is strengthened
    until the matrix is positive definite and the step is not too short.

    The imbalance ratio is the work of the dual residual along the whole motion so far: early this tells how far bodies still go, at the end
    of a long motion it says far too much. There the Newton decrement, what the residual would bring in the quadratic model, takes its place
    where it is less. A strengthened diagonal makes that too small, so it counts without one alone.

    Source: Mehrotra 1992; the lower limits of the centring are ours. Newton decrement: Boyd and Vandenberghe 2004, section 9.5.
    """
    s, lam, at, mu = state.s, state.lam, state.at, watch.mu
    settings = settings_for(len(state.u))
    data = at.condensed(lam / s, lam, retraction.balance(dual_residual, at), 1.0 / state.unit)
    shift = MIN_SHIFT if state.shift <= settings.min_kept_shift else state.shift / SETTINGS.shift_decay
    found, goal = None, np.empty_like(s)
    for attempt in range(SETTINGS.max_factorisations):
        if not matrix.update(data, shift + state.proximal_weight):
            shift = max(SETTINGS.shift_growth * shift, SETTINGS.definite_shift)
            continue
        found = direction = None  # of the attempt before: in assemblies of a million parts these arrays count
        np.negative(np.multiply(s, lam, out=goal), out=goal)
        predictor = newton(state, matrix, dual_residual, goal)
        gap = gap_after(s, predictor.s, lam, predictor.lam, predictor.primal_step, predictor.dual_step)
        centring = (gap / max(len(s), 1) / mu) ** 3 if mu > 0 else 0.0
        behind = watch.imbalance_ratio
        if behind > SETTINGS.max_infeasibility_ratio and shift <= MIN_SHIFT:
            decrement = dot(dual_residual, matrix.solve(dual_residual))
            behind = min(behind, SETTINGS.decrement_weight * decrement / (mu * len(s)))
        behind = max(behind, watch.infeasibility_ratio)
        if behind > SETTINGS.max_infeasibility_ratio:  # feasibility must not fall behind complementarity
            centring = max(centring, min(settings.max_centring, behind))
        if state.growth > settings.min_growth:
            centring = max(centring, settings.moving_centring)
        next_mu = max(centring * mu, least)
        corrector_goal(s, predictor.s, lam, predictor.lam, next_mu, SETTINGS.max_correction * mu, goal)
        del predictor
        direction = newton(state, matrix, dual_residual, goal)
        if mu * len(s) < settings.corrected_gap * max(abs(at.value) / state.unit, 1.0):
            direction = corrected(state, matrix, direction, next_mu, goal)
        found = NewtonStep.to_boundary(direction, shift)
        if found.primal_step > SETTINGS.min_step_length or attempt >= SETTINGS.max_lengthenings:
            break
        shift = max(SETTINGS.shift_growth * shift, settings.longer_step_shift)
    stuck = found is not None and found.shift > SETTINGS.hopeless_shift and found.primal_step < SETTINGS.min_step_length
    return None if stuck else found


def take_step(state: Iterate, step: NewtonStep, retraction: Retraction, before: float) -> None:
    """Take the step; halve it while the violation of rows, now `before`, grows and exceeds half the complementarity.

    Rows and derivatives at the new point take the place of those at the old one: in assemblies of a million parts these arrays count.
    """
    lam, value = state.lam + step.dual_step * step.lam, state.at.value
    share = step.primal_step
    # full steps in a row that a strengthened diagonal keeps short: nothing is in the way, so try longer ones
    short = step.primal_step == 1.0 and step.shift > SETTINGS.max_free_shift
    state.stride = min(SETTINGS.stride_growth * state.stride, SETTINGS.max_stride) if short else 1.0
    if state.stride > SETTINGS.stride_growth:
        u = retraction.step(state.u, state.stride * step.u, state.at)
        at = state.at.program.linearise(u, state.at)
        if at.h.min(initial=np.inf) > 0 and at.value > state.at.value:
            state.move, state.shift = step.u, step.shift
            state.u, state.s, state.lam, state.at = u, at.h.copy(), lam, at
            return
        state.stride = 1.0
    s = np.empty_like(lam)
    for _ in range(SETTINGS.max_halvings + 1):
        u = retraction.step(state.u, share * step.u, state.at)
        at = state.at.program.linearise(u, state.at)
        wrong, gap = stepped_slacks(state.s, step.s, share, lam, at.h, SETTINGS.min_slack, s)
        if wrong <= max(SETTINGS.max_violation * gap, SETTINGS.max_violation_growth * before):
            break
        share /= 2
    state.move, state.shift = step.u, step.shift
    state.u, state.s, state.lam, state.at = u, s, lam, at
    state.growth = (at.value - value) / max(abs(at.value), state.unit)


def corrected(state: Iterate, matrix: Factor, direction: Direction, mean: float, goal: Floats) -> Direction:
    """The direction, changed in place so that longer steps are possible along it; products should come near `mean`.

    Centrality correctors move products of slack and multiplier that fall out of line towards their mean. Each costs one more solution
    with the same factor. Source: Gondzio 1996; the share of a corrector that is used: Colombo and Gondzio 2008.

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
