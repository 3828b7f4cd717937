"""Plans when gaps vary: the share of draws that go together, whose gap decides, and the smallest gap at which a plan works."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.displayable import Displayable
from wiggleroom.errors import InputError
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.plan_geometry import PlanGeometry
from wiggleroom.planning.steps import Step
from wiggleroom.sensitivity.gap_distribution import Spread, wilson

Floats = NDArray[np.float64]

GAP_TOLERANCE = 0.01
"""Both sides of the smallest gap end no further apart than this share of it."""
MIN_GAP_SHARE = 1e-3
"""Gaps below this share of the plan's own are not tried."""
RANK_SHARE = 0.1
"""For a ranking, gaps grow by this share of the least clearance."""


@dataclass(frozen=True, eq=False)
class PlanSample(Displayable):
    """A plan under random variation of the gap round every part.

    Parameters
    ----------
    plan : Plan
    spread : Spread
    clearance : (d,) float64 [mm]
        Least clearance of every draw on the unchanged paths of the plan; not above 0 for a draw that does not go together.
    failing : tuple of int
        Number of draws in which each step fails, from the first; the last entry counts draws whose parts overlap at rest.
    """

    plan: Plan
    spread: Spread
    clearance: Floats
    failing: tuple[int, ...]

    @property
    def share(self) -> float:
        """Share of the draws that go together."""
        return float((self.clearance > 0).mean())

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the share."""
        return wilson(int((self.clearance > 0).sum()), len(self.clearance))

    def quantile(self, q: float) -> float:
        """Least clearance [mm] that a share q of the draws falls below."""
        return float(np.quantile(self.clearance, q))


@dataclass(frozen=True, eq=False)
class PlanRanking(Displayable):
    """Gaps ranked by the room that they give a plan.

    Parameters
    ----------
    plan : Plan
    parts : tuple of names
        The most important first.
    gain : (n,) float64 [mm per mm]
        Gain of the plan's least clearance, its paths fitted anew, per mm of extra gap round each of these parts.
    """

    plan: Plan
    parts: tuple[str, ...]
    gain: Floats


@dataclass(frozen=True, eq=False)
class SmallestGap(Displayable):
    """The smallest gap at which a plan works, from both sides.

    Parameters
    ----------
    plan : Plan
    works_at : float [mm]
        Smallest gap at which all steps, fitted anew, are free.
    works : tuple of Step
        These steps.
    fails_at : float or None [mm]
        Largest gap at which some step is not; None if every tried gap works.
    failing : int
        That step, from 0; -1 if parts touch at rest.
    pair : tuple of names
        Two parts that collide there; empty if they touch at rest.
    """

    plan: Plan
    works_at: float
    works: tuple[Step, ...]
    fails_at: float | None
    failing: int
    pair: tuple[str, ...]


def sample_plan(
    plan: Plan, geometry: PlanGeometry, spread: Spread, draws: int, seed: int, context: Context
) -> PlanSample:
    """How often parts whose gaps vary go together along the paths of a plan; see `wiggleroom.sample_plan`.

    Raises
    ------
    InputError
        If there is no plan, or it was stopped before the first draw.
    """
    _check_plan(plan)
    names = geometry.assembly.names
    extra = spread.draw(draws, len(names), seed)
    found, failing = [], np.zeros(len(plan.steps) + 1, dtype=np.int64)
    for row in extra:
        if context.stopped:
            break
        made = geometry.made(inward={name: float(x) / 2 for name, x in zip(names, row, strict=True)})
        least, step = (0.0, -1) if made is None else _least(made, plan.steps)
        found.append(least)
        if least <= 0:
            failing[step] += 1
    if not found:
        raise InputError("sample of a plan: stopped before the first draw")
    return PlanSample(plan, spread, np.array(found), tuple(failing.tolist()))


def rank_plan(plan: Plan, geometry: PlanGeometry, context: Context) -> PlanRanking:
    """Which gap to enlarge so that a plan has more room: extra gap round one part after the other, paths fitted anew.

    Raises
    ------
    InputError
        If there is no plan.
    """
    _check_plan(plan)
    names = geometry.assembly.names
    least = min(step.clearance for step in plan.steps)
    extra = RANK_SHARE * max(least, 1e-3 * geometry.clearance)
    near = [step for step in plan.steps if step.clearance < least + 2 * extra]
    gain = np.zeros(len(names))
    for k, name in enumerate(names):
        made = None if context.stopped else geometry.made(inward={name: extra / 2})
        if made is None:
            continue
        value = min(made.measured(_alone(made, step)).clearance for step in near)
        gain[k] = max((value - least) / extra, 0.0)
    order = np.argsort(-gain, kind="stable")
    return PlanRanking(plan, tuple(names[k] for k in order), gain[order])


def smallest_gap(plan: Plan, geometry: PlanGeometry, context: Context) -> SmallestGap:
    """The smallest gap of the whole assembly at which a plan works, its paths fitted anew at every gap.

    Raises
    ------
    InputError
        If there is no plan, or the assembly has no gap of its own that could be made smaller.
    """
    _check_plan(plan)
    assembly = geometry.assembly
    if not assembly.gap > 0:
        finding = f"{assembly.drawing.source or 'the assembly'}: it has no gap that could be made smaller; give one, with --gap"
        raise InputError(finding)
    high, works = assembly.gap, plan.steps
    low: float | None = None
    why: tuple[int, tuple[str, ...]] = (-1, ())
    trial = high / 2
    while not context.stopped:
        steps, told = _at_gap(geometry, works, trial)
        if steps is None:
            low, why = trial, told
        else:
            high, works = trial, steps
        if low is None and high < MIN_GAP_SHARE * assembly.gap:
            break
        if low is not None and high - low <= GAP_TOLERANCE * high:
            break
        trial = high / 2 if low is None else (low + high) / 2
    return SmallestGap(plan, high, works, low, *why)


def _at_gap(
    geometry: PlanGeometry, steps: tuple[Step, ...], gap: float
) -> tuple[tuple[Step, ...] | None, tuple[int, tuple[str, ...]]]:
    """Steps fitted to another gap, or None and which of them does not go, because of which two parts."""
    made = geometry.made(gap=gap)
    if made is None:
        return None, (-1, ())
    fitted = made.fitted(steps)
    for k, step in enumerate(fitted):
        pair = made.collision(step)
        if pair is not None:
            return None, (k, pair)
    return tuple(made.measured(step) for step in fitted), (-1, ())


def _alone(geometry: PlanGeometry, step: Step) -> Step:
    """A step fitted to other outlines, its first waypoint as it is."""
    fitted = geometry.fitted([step])
    return fitted[0] if len(fitted) == 1 else step


def _least(geometry: PlanGeometry, steps: tuple[Step, ...]) -> tuple[float, int]:
    """Least clearance of steps as they are, and the step where it is; 0 where one of them is not free."""
    found = []
    for k, step in enumerate(steps):
        if geometry.collision(step) is not None:
            return 0.0, k
        found.append(geometry.measured(step).clearance)
    return min(found), int(np.argmin(found))


def _check_plan(plan: Plan) -> None:
    if not plan.steps:
        finding = (
            f"{plan.assembly.drawing.source or 'the assembly'}: there is no plan whose tolerances could be looked at"
        )
        raise InputError(finding)
