"""Motion against gap, and the gap at which nothing stops the motion any more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.findings import question_findings
from wiggleroom.bound.prove import check_request
from wiggleroom.bound.prove import prove as prove_bound
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError
from wiggleroom.sensitivity.counted_bound import counted_bound
from wiggleroom.sensitivity.found_motion import Found, MadeAssembly
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.gap_trials import Trial
from wiggleroom.sensitivity.searched_gaps import SearchedGaps
from wiggleroom.solve.dual_linear_program import need_highs
from wiggleroom.verdict import Verdict

PROOF_WORK = 60_000.0
"""Work of the proof of one gap, about milliseconds."""
DEFAULT_GAPS = 9
"""Gaps of a sweep that names none: from a quarter of the assembly's gap to twice it."""


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
    answer : Answer or None
        What was found there; where a smaller gap has shown more, that motion. None where there is no such motion.
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
    assembly : Assembly
    goals : tuple of Pull, Turn or W, or of Pull, Turn or Weight
    steps : tuple of SweepStep
        Gaps in order of size.
    lost : (float, float) or None [mm]
        At the first gap a search found an end of the motion; at the second a checked path is unbounded. None if no gap of the sweep is so
        large. A search may miss a narrow way out, so the first is no proof.
    stopped : bool
        True if stopped before all of that was known.
    """

    assembly: Any
    goals: tuple[Any, ...]
    steps: tuple[SweepStep, ...]
    lost: tuple[float, float] | None
    stopped: bool = False


def sweep(
    study: GapStudy[Found],
    gaps: Sequence[float] | None,
    *,
    prove: float | None = None,
    seconds: float | None = None,
    each: Callable[[SweepStep, NDArray[np.float64] | None], None] | None = None,
    context: Context = UNLIMITED,
) -> Sweep:
    """Largest motion of what is asked about for several gaps; see `wiggleroom.sweep`."""
    if prove is not None:
        check_request(prove, seconds)
        need_highs()
    wrong = list(question_findings(replace(study.assembly.drawing, goals=study.goals)))
    sizes = _gaps(study.assembly, gaps, wrong)
    if wrong:
        raise InputError(wrong)
    total = len(sizes) if prove is None else 2 * len(sizes)
    tried, steps = SearchedGaps(study, context=context.silent), []
    for gap in sizes:
        if tried.stopped:
            break
        trial = tried.at(gap)
        if trial.verdict == Verdict.STOPPED and tried.stopped:
            break  # a gap that was not finished says nothing about the curve
        steps.append(_step(trial))
        if each is not None:
            each(steps[-1], None if steps[-1].objective is None else trial.answer.motion)
        if context.counted is not None:
            context.counted(len(steps), total)
    done = [tried.trials[step.gap] for step in steps]
    free = next((t.gap for t in done if tried.fails(t)), None)
    held = max((t.gap for t in done if tried.keeps(t) and t.checked), default=None)
    lost = None if free is None or held is None else tried.narrow(held, free)
    found = Sweep(study.assembly, study.goals, tuple(steps), lost)
    return found if prove is None else _with_band(found, prove, seconds, context)


def _with_band(found: Sweep, within: float, seconds: float | None, context: Context) -> Sweep:
    """The sweep with a bound at every gap; that of a larger gap, whose parts are smaller, holds as well."""
    steps, least, count = list(found.steps), np.inf, len(found.steps)
    for k in reversed(range(count)):
        step = steps[k]
        if step.answer is not None and step.objective is not None and not context.stopped:
            done = (
                counted_bound(step.answer, within, work=PROOF_WORK, context=context.silent)
                if seconds is None
                else prove_bound(step.answer, within, seconds=seconds, context=context.silent)
            )
            least = min(least, np.inf if done.at_most is None else done.at_most)
            step = replace(step, answer=done, verdict=done.verdict)
        if step.objective is not None and np.isfinite(least):
            step = replace(step, at_most=float(least))
        steps[k] = step
        if context.counted is not None:
            context.counted(2 * count - k, 2 * count)
    return replace(found, steps=tuple(steps))


def _step(trial: Trial) -> SweepStep:
    """The step of a trial."""
    value = None if trial.value is None or trial.value == math.inf else trial.value
    answer = trial.answer and replace(trial.answer, warm_start=None)
    return SweepStep(trial.gap, value, Verdict(trial.verdict), trial.checked, answer)


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
