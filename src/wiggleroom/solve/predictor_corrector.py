"""One step of Mehrotra's predictor and corrector, and how much of it is taken."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.centrality_correctors import corrected
from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.interior_point_settings import SETTINGS, settings_for
from wiggleroom.solve.newton_step import MIN_SHIFT, Direction, Iterate, dot, newton
from wiggleroom.solve.row_operations import corrector_goal, gap_after, stepped_slacks, violation

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """A direction, and how far to go along it.

    Parameters
    ----------
    u, s, lam : (3F,), (R,), (R,) float64
        Changes of variables, slacks and multipliers.
    primal, dual : float in [0, 1]
        Shares of the first two, and of the multipliers, that are taken.
    shift : float
        What strengthened the diagonal.
    """

    u: Floats
    s: Floats
    lam: Floats
    primal: float
    dual: float
    shift: float

    @classmethod
    def to_boundary(cls, direction: Direction, shift: float) -> NewtonStep:
        """All of a direction, or most of the way to where a slack or a multiplier becomes nothing."""
        share = SETTINGS.fraction_to_boundary
        primal = share * direction.primal if direction.primal < 1 else 1.0
        dual = share * direction.dual if direction.dual < 1 else 1.0
        return cls(direction.u, direction.s, direction.lam, primal, dual, shift)

    def capped(self, longest: float) -> NewtonStep:
        """The same, but no body moves further than `longest` [program.length] at once."""
        far = float(np.abs(self.u).max(initial=0.0))
        return self if self.primal * far <= longest else replace(self, primal=longest / far)


def predictor_corrector_step(
    state: Iterate,
    matrix: Factor,
    retraction: Retraction,
    primal: Floats,
    dual: Floats,
    mu: float,
    infeasibility_ratio: float,
    least: float,
) -> NewtonStep | None:
    """The next step, and with it the barrier parameter: centring (mu after the predictor / mu)^3 mu, then the corrector.

    The diagonal is strengthened until the matrix is positive definite and the step is not too short.
    """
    s, lam, at = state.s, state.lam, state.at
    settings = settings_for(len(state.u))
    data = at.condensed(lam / s, lam, retraction.balance(dual, at), 1.0 / state.unit)
    shift = MIN_SHIFT if state.shift <= 1e-8 else state.shift / 5
    found, goal = None, np.empty_like(s)
    for attempt in range(16):
        if not matrix.update(data, shift + state.proximal_weight):
            shift = max(10 * shift, 1e-5)
            continue
        np.negative(np.multiply(s, lam, out=goal), out=goal)
        predictor = newton(state, matrix, primal, dual, goal)
        after = gap_after(s, predictor.s, lam, predictor.lam, predictor.primal, predictor.dual) / max(len(s), 1)
        centring = (after / mu) ** 3 if mu > 0 else 0.0
        if infeasibility_ratio > 0.3:  # feasibility must not fall behind complementarity
            centring = max(centring, min(settings.max_centring, infeasibility_ratio))
        if state.growth > settings.min_growth:
            centring = max(centring, settings.moving_centring)
        mean = max(centring * mu, least)
        corrector_goal(s, predictor.s, lam, predictor.lam, mean, SETTINGS.max_correction * mu, goal)
        del predictor  # in assemblies of a million parts these arrays count
        direction = newton(state, matrix, primal, dual, goal)
        if mu * len(s) < settings.corrected_gap * max(abs(at.value) / state.unit, 1.0):
            direction = corrected(state, matrix, direction, mean)
        found = NewtonStep.to_boundary(direction, shift)
        if found.primal > SETTINGS.min_step_length or attempt >= 5:
            break
        shift = max(10 * shift, 1e-6)
    stuck = found is not None and found.shift > SETTINGS.hopeless_shift and found.primal < SETTINGS.min_step_length
    return None if stuck else found


def take_step(state: Iterate, step: NewtonStep, retraction: Retraction) -> None:
    """Take the step; halve it while the infeasibility grows beyond half the complementarity."""
    lam, value = state.lam + step.dual * step.lam, state.at.value
    share = step.primal
    before = violation(state.lam, state.s, state.at.h)
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
    s = np.empty_like(lam)
    for _ in range(6):
        u = retraction.step(state.u, share * step.u, state.at)
        at = state.at.program.linearise(u)
        stepped_slacks(state.s, step.s, share, at.h, SETTINGS.min_slack, s)
        if violation(lam, s, at.h) <= max(0.5 * dot(s, lam), 2.0 * before):
            break
        share /= 2
    state.move, state.shift = step.u, step.shift
    state.u, state.s, state.lam, state.at = u, s, lam, at
    state.growth = (at.value - value) / max(abs(at.value), state.unit)
