"""Questions about the gap, of drawings and of assemblies in space: each is handed to the functions of its dimension."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.deadline import Deadline
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import Stop
from wiggleroom.questions import given, refuse_planar_options
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.search.prepare import Prepared
    from wiggleroom.search.progress import Progress
    from wiggleroom.sensitivity.gap_distribution import Spread
    from wiggleroom.sensitivity.gap_trials import AllowableGap
    from wiggleroom.sensitivity.rank import Ranking
    from wiggleroom.sensitivity.sample import Sample
    from wiggleroom.sensitivity.sweep import Sweep, SweepStep
    from wiggleroom.sensitivity.tighten import Tightening


def sweep(
    assembly: Assembly | SpatialAssembly,
    gaps: Sequence[float] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, NDArray[np.float64] | None], None] | None = None,
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
        from wiggleroom.spatial.spatial_study import sweep_spatial

        refuse_planar_options("sweep", prove=prove, seconds=seconds)
        return sweep_spatial(assembly, gaps, goals, stop=stop, progress=progress, each=each)
    from wiggleroom.sensitivity.sweep import sweep as sweep_planar

    options = given(seconds=seconds)
    return sweep_planar(assembly, gaps, goals, prove=prove, stop=stop, progress=progress, each=each, **options)


def rank(
    question: Assembly | Prepared | SpatialAssembly | Answer[Any],
    goals: Goal | Sequence[Goal] | None = None,
    **options: Any,
) -> Ranking:
    """Importance of every part's gap, and of every joint's, for the largest motion.

    Parameters
    ----------
    question : Assembly, SpatialAssembly, Prepared or Answer
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

    return work_out(_study(question, goals), None if _in_space(question) else goals, **options)


def tighten(
    assembly: Assembly | SpatialAssembly | Answer[Any],
    goals: Goal | Sequence[Goal] | None = None,
    **options: Any,
) -> Tightening:
    """Which parts to make tighter for the least motion, or the fewest for a wanted limit.

    Parameters
    ----------
    assembly : Assembly, SpatialAssembly or Answer
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

    return work_out(_study(assembly, goals), None if _in_space(assembly) else goals, **options)


def sample(
    assembly: Assembly | SpatialAssembly | Answer[Any],
    spread: Spread | float,
    goals: Goal | Sequence[Goal] | None = None,
    **options: Any,
) -> Sample:
    """Largest motion when the gap round every part varies at random.

    Parameters
    ----------
    assembly : Assembly, SpatialAssembly or Answer
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

    return work_out(_study(assembly, goals), spread, None if _in_space(assembly) else goals, **options)


def allowable_gap(
    assembly: Assembly | SpatialAssembly, goals: Goal | Sequence[Goal] | None = None, **options: Any
) -> AllowableGap:
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
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_study import spatial_allowable_gap

        return spatial_allowable_gap(assembly, goals, **options)
    from wiggleroom.sensitivity.allowable_gap import allowable_gap as work_out

    return work_out(assembly, goals, **options)


def largest_gap(
    assembly: Assembly | SpatialAssembly,
    *,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
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
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_study import spatial_largest_gap

        return spatial_largest_gap(assembly, stop=stop if seconds is None else Deadline(seconds, stop))
    from wiggleroom.disassembly.largest_gap import largest_gap as work_out

    return work_out(assembly, stop=stop, progress=progress, seconds=seconds)


def _study(question: Any, goals: Goal | Sequence[Goal] | None) -> Any:
    """What a study asks: an assembly of the plane itself, of space its study."""
    if not _in_space(question):
        return question
    from wiggleroom.spatial.spatial_study import SpatialStudy, spatial_study_of

    if isinstance(question, Answer):
        return SpatialStudy(question.assembly, question.goals, question)
    return spatial_study_of(question, goals)


def _in_space(question: Any) -> bool:
    return isinstance(question.assembly if isinstance(question, Answer) else question, SpatialAssembly)
