"""The largest gap at which a motion stays below a limit: bracketed by trials, then proven from below."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Generic

from wiggleroom.context import Context
from wiggleroom.sensitivity.found_motion import Found
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.gap_trials import CLIMBED, AllowableGap
from wiggleroom.sensitivity.searched_gaps import RELATIVE_TOLERANCE, SearchedGaps
from wiggleroom.verdict import Certainty, Verdict


@dataclass(frozen=True)
class GapSearchSettings:
    """Parameters of the bracketing and of the proofs.

    Parameters
    ----------
    max_proof_distance : float in (0, 1)
        A proven gap is the answer where it lies no further than this share below a gap that fails.
    min_gap_share : float in (0, 1)
        No gap below this share of the drawing's size is tried.
    first_gap_share : float in (0, 1)
        Where the drawing gives no gap, the search begins at this share of its size.
    proof_steps : tuple of float in (0, 1)
        Shares below the border at which a proof is tried, one after the other: near ones say more, far ones are easier.
    min_proof_share : float in (0, 1)
        No proof is tried that would have to come nearer to the motion than this share of it.
    """

    max_proof_distance: float = 1e-2
    min_gap_share: float = 1e-5
    first_gap_share: float = 1e-2
    proof_steps: tuple[float, ...] = (0.004, 0.02, 0.08, 0.3)
    min_proof_share: float = 2e-3


SETTINGS = GapSearchSettings()


class MotionBorder(Generic[Found]):
    """Encloses the gap at which the largest motion reaches a limit."""

    def __init__(self, study: GapStudy[Found], limit: float, context: Context) -> None:
        self.study, self.limit = study, limit
        self.assembly, self.goals = study.assembly, study.goals
        self.context = context
        self.gaps = SearchedGaps(study, limit, searching=False, context=context)
        self.unconfirmed = False

    def enclose(self) -> AllowableGap:
        """Bracket the border by growing and halving, have it confirmed, then look for a proof on its lower side.

        Trials climb from rest, and the answer is searched. Where that finds more than the climb, every gap is searched.
        """
        low, high, why = self._bracket()
        if low is not None and not self._confirmed(low):
            self.gaps.search()
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
        low = max(t.gap for t in self.gaps.trials.values() if self.gaps.keeps(t) and (high is None or t.gap < high))
        if high is not None:
            low, high = self.gaps.narrow(low, high)
        return low, high, why

    def _below(self, size: float) -> float | None:
        """A gap at which the motion stays below the limit; None where none was found."""
        gap = begin = self.assembly.gap or SETTINGS.first_gap_share * size
        while gap > SETTINGS.min_gap_share * size and not self.context.stopped:
            trial = self.gaps.at(gap)
            if self.gaps.keeps(trial):
                return gap
            if trial.verdict == Verdict.TOUCHING:
                break
            value = trial.value
            gap *= 0.95 * self.limit / value if gap == begin and value and value < math.inf else 0.5
        if self.gaps.keeps(self.gaps.at(0.0)):
            return 0.0
        return None

    def _above(self, low: float, size: float) -> tuple[float | None, str]:
        """A gap at which a larger motion was found, or None and why there is none."""
        known = [t.gap for t in self.gaps.trials.values() if t.gap > low and self.gaps.fails(t)]
        if known:
            return min(known), ""
        gap, made, step = low or SETTINGS.first_gap_share * size, low, 0.0
        while not self.context.stopped:
            value = self.gaps.trials[low].value
            share = min(max(1.02 * self.limit / value - 1, 0.02), 3.0) if value else 1.0
            step = 2 * step or gap * share
            gap += step
            trial = self.gaps.at(gap)
            if self.gaps.fails(trial):
                return gap, ""
            if self.gaps.keeps(trial):
                made = low = gap
            elif trial.verdict == Verdict.NOT_MAKEABLE:
                return self._thinnest(made, gap)
            elif trial.verdict != Verdict.STOPPED and gap > 4 * size:
                break
        return None, "no gap was found at which it moves further"

    def _thinnest(self, made: float, gone: float) -> tuple[float | None, str]:
        """The border lies below the gap at which parts vanish; or no gap at which the parts can be made moves further."""
        while gone - made > RELATIVE_TOLERANCE * gone and not self.context.stopped:
            gap = (made + gone) / 2
            trial = self.gaps.at(gap)
            if self.gaps.fails(trial):
                return gap, ""
            made, gone = (made, gap) if trial.verdict == Verdict.NOT_MAKEABLE else (gap, gone)
        return None, f"at a gap of {gone:.6g} mm parts fall to pieces before the motion gets further"

    def _confirmed(self, low: float) -> bool:
        """False where a search at the answer, which climbs do not make, finds a motion beyond the limit."""
        self.unconfirmed = self.context.stopped
        if self.unconfirmed or self.gaps.trials[low].verdict != CLIMBED:
            return True
        self.gaps.searching = True
        del self.gaps.trials[low]
        found = self.gaps.at(low)
        self.unconfirmed = self.context.stopped and not found.ended
        return self.gaps.keeps(found) or self.unconfirmed

    def _proven(self, low: float) -> float | None:
        """Largest gap at which no motion above the limit is possible, by a bound."""
        for share in (0.0, *SETTINGS.proof_steps):
            if self.context.stopped:
                return None
            gap = low * (1 - share)
            trial = self.gaps.at(gap)
            if trial.at_most is not None and trial.at_most <= self.limit:
                return gap
            found = None if trial.answer is None else trial.answer.objective
            within = self.limit / found - 1 if found else 0.0
            if within >= SETTINGS.min_proof_share:
                most = self.study.with_bound(trial.answer, min(0.9 * within, 9.0), self.context).at_most
                if most is not None and most <= self.limit:
                    self.gaps.trials[gap] = replace(trial, at_most=most)
                    return gap
        return None

    def _least_trial_words(self) -> str:
        """Why no gap keeps the limit."""
        done = sorted((t for t in self.gaps.trials.values() if t.value is not None), key=lambda t: t.gap)
        if self.context.stopped:
            return "stopped before a gap was found that keeps the limit"
        if not done:
            return "the parts leave no room at any gap that was tried"
        least = done[0]
        moves = "nothing stops it" if least.value == math.inf else f"it moves {least.value:.6g}"
        return f"no gap keeps the limit: at a gap of {least.gap:.6g} mm {moves}"

    def _answer(
        self, low: float | None, why: str, high: float | None = None, proven: float | None = None
    ) -> AllowableGap:
        failing = [t.gap for t in self.gaps.trials.values() if self.gaps.fails(t)]
        beyond = high if high is not None else min(failing, default=None)
        searched = low
        near = proven is not None and proven >= (1 - SETTINGS.max_proof_distance) * (beyond or low or 0.0)
        cut = self.context.stopped and (
            self.unconfirmed or low is None or high is None or high - low > RELATIVE_TOLERANCE * high
        )
        undecided = high is not None and low is not None and high - low > RELATIVE_TOLERANCE * high and not cut
        if undecided:
            why = "between the two gaps no search came to an end"
        return AllowableGap(
            "at most", self.limit, self.assembly, self.goals,
            proven if near else low,
            Certainty.PROVEN if near else Certainty.SEARCHED if low is not None else None,
            beyond, searched, proven,
            tuple(sorted(self.gaps.trials.values(), key=lambda t: t.gap)),
            why=why, stopped=cut,
        )  # fmt: skip
