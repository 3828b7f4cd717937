"""Which gap a maker may leave: the largest that keeps a motion small or the parts together, the smallest that fits.

Parts only get smaller as the gap grows, so what can be moved at one gap can be moved at any larger one: the largest motion never
falls, a way apart stays one, and parts that fit beside each other still do. Each question therefore has one border, which is
enclosed between a gap that answers it and one that was seen not to.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.findings import asked_goals, overlap_depth
from wiggleroom.bound.prove import prove
from wiggleroom.deadline import Deadline
from wiggleroom.disassembly.interlock import Interlock
from wiggleroom.disassembly.largest_gap import largest_gap
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, MissingExtraError, Stop, StoppedError
from wiggleroom.maximise import flex
from wiggleroom.search.answer import Answer
from wiggleroom.search.drawable import Drawable
from wiggleroom.search.loop import Progress
from wiggleroom.verdict import Certainty, Verdict

Question = Literal["at most", "holds", "fits"]


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
    max_confirmations : int
        Global searches, each at an answer that the one before has lowered.
    """

    relative_tolerance: float = 1e-3
    geometric_tolerance: float = 1e-6
    max_proof_distance: float = 1e-2
    min_gap_share: float = 1e-5
    first_gap_share: float = 1e-2
    proof_seconds: float = 10.0
    proof_steps: tuple[float, ...] = (0.004, 0.02, 0.08, 0.3)
    min_proof_share: float = 2e-3
    max_confirmations: int = 4


SETTINGS = GapSearchSettings()


@dataclass(frozen=True, eq=False)
class Trial:
    """What was found at one gap.

    Parameters
    ----------
    gap : float [mm]
    value : float or None
        Largest motion found [mm] (turns in [rad]), infinite where nothing stops it; for `fits` the deepest overlap at rest [mm].
        None where the parts cannot be made or touch.
    verdict : str
        That of the answer; "touching", "cannot be made", "fits" or "overlaps".
    checked : bool
        True where the value is that of a state that was checked by exact geometry, its way from rest too.
    at_most : float or None
        A value that no motion at this gap can exceed, where one was worked out.
    answer : Answer or None
        The motion.
    """

    gap: float
    value: float | None
    verdict: str
    checked: bool
    at_most: float | None = None
    answer: Answer | None = field(default=None, repr=False)


@dataclass(frozen=True, eq=False)
class AllowableGap(Drawable):
    """Gap that answers a maker's question.

    Parameters
    ----------
    question : str
        "at most": the largest gap at which the motion stays below the limit; "holds": the largest at which the parts interlock; "fits":
        the smallest at which they fit beside each other when every outline is larger by the limit.
    limit : float or None
        [mm] (turns in [rad]).
    assembly : Assembly
        As it was asked about.
    goals : tuple of Goal
        For "at most".
    gap : float or None [mm]
        The answer; None where there is none, see `why`.
    certainty : Certainty or None
        Proven, or searched: no larger motion, or no way apart, was found at this gap. None where there is no answer.
    beyond : float or None [mm]
        Nearest gap that was seen to fail, by a state that was checked; None where none was.
    searched_gap, proven_gap : float or None [mm]
        Largest gap at which no larger motion was found, and largest at which none is possible. For "fits" both are the answer.
    trials : tuple of Trial
        Everything that was tried, in order of the gap.
    sides : (Interlock or None, Interlock or None)
        For "holds": the states that were verified at `gap` and at `beyond`.
    why : str
        What a reader must know beside the number; empty where there is nothing.
    stopped : bool
        True where the time was over, or it was stopped, before both sides lay near each other.
    """

    question: Question
    limit: float | None
    assembly: Assembly
    goals: tuple[Goal, ...]
    gap: float | None
    certainty: Certainty | None
    beyond: float | None
    searched_gap: float | None
    proven_gap: float | None
    trials: tuple[Trial, ...]
    sides: tuple[Interlock | None, Interlock | None] = (None, None)
    why: str = ""
    stopped: bool = False

    def cut_offset(self, kerf: float) -> float | None:
        """How far outward the cutter's path must lie from the drawn line [mm], so that this gap comes out.

        A cut along the line takes half a kerf from every outline, and the gap wants half a gap: the difference is the offset.
        """
        return None if self.gap is None else (kerf - self.gap) / 2


