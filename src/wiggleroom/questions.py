"""Reading, making, the largest motion and what comes apart, in the plane and in space: each is handed to the functions of its dimension."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.drawing.dimension import is_spatial_file
from wiggleroom.drawing.model import Drawing, Goal, part_of
from wiggleroom.errors import InputError, Stop, go_on

if TYPE_CHECKING:
    from wiggleroom.disassembly.interlock_result import Interlock
    from wiggleroom.disassembly.largest_gap import LargestGap
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
) -> Assembly:
    """Read an assembly from a file: a drawing or a file of format wiggleroom/1 in the plane, one of format wiggleroom/2 in space.

    Parameters
    ----------
    path : str or path
        Assembly file (.json), drawing (.svg, .dxf, .lbrn2) or voxel puzzle (.puz, .xmpuzzle).
    gap : float, optional [mm]
        In place of the file's.
    unit : str, optional
        Replaces the drawing's: mm, cm, m, in, px or pt; drawings only.
    flatten : float, optional [mm]
        Largest distance between a curve and its polygon; drawings only.
    fix : sequence of names
        Fixed parts, besides those of the file.
    goals : sequence of Pull or Turn
        Replaces the file's question.
    only, skip : sequence of str
        Layers, colours or names of a drawing to read exclusively, or to leave out; drawings only, as all below.
    join : float, optional [mm]
        Join open ends nearer than this.
    solid, hole : sequence of str
        Outlines inside others to read as parts, not holes; outlines to cut out of the parts around or under them: names, points as
        "@12,30" [mm], or "all".
    dpi : float, optional
        Units of a drawing per inch, in place of `unit`.
    stop : optional
        Anything with `is_set()`.
    overlapping : bool
        Accept parts that overlap, for `clearances` and `allowable_gap` with `fits`; in space meshes are then not cut into pieces.

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
        return read_spatial_assembly(Path(path), gap=gap, fix=fix, goals=goals, overlapping=overlapping, stop=stop)
    from wiggleroom.assembly.build import assembly_of
    from wiggleroom.drawing import read_drawing
    from wiggleroom.drawing.strokes.read_options import ReadOptions
    from wiggleroom.drawing.units import unit_of

    named = [name for goal in goals if (name := part_of(goal)) is not None]  # any of these may be a point of a part
    options = ReadOptions(tuple(only), tuple(skip), join, (*solid, *fix, *named), stop, tuple(hole))
    drawing = read_drawing(Path(path), unit=unit_of(unit, dpi), flatten=flatten, gap=gap, options=options)
    go_on(stop)
    return assembly_of(drawing, gap=gap, fix=fix, goals=goals, overlapping=overlapping)


def assemble(
    drawing: Drawing,
    *,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    offset: Mapping[str, float] | None = None,
    overlapping: bool = False,
) -> Assembly:
    """Make the parts of a drawing, with their roles.

    Parameters
    ----------
    drawing : Drawing [mm]
    gap : float, optional [mm]
        In place of the drawing's.
    fix : sequence of names
        Fixed parts, besides those of the drawing.
    goals : sequence of Pull, Turn and others
        Replaces the drawing's question.
    offset : mapping of names to float, optional [mm]
        Extra offsets of single parts; drawings only.
    overlapping : bool
        See `read`.

    Raises
    ------
    InputError
        With everything that is wrong, one line each; an `OverlapError` where that is only that parts overlap.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> drawing = wr.patterns.chain(2, joint="tee", gap=0.02).drawing
    >>> wr.assemble(drawing, gap=0.01).gap
    0.01
    """
    if drawing.dimension == 3:
        from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

        refuse_planar_options("assemble", offset=offset)
        return assemble_spatial(drawing, gap=gap, fix=fix, goals=goals, overlapping=overlapping)
    from wiggleroom.assembly.build import assemble as assemble_planar

    return assemble_planar(drawing, gap=gap, fix=fix, goals=goals, offset=offset, overlapping=overlapping)


