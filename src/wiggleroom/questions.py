"""The questions anyone may ask, of drawings and of assemblies in space: each is handed to the functions of its dimension."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.deadline import Deadline
from wiggleroom.drawing.dimension import is_spatial_file
from wiggleroom.errors import InputError, Stop
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.solids.spatial_goals import AnyGoal, spatial_goals
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_answer import SpatialAnswer

if TYPE_CHECKING:
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.freespace.models.pair_models import PairModel
    from wiggleroom.sensitivity.gap_distribution import Spread
    from wiggleroom.sensitivity.gap_trials import AllowableGap
    from wiggleroom.sensitivity.rank import Ranking
    from wiggleroom.sensitivity.sample import Sample
    from wiggleroom.sensitivity.sweep import Sweep, SweepStep
    from wiggleroom.sensitivity.tighten import Tightening


def read(
    path: str | PathLike[str],
    gap: float | None = None,
    unit: str | None = None,
    flatten: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Any] = (),
    only: Sequence[str] = (),
    skip: Sequence[str] = (),
    join: float | None = None,
    solid: Sequence[str] = (),
    stop: Stop | None = None,
) -> Assembly | SpatialAssembly:
    """Assembly from a file: a drawing or a file of format wiggleroom/1 in the plane, one of format wiggleroom/2 in space.

    Parameters
    ----------
    path : str or path
        Assembly file (.json) or drawing (.svg, .dxf, .lbrn2).
    gap : float, optional [mm]
        In place of the file's.
    unit : str, optional
        In place of the drawing's: mm, cm, m, in or px; drawings only.
    flatten : float, optional [mm]
        Largest distance between a curve and the straight edges that replace it; drawings only.
    fix : sequence of names
        Parts that stand, besides those the file fixes.
    goals : sequence of Pull or Turn
        In place of the file's, where there are any.
    only, skip, join, solid
        Of drawings only: see `wiggleroom.assembly.build.read`.
    stop : optional
        Anything with `is_set()`; files in space are read in one go.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    StoppedError
        If it was asked to stop.
    """
    if is_spatial_file(path):
        from wiggleroom.spatial.solids.spatial_assembly import read_spatial_assembly

        _check_spatial("read", unit=unit, flatten=flatten, only=only, skip=skip, join=join, solid=solid)
        return read_spatial_assembly(Path(path), gap=gap, fix=fix, goals=spatial_goals(tuple(goals)) or ())
    from wiggleroom.assembly.build import read as read_planar

    return read_planar(path, gap, unit, flatten, fix, goals, only, skip, join, solid, stop)


@overload
def flex(
    assembly: SpatialAssembly,
    goals: AnyGoal | Sequence[AnyGoal] | None = None,
    *,
    solver: str = ...,
    search: int | None = ...,
    stop: Stop | None = ...,
    progress: Callable[..., None] | None = ...,
) -> SpatialAnswer: ...
@overload
def flex(
    assembly: Any,
    goals: AnyGoal | Sequence[AnyGoal] | None = None,
    *,
    model: str | PairModel | None = ...,
    solver: str = ...,
    start: Answer | None = ...,
    search: int | None = ...,
    prove: float | None = ...,
    seconds: float | None = ...,
    stop: Stop | None = ...,
    progress: Callable[..., None] | None = ...,
) -> Answer: ...
def flex(
    assembly: Any,
    goals: AnyGoal | Sequence[AnyGoal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = None,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[..., None] | None = None,
) -> Answer | SpatialAnswer:
    """How far the assembly can move: the largest motion that was found and checked, and how sure it is.

    Parameters
    ----------
    assembly : Assembly, Prepared or SpatialAssembly
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for. In space `Pull("lid", (0, 0, 1))` and `Turn("lid", (0, 0, 1))`: a twist about a
        direction of the world.
    solver, search, stop, progress : optional
        As of `wiggleroom.maximise.flex`; in space `progress` is called with the number of iterations and the value.
    model, start, prove, seconds : optional
        Of drawings only: see `wiggleroom.maximise.flex`.

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

        _check_spatial("flex", model=model, start=start, prove=prove, seconds=seconds)
        answer = flex_spatial(
            assembly, spatial_goals(goals), solver=solver, search=search, stop=stop, progress=progress
        )
        return with_cross_section_bound(answer, stop)
    from wiggleroom.maximise import flex as flex_planar

    options = _given(seconds=seconds) | {"stop": stop, "progress": progress}
    return flex_planar(assembly, goals, model=model, solver=solver, start=start, search=search, prove=prove, **options)  # type: ignore[arg-type]


