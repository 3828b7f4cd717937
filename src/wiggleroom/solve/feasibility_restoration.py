"""The end of the interior-point method: rows that are violated by a little are satisfied, and the motion hardly changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.interior_point_settings import LARGE_PROGRAM, MAX_LIFTS, MAX_PULLS, SETTINGS, SLACK_TOLERANCE
from wiggleroom.solve.newton_step import Iterate, newton
from wiggleroom.solve.predictor_corrector import NewtonStep, take_step
from wiggleroom.solve.row_operations import dot, violation

Floats = NDArray[np.float64]


def restore_feasibility(state: Iterate, matrix: Factor, retraction: Retraction, exact: float) -> Iterate:
    """A few centred steps that remove the remaining infeasibility; bodies that nothing holds stay where they are.

    In large programs a point inside all rows is good enough: there slacks are as right as the tolerance asks.
    """
    large = len(state.u) > LARGE_PROGRAM
    exact = np.inf if large else exact
    mu = dot(state.s, state.lam) / max(len(state.s), 1)
    for _ in range(6):
        dual_residual, _, _ = state.residuals()
        wrong = np.abs(state.s - state.at.h).max(initial=0.0)
        if wrong < SLACK_TOLERANCE or (wrong < exact and state.at.h.min(initial=np.inf) > 0):
            break
        data = state.at.condensed(
            state.lam / state.s, state.lam, retraction.balance(dual_residual, state.at), 1.0 / state.unit
        )
        shift = max(state.shift, 1e-2)
        while not matrix.update(data, shift):
            shift *= 10
        step = NewtonStep.to_boundary(newton(state, matrix, dual_residual, mu - state.s * state.lam), shift)
        if large and step.primal_step < SETTINGS.min_restoring_step:
            del step, data  # in assemblies of a million parts these arrays count
            return _lifted(state, matrix, retraction)
        take_step(state, step, retraction, violation(state.lam, state.s, state.at.h))
    return state


def _lifted(state: Iterate, matrix: Factor, retraction: Retraction) -> Iterate:
    """The state, moved as little as can be, in the metric of its slacks, until rows that lie below their slacks have come up to them."""
    u, at, s = state.u, state.at, state.s
    weight, none = 1.0 / np.maximum(s, SETTINGS.lifted_slack) ** 2, np.zeros_like(s)
    for _ in range(MAX_LIFTS):
        short = np.maximum(s - at.h, 0.0)
        if at.h.min(initial=np.inf) >= 0.0:
            break
        shift = 1e-2
        while not matrix.update(at.condensed(weight, none, share=0.0), shift):
            shift *= 100
        u = retraction.step(u, matrix.solve(at.transposed_jacobian_product(weight * short)), at)
        at = at.program.linearise(u, None if at is state.at else at)
    return replace(state, u=u, at=at, s=np.maximum(at.h, SETTINGS.min_slack)) if at.h.min() >= 0.0 else state


def pulled_inside(state: Iterate, inside: Floats) -> Iterate:
    """The state, or where rows are still violated there the last point of the segment from a feasible point to it that is feasible."""
    if state.at.h.min(initial=np.inf) >= 0:
        return state
    program, room = state.at.program, state.at.program.values(inside)
    below = state.at.h < 0
    share = float((room[below] / (room[below] - state.at.h[below])).min())
    for _ in range(MAX_PULLS):
        at = program.linearise(inside + share * (state.u - inside))
        if at.h.min() >= 0:
            break
        share *= 0.9
    else:
        return state
    u = inside + share * (state.u - inside)
    return replace(state, u=u, at=at, s=np.maximum(at.h, SETTINGS.min_slack))
