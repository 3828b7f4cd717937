"""Primal-dual interior-point method on the condensed system: the default solver.

Slacks and multipliers are eliminated, so one symmetric 3F x 3F matrix with the sparsity of the neighbour graph is factorised per
iteration. Mehrotra's predictor and corrector choose the centring; steps are taken along `Retraction`, which keeps long assemblies feasible
while they turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.program.nonlinear_program import Linearised, Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.carried_multipliers import LEAST_CARRIED_SLACK
from wiggleroom.solve.centrality_correctors import corrected
from wiggleroom.solve.factorisation import Factor, factor
from wiggleroom.solve.monotone_barrier import MonotoneBarrier
from wiggleroom.solve.newton_step import MIN_SHIFT, Iterate, dot, max_step, newton
from wiggleroom.solve.saddle_escape import ascent_direction, perturbed_start
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

INITIAL_BARRIER = 0.1
"""Complementarity to begin with, as a share of the objective's largest derivative."""
WARM_START_GAP = 3e-2
"""The next program starts at the last feasible iterate whose complementarity was still this share of the objective."""
SLACK_TOLERANCE = 1e-12
"""Slacks that are right to this share of `program.length` are exact."""
MAX_LIFTS = 8
"""Most steps that lift rows that are violated at the end."""
MAX_PULLS = 60
"""Most points tried between a feasible point and an end that violates rows."""


@dataclass(frozen=True)
class Settings:
    """Parameters of the method.

    Parameters
    ----------
    fraction_to_boundary : float in (0, 1)
        Share of the step to the nearest bound that is taken; nearer to 1 is quicker and less safe.
    max_correction : float > 1
        Mehrotra's second-order term is kept within this multiple of mu; larger ones come from steps too long to trust.
    min_step_length : float in (0, 1)
        A shorter step is tried again with a stronger diagonal.
    min_slack : float > 0 [program.length]
        Slacks never become smaller: their reciprocals stay finite.
    initial_slack : float > 0 [program.length]
        Slacks begin no smaller: a wall right beside the start would block every step away from the others.
    max_step_share : float in (0, 1)
        Share of the horizon that a body may move in one iteration.
    proximal_share : float in (0, 1)
        Share of the tolerance that may be given up to stay near rest, so that bodies that nothing holds do not drift.
    dual_error_ratio, dual_error_floor, dual_error_allowance : float in (0, 1)
        Bound on dual residual times displacement since the start, relative to the duality gap; it counts where it exceeds the floor, a
        share of the objective, as far as it exceeds the allowance. Without allowance it sets in with a jump, which is quick; in large
        programs such jumps follow each other.
    dual_tolerance : float in (0, 1)
        Largest dual residual at the end, as a share of the objective's largest derivative.
    min_iterations, max_iterations, max_monotone_iterations : int
        Of the predictor-corrector method, and of the monotone barrier method that takes over where it fails.
    max_stalled_iterations : int
        After so many iterations that do not reduce the error the predictor-corrector method has failed.
    max_saddle_escapes : int
        Most escapes from saddle points, where the first-order conditions hold but the objective curves upwards.
    max_free_shift : float > 0
        A diagonal strengthened by more than this keeps steps short; then longer ones are tried.
    hopeless_shift : float > 0
        Where steps are too short even with a diagonal strengthened by this, a violated row whose slack has become nothing blocks them.
    max_centring : float > 0
        Where feasibility falls behind, complementarity becomes at most this multiple of what it was.
    min_restoring_step, lifted_slack : float in (0, 1), float > 0 [program.length]
        At the end of large programs, where steps that restore feasibility are shorter than the first, violated rows alone are
        lifted; slacks below the second weigh no more there.
    corrected_gap : float in (0, 1)
        Centrality correctors lengthen the steps of large programs from this share of the objective on: before, they lead into worse basins.
    """

    fraction_to_boundary: float = 0.99
    max_correction: float = 10.0
    min_step_length: float = 0.05
    min_slack: float = 1e-14
    initial_slack: float = 1e-3
    max_step_share: float = 0.1
    proximal_share: float = 0.01
    dual_error_ratio: float = 0.3
    dual_error_floor: float = 0.05
    dual_error_allowance: float = 0.0
    dual_tolerance: float = 1e-3
    min_iterations: int = 3
    max_iterations: int = 100
    max_monotone_iterations: int = 200
    max_stalled_iterations: int = 30
    max_saddle_escapes: int = 2
    max_free_shift: float = 1e-3
    hopeless_shift: float = 1e6
    max_centring: float = 10.0
    min_restoring_step: float = 0.7
    lifted_slack: float = 1e-9
    corrected_gap: float = 0.0


