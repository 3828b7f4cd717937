"""How far can it move, in space: rounds of the program, a checked path, and the answer put together."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import asked_goals
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Goal, Translation
from wiggleroom.errors import InputError
from wiggleroom.search.answer import Answer
from wiggleroom.solve import solver_named
from wiggleroom.spatial.overlaps.overlap_check import deepest_overlap
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SquaredTravel, SumOfTerms
from wiggleroom.spatial.proof.cross_section_bound import with_cross_section_bound, with_known_bound
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared, prepare_spatial, spatial_objective
from wiggleroom.spatial.search.spatial_search import SearchEnd, SpatialSearch
from wiggleroom.spatial.search.spatial_starts import BestOfStarts, best_of_starts, is_free, is_held, random_leads
from wiggleroom.spatial.spatial_contact_forces import HeldMotion, spatial_contacts
from wiggleroom.verdict import PathState, SolverStatus, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def flex_spatial(
    assembly: Assembly | SpatialPrepared,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    solver: str = "interior-point",
    search: int | None = None,
    lead: Floats | None = None,
    bound: bool = False,
    context: Context = UNLIMITED,
) -> Answer:
    """How far a spatial assembly can move; see `wiggleroom.flex`.

    Parameters
    ----------
    search : int, optional
        Number of climbs beside the one from rest; by default a few, of up to six free bodies and within a fixed amount of work,
        where that one came to an end.
    lead : (k, n, 6) float64, optional [mm, rad]
        First part of the path of an answer to nearly the same question (`Answer.lead`): one climb begins at its end, too.
    bound : bool
        Whether an upper bound is looked for. Where it proves the climb from rest, no other follows.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, a goal names an unknown part, or `search` is negative.
    TouchingError
        If two parts touch at rest.
    """
    began = time.perf_counter()
    solver_named(solver)
    its = assembly.assembly if isinstance(assembly, SpatialPrepared) else assembly
    asked = asked_goals(its.drawing, goals)
    if search is not None and search < 0:
        message = f"search is {search}: it must be a number of starts, 0 for none"
        raise InputError(message)
    ready = assembly if isinstance(assembly, SpatialPrepared) else prepare_spatial(assembly)
    prepared = time.perf_counter()
    climb = SpatialSearch(ready, spatial_objective(ready, asked), context, solver=solver)
    end = climb.run()
    alone = BestOfStarts(end, None, climb.iterations, climb.rounds, end.path[:1])
    first = _answer(climb, alone, asked, began, prepared)
    if any(isinstance(goal, Translation) for goal in asked) and lead is None:
        return _travelled(climb, end, first, asked, search)
    if bound and not its.overshoot:  # what holds a cover need not hold what it covers
        first = with_cross_section_bound(first, context)
    if first.verdict is Verdict.PROVEN or (search is None and lead is None and not first.verdict.ends):
        return first
    if lead is not None and len(lead) > 1 and is_free(ready, lead):
        best = best_of_starts(climb, end, [lead], once=False)
    else:
        best = best_of_starts(climb, end, random_leads(climb, search), once=True)
    if best.end is end:
        spent = time.perf_counter() - began
        return replace(first, search=best.effort, seconds=first.seconds | {"total": spent})
    further = _answer(climb, best, asked, began, prepared)
    if end.good and further.verdict is Verdict.STOPPED:  # what seemed to leave may not
        return first
    return with_known_bound(further, first.at_most)


def _travelled(
    climb: SpatialSearch, end: SearchEnd, first: Answer, asked: tuple[Goal, ...], search: int | None
) -> Answer:
    """The answer where squared displacements are asked: at rest they have no derivative, so that climbs begin on paths of pulls.

    These go along the axes of the world, then at random.
    """
    began = time.perf_counter() - first.seconds["total"]
    leads = []
    for direction in (sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)):
        if climb.context.stopped:
            break
        pull = SpatialSearch(climb.ready, _pulled(climb.objective, direction), climb.context.silent)
        found = pull.run()
        climb.work += pull.work
        if not is_held(found):
            return _answer(
                climb, BestOfStarts(found, None, pull.iterations, pull.rounds, found.path[:1]), asked, began, began
            )
        if len(found.path) > 1:
            leads.append(found.path[: (len(found.path) + 2) // 2])
    best = best_of_starts(climb, end, itertools.chain(leads, random_leads(climb, search)), once=False)
    if best.end is end:
        return replace(first, search=best.effort)
    return _answer(climb, best, asked, began, began)


def _pulled(objective: SumOfTerms, direction: Floats) -> SumOfTerms:
    """A pull along a direction (3,) at every point whose squared displacement is asked."""
    squares = [t for t in objective.terms if isinstance(t, SquaredTravel)]
    return SumOfTerms(tuple(Displacement(t.body, t.arm, direction, t.rest) for t in squares))


def _answer(climb: SpatialSearch, best: BestOfStarts, asked: tuple[Goal, ...], began: float, prepared: float) -> Answer:
    """What a climb has come to, as an answer."""
    ready, its, done = climb.ready, climb.ready.assembly, best.end
    verdict, leaves, turns = _verdict(ready, climb.objective, done)
    solved = time.perf_counter()
    found, path = done.found, done.path  # free as far as it goes, which may be short of the solution
    motion = path[-1]
    deepest = deepest_overlap(its, motion)
    held = (
        HeldMotion(ready.grouping, done.program, found)
        if _at_end(ready, done) and found.status is SolverStatus.CONVERGED
        else None
    )
    contacts = () if held is None else spatial_contacts(its, held)
    ended = time.perf_counter()
    spent = {"freespace": prepared - began, "solve": solved - prepared, "check": ended - solved, "total": ended - began}
    value = None if verdict is Verdict.UNBOUNDED else climb.value(done)
    return Answer(
        assembly=its, goals=asked, verdict=verdict, objective=value, motion=motion, waypoints=path, contacts=contacts,
        path=PathState.CHECKED, collision_free=deepest <= OVERLAP_TOLERANCE * ready.size,
        deepest_overlap=deepest, model="planes", solver=climb.solver, rounds=best.rounds, iterations=best.iterations,
        search=best.effort,
        lead=best.lead, seconds=spent,
        leaves=leaves, turns=turns, warm_start=held,
    )  # fmt: skip


def _at_end(ready: SpatialPrepared, done: SearchEnd) -> bool:
    """True where the path ends at the solution."""
    pose, last = ready.grouping.pose_of(done.path[-1]), done.found.point.pose
    return bool(np.abs(pose.T - last.T).max() + ready.size * np.abs(pose.R - last.R).max() < 1e-9 * ready.size)


def _verdict(
    ready: SpatialPrepared, objective: SumOfTerms, done: SearchEnd
) -> tuple[Verdict, tuple[str, ...], tuple[str, ...]]:
    """How the question ended, and the parts that leave or turn without limit."""
    names, found = ready.assembly.names, done.found
    if done.leaving or done.turning:
        return Verdict.UNBOUNDED, tuple(names[k] for k in done.leaving), tuple(names[k] for k in done.turning)
    if found.status is SolverStatus.ESCAPING and done.whole and _at_end(ready, done):
        leaving = leaving_parts(ready, done.path[-1], objective)
        if leaving:
            return Verdict.UNBOUNDED, tuple(names[k] for k in leaving), ()
    if found.status is SolverStatus.CONVERGED and done.whole:
        largest = (
            found.curved_down and not ready.assembly.overshoot
        )  # what ends a cover's motion need not end that of what it covers
        return (Verdict.OPTIMAL if largest else Verdict.STATIONARY), (), ()
    return Verdict.STOPPED, (), ()


def leaving_parts(ready: SpatialPrepared, motion: Floats, objective: SumOfTerms) -> list[int]:
    """Parts that go on straight without limit from a motion: nothing is ahead of them; empty where that is not sure.

    Parts that came along further than half of the farthest one go on with it, in the direction it is pulled. Balls round all parts show
    that they only get further from the others.
    """
    pulls = objective.pulls(ready.grouping.pose_of(motion)) or [
        t for t in objective.terms if isinstance(t, Displacement)
    ]
    if not pulls:
        return []
    assembly, reference = ready.assembly, ready.assembly.reference
    total = np.sum([t.direction for t in pulls], axis=0)
    body = ready.grouping.body_of
    pulled = {t.body for t in pulls}
    along = motion[:, :3] @ (total / np.linalg.norm(total)) if np.linalg.norm(total) > 0 else np.zeros(len(motion))
    far = np.array([k for k in range(len(motion)) if int(body[k]) in pulled])
    farthest = float(along[far].max(initial=0.0))
    if farthest < ready.size:
        return []
    gone = along > farthest / 2
    direction = total / np.linalg.norm(total)
    radius = np.array([
        np.linalg.norm(m.surface.vertices - m.centroid, axis=1).max() for m in assembly.solids
    ])  # fmt: skip
    centre = reference + motion[:, :3]
    for k in np.flatnonzero(gone):
        for j in np.flatnonzero(~gone):
            apart = centre[k] - centre[j]
            ahead = float(apart @ direction)
            beside = float(np.linalg.norm(apart - ahead * direction))
            room = radius[k] + radius[j]
            if beside <= room and not (ahead > 0 and np.linalg.norm(apart) > room):
                return []
    return np.flatnonzero(gone).tolist()