def flex(
    assembly: Assembly | Prepared,
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
) -> Answer:
    """Find the largest motion of the goals, checked, with a verdict on its certainty.

    Parameters
    ----------
    assembly : Assembly or Prepared
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file. In space `Pull("lid", (0, 0, 1))` and `Turn("lid", (0, 0, 1))`: a twist about a
        direction of the world.
    model : str, Hull or HalfPlane, optional
        For drawings only. "walls", the exact contacts; for comparison "hull", the paper's, or "halfplane", PuzzleFlex's: these accept
        some overlap, which the answer reports. By default the model of the prepared assembly, else walls.
    solver : str
        "interior-point", or "ipopt" (needs the extra `ipopt`); half-planes need neither.
    start : Answer, optional
        For drawings only: an earlier answer of the same prepared assembly, with walls; the search starts near its motion.
    search : int, optional
        Number of starts besides rest, each with another objective first, then the true one; 0 for none. By default none if the bound
        proves the first end, else as many as a fixed amount of work allows, until a better local optimum is unlikely; none for more than
        50 free bodies (from 100 to 1,000 the first climb runs nine times instead), for approximate models, and from an earlier answer. In
        space a few, for at most 6 free bodies.
    prove : float, optional
        Prove afterwards that no motion exceeds the answer by more than this share, see `wiggleroom.prove`.
    seconds : float, optional
        For `prove`: time limit of the proof, instead of a fixed amount of work.
    stop : optional
        Anything with `is_set()`, for example a `threading.Event`; checked every iteration.
    progress : callable, optional
        Called with a `Progress` every iteration; in space with the number of iterations and the value.

    Returns
    -------
    Answer
        A motion, with walls one without overlap, and its verdict. If that takes less work than the search, `at_most` is a value that no
        motion exceeds; such a quick bound is near only for small assemblies.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, a goal names an unknown part, or the model is unknown.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01))
    >>> round(answer.objective, 4)
    0.0261
    """
    if isinstance(assembly, Assembly) and assembly.dimension == 3:
        from wiggleroom.spatial.spatial_flex import flex_spatial

        refuse_planar_options("flex", model=model, start=start)
        if prove is not None:
            from wiggleroom.bound.prove import check_request

            check_request(prove, seconds)
        context = Context(stop=stop, progress=progress)
        answer = flex_spatial(assembly, goals, solver=solver, search=search, bound=True, context=context)
        if prove is None:
            return answer
        from wiggleroom.spatial.proof.spatial_prove import prove_spatial

        return prove_spatial(answer, prove, seconds=seconds, context=Context(stop=stop))
    from wiggleroom.maximise import flex as flex_planar

    options = given(seconds=seconds) | {"stop": stop, "progress": progress}
    return flex_planar(assembly, goals, model=model, solver=solver, start=start, search=search, prove=prove, **options)


