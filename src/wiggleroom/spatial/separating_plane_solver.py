"""Primal-dual interior-point method over bodies and planes.

Multipliers and planes are eliminated, so one symmetric matrix of 6 x 6 blocks on the graph of neighbours is factorised per iteration.
There are two modes. With slacks that may run ahead of the rows few iterations are needed, but a part may be carried through another one.
In the other mode every iterate is inside all rows: the barrier parameter is chosen by a predictor and a corrector as long as that makes
the error less; where it does not, it stands still until its problem is solved, with steps that make the barrier function smaller.

Source: adaptive and monotone barrier updates, Nocedal, Wachter and Waltz 2009.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.newton_step import dot, max_step
from wiggleroom.spatial.graph_retraction import GraphRetraction
from wiggleroom.spatial.separating_plane_newton import SeparatingPlaneIterate, SeparatingPlaneSystem
from wiggleroom.spatial.separating_plane_program import (
    LinearisedSeparatingPlanes,
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    beside_rest,
    parted,
)
from wiggleroom.spatial.separating_plane_settings import SETTINGS
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

CONSTANT = 1e-12
"""Where derivatives by what is free are below this share of all, the objective does not depend on it."""


@dataclass(frozen=True, eq=False)
class SeparatingPlaneSolution:
    """Where the method ended.

    Parameters
    ----------
    point : SeparatingPlanePoint
    lam : (R,) float64
        Multipliers: objective per mm of each row.
    value : float
    status : SolverStatus
    iterations : int
    path : tuple of SeparatingPlanePoint
        Points inside all rows, from the start.
    error : float
        Largest of complementarity and imbalance, in units of the objective.
    curved_down : bool
        True where the second-order conditions hold: no direction along the active rows goes up.
    """

    point: SeparatingPlanePoint
    lam: Floats
    value: float
    status: SolverStatus
    iterations: int
    path: tuple[SeparatingPlanePoint, ...]
    error: float
    curved_down: bool


@dataclass(frozen=True, eq=False)
class _PlaneStep:
    """Directions, how far they may be followed, and the barrier parameter that they aim at."""

    u: Floats
    y: Floats
    s: Floats
    lam: Floats
    primal: float
    dual: float
    shift: float
    mu: float


def _to_boundary(at: Floats, direction: Floats) -> float:
    """Share of a step that goes a fraction of the way to where something positive ends; all of it where nothing does."""
    far = max_step(at, direction)
    return SETTINGS.fraction * far if far < 1 else 1.0


@dataclass(frozen=True, eq=False)
class _BestIterate:
    """The iterate at which the conditions held best, and how many waypoints there were."""

    error: float
    state: SeparatingPlaneIterate
    path: int


@dataclass(eq=False)
class SeparatingPlaneSolver:
    """Largest objective of a program from rest.

    Parameters
    ----------
    program : SeparatingPlaneProgram
    inside : bool
        True: every iterate stays inside all rows, so that nothing can pass through anything.
    damped : bool
        True: where the matrix is not positive definite the rows are damped, not the diagonal alone, so that what many bodies do
        together stays free.
    tolerance : float
        Relative tolerance of the objective.
    most : int
        Iterations at most.
    seed : int
        Which point beside rest it starts from.
    horizon : float [mm]
        A body that moves further than this is taken to escape.
    most_turn : float
        An objective beyond this, where twists are maximised, is taken to turn without limit [rad].
    stop, progress : optional
        Asked and told (iteration, objective) every iteration.
    """

    program: SeparatingPlaneProgram
    inside: bool = True
    damped: bool = False
    tolerance: float = 3e-8
    most: int = 200
    seed: int = 0
    horizon: float = np.inf
    most_turn: float = np.inf
    stop: Stop | None = None
    progress: Callable[[int, float], None] | None = None
    iterations: int = 0
    path: list[SeparatingPlanePoint] = field(default_factory=list)

    def solve(
        self, start: SeparatingPlanePoint | None = None, mu: float = SETTINGS.first_mu
    ) -> SeparatingPlaneSolution:
        """Run the method from a point inside all rows."""
        P = self.program
        self._start_system()
        self._floor = SETTINGS.rounding * P.bodies.size / P.length
        self._fixed: float | None = None
        self._errors: list[float] = []
        at = P.linearise(beside_rest(P, self.seed) if start is None else start)
        unit = float(np.abs(at.gradient).max(initial=0.0)) or 1.0
        if unit <= CONSTANT * np.abs(P.objective.gradient(at.point.pose) * P.scale).max(initial=0.0):
            return self._at_rest()
        slack = at.h if self.inside else np.maximum(at.h, SETTINGS.first_slack)
        state = SeparatingPlaneIterate(
            at,
            slack,
            mu / slack,
            unit,
            SETTINGS.tiny_shift,
            P.start.pose,
            SETTINGS.anchored if self.inside else SETTINGS.loose,
        )
        self.path = [P.start]
        status, error, state = self._follow(state)
        curved = status is SolverStatus.CONVERGED and self._curved_down(state)
        last = state.at if state.at.point is self.path[-1] else P.linearise(self.path[-1], state.at.value)
        return SeparatingPlaneSolution(
            last.point,
            state.lam * unit / P.length,
            last.value,
            status,
            self.iterations,
            tuple(self.path),
            error,
            curved,
        )

    def _at_rest(self) -> SeparatingPlaneSolution:
        """The answer where nothing that is free changes the objective."""
        start = self.program.start
        value = self.program.objective.value(start.pose)
        nothing = np.zeros(self.program.rows)
        return SeparatingPlaneSolution(start, nothing, value, SolverStatus.CONVERGED, 0, (start,), 0.0, True)

    def _curved_down(self, state: SeparatingPlaneIterate) -> bool:
        """True where the condensed matrix is positive definite up to a small share.

        Rows weigh at most so much: what is positive definite then is so with their whole weight, whose rounding would hide it.
        """
        u = state.displacement
        weight = state.proximal(state.complementarity, u)
        dual = state.residuals(weight, u)[0]
        for most in SETTINGS.most_weights:
            self._system.set(replace(state, s=np.maximum(state.s, state.lam / most)), dual, weight)
            if self._system.factorise(SETTINGS.least_curvature):
                return True
        return False

    def _follow(self, state: SeparatingPlaneIterate) -> tuple[SolverStatus, float, SeparatingPlaneIterate]:
        """Advance the state until it is converged, stopped or escaping; where it gets no further, back to the best iterate."""
        before, escapes, least, since = np.inf, SETTINGS.saddles, np.inf, 0
        best = _BestIterate(np.inf, state, 0)
        patience = SETTINGS.patience_damped if self.damped else SETTINGS.patience
        for k in range(self.most + 1):
            u, mu = state.displacement, state.complementarity
            weight = state.proximal(mu, u)
            dual, dual_planes = state.residuals(weight, u)
            value = state.at.value / state.unit
            if self.progress is not None:
                self.progress(self.iterations, state.at.value)
            size = max(abs(value), 1.0)
            primal = state.s - state.at.h
            infeasible = dot(state.lam, np.abs(primal))
            rows = len(state.lam)
            gap = rows * mu + weight * dot(u, u)
            unheld = dot(np.abs(dual), np.abs(u))
            wrong = max(float(np.abs(d).max(initial=0.0)) for d in (dual, dual_planes))
            legal = self._legal(state.at)
            if legal is not None:
                self.path.append(legal)
            error = max(gap, infeasible, min(unheld, 1e3)) / size
            if k >= SETTINGS.least_iterations and wrong < SETTINGS.balanced and legal is not None:
                enough = max(self.tolerance * size, 5 * rows * self._floor)
                settled = unheld < 10 * enough or (
                    abs(value - before) < enough and unheld < np.sqrt(self.tolerance) * size
                )
                if max(gap, infeasible) < enough and settled:
                    escapes -= 1
                    aside = (
                        None if escapes < 0 or self._curved_down(state) else self._recentred(state, SETTINGS.highest)
                    )
                    if aside is None:
                        return SolverStatus.CONVERGED, error, state
                    state, before, best = aside, value, _BestIterate(np.inf, state, 0)
                    self.iterations += 1
                    continue
                if error < best.error:
                    best = _BestIterate(error, state, len(self.path))
            if self.stop is not None and self.stop.is_set():
                return SolverStatus.STOPPED, error, state
            moved = np.abs(state.at.point.pose.T - self.program.bodies.at).max(initial=0.0)
            if moved > self.horizon or abs(state.at.value) > self.most_turn:
                return (SolverStatus.ESCAPING if legal is not None else SolverStatus.FAILED), error, state
            lost = best.error < SETTINGS.acceptable and error > SETTINGS.lost * best.error
            least, since = (error, 0) if error < 0.9 * least else (least, since + 1)
            if k == self.most or lost or (not self.inside and since > patience):
                break
            lowest = max(0.2 * self.tolerance * size / max(rows, 1), self._floor)
            lag = max(infeasible, SETTINGS.unheld * unheld if unheld > SETTINGS.early * size else 0.0) / max(
                rows * mu, 1e-300
            )
            following = (
                self._advance(state, dual, dual_planes, weight, u, wrong, lowest)
                if self.inside
                else self._run_ahead(state, primal, dual, dual_planes, weight, u, lag, lowest)
            )
            if following is None:
                break
            self.iterations += 1
            state, before = following, value
        if best.error < SETTINGS.acceptable:
            del self.path[best.path :]
            return SolverStatus.CONVERGED, best.error, best.state
        return SolverStatus.FAILED, error, state

    def _start_system(self) -> None:
        """Make the retraction and the factorisation of the program ready."""
        self._retraction = GraphRetraction(self.program)
        self._system = SeparatingPlaneSystem(factor(self.program.pattern), self._retraction)

    def _legal(self, at: LinearisedSeparatingPlanes) -> SeparatingPlanePoint | None:
        """The point, inside all rows once planes that lag behind are set anew; None where pieces overlap."""
        if at.h.min(initial=np.inf) > 0:
            return at.point
        found = parted(self.program, at.point, at.h)
        return found if self.program.values(found).min(initial=np.inf) > 0 else None

    def _run_ahead(
        self,
        state: SeparatingPlaneIterate,
        primal: Floats,
        dual: Floats,
        dual_planes: Floats,
        weight: float,
        u: Floats,
        lag: float,
        lowest: float,
    ) -> SeparatingPlaneIterate | None:
        """The next iterate with slacks: the step is halved while rows fall behind by more than half of the complementarity."""
        self._system.set(state, dual, weight)
        step = self._predicted(state, primal, dual, dual_planes, weight, u, lowest, lag)
        if step is None:
            return None
        share = min(step.primal, self._longest_share(step.u))
        lam = state.lam + step.dual * step.lam
        before = dot(state.lam, np.abs(primal))
        for _ in range(8):
            ahead = self._moved(state, step, share, SETTINGS.least_slack)
            s = np.maximum(np.maximum(state.s + share * step.s, ahead.h), SETTINGS.least_slack)
            if dot(lam, s - ahead.h) <= max(0.5 * dot(s, lam), 2.0 * before):
                break
            share /= 2
        return replace(state, at=ahead, s=s, lam=lam, shift=step.shift)

    def _advance(
        self,
        state: SeparatingPlaneIterate,
        dual: Floats,
        dual_planes: Floats,
        weight: float,
        u: Floats,
        wrong: float,
        lowest: float,
    ) -> SeparatingPlaneIterate | None:
        """The next iterate; None where no step makes the barrier function smaller."""
        mu = state.complementarity
        self._system.set(state, dual, weight)
        if self._fixed is not None:
            spread = float(np.abs(state.at.h * state.lam - self._fixed).max(initial=0.0))
            solved = SETTINGS.solved * self._fixed
            if max(wrong, spread) < solved:
                self._fixed, self._errors = None, [solved]
        if self._fixed is None:
            self._errors.append(mu + SETTINGS.balance_share * wrong)
            step = self._predicted(state, np.zeros_like(state.s), dual, dual_planes, weight, u, lowest)
            following = None if step is None else self._taken(state, step)
            if following is not None and self._error(following) < SETTINGS.progress * max(
                self._errors[-SETTINGS.memory :]
            ):
                return following
            self._fixed = max(SETTINGS.reduction * mu if self._solved_at(mu, wrong) else mu, lowest)
            self._since = 0
        self._since += 1
        if self._since > SETTINGS.stuck and self._fixed < SETTINGS.highest:
            return self._recentred(state, min(SETTINGS.raised * self._fixed, SETTINGS.highest))
        return self._descended(state, dual_planes, max(self._fixed, lowest), u)

    def _recentred(self, state: SeparatingPlaneIterate, mu: float) -> SeparatingPlaneIterate | None:
        """The iterate after a first step at a larger mu, which then stands still; displacements count from here on."""
        self._fixed, self._since = mu, 0
        state = replace(state, anchor=state.at.point.pose)
        u = state.displacement
        weight = state.proximal(mu, u)
        dual, dual_planes = state.residuals(weight, u)
        self._system.set(state, dual, weight)
        return self._descended(state, dual_planes, mu, u)

    def _solved_at(self, mu: float, wrong: float) -> bool:
        """True where the problem of the present barrier parameter is solved."""
        return wrong < SETTINGS.solved * mu

    def _error(self, state: SeparatingPlaneIterate) -> float:
        """Complementarity and imbalance of an iterate in one number."""
        u, mu = state.displacement, state.complementarity
        dual, dual_planes = state.residuals(state.proximal(mu, u), u)
        return mu + SETTINGS.balance_share * max(float(np.abs(d).max(initial=0.0)) for d in (dual, dual_planes))

    def _predicted(
        self,
        state: SeparatingPlaneIterate,
        primal: Floats,
        dual: Floats,
        dual_planes: Floats,
        weight: float,
        u: Floats,
        lowest: float,
        lag: float = 0.0,
    ) -> _PlaneStep | None:
        """Predictor and corrector; diagonal or rows are strengthened until the matrix is positive definite and the step no stub.

        Source: Mehrotra 1992.
        """
        s, lam, mu, system = state.s, state.lam, state.complementarity, self._system
        growth = SETTINGS.damping_growth if self.damped else 10.0
        before = state.shift if state.shift > SETTINGS.negligible_shift else 0.0
        shift = before / 5 if self.damped else max(SETTINGS.tiny_shift, mu if self.inside else 0.0, before / 5)
        found = None
        for attempt in range(24):
            if not (system.factorise_damped(shift) if self.damped else system.factorise(shift)):
                shift = max(growth * shift, SETTINGS.least_damping)
                continue
            _, _, ds, dl = system.newton(primal, dual, dual_planes, -s * lam)
            after = dot(s + max_step(s, ds) * ds, lam + max_step(lam, dl) * dl) / max(len(s), 1)
            centring = max((after / mu) ** 3 if mu > 0 else 0.0, min(10.0, lag) if lag > SETTINGS.behind else 0.0)
            target = max(centring * mu, lowest)
            goal = (
                target - s * lam - np.clip(ds * dl, -SETTINGS.largest_correction * mu, SETTINGS.largest_correction * mu)
            )
            less = (state.proximal(min(target, mu), u) - weight) * u
            du, dy, ds, dl = system.newton(primal, dual + less, dual_planes, goal)
            found = _PlaneStep(du, dy, ds, dl, _to_boundary(s, ds), _to_boundary(lam, dl), shift, target)
            if found.primal > SETTINGS.short or attempt >= 5:
                break
            shift = max(growth * shift, SETTINGS.least_damping if self.damped else 1e-6)
        return found

    def _taken(self, state: SeparatingPlaneIterate, step: _PlaneStep) -> SeparatingPlaneIterate | None:
        """The iterate after a step of predictor and corrector; None where that is outside the rows or nearly no step."""
        share = min(step.primal, self._longest_share(step.u))
        for _ in range(3):
            ahead = self._moved(state, step, share)
            if (ahead.h > SETTINGS.least_share_of_row * (1 - SETTINGS.fraction) * state.at.h).all():
                lam = state.lam + min(step.dual, 1.0) * step.lam
                lam = np.clip(lam, step.mu / (SETTINGS.far_apart * ahead.h), SETTINGS.far_apart * step.mu / ahead.h)
                return replace(state, at=ahead, s=ahead.h, lam=lam, shift=step.shift)
            share /= 2
        return None

    def _descended(
        self, state: SeparatingPlaneIterate, dual_planes: Floats, mu: float, u: Floats
    ) -> SeparatingPlaneIterate | None:
        """The iterate after one step that makes the barrier function at a fixed mu smaller."""
        h, lam, system, at = state.at.h, state.lam, self._system, state.at
        weight = state.proximal(mu, u)
        dual = state.residuals(weight, u)[0]
        shift = max(SETTINGS.tiny_shift, mu, state.shift / 3 if state.shift > SETTINGS.negligible_shift else 0.0)
        while not system.factorise(shift):
            shift = max(8 * shift, 1e-5)
            if shift > 1e12:
                return None
        du, dy, dh, dlam = system.newton(np.zeros_like(h), dual, dual_planes, mu - h * lam)
        step = _PlaneStep(du, dy, dh, dlam, _to_boundary(h, dh), _to_boundary(lam, dlam), shift, mu)
        slope = dot(weight * u - at.gradient / state.unit, du) - mu * dot(1 / h, dh)
        now, share = state.barrier(at, mu, weight), min(step.primal, self._longest_share(du))
        for _ in range(40):
            ahead = self._moved(state, step, share)
            value = state.barrier(ahead, mu, weight)
            if value <= now + SETTINGS.downhill * share * min(slope, 0.0) + 1e-13 * abs(now):
                break
            share /= 2
        else:
            return None
        if share == 1.0 and shift > SETTINGS.free:
            ahead = self._stride(state, ahead, step, weight)
        lam = np.clip(lam + step.dual * dlam, mu / (SETTINGS.apart * ahead.h), SETTINGS.apart * mu / ahead.h)
        return replace(state, at=ahead, s=ahead.h, lam=lam, shift=shift)

    def _moved(
        self, state: SeparatingPlaneIterate, step: _PlaneStep, share: float, least: float | None = None
    ) -> LinearisedSeparatingPlanes:
        """The program after a share of a step, with corrections of second order by the factorisation of the step."""
        P, at = self.program, state.at
        foreseen = at.h + share * at.along(step.u, step.y)
        goal = np.maximum(foreseen, SETTINGS.least_share_of_row * at.h if least is None else least)
        heavy = state.lam / state.s
        heavy = np.maximum(heavy, heavy.max(initial=1.0) / SETTINGS.heaviest)
        ahead = P.linearise(self._retraction.step(at, step.u, step.y, share, goal, heavy), at.value)
        behind = dot(heavy, np.maximum(goal - ahead.h, 0.0))
        for _ in range(SETTINGS.corrections):
            if behind <= SETTINGS.corrected * dot(heavy, goal):
                break
            du, dy = self._system.correction(goal - ahead.h)
            if not self._longest_share(du) > 1:
                break
            trial = P.linearise(self._retraction.step(ahead, du, dy, 1.0, goal, heavy), ahead.value)
            left = dot(heavy, np.maximum(goal - trial.h, 0.0))
            if not left < 0.7 * behind:
                break
            ahead, behind = trial, left
        return ahead

    def _stride(
        self, state: SeparatingPlaneIterate, ahead: LinearisedSeparatingPlanes, step: _PlaneStep, weight: float
    ) -> LinearisedSeparatingPlanes:
        """Longer steps along a direction that a strengthened diagonal kept short, as long as they pay."""
        best, share = state.barrier(ahead, step.mu, weight), 4.0
        while share <= min(1024.0, self._longest_share(step.u)):
            further = self.program.linearise(self._retraction.step(state.at, step.u, step.y, share), state.at.value)
            value = state.barrier(further, step.mu, weight)
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
        return min(SETTINGS.largest_turn / max(turn, 1e-300), SETTINGS.longest * self.horizon / max(move, 1e-300))
