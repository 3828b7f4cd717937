"""The largest gap at which a motion stays below a limit: bracketed by trials, then proven from below."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Generic

from wiggleroom.deadline import Deadline
from wiggleroom.errors import FreeSpaceError, InputError, StoppedError, TouchingError
from wiggleroom.search.progress import Progress
from wiggleroom.sensitivity.found_motion import Found, is_checked, verdict_of
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.gap_trials import AllowableGap, Trial
from wiggleroom.verdict import Certainty, Verdict


@dataclass(frozen=True)
class GapSearchSettings:
    """Parameters of the bracketing and of the proofs.

    Parameters
    ----------
    relative_tolerance : float in (0, 1)
        Both sides end no further apart than this share of the gap: finer than any cutter.
    geometric_tolerance : float in (0, 1)
        The same where nothing but geometry is asked, which costs little.
    max_proof_distance : float in (0, 1)
        A proven gap is the answer where it lies no further than this share below a gap that fails.
    min_gap_share : float in (0, 1)
        No gap below this share of the drawing's size is tried.
    first_gap_share : float in (0, 1)
        Where the drawing gives no gap, the search begins at this share of its size.
    proof_seconds : float > 0 [s]
        Time that proofs may take where no time was given.
    proof_steps : tuple of float in (0, 1)
        Shares below the border at which a proof is tried, one after the other: near ones say more, far ones are easier.
    min_proof_share : float in (0, 1)
        No proof is tried that would have to come nearer to the motion than this share of it.
    """

    relative_tolerance: float = 1e-3
    geometric_tolerance: float = 1e-6
    max_proof_distance: float = 1e-2
    min_gap_share: float = 1e-5
    first_gap_share: float = 1e-2
    proof_seconds: float = 10.0
    proof_steps: tuple[float, ...] = (0.004, 0.02, 0.08, 0.3)
    min_proof_share: float = 2e-3


SETTINGS = GapSearchSettings()


class TrialStart(Enum):
    """Where trials begin."""

    REST = auto()
    SMALLER_GAP = auto()
    SEARCH = auto()


class MotionBorder(Generic[Found]):
    """Encloses the gap at which the largest motion reaches a limit."""

    def __init__(
        self,
        study: GapStudy[Found],
        limit: float,
        deadline: Deadline,
        progress: Callable[[Progress], None] | None,
    ) -> None:
        self.study, self.limit = study, limit
        self.assembly, self.goals = study.assembly, study.goals
        self.deadline, self.progress = deadline, progress
        self.trials: dict[float, Trial] = {}
        self.ends: dict[float, tuple[GapStudy[Found], Found]] = {}  # from which larger gaps go on
        self.searched: set[float] = set()
        self.begin = TrialStart.REST
        self.unconfirmed = False

    def enclose(self) -> AllowableGap:
        """Bracket the border by growing and halving, have it confirmed, then look for a proof on its lower side.

        Trials climb from rest. Where a search at the answer finds more than that, they go on from the end at the next smaller gap that was
        searched; where that misses something too, every gap is searched.
        """
        low, high, why = self._bracket()
        for begin in (TrialStart.SMALLER_GAP, TrialStart.SEARCH):
            if low is None or self._confirmed(low):
                break
            self.begin = begin
            self.trials = {gap: t for gap, t in self.trials.items() if gap in self.searched or self._fails(t)}
            self.ends = {gap: end for gap, end in self.ends.items() if gap in self.searched}
            low, high, why = self._bracket()
        if low is None:
            return self._answer(None, why)
        return self._answer(low, why, high, self._proven(low))

    def _bracket(self) -> tuple[float | None, float | None, str]:
        """A gap that keeps the limit and one that does not, near each other; what is None was not found, and the words say why."""
        size = self.assembly.size
        low = self._below(size)
        if low is None:
            return None, None, self._least_trial_words()
        high, why = self._above(low, size)
        low = max(t.gap for t in self.trials.values() if self._keeps(t) and (high is None or t.gap < high))
        if high is not None:
            low, high = self._narrow(low, high)
        return low, high, why

    def _below(self, size: float) -> float | None:
        """A gap at which the motion stays below the limit; None where none was found."""
        gap = begin = self.assembly.gap or SETTINGS.first_gap_share * size
        while gap > SETTINGS.min_gap_share * size and not self.deadline.is_set():
            trial = self._at(gap)
            if self._keeps(trial):
                return gap
            if trial.verdict == Verdict.TOUCHING:
                break
            value = trial.value
            gap *= 0.95 * self.limit / value if gap == begin and value and value < math.inf else 0.5
        if self._keeps(self._at(0.0)):
            return 0.0
        return None

    def _above(self, low: float, size: float) -> tuple[float | None, str]:
        """A gap at which a larger motion was found, or None and why there is none."""
        known = [t.gap for t in self.trials.values() if t.gap > low and self._fails(t)]
        if known:
            return min(known), ""
        gap, made, step = low or SETTINGS.first_gap_share * size, low, 0.0
        while not self.deadline.is_set():
            value = self.trials[low].value
            share = min(max(1.02 * self.limit / value - 1, 0.02), 3.0) if value else 1.0
            step = 2 * step or gap * share
            gap += step
            trial = self._at(gap)
            if self._fails(trial):
                return gap, ""
            if self._keeps(trial):
                made = low = gap
            elif trial.verdict == Verdict.NOT_MAKEABLE:
                return self._thinnest(made, gap)
            elif trial.verdict != Verdict.STOPPED and gap > 4 * size:
                break
        return None, "no gap was found at which it moves further"

    def _thinnest(self, made: float, gone: float) -> tuple[float | None, str]:
        """The border lies below the gap at which parts vanish; or no gap at which the parts can be made moves further."""
        while gone - made > SETTINGS.relative_tolerance * gone and not self.deadline.is_set():
            gap = (made + gone) / 2
            trial = self._at(gap)
            if self._fails(trial):
                return gap, ""
            made, gone = (made, gap) if trial.verdict == Verdict.NOT_MAKEABLE else (gap, gone)
        return None, f"at a gap of {gone:.6g} mm parts fall to pieces before the motion gets further"

    def _narrow(self, low: float, high: float) -> tuple[float, float]:
        """Enclose the border to `relative_tolerance`: secant steps from either side in turn, and halving where they are slow."""
        side, halve, high = 1.0, False, self._followed_down(low, high)
        low = max((t.gap for t in self.trials.values() if self._keeps(t) and t.gap < high), default=low)
        while high - low > SETTINGS.relative_tolerance * high and not self.deadline.is_set():
            wide = high - low
            gap = (low + high) / 2
            below, above = self.trials[low].value, self._end_above(high)
            if not halve and below is not None and above is not None and below < self.limit:
                chord = low + (above[0] - low) * (self.limit - below) / (above[1] - below)
                gap = min(
                    max(chord + side * 0.3 * SETTINGS.relative_tolerance * high, low + 0.02 * wide), high - 0.02 * wide
                )
            trial = self._at(gap)
            if self._fails(trial):
                high, side = self._followed_down(low, gap), -1.0
            elif self._keeps(trial):
                low, side = gap, 1.0
            else:
                break
            halve = high - low > 0.5 * wide
        return low, high

    def _end_above(self, high: float) -> tuple[float, float] | None:
        """Nearest gap from `high` on whose motion ends beyond the limit, and its value; None where it is endless there."""
        ends = [t for t in self.trials.values() if t.gap >= high and self._fails(t) and t.verdict != Verdict.STOPPED]
        nearest = min(ends, key=lambda t: t.gap, default=None)
        if nearest is None or nearest.value is None or nearest.value == math.inf:
            return None
        return nearest.gap, nearest.value

    def _followed_down(self, low: float, high: float) -> float:
        """Least gap above `low` at which the path by which `high` fails is free: far below it where the curve jumps."""
        answer, tolerance = self.trials[high].answer, SETTINGS.relative_tolerance
        if self.begin is TrialStart.REST:  # a climb costs little more than the check of a path
            return high
        if answer is None or not self._follows(answer, (1 - tolerance) * high):  # else a contact ends it
            return high
        high *= 1 - tolerance
        while high - low > tolerance * high and not self.deadline.is_set():
            gap = (low + high) / 2
            low, high = (low, gap) if self._follows(answer, gap) else (gap, high)
        return high

    def _follows(self, answer: Found, gap: float) -> bool:
        """True where the path of a larger gap is free here too until the motion is beyond the limit."""
        try:
            found = self.study.at_gap(gap).followed(answer, self.limit)
        except InputError:
            return False
        if found is not None:
            self.trials[gap] = Trial(gap, found.objective, found.verdict, True, None, found)
        return found is not None

    def _confirmed(self, low: float) -> bool:
        """False where a global search at the answer, which not all trials make, finds a larger motion."""
        known = low in self.searched
        if known or self.deadline.is_set():
            self.unconfirmed = not known
            return True
        self.trials[low] = self._solved(low, TrialStart.SEARCH)
        self.unconfirmed = self.trials[low].verdict == Verdict.STOPPED
        return not self._fails(self.trials[low])

    def _proven(self, low: float) -> float | None:
        """Largest gap at which no motion above the limit is possible, by a bound."""
        left = min(self.deadline.left, SETTINGS.proof_seconds)
        if left <= 0:
            return None
        limit = Deadline(left, self.deadline)
        for share in (0.0, *SETTINGS.proof_steps):
            gap = low * (1 - share)
            trial = self._at(gap)
            if trial.at_most is not None and trial.at_most <= self.limit:
                return gap
            found = None if trial.answer is None else trial.answer.objective
            within = self.limit / found - 1 if found else 0.0
            left = limit.left
            if within >= SETTINGS.min_proof_share and left > 0 and not limit.is_set():
                most = self.study.bound(trial.answer, min(0.9 * within, 9.0), left / 2, limit, self.progress)
                if most is not None and most <= self.limit:
                    self.trials[gap] = Trial(gap, trial.value, trial.verdict, trial.checked, most, trial.answer)
                    return gap
            if limit.is_set():
                return None
        return None

    def _at(self, gap: float) -> Trial:
        """What is found at a gap; at a larger gap never less than at a smaller one."""
        if gap not in self.trials:
            self.trials[gap] = self._solved(gap, self.begin)
        return self.trials[gap]

    def _solved(self, gap: float, begin: TrialStart) -> Trial:
        try:
            made = self.study.at_gap(gap)
        except InputError as why:
            return Trial(gap, None, verdict_of(why), False)
        try:
            made, answer = self._flexed(made, gap, begin)
        except (StoppedError, FreeSpaceError, TouchingError) as why:
            return Trial(gap, None, verdict_of(why), False)
        if answer.verdict.ends and is_checked(answer) and made.can_be_ranked(answer):
            self.ends[gap] = made, answer
        value = math.inf if answer.objective is None else answer.objective
        trial = Trial(gap, value, answer.verdict, is_checked(answer), answer.at_most, answer)
        smaller = [t for t in self.trials.values() if t.gap < gap and t.checked and t.value is not None]
        best = max(smaller, key=lambda t: t.value or 0.0, default=None)
        if best is not None and best.value is not None and best.value > value:
            # the same motion is free here too, where every part is smaller; but what bounds motions there says nothing of those here
            return replace(trial, value=best.value, checked=True)
        return trial

    def _flexed(self, made: GapStudy[Found], gap: float, begin: TrialStart) -> tuple[GapStudy[Found], Found]:
        """The largest motion at a gap, and what it was asked of."""
        if begin is TrialStart.REST:
            return made, made.flexed(0, self.deadline, self.progress)
        smaller = max((g for g in self.ends if g < gap), default=None)
        if begin is TrialStart.SMALLER_GAP and smaller is not None:
            return made.answer_onward(self.ends[smaller], False, self.deadline)
        self.searched.add(gap)
        return made, made.flexed(None, self.deadline, self.progress)

    def _keeps(self, trial: Trial) -> bool:
        """No motion beyond the limit was found by a search that came to its end."""
        return trial.value is not None and trial.value <= self.limit and trial.verdict != Verdict.STOPPED

    def _fails(self, trial: Trial) -> bool:
        """A motion beyond the limit was found and checked."""
        return trial.value is not None and trial.value > self.limit and trial.checked

    def _least_trial_words(self) -> str:
        """Why no gap keeps the limit."""
        done = sorted((t for t in self.trials.values() if t.value is not None), key=lambda t: t.gap)
        if self.deadline.is_set():
            return "stopped before a gap was found that keeps the limit"
        if not done:
            return "the parts leave no room at any gap that was tried"
        least = done[0]
        moves = "nothing stops it" if least.value == math.inf else f"it moves {least.value:.6g}"
        return f"no gap keeps the limit: at a gap of {least.gap:.6g} mm {moves}"

    def _answer(
        self, low: float | None, why: str, high: float | None = None, proven: float | None = None
    ) -> AllowableGap:
        failing = [t.gap for t in self.trials.values() if self._fails(t)]
        beyond = high if high is not None else min(failing, default=None)
        searched = low
        near = proven is not None and proven >= (1 - SETTINGS.max_proof_distance) * (beyond or low or 0.0)
        cut = self.deadline.is_set() and (
            self.unconfirmed or low is None or high is None or high - low > SETTINGS.relative_tolerance * high
        )
        undecided = high is not None and low is not None and high - low > SETTINGS.relative_tolerance * high and not cut
        if undecided:
            why = "between the two gaps no search came to an end"
        return AllowableGap(
            "at most", self.limit, self.assembly, self.goals,
            proven if near else low,
            Certainty.PROVEN if near else Certainty.SEARCHED if low is not None else None,
            beyond, searched, proven,
            tuple(sorted(self.trials.values(), key=lambda t: t.gap)),
            why=why, stopped=cut,
        )  # fmt: skip
