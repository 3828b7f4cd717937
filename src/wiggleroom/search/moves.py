"""Moves of the search: where to begin next, seen from the best motion so far."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells, CellWish, grow_cells, replaced, select
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.search.active_set import target_poses
from wiggleroom.search.carried_start import carried_start
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
Floats = NDArray[np.float64]

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
        wish=CellWish(keep[:, None, :], excluded_edge, target, turned_out),
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


POSE_TOLERANCE = 0.05
"""Ends of two joints that differ by less than this share of the clearance are the same."""
MAX_SWAPS = 64
"""Joints are tried one by one where there are no more tries than this."""


@dataclass(frozen=True, eq=False)
class CongruentSwap:
    """Pairs `who` (k,) that take the path of the pair `like`."""

    who: Ints
    like: int


def congruent_swaps(bodies: Bodies, cells: Cells, motion: Floats, clearance: float) -> list[CongruentSwap]:
    """What to try at the end of a motion (n, 3) [mm, mm, rad]: each end for all joints of its kind, and for each joint alone.

    None where the pairs do not hang together as a tree, or there would be too many.
    """
    rest = relative_pose(bodies, cells.a, cells.b)
    if not _is_tree(bodies, cells):
        return []
    _, label = congruence_classes(bodies, cells.a, cells.b, rest)
    end = relative_pose(bodies, cells.a, cells.b, motion) - rest
    end[:, 2] *= np.maximum(bodies.radius[cells.a], bodies.radius[cells.b])
    together: list[CongruentSwap] = []
    alone: list[CongruentSwap] = []
    for kind in range(int(label.max(initial=-1)) + 1):
        same = np.flatnonzero(label == kind)
        for k, like in enumerate(same):
            far = np.abs(end[same] - end[like]).max(axis=1) > POSE_TOLERANCE * clearance
            if not far[:k].all():  # an end that was met before
                continue
            others = same[far]
            if len(others):
                together.append(CongruentSwap(others, int(like)))
                alone += [CongruentSwap(np.array([one]), int(like)) for one in others]
    return [*together, *alone] if len(together) + len(alone) <= MAX_SWAPS else []


def exchanged(bodies: Bodies, cells: Cells, swap: CongruentSwap) -> Cells:
    """The same cells, but `swap.who` with those of `swap.like`."""
    rest = relative_pose(bodies, cells.a, cells.b)
    theirs = select(cells, np.full(len(swap.who), swap.like))
    turns = rest[swap.who] - rest[swap.like]
    turns[:, :2] = 0.0  # congruent, up to whole turns
    mine = replace(
        theirs,
        a=cells.a[swap.who],
        b=cells.b[swap.who],
        ends=theirs.ends + turns[:, 2:],
        seed=theirs.seed + turns,
    )
    return replaced(cells, swap.who, mine)


def followed(bodies: Bodies, cells: Cells, swap: CongruentSwap, motions: Floats) -> Floats:
    """The motions (k, n, 3) [mm, mm, rad] in which `swap.who` are where `swap.like` is, and all other pairs where they were."""
    rest = relative_pose(bodies, cells.a, cells.b)
    now = np.stack([relative_pose(bodies, cells.a, cells.b, motion) for motion in motions], axis=1)
    now[swap.who] = rest[swap.who, None] + (now[swap.like] - rest[swap.like])
    pose, out = bodies.rest + motions, motions.copy()
    for pair, forward in _outwards(bodies, cells):
        a, b = int(cells.a[pair]), int(cells.b[pair])
        if forward:
            pose[:, b, 2] = pose[:, a, 2] + now[pair, :, 2]
            pose[:, b, :2] = pose[:, a, :2] + rotated(now[pair, :, :2], pose[:, a, 2])
        else:
            pose[:, a, 2] = pose[:, b, 2] - now[pair, :, 2]
            pose[:, a, :2] = pose[:, b, :2] - rotated(now[pair, :, :2], pose[:, a, 2])
        moved = b if forward else a
        out[:, moved] = pose[:, moved] - bodies.rest[moved]
    still = ~motions.any(axis=(1, 2))  # rest stays rest, to the last digit
    out[still] = 0.0
    return out


def _is_tree(bodies: Bodies, cells: Cells) -> bool:
    """True where every free body hangs on others, or on what is fixed, by one chain of pairs only."""
    return len(_outwards(bodies, cells)) == len(cells.a)


def _outwards(bodies: Bodies, cells: Cells) -> list[tuple[int, bool]]:
    """Pairs in the order in which they are met from what is fixed, and whether each leads from A to B; none that closes a loop."""
    at: list[list[tuple[int, int, bool]]] = [[] for _ in bodies.fixed]
    for pair, (a, b) in enumerate(zip(cells.a.tolist(), cells.b.tolist(), strict=True)):
        at[a].append((pair, b, True))
        at[b].append((pair, a, False))
    known = bodies.fixed.copy()
    found: list[tuple[int, bool]] = []
    for root in [*np.flatnonzero(bodies.fixed), *np.flatnonzero(~bodies.fixed)]:
        if known[root] and not bodies.fixed[root]:
            continue
        known[root] = True
        todo = deque([int(root)])
        while todo:
            for pair, other, forward in at[todo.popleft()]:
                if not known[other]:
                    known[other] = True
                    found.append((pair, forward))
                    todo.append(other)
    return found
