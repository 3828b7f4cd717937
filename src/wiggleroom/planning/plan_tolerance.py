"""Plans when gaps vary: the share of draws that go together, whose gap decides, and the smallest gap at which a plan works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.disassembly.interlock import with_ground
from wiggleroom.disassembly.remaining import only
from wiggleroom.displayable import Displayable
from wiggleroom.errors import InputError, Stop, TouchingError
from wiggleroom.planning.path_improvement import improved_steps
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import Step, measured
from wiggleroom.search.prepare import survey
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
    """What becomes of a plan when the gap round every part varies at random.

    Parameters
    ----------
    plan : Plan
    spread : Spread
    clearance : (d,) float64 [mm]
        Least clearance of every draw on the paths of the plan as they are; not above 0 where it does not go together.
    failing : tuple of int
        In how many draws each step, from the first, is the one that does not go; the last entry: where parts overlap at rest.
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
    """Whose gap decides how much room a plan has.

    Parameters
    ----------
    plan : Plan
    parts : tuple of names
        The most important first.
    gain : (n,) float64 [mm per mm]
        How much the least clearance of the plan, its paths fitted anew, grows per mm of extra gap round each of these parts.
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
        Smallest gap at which all steps, fitted anew, were found to be free.
    works : tuple of Step
        These steps.
    fails_at : float or None [mm]
        Largest gap at which some step was not; None where every gap that was tried works.
    failing : int
        That step, from 0; -1 where parts touch at rest.
    pair : tuple of names
        Two parts that collide there; empty where they touch at rest.
    """

    plan: Plan
    works_at: float
    works: tuple[Step, ...]
    fails_at: float | None
    failing: int
    pair: tuple[str, ...]


def sample_plan(plan: Plan, spread: Spread, *, draws: int = 200, seed: int = 0, stop: Stop | None = None) -> PlanSample:
    """How often parts whose gaps vary go together along the paths of a plan.

    Parameters
    ----------
    plan : Plan
    spread : Spread
        Of the extra gap round every part: its outline moves inward by half of it.
    draws, seed : int
    stop : optional
        Asked before every draw; then those so far are given.

    Raises
    ------
    InputError
        If there is no plan, or it was stopped before the first draw.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.plan(wr.patterns.chain(2, joint="finger", gap=0.05))
    >>> sample_plan(found, Spread(0.001), draws=5).share
    1.0
    """
    _check_plan(plan)
    assembly = with_ground(plan.assembly)
    extra = spread.draw(draws, len(assembly.parts), seed)
    found, failing = [], np.zeros(len(plan.steps) + 1, dtype=np.int64)
    for row in extra:
        if stop is not None and stop.is_set():
            break
        offset = {name: -float(x) / 2 for name, x in zip(assembly.names, row, strict=True)}
        made = _made(assembly, offset=offset)
        least, step = (0.0, -1) if made is None else _least(made, plan.steps)
        found.append(least)
        if least <= 0:
            failing[step] += 1
    if not found:
        raise InputError("sample of a plan: stopped before the first draw")
    return PlanSample(plan, spread, np.array(found), tuple(failing.tolist()))


def rank_plan(plan: Plan, *, stop: Stop | None = None) -> PlanRanking:
    """Which gap to enlarge so that a plan has more room: extra gap round one part after the other, paths fitted anew.

    Raises
    ------
    InputError
        If there is no plan.
    """
    _check_plan(plan)
    assembly = with_ground(plan.assembly)
    least = min(step.clearance for step in plan.steps)
    extra = RANK_SHARE * max(least, 1e-3 * survey(assembly).clearance)
    near = [step for step in plan.steps if step.clearance < least + 2 * extra]
    gain = np.zeros(len(assembly.parts))
    for k, name in enumerate(assembly.names):
        made = None if stop is not None and stop.is_set() else _made(assembly, offset={name: -extra / 2})
        if made is None:
            continue
        surveyed = survey(made)
        value = min(measured(made, surveyed, _alone(made, step)).clearance for step in near)
        gain[k] = max((value - least) / extra, 0.0)
    order = np.argsort(-gain, kind="stable")
    return PlanRanking(plan, tuple(assembly.names[k] for k in order), gain[order])


def smallest_gap(plan: Plan, *, stop: Stop | None = None) -> SmallestGap:
    """The smallest gap of the whole assembly at which a plan works, its paths fitted anew at every gap.

    Raises
    ------
    InputError
        If there is no plan, or the assembly has no gap of its own that could be made smaller.
    """
    _check_plan(plan)
    assembly = with_ground(plan.assembly)
    if not assembly.gap > 0:
        finding = f"{assembly.drawing.source or 'the assembly'}: it has no gap that could be made smaller; give one, with --gap"
        raise InputError(finding)
    high, works = assembly.gap, plan.steps
    low: float | None = None
    why: tuple[int, tuple[str, ...]] = (-1, ())
    trial = high / 2
    while not (stop is not None and stop.is_set()):
        steps, told = _at_gap(assembly, works, trial)
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
    assembly: Assembly, steps: tuple[Step, ...], gap: float
) -> tuple[tuple[Step, ...] | None, tuple[int, tuple[str, ...]]]:
    """Steps fitted to another gap, or None and which of them does not go, because of which two parts."""
    made = _made(assembly, gap=gap)
    if made is None:
        return None, (-1, ())
    surveyed = survey(made)
    fitted = improved_steps(made, surveyed, steps)
    for k, step in enumerate(fitted):
        there = np.flatnonzero(step.there)
        audit = audit_path(only(made, there), step.path[:, there])
        if not audit.free:
            first = audit.piece.argmin()
            return None, (k, (made.names[there[audit.a[first]]], made.names[there[audit.b[first]]]))
    return tuple(measured(made, surveyed, step) for step in fitted), (-1, ())


def _alone(assembly: Assembly, step: Step) -> Step:
    """A step fitted to other outlines, its first waypoint as it is."""
    fitted = improved_steps(assembly, survey(assembly), [step])
    return fitted[0] if len(fitted) == 1 else step


def _least(assembly: Assembly, steps: tuple[Step, ...]) -> tuple[float, int]:
    """Least clearance of steps as they are, and the step where it is; 0 where one of them is not free."""
    surveyed, found = survey(assembly), []
    for k, step in enumerate(steps):
        there = np.flatnonzero(step.there)
        if not audit_path(only(assembly, there), step.path[:, there]).free:
            return 0.0, k
        found.append(measured(assembly, surveyed, step).clearance)
    return min(found), int(np.argmin(found))


def _made(assembly: Assembly, **options: object) -> Assembly | None:
    """The assembly made otherwise; None where parts then touch at rest, or cannot be made."""
    make: Callable[..., Assembly] = assemble
    try:
        made = make(assembly.drawing, **options)
        survey(made)
    except (InputError, TouchingError):
        return None
    return made


def _check_plan(plan: Plan) -> None:
    if not plan.steps:
        finding = (
            f"{plan.assembly.drawing.source or 'the assembly'}: there is no plan whose tolerances could be looked at"
        )
        raise InputError(finding)
