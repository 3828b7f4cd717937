"""How far it can move, with walls: a climb from rest to a local optimum, then the global search."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from wiggleroom.audit.path_audit import audit_path
from wiggleroom.bound.dual_bound import with_quick_bound, work_of_search
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, StoppedError
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.program.objectives import Objective
from wiggleroom.search.answer import PROVEN_WITHIN, Answer, Bound, with_bound
from wiggleroom.search.build_answer import answer_of
from wiggleroom.search.canonical_frame import canonical_frame, carried_incumbent
from wiggleroom.search.distance_climb import FURTHER_CLIMBS, climbed
from wiggleroom.search.global_search import MAX_BODIES, effort, search_on, together
from wiggleroom.search.incumbent import Incumbent, Start, start_at_rest
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.multistart import pulls
from wiggleroom.search.periodic_motion import PeriodicMotion, periodic_motion
from wiggleroom.search.prepare import Prepared, prepare_as_drawn
from wiggleroom.search.prepare_walls import contact_places, held_back, prepare_simplified
from wiggleroom.search.progress import Progress
from wiggleroom.search.separated_bodies import without_separated
from wiggleroom.search.turn_in_place import better_climb, cells_round, turned_in_place
from wiggleroom.solve import solver_named
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import Verdict

FIRST_BOUND_WORK, NEAR_BOUND, MORE_WORK = 500.0, 0.03, 4.0
"""Work of the bound that comes before a search, in about milliseconds; it is kept where it lies no further above the end than this share,
or where the search took no more than this multiple of its work."""
MAX_REFINEMENTS, MAX_HELD_BACK = 4, 5e-4
"""Simplified outlines are refined at contacts at most this many times, and while they hold back more than this share of the motion."""


@dataclass(frozen=True, eq=False)
class MotionQuery:
    """What is asked, and how it is looked for.

    Parameters
    ----------
    goals : tuple of Goal
    solver : str
    search : int, optional
        Number of starts beside the one from rest; by default as many as a fixed amount of work allows.
    start : Answer, optional
        An earlier answer of the same prepared assembly.
    periods : bool
        Whether it is looked whether a motion repeats without end.
    context : Context
        Asked every iteration whether to stop; told a `Progress`.
    began : float
        When it was asked, by `time.perf_counter`.
    """

    goals: tuple[Goal, ...]
    solver: str = "interior-point"
    search: int | None = 0
    start: Answer | None = None
    periods: bool = True
    context: Context = UNLIMITED
    began: float = field(default_factory=time.perf_counter)

    @property
    def solve(self) -> Callable[..., Solution]:
        """The solver."""
        return solver_named(self.solver)


def flex_walls(ready: Prepared, query: MotionQuery) -> Answer:
    """The answer; it holds a bound, or says why there is none, only where the search itself came to that."""
    if ready.simplified:
        return _refined(ready, query)
    own = _in_own_frame(ready, query) if query.search != 0 and query.start is None else None
    if own is None:
        return _climbed(ready, query)
    if audit_path(ready.assembly, own.waypoints).free:
        return own
    # rounding has moved a part too far
    answer = _climbed(ready, replace(query, began=time.perf_counter()))
    return _with_work(answer, (own, answer), query)


def _refined(ready: Prepared, query: MotionQuery) -> Answer:
    """Answer for outlines of many corners: fewer corners first, more where parts touch, as long as that may gain.

    What is searched is the first of these problems; later ones begin where the one before ended.
    """
    answer = _climbed(ready, query)
    places, climbs = contact_places(answer), [answer]
    for _ in range(MAX_REFINEMENTS if query.start is None else 0):
        if answer.verdict is Verdict.PROVEN:
            return _with_work(answer, climbs, query)
        if not answer.verdict.ends or not answer.objective:
            break
        if held_back(answer) <= MAX_HELD_BACK * abs(answer.objective):
            break
        finer = prepare_simplified(ready.assembly, places, query.context.stop, ready.clearance)
        if finer is None or query.context.stopped:
            break
        again = _climbed(finer, replace(query, start=None, began=time.perf_counter()), _near_end(finer, answer))
        climbs.append(again)
        places = np.concatenate([places, contact_places(again)])
        before, answer = answer, _better(answer, replace(again, search=answer.search))
        if answer is before:
            break
    why = f"outlines of many corners were searched with fewer, up to {ready.simplified:.2g} mm further out"
    # The conditions hold for parts that are a little larger; of the parts as drawn that is no more than a good motion.
    verdict = Verdict.STATIONARY if answer.verdict.ends else answer.verdict
    bound = replace(answer.bound or Bound(None, None, 0.0), why=why)
    return _with_work(replace(answer, verdict=verdict, bound=bound), climbs, query)


def _near_end(finer: Prepared, answer: Answer) -> Start | None:
    """The start near the end of an answer for other outlines of the same assembly; None where these leave no room there."""
    found = answer.warm_start
    if found is None:
        return None
    near = found.start()
    cells = cells_round(finer, near.inner)
    return None if cells is None else replace(near, cells=cells, tolerance=found.tolerance)


def _with_work(answer: Answer, climbs: Sequence[Answer], query: MotionQuery) -> Answer:
    """The answer with the rounds, iterations and seconds of all climbs that led to it."""
    seconds: dict[str, float] = {}
    for climb in climbs:
        for stage, spent in climb.seconds.items():
            seconds[stage] = seconds.get(stage, 0.0) + spent
    return replace(
        answer,
        rounds=sum(climb.rounds for climb in climbs),
        iterations=sum(climb.iterations for climb in climbs),
        seconds=seconds | {"total": time.perf_counter() - query.began},
    )


def _better(one: Answer, other: Answer) -> Answer:
    """The answer with the larger motion."""
    if one.objective is None or other.objective is None:
        return one if one.objective is None else other
    return other if other.objective > one.objective else one


def _in_own_frame(ready: Prepared, query: MotionQuery) -> Answer | None:
    """The answer, searched for in the frame that an assembly of few bodies has of its own; None where it must be searched for as it is."""
    if int((~ready.bodies.fixed).sum()) > MAX_BODIES:
        return None
    frame = canonical_frame(without_separated(ready, query.goals), query.goals)

    def told(progress: Progress) -> None:
        query.context.tell(replace(progress, objective=progress.objective / frame.worth))

    try:
        own = prepare_as_drawn(frame.assembly, stop=query.context.stop)
    except (InputError, StoppedError):
        return None
    there = replace(query, goals=frame.goals, context=replace(query.context, progress=told))
    found = with_quick_bound(_climbed(own, there), query.context.stop)
    answer = frame.answer(found, ready.assembly, query.goals)
    motion = of_bodies(ready.assembly, ready.bodies, answer.waypoints[-1:])[0]
    goal = ready.objective(query.goals)
    answer = replace(
        answer,
        objective=None if answer.objective is None else goal.value(motion),
        deepest_overlap=overlaps(ready.bodies, motion, ready.ignored).deepest,
        seconds=answer.seconds | {"total": time.perf_counter() - query.began},
    )
    return replace(answer, warm_start=carried_incumbent(ready, goal, query.solve, found, frame, answer.waypoints))


def _climbed(ready: Prepared, query: MotionQuery, near: Start | None = None) -> Answer:
    """The answer, searched for in the frame of the assembly that was prepared; where a start near an end is known, climbed from there."""
    goal, search, from_rest = ready.objective(query.goals), query.search, query.start is None
    climb = LocalSearch(ready, goal, query.solve, THOROUGH, query.context.stop, query.context.tell)
    climb.seconds["freespace"] += time.perf_counter() - query.began
    if near is not None:
        climb.improve(near)
        climb, repeats = periodic_motion(climb, query.goals) if query.periods else (climb, None)
        return _answer(climb, query, repeats)
    first = pulls(ready.bodies, goal, ready.clearance) if from_rest else ()
    if first:
        return _from_several(climb, first, query)
    turned = turned_in_place(ready, goal) if from_rest and search != 0 else None
    begin: Start | Incumbent
    if turned is not None and ready.simplified:  # from rest, corners of simplified curves would be climbed one by one
        begin = turned
    elif query.start is None:
        begin = climbed(climb, start_at_rest(ready), FURTHER_CLIMBS if search is None else 0)
    else:
        begin = _incumbent(query.start, ready).start()
    if isinstance(begin, Incumbent):
        climb.best = begin
    else:
        climb.improve(begin)
    if climb.stopped:
        return _answer(climb, query)
    before: tuple[float, ...] = ()
    if turned is not None and not ready.simplified:
        climb, before = better_climb(climb, turned)
    climb, repeats = periodic_motion(climb, query.goals) if query.periods else (climb, None)
    if search == 0 or repeats is not None:
        return _answer(climb, query, repeats)
    return _searched(climb, query, before)


def _searched(climb: LocalSearch, query: MotionQuery, before: tuple[float, ...]) -> Answer:
    """The answer after the global search; a body alone is searched completely, where that is left to do.

    `before` are values at which other climbs ended.
    """
    search = query.search
    ends: tuple[float, ...] = (*before, climb.certain_value()[0])
    at_most, quick = None, None
    exact = not climb.ready.simplified
    free = int((~climb.ready.bodies.fixed).sum())
    alone = free == 1
    if exact and search is None and free <= MAX_BODIES:  # a bound of larger parts is none of these
        answer = with_quick_bound(_answer(climb, query), climb.stop, FIRST_BOUND_WORK)
        if answer.verdict is Verdict.PROVEN:
            return replace(answer, search=effort(ends, ends[-1]))
        quick = answer.bound
    if alone:
        from wiggleroom.search.complete_search import complete_search

        found = complete_search(climb)
        at_most = found.at_most
        if search is None:
            ends = (*before, *found.ends)
        if found.best is not climb:
            climb, repeats = periodic_motion(found.best, query.goals)
            if repeats is not None:
                return _answer(climb, query, repeats)
    if alone and search is None:
        answer = _bounded(_answer(climb, query), at_most)
        if answer.verdict is Verdict.PROVEN or found.settled:
            return replace(answer, search=effort(ends, climb.certain_value()[0]))
    enough = np.inf if quick is None or quick.at_most is None else quick.at_most / PROVEN_WITHIN
    further, done = search_on(climb, search, ends, enough)
    turned, repeats = (climb, None) if further is climb else periodic_motion(further, query.goals)
    if turned is not further and repeats is None:  # what the search took for endless came to an end: go on from there
        left = None if search is None else search + len(ends) - done.starts
        further, more = search_on(turned, left, (turned.certain_value()[0],), enough)
        done = together(done, more)
        if further is not turned:
            turned, repeats = periodic_motion(further, query.goals)
    answer = _bounded(replace(_answer(turned, query, repeats), search=done), at_most)
    return _with_first_bound(answer, quick)


def _with_first_bound(answer: Answer, quick: Bound | None) -> Answer:
    """The answer with the bound that came before the search, unless one with the work of the search may come nearer."""
    found: Incumbent | None = answer.warm_start
    if quick is None or quick.at_most is None or answer.bound is not None or not answer.objective or found is None:
        return answer
    near = quick.at_most <= (1 + NEAR_BOUND) * answer.objective
    if not near and work_of_search(answer, found) > MORE_WORK * FIRST_BOUND_WORK:
        return answer
    timed = replace(answer, seconds=answer.seconds | {"bound": quick.seconds})
    return with_bound(timed, replace(quick, within=quick.at_most / answer.objective - 1))


def _bounded(answer: Answer, at_most: float | None) -> Answer:
    """The answer with what a complete search found that no motion exceeds."""
    if at_most is None or not answer.objective:
        return answer
    return with_bound(answer, Bound(at_most, at_most / answer.objective - 1, 0.0))


def _from_several(search: LocalSearch, first: Sequence[Objective], query: MotionQuery) -> Answer:
    """Best answer of searches that begin at the ends of several pulls, for objectives without a direction at rest."""
    answers = []
    for pull in first:
        escape = LocalSearch(search.ready, pull, search.solve, THOROUGH, search.stop, search.tell)
        end = escape.improve(start_at_rest(search.ready))
        again = LocalSearch(search.ready, search.objective, search.solve, THOROUGH, search.stop, search.tell)
        again.improve(start_at_rest(search.ready) if end is None else end.start())
        for stage in search.seconds:
            search.seconds[stage] += escape.seconds[stage] + again.seconds[stage]
        search.rounds += escape.rounds + again.rounds
        search.iterations += escape.iterations + again.iterations
        answers.append(_answer(again, query))
        if answers[-1].objective is None or query.context.stopped:
            break
    best = max(answers, key=lambda a: (a.objective is None, a.collision_free, a.objective))
    seconds = search.seconds | {"total": time.perf_counter() - query.began}
    return replace(best, seconds=seconds, rounds=search.rounds, iterations=search.iterations)


def _answer(climb: LocalSearch, query: MotionQuery, repeats: PeriodicMotion | None = None) -> Answer:
    """What a search has come to, as an answer."""
    return answer_of(climb, query.goals, query.solver, query.began, repeats)


def _incumbent(start: Answer, ready: Prepared) -> Incumbent:
    """How an earlier answer for the same prepared assembly was found."""
    if start.warm_start is None or start.warm_start.program.bodies is not ready.bodies:
        finding = "start: the earlier answer belongs to another prepared assembly; ask the same one, from prepare()"
        raise InputError(finding)
    return start.warm_start
