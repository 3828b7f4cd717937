"""The questions anyone may ask, of drawings and of assemblies in space: each is put to the code of its dimension here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.errors import InputError
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_goals import AnyGoal, spatial_goals
from wiggleroom.spatial.spatial_model import SpatialAssembly

if TYPE_CHECKING:
    from wiggleroom.sensitivity.sweep import Sweep


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
        Of drawings alone: see `wiggleroom.assembly.build.read`.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    """
    if is_spatial_file(path):
        from wiggleroom.spatial.spatial_assembly import read_spatial_assembly

        return read_spatial_assembly(Path(path), gap=gap, fix=fix, goals=spatial_goals(tuple(goals)) or ())
    from wiggleroom.assembly.build import read as read_planar

    return read_planar(path, gap, unit, flatten, fix, goals, **options)


def is_spatial_file(path: str | PathLike[str]) -> bool:
    """True for a file of format wiggleroom/2."""
    path = Path(path)
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    from wiggleroom.drawing.source import load
    from wiggleroom.spatial.spatial_file import is_spatial

    return is_spatial(load(path, opening="{[", name="assembly"))


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
        In the plane those of `wiggleroom.maximise.flex`; in space `stop` and `progress`.

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
        from wiggleroom.spatial.spatial_flex import flex_spatial

        return flex_spatial(assembly, spatial_goals(goals), **options)
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
