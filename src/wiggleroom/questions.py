"""Reading, the largest motion and what comes apart, in the plane and in space: each is handed to the functions of its dimension."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.deadline import Deadline
from wiggleroom.drawing.dimension import is_spatial_file
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly

if TYPE_CHECKING:
    from wiggleroom.disassembly.interlock_result import Interlock
    from wiggleroom.freespace.models.pair_models import PairModel
    from wiggleroom.search.answer import Answer
    from wiggleroom.search.prepare import Prepared
    from wiggleroom.search.progress import Progress


def read(
    path: str | PathLike[str],
    gap: float | None = None,
    unit: str | None = None,
    flatten: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    only: Sequence[str] = (),
    skip: Sequence[str] = (),
    join: float | None = None,
    solid: Sequence[str] = (),
    stop: Stop | None = None,
    hole: Sequence[str] = (),
    dpi: float | None = None,
    overlapping: bool = False,
) -> Assembly | SpatialAssembly:
    """Assembly from a file: a drawing or a file of format wiggleroom/1 in the plane, one of format wiggleroom/2 in space.

    Parameters
    ----------
    path : str or path
        Assembly file (.json) or drawing (.svg, .dxf, .lbrn2).
    gap : float, optional [mm]
        In place of the file's.
    unit : str, optional
        In place of the drawing's: mm, cm, m, in, px or pt; drawings only.
    flatten : float, optional [mm]
        Largest distance between a curve and the straight edges that replace it; drawings only.
    fix : sequence of names
        Parts that stand, besides those the file fixes.
    goals : sequence of Pull or Turn
        In place of the file's, where there are any.
    only, skip, join, solid, hole, dpi
        Of drawings only: see `wiggleroom.assembly.build.read`.
    stop : optional
        Anything with `is_set()`; files in space are read in one go.
    overlapping : bool
        Accept parts of a drawing that overlap, for `allowable_gap` with `fits`.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    StoppedError
        If it was asked to stop.
    """
    if is_spatial_file(path):
        from wiggleroom.spatial.solids.spatial_assembly import read_spatial_assembly

        refuse_planar_options(
            "read", unit=unit, flatten=flatten, only=only, skip=skip, join=join, solid=solid, hole=hole, dpi=dpi
        )
        return read_spatial_assembly(Path(path), gap=gap, fix=fix, goals=goals)
    from wiggleroom.assembly.build import read as read_planar

    return read_planar(path, gap, unit, flatten, fix, goals, only, skip, join, solid, stop, hole, dpi, overlapping)


@overload
def flex(
    assembly: SpatialAssembly,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    solver: str = ...,
    search: int | None = ...,
    stop: Stop | None = ...,
    progress: Callable[..., None] | None = ...,
) -> Answer[SpatialAssembly]: ...
@overload
def flex(
    assembly: Assembly | Prepared,
    goals: Goal | Sequence[Goal] | None = None,
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
    assembly: Assembly | Prepared | SpatialAssembly,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = None,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[..., None] | None = None,
) -> Answer[Any]:
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
    Answer

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
        from wiggleroom.spatial.spatial_flex import flex_spatial

        refuse_planar_options("flex", model=model, start=start, prove=prove, seconds=seconds)
        return flex_spatial(assembly, goals, solver=solver, search=search, bound=True, stop=stop, progress=progress)
    from wiggleroom.maximise import flex as flex_planar

    options = given(seconds=seconds) | {"stop": stop, "progress": progress}
    return flex_planar(assembly, goals, model=model, solver=solver, start=start, search=search, prove=prove, **options)


@overload
def check(
    assembly: SpatialAssembly,
    *,
    stop: Stop | None = ...,
    progress: Callable[[Progress], None] | None = ...,
    every: bool = ...,
    seconds: float | None = ...,
) -> Interlock[SpatialAssembly]: ...
@overload
def check(
    assembly: Assembly,
    *,
    stop: Stop | None = ...,
    progress: Callable[[Progress], None] | None = ...,
    boxes: int | None = ...,
    questions: int | None = ...,
    every: bool = ...,
    seconds: float | None = ...,
) -> Interlock: ...
def check(
    assembly: Assembly | SpatialAssembly,
    *,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    boxes: int | None = None,
    questions: int | None = None,
    every: bool = True,
    seconds: float | None = None,
) -> Interlock[Any]:
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
    Interlock

    Raises
    ------
    InputError
        If there is only one part, or all are fixed.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> str(wr.check(wr.patterns.chain(3, joint="finger", gap=0.02)).verdict)
    'comes apart'
    """
    if isinstance(assembly, SpatialAssembly):
        from wiggleroom.spatial.spatial_disassembly import check_spatial

        refuse_planar_options("check", boxes=boxes, questions=questions)
        return check_spatial(assembly, stop=stop if seconds is None else Deadline(seconds, stop), every=every)
    from wiggleroom.disassembly.interlock import check as check_planar

    options = given(boxes=boxes, questions=questions)
    return check_planar(assembly, stop=stop, progress=progress, every=every, seconds=seconds, **options)


def refuse_planar_options(question: str, **given: Any) -> None:
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


def given(**options: Any) -> dict[str, Any]:
    """Options that were given, so that those left out keep their defaults."""
    return {name: value for name, value in options.items() if value is not None}
