"""How far can it move: the question, put to the model that was chosen, and its answer.

Models of a pair are told apart here and nowhere else.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import asked_goals
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.bound.dual_bound import with_quick_bound
from wiggleroom.compare.approximate import Approximation, answer_from, approximate
from wiggleroom.deadline import GracePeriod
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.freespace.models.pair_models import HalfPlane, PairModel, Walls, model_named
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.program.objectives import Objective, objective
from wiggleroom.search import prepare as problem
from wiggleroom.search.answer import Answer, Bound, with_bound, witnessed
from wiggleroom.search.build_answer import answer_of
from wiggleroom.search.canonical_frame import canonical_frame
from wiggleroom.search.carried_incumbent import carried_incumbent
from wiggleroom.search.distance_climb import FURTHER_CLIMBS, climbed
from wiggleroom.search.global_search import MAX_BODIES, effort, search_on
from wiggleroom.search.incumbent import Incumbent, Start, start_at_rest
from wiggleroom.search.loop import LocalSearch, Progress, silent
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.multistart import pulls
from wiggleroom.search.periodic_motion import periodic_motion
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.simplified_outlines import contact_places, prepare_outlines, prepare_simplified
from wiggleroom.search.turn_in_place import better_climb, turned_in_place
from wiggleroom.solve import solver_named
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import Verdict

MAX_REFINEMENTS, MIN_REFINEMENT = 4, 1e-4
"""So often simplified outlines are refined where they touch, as long as that gains this share."""


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
    """Find the pairs that can meet and work out their free spaces round rest, congruent pairs once.

    Parameters
    ----------
    assembly : Assembly
    model : str, Hull or HalfPlane
        "walls", "hull" or "halfplane": what stands for the free space of a pair.
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
    wanted = model_named(model)
    if isinstance(wanted, Walls):
        return PreparedModel(**vars(prepare_outlines(assembly, stop=stop)))
    return ApproximateModel(**vars(approximate(assembly, wanted, stop)))


