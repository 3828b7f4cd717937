"""Primal-dual interior-point method on the condensed system: the default solver.

Slacks and multipliers are eliminated, so one symmetric 3F x 3F matrix with the sparsity of the neighbour graph is factorised per
iteration. Mehrotra's predictor and corrector choose the centring; steps are taken along `Retraction`, which keeps long assemblies legal
while they turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.build import Linearised, Program
from wiggleroom.program.retract import Retraction
from wiggleroom.solve.factor import Factor, factor

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
LONGEST = 0.1
"""Share of the horizon that a body may move in one iteration."""
HOME = 0.01
"""Share of the tolerance that may be given up to stay near rest."""
TINY_SHIFT = 1e-11
BALANCED = 1e-3
"""Share of the largest derivative of the objective that the forces on a body may be out of balance at the end."""
LEAST_ITERATIONS, MOST_ITERATIONS = 3, 100
FREE = 1e-3
"""A diagonal strengthened by more than this keeps steps short."""


class Stop(Protocol):
    """Anything with `is_set`, asked every iteration."""

    def is_set(self) -> bool:
        """True to stop."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a solver ended.

    Parameters
    ----------
    u : (3F,) float64
        Scaled variables.
    lam : (R,) float64
        Multipliers of the rows: objective [mm] per unit of `program.length`, scaled so that the largest derivative of the objective is 1.
    status : str
        "converged", "stopped", "escaping" or "failed".
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
    status: str
    iterations: int
    inner: Floats
    inner_mu: float
    way: tuple[Floats, ...] = ()
    error: float = 0.0


