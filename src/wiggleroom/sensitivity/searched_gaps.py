"""Largest motions at several gaps, and the gap at which they pass a limit.

Parts only get smaller as the gap grows. So a motion that is free at one gap is free at every larger one: what was found there counts
here too, and a path that is found at a large gap is followed to smaller ones, as far as exact geometry says that it is free.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Generic

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import FreeSpaceError, InputError, StoppedError, TouchingError
from wiggleroom.sensitivity.found_motion import Found, is_checked, verdict_of
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.gap_trials import CLIMBED, Trial
from wiggleroom.verdict import Verdict

RELATIVE_TOLERANCE = 1e-3
"""Both sides of a border end no further apart than this share of the gap: finer than any cutter."""
MAX_WIDENINGS = 4
"""A path is moved away from other parts at most so many times while it is followed to smaller gaps."""
JUMP = 0.01
"""Only a motion that lies beyond the limit by this share is followed: one that is nearer ends at a contact."""
BISECTION_SHARES = (0.5, 0.3, 0.7)
"""Where between two gaps the next one lies; the others where a search there was cut short."""


class SearchedGaps(Generic[Found]):
    """Trials at several gaps, each searched as a direct question is.

    Parameters
    ----------
    study : GapStudy
    limit : float [mm]
        Motions beyond it fail; infinite: those that nothing stops.
    context : Context
        Asked and told within every trial.
    searching : bool
        False: trials are climbs from rest, which are quick, until it is set.
    """

    def __init__(
        self, study: GapStudy[Found], limit: float = math.inf, context: Context = UNLIMITED, *, searching: bool = True
    ) -> None:
        self.study, self.limit = study, limit
        self.context = context
        self.searching = searching
        self.trials: dict[float, Trial] = {}

    @property
    def stopped(self) -> bool:
        """True where it was asked to stop."""
        return self.context.stopped

    def keeps(self, trial: Trial) -> bool:
        """True where a search that came to its end found no motion beyond the limit."""
        return trial.value is not None and trial.value <= self.limit and trial.value < math.inf and trial.ended

    def fails(self, trial: Trial) -> bool:
        """True where a motion beyond the limit was found and checked."""
        return trial.value is not None and (trial.value > self.limit or trial.value == math.inf) and trial.checked

    def at(self, gap: float) -> Trial:
        """What is found at a gap: never less than at a smaller one."""
        if gap not in self.trials:
            self.trials[gap] = self._tried(gap, self.searching)
        return self.trials[gap]

    def search(self) -> None:
        """From here on trials are searched; climbs are forgotten, but those that fail, which are certain."""
        self.searching = True
        self.trials = {gap: t for gap, t in self.trials.items() if t.verdict != CLIMBED or self.fails(t)}

    def _tried(self, gap: float, search: bool) -> Trial:
        try:
            made = self.study.at_gap(gap, self.context.stop)
        except (InputError, StoppedError) as why:
            return Trial(gap, None, verdict_of(why), False)
        smaller = [t for t in self.trials.values() if t.gap < gap and t.checked and t.value is not None]
        best = max(smaller, key=lambda t: t.value or 0.0, default=None)
        if best is not None and best.value == math.inf:  # parts leave by the same path
            return replace(best, gap=gap, answer=best.answer and made.with_assembly(best.answer))
        try:
            answer = made.flexed(None if search else 0, self.context)
        except (StoppedError, FreeSpaceError, TouchingError) as why:
            return Trial(gap, None, verdict_of(why), False)
        value = math.inf if answer.objective is None else answer.objective
        verdict = str(answer.verdict) if search or answer.verdict is Verdict.UNBOUNDED else CLIMBED
        ended = answer.verdict.ends or answer.objective is None
        trial = Trial(gap, value, verdict, is_checked(answer), answer.at_most, answer, ended)
        if best is not None and best.value is not None and best.value > value:
            # what bounds motions at the smaller gap says nothing of those here
            carried = made.in_place_of(answer, best.answer)
            return replace(trial, value=best.value, checked=True, answer=carried, verdict=str(carried.verdict))
        return trial

    def narrow(self, low: float, high: float) -> tuple[float, float]:
        """Enclose the border between a gap that keeps the limit and one that fails to `RELATIVE_TOLERANCE`.

        The path that fails is followed down first, and the next trial lies just below. Where the border is no end of that path: secant
        steps from either side in turn, and halving where these are slow.
        """
        side, halve, tries = 1.0, False, list(BISECTION_SHARES)
        high, jumped = self._followed_down(low, high)
        while high - low > RELATIVE_TOLERANCE * high and tries and not self.stopped:
            wide = high - low
            gap = low + tries[0] * wide
            below, above = self.trials[low].value, self._end_above(high)
            if jumped:
                gap = max(gap, (1 - 0.99 * RELATIVE_TOLERANCE) * high)
            elif not halve and len(tries) == len(BISECTION_SHARES) and below is not None and above is not None:
                chord = low + (above[0] - low) * (self.limit - below) / (above[1] - below)
                aside = side * 0.3 * RELATIVE_TOLERANCE * high
                gap = min(max(chord + aside, low + 0.02 * wide), high - 0.02 * wide)
            trial = self.at(gap)
            if self.fails(trial):
                before, was = high, jumped
                high, jumped = self._followed_down(low, gap)
                jumped = jumped and not (was and before - high < 0.5 * wide)
                side = -1.0
            elif self.keeps(trial):
                low, side, jumped = gap, 1.0, False
            else:
                tries.pop(0)  # undecided: beside it, perhaps
                jumped = False
                continue
            tries = list(BISECTION_SHARES)
            halve = high - low > 0.5 * wide
        return low, high

    def _end_above(self, high: float) -> tuple[float, float] | None:
        """Nearest gap from `high` on whose motion ends beyond the limit, and its value; None where it is endless there."""
        ends = [t for t in self.trials.values() if t.gap >= high and self.fails(t) and t.ended]
        nearest = min(ends, key=lambda t: t.gap, default=None)
        if nearest is None or nearest.value is None or nearest.value == math.inf:
            return None
        return nearest.gap, nearest.value

    def _followed_down(self, low: float, high: float) -> tuple[float, bool]:
        """Least gap above `low` at which the path by which `high` fails is free, and whether that lies below `high`.

        The path is moved away from other parts, followed, and moved again where it got to.
        """
        begin = high
        for _ in range(MAX_WIDENINGS if self.searching else 0):  # a climb costs no more than this
            answer, value = self.trials[high].answer, self.trials[high].value
            if answer is None or value is None or value < (1 + JUMP) * self.limit < math.inf or self.stopped:
                break
            answer = self.study.at_gap(high).with_room(answer, self.limit, self.context)
            good, bad = (1 - RELATIVE_TOLERANCE) * high, low
            if not self._follows(answer, good):  # a contact ends it
                break
            while good - bad > 0.5 * RELATIVE_TOLERANCE * good and not self.stopped:
                gap = (bad + good) / 2
                bad, good = (bad, gap) if self._follows(answer, gap) else (gap, good)
            high = good
        return high, high < begin

    def _follows(self, answer: Found, gap: float) -> bool:
        """True where the path of a larger gap is free here too until the motion is beyond the limit."""
        try:
            found = self.study.at_gap(gap).followed(answer, self.limit)
        except InputError:
            return False
        if found is not None:
            value = math.inf if found.objective is None else found.objective
            self.trials[gap] = Trial(gap, value, str(found.verdict), True, None, found)
        return found is not None
