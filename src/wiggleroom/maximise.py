"""How far can it move: the question, put to the model that was chosen, and its answer.

Models of a pair are told apart here and nowhere else.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.assembly.findings import asked_goals
from wiggleroom.bound.dual_bound import with_quick_bound
from wiggleroom.compare.approximate import Approximation, approximate
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.flex_walls import MotionQuery, flex_walls
from wiggleroom.freespace.models.pair_models import PairModel, Walls, model_named
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.prepare_walls import prepare_walls
from wiggleroom.search.progress import Progress
from wiggleroom.solve import solver_named
from wiggleroom.verdict import PathState, Verdict


@dataclass(frozen=True, eq=False)
class PreparedModel(Prepared):
    """An assembly made ready for questions, which can be asked of it."""

    def flex(self, goals: Goal | Sequence[Goal] | None = None, **options: Any) -> Answer:
        """How far it can move; see `wiggleroom.flex`, whose other arguments this takes too."""
        return flex(self, goals, **options)


@dataclass(frozen=True, eq=False)
class ApproximateModel(Approximation):
    """An assembly made ready for a model that approximates, of which questions can be asked."""

    def flex(self, goals: Goal | Sequence[Goal] | None = None, **options: Any) -> Answer:
        """How far it can move; see `wiggleroom.flex`, whose other arguments this takes too."""
        return flex(self, goals, **options)


@overload
def prepare(assembly: Assembly, *, stop: Stop | None = None) -> PreparedModel: ...
@overload
def prepare(
    assembly: Assembly, model: str | PairModel, *, stop: Stop | None = None
) -> PreparedModel | ApproximateModel: ...
def prepare(
    assembly: Assembly, model: str | PairModel = "walls", *, stop: Stop | None = None
) -> PreparedModel | ApproximateModel:
    """Compute the pairs that can meet and their free spaces round rest, congruent pairs once.

    Parameters
    ----------
    assembly : Assembly
    model : str, Hull or HalfPlane
        "walls", "hull" or "halfplane": the model of the free space of a pair.
    stop : optional
        Anything with `is_set()`, asked now and then.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    TouchingError
        If two parts touch or overlap after gap and offsets.
    InputError
        If nothing can move, or there is no such model.
    """
    require_planar(assembly, "prepare")
    wanted = model_named(model)
    if isinstance(wanted, Walls):
        return PreparedModel(**vars(prepare_walls(assembly, stop=stop)))
    return ApproximateModel(**vars(approximate(assembly, wanted, Context(stop=stop))))


def flex(
    assembly: Assembly | Prepared | Approximation,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = None,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """How far an assembly in the plane can move; see `wiggleroom.flex`.

    Source: Mind the Gap, section 4; by default walls instead of the hull, and the iterative re-approximation of its outlook.
    """
    if prove is not None:
        from wiggleroom.bound.prove import check_request

        check_request(prove, seconds)
    if search is not None and search < 0:
        finding = f"search: {search} starts: it must be 0 or more"
        raise InputError(finding)
    starts = 0 if search is None and start is not None else search
    context = Context(stop=stop, progress=progress)
    answer = witness(assembly, goals, model=model, solver=solver, start=start, search=starts, context=context)
    answer = with_quick_bound(answer, stop)
    if prove is None:
        return answer
    from wiggleroom.bound.prove import prove as proved

    return proved(answer, prove, seconds=seconds, context=context)


def witness(
    assembly: Assembly | Prepared | Approximation,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = 0,
    context: Context = UNLIMITED,
) -> Answer:
    """The answer of `flex` without its quick bound, by default from rest only: for studies, which ask many questions.

    Parameters
    ----------
    assembly, goals, model, solver, start
        As for `flex`.
    search : int, optional
        Number of starts beside the one from rest; None for as many as `flex` makes. Where a search itself proved a bound, as it
        does to end early, the answer holds it.
    context : Context

    Raises
    ------
    InputError, TouchingError
        As for `flex`.
    """
    began = time.perf_counter()
    context = context.with_grace
    its = assembly if isinstance(assembly, Assembly) else assembly.assembly
    asked = asked_goals(its.drawing, goals)
    wanted = assembly.model if model is None and not isinstance(assembly, Assembly) else model_named(model or "walls")
    solver_named(solver)  # it is there
    context.tell(Progress("pairs"))
    try:
        ready = (
            assembly
            if not isinstance(assembly, Assembly) and assembly.model == wanted
            else prepare(its, wanted, stop=context.stop)
        )
    except StoppedError:
        rest = np.zeros((1, len(its.parts), 3))
        none = witnessed(its, asked, Verdict.STOPPED, 0.0, rest, PathState.CHECKED)
        return replace(none, model=wanted.name, solver=solver, seconds={"total": time.perf_counter() - began})
    if isinstance(ready, Approximation):
        if search:
            raise InputError("search: only the model walls is searched from other starts; leave it out")
        if start is not None:
            raise InputError("start: only the model walls begins at an earlier answer; leave it out")
        from wiggleroom.compare.flex_approximate import flex_approximate

        return flex_approximate(ready, asked, solver, time.perf_counter() - began, context)
    return flex_walls(ready, MotionQuery(asked, solver, search, start, context=context, began=began))
