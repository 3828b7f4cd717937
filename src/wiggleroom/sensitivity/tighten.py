"""What to make tighter: few parts whose gaps, closed down, take away most of the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError, StoppedError
from wiggleroom.parallel.parallel_run import run_each
from wiggleroom.sensitivity.found_motion import Found, endless, is_checked
from wiggleroom.sensitivity.gap_study import GapStudy, check_end
from wiggleroom.sensitivity.perturbation import SAME_VALUE, exceeds
from wiggleroom.sensitivity.rank import ranking_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
ChosenBy = Literal["rank", "draws", "all"]


@dataclass(frozen=True)
class TighteningSettings:
    """Parameters of the greedy choice and of the trials after it.

    Parameters
    ----------
    kept_gap_share : float in [0, 1)
        By default the share of a gap that a tightened part keeps.
    max_rankings : int
        Rankings while parts are being chosen; more parts are chosen at a time where more would be needed.
    max_removal_tests : int
        Late choices that are tested again by leaving them out.
    random_choices : int
        Random sets of as many parts, to compare with; the best of them is taken where it is better.
    max_confirmed : int
        So many of the best sets, by climbs, are searched at most.
    """

    kept_gap_share: float = 0.1
    max_rankings: int = 8
    max_removal_tests: int = 16
    random_choices: int = 50
    max_confirmed: int = 4


SETTINGS = TighteningSettings()


@dataclass(frozen=True, eq=False)
class Tightening(Drawable):
    """Parts to make tighter, and the resulting motion.

    Parameters
    ----------
    before, after : Answer
        The motion without change, and with the chosen parts tightened.
    chosen : tuple of names
        In the order of choice; parts not chosen by rank in the order of the assembly.
    gap : float [mm]
        Remaining gap that a tightened part gives to its joints.
    limit : float or None
        Limit of the motion.
    random : (draws,) float64
        Objective of each random choice of as many parts, or of every choice if there are no more; nan if the parts do not fit.
    chosen_by : str
        "rank": by rank, a few at a time. "draws": the best random choice, if better. "all": the best of every choice.
    stopped : bool
        True if stopped before all choices were tried.
    """

    before: Any
    after: Any
    chosen: tuple[str, ...]
    gap: float
    limit: float | None
    random: Floats
    chosen_by: ChosenBy = "rank"
    stopped: bool = False

    @property
    def lowered(self) -> float:
        """Share of the motion [%] that the chosen parts take away."""
        return _lowered(self.before, self.after.objective)

    @property
    def lowered_at_random(self) -> float:
        """Mean share [%] that parts chosen at random take away, of those choices whose parts fit; nan where none does."""
        fits = self.random[np.isfinite(self.random)]
        return _lowered(self.before, float(np.mean(fits))) if len(fits) else float("nan")

    @property
    def misfits(self) -> int:
        """Choices at random whose parts, made tighter, do not fit beside each other."""
        return int(np.isnan(self.random).sum())

    @property
    def reached(self) -> bool:
        """True where the motion is not above the limit, or none was given."""
        return self.limit is None or (self.after.objective is not None and self.after.objective <= self.limit)


def _lowered(before: Any, value: float | None) -> float:
    if before.objective is None or value is None or not before.objective > 0:
        return float("nan")
    return 100 * (1 - value / before.objective)


def tighten(
    study: GapStudy[Any],
    *,
    parts: int | None = None,
    limit: float | None = None,
    gap: float | None = None,
    draws: int = SETTINGS.random_choices,
    seed: int = 0,
    context: Context = UNLIMITED,
) -> Tightening:
    """Which parts to make tighter for the least motion, or the fewest for a wanted limit; see `wiggleroom.tighten`.

    Raises
    ------
    InputError
        If neither or both of `parts` and `limit` are given, or a number makes no sense, or nothing stops the motion, as may show when
        larger parts get away.

    Source: Mind the Gap, section 6.2 and Fig. 11.
    """
    whole = study.assembly.gap if study.assembly.gap > 0 else study.clearance
    aim = SETTINGS.kept_gap_share * whole if gap is None else gap
    count = len(study.assembly.parts)
    _check(parts, limit, aim, whole, count)
    room = study.room(whole, aim)
    before = study.answer(context)
    check_end(study, before)
    choice, after = _choose(study, before, room, parts, limit, context)
    if choice:  # what the choice was made by need not be the largest motion
        after = _searched(study, choice, room, after, context)
    able = np.flatnonzero(room > 0)
    subsets, whole_list = _others(able, len(choice), draws, seed)
    results = run_each(*study.draws(before, context), [_inward(subset, room) for subset in subsets], context)
    random = np.array([np.nan if r is None else r.value for r in results], dtype=float)
    by: ChosenBy = "all" if whole_list and len(subsets) else "rank"
    tried = {tuple(sorted(choice))}
    for k in np.argsort(random, kind="stable")[: SETTINGS.max_confirmed].tolist():
        if after.objective is not None and not random[k] < (1 - SAME_VALUE) * after.objective:
            break
        if tuple(subsets[k]) in tried or context.stopped:
            continue
        tried.add(tuple(subsets[k]))
        other = _searched(study, subsets[k], room, None, context)
        if other is not None and exceeds(after, other):
            choice, after, by = list(subsets[k]), other, by if whole_list else "draws"
    if exceeds(after, before) and is_checked(after):  # where larger parts get, smaller ones do
        if after.objective is None:
            raise endless(study.with_assembly(after))
        before = study.in_place_of(before, after)
    names = tuple(study.assembly.names[k] for k in choice)
    return Tightening(before, after, names, aim, limit, random[[r is not None for r in results]], by)


def _others(able: Ints, count: int, draws: int, seed: int) -> tuple[list[tuple[int, ...]], bool]:
    """Choices of `count` parts: all, where these are no more than `draws`, else at random; and whether they are all."""
    if not count or not draws:
        return [], False
    if comb(len(able), count) <= draws:
        return list(combinations(able.tolist(), count)), True
    rng = np.random.default_rng(seed)
    return [tuple(np.sort(rng.choice(able, count, replace=False)).tolist()) for _ in range(draws)], False


def _searched(
    study: GapStudy[Found], chosen: Sequence[int], room: Floats, known: Found | None, context: Context
) -> Found | None:
    """What a direct question finds with some parts tightened; `known` where that is more, the parts do not fit, or it was stopped."""
    try:
        found = study.with_inward(_inward(chosen, room), context.stop).answer(context)
    except (InputError, StoppedError):
        return known
    return found if known is None or not exceeds(known, found) else known


def _check(parts: int | None, limit: float | None, aim: float, whole: float, count: int) -> None:
    wrong = []
    if (parts is None) == (limit is None):
        wrong.append("tighten: say how many parts, or the limit that the motion must keep, not both")
    if parts is not None and not 1 <= parts <= count:
        wrong.append(f"tighten: {parts} parts: there are {count}, choose 1 to {count}")
    if limit is not None and not 0 < limit < np.inf:
        wrong.append(f"tighten: limit {limit:g}: it must be more than 0")
    if not 0 <= aim < whole:
        wrong.append(f"tighten: to a gap of {aim:g}: it must be 0 or more and less than the present gap, {whole:g}")
    if wrong:
        raise InputError(wrong)


def _choose(
    study: GapStudy[Found], before: Found, room: Floats, parts: int | None, limit: float | None, context: Context
) -> tuple[list[int], Found]:
    """Parts chosen a few at a time, each time by the rank that is left, and the answer with all of them tightened."""
    able = room > 0
    most = min(able.sum() if parts is None else parts, able.sum())
    chosen: list[int] = []
    worth, answer = np.zeros(len(room)), before
    while len(chosen) < most and answer.objective is not None and not context.stopped:
        if limit is not None and answer.objective <= limit:
            break
        if study.can_be_ranked(answer):
            # mm of motion that each would take: what less gap loses, which of shared loads is more than what more gap gains
            worth = 2 * np.maximum(ranking_of(answer, study.derivatives(answer)).tighter, 0.0) * room
        left = np.flatnonzero(able)
        order = left[np.argsort(-worth[left], kind="stable")]
        batch = min(max(1, -(-most // SETTINGS.max_rankings)), most - len(chosen))
        if limit is not None:
            # what half of the missing motion needs by first order: the rest is ranked anew
            needed = int(np.searchsorted(np.cumsum(worth[order]), (answer.objective - limit) / 2)) + 1
            batch = min(batch, needed)
        more = [*chosen, *order[:batch].tolist()]
        try:
            answer = study.moved(before, _inward(more, room), context)
        except StoppedError:
            break
        chosen = more
        able[order[:batch]] = False
    if limit is not None and answer.objective is not None and answer.objective <= limit:
        for k in chosen[: -SETTINGS.max_removal_tests : -1]:  # a batch may have held more than it took
            fewer = [c for c in chosen if c != k]
            try:
                less = study.moved(before, _inward(fewer, room), context) if fewer else before
            except StoppedError:
                break
            if less.objective is not None and less.objective <= limit:
                chosen, answer = fewer, less
    return chosen, answer


def _inward(chosen: Sequence[int] | Ints, room: Floats) -> Floats:
    """How far the boundary of each part (n,) lies further in [mm] when some are made larger."""
    inward = np.zeros(len(room))
    inward[list(chosen)] = -room[list(chosen)]
    return inward