def prove(
    answer: Answer,
    within: float = 0.01,
    *,
    seconds: float | None = None,
    work: float | None = None,
    certify: bool = False,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """Prove a value that no motion can exceed.

    Parameters
    ----------
    answer : Answer
        From `flex`, of pulls, turns or Ws; in space of one pull or turn, where one body moves among fixed ones.
    within : float
        Largest excess of the bound over the answer's objective, as a share of it, more than 0. Less takes longer.
    seconds : float, optional
        Time limit; then the best bound so far is returned, which depends on the speed of the machine.
    work : float, optional
        Limit of counted work, about milliseconds; 60,000 if `seconds` is left out, else none. Then the best bound so far is returned.
    certify : bool
        Write a proof for independent checks: `bound.certificate` is the input of `wiggleroom verify`. Takes longer. Its own `at_most` is
        larger than that of the answer if the answer already had a nearer bound.
    stop : optional
        Anything with `is_set()`; ends it at once.
    progress : callable, optional
        Called with a `Progress`: stage, time, and the bound so far.

    Returns
    -------
    Answer
        The same answer, with `at_most` and `bound`. If nothing is proven, `bound.why` gives the reason, and `at_most` is unchanged.

    Raises
    ------
    InputError
        If the goals are not linear in points and turns, the answer is of a model that only approximates contacts, or a number makes no
        sense.
    MissingExtraError
        If highspy, the extra `prove`, is not installed.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.prove(wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01)), within=0.01)
    >>> answer.objective <= answer.at_most <= 1.01 * answer.objective
    True
    """
    context = Context(stop=stop, progress=progress)
    if answer.assembly.dimension == 3:
        from wiggleroom.spatial.proof.spatial_prove import prove_spatial

        return prove_spatial(answer, within, seconds=seconds, work=work, certify=certify, context=context)
    from wiggleroom.bound.prove import prove as prove_planar

    return prove_planar(answer, within, seconds=seconds, work=work, certify=certify, context=context)


def check(
    assembly: Assembly,
    *,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    boxes: int | None = None,
    questions: int | None = None,
    every: bool = True,
    seconds: float | None = None,
) -> Interlock:
    """Decide whether some parts can move without limit away from the others.

    Fixed parts stand; if none is fixed, the largest part stands. Turning in place is not coming apart.

    Parameters
    ----------
    assembly : Assembly
    stop : optional
        Anything with `is_set()`.
    progress : optional
        Called as it goes on; not in space.
    boxes : int, optional
        For drawings only: most boxes of motions for the only body that can leave, before largest motions are searched.
    questions : int, optional
        For drawings only: most largest motions to search, each time some parts have left.
    every : bool
        False: stop at the first parts that leave, without the others and without turns in place.
    seconds : float, optional
        Time limit; then the verdict so far is returned, as after a request to stop.

    Returns
    -------
    Interlock

    Raises
    ------
    InputError
        If there is only one part, or all are fixed; if `seconds` is not more than 0.
    TouchingError
        If two parts overlap at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> str(wr.check(wr.patterns.chain(3, joint="finger", gap=0.02)).verdict)
    'comes apart'
    """
    context = Context(stop=_within(seconds, stop), progress=progress)
    if isinstance(assembly, Assembly) and assembly.dimension == 3:
        from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial

        refuse_planar_options("check", boxes=boxes, questions=questions)
        return check_spatial(assembly, every=every, context=context.silent)
    from wiggleroom.disassembly.escape_effort import EscapeEffort
    from wiggleroom.disassembly.interlock import interlock

    effort = EscapeEffort(**given(boxes=boxes, questions=questions))
    return interlock(assembly, effort, every=every, context=context)


def largest_gap(
    assembly: Assembly,
    *,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    seconds: float | None = None,
) -> LargestGap:
    """Find the gap of the whole assembly at which it comes apart, to 0.1 %.

    Parameters
    ----------
    assembly : Assembly
        The search begins at its own gap. Gaps of single joints and offsets of parts stay as they are.
    stop : optional
        Anything with `is_set()`.
    seconds : float, optional
        Time limit; then both sides are the best known so far.
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
    context = Context(stop=_within(seconds, stop), progress=progress)
    if assembly.dimension == 3:
        from wiggleroom.disassembly.largest_gap import largest_gap_over
        from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
        from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

        context = context.silent
        return largest_gap_over(
            assembly,
            lambda gap: assemble_spatial(assembly.drawing, gap=gap, stop=context.stop),
            lambda made: check_spatial(made, every=False, context=context),
            context,
        )
    from wiggleroom.disassembly.largest_gap import largest_gap as work_out

    return work_out(assembly, context)


def _within(seconds: float | None, stop: Stop | None) -> Stop | None:
    """A request to stop that comes after some time at the latest; InputError where that is no time."""
    if seconds is None:
        return stop
    if not 0 < seconds < math.inf:
        finding = f"seconds {seconds:g}: it must be more than 0"
        raise InputError(finding)
    return Deadline(seconds, stop)


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
