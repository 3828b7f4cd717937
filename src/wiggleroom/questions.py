"""The questions anyone may ask, of drawings and of assemblies in space: each is handed to the functions of its dimension."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.dimension import is_spatial_file
from wiggleroom.errors import InputError
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_goals import AnyGoal, spatial_goals
from wiggleroom.spatial.spatial_model import SpatialAssembly

if TYPE_CHECKING:
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.sensitivity.gap_distribution import Spread
    from wiggleroom.sensitivity.gap_trials import AllowableGap
    from wiggleroom.sensitivity.rank import Ranking
    from wiggleroom.sensitivity.sample import Sample
    from wiggleroom.sensitivity.sweep import Sweep
    from wiggleroom.sensitivity.tighten import Tightening


def read(
    path: str | PathLike[str],
    gap: float | None = None,
    unit: str | None = None,
    flatten: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Any] = (),
    **options: Any,
) -> Assembly | SpatialAssembly:
    """Assembly from a file: a drawing or a file of format wiggleroom/1 in the plane, one of format wiggleroom/2 in space.

    Parameters
    ----------
    path : str or path
        Assembly file (.json) or drawing (.svg, .dxf, .lbrn2).
    gap : float, optional [mm]
        In place of the file's.
    unit : str, optional
        In place of the drawing's: mm, cm, m, in or px.
    flatten : float, optional [mm]
        Largest distance between a curve and the straight edges that replace it; drawings only.
    fix : sequence of names
        Parts that stand, besides those the file fixes.
    goals : sequence of Pull or Turn
        In place of the file's, where there are any.
    **options
        Of drawings alone, `stop` among them: see `wiggleroom.assembly.build.read`.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    StoppedError
        If it was asked to stop.
    """
    if is_spatial_file(path):
        from wiggleroom.spatial.spatial_assembly import read_spatial_assembly

        return read_spatial_assembly(Path(path), gap=gap, fix=fix, goals=spatial_goals(tuple(goals)) or ())
    from wiggleroom.assembly.build import read as read_planar

    return read_planar(path, gap, unit, flatten, fix, goals, **options)


@overload
def flex(
    assembly: SpatialAssembly, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any
) -> SpatialAnswer: ...
@overload
def flex(assembly: Any, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any) -> Answer: ...
def flex(assembly: Any, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any) -> Answer | SpatialAnswer:
    """How far the assembly can move: the largest motion that was found and checked, and how sure it is.

    Parameters
    ----------
    assembly : Assembly, Prepared or SpatialAssembly
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for. In space `Pull("lid", (0, 0, 1))` and `Turn("lid", (0, 0, 1))`: a twist about a
        direction of the world.
    **options
        In the plane those of `wiggleroom.maximise.flex`; in space `solver`, `search`, `stop` and `progress`.

    Returns
    -------
    Answer or SpatialAnswer

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01))
    >>> round(answer.objective, 4)
    0.0261
    """
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.cross_section_bound import with_cross_section_bound
        from wiggleroom.spatial.spatial_flex import flex_spatial

        return with_cross_section_bound(flex_spatial(assembly, spatial_goals(goals), **options), options.get("stop"))
    from wiggleroom.maximise import flex as flex_planar

    return flex_planar(assembly, goals, **options)  # type: ignore[arg-type]


def check(assembly: Any, *, stop: Any = None, progress: Callable[[Any], None] | None = None, **options: Any) -> Any:
    """Whether some parts can be moved without limit away from the others.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    stop, progress : optional
        In space only `stop` is asked.
    **options
        In the plane those of `wiggleroom.disassembly.interlock.check`.

    Returns
    -------
    Interlock or SpatialDisassembly
    """
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_disassembly import check_spatial

        return check_spatial(assembly, stop=stop)
    from wiggleroom.disassembly.interlock import check as check_planar

    return check_planar(assembly, stop=stop, progress=progress, **options)


def sweep(
    assembly: Any,
    gaps: Sequence[float] | None = None,
    goals: AnyGoal | Sequence[AnyGoal] | None = None,
    **options: Any,
) -> Sweep:
    """Largest motion for several gaps, and the gap from which on nothing stops it.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    gaps : sequence of float, optional [mm]
        In place of the file's gap, in any order; by default nine from a quarter of it to twice it.
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    **options
        `prove` and `seconds` (drawings only), `stop`, `progress` and `each`, see `wiggleroom.sensitivity.sweep.sweep`.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        If a gap makes no sense, or nothing is fixed or pulled.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.sweep(wr.patterns.chain(2, joint="tee"), [0.01, 0.02])
    >>> [round(step.objective, 4) for step in found.steps]
    [0.0261, 0.0539]
    """
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_sweep import sweep_spatial

        if options.pop("prove", None) is not None:
            raise InputError("sweep: a bound is proven for drawings only, not for assemblies in space: leave out prove")
        options.pop("seconds", None)
        return sweep_spatial(assembly, gaps, spatial_goals(goals), **options)
    from wiggleroom.sensitivity.sweep import sweep as sweep_planar

    return sweep_planar(assembly, gaps, goals, **options)  # type: ignore[arg-type]


def rank(question: Any, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any) -> Ranking:
    """Importance of every part's gap, and of every joint's, for the largest motion.

    Parameters
    ----------
    question : Assembly, Prepared, Answer, SpatialAssembly or SpatialAnswer
        An answer is ranked as it is; else the motion is looked for first.
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    **options
        `by`, `exact`, `workers`, `cluster`, `stop` and `progress`, see `wiggleroom.sensitivity.rank.rank`.

    Returns
    -------
    Ranking

    Raises
    ------
    InputError
        If nothing stops the motion or the search for it was cut short.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> ranking = wr.rank(wr.patterns.chain(5, joint="tee", gap=0.01))
    >>> [ranking.answer.assembly.names[k] for k in ranking.order]
    ['b2', 'b3', 'b1', 'b4', 'b5']
    """
    from wiggleroom.sensitivity.rank import rank as work_out

    return work_out(_study(question, goals), None if _in_space(question) else goals, **options)  # type: ignore[arg-type]


def tighten(assembly: Any, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any) -> Tightening:
    """Which parts to make tighter for the least motion, or the fewest for a wanted limit.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    **options
        `parts` or `limit`, `gap`, `draws`, `seed` and more, see `wiggleroom.sensitivity.tighten.tighten`.

    Returns
    -------
    Tightening

    Raises
    ------
    InputError
        If neither or both of `parts` and `limit` are given, or a number makes no sense, or nothing stops the motion.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> better = wr.tighten(wr.patterns.chain(5, joint="tee", gap=0.01), parts=2, draws=5)
    >>> better.chosen, round(better.lowered)
    (('b2', 'b3'), 55)
    """
    from wiggleroom.sensitivity.tighten import tighten as work_out

    return work_out(_study(assembly, goals), None if _in_space(assembly) else goals, **options)  # type: ignore[arg-type]


def sample(
    assembly: Any, spread: Spread | float, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any
) -> Sample:
    """Largest motion when the gap round every part varies at random.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    spread : Spread or float [mm]
        Distribution of the extra gap round a part; a number is the standard deviation of a normal one. Extra gap e
        moves the part's boundary inward by e/2, in space all its faces.
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    **options
        `draws`, `seed`, `limit` and more, see `wiggleroom.sensitivity.sample.sample`.

    Returns
    -------
    Sample

    Raises
    ------
    InputError
        If numbers make no sense, or nothing stops the motion without variation.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> some = wr.sample(wr.patterns.chain(3, joint="tee", gap=0.02), 0.002, draws=20, limit=0.3)
    >>> some.good, some.misfits
    (20, 0)
    """
    from wiggleroom.sensitivity.sample import sample as work_out

    return work_out(_study(assembly, goals), spread, None if _in_space(assembly) else goals, **options)  # type: ignore[arg-type]


def allowable_gap(assembly: Any, goals: AnyGoal | Sequence[AnyGoal] | None = None, **options: Any) -> AllowableGap:
    """Gap at which a motion stays below a limit, parts interlock, or parts that were cut too large still fit.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
        Its own gap is where the search begins.
    goals : Pull, Turn and others, or several that add up
        For `at_most`; by default what the assembly's file asks for.
    **options
        One of `at_most`, `holds` and `fits` (of drawings); `seconds`, `stop` and `progress`: see
        `wiggleroom.sensitivity.allowable_gap.allowable_gap`.

    Returns
    -------
    AllowableGap

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
    if _in_space(assembly):
        from wiggleroom.spatial.spatial_study import spatial_allowable_gap

        return spatial_allowable_gap(assembly, spatial_goals(goals), **options)
    from wiggleroom.sensitivity.allowable_gap import allowable_gap as work_out

    return work_out(assembly, goals, **options)  # type: ignore[arg-type]


