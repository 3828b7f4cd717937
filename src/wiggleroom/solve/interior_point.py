"""Primal-dual interior-point method on the condensed system: the default solver.

Slacks and multipliers are eliminated, so one symmetric 3F x 3F matrix with the sparsity of the neighbour graph is factorised per
iteration. Mehrotra's predictor and corrector choose the centring; steps are taken along `Retraction`, which keeps long assemblies legal
while they turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.factorisation import LARGE, Factor, factor
from wiggleroom.solve.monotone_barrier import Careful
from wiggleroom.solve.newton_step import TINY_SHIFT, State, dot, longest, newton
from wiggleroom.solve.saddle_escape import beside, uphill
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

FRACTION = 0.99
"""Share of the way to the nearest wall that a step may use."""
CORRECTION = 10.0
"""Mehrotra's second-order term is held within this multiple of mu; larger ones come from steps too long to trust."""
SHORT = 0.05
"""A step shorter than this is tried again with a stronger diagonal."""
FIRST_MU = 0.1
INNER = 3e-2
"""The next program starts at the last legal iterate whose complementarity was still this share of the objective."""
LEAST_SLACK = 1e-14
FIRST_SLACK = 1e-3
"""Slacks begin no smaller: a wall right beside the start would else block every step away from the others."""
LONGEST = 0.1
"""Share of the horizon that a body may move in one iteration."""
HOME = 0.01
"""Share of the tolerance that may be given up to stay near rest."""
UNHELD = 0.3
"""Share of what forces out of balance would bring, were the round's motion made again, that must not fall behind complementarity."""
EARLY = 0.05
"""As long as they would bring more than this share of the objective."""
BALANCED = 1e-3
"""Share of the largest derivative of the objective that the forces on a body may be out of balance at the end."""
LEAST_ITERATIONS, MOST_ITERATIONS, MOST_CAREFUL = 3, 100, 200
SHARED, ROUGH = 3, 1e-3
"""So many of the last steps share a factorisation in large programs, where the tolerance is coarser than this."""
MOST_RIDGES = 2
"""So often the search goes on beside a point that balances on a ridge."""
PATIENCE = 30
"""After so many iterations that do not make the error less, the quick steps have failed."""
EXACT = 1e-12
"""Slacks that are right to this share of `program.length` are exact."""
FREE = 1e-3
"""A diagonal strengthened by more than this keeps steps short."""


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
    """

    u: Floats
    lam: Floats
    status: SolverStatus
    iterations: int
    inner: Floats
    inner_mu: float
    way: tuple[Floats, ...] = ()
    error: float = 0.0


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
    mu: float = FIRST_MU,
    tolerance: float = 1e-6,
    horizon: float = np.inf,
    enough: float = np.inf,
    exact: float = EXACT,
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Solution:
    """Largest objective from a point strictly inside all rows.

    Parameters
    ----------
    program : Program
    start : (3F,) float64, optional
        Strictly inside all rows; by default rest.
    mu : float
        Complementarity to begin with, as a share of the objective's largest derivative.
    tolerance : float
        Share of the objective that may be left on the table.
    horizon : float [mm]
        A body that moves further than this is taken to escape.
    enough : float [mm]
        A point inside all rows that is worth so much is good enough.
    exact : float
        A point inside all rows whose slacks are right to this share of `program.length` needs no more steps at the end.
    stop, progress : optional
        Asked and told (iteration, objective) every iteration.

    Returns
    -------
    Solution
    """
    begin = np.zeros(len(program.scale)) if start is None else start.copy()
    matrix, retraction = factor(program.pattern), Retraction(program)
    unit = float(np.abs(program.linearise(begin).gradient).max()) or 1.0
    farthest = LONGEST * horizon / program.length
    watch = _Watch(tolerance, horizon, enough, stop, progress, begin, mu)

    def at_start(u: Floats, mu: float, least: float) -> State:
        at = program.linearise(u)
        s = np.maximum(at.h, least)
        return State(u, s, mu / s, at, unit, np.zeros_like(u), HOME * tolerance)

    def quick(state: State, primal: Floats, dual: Floats, least: float) -> bool:
        step = _step(state, matrix, retraction, primal, dual, watch.mu, watch.lag, least)
        if step is not None:
            _advance(state, step.capped(farthest), retraction)
        return step is not None

    for ridges in range(MOST_RIDGES + 1):
        state = at_start(begin, mu, FIRST_SLACK)
        status = watch.follow(state, quick, MOST_ITERATIONS)
        if status is SolverStatus.FAILED and watch.legal is not None:
            state = at_start(*watch.legal, 0.0)
            status = watch.follow(state, Careful(matrix, retraction, watch.legal[1], farthest).advance, MOST_CAREFUL)
        up = uphill(state, matrix, tolerance) if status is SolverStatus.CONVERGED and ridges < MOST_RIDGES else None
        if up is None:
            break
        begin, mu = beside(program, watch.inner[0], up), watch.inner[1]
        watch.back_to_inner()
    shared = SHARED if tolerance > ROUGH and len(begin) > LARGE else 1
    settled = _settle(state, matrix, retraction, shared, exact) if status is SolverStatus.CONVERGED else state
    inner = watch.legal if status is SolverStatus.FAILED and watch.legal else watch.inner
    return Solution(settled.u, settled.lam * unit, status, watch.iterations, *inner, tuple(watch.way), watch.error)


@dataclass(eq=False)
class _Watch:
    """Looks at every iterate: whether to go on, and what to remember."""

    tolerance: float
    horizon: float
    enough: float
    stop: Stop | None
    progress: Callable[[int, float], None] | None
    begin: Floats
    first_mu: float
    iterations: int = 0
    error: float = np.inf
    mu: float = 0.0
    lag: float = 0.0
    legal: tuple[Floats, float] | None = None
    way: list[Floats] = field(default_factory=list)
    inner: tuple[Floats, float] = field(init=False)

    def __post_init__(self) -> None:
        """Begin with the start as the inner point."""
        self.inner = self.begin, self.first_mu

    def back_to_inner(self) -> None:
        """Forget the way past the inner point."""
        last = next((k for k, u in enumerate(self.way) if u is self.inner[0]), -1)
        del self.way[last + 1 :]

    def follow(self, state: State, advance: Callable[[State, Floats, Floats, float], bool], most: int) -> SolverStatus:
        """Advance the state until it is converged, stopped or escaping, or until that fails."""
        before, best, since = np.inf, np.inf, 0
        for k in range(most + 1):
            primal, dual, gap, value = state.residuals()
            status = self._judge(state, primal, dual, gap, value, before, k)
            if status is not None:
                return status
            best, since = (self.error, 0) if self.error < 0.9 * best else (best, since + 1)
            target = 0.2 * self.tolerance * max(abs(value), 1.0) / max(len(primal), 1)
            if k == most or since > PATIENCE or not advance(state, primal, dual, target):
                break
            before = value
            self.iterations += 1
        return SolverStatus.FAILED

    def _judge(
        self, state: State, primal: Floats, dual: Floats, gap: float, value: float, before: float, k: int
    ) -> SolverStatus | None:
        """Measure an iterate; the status to end with, or nothing."""
        if self.progress is not None:
            self.progress(self.iterations, state.at.value)
        self.mu = gap / max(len(primal), 1)
        infeasible = dot(state.lam, np.abs(primal))
        wrong = dot(np.abs(dual), np.minimum(np.abs(state.move), 1.0)) if k else 0.0
        unheld = dot(np.abs(dual), np.abs(state.u - self.begin))
        far_off = UNHELD * unheld if unheld > EARLY * max(abs(value), 1.0) else 0.0
        self.lag = max(infeasible, wrong, far_off) / gap if gap > 0 else 0.0
        self.error = max(gap, infeasible, wrong, abs(value - before)) / max(abs(value), 1.0)
        inside = state.at.h.min(initial=np.inf) > 0
        if inside:
            self.legal = state.u, self.mu
            self.way.append(state.u)
            if k == 0 or gap > INNER * max(abs(value), 1.0):
                self.inner = state.u, self.mu
            if state.at.value >= self.enough:
                return SolverStatus.ENOUGH
        if (
            k >= LEAST_ITERATIONS
            and self.error < self.tolerance
            and unheld < np.sqrt(self.tolerance) * max(abs(value), 1.0)
            and np.abs(dual).max() < max(10 * self.tolerance, BALANCED)
        ):
            return SolverStatus.CONVERGED
        if self.stop is not None and self.stop.is_set():
            return SolverStatus.STOPPED
        pulled = (state.at.gradient.reshape(-1, 3) != 0).any(axis=1)  # a loose part may drift anywhere
        reached = np.abs(state.u.reshape(-1, 3)[pulled, :2]).max(initial=0.0) * state.at.program.length
        far = reached > self.horizon
        return (SolverStatus.ESCAPING if inside else SolverStatus.FAILED) if far else None


def _step(
    state: State,
    matrix: Factor,
    retraction: Retraction,
    primal: Floats,
    dual: Floats,
    mu: float,
    lag: float,
    least: float,
) -> _Step | None:
    """Predictor and corrector; the diagonal is strengthened until the matrix is positive definite and the step is not a stub."""
    s, lam, at = state.s, state.lam, state.at
    data = at.condensed(lam / s, lam, retraction.balance(dual, at), 1.0 / state.unit)
    shift = TINY_SHIFT if state.shift <= 1e-8 else state.shift / 5
    found = None
    for attempt in range(16):
        if not matrix.update(data, shift + state.pull_home):
            shift = max(10 * shift, 1e-5)
            continue
        _, ds, dl = newton(state, matrix, primal, dual, -s * lam)
        after = dot(s + longest(s, ds) * ds, lam + longest(lam, dl) * dl) / max(len(s), 1)
        centring = (after / mu) ** 3 if mu > 0 else 0.0
        if lag > 0.3:  # feasibility must not fall behind complementarity
            centring = max(centring, min(10.0, lag))
        goal = max(centring * mu, least) - s * lam - np.clip(ds * dl, -CORRECTION * mu, CORRECTION * mu)
        du, ds, dl = newton(state, matrix, primal, dual, goal)
        far, dfar = longest(s, ds), longest(lam, dl)
        found = _Step(du, ds, dl, FRACTION * far if far < 1 else 1.0, FRACTION * dfar if dfar < 1 else 1.0, shift)
        if found.primal > SHORT or attempt >= 5:
            break
        shift = max(10 * shift, 1e-6)
    return found


def _advance(state: State, step: _Step, retraction: Retraction) -> None:
    """Take the step; halve it while the true rows fall behind the foreseen ones by more than half the complementarity."""
    lam = state.lam + step.dual * step.lam
    share = step.primal
    before = dot(state.lam, np.abs(state.s - state.at.h))
    # full steps in a row that a strengthened diagonal keeps short: nothing is in the way, so stride out
    state.stride = min(4 * state.stride, 4096.0) if step.primal == 1.0 and step.shift > FREE else 1.0
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
        s = np.maximum(np.maximum(state.s + share * step.s, at.h), LEAST_SLACK)
        if dot(lam, s - at.h) <= max(0.5 * dot(s, lam), 2.0 * before):
            break
        share /= 2
    state.move, state.shift = step.u, step.shift
    state.u, state.s, state.lam, state.at = u, s, lam, at


def _settle(state: State, matrix: Factor, retraction: Retraction, shared: int, exact: float) -> State:
    """A few short centred steps that remove what is left of the violation; bodies that nothing holds stay where they are.

    Each factorisation serves `shared` steps.
    """
    mu = dot(state.s, state.lam) / max(len(state.s), 1)
    shift = 0.0
    for k in range(6):
        primal, dual, _, _ = state.residuals()
        wrong = np.abs(primal).max(initial=0.0)
        if wrong < EXACT or (wrong < exact and state.at.h.min(initial=np.inf) > 0):
            break
        if k % shared == 0:  # the rows are met to first order whatever matrix the step comes from
            share = state.lam / state.s
            data = state.at.condensed(share, state.lam, retraction.balance(dual, state.at), 1.0 / state.unit)
            shift = max(state.shift, 1e-2)
            while not matrix.update(data, shift):
                shift *= 10
        du, ds, dl = newton(state, matrix, primal, dual, mu - state.s * state.lam)
        far, dfar = longest(state.s, ds), longest(state.lam, dl)
        _advance(
            state,
            _Step(du, ds, dl, FRACTION * far if far < 1 else 1.0, FRACTION * dfar if dfar < 1 else 1.0, shift),
            retraction,
        )
    return state
