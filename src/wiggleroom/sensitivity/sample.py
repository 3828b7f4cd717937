"""What if the gaps vary: the motion of many assemblies whose gaps are drawn at random."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError
from wiggleroom.parallel.parallel_run import run_each
from wiggleroom.sensitivity.gap_distribution import Spread, wilson
from wiggleroom.sensitivity.gap_study import GapStudy, check_end
from wiggleroom.sensitivity.rank import Ranking, rank_at_once
from wiggleroom.sensitivity.searched_draws import SearchedDraws
from wiggleroom.verdict import Verdict

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sample(Drawable):
    """Motions of assemblies with gaps drawn at random.

    Parameters
    ----------
    answer : Answer
        Without any variation.
    spread : Spread
    seed : int
    extra : (draws, n) float64 [mm]
        Extra gap round every part.
    value : (draws,) float64
        Objective; infinity if nothing stops the motion, nan if parts do not fit beside each other.
    cut_short : int
        Number of draws whose value is only a safe motion, not an optimum.
    limit : float or None
        Largest motion of a good assembly.
    checked : (k, 3) float64
        For fully searched draws: number of the draw, value of its climbs, value of the search.
    tightest, loosest : float or None
        Largest motion, searched, with every part as tight and as loose as in any draw, which bounds all draws; infinity if nothing stops
        it, nan if the parts do not fit, None if not searched.
    undecided : (draws,) bool
        Climbed draws whose value may be low: a looser, searched state moves further (with a limit, further than the limit).
    ranking : Ranking
        Ranking of the answer, for the contributions of parts to the spread.
    asked : int
        Requested draws; a stopped study has fewer.
    """

    answer: Any
    spread: Spread
    seed: int
    extra: Floats
    value: Floats
    cut_short: int
    limit: float | None
    checked: Floats
    tightest: float | None
    loosest: float | None
    undecided: NDArray[np.bool_]
    ranking: Ranking
    asked: int

    @property
    def bounded(self) -> Floats:
        """Objectives of the draws that fit and hold, in order of size."""
        return np.sort(self.value[np.isfinite(self.value)])

    @property
    def misfits(self) -> int:
        """Draws whose parts do not fit beside each other."""
        return int(np.isnan(self.value).sum())

    @property
    def loose(self) -> int:
        """Draws where nothing stops the motion."""
        return int(np.isposinf(self.value).sum())

    def quantile(self, share: float) -> float:
        """Objective that `share` of the draws do not exceed; infinite where too many hold nothing. Misfits are left out."""
        fits = np.sort(self.value[~np.isnan(self.value)])
        if not len(fits):
            return float("nan")
        return float(np.quantile(fits, share, method="higher" if np.isinf(fits[-1]) else "linear"))

    @property
    def worst(self) -> int:
        """Draw with the largest objective."""
        return int(np.argmax(np.nan_to_num(self.value, nan=-np.inf, posinf=np.inf)))

    @property
    def good(self) -> int:
        """Draws that fit and keep the limit; those that are undecided are not counted."""
        return self._kept - (0 if self.limit is None else int(self.undecided.sum()))

    @property
    def _kept(self) -> int:
        """Draws that fit and were not seen to break the limit."""
        return int((self.value <= (np.inf if self.limit is None else self.limit)).sum())

    @property
    def yields(self) -> tuple[float, float, float]:
        """Share of all draws that fit and keep the limit, and its 95 % confidence interval.

        Draws that are undecided are not in the share; the interval allows for all or none of them.
        """
        count = len(self.value)
        return self.good / count, wilson(self.good, count)[0], wilson(self._kept, count)[1]

    @property
    def contributions(self) -> Floats:
        """Share of each part (n,) [%] in the variance, to first order and as if the parts varied independently."""
        squares = np.nan_to_num(self.ranking.by_duals) ** 2
        return 100 * squares / squares.sum() if squares.any() else squares

    @property
    def foreseen(self) -> float:
        """Predicted standard deviation of the objective: to first order, from the derivatives of the ranking, without the draws."""
        worth = np.nan_to_num(self.ranking.by_duals)
        alone, together = float((worth**2).sum()), float(worth.sum() ** 2)
        return float(self.spread.deviation * np.sqrt((1 - self.spread.sheet) * alone + self.spread.sheet * together))

    @property
    def largest_difference(self) -> float:
        """Largest share by which the climbs of a searched draw were off."""
        if not len(self.checked):
            return float("nan")
        used, anew = self.checked[:, 1], self.checked[:, 2]
        same = (used == anew) | (np.isnan(used) & np.isnan(anew))
        with np.errstate(invalid="ignore", divide="ignore"):
            off = np.abs(used - anew) / np.abs(anew)
        return float(np.where(same, 0.0, np.where(np.isfinite(off), off, 1.0)).max())


def sample(
    study: GapStudy[Any],
    spread: Spread | float,
    *,
    draws: int = 1000,
    seed: int = 0,
    limit: float | None = None,
    context: Context = UNLIMITED,
) -> Sample:
    """Largest motion when the gap round every part varies at random; see `wiggleroom.sample`.

    Pairs and free spaces are worked out once: walls are linear in the gaps, so every draw begins with the same walls,
    moved. It goes through the rounds of the search from rest, and where a direct question searches also from the end of the answer
    without variation and from other optima of it, for with other gaps one of these may be the largest; its end is free of overlap by
    exact geometry.
    Two states bound all draws, because parts only get smaller as their gaps grow: with every part as tight as in any draw, and as
    loose. Both are searched. Where the climbs find as much there, they are believed between them. Where not, draws are searched as a
    direct question is, those first that decide most others, until the yield is known or a counted amount of work is done;
    see `Sample.undecided`.

    Raises
    ------
    InputError
        If numbers make no sense, or nothing stops the motion without variation.
    """
    distribution = spread if isinstance(spread, Spread) else Spread(float(spread))
    wrong = [f"sample: {draws} draws: ask for at least 1"] if draws < 1 else []
    if limit is not None and not np.isfinite(limit):
        wrong.append(f"sample: limit {limit:g}: it must be a finite number")
    if wrong:
        raise InputError(wrong)
    answer = study.answer(context)
    check_end(study, answer)
    extra = distribution.draw(draws, len(study.assembly.parts), seed)
    results = run_each(*study.draws(answer, context), list(extra / 2), context)
    done = [k for k, r in enumerate(results) if r is not None]
    if not done:
        finding = "sample: stopped before the first draw was done"
        raise InputError(finding)
    found = SearchedDraws(study, answer, extra[done] / 2, [results[k] for k in done], limit)
    found.search(context)
    return Sample(
        answer, distribution, seed, extra[done], found.value,
        sum(results[k].verdict is Verdict.STOPPED for k in done), limit, found.checked, found.tightest, found.loosest,
        found.undecided, rank_at_once(answer, study), draws,
    )  # fmt: skip
