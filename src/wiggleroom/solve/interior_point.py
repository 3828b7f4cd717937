"""Primal-dual interior-point method on the condensed system: the default solver.

Slacks and multipliers are eliminated, so one symmetric 3F x 3F matrix with the sparsity of the neighbour graph is factorised per
iteration. Mehrotra's predictor and corrector choose the centring; steps are taken along `Retraction`, which keeps long assemblies feasible
while they turn.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.program.nonlinear_program import Linearised, Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.carried_multipliers import MIN_CARRIED_SLACK
from wiggleroom.solve.convergence import ConvergenceMonitor
from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.feasibility_restoration import pulled_inside, restore_feasibility
from wiggleroom.solve.interior_point_settings import INITIAL_BARRIER, SETTINGS, SLACK_TOLERANCE, settings_for
from wiggleroom.solve.monotone_barrier import MonotoneBarrier
from wiggleroom.solve.newton_step import Iterate
from wiggleroom.solve.predictor_corrector import predictor_corrector_step, take_step
from wiggleroom.solve.saddle_escape import ascent_direction, perturbed_start
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]


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
        step = predictor_corrector_step(
            state, matrix, retraction, dual_residual, watch.mu, watch.infeasibility_ratio, watch.imbalance_ratio, least
        )
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
