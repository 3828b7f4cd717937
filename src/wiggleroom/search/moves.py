"""Moves of the search: where to begin next, seen from the best motion so far."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import grow_cells, replaced, select
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.search.active_set import target_poses
from wiggleroom.search.carried_start import carried_start
from wiggleroom.search.congruent_swap import CongruentSwap, congruent_swaps, exchanged, followed
from wiggleroom.search.incumbent import HANDED_OVER_TOLERANCE, Incumbent, PathSegment, Start
from wiggleroom.search.local_search import (
    FINE_TOLERANCE,
    MAX_TOLERANCE,
    ROUGH_TOLERANCE,
    TOLERANCE_PER_BODY,
    LocalSearch,
    Policy,
)
from wiggleroom.search.progress import Progress
from wiggleroom.solve.interior_point_settings import INITIAL_BARRIER
from wiggleroom.verdict import SolverStatus

Ints = NDArray[np.int64]

MAX_BRANCHES = 8, 100
"""Corner contacts that are tried one by one, at most; and bodies of the largest assembly in which they are."""
MAX_NEARER_SEEDS = 3
"""Most regrowths from a seed nearer the optimum."""


def stale(search: LocalSearch, incumbent: Incumbent) -> Ints:
    """Pairs whose cells stop the motion although nothing touches there; all that moved, where the solver did not get to an end."""
    if incumbent.solution.status is not SolverStatus.FAILED:
        return np.unique(incumbent.active.pair[incumbent.active.virtual])
    cells, ready = incumbent.program.cells, search.ready
    moved = relative_pose(ready.bodies, cells.a, cells.b, incumbent.motion) - cells.seed
    return np.flatnonzero(np.hypot(moved[:, 0], moved[:, 1]) > ready.clearance)


def regrow_stale(search: LocalSearch, incumbent: Incumbent, gained: bool) -> Iterator[Start]:
    """Grow the stale cells anew, as long as that brings something."""
    pairs = search.policy.stale(search, incumbent) if gained else np.zeros(0, dtype=np.int64)
    if len(pairs):
        failed = incumbent.solution.status is SolverStatus.FAILED  # still on its way: go on in larger steps
        rough = failed or incumbent.tolerance > max(2 * search.fine, HANDED_OVER_TOLERANCE)
        start = regrown(search, incumbent, pairs)
        yield replace(
            start,
            tolerance=(None if failed else incumbent.tolerance) if rough else search.fine,
            mu=INITIAL_BARRIER if failed else start.mu,
            multipliers=None if failed else start.multipliers,
        )


def tighten(search: LocalSearch, incumbent: Incumbent, _: bool) -> Iterator[Start]:
    """Go on to the last tolerance, with the stale cells grown anew; where these lead elsewhere, in the same cells."""
    if incumbent.tolerance > 2 * search.fine:
        pairs = search.policy.stale(search, incumbent)
        yield replace(regrown(search, incumbent, pairs), tolerance=search.fine)
        best = search.best
        if best is not None and best.tolerance > 2 * search.fine:
            yield best.start(tolerance=search.fine, mu=best.solution.inner_mu)


def regrow_nearer(search: LocalSearch, incumbent: Incumbent, _: bool) -> Iterator[Start]:
    """Grow the stale cells nearer to the end: past a corner, the walls that matter show only from where it has been passed."""
    if incumbent.active.virtual.any() and not search.large:
        seed = incumbent.solution.inner
        for level in range(1, MAX_NEARER_SEEDS + 1):
            if incumbent.nearer(level) is seed:
                return
            seed = incumbent.nearer(level)
            start = regrown(search, incumbent, search.policy.stale(search, incumbent), level=level)
            yield replace(start, tolerance=search.fine)


def other_side_of_corners(search: LocalSearch, incumbent: Incumbent, _: bool) -> Iterator[Start]:
    """Pass corner contacts on their other side, all at once and, where they are few, each alone."""
    corners = _corner_contacts(incumbent)
    if not len(corners) or search.large:
        return
    yield replace(regrown(search, incumbent, corners, other_side=True), tolerance=search.fine)
    if len(corners) > 1 and _few(incumbent):
        for k in range(len(corners))[::-1]:
            start = regrown(search, incumbent, corners[k : k + 1], other_side=True)
            yield replace(start, tolerance=search.fine)


def congruent_swap(search: LocalSearch, incumbent: Incumbent, _: bool) -> Iterator[Start]:
    """In small assemblies, let joints take the path of a congruent one."""
    count = len(incumbent.program.cells.a)
    whole = all(len(segment.program.cells.a) == count for segment in incumbent.segments)
    if whole and len(incumbent.motion) <= MAX_BRANCHES[1]:
        bodies, cells = search.ready.bodies, incumbent.program.cells
        for swap in congruent_swaps(bodies, cells, incumbent.motion, search.ready.clearance):
            yield replace(_swapped(search, incumbent, swap), tolerance=search.fine)


def branches_left_open(incumbent: Incumbent) -> bool:
    """True where the other sides of corner contacts were too many to be tried."""
    return not (_few(incumbent) or not len(_corner_contacts(incumbent)))


def regrown(
    search: LocalSearch, incumbent: Incumbent, pairs: Ints, *, other_side: bool = False, level: int = 0
) -> Start:
    """The start near an incumbent, with new cells for some pairs grown there.

    The new cells keep the solution itself inside, so the next round can only be better. With `other_side` they avoid the line that a
    corner touches at its very end: the path past the other side of the corner. With `level` the round begins nearer to the solution.
    """
    began = time.perf_counter()
    search.tell(Progress("free spaces", search.rounds, incumbent.solution.iterations, incumbent.value))
    bodies, old, active = search.ready.bodies, incumbent.program.cells, incumbent.active
    start = incumbent.start(level=level)
    if not search.policy.mu_may_grow:
        start = replace(start, mu=min(start.mu, incumbent.mu))
    a, b = old.a[pairs], old.b[pairs]
    seed, keep = relative_pose(bodies, a, b, start.inner), relative_pose(bodies, a, b, incumbent.motion)
    room = np.full(len(pairs), search.ready.clearance)
    target = None if other_side else target_poses(incumbent.program, incumbent.solution.u, active, pairs)
    excluded_edge = active.lines_at_end(incumbent.program, pairs) if other_side else None
    turned_out = np.isin(pairs, active.pair[np.isnan(active.place)])
    grown, good = grow_cells(
        bodies,
        a,
        b,
        seed,
        room,
        keep=keep[:, None, :],
        excluded_edge=excluded_edge,
        target=target,
        to_the_end=turned_out,
        stop=search.preparation_stop,
    )
    cells = replaced(old, pairs[good], select(grown, np.flatnonzero(good)))
    start = replace(start, cells=cells)
    if search.carries_multipliers and level == 0:
        fresh = np.zeros(len(cells.a), dtype=bool)
        fresh[pairs[good]] = True
        start = carried_start(start, incumbent.program, incumbent.solution, fresh)
    search.seconds["freespace"] += time.perf_counter() - began
    return start


def _swapped(search: LocalSearch, incumbent: Incumbent, swap: CongruentSwap) -> Start:
    """The start where some joints have taken the path of another one."""
    bodies, segments = search.ready.bodies, []
    for segment in incumbent.start().segments:
        cells = segment.program.cells
        program = build_program(bodies, exchanged(bodies, cells, swap), search.objective, length=search.ready.clearance)
        motions = followed(bodies, cells, swap, np.array([segment.program.motion(point) for point in segment.points]))
        segments.append(PathSegment(program, tuple(program.variables(motion) for motion in motions)))
    last = segments[-1]
    inner = last.program.motion(last.points[-1])
    return replace(incumbent.start(), cells=last.program.cells, inner=inner, segments=tuple(segments))


def _corner_contacts(incumbent: Incumbent) -> Ints:
    return np.unique(incumbent.active.pair[incumbent.active.at_end])


def _few(incumbent: Incumbent) -> bool:
    return len(_corner_contacts(incumbent)) <= MAX_BRANCHES[0] and len(incumbent.motion) <= MAX_BRANCHES[1]


def _unchecked(search: LocalSearch, incumbent: Incumbent) -> tuple[Ints, Ints]:
    return search.checked_path(incumbent).missed


def _fine(search: LocalSearch) -> float:
    return min(max(FINE_TOLERANCE, TOLERANCE_PER_BODY * len(search.ready.bodies.fixed)), MAX_TOLERANCE)


WITHOUT_BRANCHES = Policy(moves=(regrow_stale, tighten, regrow_nearer), stale=stale, fine=_fine)
"""The best motion in reach of the cells; other sides of corner contacts are not tried, and the path is not audited."""
THOROUGH = replace(
    WITHOUT_BRANCHES, moves=(*WITHOUT_BRANCHES.moves, other_side_of_corners, congruent_swap), unchecked=_unchecked
)
"""What an answer needs."""
CLIMB = replace(WITHOUT_BRANCHES, moves=(regrow_stale, tighten), unchecked=_unchecked, fine=lambda _: 1e-4)
"""A climb that only shows how good a local optimum is."""
RANDOM_CLIMB = replace(
    WITHOUT_BRANCHES, moves=(regrow_stale,), unchecked=_unchecked, fine=lambda _: ROUGH_TOLERANCE, most_rounds=8
)
"""A short climb, with another objective than the true one."""
