"""Motion against gap, and the gap at which nothing stops the motion any more."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import question_findings
from wiggleroom.assembly.statements import given_goals
from wiggleroom.bound.prove import check_request
from wiggleroom.bound.prove import prove as prove_bound
from wiggleroom.displayable import Drawable
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import FreeSpaceError, InputError, Stop, StoppedError, TouchingError
from wiggleroom.sensitivity.found_motion import Found, MadeAssembly, is_checked, verdict_of
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.planar_study import PlanarStudy
from wiggleroom.solve.dual_linear_program import need_highs
from wiggleroom.verdict import Verdict

DEFAULT_GAPS = 9
"""Gaps of a sweep that names none: from a quarter of the assembly's gap to twice it."""
BRACKET_TOLERANCE = 1e-3
"""Relative tolerance of the gap from which on nothing stops the motion."""
BISECTION_SHARES = (0.5, 0.3, 0.7)
"""Where between two gaps the next one lies; the others where a search there was cut short."""


@dataclass(frozen=True, eq=False)
class SweepStep:
    """One gap of a sweep.

    Parameters
    ----------
    gap : float [mm]
    objective : float or None
        None where nothing stops the motion, or where the parts cannot be made or touch.
    verdict : Verdict
    checked : bool
        True where the path from rest was checked, at this gap.
    answer : Answer, SpatialAnswer or None
        What was found there, its path from rest through the ends at smaller gaps; None where there is no such motion.
    at_most : float or None
        A value that no motion exceeds, at this gap or a smaller one; None where none was asked for or proven.
    """

    gap: float
    objective: float | None
    verdict: Verdict
    checked: bool
    answer: Any = field(default=None, repr=False)
    at_most: float | None = None


@dataclass(frozen=True, eq=False)
class Sweep(Drawable):
    """Motion against gap.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    goals : tuple of Pull, Turn or W, or of SpatialPull, SpatialTurn or Weight
    steps : tuple of SweepStep
        Gaps in order of size.
    lost : (float, float) or None [mm]
        At the first gap a search found an end of the motion, at the second nothing stops it, along a path that was checked; None where
        no gap of the sweep is so large. A search may miss a narrow way out, so the first is no proof.
    """

    assembly: Any
    goals: tuple[Any, ...]
    steps: tuple[SweepStep, ...]
    lost: tuple[float, float] | None


def sweep(
    assembly: Assembly,
    gaps: Sequence[float] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    prove: float | None = None,
    seconds: float = 60.0,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, NDArray[np.float64] | None], None] | None = None,
) -> Sweep:
    """Largest motion for several gaps, and the gap from which on nothing stops it.

    Each gap begins with the motion of the gap before, which is free of overlap there too, because every part has become
    smaller: so the curve never falls, and a path that was checked stays checked. The first gap, the largest at which parts
    can be made, and the drawing's own are searched as a direct question is: the way out may begin elsewhere than where the
    motion ends. Where there is one, the smallest gap that has it is searched for as well.

    Parameters
    ----------
    assembly : Assembly
    gaps : sequence of float, optional [mm]
        In place of the drawing's gap, in any order; by default nine from a quarter of it to twice it.
    goals : Pull, Turn or W, or several that add up
        By default what the assembly's file asks for.
    prove : float, optional
        Prove a bound for every gap, at most this share above the motion, and so a band round the whole curve.
    seconds : float
        The longest that the proof of one gap may take; then the best bound so far is given.
    stop, progress : optional
        Asked between gaps and within; told how many gaps are done, and how many there are. Proofs count once more.
    each : callable, optional
        Told every gap's step when it is found, and the motion of the parts there (n, 3) [mm, mm, rad], None where the
        motion does not end. Where the motion loses its end is found last, and may make larger gaps unbounded.

    Raises
    ------
    InputError
        If a gap makes no sense, nothing is fixed or pulled, or what is asked has no bound.
    MissingExtraError
        If `prove` needs the extra of that name.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.sweep(wr.patterns.chain(2, joint="tee"), [0.01, 0.02])
    >>> [round(step.objective, 4) for step in found.steps]
    [0.0261, 0.0539]
    """
    if prove is not None:
        check_request(prove, seconds)
        need_highs()
    asked = given_goals(goals, assembly.goals)
    wrong = list(question_findings(replace(assembly.drawing, goals=asked)))

    def told(done: int, total: int) -> None:
        if progress is not None:
            progress(done, total if prove is None else 2 * total)

    found = sweep_over(PlanarStudy(assembly, asked), gaps, wrong, stop=stop, progress=told, each=each)
    return found if prove is None else _with_band(found, prove, seconds, stop, progress)


