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
from wiggleroom.solve.newton_step import dot
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.planes.separating_plane_newton import CarriedIterate, SeparatingPlaneIterate
from wiggleroom.spatial.planes.separating_plane_program import (
    LinearisedSeparatingPlanes,
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    beside_rest,
    parted,
)
from wiggleroom.spatial.planes.separating_plane_settings import SETTINGS
from wiggleroom.spatial.planes.separating_plane_steps import SeparatingPlaneSteps
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
    centred : bool
        True: the barrier parameter follows closely what is not held yet. So hundreds of bodies that hem each other in settle; one that has
        room may be carried through another.
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
    lacks : optional
        Asked once, at a rough answer, whether the program lacks rows that are broken there: then the method ends, STOPPED.
    """

    program: SeparatingPlaneProgram
    inside: bool = True
    damped: bool = False
    centred: bool = False
    tolerance: float = 2e-9
    most: int = 200
    seed: int = 0
    horizon: float = np.inf
    most_turn: float = np.inf
    stop: Stop | None = None
    progress: Callable[[int, float], None] | None = None
    lacks: Callable[[SpatialPose], bool] | None = None
    iterations: int = 0
    path: list[SeparatingPlanePoint] = field(default_factory=list)

    def solve(
        self, start: CarriedIterate | None = None, carried_mu: float = SETTINGS.carried_mu[0]
    ) -> SeparatingPlaneSolution:
        """Run the method from beside rest, or from the end of a round before."""
        P = self.program
        self._steps = SeparatingPlaneSteps(P, self.inside, self.damped, self.horizon)
        self._floor = SETTINGS.rounding * P.bodies.size / P.length
        at = P.linearise(beside_rest(P, self.seed)) if start is None else P.linearise(start.point, start.value)
        unit = float(np.abs(at.gradient).max(initial=0.0)) or 1.0
        if unit <= CONSTANT * np.abs(P.objective.gradient(at.point.pose) * P.scale).max(initial=0.0):
            return self._at_rest()
        state = self._first_iterate(at, unit, start, carried_mu)
        self.path = [P.start] if start is None else list(start.path)
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

    def _first_iterate(
        self, at: LinearisedSeparatingPlanes, unit: float, start: CarriedIterate | None, carried_mu: float
    ) -> SeparatingPlaneIterate:
        """Slacks and multipliers to begin with: all products alike, or at least so large where a round goes on."""
        P = self.program
        held = SETTINGS.anchored if self.inside else SETTINGS.loose
        if start is None:
            slack = at.h if self.inside else np.maximum(at.h, SETTINGS.first_slack)
            return SeparatingPlaneIterate(
                at, slack, SETTINGS.first_mu / slack, unit, SETTINGS.tiny_shift, P.start.pose, held
            )
        mu = carried_mu * max(1.0, abs(start.value) / unit) / P.rows
        lam = np.maximum(start.lam * P.length / unit, np.sqrt(mu))
        slack = np.maximum(at.h, mu / lam)
        lam = np.maximum(start.lam * P.length / unit, mu / slack)
        return SeparatingPlaneIterate(at, slack, lam, unit, SETTINGS.carried_damping, P.start.pose, held)

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
        lacking = state.residuals(state.complementarity)
        for most in SETTINGS.most_weights:
            self._steps.system.set(replace(state, s=np.maximum(state.s, state.lam / most)), lacking)
            if self._steps.system.factorise(SETTINGS.least_curvature):
                return True
        return False

    def _follow(self, state: SeparatingPlaneIterate) -> tuple[SolverStatus, float, SeparatingPlaneIterate]:
        """Advance the state until it is converged, stopped or escaping; where it gets no further, back to the best iterate."""
        before, escapes, least, since = np.inf, SETTINGS.saddles, np.inf, 0
        best = _BestIterate(np.inf, state, 0)
        patience = SETTINGS.patience_damped if self.damped else SETTINGS.patience
        unheld_weight, early = self._weight_of_unheld()
        lacks = self.lacks
        for k in range(self.most + 1):
            mu = state.complementarity
            lacking = state.residuals(mu)
            value = state.at.value / state.unit
            if self.progress is not None:
                self.progress(self.iterations, state.at.value)
            size = max(abs(value), 1.0)
            infeasible = dot(state.lam, np.abs(lacking.primal))
            rows = len(state.lam)
            gap = rows * mu + lacking.weight * dot(lacking.u, lacking.u)
            unheld = lacking.unheld
            legal = self._legal(state.at)
            if legal is not None:
                self.path.append(legal)
            error = max(gap, infeasible, min(unheld, 1e3)) / size
            if k >= SETTINGS.least_iterations and lacking.imbalance < SETTINGS.balanced and legal is not None:
                enough = max(self.tolerance * size, 5 * rows * self._floor)
                settled = unheld < 10 * enough or (
                    abs(value - before) < enough and unheld < np.sqrt(self.tolerance) * size
                )
                if max(gap, infeasible) < enough and settled:
                    escapes -= 1
                    aside = (
                        None
                        if escapes < 0 or self._curved_down(state)
                        else self._steps.recentred(state, SETTINGS.highest)
                    )
                    if aside is None:
                        return SolverStatus.CONVERGED, error, state
                    state, before, best = aside, value, _BestIterate(np.inf, state, 0)
                    self.iterations += 1
                    continue
                if max(gap, infeasible) < enough and not settled and escapes > 0 and self._renews:
                    # the end is reached but for multipliers, which shrinking rows have made noise: a wider barrier sets them anew
                    aside = self._steps.recentred(state, SETTINGS.highest)
                    if aside is not None:
                        escapes -= 1
                        state, before = aside, value
                        self.iterations += 1
                        continue
                if error < best.error:
                    best = _BestIterate(error, state, len(self.path))
            if self.stop is not None and self.stop.is_set():
                return SolverStatus.STOPPED, error, state
            if lacks is not None and k >= SETTINGS.least_iterations and error < SETTINGS.rough and legal is not None:
                if lacks(legal.pose):
                    return SolverStatus.STOPPED, error, state
                lacks = None
            moved = np.abs(state.at.point.pose.T - self.program.bodies.at).max(initial=0.0)
            if moved > self.horizon or abs(state.at.value) > self.most_turn:
                return (SolverStatus.ESCAPING if legal is not None else SolverStatus.FAILED), error, state
            lost = best.error < SETTINGS.acceptable and error > SETTINGS.lost * best.error
            least, since = (error, 0) if error < 0.9 * least else (least, since + 1)
            if k == self.most or lost or error > SETTINGS.diverged or (not self.inside and since > patience):
                break
            lowest = max(0.2 * self.tolerance * size / max(rows, 1), self._floor)
            lag = max(infeasible, unheld_weight * unheld if unheld > early * size else 0.0) / max(rows * mu, 1e-300)
            following = (
                self._steps.advance(state, lacking, lowest)
                if self.inside
                else self._steps.run_ahead(state, lacking, lag, lowest)
            )
            if following is None:
                break
            self.iterations += 1
            state, before = following, value
        if best.error < SETTINGS.acceptable:
            del self.path[best.path :]
            return SolverStatus.CONVERGED, best.error, best.state
        return SolverStatus.FAILED, error, state

    def _weight_of_unheld(self) -> tuple[float, float]:
        """Weight of what is not held in the choice of the barrier parameter, and the share of the objective from which on it counts."""
        if self.centred:
            return SETTINGS.unheld_centred, SETTINGS.early_centred
        if self.damped:
            return SETTINGS.unheld_damped, SETTINGS.early_damped
        return SETTINGS.unheld, SETTINGS.early

    @property
    def _renews(self) -> bool:
        """True where multipliers are set anew at the end: with few rows another mode may find a better one."""
        return self.damped and self.program.rows > SETTINGS.many_rows

    def _legal(self, at: LinearisedSeparatingPlanes) -> SeparatingPlanePoint | None:
        """The point, inside all rows once planes that lag behind are set anew; None where pieces overlap."""
        if at.h.min(initial=np.inf) > 0:
            return at.point
        found = parted(self.program, at.point, at.h)
        return found if self.program.values(found).min(initial=np.inf) > 0 else None
