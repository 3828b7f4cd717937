"""Draws of gaps that bound each other: which of them are searched, and what that says of the others.

A part lies inside itself with its boundary further in. So what is free in one draw is free in every looser one, that is one in which no
part is larger: a checked motion is a lower bound of all looser draws, and what a search found, as far as it is believed, an upper bound
of all tighter ones. The state with every part as tight as in any draw, and that with every part as loose, bound all of them.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from typing import Any, Generic

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import InputError, StoppedError
from wiggleroom.parallel.parallel_run import StopHere, Work, run_each
from wiggleroom.sensitivity.found_motion import Found, is_checked, verdict_of
from wiggleroom.sensitivity.gap_distribution import wilson
from wiggleroom.sensitivity.gap_study import GapStudy
from wiggleroom.sensitivity.perturbation import SAME_VALUE, PerturbedObjective
from wiggleroom.verdict import Verdict

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MAX_SEARCHES, BATCH = 48, 4
"""Draws that are searched at most, and how many at once: the same on any number of processors."""
TESTED = 8
"""Draws that are searched, from the smallest to the largest, where there is no limit to decide about."""
KNOWN_SHARE = 0.1
"""The yield is known where the undecided draws are no more than this share of its confidence interval."""


class SearchedDraws(Generic[Found]):
    """Values of draws, made surer by searches.

    Parameters
    ----------
    study : GapStudy
    answer : Answer
        Without variation.
    inward : (draws, n) float64 [mm]
        How far the boundary of each part lies further in.
    climbs : sequence of PerturbedObjective
        What climbs found.
    limit : float or None
        Largest motion that is wanted.
    """

    def __init__(
        self,
        study: GapStudy[Found],
        answer: Found,
        inward: Floats,
        climbs: list[PerturbedObjective],
        limit: float | None,
    ) -> None:
        self.study, self.answer, self.inward, self.limit = study, answer, inward, limit
        self.climbed = np.array([c.value for c in climbs])
        self.value = self.climbed.copy()
        self.most = np.full(len(climbs), np.inf)
        """Value that no motion of a draw exceeds, as far as searches are believed."""
        self.searched: dict[int, float] = {}
        self.tightest: float | None = None
        self.loosest: float | None = None
        self.believed = False
        self._studies: dict[int, GapStudy[Found]] = {}
        self._context = UNLIMITED
        self._done = len(climbs)

    @property
    def fit(self) -> Bools:
        """Draws whose parts fit beside each other."""
        return ~np.isnan(self.value)

    @property
    def checked(self) -> Floats:
        """Number, climb and search of every draw that was searched (k, 3)."""
        rows = [(k, self.climbed[k], value) for k, value in sorted(self.searched.items())]
        return np.array(rows, dtype=float).reshape(-1, 3)

    @property
    def undecided(self) -> Bools:
        """Draws of which it is not known whether they keep the limit; without one, draws that may move further than is known."""
        if self.believed:
            return np.zeros(len(self.value), dtype=bool)
        low = self.fit & (self.value < (1 - SAME_VALUE) * self.most)
        return low if self.limit is None else low & (self.value <= self.limit) & (self.most > self.limit)

    def search(self, context: Context) -> None:
        """Search the tightest and the loosest state, and where the climbs fall short of either, draws between them."""
        self._context = context
        with suppress(StoppedError):
            if self.fit.any():
                self._search(context)

    def _search(self, context: Context) -> None:
        ends = [self.inward[self.fit].min(axis=0), self.inward[self.fit].max(axis=0)]
        climbs = self._each(*self.study.draws(self.answer, context), ends, context)
        found = self._each(searched_draw, self._bare, ends, context)
        self.tightest, self.loosest = (self._take(end, one) for end, one in zip(ends, found, strict=True))
        if self.tightest is None or self.loosest is None or None in climbs:
            return
        low, high = (climb.value for climb in climbs)
        tight = math.isnan(self.tightest)  # then it says nothing, and draws are tried in its place
        agree = not _falls_short(high, self.loosest) and (tight or not _falls_short(low, self.tightest))
        wanted = tight if agree and self.loosest < math.inf else self.limit is None
        if wanted:
            order = np.flatnonzero(self.fit)[np.argsort(self.value[self.fit], kind="stable")]
            self._search_draws(np.unique(order[np.linspace(0, len(order) - 1, TESTED).round().astype(int)]), context)
            agree = agree and not any(_falls_short(self.climbed[k], value) for k, value in self.searched.items())
        self.believed = agree and self.loosest < math.inf and not context.stopped
        while self.limit is not None and not self._known and not context.stopped:
            some = self._most_deciding()
            if not len(some):
                break
            self._search_draws(some, context)

    @property
    def _bare(self) -> tuple[GapStudy[Found], StopHere]:
        """The study as it was asked, for other processes, and what stops it in this one."""
        stop = self._context.stop
        return self.study.with_inward(np.zeros(self.inward.shape[1]), stop), StopHere(stop)

    @property
    def _known(self) -> bool:
        """True where the undecided draws hardly widen the confidence interval of the yield."""
        left, count = int(self.undecided.sum()), len(self.value)
        assert self.limit is not None
        low, high = wilson(int((self.value <= self.limit).sum()), count)
        return left <= KNOWN_SHARE * (high - low) * count

    def _most_deciding(self) -> NDArray[np.int64]:
        """Some undecided draws, each of which decides the most tighter ones if it keeps the limit, and not the same ones.

        One that does not keep it is found sooner than that, and its path is followed to others.
        """
        left = np.setdiff1d(np.flatnonzero(self.undecided), list(self.searched))
        some = self.inward[left]
        inside: Bools = np.all(some[:, None] <= some[None], axis=2)  # the first is as tight as the second
        chosen: list[int] = []
        while len(chosen) < min(BATCH, len(left), MAX_SEARCHES - len(self.searched)):
            above, below = inside.sum(axis=1), inside.sum(axis=0)
            worth = below + 1e-3 * above
            worth[chosen] = -1.0
            best = int(np.argmax(worth))
            chosen.append(best)
            decided = inside[best] | inside[:, best]
            inside[decided] = False
            inside[:, decided] = False
        return left[chosen]

    def _search_draws(self, some: NDArray[np.int64], context: Context) -> None:
        found = self._each(searched_draw, self._bare, list(self.inward[some]), context)
        for k, one in zip(some.tolist(), found, strict=True):
            value = self._take(self.inward[k], one)
            if value is not None:
                self.searched[k] = value
                self.value[k] = np.fmax(self.value[k], value)

    def _each(self, work: Work, shared: Any, tasks: list[Floats], context: Context) -> list[Any]:
        """Results of some tasks; they are told as further ones after those that were done before."""
        before, tell = self._done, context.counted
        if tell is not None:
            tell(before, before + len(tasks))
            context = replace(context, counted=lambda done, total: tell(before + done, before + total))
        self._done += len(tasks)
        return run_each(work, shared, tasks, context)

    def _take(self, inward: Floats, found: Found | Verdict | None) -> float | None:
        """What a search says of the state itself and of all draws; None where it was not made, nan where the parts do not fit."""
        if found is None or isinstance(found, Verdict):
            return None if found in (None, Verdict.STOPPED) else math.nan
        value = math.inf if found.objective is None else float(found.objective)
        looser = (self.inward >= inward).all(axis=1) & self.fit
        tighter = (self.inward <= inward).all(axis=1) & self.fit
        if is_checked(found):
            self.value[looser] = np.maximum(self.value[looser], value)
            self._follow(found, inward, value)
        if found.verdict.ends:
            self.most[tighter] = np.minimum(self.most[tighter], value)
        return value

    def _follow(self, found: Found, inward: Floats, value: float) -> None:
        """Follow the path of a state beyond the limit to the draws that are tighter in some part and not known to get there."""
        limit = math.inf if self.limit is None else self.limit
        asked = np.flatnonzero(self.fit & (self.value <= limit) & (self.value < math.inf))
        if not len(asked) or (value <= limit and value < math.inf):
            return
        wide = self.study.with_inward(inward, self._context.stop).with_room(found, limit, self._context)
        for k in asked.tolist():
            if self._context.stopped:
                break
            if k not in self._studies:
                self._studies[k] = self.study.with_inward(self.inward[k], self._context.stop)
            kept = self._studies[k].followed(wide, limit)
            if kept is not None:
                self.value[k] = math.inf if kept.objective is None else max(self.value[k], kept.objective)


def _falls_short(climb: float, search: float) -> bool:
    """Whether a climb found less than a search of the same state."""
    return not climb >= (1 - SAME_VALUE) * search


def searched_draw(shared: tuple[GapStudy[Any], StopHere], inward: Floats) -> Any:
    """The answer of a direct question with other boundaries, without what a search could go on from; a verdict where there is none."""
    study, stop = shared
    try:
        return replace(study.with_inward(inward, stop).answer(Context(stop=stop)), warm_start=None)
    except (InputError, StoppedError) as why:
        return verdict_of(why)