def _with_band(
    found: Sweep, within: float, seconds: float, stop: Stop | None, progress: Callable[[int, int], None] | None
) -> Sweep:
    """The sweep with a bound at every gap; that of a larger gap, whose parts are smaller, holds as well."""
    steps, least, count = list(found.steps), np.inf, len(found.steps)
    for k in reversed(range(count)):
        step = steps[k]
        if step.answer is not None and step.objective is not None and not (stop is not None and stop.is_set()):
            done = prove_bound(step.answer, within, seconds=seconds, stop=stop)
            least = min(least, np.inf if done.at_most is None else done.at_most)
            step = replace(step, answer=done, verdict=done.verdict)
        if step.objective is not None and np.isfinite(least):
            step = replace(step, at_most=float(least))
        steps[k] = step
        if progress is not None:
            progress(2 * count - k, 2 * count)
    return replace(found, steps=tuple(steps))


@dataclass(frozen=True, eq=False)
class _Held(Generic[Found]):
    """What the next larger gap starts from: an answer that ends, and what it was asked of."""

    gap: float
    study: GapStudy[Found]
    answer: Found


def sweep_over(
    study: GapStudy[Found],
    gaps: Sequence[float] | None,
    wrong: list[str],
    *,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, NDArray[np.float64] | None], None] | None = None,
) -> Sweep:
    """The sweep of any assembly; `wrong` holds what is wrong with the question.

    Raises
    ------
    InputError
        If anything is wrong.
    """
    sizes = _gaps(study.assembly, gaps, wrong)
    if wrong:
        raise InputError(wrong)
    steps: list[SweepStep] = []
    state: _Held[Found] | None = None
    ends: dict[float, _Held[Found]] = {}
    searched = (sizes[0], _largest_made(study, sizes), study.assembly.gap) if study.goes_on else sizes
    for gap in sizes:
        if stop is not None and stop.is_set():
            break
        if any(s.verdict == Verdict.UNBOUNDED for s in steps):  # smaller parts leave by the same path
            steps.append(_looser(study, steps[-1], gap))
            continue
        step, state = _step(study, gap, state, stop, search=gap in searched)
        if step.verdict == Verdict.STOPPED and stop is not None and stop.is_set():
            break  # a gap that was not finished says nothing about the curve
        if state is not None and state.gap == gap:
            ends[gap] = state
        step = _not_lower(study, step, steps)
        steps.append(step)
        if each is not None:
            each(step, state.answer.motion if state is not None and state.gap == gap else None)
        if progress is not None:
            progress(len(steps), len(sizes))
    steps = _freed_sooner(study, steps, ends, searched, stop)
    free = next((s.gap for s in steps if s.verdict == Verdict.UNBOUNDED), None)
    held = None if free is None else _nearest_below(ends, free)
    lost = None
    if free is not None and held is not None:
        lost = _lost(study, held, free, stop)
        least = lost[1]
        kept = Verdict.UNBOUNDED, Verdict.NOT_MAKEABLE
        steps = [s if s.gap < least or s.verdict in kept else _beyond(s.gap) for s in steps]
    return Sweep(study.assembly, study.goals, tuple(steps), lost)


def _gaps(assembly: MadeAssembly, gaps: Sequence[float] | None, wrong: list[str]) -> list[float]:
    """Gaps in order; what is wrong with them is added to the list."""
    if gaps is None:
        if assembly.gap <= 0:
            wrong.append("sweep: the drawing has no gap to start from: name the gaps")
        return np.linspace(assembly.gap / 4, 2 * assembly.gap, DEFAULT_GAPS).tolist()
    asked = set(gaps)
    odd = {g for g in asked if not 0 <= g < np.inf}
    wrong += [f"sweep: gap {g:g}: it must be 0 or more" for g in sorted(odd)]
    if not asked:
        wrong.append("sweep: name at least one gap")
    return sorted(float(g) for g in asked - odd)


def _largest_made(study: GapStudy[Found], sizes: Sequence[float]) -> float:
    """The largest of some gaps, in order, at which the parts can be made; the smallest where there is none."""
    for gap in reversed(sizes):
        try:
            study.at_gap(gap)
        except InputError:
            continue
        return gap
    return sizes[0]