def largest_gap(assembly: Any, *, stop: Any = None, seconds: float | None = None, **options: Any) -> LargestGap:
    """The gap of the whole assembly at which it comes apart, to 0.1 %.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
        Its own gap is where the search begins.
    stop : optional
        Anything with `is_set()`.
    seconds : float, optional
        Time that it may take; then both sides are those that are known so far.
    **options
        In the plane `progress`, see `wiggleroom.disassembly.largest_gap.largest_gap`.

    Returns
    -------
    LargestGap

    Raises
    ------
    InputError
        As for `check`.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> wr.largest_gap(wr.patterns.chain(2, joint="finger", gap=0.02)).holds is None
    True
    """
    if _in_space(assembly):
        from wiggleroom.deadline import Deadline
        from wiggleroom.spatial.spatial_study import spatial_largest_gap

        return spatial_largest_gap(assembly, stop=stop if seconds is None else Deadline(seconds, stop))
    from wiggleroom.disassembly.largest_gap import largest_gap as work_out

    return work_out(assembly, stop=stop, seconds=seconds, **options)


def _in_space(question: Any) -> bool:
    return isinstance(question, SpatialAssembly | SpatialAnswer)


def _study(question: Any, goals: AnyGoal | Sequence[AnyGoal] | None) -> Any:
    """What a study asks: an assembly of the plane itself, of space its model."""
    if not _in_space(question):
        return question
    from wiggleroom.spatial.spatial_study import SpatialStudy, spatial_study_of

    if isinstance(question, SpatialAnswer):
        return SpatialStudy(question.assembly, question.goals, question)
    return spatial_study_of(question, spatial_goals(goals))
