"""Primal-dual interior-point method on the condensed system: the default solver.

Slacks and multipliers are eliminated, so one symmetric 3F x 3F matrix with the sparsity of the neighbour graph is factorised per
iteration. Mehrotra's predictor and corrector choose the centring; steps are taken along `Retraction`, which keeps long assemblies feasible
while they turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.program.nonlinear_program import Linearised, Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.carried_multipliers import MIN_CARRIED_SLACK
from wiggleroom.solve.convergence import ConvergenceMonitor
from wiggleroom.solve.factorisation import Factor, factor
from wiggleroom.solve.interior_point_settings import (
    INITIAL_BARRIER,
    LARGE_PROGRAM,
    MAX_LIFTS,
    MAX_PULLS,
    SETTINGS,
    SLACK_TOLERANCE,
    settings_for,
)
from wiggleroom.solve.monotone_barrier import MonotoneBarrier
from wiggleroom.solve.newton_step import Iterate, newton
from wiggleroom.solve.predictor_corrector import NewtonStep, predictor_corrector_step, take_step
from wiggleroom.solve.row_operations import dot, violation
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

MIN_CURVATURE = 1e-4
"""Least positive curvature [objective's unit per clearance squared] that counts."""
POWER_ITERATIONS = 6
"""Of the inverse iteration; a rough direction is enough."""


def solve(
    program: Program,
    start: Floats | None = None,
    *,
    mu: float = INITIAL_BARRIER,
    multipliers: Floats | None = None,
    tolerance: float = 1e-6,
    horizon: float = np.inf,
    enough: float = np.inf,
    exact: float = SLACK_TOLERANCE,
    balanced: bool = True,
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
    reached: Callable[[Floats], None] | None = None,
) -> Solution:
    """Largest objective from a point strictly inside all rows.

    Parameters
    ----------
    program : Program
    start : (3F,) float64, optional
        Strictly inside all rows; by default rest.
    mu : float
        Complementarity to begin with, as a share of the objective's largest derivative.
    multipliers : (R,) float64, optional
        To begin with, scaled as those of a `Solution`; by default every row has the same complementarity.
    tolerance : float
        Relative tolerance of the objective.
    horizon : float [mm]
        A body that moves further than this is taken to escape.
    enough : float [mm]
        A point inside all rows that is worth so much is good enough.
    exact : float
        A point inside all rows whose slacks are right to this share of `program.length` needs no more steps at the end.
    balanced : bool
        Whether the multipliers must be in balance with the objective at the end; without, only the motion is of use.
    stop, progress : optional
        Asked and told (iteration, objective) every iteration.
    reached : callable, optional
        Told every point from which the next program can start.

    Returns
    -------
    Solution
    """
    begin = np.zeros(len(program.scale)) if start is None else start.copy()
    matrix, retraction = factor(program.pattern), Retraction(program)
    unit = barrier_unit(program.linearise(begin))
    farthest = SETTINGS.max_step_share * horizon / program.length
    watch = ConvergenceMonitor(tolerance, horizon, enough, balanced, stop, progress, reached, begin, mu)

    def at_start(u: Floats, mu: float, least: float, lam: Floats | None = None) -> Iterate:
        at = program.linearise(u)
        s = np.maximum(at.h, least if lam is None else MIN_CARRIED_SLACK)
        lam = mu / s if lam is None else lam / unit
        return Iterate(u, s, lam, at, unit, np.zeros_like(u), SETTINGS.proximal_share * tolerance)

    def predictor_corrector(state: Iterate, dual_residual: Floats, least: float) -> bool:
        step = predictor_corrector_step(state, matrix, retraction, dual_residual, watch, least)
        if step is not None:
            take_step(state, step.capped(farthest), retraction, watch.infeasible)
        return step is not None

    for escapes in range(SETTINGS.max_saddle_escapes + 1):
        state = at_start(begin, mu, SETTINGS.initial_slack, None if escapes else multipliers)
        status = watch.follow(state, predictor_corrector, settings_for(len(begin)).max_iterations)
        if status is SolverStatus.FAILED and watch.feasible is not None:
            state = at_start(*watch.feasible[:2], 0.0)
            status = watch.follow(
                state,
                MonotoneBarrier(matrix, retraction, watch.feasible[1], farthest).advance,
                SETTINGS.max_monotone_iterations,
            )
        up = (
            ascent_direction(state, matrix, tolerance)
            if status is SolverStatus.CONVERGED and escapes < SETTINGS.max_saddle_escapes
            else None
        )
        if up is None:
            break
        begin, mu = perturbed_start(program, watch.inner[0], up), watch.inner[1]
        watch.rewind_to_inner()
    settled = restore_feasibility(state, matrix, retraction, exact) if status is SolverStatus.CONVERGED else state
    if status is SolverStatus.CONVERGED and watch.feasible is not None:
        settled = pulled_inside(settled, watch.feasible[0])
    inner = watch.feasible if status is SolverStatus.FAILED and watch.feasible else watch.inner
    return Solution(
        settled.u, settled.lam * unit, status, watch.iterations, inner[0], inner[1], tuple(watch.path), watch.error,
        None if inner[2] is None else inner[2] * unit,
    )  # fmt: skip


def barrier_unit(at: Linearised) -> float:
    """Largest derivative of the objective, by which multipliers are divided; 1 where there is none."""
    return float(np.abs(at.gradient).max()) or 1.0


def ascent_direction(state: Iterate, matrix: Factor, tolerance: float) -> Floats | None:
    """Direction (3F,) in which the objective curves upwards along the active walls, its largest entry 1; None at a true optimum.

    The condensed matrix is stiff across active walls, so it is positive definite where the second-order conditions hold; else the
    vector of its least eigenvalue runs along the walls.
    """
    data = state.at.condensed(state.lam / state.s, state.lam, share=1.0 / state.unit)
    shift = max(MIN_CURVATURE, 10 * tolerance * max(abs(state.at.value) / state.unit, 1.0))
    if matrix.update(data, shift):
        return None
    while not matrix.update(data, shift):
        shift *= 2
    v = np.random.default_rng(0).standard_normal(len(state.u))
    for _ in range(POWER_ITERATIONS):
        v = matrix.solve(v / np.abs(v).max())
    return v / np.abs(v).max()


def perturbed_start(program: Program, u: Floats, v: Floats) -> Floats:
    """A point on the better side of u along v, up to a clearance away and with at least half of the room to every wall."""
    room, share = program.values(u), 1.0
    while share > 1e-6:
        sides = [w for w in (u + share * v, u - share * v) if (program.values(w) > 0.5 * room).all()]
        if sides:
            return max(sides, key=lambda w: program.objective.value(program.motion(w)))
        share /= 2
    return u


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