def flex(
    assembly: Assembly | Prepared | Approximation,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = None,
    prove: float | None = None,
    seconds: float = 60.0,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """How far the assembly can move.

    Parameters
    ----------
    assembly : Assembly or Prepared
    goals : Pull, Turn, W, Translation or Closer, or several that add up
        By default what the assembly's file asks for.
    model : str, Hull or HalfPlane, optional
        "walls", the exact contacts; "hull", the paper's, or "halfplane", PuzzleFlex's, to compare with: these accept some overlap, which
        the answer tells. By default what the assembly was prepared for, else walls.
    solver : str
        "interior-point", or "ipopt" (needs the extra `ipopt`); half-planes need neither.
    start : Answer, optional
        An earlier answer of the same prepared assembly, with walls; the search starts near its motion.
    search : int, optional
        So many starts beside the one from rest: with another objective first, then the true one; 0 for none. By default as many as a
        fixed amount of work allows, until it is unlikely that there is a higher hill; none for more than 50 free bodies (from 100
        to 1,000 the first climb is made nine times instead), for models that approximate, and from an earlier answer.
    prove : float, optional
        Prove afterwards that no motion is worth more than this share above the answer, see `wiggleroom.prove`.
    seconds : float
        For `prove`: time that the proof may take.
    stop : optional
        Anything with `is_set()`, for example a `threading.Event`; asked every iteration.
    progress : callable, optional
        Told a `Progress` every iteration.

    Returns
    -------
    Answer
        A motion, with walls one without overlap, and how sure it is. Where that takes less work than the search, `at_most` says
        beside it what no motion exceeds; such a quick bound is near only for small assemblies.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, a goal names an unknown part, or there is no such model.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01))
    >>> round(answer.objective, 4)
    0.0261

    Source: Mind the Gap, section 4; by default walls instead of the hull, and the iterative re-approximation of its outlook.
    """
    if prove is not None:
        from wiggleroom.bound.prove import check_request

        check_request(prove, seconds)
    if search is not None and search < 0:
        finding = f"search: {search} starts: it must be 0 or more"
        raise InputError(finding)
    answer = with_quick_bound(
        witness(
            assembly,
            goals,
            model=model,
            solver=solver,
            start=start,
            search=0 if search is None and start is not None else search,
            stop=stop,
            progress=progress,
        ),
        stop,
    )
    if prove is None:
        return answer
    from wiggleroom.bound.prove import prove as proved

    return proved(answer, prove, seconds=seconds, stop=stop, progress=progress)


def witness(
    assembly: Assembly | Prepared | Approximation,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    model: str | PairModel | None = None,
    solver: str = "interior-point",
    start: Answer | None = None,
    search: int | None = 0,
    periods: bool = True,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """The answer of `flex` without any bound, by default from rest only, for studies that ask many questions and need neither.

    Without `periods` it is not looked whether a motion repeats without end.
    """
    began = time.perf_counter()
    stop = None if stop is None else GracePeriod(stop)
    tell = progress or silent
    its = assembly if isinstance(assembly, Assembly) else assembly.assembly
    asked = asked_goals(its.drawing, goals)
    wanted = assembly.model if model is None and not isinstance(assembly, Assembly) else model_named(model or "walls")
    solve = solver_named(solver)
    tell(Progress("pairs"))
    try:
        ready = (
            assembly
            if not isinstance(assembly, Assembly) and assembly.model == wanted
            else prepare(its, wanted, stop=stop)
        )
    except StoppedError:
        rest = np.zeros((1, len(its.parts), 3))
        none = witnessed(its, asked, Verdict.STOPPED, 0.0, rest, "checked")
        return replace(none, model=wanted.name, solver=solver, seconds={"total": time.perf_counter() - began})
    if isinstance(ready, Approximation):
        if search:
            raise InputError("search: only the model walls is searched from other starts; leave it out")
        if start is not None:
            raise InputError("start: only the model walls begins at an earlier answer; leave it out")
        return _approximately(ready, asked, solver, stop, tell, time.perf_counter() - began)
    if ready.simplified:
        return _refined(ready, asked, solve, solver, start, search, stop, tell, began)
    if search != 0 and start is None:
        answer = _in_own_frame(ready, asked, solve, solver, search, stop, tell, began)
        if answer is not None:
            return answer
    return _climbed(ready, asked, solve, solver, search, start, stop, tell, began, periods)


def _refined(
    ready: Prepared,
    asked: tuple[Goal, ...],
    solve: Callable[..., Solution],
    solver: str,
    start: Answer | None,
    search: int | None,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    began: float,
) -> Answer:
    """Answer for outlines of many corners: fewer corners first, more where parts touch, as long as that gains."""
    answer = _climbed(ready, asked, solve, solver, search, start, stop, tell, began)
    places = contact_places(answer)
    for _ in range(MAX_REFINEMENTS if start is None else 0):
        finer = prepare_simplified(ready.assembly, places, stop) if answer.verdict.ends and len(places) else None
        if finer is None or (stop is not None and stop.is_set()):
            break
        again = _climbed(finer, asked, solve, solver, search, None, stop, tell, began)
        places = np.concatenate([places, contact_places(again)])
        before, answer = answer, _better(answer, again)
        if answer.objective is None or before.objective is None or answer is before:
            break
        if answer.objective < before.objective * (1 + MIN_REFINEMENT):
            break
    why = f"outlines of many corners were searched with fewer, up to {ready.simplified:.2g} mm further out"
    # The conditions hold for parts that are a little larger; of the parts as drawn that is no more than a good motion.
    verdict = Verdict.STATIONARY if answer.verdict.ends else answer.verdict
    return replace(answer, verdict=verdict, bound=Bound(None, None, 0.0, why))


def _better(one: Answer, other: Answer) -> Answer:
    """The answer with the larger motion."""
    if one.objective is None or other.objective is None:
        return one if one.objective is None else other
    return other if other.objective > one.objective else one


def _climbed(
    ready: Prepared,
    asked: tuple[Goal, ...],
    solve: Callable[..., Solution],
    solver: str,
    search: int | None,
    start: Answer | None,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    began: float,
    periods: bool = True,
) -> Answer:
    """The answer, searched for in the frame of the assembly that was prepared."""
    goal = ready.objective(asked)
    climb = LocalSearch(ready, goal, solve, THOROUGH, stop, tell)
    climb.seconds["freespace"] += time.perf_counter() - began
    first = pulls(ready.bodies, goal, ready.clearance) if start is None else ()
    if first:
        return _from_several(climb, first, asked, solver, began)
    turned = turned_in_place(ready, goal) if start is None and search != 0 else None
    if turned is not None and ready.simplified:  # from rest, corners of simplified curves would be climbed one by one
        begin: Start | Incumbent = turned
    else:
        further = FURTHER_CLIMBS if search is None else 0
        begin = climbed(climb, start_at_rest(ready), further) if start is None else _incumbent(start, ready).start()
    if isinstance(begin, Incumbent):
        climb.best = begin
    else:
        climb.improve(begin)
    if climb.stopped:
        return answer_of(climb, asked, solver, began)
    before: tuple[float, ...] = ()
    if turned is not None and not ready.simplified:
        climb, before = better_climb(climb, turned)
    elif turned is not None and search is None:
        value, free = climb.certain_value()
        if free or value >= goal.value(turned.inner):  # no turn gains more
            return replace(answer_of(climb, asked, solver, began), search=effort((value,), value))
    climb, repeats = periodic_motion(climb, asked) if periods else (climb, None)
    if search == 0 or repeats is not None:
        return answer_of(climb, asked, solver, began, repeats)
    return _searched(climb, search, asked, solver, began, before)


def _in_own_frame(
    ready: Prepared,
    asked: tuple[Goal, ...],
    solve: Callable[..., Solution],
    solver: str,
    search: int | None,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    began: float,
) -> Answer | None:
    """The answer, searched for in the frame that an assembly of few bodies has of its own; None where it must be searched for as it is."""
    if int((~ready.bodies.fixed).sum()) > MAX_BODIES:
        return None
    frame = canonical_frame(ready.assembly, asked)

    def told(progress: Progress) -> None:
        tell(replace(progress, objective=progress.objective / frame.scale))

    try:
        own = problem.prepare(frame.assembly, stop=stop)
    except (InputError, StoppedError):
        return None
    found = with_quick_bound(_climbed(own, frame.goals, solve, solver, search, None, stop, told, began), stop)
    answer = frame.answer(found, ready.assembly, asked)
    if not audit_path(ready.assembly, answer.waypoints).free:
        return None  # rounding has moved a part too far
    motion = of_bodies(ready.assembly, ready.bodies, answer.waypoints[-1:])[0]
    goal = ready.objective(asked)
    answer = replace(
        answer,
        objective=None if answer.objective is None else goal.value(motion),
        deepest_overlap=overlaps(ready.bodies, motion, ready.ignored).deepest,
        seconds=answer.seconds | {"total": time.perf_counter() - began},
    )
    return replace(answer, warm_start=carried_incumbent(ready, goal, solve, found, frame, answer.waypoints))


def _searched(
    climb: LocalSearch,
    search: int | None,
    asked: tuple[Goal, ...],
    solver: str,
    began: float,
    before: tuple[float, ...],
) -> Answer:
    """The answer after the search beyond the nearest hill; a body alone is searched completely, where that is left to do.

    `before` are values at which other climbs ended.
    """
    ends: tuple[float, ...] = (*before, climb.certain_value()[0])
    at_most = None
    exact = not climb.ready.simplified  # a bound of larger parts is none of these
    alone = exact and int((~climb.ready.bodies.fixed).sum()) == 1
    if alone and search is None:
        answer = with_quick_bound(answer_of(climb, asked, solver, began), climb.stop)
        if answer.verdict is Verdict.PROVEN:
            return replace(answer, search=effort(ends, ends[-1]))
    if alone or (exact and search is None):
        from wiggleroom.search.complete_search import complete_search

        found = complete_search(climb)
        at_most = found.at_most
        if search is None:
            ends = (*before, *found.ends)
        if found.best is not climb:
            climb, repeats = periodic_motion(found.best, asked)
            if repeats is not None:
                return answer_of(climb, asked, solver, began, repeats)
    if alone and search is None:
        answer = _bounded(answer_of(climb, asked, solver, began), at_most)
        if answer.verdict is Verdict.PROVEN:
            return replace(answer, search=effort(ends, climb.certain_value()[0]))
    further, done = search_on(climb, search, ends)
    repeats = None
    if further is not climb:
        further, repeats = periodic_motion(further, asked)
    return _bounded(replace(answer_of(further, asked, solver, began, repeats), search=done), at_most)


def _bounded(answer: Answer, at_most: float | None) -> Answer:
    """The answer with what a complete search found that no motion exceeds."""
    if at_most is None or not answer.objective:
        return answer
    return with_bound(answer, Bound(at_most, at_most / answer.objective - 1, 0.0))


def _from_several(
    search: LocalSearch, first: Sequence[Objective], asked: tuple[Goal, ...], solver: str, began: float
) -> Answer:
    """Best answer of searches that begin at the ends of several pulls, for objectives without a direction at rest."""
    answers = []
    for pull in first:
        way_out = LocalSearch(search.ready, pull, search.solve, THOROUGH, search.stop, search.tell)
        end = way_out.improve(start_at_rest(search.ready))
        again = LocalSearch(search.ready, search.objective, search.solve, THOROUGH, search.stop, search.tell)
        again.improve(start_at_rest(search.ready) if end is None else end.start())
        for stage in search.seconds:
            search.seconds[stage] += way_out.seconds[stage] + again.seconds[stage]
        search.rounds += way_out.rounds + again.rounds
        search.iterations += way_out.iterations + again.iterations
        answers.append(answer_of(again, asked, solver, began))
        if answers[-1].objective is None or (search.stop is not None and search.stop.is_set()):
            break
    best = max(answers, key=lambda a: (a.objective is None, a.collision_free, a.objective))
    seconds = search.seconds | {"total": time.perf_counter() - began}
    return replace(best, seconds=seconds, rounds=search.rounds, iterations=search.iterations)


def _approximately(
    ready: Approximation,
    asked: tuple[Goal, ...],
    solver: str,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    spent: float,
) -> Answer:
    """Answer by the model hull or halfplane."""
    began = time.perf_counter()
    goal = objective(ready.assembly, ready.bodies, asked, ready.near)
    if isinstance(ready.model, HalfPlane):
        if solver != "interior-point":
            finding = f'solver "{solver}": half-planes make linear programs; leave the solver out'
            raise InputError(finding)
        from wiggleroom.compare.flex_halfplane import flex_half_planes
        from wiggleroom.solve.linear_programming import linear_solver

        solver = linear_solver()
        end = flex_half_planes(ready, goal, ready.model.iterated, stop, tell)
    else:
        from wiggleroom.compare.flex_hull import flex_hull

        end = flex_hull(ready, goal, solver_named(solver), stop, tell)
    seconds = {"freespace": spent, "solve": time.perf_counter() - began}
    return answer_from(ready, asked, solver, end, seconds)


def _incumbent(start: Answer, ready: Prepared) -> Incumbent:
    """How an earlier answer for the same prepared assembly was found."""
    if start.warm_start is None or start.warm_start.program.bodies is not ready.bodies:
        finding = "start: the earlier answer belongs to another prepared assembly; ask the same one, from prepare()"
        raise InputError(finding)
    return start.warm_start