def allowable_gap(
    assembly: Assembly,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    at_most: float | None = None,
    holds: bool = False,
    fits: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> AllowableGap:
    """Gap at which a motion stays below a limit, parts interlock, or parts that were cut too large still fit.

    Parameters
    ----------
    assembly : Assembly
        Its own gap is where the search begins. Gaps of single joints and offsets of parts stay as they are.
    goals : Pull, Turn or W, or several that add up
        For `at_most`; by default what the assembly's file asks for.
    at_most : float, optional [mm]
        Ask for the largest gap at which the largest motion is no more than this (turns in [rad]).
    holds : bool
        Ask for the largest gap at which the parts interlock.
    fits : float, optional [mm]
        Ask for the smallest gap at which the parts do not overlap at rest when every outline lies up to so much further out.
    seconds : float, optional [s]
        When this time is over, the best so far is given.
    stop, progress : optional
        As for `flex`.

    Raises
    ------
    InputError
        If not one question is asked, a number makes no sense, or nothing is fixed or pulled.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.allowable_gap(wr.patterns.chain(2, joint="tee", gap=0.02), at_most=0.1)
    >>> found.gap < found.beyond < 1.011 * found.gap
    True
    """
    if sum((at_most is not None, holds, fits is not None)) != 1:
        raise InputError("gap: ask one question: at most (--at-most 0.5), holds (--holds) or fits (--fits 0.1)")
    for name, value in (("at most", at_most), ("fits", fits)):
        if value is not None and not (math.isfinite(value) and (value > 0 or (value == 0 and name == "fits"))):
            wrong = f"gap: {name} {value:g}: it must be more than 0"
            raise InputError(wrong)
    deadline = Deadline(seconds, stop)
    if at_most is not None:
        return _MotionBorder(assembly, asked_goals(assembly.drawing, goals), at_most, deadline, progress).enclose()
    if fits is not None:
        return _fitting(assembly, fits)
    return _holding(assembly, deadline, progress)


class _MotionBorder:
    """Encloses the gap at which the largest motion reaches a limit."""

    def __init__(
        self,
        assembly: Assembly,
        goals: tuple[Goal, ...],
        limit: float,
        deadline: Deadline,
        progress: Callable[[Progress], None] | None,
    ) -> None:
        self.assembly, self.goals, self.limit = assembly, goals, limit
        self.deadline, self.progress = deadline, progress
        self.trials: dict[float, Trial] = {}

    def enclose(self) -> AllowableGap:
        """Bracket the border by growing and halving, then look for a proof on its lower side."""
        size = self.assembly.size
        low = self._below(size)
        if low is None:
            return self._answer(None, self._least_trial_words())
        high, why = self._above(low, size)
        low = max(t.gap for t in self.trials.values() if self._keeps(t) and (high is None or t.gap < high))
        if high is not None:
            low, high = self._narrow(low, high)
        low, high = self._confirmed(low, high)
        proven = self._proven(low)
        return self._answer(low, why, high, proven)

    def _below(self, size: float) -> float | None:
        """A gap at which the motion stays below the limit; None where none was found."""
        gap = self.assembly.gap or SETTINGS.first_gap_share * size
        while gap > SETTINGS.min_gap_share * size and not self.deadline.is_set():
            trial = self._at(gap)
            if self._keeps(trial):
                return gap
            if trial.verdict == Verdict.TOUCHING:
                break
            value, first = trial.value, len(self.trials) == 1
            gap *= 0.95 * self.limit / value if first and value and value < math.inf else 0.5
        if self._keeps(self._at(0.0)):
            return 0.0
        return None

    def _above(self, low: float, size: float) -> tuple[float | None, str]:
        """A gap at which a larger motion was found, or None and why there is none."""
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
        """Enclose the border to `RELATIVE_TOLERANCE`: secant steps from either side in turn, and halving where they are slow."""
        side, halve = 1.0, False
        low = max((t.gap for t in self.trials.values() if self._keeps(t) and t.gap < high), default=low)
        while high - low > SETTINGS.relative_tolerance * high and not self.deadline.is_set():
            wide = high - low
            gap = (low + high) / 2
            below, above = self.trials[low].value, self.trials[high].value
            if not halve and below is not None and above is not None and below < self.limit < above < math.inf:
                chord = low + wide * (self.limit - below) / (above - below)
                gap = min(
                    max(chord + side * 0.3 * SETTINGS.relative_tolerance * high, low + 0.02 * wide), high - 0.02 * wide
                )
            trial = self._at(gap)
            if self._fails(trial):
                high, side = gap, -1.0
            elif self._keeps(trial):
                low, side = gap, 1.0
            else:
                break
            halve = high - low > 0.5 * wide
        return low, high

    def _confirmed(self, low: float, high: float | None) -> tuple[float, float | None]:
        """Search beyond the nearest hill at the answer, which trials do not; where that finds a larger motion the border lies below."""
        for _ in range(SETTINGS.max_confirmations):
            if self.deadline.is_set():
                break
            self.trials[low] = self._solved(low, None)
            smaller = [t.gap for t in self.trials.values() if self._keeps(t) and t.gap < low]
            if not self._fails(self.trials[low]) or not smaller:
                break
            low, high = self._narrow(max(smaller), low)
        return low, high

    def _proven(self, low: float) -> float | None:
        """Largest gap at which no motion above the limit is possible, by a bound."""
        limit = Deadline(min(self.deadline.left, SETTINGS.proof_seconds), self.deadline)
        for share in (0.0, *SETTINGS.proof_steps) if limit.left > 0 else ():
            gap = low * (1 - share)
            trial = self._at(gap)
            if trial.at_most is not None and trial.at_most <= self.limit:
                return gap
            within = self.limit / trial.value - 1 if trial.value else 0.0
            if trial.answer is not None and within >= SETTINGS.min_proof_share and not limit.is_set():
                try:
                    most = prove(
                        trial.answer, min(0.9 * within, 9.0), seconds=limit.left / 2,
                        stop=limit, progress=self.progress,
                    ).at_most  # fmt: skip
                except (InputError, MissingExtraError):  # sums of squares have no bound, or the extra is not there
                    return None
                if most is not None and most <= self.limit:
                    self.trials[gap] = Trial(gap, trial.value, trial.verdict, trial.checked, most, trial.answer)
                    return gap
            if limit.is_set():
                return None
        return None

    def _at(self, gap: float) -> Trial:
        """What is found at a gap; at a larger gap never less than at a smaller one."""
        if gap not in self.trials:
            self.trials[gap] = self._solved(gap)
        return self.trials[gap]

    def _solved(self, gap: float, search: int | None = 0) -> Trial:
        try:
            made = assemble(self.assembly.drawing, gap=gap)
        except InputError:
            overlapping = gap < max((t.gap for t in self.trials.values() if t.value is not None), default=0.0)
            return Trial(gap, None, Verdict.TOUCHING if overlapping or gap == 0 else Verdict.NOT_MAKEABLE, False)
        try:
            answer = flex(made, self.goals, search=search, stop=self.deadline, progress=self.progress)
        except StoppedError:
            return Trial(gap, None, Verdict.STOPPED, False)
        except InputError:
            return Trial(gap, None, Verdict.TOUCHING, False)
        value = math.inf if answer.objective is None else answer.objective
        trial = Trial(
            gap, value, answer.verdict, answer.path == "checked" and answer.collision_free, answer.at_most, answer
        )
        smaller = [t for t in self.trials.values() if t.gap < gap and t.checked and t.value is not None]
        best = max(smaller, key=lambda t: t.value or 0.0, default=None)
        if best is not None and best.value is not None and best.value > value:
            # the same motion is free here too, where every part is smaller
            return Trial(gap, best.value, best.verdict, True, trial.at_most, best.answer)
        return trial

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
            low is None or high is None or high - low > SETTINGS.relative_tolerance * high
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


def _holding(assembly: Assembly, deadline: Deadline, progress: Callable[[Progress], None] | None) -> AllowableGap:
    """Largest gap at which the parts interlock."""
    border = largest_gap(assembly, stop=deadline, progress=progress)
    certainty = None if border.interlocked is None else border.interlocked.certainty
    trials = tuple(
        Trial(gap, None, state.verdict, True)
        for gap, state in ((border.holds, border.interlocked), (border.parts_at, border.apart))
        if gap is not None and state is not None
    )
    near = border.holds is not None and border.parts_at is not None and (
        border.parts_at - border.holds <= 2 * SETTINGS.relative_tolerance * border.parts_at
    )  # fmt: skip
    if border.holds is None:
        why = "no gap was found that holds it together"
    elif border.parts_at is None:
        why = "parts fall to pieces before they come apart"
    else:
        why = "" if near else "between the two gaps it was not decided"
    return AllowableGap(
        "holds", None, assembly, (), border.holds, certainty, border.parts_at, border.holds,
        border.holds if certainty is Certainty.PROVEN else None, trials, (border.interlocked, border.apart), why,
        deadline.is_set() and not near,
    )  # fmt: skip


def _fitting(assembly: Assembly, larger: float) -> AllowableGap:
    """Smallest gap at which outlines that lie `larger` further out do not overlap at rest."""
    trials: dict[float, Trial] = {}
    outward = dict.fromkeys(assembly.names, larger)

    def at(gap: float) -> Trial:
        if gap not in trials:
            depth = overlap_depth(assembly.drawing, gap=gap, offset=outward)
            verdict = Verdict.NOT_MAKEABLE if depth is None else "overlaps" if depth > 0 else "fits"
            trials[gap] = Trial(gap, depth, verdict, depth is not None)
        return trials[gap]

    low, high, size = 0.0, 2 * larger or SETTINGS.min_gap_share * assembly.size, assembly.size
    if at(0.0).verdict == "fits":
        return _fits(assembly, larger, 0.0, None, trials, "")
    while at(high).verdict == "overlaps" and high < 4 * size:
        low, high = high, 2 * high
    if at(high).verdict == Verdict.NOT_MAKEABLE:
        while high - low > SETTINGS.geometric_tolerance * high and at((low + high) / 2).verdict != "fits":
            middle = (low + high) / 2
            low, high = (middle, high) if at(middle).verdict == "overlaps" else (low, middle)
        high = (low + high) / 2
    if at(high).verdict != "fits":
        why = "no gap makes room: parts overlap at every gap at which they can be made"
        return _fits(assembly, larger, None, low, trials, why)
    while high - low > SETTINGS.geometric_tolerance * high:
        middle = (low + high) / 2
        low, high = (low, middle) if at(middle).verdict == "fits" else (middle, high)
    return _fits(assembly, larger, high, low, trials, "")


def _fits(
    assembly: Assembly, larger: float, gap: float | None, beyond: float | None, trials: dict[float, Trial], why: str
) -> AllowableGap:
    found = tuple(sorted(trials.values(), key=lambda t: t.gap))
    sure = None if gap is None else Certainty.PROVEN
    return AllowableGap("fits", larger, assembly, (), gap, sure, beyond, gap, gap, found, why=why)