@dataclass(eq=False)
class _State:
    """Iterate of the method; `s` are slacks of the rows."""

    u: Floats
    s: Floats
    lam: Floats
    at: Linearised
    unit: float
    move: Floats
    home: float
    shift: float = TINY_SHIFT
    stride: float = 1.0
    way: list[Floats] = field(default_factory=list)

    def residuals(self) -> tuple[Floats, Floats, float, float]:
        """Primal and dual residual, complementarity, and value in units of the objective's largest derivative."""
        primal = self.s - self.at.h
        dual = self.pull_home * self.u - self.at.gradient / self.unit - self.at.against(self.lam)
        return primal, dual, _dot(self.s, self.lam), self.at.value / self.unit

    @property
    def pull_home(self) -> float:
        """Weight of half the squared motion, so small that it decides only between motions that are equally good."""
        return self.home * max(abs(self.at.value) / self.unit, 1.0) / max(_dot(self.u, self.u), 1.0)


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
    stop, progress : optional
        Asked and told (iteration, objective) every iteration.

    Returns
    -------
    Solution
    """
    u = np.zeros(len(program.scale)) if start is None else start.copy()
    at = program.linearise(u)
    unit = float(np.abs(at.gradient).max()) or 1.0
    s = np.maximum(at.h, 1e-9)
    state = _State(u, s, mu / s, at, unit, np.zeros_like(u), HOME * tolerance)
    matrix, retraction = factor(program.pattern), Retraction(program)
    inner, inner_mu, status, error, before = u, mu, "failed", np.inf, np.inf
    for k in range(MOST_ITERATIONS + 1):
        primal, dual, gap, value = state.residuals()
        if progress is not None:
            progress(k, state.at.value)
        infeasible, wrong = _dot(state.lam, np.abs(primal)), _dot(np.abs(dual), np.minimum(np.abs(state.move), 1.0))
        if k == 0:
            wrong = np.inf
        error = max(gap, infeasible, wrong, abs(value - before)) / max(abs(value), 1.0)
        before = value
        inside = state.at.h.min(initial=np.inf) > 0
        if inside:
            state.way.append(state.u)
            if k == 0 or gap > INNER * max(abs(value), 1.0):
                inner, inner_mu = state.u, gap / max(program.rows, 1)
        if k >= LEAST_ITERATIONS and error < tolerance and np.abs(dual).max() < max(10 * tolerance, BALANCED):
            status = "converged"
            break
        if stop is not None and stop.is_set():
            status = "stopped"
            break
        if inside and np.abs(program.motion(state.u)[:, :2]).max(initial=0.0) > horizon:
            status = "escaping"
            break
        lag = max(infeasible, 0.0 if k == 0 else wrong) / gap if gap > 0 else 0.0
        target = 0.2 * tolerance * max(abs(value), 1.0) / max(program.rows, 1)
        step = _step(state, matrix, retraction, primal, dual, gap / max(program.rows, 1), lag, target)
        step = step and step.capped(LONGEST * horizon / program.length)
        if step is None or k == MOST_ITERATIONS:
            break
        _advance(state, step, retraction)
    settled = _settle(state, matrix, retraction) if status == "converged" else state
    return Solution(settled.u, settled.lam * unit, status, k, inner, inner_mu, tuple(state.way), error)


def _step(
    state: _State,
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
    data = at.condensed(lam / s, lam, retraction.balance(dual, at), unit=state.unit)
    shift = TINY_SHIFT if state.shift <= 1e-8 else state.shift / 5
    found = None
    for attempt in range(16):
        if not matrix.update(data, shift + state.pull_home):
            shift = max(10 * shift, 1e-5)
            continue
        _, ds, dl = _newton(state, matrix, primal, dual, -s * lam)
        after = _dot(s + _longest(s, ds) * ds, lam + _longest(lam, dl) * dl) / max(len(s), 1)
        centring = (after / mu) ** 3 if mu > 0 else 0.0
        if lag > 0.3:  # feasibility must not fall behind complementarity
            centring = max(centring, min(10.0, lag))
        goal = max(centring * mu, least) - s * lam - np.clip(ds * dl, -CORRECTION * mu, CORRECTION * mu)
        du, ds, dl = _newton(state, matrix, primal, dual, goal)
        far, dfar = _longest(s, ds), _longest(lam, dl)
        found = _Step(du, ds, dl, FRACTION * far if far < 1 else 1.0, FRACTION * dfar if dfar < 1 else 1.0, shift)
        if found.primal > SHORT or attempt >= 5:
            break
        shift = max(10 * shift, 1e-6)
    return found


def _newton(state: _State, matrix: Factor, primal: Floats, dual: Floats, goal: Floats) -> tuple[Floats, Floats, Floats]:
    """Directions (du, ds, dlam) that change s * lam by `goal` and remove both residuals, to first order."""
    s, lam, at = state.s, state.lam, state.at
    du = matrix.solve(at.against((lam * primal + goal) / s) - dual)
    ds = at.along(du) - primal
    return du, ds, (goal - lam * ds) / s


def _dot(x: Floats, y: Floats) -> float:
    """X . y without the threads of a linear-algebra library, which cost more than they save here."""
    return float(np.einsum("i,i->", x, y))


def _longest(x: Floats, dx: Floats) -> float:
    """Largest step in [0, 1] that keeps x + step * dx >= 0."""
    shrinking = dx < 0
    return min(1.0, float((-x[shrinking] / dx[shrinking]).min())) if shrinking.any() else 1.0


def _advance(state: _State, step: _Step, retraction: Retraction) -> None:
    """Take the step; halve it while the true rows fall behind the foreseen ones by more than half the complementarity."""
    lam = state.lam + step.dual * step.lam
    share = step.primal
    before = _dot(state.lam, np.abs(state.s - state.at.h))
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
        if _dot(lam, s - at.h) <= max(0.5 * _dot(s, lam), 2.0 * before):
            break
        share /= 2
    state.move, state.shift = step.u, step.shift
    state.u, state.s, state.lam, state.at = u, s, lam, at


def _settle(state: _State, matrix: Factor, retraction: Retraction) -> _State:
    """A few short centred steps that remove what is left of the violation; bodies that nothing holds stay where they are."""
    mu = _dot(state.s, state.lam) / max(len(state.s), 1)
    for _ in range(6):
        primal, dual, _, _ = state.residuals()
        if np.abs(primal).max(initial=0.0) < 1e-12:
            break
        data = state.at.condensed(state.lam / state.s, state.lam, retraction.balance(dual, state.at), unit=state.unit)
        shift = max(state.shift, 1e-2)
        while not matrix.update(data, shift):
            shift *= 10
        du, ds, dl = _newton(state, matrix, primal, dual, mu - state.s * state.lam)
        far, dfar = _longest(state.s, ds), _longest(state.lam, dl)
        _advance(
            state,
            _Step(du, ds, dl, FRACTION * far if far < 1 else 1.0, FRACTION * dfar if dfar < 1 else 1.0, shift),
            retraction,
        )
    return state
