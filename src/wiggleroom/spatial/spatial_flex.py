"""How far can it move, in space: rounds of the program, a checked path, and the answer put together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.assembly.statements import given_goals, missing_roles
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop
from wiggleroom.search.answer import Answer
from wiggleroom.solve import solver_named
from wiggleroom.spatial.cross_section_bound import with_cross_section_bound, with_known_bound
from wiggleroom.spatial.overlaps.overlap_check import deepest_overlap
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms
from wiggleroom.spatial.solids.spatial_assembly import spatial_goal_findings
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_contact_forces import HeldMotion, spatial_contacts
from wiggleroom.spatial.spatial_prepare import SpatialPrepared, prepare_spatial, spatial_objective
from wiggleroom.spatial.spatial_search import SearchEnd, SpatialSearch
from wiggleroom.spatial.spatial_starts import BestOfStarts, best_of_starts, is_free, random_leads
from wiggleroom.verdict import PathState, SolverStatus, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def flex_spatial(
    assembly: SpatialAssembly | SpatialPrepared,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    solver: str = "interior-point",
    search: int | None = None,
    lead: Floats | None = None,
    bound: bool = False,
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Answer[SpatialAssembly]:
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
    asked = given_goals(goals, its.goals)
    wrong = spatial_question_findings(its, asked)
    if search is not None and search < 0:
        wrong.append(f"search is {search}: it must be a number of starts, 0 for none")
    if wrong:
        raise InputError([f"{its.drawing.source}: {line}" if its.drawing.source else line for line in wrong])
    ready = assembly if isinstance(assembly, SpatialPrepared) else prepare_spatial(assembly)
    prepared = time.perf_counter()
    climb = SpatialSearch(ready, spatial_objective(ready, asked), stop, progress, solver=solver)
    end = climb.run()
    alone = BestOfStarts(end, None, climb.iterations, climb.rounds, end.path[:1])
    first = _answer(climb, alone, asked, began, prepared)
    if bound:
        first = with_cross_section_bound(first, stop)
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


def _answer(
    climb: SpatialSearch, best: BestOfStarts, asked: tuple[Goal, ...], began: float, prepared: float
) -> Answer[SpatialAssembly]:
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


def spatial_question_findings(assembly: SpatialAssembly, goals: Sequence[Goal]) -> list[str]:
    """List what is wrong with a question about motion: with its goals, and what it lacks."""
    return spatial_goal_findings(assembly.drawing, goals) + lacking(assembly, goals)


def lacking(assembly: SpatialAssembly, goals: Sequence[Goal]) -> list[str]:
    """List what a question about motion lacks: a fixed part, a free one, a pull."""
    return missing_roles([p.fixed for p in assembly.parts], goals, "+z")


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
        return (Verdict.OPTIMAL if found.curved_down else Verdict.STATIONARY), (), ()
    return Verdict.STOPPED, (), ()


def leaving_parts(ready: SpatialPrepared, motion: Floats, objective: SumOfTerms) -> list[int]:
    """Parts that go on straight without limit from a motion: nothing is ahead of them; empty where that is not sure.

    Parts that came along further than half of the farthest one go on with it, in the direction it is pulled. Balls round all parts show
    that they only get further from the others.
    """
    pulls = [t for t in objective.terms if isinstance(t, Displacement)]
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
        np.linalg.norm(m.surface.vertices - m.centroid, axis=1).max() for m in assembly.made
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
