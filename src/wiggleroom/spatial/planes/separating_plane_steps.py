"""Steps of the interior-point method over bodies and planes: predictor and corrector, and descent at a barrier parameter that stands still.

Source: predictor and corrector, Mehrotra 1992; adaptive and monotone barrier updates, Nocedal, Wachter and Waltz 2009.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.newton_step import dot, max_step
from wiggleroom.spatial.planes.graph_retraction import GraphRetraction
from wiggleroom.spatial.planes.separating_plane_newton import (
    SeparatingPlaneIterate,
    SeparatingPlaneResiduals,
    SeparatingPlaneSystem,
)
from wiggleroom.spatial.planes.separating_plane_program import LinearisedSeparatingPlanes, SeparatingPlaneProgram
from wiggleroom.spatial.planes.separating_plane_settings import SETTINGS

Floats = NDArray[np.float64]


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


@dataclass(eq=False)
class SeparatingPlaneSteps:
    """What leads from one iterate to the next, and what is remembered for it.

    Parameters
    ----------
    program : SeparatingPlaneProgram
    damped : bool
        As in `SeparatingPlaneSolver`.
    inside : bool
        As there.
    horizon : float [mm]
        As there; no step moves a body by more than a share of it.
    """

    program: SeparatingPlaneProgram
    inside: bool
    damped: bool
    horizon: float
    _fixed_mu: float | None = field(default=None, init=False)  # where the barrier parameter stands still
    _errors: list[float] = field(default_factory=list, init=False)  # of iterates while it does not
    _steps_at_fixed_mu: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.retraction = GraphRetraction(self.program)
        self.system = SeparatingPlaneSystem(factor(self.program.pattern), self.retraction)

    def run_ahead(
        self, state: SeparatingPlaneIterate, lacking: SeparatingPlaneResiduals, lag: float, lowest: float
    ) -> SeparatingPlaneIterate | None:
        """The next iterate with slacks: the step is halved while rows fall behind by more than half of the complementarity."""
        self.system.set(state, lacking)
        step = self._predicted(state, lacking, lowest, lag)
        if step is None:
            return None
        share = min(step.primal, self._longest_share(step.u))
        lam = state.lam + step.dual * step.lam
        before = dot(state.lam, np.abs(lacking.primal))
        for _ in range(8):
            ahead = self._moved(state, step, share, SETTINGS.least_slack)
            s = np.maximum(np.maximum(state.s + share * step.s, ahead.h), SETTINGS.least_slack)
            if dot(lam, s - ahead.h) <= max(0.5 * dot(s, lam), 2.0 * before):
                break
            share /= 2
        return replace(state, at=ahead, s=s, lam=lam, shift=step.shift)

    def advance(
        self, state: SeparatingPlaneIterate, lacking: SeparatingPlaneResiduals, lowest: float
    ) -> SeparatingPlaneIterate | None:
        """The next iterate; None where no step makes the barrier function smaller."""
        mu, wrong = state.complementarity, lacking.imbalance
        self.system.set(state, lacking)
        if self._fixed_mu is not None:
            spread = float(np.abs(state.at.h * state.lam - self._fixed_mu).max(initial=0.0))
            solved = SETTINGS.solved * self._fixed_mu
            if max(wrong, spread) < solved:
                self._fixed_mu, self._errors = None, [solved]
        if self._fixed_mu is None:
            self._errors.append(mu + SETTINGS.balance_share * wrong)
            step = self._predicted(state, lacking, lowest)
            following = None if step is None else self._taken(state, step)
            if following is not None and self._error(following) < SETTINGS.progress * max(
                self._errors[-SETTINGS.memory :]
            ):
                return following
            self._fixed_mu = max(SETTINGS.reduction * mu if self._solved_at(mu, wrong) else mu, lowest)
            self._steps_at_fixed_mu = 0
        self._steps_at_fixed_mu += 1
        if self._steps_at_fixed_mu > SETTINGS.stuck and self._fixed_mu < SETTINGS.highest:
            return self.recentred(state, min(SETTINGS.raised * self._fixed_mu, SETTINGS.highest))
        return self._descended(state, max(self._fixed_mu, lowest))

    def recentred(self, state: SeparatingPlaneIterate, mu: float) -> SeparatingPlaneIterate | None:
        """The iterate after a first step at a larger mu, which then stands still; displacements count from here on."""
        self._fixed_mu, self._steps_at_fixed_mu = mu, 0
        state = replace(state, anchor=state.at.point.pose)
        self.system.set(state, state.residuals(mu))
        return self._descended(state, mu)

    def _solved_at(self, mu: float, wrong: float) -> bool:
        """True where the problem of the present barrier parameter is solved."""
        return wrong < SETTINGS.solved * mu

    def _error(self, state: SeparatingPlaneIterate) -> float:
        """Complementarity and imbalance of an iterate in one number."""
        mu = state.complementarity
        return mu + SETTINGS.balance_share * state.residuals(mu).imbalance

    def _predicted(
        self, state: SeparatingPlaneIterate, lacking: SeparatingPlaneResiduals, lowest: float, lag: float = 0.0
    ) -> _PlaneStep | None:
        """Predictor and corrector; diagonal or rows are strengthened until the matrix is positive definite and the step no stub.

        Source: Mehrotra 1992.
        """
        s, lam, mu, system = state.s, state.lam, state.complementarity, self.system
        growth = SETTINGS.damping_growth if self.damped else 10.0
        before = state.shift if state.shift > SETTINGS.negligible_shift else 0.0
        shift = before / 5 if self.damped else max(SETTINGS.tiny_shift, mu if self.inside else 0.0, before / 5)
        found = None
        for attempt in range(24):
            if not (system.factorise_damped(shift) if self.damped else system.factorise(shift)):
                shift = max(growth * shift, SETTINGS.least_damping)
                continue
            _, _, ds, dl = system.newton(lacking, -s * lam)
            after = dot(s + max_step(s, ds) * ds, lam + max_step(lam, dl) * dl) / max(len(s), 1)
            centring = max((after / mu) ** 3 if mu > 0 else 0.0, min(10.0, lag) if lag > SETTINGS.behind else 0.0)
            target = max(centring * mu, lowest)
            goal = (
                target - s * lam - np.clip(ds * dl, -SETTINGS.largest_correction * mu, SETTINGS.largest_correction * mu)
            )
            less = (state.proximal(min(target, mu), lacking.u) - lacking.weight) * lacking.u
            ahead = replace(lacking, dual=lacking.dual + less)
            du, dy, ds, dl = system.newton(ahead, goal)
            found = _PlaneStep(du, dy, ds, dl, _to_boundary(s, ds), _to_boundary(lam, dl), shift, target)
            if self.damped:
                found = self._lengthened(state, ahead, goal, found)
            if found.primal > SETTINGS.short or attempt >= 5:
                break
            shift = max(growth * shift, SETTINGS.least_damping if self.damped else 1e-6)
        return found

    def _lengthened(
        self, state: SeparatingPlaneIterate, lacking: SeparatingPlaneResiduals, goal: Floats, step: _PlaneStep
    ) -> _PlaneStep:
        """The step with corrections towards the central path, as long as they make it longer.

        Source: multiple centrality corrections, Gondzio 1996.
        """
        s, lam = state.s, state.lam
        least, most = step.mu / SETTINGS.off_centre, step.mu * SETTINGS.off_centre
        for _ in range(SETTINGS.centrality_corrections):
            if min(step.primal, step.dual) >= SETTINGS.fraction:
                break
            ahead = [min(1.0, share + SETTINGS.longer) for share in (step.primal, step.dual)]
            product = (s + ahead[0] * step.s) * (lam + ahead[1] * step.lam)
            goal = goal + np.maximum(np.clip(product, least, most) - product, -most)
            du, dy, ds, dl = self.system.newton(lacking, goal)
            trial = _PlaneStep(du, dy, ds, dl, _to_boundary(s, ds), _to_boundary(lam, dl), step.shift, step.mu)
            if trial.primal + trial.dual < step.primal + step.dual + SETTINGS.worthwhile:
                break
            step = trial
        return step

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

    def _descended(self, state: SeparatingPlaneIterate, mu: float) -> SeparatingPlaneIterate | None:
        """The iterate after one step that makes the barrier function at a fixed mu smaller."""
        h, lam, system, at = state.at.h, state.lam, self.system, state.at
        lacking = state.residuals(mu)
        shift = max(SETTINGS.tiny_shift, mu, state.shift / 3 if state.shift > SETTINGS.negligible_shift else 0.0)
        while not system.factorise(shift):
            shift = max(8 * shift, 1e-5)
            if shift > 1e12:
                return None
        du, dy, dh, dlam = system.newton(lacking, mu - h * lam)
        step = _PlaneStep(du, dy, dh, dlam, _to_boundary(h, dh), _to_boundary(lam, dlam), shift, mu)
        weight = lacking.weight
        slope = dot(weight * lacking.u - at.gradient / state.unit, du) - mu * dot(1 / h, dh)
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
        ahead = P.linearise(self.retraction.step(at, step.u, step.y, share, goal, heavy), at.value)
        behind = dot(heavy, np.maximum(goal - ahead.h, 0.0))
        for _ in range(SETTINGS.corrections):
            if behind <= SETTINGS.corrected * dot(heavy, goal):
                break
            du, dy = self.system.correction(goal - ahead.h)
            if not self._longest_share(du) > 1:
                break
            trial = P.linearise(self.retraction.step(ahead, du, dy, 1.0, goal, heavy), ahead.value)
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
            further = self.program.linearise(self.retraction.step(state.at, step.u, step.y, share), state.at.value)
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