def _step(
    study: GapStudy[Found], gap: float, last: _Held[Found] | None, stop: Stop | None, *, search: bool = False
) -> tuple[SweepStep, _Held[Found] | None]:
    """One gap, from the answer of a smaller one where there is one, and searched as well; and what the next gap may start from."""
    try:
        made = study.at_gap(gap)
    except InputError as why:
        return SweepStep(gap, None, verdict_of(why), False), last
    try:
        smaller = None if last is None else (last.study, last.answer)
        made, answer = made.answer_onward(smaller, search, stop)
    except (StoppedError, FreeSpaceError, TouchingError) as why:
        return SweepStep(gap, None, verdict_of(why), False), None if isinstance(why, TouchingError) else last
    checked = is_checked(answer)
    step = SweepStep(gap, answer.objective, answer.verdict, checked, replace(answer, warm_start=None))
    good = answer.verdict.ends and checked and study.can_be_ranked(answer)
    return step, _Held(gap, made, answer) if good else last


def _not_lower(study: GapStudy[Found], step: SweepStep, smaller: Sequence[SweepStep]) -> SweepStep:
    """The step, or where it is lower than a checked one of a smaller gap whose search was cut short, that motion: it is free here too."""
    known = [s for s in smaller if s.checked and s.objective is not None and s.answer is not None]
    best = max(known, key=lambda s: s.objective or 0.0, default=None)
    if best is None or step.objective is None or step.objective >= (best.objective or 0.0):
        return step
    answer = study.at_gap(step.gap).in_place_of(step.answer, best.answer)
    return SweepStep(step.gap, best.objective, answer.verdict, True, answer)


def _freed_sooner(
    study: GapStudy[Found],
    steps: list[SweepStep],
    ends: dict[float, _Held[Found]],
    searched: Sequence[float],
    stop: Stop | None,
) -> list[SweepStep]:
    """The steps, searched by halving below the first at which nothing stops the motion; `ends` are brought up to date.

    Smaller gaps went on from each other: what leaves by another way shows at none of them.
    """
    verdicts = [s.verdict for s in steps]
    if Verdict.UNBOUNDED not in verdicts:
        return steps
    free = verdicts.index(Verdict.UNBOUNDED)
    low = max((k for k in range(free) if steps[k].gap in searched), default=-1)
    while free - low > 1 and not (stop is not None and stop.is_set()):
        k = (low + free) // 2
        gap = steps[k].gap
        step, state = _step(study, gap, _nearest_below(ends, gap), stop, search=True)
        if step.verdict == Verdict.UNBOUNDED:
            free, steps = k, [*steps[:k], step, *(_looser(study, step, s.gap) for s in steps[k + 1 :])]
            continue
        if stop is not None and stop.is_set():
            break  # a search that was not finished says nothing
        low, steps = k, [*steps[:k], _not_lower(study, step, steps[:k]), *steps[k + 1 :]]
        if state is not None and state.gap == gap:
            ends[gap] = state
    return steps


def _nearest_below(ends: dict[float, _Held[Found]], gap: float) -> _Held[Found] | None:
    """What the largest gap below one ended with; None where there is none."""
    return ends.get(max((g for g in ends if g < gap), default=-1.0))


def _beyond(gap: float) -> SweepStep:
    """A gap beyond that at which the motion loses its end, where no escape path was found from the smaller gaps."""
    return SweepStep(gap, None, Verdict.UNBOUNDED, True)


def _looser(study: GapStudy[Found], step: SweepStep, gap: float) -> SweepStep:
    """The step of a gap at which parts leave by the path of a smaller gap, where they can be made."""
    try:
        made = study.at_gap(gap)
    except InputError as why:
        return SweepStep(gap, None, verdict_of(why), False)
    return replace(step, gap=gap, answer=step.answer and made.with_assembly(step.answer))


def _lost(study: GapStudy[Found], held: _Held[Found], free: float, stop: Stop | None) -> tuple[float, float]:
    """Between which gaps the motion loses its end, by halving."""
    low, tries = held.gap, list(BISECTION_SHARES)
    while free - low > BRACKET_TOLERANCE * free and tries and not (stop is not None and stop.is_set()):
        gap = low + tries[0] * (free - low)
        step, state = _step(study, gap, held, stop)
        if step.objective is not None and study.goes_on:  # a narrow escape path may show from rest and not from there
            anew, _ = _step(study, gap, None, stop)
            step = anew if anew.verdict == Verdict.UNBOUNDED else step
        if step.verdict == Verdict.UNBOUNDED:
            free, tries = gap, list(BISECTION_SHARES)
        elif stop is not None and stop.is_set():
            break  # a search that was not finished says nothing
        elif state is not None and state.gap == gap:
            low, held, tries = gap, state, list(BISECTION_SHARES)
        else:
            tries.pop(0)  # undecided: beside it, perhaps
    return low, free