SETTINGS = Settings()
LARGE_PROGRAM = 300
"""Programs of more variables are large: they take more iterations, so these are made to count, and roundings add up."""
LARGE_SETTINGS = replace(SETTINGS, max_centring=1.0, dual_error_allowance=SETTINGS.dual_error_floor, corrected_gap=0.3)


def settings_for(variables: int) -> Settings:
    """Parameters for a program of so many variables."""
    return LARGE_SETTINGS if variables > LARGE_PROGRAM else SETTINGS


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a solver ended.

    Parameters
    ----------
    u : (3F,) float64
        Scaled variables.
    lam : (R,) float64
        Multipliers of the rows: objective [mm] per unit of `program.length`, scaled so that the largest derivative of the objective is 1.
    status : SolverStatus
    iterations : int
    inner : (3F,) float64
        A point well inside all rows on the way, from which the next program can start.
    inner_mu : float
        Mean complementarity there, as a share of the objective's largest derivative.
    way : tuple of (3F,) float64
        Points inside all rows on the way from the start.
    error : float
        Largest of complementarity, violation and dual residual, in units of the objective.
    inner_lam : (R,) float64, optional
        Multipliers at the inner point, scaled as `lam`.
    """

    u: Floats
    lam: Floats
    status: SolverStatus
    iterations: int
    inner: Floats
    inner_mu: float
    way: tuple[Floats, ...] = ()
    error: float = 0.0
    inner_lam: Floats | None = None


@dataclass(frozen=True, eq=False)
class _Step:
    u: Floats
    s: Floats
    lam: Floats
    primal: float
    dual: float
    shift: float

    def capped(self, longest: float) -> _Step:
        """The same, but no body moves further than `longest` [program.length] at once."""
        far = float(np.abs(self.u).max(initial=0.0))
        return self if self.primal * far <= longest else replace(self, primal=longest / far)


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
        Share of the objective that may be left on the table.
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
    watch = _Monitor(tolerance, horizon, enough, balanced, stop, progress, reached, begin, mu)

    def at_start(u: Floats, mu: float, least: float, lam: Floats | None = None) -> Iterate:
        at = program.linearise(u)
        s = np.maximum(at.h, least if lam is None else LEAST_CARRIED_SLACK)
        lam = mu / s if lam is None else lam / unit
        return Iterate(u, s, lam, at, unit, np.zeros_like(u), SETTINGS.proximal_share * tolerance)

    def predictor_corrector(state: Iterate, primal: Floats, dual: Floats, least: float) -> bool:
        step = _step(state, matrix, retraction, primal, dual, watch.mu, watch.infeasibility_ratio, least)
        if step is not None:
            _take_step(state, step.capped(farthest), retraction)
        return step is not None

    for escapes in range(SETTINGS.max_saddle_escapes + 1):
        state = at_start(begin, mu, SETTINGS.initial_slack, None if escapes else multipliers)
        status = watch.follow(state, predictor_corrector, SETTINGS.max_iterations)
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
    settled = _restore_feasibility(state, matrix, retraction, exact) if status is SolverStatus.CONVERGED else state
    if status is SolverStatus.CONVERGED and watch.feasible is not None:
        settled = _pulled_inside(settled, watch.feasible[0])
    inner = watch.feasible if status is SolverStatus.FAILED and watch.feasible else watch.inner
    return Solution(
        settled.u, settled.lam * unit, status, watch.iterations, inner[0], inner[1], tuple(watch.way), watch.error,
        None if inner[2] is None else inner[2] * unit,
    )  # fmt: skip


def barrier_unit(at: Linearised) -> float:
    """Largest derivative of the objective, by which multipliers are divided; 1 where there is none."""
    return float(np.abs(at.gradient).max()) or 1.0


@dataclass(eq=False)
class _Monitor:
    """Convergence tests at every iterate, and what the next program needs to start from."""

    tolerance: float
    horizon: float
    enough: float
    balanced: bool
    stop: Stop | None
    progress: Callable[[int, float], None] | None
    reached: Callable[[Floats], None] | None
    begin: Floats
    first_mu: float
    iterations: int = 0
    error: float = np.inf
    mu: float = 0.0
    infeasibility_ratio: float = 0.0
    feasible: tuple[Floats, float, Floats | None] | None = None
    way: list[Floats] = field(default_factory=list)
    inner: tuple[Floats, float, Floats | None] = field(init=False)

    def __post_init__(self) -> None:
        """Begin with the start as the inner point."""
        self.inner = self.begin, self.first_mu, None

    def rewind_to_inner(self) -> None:
        """Forget the iterates past the inner point."""
        last = next((k for k, u in enumerate(self.way) if u is self.inner[0]), -1)
        del self.way[last + 1 :]

    def follow(
        self, state: Iterate, advance: Callable[[Iterate, Floats, Floats, float], bool], most: int
    ) -> SolverStatus:
        """Advance the state until it is converged, stopped or escaping, or until that fails."""
        before, best, since = np.inf, np.inf, 0
        for k in range(most + 1):
            primal, dual, gap, value = state.residuals()
            status = self._judge(state, primal, dual, gap, value, before, k)
            if status is not None:
                return status
            best, since = (self.error, 0) if self.error < 0.9 * best else (best, since + 1)
            target = 0.2 * self.tolerance * max(abs(value), 1.0) / max(len(primal), 1)
            if k == most or since > SETTINGS.max_stalled_iterations or not advance(state, primal, dual, target):
                break
            before = value
            self.iterations += 1
        return SolverStatus.FAILED

    def _judge(
        self, state: Iterate, primal: Floats, dual: Floats, gap: float, value: float, before: float, k: int
    ) -> SolverStatus | None:
        """Measure an iterate; the status to end with, or nothing."""
        if self.progress is not None:
            self.progress(self.iterations, state.at.value)
        self.mu = gap / max(len(primal), 1)
        infeasible = dot(state.lam, np.abs(primal))
        wrong = dot(np.abs(dual), np.minimum(np.abs(state.move), 1.0)) if k else 0.0
        dual_displacement = dot(np.abs(dual), np.abs(state.u - self.begin))
        settings, whole = settings_for(len(state.u)), max(abs(value), 1.0)
        dual_error = (
            settings.dual_error_ratio * (dual_displacement - settings.dual_error_allowance * whole)
            if dual_displacement > settings.dual_error_floor * whole
            else 0.0
        )
        self.infeasibility_ratio = max(infeasible, wrong, dual_error) / gap if gap > 0 else 0.0
        self.error = max(gap, infeasible, wrong, abs(value - before)) / max(abs(value), 1.0)
        inside = state.at.h.min(initial=np.inf) > 0
        if inside:
            self.feasible = state.u, self.mu, state.lam
            self.way.append(state.u)
            if k == 0 or gap > WARM_START_GAP * max(abs(value), 1.0):
                self.inner = state.u, self.mu, state.lam
                if self.reached is not None:
                    self.reached(state.u)
            if state.at.value >= self.enough:
                return SolverStatus.ENOUGH
        if (
            k >= SETTINGS.min_iterations
            and self.error < self.tolerance
            and (not self.balanced or self._in_balance(dual, dual_displacement, whole))
        ):
            return SolverStatus.CONVERGED
        if self.stop is not None and self.stop.is_set():
            return SolverStatus.STOPPED
        pulled = (state.at.gradient.reshape(-1, 3) != 0).any(axis=1)  # a loose part may drift anywhere
        reached = np.abs(state.u.reshape(-1, 3)[pulled, :2]).max(initial=0.0) * state.at.program.length
        far = reached > self.horizon
        return (SolverStatus.ESCAPING if inside else SolverStatus.FAILED) if far else None

    def _in_balance(self, dual: Floats, displacement: float, whole: float) -> bool:
        """True where the multipliers balance the objective."""
        return bool(
            displacement < np.sqrt(self.tolerance) * whole
            and np.abs(dual).max() < max(10 * self.tolerance, SETTINGS.dual_tolerance)
        )


def _step(
    state: Iterate,
    matrix: Factor,
    retraction: Retraction,
    primal: Floats,
    dual: Floats,
    mu: float,
    infeasibility_ratio: float,
    least: float,
) -> _Step | None:
    """The next step, and with it the barrier parameter: centring (mu after the predictor / mu)^3 mu, then the corrector.

    The diagonal is strengthened until the matrix is positive definite and the step is not too short.
    """
    s, lam, at = state.s, state.lam, state.at
    settings = settings_for(len(state.u))
    data = at.condensed(lam / s, lam, retraction.balance(dual, at), 1.0 / state.unit)
    shift = MIN_SHIFT if state.shift <= 1e-8 else state.shift / 5
    found = None
    for attempt in range(16):
        if not matrix.update(data, shift + state.proximal_weight):
            shift = max(10 * shift, 1e-5)
            continue
        _, ds, dl = newton(state, matrix, primal, dual, -s * lam)
        after = dot(s + max_step(s, ds) * ds, lam + max_step(lam, dl) * dl) / max(len(s), 1)
        centring = (after / mu) ** 3 if mu > 0 else 0.0
        if infeasibility_ratio > 0.3:  # feasibility must not fall behind complementarity
            centring = max(centring, min(settings.max_centring, infeasibility_ratio))
        goal = (
            max(centring * mu, least)
            - s * lam
            - np.clip(ds * dl, -SETTINGS.max_correction * mu, SETTINGS.max_correction * mu)
        )
        direction = newton(state, matrix, primal, dual, goal)
        if mu * len(s) < settings.corrected_gap * max(abs(at.value) / state.unit, 1.0):
            direction = corrected(state, matrix, direction, max(centring * mu, least))
        du, ds, dl = direction
        far, dfar = max_step(s, ds), max_step(lam, dl)
        found = _Step(
            du,
            ds,
            dl,
            SETTINGS.fraction_to_boundary * far if far < 1 else 1.0,
            SETTINGS.fraction_to_boundary * dfar if dfar < 1 else 1.0,
            shift,
        )
        if found.primal > SETTINGS.min_step_length or attempt >= 5:
            break
        shift = max(10 * shift, 1e-6)
    stuck = found is not None and found.shift > SETTINGS.hopeless_shift and found.primal < SETTINGS.min_step_length
    return None if stuck else found


def _take_step(state: Iterate, step: _Step, retraction: Retraction) -> None:
    """Take the step; halve it while the infeasibility grows beyond half the complementarity."""
    lam = state.lam + step.dual * step.lam
    share = step.primal
    before = dot(state.lam, np.abs(state.s - state.at.h))
    # full steps in a row that a strengthened diagonal keeps short: nothing is in the way, so try longer ones
    state.stride = min(4 * state.stride, 4096.0) if step.primal == 1.0 and step.shift > SETTINGS.max_free_shift else 1.0
    if state.stride > 4.0:
        u = retraction.step(state.u, state.stride * step.u, state.at)
        at = state.at.program.linearise(u)
        if at.h.min(initial=np.inf) > 0 and at.value > state.at.value:
            state.move, state.shift = step.u, step.shift
            state.u, state.s, state.lam, state.at = u, at.h, lam, at
            return
        state.stride = 1.0
    for _ in range(6):
        u = retraction.step(state.u, share * step.u, state.at)
        at = state.at.program.linearise(u)
        s = np.maximum(np.maximum(state.s + share * step.s, at.h), SETTINGS.min_slack)
        if dot(lam, s - at.h) <= max(0.5 * dot(s, lam), 2.0 * before):
            break
        share /= 2
    state.move, state.shift = step.u, step.shift
    state.u, state.s, state.lam, state.at = u, s, lam, at


def _restore_feasibility(state: Iterate, matrix: Factor, retraction: Retraction, exact: float) -> Iterate:
    """A few centred steps that remove the remaining infeasibility; bodies that nothing holds stay where they are.

    In large programs a point inside all rows is good enough: there slacks are as right as the tolerance asks.
    """
    large = len(state.u) > LARGE_PROGRAM
    exact = np.inf if large else exact
    mu = dot(state.s, state.lam) / max(len(state.s), 1)
    for _ in range(6):
        primal, dual, _, _ = state.residuals()
        wrong = np.abs(primal).max(initial=0.0)
        if wrong < SLACK_TOLERANCE or (wrong < exact and state.at.h.min(initial=np.inf) > 0):
            break
        data = state.at.condensed(state.lam / state.s, state.lam, retraction.balance(dual, state.at), 1.0 / state.unit)
        shift = max(state.shift, 1e-2)
        while not matrix.update(data, shift):
            shift *= 10
        du, ds, dl = newton(state, matrix, primal, dual, mu - state.s * state.lam)
        far, dfar = max_step(state.s, ds), max_step(state.lam, dl)
        if large and far < SETTINGS.min_restoring_step:
            return _lifted(state, matrix, retraction)
        _take_step(
            state,
            _Step(
                du,
                ds,
                dl,
                SETTINGS.fraction_to_boundary * far if far < 1 else 1.0,
                SETTINGS.fraction_to_boundary * dfar if dfar < 1 else 1.0,
                shift,
            ),
            retraction,
        )
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
        at = at.program.linearise(u)
    return replace(state, u=u, at=at, s=np.maximum(at.h, SETTINGS.min_slack)) if at.h.min() >= 0.0 else state


def _pulled_inside(state: Iterate, inside: Floats) -> Iterate:
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
