"""Largest and smallest motion that tolerances allow, and which of them contribute.

The loosest corner of the tolerances has every outline as far in, and every joint as wide, as they allow. There each part lies inside
itself as it is anywhere else within the tolerances. So every motion that is possible somewhere within them is possible at that corner:
it is the worst case, whatever the derivatives are. What is searched is only the largest motion at it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.deviations import deviated
from wiggleroom.displayable import Drawable
from wiggleroom.drawing.model import Drawing, Goal, Tolerance
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.maximise import flex, witness
from wiggleroom.parallel.parallel_run import ParallelRun
from wiggleroom.search.answer import Answer
from wiggleroom.search.progress import Progress
from wiggleroom.sensitivity.counted_bound import counted_bound
from wiggleroom.sensitivity.rank import Ranking, rank
from wiggleroom.verdict import Certainty, PathState, Verdict


@dataclass(frozen=True)
class Contribution:
    """What one tolerance does to the motion, the others at their nominal.

    Parameters
    ----------
    tolerance : Tolerance
    slope : float [mm per mm]
        Motion gained for each mm that the outline lies further in, or the joint is wider.
    looser, tighter : float [mm]
        To first order: motion gained at its loose end, and lost at its tight end.
    """

    tolerance: Tolerance
    slope: float
    looser: float
    tighter: float


@dataclass(frozen=True, eq=False)
class WorstCase(Drawable):
    """Range of the largest motion within tolerances.

    Parameters
    ----------
    nominal : Answer
        Everything where it should be.
    loosest : Answer
        Every outline as far in, and every joint as wide, as allowed: the worst case.
    tightest : Answer or None
        Every outline as far out, and every joint as narrow; None where parts then do not fit beside each other, see `misfit`.
    misfit : str
        Why they do not fit.
    contributions : tuple of Contribution
        Of the tolerances, the largest first.
    limit : float or None
        Largest motion that is wanted.
    stopped : bool
        True where not everything was worked out in time.
    """

    nominal: Answer
    loosest: Answer
    tightest: Answer | None
    misfit: str
    contributions: tuple[Contribution, ...]
    limit: float | None
    stopped: bool = False

    @property
    def assembly(self) -> Assembly:
        """As it should be."""
        return self.nominal.assembly

    @property
    def certainty(self) -> Certainty:
        """Proven where a bound shows that the limit is kept, or a checked motion that it is not; else searched."""
        most, found = self.loosest.at_most, self.loosest.objective
        if self.limit is not None and most is not None and most <= self.limit:
            return Certainty.PROVEN
        broken = (
            self.limit is not None and (found is None or found > self.limit) and self.loosest.path == PathState.CHECKED
        )
        return Certainty.PROVEN if broken else Certainty.SEARCHED

    @property
    def keeps(self) -> bool | None:
        """True where the limit is kept everywhere within the tolerances; None without a limit."""
        if self.limit is None:
            return None
        return self.loosest.objective is not None and self.loosest.objective <= self.limit

    @property
    def first_order(self) -> float:
        """Worst case as the sum of all contributions [mm]."""
        return (self.nominal.objective or 0.0) + sum(c.looser for c in self.contributions)

    @property
    def root_sum_square(self) -> float:
        """The same with contributions that are independent of each other: the root of the sum of their squares [mm]."""
        return (self.nominal.objective or 0.0) + math.sqrt(sum(c.looser**2 for c in self.contributions))

    @property
    def percent(self) -> NDArray[np.float64]:
        """Share of each contribution (k,) [%] in the sum."""
        some = np.array([c.looser for c in self.contributions])
        return 100 * some / some.sum() if some.sum() > 0 else np.zeros_like(some)


def worst_case(
    assembly: Assembly,
    tolerances: Sequence[Tolerance] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    limit: float | None = None,
    workers: int | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> WorstCase:
    """Largest and smallest motion within tolerances, each solved at its corner, and what every tolerance contributes.

    Parameters
    ----------
    assembly : Assembly
    tolerances : sequence of Tolerance, optional
        By default those of the assembly's file.
    goals : Pull, Turn or W, or several that add up
        By default what the assembly's file asks for.
    limit : float, optional
        Largest motion that is wanted.
    workers, stop, progress : optional
        Where single outlines are solved, and what stops it.

    Raises
    ------
    InputError
        If there are no tolerances, a name is unknown, parts do not fit even where they should be, or nothing stops the motion there.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> chain = wr.patterns.chain(2, joint="tee", gap=0.02)
    >>> found = wr.worst_case(chain, [wr.Tolerance(("b2",), plus=0.002, minus=0.002)])
    >>> found.tightest.objective < found.nominal.objective < found.loosest.objective
    True
    """
    require_planar(assembly, "worst_case")
    given = tuple(assembly.drawing.tolerances if tolerances is None else tolerances)
    _check_question(given, limit)
    drawing = assembly.drawing
    middle = _made(drawing, [(t, 0.0) for t in given])
    ranking = rank(middle, goals, stop=stop)
    nominal = ranking.answer
    loosest = _corner(drawing, [(t, _loose(t)) for t in given], nominal, stop, progress)
    loosest = _with_bound(loosest, limit, stop)
    tightest, misfit = None, ""
    try:
        tightest = _tight(drawing, [(t, -_opposite(t)) for t in given], nominal, stop, progress)
    except InputError as problem:
        misfit = problem.findings[0]
    except StoppedError:
        misfit = "stopped before it was worked out"
    slopes, whole = _slopes(drawing, given, ranking, workers, stop)
    some = [
        Contribution(t, slope, slope * abs(_loose(t)), slope * abs(_opposite(t)))
        for t, slope in zip(given, slopes, strict=True)
    ]
    some.sort(key=lambda c: -c.looser)
    cut = not whole or Verdict.STOPPED in (loosest.verdict, nominal.verdict)
    return WorstCase(nominal, loosest, tightest, misfit, tuple(some), limit, cut)


def _check_question(given: Sequence[Tolerance], limit: float | None) -> None:
    wrong = (
        []
        if given
        else ["tolerances: none are given: name a table with --tolerances FILE, or write them into the assembly file"]
    )
    seen = [(frozenset(t.parts), t.outline) for t in given]
    wrong += [
        f"tolerances: {' and '.join(sorted(names))} are given twice; once is right"
        for names, outline in dict.fromkeys(seen)
        if seen.count((names, outline)) > 1
    ]
    for t in given:
        if not (0 <= t.plus < math.inf and 0 <= t.minus < math.inf):
            wrong.append(f"tolerance of {' and '.join(t.parts)}: plus and minus must be 0 or more")
    if limit is not None and not math.isfinite(limit):
        wrong.append(f"limit {limit:g}: it must be a finite number")
    if wrong:
        raise InputError(wrong)


def _loose(tolerance: Tolerance) -> float:
    """Deviation at the end where there is more room [mm]."""
    return tolerance.plus if len(tolerance.parts) == 2 else -tolerance.minus


def _opposite(tolerance: Tolerance) -> float:
    """Deviation at the other end, its sign turned round [mm]."""
    return tolerance.minus if len(tolerance.parts) == 2 else -tolerance.plus


def _made(drawing: Drawing, deviations: Sequence[tuple[Tolerance, float]]) -> Assembly:
    return assemble(deviated(drawing, deviations))


def _corner(
    drawing: Drawing,
    deviations: Sequence[tuple[Tolerance, float]],
    nominal: Answer,
    stop: Stop | None,
    progress: Callable[[Progress], None] | None,
) -> Answer:
    """Answer at the loose corner; never less than the nominal motion, which is free for the smaller parts too."""
    made = _made(drawing, deviations)
    answer = flex(made, nominal.goals, stop=stop, progress=progress)
    if answer.objective is not None and answer.objective < (nominal.objective or 0.0):
        return replace(nominal, assembly=made, at_most=answer.at_most, bound=answer.bound)
    return answer


def _with_bound(loosest: Answer, limit: float | None, stop: Stop | None) -> Answer:
    """The worst case with a bound below the limit, where one can be proven with little work."""
    found, most = loosest.objective, loosest.at_most
    if limit is None or found is None or not 0 < found < limit or (most is not None and most <= limit):
        return loosest
    return counted_bound(loosest, min(0.9 * (limit / found - 1), 9.0), stop)


def _tight(
    drawing: Drawing,
    deviations: Sequence[tuple[Tolerance, float]],
    nominal: Answer,
    stop: Stop | None,
    progress: Callable[[Progress], None] | None,
) -> Answer:
    return flex(_made(drawing, deviations), nominal.goals, stop=stop, progress=progress)


def _slopes(
    drawing: Drawing, given: Sequence[Tolerance], ranking: Ranking, workers: int | None, stop: Stop | None
) -> tuple[list[float], bool]:
    """Motion gained per mm of looser tolerance: of parts and joints from the forces, of single outlines solved again."""
    names = ranking.answer.assembly.names
    parts = dict(zip(names, np.nan_to_num(ranking.by_duals).tolist(), strict=True))
    joints = {
        frozenset(names[k] for k in pair): float(value)
        for pair, value in zip(ranking.joints.tolist(), ranking.joint_looser, strict=True)
    }
    alone = [t for t in given if t.outline is not None and _loose(t)]
    shared = (drawing, tuple(given), ranking.answer.goals, ranking.answer.objective or 0.0)
    results = ParallelRun(workers, None, stop).each(one_outline, shared, alone)
    outlines = dict(zip(alone, results, strict=True))
    slopes = []
    for t in given:
        if len(t.parts) == 2:
            slopes.append(joints.get(frozenset(t.parts), 0.0))
        elif t.outline is None:
            slopes.append(2 * parts[t.parts[0]])  # extra gap e is an outline e/2 further in
        else:
            slopes.append(outlines.get(t) or 0.0)
    return slopes, None not in results


def one_outline(shared: tuple[Drawing, tuple[Tolerance, ...], tuple[Goal, ...], float], loose: Tolerance) -> float:
    """Motion gained per mm when one tolerance alone is at its loose end."""
    drawing, given, goals, value = shared
    made = _made(drawing, [(t, _loose(t) if t == loose else 0.0) for t in given])
    answer = witness(made, goals)
    return math.inf if answer.objective is None else max(answer.objective - value, 0.0) / abs(_loose(loose))
