"""Primal-dual interior-point method over bodies and planes.

The method is that of `wiggleroom.solve.interior_point`: slacks, multipliers and here also the planes are eliminated, so one symmetric
matrix of 6 x 6 blocks on the graph of neighbours is factorised per iteration. Two modes: with slacks that may run ahead of the rows,
which needs few iterations but may carry a part through another one, and one whose every iterate is inside all rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.solve.factorisation import Factor, factor
from wiggleroom.solve.newton_step import dot, max_step
from wiggleroom.spatial.rotations import logarithm
from wiggleroom.spatial.separating_plane_program import (
    GraphRetraction,
    LinearisedSeparatingPlanes,
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    beside_rest,
    parted,
)
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

FRACTION = 0.99
CORRECTION = 10.0
SHORT = 0.05
FIRST_MU = 0.1
INNER = 3e-2
"""Another solve starts at the last iterate whose complementarity was still this share of the objective."""
FIRST_SLACK = 1e-3
LEAST_SLACK = 1e-15
LONGEST = 0.1
LARGEST_TURN = 0.5
"""No body turns further in one iteration [rad]."""
HOME = 0.01
TINY_SHIFT = 1e-11
BALANCED = 1e-3
ROUNDING = 500 * float(np.finfo(float).eps)
"""mu stays above this, times the size in clearances: slacks that are as small as the rounding of rows make multipliers of noise."""
LEAST_CURVATURE = 1e-3
"""Curvature upwards [objective's unit per clearance squared] that counts."""
UNHELD, EARLY = 0.3, 0.05
LEAST_ITERATIONS = 3
ACCEPTABLE, LOST = 1e-6, 1e3
"""Where rounding spoils the conditions again by the second factor, an iterate at which they held to the first is good enough."""
PATIENCE, GAINING = 40, 0.01
"""After so many iterations that do not make the error less nor the objective this share larger, the method has failed."""
LESS, FASTER, LEAST_SHARE, SOLVED = 0.2, 1.4, 0.04, 10.0
"""mu becomes this share or this power of itself, but no less than a third share, when its problem is solved to this multiple of mu."""
DOWNHILL = 1e-4
"""Share of the foreseen descent that a step must bring."""
APART = 10
"""A multiplier may differ from mu / slack by this factor."""
FREE = 1e-3
"""A diagonal strengthened by more than this keeps steps short; then longer ones are tried."""
HEAVIEST = 1e12
"""Largest weight of a row in the fit of the planes, against the lightest."""


@dataclass(frozen=True, eq=False)
class SeparatingPlaneSolution:
    """Where the method ended.

    Parameters
    ----------
    point : SeparatingPlanePoint
        The last point inside all rows.
    lam : (R,) float64
        Multipliers: objective per mm of each row.
    status : SolverStatus
    iterations : int
    way : tuple of SeparatingPlanePoint
        Points inside all rows, from the start.
    error : float
        Largest of complementarity, violation and imbalance, in units of the objective.
    curved_down : bool
        True where the second-order conditions hold: no direction along the active rows goes up.
    inner : (int, float)
        How many of the way-points lie well inside all rows, and the mean complementarity at the last of these.
    """

    point: SeparatingPlanePoint
    lam: Floats
    value: float
    status: SolverStatus
    iterations: int
    way: tuple[SeparatingPlanePoint, ...]
    error: float
    curved_down: bool
    inner: tuple[int, float]


@dataclass(eq=False)
class SeparatingPlaneState:
    """Iterate of the method; `s` are slacks of the rows, `at` the program at the point."""

    at: LinearisedSeparatingPlanes
    s: Floats
    lam: Floats
    unit: float
    tolerance: float
    shift: float = TINY_SHIFT
    stride: float = 1.0

    @property
    def displacement(self) -> Floats:
        """Scaled motion (V,) from rest."""
        P, pose = self.at.program, self.at.point.pose
        x = np.hstack([pose.T - P.bodies.at, logarithm(pose.R)])
        return P.packed(x / P.scale)

    def residuals(self) -> tuple[Floats, Floats, Floats, float]:
        """Primal residual (R,), dual residuals of bodies (V,) and planes (K, 3), and complementarity."""
        u = self.displacement
        self.home = HOME * self.tolerance * max(abs(self.at.value) / self.unit, 1.0) / max(dot(u, u), 1.0)
        force, moment = self.at.against(self.lam)
        dual = self.home * u - self.at.gradient / self.unit - force
        return self.s - self.at.h, dual, -moment, dot(self.s, self.lam)


class _System:
    """The condensed system of one iterate, factorised."""

    def __init__(self, matrix: Factor, retraction: GraphRetraction) -> None:
        self._matrix, self._retraction = matrix, retraction

    def set(self, state: SeparatingPlaneState, dual: Floats) -> None:
        """Work the matrix out."""
        at = state.at
        self._at = at
        balance = self._retraction.balance(dual, at)
        self._data, self._inverse, self._mixed = at.condensed(state.lam / state.s, state.lam, balance, 1.0 / state.unit)

    def factorise(self, shift: float) -> bool:
        """Factorise with a shift of the diagonal; False where the matrix is not positive definite."""
        return bool(np.isfinite(self._data).all()) and self._matrix.update(self._data, shift)

    def newton(
        self, state: SeparatingPlaneState, primal: Floats, dual: Floats, dual_planes: Floats, goal: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Directions (du, dy, ds, dlam) that change s * lam by `goal` and remove the residuals, to first order."""
        from wiggleroom.spatial import separating_plane_constraints as kernel

        at, P, s, lam = self._at, self._at.program, state.s, state.lam
        x, y = at.against((lam * primal + goal) / s)
        y = y - dual_planes
        bodies, share = P.unpacked(x - dual), np.empty_like(y)
        on_bodies = np.zeros_like(bodies)
        kernel.eliminate(
            at.Psi, at.point.pose.R, P.a, P.b, P.plane, self._inverse, self._mixed, y, P.scale, share, on_bodies
        )
        du = self._matrix.solve(P.packed(bodies + on_bodies))
        kernel.substitute(P.plane, self._inverse, self._mixed, at.seen(du), share)
        ds = at.along(du, share) - primal
        return du, share, ds, (goal - lam * ds) / s


@dataclass(eq=False)
class _SpatialStep:
    u: Floats
    y: Floats
    s: Floats
    lam: Floats
    primal: float
    dual: float
    shift: float


@dataclass(frozen=True, eq=False)
class _Best:
    """The iterate inside all rows at which the conditions held best, and how many way-points there were."""

    error: float
    at: LinearisedSeparatingPlanes
    lam: Floats
    way: int


@dataclass(eq=False)
class SeparatingPlaneSolver:
    """Largest objective of a program from rest.

    Parameters
    ----------
    program : SeparatingPlaneProgram
    inside : bool
        True: every iterate stays inside all rows, so that nothing can pass through anything.
    tolerance : float
        Share of the objective that may be left on the table.
    most : int
        Iterations at most.
    horizon : float [mm]
        A body that moves further than this is taken to escape.
    most_turn : float
        An objective beyond this, where twists are maximised, is taken to turn without limit [rad].
    stop, progress : optional
        Asked and told (iteration, objective) every iteration.
    """

    program: SeparatingPlaneProgram
    inside: bool = False
    tolerance: float = 1e-8
    most: int = 150
    horizon: float = np.inf
    most_turn: float = np.inf
    stop: Stop | None = None
    progress: Callable[[int, float], None] | None = None
    iterations: int = 0
    way: list[SeparatingPlanePoint] = field(default_factory=list)
    inner: tuple[int, float] = (1, FIRST_MU)

    def solve(self, start: SeparatingPlanePoint | None = None, mu: float = FIRST_MU) -> SeparatingPlaneSolution:
        """Run the method from a point inside all rows."""
        P = self.program
        self._retraction = GraphRetraction(P)
        self._system = _System(factor(P.pattern), self._retraction)
        at = P.linearise(beside_rest(P) if start is None else start)
        unit = float(np.abs(at.gradient).max(initial=0.0)) or 1.0
        s = np.maximum(at.h, 0.0 if self.inside else FIRST_SLACK)
        state = SeparatingPlaneState(at, s, mu / s, unit, self.tolerance)
        self._barrier = mu
        self._floor = ROUNDING * P.bodies.size / P.length
        self.way = [P.start]
        status, error = self._follow(state)
        last = state.at
        if self.way and last.point is not self.way[-1]:
            last = P.linearise(self.way[-1], last.value)
        curved = status is SolverStatus.CONVERGED and self._curved_down(state)
        return SeparatingPlaneSolution(
            last.point,
            state.lam * unit / P.length,
            last.value,
            status,
            self.iterations,
            tuple(self.way),
            error,
            curved,
            self.inner,
        )

    def _curved_down(self, state: SeparatingPlaneState) -> bool:
        """True where the condensed matrix is positive definite up to a small share."""
        _, dual, _, _ = state.residuals()
        self._system.set(state, dual)
        return self._system.factorise(LEAST_CURVATURE + state.home)

    def _follow(self, state: SeparatingPlaneState) -> tuple[SolverStatus, float]:
        """Advance the state until it is converged, stopped or escaping; where it gets no further, back to the best iterate."""
        before, least, since, most = np.inf, np.inf, 0, -np.inf
        best, inner = _Best(np.inf, state.at, state.lam, 0), (1, FIRST_MU)
        self._move = np.zeros_like(state.displacement)
        for k in range(self.most + 1):
            self.inner = inner
            primal, dual, dual_planes, gap = state.residuals()
            value = state.at.value / state.unit
            if self.progress is not None:
                self.progress(self.iterations, state.at.value)
            self._mu = gap / max(len(primal), 1)
            size = max(abs(value), 1.0)
            infeasible = dot(state.lam, np.abs(primal))
            unheld = dot(np.abs(dual), np.abs(state.displacement))
            wrong = dot(np.abs(dual), np.minimum(np.abs(self._move), 1.0)) if k else 0.0
            far_off = UNHELD * unheld if unheld > EARLY * size else 0.0
            self._lag = max(infeasible, wrong, far_off) / gap if gap > 0 else 0.0
            legal = self._legal(state.at)
            if legal is not None:
                self.way.append(legal)
                if gap > INNER * size:
                    inner = len(self.way), self._mu
            error = max(gap, infeasible, min(unheld, 1e3)) / size
            balanced = max(float(np.abs(d).max(initial=0.0)) for d in (dual, dual_planes)) < BALANCED
            if k >= LEAST_ITERATIONS and legal is not None and balanced:
                enough = max(self.tolerance * size, 5 * len(primal) * self._floor)
                settled = unheld < 10 * enough or (
                    abs(value - before) < enough and unheld < np.sqrt(self.tolerance) * size
                )
                if max(gap, infeasible) < enough and settled:
                    return SolverStatus.CONVERGED, error
                if error < best.error:
                    best = _Best(error, state.at, state.lam, len(self.way))
            if self.stop is not None and self.stop.is_set():
                return SolverStatus.STOPPED, error
            moved = np.abs(state.at.point.pose.T - state.at.program.bodies.at).max(initial=0.0)
            if moved > self.horizon or abs(state.at.value) > self.most_turn:
                return (SolverStatus.ESCAPING if legal is not None else SolverStatus.FAILED), error
            gained = value - most > GAINING * size
            least, since = (min(error, least), 0) if error < 0.9 * least or gained else (least, since + 1)
            most = value if gained or k == 0 else most
            lost = best.error < ACCEPTABLE and error > LOST * best.error
            if k == self.most or since > PATIENCE or lost or not self._advance(state, primal, dual, dual_planes, size):
                break
            before = value
            self.iterations += 1
        if best.error < ACCEPTABLE:
            state.at, state.lam, state.s = best.at, best.lam, np.maximum(best.at.h, LEAST_SLACK)
            del self.way[best.way :]
            return SolverStatus.CONVERGED, best.error
        return SolverStatus.FAILED, error

    def _legal(self, at: LinearisedSeparatingPlanes) -> SeparatingPlanePoint | None:
        """The point, inside all rows once planes that lag behind are set anew; None where pieces overlap."""
        if at.h.min(initial=np.inf) > 0:
            return at.point
        found = parted(self.program, at.point, at.h)
        return found if self.program.values(found).min(initial=np.inf) > 0 else None

    def _advance(
        self, state: SeparatingPlaneState, primal: Floats, dual: Floats, dual_planes: Floats, size: float
    ) -> bool:
        least = max(0.2 * self.tolerance * size / max(len(primal), 1), self._floor)
        if self.inside:
            return self._descend(state, primal, dual, dual_planes, least)
        step = self._direction(state, primal, dual, dual_planes, least)
        return step is not None and self._take(state, step)

    def _descend(
        self, state: SeparatingPlaneState, primal: Floats, dual: Floats, dual_planes: Floats, least: float
    ) -> bool:
        """One step that makes the barrier function smaller, all rows kept; mu only falls.

        Source: the monotone mode of Wachter and Biegler 2006 (IPOPT), with slacks that are the rows themselves.
        """
        s, lam, system, at = state.s, state.lam, self._system, state.at
        wrong = max(float(np.abs(dual).max(initial=0.0)), float(np.abs(dual_planes).max(initial=0.0)))
        while self._barrier > least and max(wrong, np.abs(s * lam - self._barrier).max()) < SOLVED * self._barrier:
            self._barrier = max(min(LESS * self._barrier, self._barrier**FASTER), LEAST_SHARE * self._barrier, least)
        mu = self._barrier
        system.set(state, dual)
        shift = TINY_SHIFT if state.shift <= 1e-8 else state.shift / 3
        while not system.factorise(shift + state.home):
            shift = max(8 * shift, 1e-5)
            if shift > 1e12:
                return False
        du, dy, ds, dlam = system.newton(state, primal, dual, dual_planes, mu - s * lam)
        share = min(FRACTION * max_step(s, ds) if (ds < -s).any() else 1.0, self._longest_share(du))
        foreseen = at.along(du, dy)
        heavy = np.maximum(lam / s, (lam / s).max() / HEAVIEST)
        slope = dot(state.home * state.displacement - at.gradient / state.unit, du) - mu * dot(1 / at.h, foreseen)
        now = _barrier_function(state, at, mu)
        for _ in range(40):
            goal = np.maximum(at.h + share * foreseen, 0.005 * at.h)
            point = self._retraction.step(at, du, dy, share, goal, heavy)
            ahead = self.program.linearise(point, at.value)
            if _barrier_function(state, ahead, mu) <= now + DOWNHILL * share * min(slope, 0.0) + 1e-13 * abs(now):
                break
            share /= 2
        else:
            return False
        if share == 1.0 and shift > FREE:
            ahead = self._stride(state, ahead, du, dy, mu)
        reach = max_step(lam, dlam)
        lam = lam + (FRACTION * reach if reach < 1 else 1.0) * dlam
        state.lam = np.clip(lam, mu / (APART * ahead.h), APART * mu / ahead.h)
        self._move, state.shift, state.at, state.s = du, shift, ahead, ahead.h
        return True

    def _stride(
        self, state: SeparatingPlaneState, ahead: LinearisedSeparatingPlanes, du: Floats, dy: Floats, mu: float
    ) -> LinearisedSeparatingPlanes:
        """Longer steps along a direction that a strengthened diagonal kept short, as long as they pay."""
        at, best, share = state.at, _barrier_function(state, ahead, mu), 4.0
        while share <= min(1024.0, self._longest_share(du)):
            further = self.program.linearise(self._retraction.step(at, du, dy, share), at.value)
            value = _barrier_function(state, further, mu)
            if not value < best:
                break
            ahead, best, share = further, value, 4 * share
        return ahead

    def _longest_share(self, u: Floats) -> float:
        """Largest share of a step that no body moves or turns too far in."""
        P = self.program
        change = P.unpacked(u) * P.scale
        turn = float(np.abs(change[:, 3:]).max(initial=0.0))
        move = float(np.abs(change[:, :3]).max(initial=0.0))
        return min(LARGEST_TURN / max(turn, 1e-300), LONGEST * self.horizon / max(move, 1e-300))

    def _direction(
        self, state: SeparatingPlaneState, primal: Floats, dual: Floats, dual_planes: Floats, least: float
    ) -> _SpatialStep | None:
        """Predictor and corrector; the diagonal is strengthened until the matrix is positive definite and the step no stub."""
        s, lam, mu, system = state.s, state.lam, self._mu, self._system
        system.set(state, dual)
        shift = TINY_SHIFT if state.shift <= 1e-8 else state.shift / 5
        found = None
        for attempt in range(24):
            if not system.factorise(shift + state.home):
                shift = max(10 * shift, 1e-5)
                continue
            _, _, ds, dl = system.newton(state, primal, dual, dual_planes, -s * lam)
            after = dot(s + max_step(s, ds) * ds, lam + max_step(lam, dl) * dl) / max(len(s), 1)
            centring = (after / mu) ** 3 if mu > 0 else 0.0
            if self._lag > 0.3:
                centring = max(centring, min(10.0, self._lag))
            goal = max(centring * mu, least) - s * lam - np.clip(ds * dl, -CORRECTION * mu, CORRECTION * mu)
            du, dy, ds, dl = system.newton(state, primal, dual, dual_planes, goal)
            far, dfar = max_step(s, ds), max_step(lam, dl)
            found = _SpatialStep(
                du, dy, ds, dl, FRACTION * far if far < 1 else 1.0, FRACTION * dfar if dfar < 1 else 1.0, shift
            )
            if found.primal > SHORT or attempt >= 5:
                break
            shift = max(10 * shift, 1e-6)
        return found

    def _take(self, state: SeparatingPlaneState, step: _SpatialStep) -> bool:
        """Take the step; halve it while rows fall behind the foreseen ones by more than half of the complementarity."""
        P, at = state.at.program, state.at
        longest_share = self._longest_share(step.u)
        share = min(step.primal, longest_share)
        lam = state.lam + step.dual * step.lam
        # full steps in a row that a strengthened diagonal keeps short: nothing is in the way, so stride out
        state.stride = min(4 * state.stride, 4096.0) if step.primal == 1.0 and step.shift > FREE else 1.0
        if min(state.stride, longest_share) > 4.0:
            point = self._retraction.step(at, step.u, step.y, min(state.stride, longest_share))
            ahead = P.linearise(point, at.value)
            if ahead.h.min(initial=np.inf) > 0 and ahead.value > at.value:
                self._move = step.u
                state.shift, state.lam, state.at, state.s = step.shift, lam, ahead, ahead.h
                return True
            state.stride = 1.0
        before = dot(state.lam, np.abs(state.s - at.h))
        foreseen = at.along(step.u, step.y)
        weight = state.lam / state.s
        weight = np.maximum(weight, weight.max(initial=1.0) / HEAVIEST)
        for _ in range(8):
            goal = np.maximum(at.h + share * foreseen, LEAST_SLACK)
            point = self._retraction.step(at, step.u, step.y, share, goal, weight)
            ahead = P.linearise(point, at.value)
            s = np.maximum(np.maximum(state.s + share * step.s, ahead.h), LEAST_SLACK)
            if dot(lam, s - ahead.h) <= max(0.5 * dot(s, lam), 2.0 * before):
                break
            share /= 2
        self._move = step.u
        state.shift, state.lam, state.at, state.s = step.shift, lam, ahead, s
        return True


def _barrier_function(state: SeparatingPlaneState, at: LinearisedSeparatingPlanes, mu: float) -> float:
    """Barrier function at a point, infinite outside the rows."""
    if at.h.min(initial=np.inf) <= 0:
        return np.inf
    P, pose = at.program, at.point.pose
    x = np.hstack([pose.T - P.bodies.at, logarithm(pose.R)])
    u = P.packed(x / P.scale)
    return -at.value / state.unit - mu * float(np.log(at.h).sum()) + state.home / 2 * dot(u, u)