def check(
    assembly: Any,
    *,
    stop: Stop | None = None,
    progress: Callable[[Any], None] | None = None,
    boxes: int | None = None,
    questions: int | None = None,
    every: bool = True,
    seconds: float | None = None,
) -> Any:
    """Whether some parts can be moved without limit away from the others.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    stop : optional
        Anything with `is_set()`.
    progress : optional
        Called as it goes on; not in space.
    boxes, questions : int, optional
        Of drawings only: see `wiggleroom.disassembly.interlock.check`.
    every : bool
        False: the first path out is enough.
    seconds : float, optional
        Time that it may take.

    Returns
    -------
    Interlock or SpatialDisassembly

    Raises
    ------
    InputError
        If there is only one part, or all are fixed.
    """
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_disassembly import check_spatial

        _check_spatial("check", boxes=boxes, questions=questions)
        return check_spatial(assembly, stop=stop if seconds is None else Deadline(seconds, stop), every=every)
    from wiggleroom.disassembly.interlock import check as check_planar

    options = _given(boxes=boxes, questions=questions)
    return check_planar(assembly, stop=stop, progress=progress, every=every, seconds=seconds, **options)


def sweep(
    assembly: Any,
    gaps: Sequence[float] | None = None,
    goals: AnyGoal | Sequence[AnyGoal] | None = None,
    *,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, Any], None] | None = None,
) -> Sweep:
    """Largest motion for several gaps, and the gap from which on nothing stops it.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    gaps : sequence of float, optional [mm]
        In place of the file's gap, in any order; by default nine from a quarter of it to twice it.
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    stop, progress, each : optional
        See `wiggleroom.sensitivity.sweep.sweep`.
    prove, seconds : float, optional
        Of drawings only: see `wiggleroom.sensitivity.sweep.sweep`.

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

        _check_spatial("sweep", prove=prove, seconds=seconds)
        return sweep_spatial(assembly, gaps, spatial_goals(goals), stop=stop, progress=progress, each=each)
    from wiggleroom.sensitivity.sweep import sweep as sweep_planar

    options = _given(seconds=seconds)
    return sweep_planar(assembly, gaps, goals, prove=prove, stop=stop, progress=progress, each=each, **options)  # type: ignore[arg-type]


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
    assembly : Assembly, Answer, SpatialAssembly or SpatialAnswer
        An answer is studied as it is; else the motion is looked for first.
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
    assembly : Assembly, Answer, SpatialAssembly or SpatialAnswer
        An answer is studied as it is; else the motion is looked for first.
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


def largest_gap(
    assembly: Any,
    *,
    stop: Stop | None = None,
    progress: Callable[[Any], None] | None = None,
    seconds: float | None = None,
) -> LargestGap:
    """The gap of the whole assembly at which it comes apart, to 0.1 %.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
        Its own gap is where the search begins.
    stop : optional
        Anything with `is_set()`.
    seconds : float, optional
        Time that it may take; then both sides are those that are known so far.
    progress : optional
        Called as it goes on; not in space.

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
        from wiggleroom.spatial.spatial_study import spatial_largest_gap

        return spatial_largest_gap(assembly, stop=stop if seconds is None else Deadline(seconds, stop))
    from wiggleroom.disassembly.largest_gap import largest_gap as work_out

    return work_out(assembly, stop=stop, progress=progress, seconds=seconds)


def _check_spatial(question: str, **given: Any) -> None:
    """Check that no option of drawings was given for an assembly in space.

    Raises
    ------
    InputError
        If one was.
    """
    named = ", ".join(name for name, value in given.items() if value is not None and value != ())
    if named:
        wrong = f"{question}: {named}: for drawings only, not for assemblies in space: leave it out"
        raise InputError(wrong)


def _given(**options: Any) -> dict[str, Any]:
    """Options that were given, so that those left out keep their defaults."""
    return {name: value for name, value in options.items() if value is not None}


def _in_space(question: Any) -> bool:
    return isinstance(question, SpatialAssembly | SpatialAnswer)


def _study(question: Any, goals: AnyGoal | Sequence[AnyGoal] | None) -> Any:
    """What a study asks: an assembly of the plane itself, of space its study."""
    if not _in_space(question):
        return question
    from wiggleroom.spatial.spatial_study import SpatialStudy, spatial_study_of

    if isinstance(question, SpatialAnswer):
        return SpatialStudy(question.assembly, question.goals, question)
    return spatial_study_of(question, spatial_goals(goals))
