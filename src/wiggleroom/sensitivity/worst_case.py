"""Largest and smallest motion that tolerances allow, in the plane and in space, and which of them contribute.

The loosest corner of the tolerances has every outline or face as far in, and every joint as wide, as they allow. There each part lies
inside itself as it is anywhere else within the tolerances. So every motion that is possible somewhere within them is possible at that
corner: it is the worst case, whatever the derivatives are. What is searched is only the largest motion at it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.statements import unknown
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.displayable import Drawable
from wiggleroom.drawing.model import Drawing, JointGap, Part, Plate, Tolerance
from wiggleroom.errors import InputError, Stop, StoppedError, go_on
from wiggleroom.parallel.parallel_run import StopHere, run_each
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.gap_study import GapStudy
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
        Everything at its nominal value.
    loosest : Answer
        Every outline as far in, and every joint as wide, as allowed: the worst case.
    tightest : Answer or None
        Every outline as far out, and every joint as narrow, as allowed; None if parts then do not fit beside each other, see `misfit`.
    misfit : str
        Reason if they do not fit.
    contributions : tuple of Contribution
        Contributions of the tolerances, the largest first.
    limit : float or None
        Largest motion that is wanted.
    stopped : bool
        True if stopped before everything was computed.
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
    study: GapStudy[Any],
    tolerances: Sequence[Tolerance] | None = None,
    *,
    limit: float | None = None,
    context: Context = UNLIMITED,
) -> WorstCase:
    """Largest and smallest motion within tolerances; see `wiggleroom.worst_case`.

    Parameters
    ----------
    study : GapStudy
        Of the assembly, and what is asked of it.
    tolerances : sequence of Tolerance, optional
        By default those of the assembly's file.
    limit : float, optional
        Largest motion that is wanted.
    context : Context, optional
        Where single outlines are solved, and what stops it.

    Raises
    ------
    InputError
        If there are no tolerances, a name is unknown, parts do not fit even where they should be, or nothing stops the motion there.
    """
    given = tuple(study.assembly.drawing.tolerances if tolerances is None else tolerances)
    _check_question(given, limit)
    ranking = rank(_made(study, [(t, 0.0) for t in given], context.stop), context=Context(stop=context.stop))
    nominal = ranking.answer
    loosest = _corner(_made(study, [(t, _loose(t)) for t in given], context.stop), nominal, limit, context)
    tightest, misfit = None, ""
    try:
        tightest = _made(study, [(t, -_opposite(t)) for t in given], context.stop).flexed(None, context)
    except InputError as problem:
        misfit = problem.findings[0]
    except StoppedError:
        misfit = "stopped before it was worked out"
    slopes, whole = _slopes(study, given, ranking, context)
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


def _made(study: GapStudy[Any], deviations: Sequence[tuple[Tolerance, float]], stop: Stop | None) -> GapStudy[Any]:
    """The same question of an assembly that is off from where it should be."""
    return study.made_of(deviated(study.assembly.drawing, deviations), stop)


def _corner(made: GapStudy[Any], nominal: Answer, limit: float | None, context: Context) -> Answer:
    """Answer at the loose corner; never less than the nominal motion, which is free for the smaller parts too.

    With a bound below the limit, where one can be proven with little work.
    """
    found = made.flexed(None, context)
    if found.objective is not None and found.objective < (nominal.objective or 0.0):
        found = replace(nominal, assembly=found.assembly, at_most=found.at_most, bound=found.bound)
    value, most = found.objective, found.at_most
    if limit is None or value is None or not 0 < value < limit or (most is not None and most <= limit):
        return found
    return made.with_bound(found, min(0.9 * (limit / value - 1), 9.0), context.silent)


def _slopes(
    study: GapStudy[Any], given: tuple[Tolerance, ...], ranking: Ranking, context: Context
) -> tuple[list[float], bool]:
    """Motion gained per mm of looser tolerance: of parts and joints from the forces, where single faces move from solving again."""
    names = ranking.answer.assembly.names
    parts = dict(zip(names, np.nan_to_num(ranking.by_duals).tolist(), strict=True))
    joints = {
        frozenset(names[k] for k in pair): float(value)
        for pair, value in zip(ranking.joints.tolist(), ranking.joint_looser, strict=True)
    }
    plates = {part.name for part in study.assembly.drawing.parts if isinstance(part.solid, Plate)}
    single = {t for t in given if t.outline is not None or (len(t.parts) == 1 and t.parts[0] in plates)}
    alone = [t for t in given if t in single and _loose(t)]
    results: list[float | None] = [None] * len(alone)
    with suppress(StoppedError):
        fresh = study.made_of(study.assembly.drawing, context.stop)  # what was prepared for the other stays here
        shared = fresh, given, ranking.answer.objective or 0.0, StopHere(context.stop)
        results = run_each(one_alone, shared, alone, context)
    outlines = dict(zip(alone, results, strict=True))
    slopes = []
    for t in given:
        if len(t.parts) == 2:
            slopes.append(joints.get(frozenset(t.parts), 0.0))
        elif t not in single:
            slopes.append(2 * parts[t.parts[0]])  # extra gap e is an outline e/2 further in
        else:
            slopes.append(outlines.get(t) or 0.0)
    return slopes, None not in results


def one_alone(shared: tuple[GapStudy[Any], tuple[Tolerance, ...], float, StopHere], loose: Tolerance) -> float:
    """Motion gained per mm when one tolerance alone is at its loose end.

    Raises
    ------
    StoppedError
        If it was asked to stop: what was found by then is no slope.
    """
    study, given, value, stop = shared
    made = _made(study, [(t, _loose(t) if t == loose else 0.0) for t in given], stop)
    answer = made.flexed(0, Context(stop=stop))
    go_on(stop)
    return math.inf if answer.objective is None else max(answer.objective - value, 0.0) / abs(_loose(loose))


def deviated(drawing: Drawing, deviations: Sequence[tuple[Tolerance, float]]) -> Drawing:
    """Drawing in which each tolerance's part, outline or joint is off by so much [mm] from its nominal.

    Positive is out of the material for parts and outlines, and wider for the gap of a joint.

    Raises
    ------
    InputError
        If a part or an outline is not there.

    Examples
    --------
    >>> import numpy as np
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> grown = deviated(Drawing((Part("a", (square,)),)), [(Tolerance(("a",), 0.1, 0.1, outline=1), 0.1)])
    >>> grown.parts[0].outline_offsets
    (0.1,)
    """
    parts = {part.name: part for part in drawing.parts}
    findings = [f"tolerance: {unknown(name, parts)}" for t, _ in deviations for name in t.parts if name not in parts]
    findings += [
        f'tolerance: part "{t.parts[0]}" {lacks}'
        for t, _ in deviations
        if t.parts[0] in parts and (lacks := _lacking(parts[t.parts[0]], t.outline))
    ]
    if findings:
        raise InputError(findings)
    gaps = {frozenset(joint.parts): joint for joint in drawing.gaps}
    for tolerance, off in deviations:
        name = tolerance.parts[0]
        if len(tolerance.parts) == 2:
            pair = frozenset(tolerance.parts)
            own = gaps[pair].gap if pair in gaps else drawing.gap
            nominal = own if tolerance.nominal is None else tolerance.nominal
            gaps[pair] = JointGap(tolerance.parts, max(nominal + off, 0.0))
        elif tolerance.outline == "thickness":
            parts[name] = _thickened(parts[name], tolerance.nominal, off)
        elif tolerance.outline is not None:
            parts[name] = _outline_moved(parts[name], tolerance.outline, (tolerance.nominal or 0.0) + off)
        else:
            nominal = parts[name].offset if tolerance.nominal is None else tolerance.nominal
            parts[name] = replace(parts[name], offset=nominal + off)
    return replace(drawing, parts=tuple(parts.values()), gaps=tuple(gaps.values()))


def _count(part: Part) -> int:
    regions = part.solid.regions if isinstance(part.solid, Plate) else part.regions
    return sum(1 + len(region.holes) for region in regions)


def _lacking(part: Part, outline: int | str | None) -> str:
    """What a tolerance of an outline, or of the thickness, misses in a part."""
    if outline == "thickness":
        return "" if isinstance(part.solid, Plate) else "has no thickness: it is no plate in space"
    return f"has {_count(part)} outlines, not {outline}" if isinstance(outline, int) and outline > _count(part) else ""


def _thickened(part: Part, nominal: float | None, more: float) -> Part:
    """A plate that is thicker, its middle where it was."""
    assert isinstance(part.solid, Plate)  # see `_lacking`
    thickness = max((part.solid.thickness if nominal is None else nominal) + more, 0.0)
    down = part.R[:, 2] * (part.solid.thickness - thickness) / 2
    at = tuple((np.asarray(part.at) + down).tolist())
    return replace(part, solid=Plate(part.solid.regions, thickness), at=at)


def _outline_moved(part: Part, number: int, outward: float) -> Part:
    """The part with one of its outlines moved out of the material."""
    offsets = list(part.outline_offsets or (0.0,) * _count(part))
    offsets[number - 1] += outward
    return replace(part, outline_offsets=tuple(offsets))
