"""A first climb among exact distances, for large assemblies: it shows where everything wants to go before any cell is chosen.

A cell commits a pair to some walls. In a large assembly the walls of the first rounds decide in which basin the search ends. Distances of
corners from edges commit to nothing, so this climb ends in a better one; then cells are grown where it came to.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.errors import StoppedError, go_on
from wiggleroom.freespace.cells.cells import Cells, CellWish, concatenated, grow_cells, replaced, select
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.vertex_edge_pairs import near_vertices
from wiggleroom.program.constraint_rows import rows_of
from wiggleroom.program.contact_functions import wall_values
from wiggleroom.program.distance_program import DistanceProgram, build_distances
from wiggleroom.search.active_set import ActiveSet
from wiggleroom.search.carried_start import carried_start
from wiggleroom.search.incumbent import HANDED_OVER_TOLERANCE, Incumbent, PathSegment, Start
from wiggleroom.search.local_search import ESCAPE_DISTANCE, LocalSearch, nudged
from wiggleroom.search.prepare import congruent_cells
from wiggleroom.search.progress import Progress
from wiggleroom.solve import interior_point
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MIN_BODIES = 100
"""In smaller assemblies cells alone come as far."""
CLIMB_TOLERANCE = 1e-3
"""Of the climb: rounds among cells go on from there."""
REACH, BESIDE = 5.0, 1.0
"""Of pairs with edges that face each other: corners up to this far in front of an edge, and beside its ends, are listed [clearances]."""
CORNER_REACH = 12.0
"""The same, both ways, of pairs that are near at a corner only: they pass far by."""
BEHIND = 2.5
"""Corners up to this far behind the line of an edge are listed too: they may come round its end [clearances]."""
FURTHER_CLIMBS = 8
"""Further climbs from points beside rest, in assemblies that are not large: they end at several local optima."""
SCATTER = 0.3
"""Standard deviation of where these begin, in units of the clearance; less where that is not inside all rows."""
KEPT_ROOM = 0.05
"""A pair keeps its cell of rest where all walls are further away than this, in units of the clearance."""
MAX_ROWS_PER_PAIR = 40
"""Curves of many short edges list more, most of them about the same place; there the climb takes too many steps."""
WHOLE_TOLERANCE = 3e-3
"""Of the first rounds of a large assembly where the search begins among cells, those of corners included: coarser ones end lower."""


def climbed(search: LocalSearch, start: Start, further: int = 0) -> Start | Incumbent:
    """Where the search begins after a climb among distances; the start itself where that does not apply or leads nowhere.

    Of the climb and `further` ones, where the assembly is not large, the highest counts. Where it is asked to stop meanwhile, the
    end of the climb is the best motion there is.
    """
    if len(search.ready.bodies.fixed) <= MIN_BODIES or search.solve is not interior_point.solve:
        return start
    began = time.perf_counter()
    program = _program(search, start)
    if program.rows > MAX_ROWS_PER_PAIR * len(program.cells.a):
        return _with_corners(search, start, program) if search.large else start
    rest = program.variables(start.inner)
    begin = nudged(program, rest)
    solution = _climb(search, start, program, begin, audited=True)
    for k in range(0 if search.large else further):
        if solution.status is not SolverStatus.CONVERGED or search.stopped:
            break
        aside = _scattered(program, rest, k)
        other = _climb(search, start, program, aside)
        if other.status is SolverStatus.CONVERGED and _value(program, other) > _value(program, solution):
            begin, solution = aside, other
    search.seconds["solve"] += time.perf_counter() - began
    if solution.status not in (SolverStatus.CONVERGED, SolverStatus.STOPPED) or not solution.path:
        return start
    try:
        return _handed_over(search, start, program, solution)
    except StoppedError:
        motion, none = program.motion(solution.u), np.zeros(0)
        active = ActiveSet(none.astype(np.int64), none.astype(np.int64), none, none)
        value, rest = search.objective.value(motion), program.variables(start.inner)
        return Incumbent(motion, value, program, solution, active, (), rest, CLIMB_TOLERANCE, start.mu)


def _climb(
    search: LocalSearch, start: Start, program: DistanceProgram, begin: Floats, *, audited: bool = False
) -> Solution:
    """One climb; `audited` now and then where it is the one that counts if it is stopped."""
    solution = interior_point.solve(
        program, begin, mu=start.mu, tolerance=CLIMB_TOLERANCE, horizon=ESCAPE_DISTANCE * search.ready.size,
        balanced=False, stop=search.stop, progress=lambda iteration, value: search.tell(Progress("solve", 0, iteration, value)),
        **(search.along((), program, program.variables(start.inner)) if audited else {}),
    )  # fmt: skip
    search.iterations += solution.iterations
    return solution


def _value(program: DistanceProgram, solution: Solution) -> float:
    return program.objective.value(program.motion(solution.u))


def _scattered(program: DistanceProgram, u: Floats, seed: int) -> Floats:
    """A point beside u, well inside all rows, always the same for a seed, in whatever order the bodies stand."""
    x, y, _ = program.bodies.rest[program.free].T.round(6)
    noise, order = np.empty((len(x), 3)), np.lexsort((y, x))
    noise[order] = np.random.default_rng(seed).standard_normal(noise.shape)
    step, room, share = noise.ravel(), program.values(u), SCATTER
    while not (program.values(u + share * step) > 0.3 * room).all():
        share /= 1.5
    return u + share * step


def _program(search: LocalSearch, start: Start) -> DistanceProgram:
    """The distances of all pairs that are near at rest."""
    ready = search.ready
    n = len(ready.bodies.fixed)
    facing, key = start.cells.a * n + start.cells.b, np.union1d(start.cells.a * n + start.cells.b, ready.corners)
    reach = ready.clearance * np.where(np.isin(key, facing), REACH, CORNER_REACH)
    beside = ready.clearance * np.where(np.isin(key, facing), BESIDE, CORNER_REACH)
    near = near_vertices(ready.bodies, key // n, key % n, start.inner, reach, beside, BEHIND * ready.clearance)
    return build_distances(ready.bodies, near, search.objective, length=ready.clearance)


def _handed_over(search: LocalSearch, start: Start, program: DistanceProgram, solution: Solution) -> Start:
    """The start of a search among cells, grown where the climb was still well inside all rows; its end stays inside them."""
    began = time.perf_counter()
    points = [program.variables(start.inner), *solution.path]
    inner = next((k for k, point in enumerate(points) if point is solution.inner), 0)
    end = _last_free(search, [program.motion(point) for point in (*points, solution.u)])
    motion = program.motion((*points, solution.u)[end])
    search.seconds["check"] += time.perf_counter() - began
    began = time.perf_counter()
    inner = min(inner, end)
    search.tell(Progress("free spaces", 0, solution.iterations, search.objective.value(motion)))
    cells = None
    while inner > 0 and cells is None:
        cells = _cells(search, program, program.motion(points[inner]), motion)
        inner = inner if cells is not None else inner // 2
    search.seconds["freespace"] += time.perf_counter() - began
    if cells is None:
        return start
    segment = PathSegment(program, tuple(points[: inner + 1]))
    begun = Start(cells, program.motion(points[inner]), (segment,), solution.inner_mu, HANDED_OVER_TOLERANCE)
    if points[inner] is not solution.inner:
        return begun
    return carried_start(begun, program, solution, np.ones(len(cells.a), dtype=bool))


def _with_corners(search: LocalSearch, start: Start, program: DistanceProgram) -> Start:
    """The start with cells of all pairs of a program: where there are many, those near at a corner only count too."""
    try:
        cells, good = _cells_of_rest(search, program.cells.a, program.cells.b)
    except StoppedError:  # the first round ends at once, with an answer
        return start
    return replace(start, cells=cells, tolerance=WHOLE_TOLERANCE) if good.all() else start


def _last_free(search: LocalSearch, motions: list[Floats]) -> int:
    """The last of some motions, or where parts overlap there the last one before which none do, by bisection."""
    ready = search.ready

    def free(k: int) -> bool:
        go_on(search.stop)
        return overlaps(ready.bodies, motions[k], ready.ignored).deepest <= OVERLAP_TOLERANCE * ready.size

    low, high = 0, len(motions) - 1
    if free(high):
        return high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if free(middle) else (low, middle)
    return low


def _cells(search: LocalSearch, program: DistanceProgram, inner: Floats, end: Floats) -> Cells | None:
    """Cells of all pairs of a program round an inner motion, with the end inside where that is possible; None where there are none.

    Pairs that still have room in their cell of rest, at both motions, keep it: congruent ones share it, so it costs nothing.
    """
    bodies, a, b = search.ready.bodies, program.cells.a, program.cells.b
    seed, keep = relative_pose(bodies, a, b, inner), relative_pose(bodies, a, b, end)
    room = np.full(len(a), search.ready.clearance)
    cells, roomy = _cells_of_rest(search, a, b)
    for pose in (seed, keep):
        roomy &= np.minimum.reduceat(_row_values(bodies, cells, pose), cells.row[:-1]) > KEPT_ROOM * room
    tight = np.flatnonzero(~roomy)
    made, grown = grow_cells(
        bodies, a[tight], b[tight], seed[tight], room[tight], wish=CellWish(keep[tight, None, :]), stop=search.stop
    )
    cells, left = replaced(cells, tight, made), tight[~grown]
    if len(left):
        others, grown = grow_cells(
            bodies, a[left], b[left], seed[left], room[left], wish=CellWish(target=keep[left]), stop=search.stop
        )
        if not grown.all():
            return None
        cells = replaced(cells, left, others)
    return cells


def _cells_of_rest(search: LocalSearch, a: Ints, b: Ints) -> tuple[Cells, NDArray[np.bool_]]:
    """Cells of some pairs at rest, and which of them (P,) are good."""
    ready = search.ready
    n = len(ready.bodies.fixed)
    key, known = a * n + b, ready.cells.a * n + ready.cells.b
    other = np.flatnonzero(~np.isin(key, known))
    room = np.full(len(other), ready.clearance)
    more, fine = congruent_cells(ready.bodies, a[other], b[other], room, search.stop)
    both = concatenated(ready.cells, more)
    order = np.argsort(np.concatenate([known, key[other]]), kind="stable")
    place = order[np.searchsorted(np.concatenate([known, key[other]])[order], key)]
    good = np.concatenate([np.ones(len(known), dtype=bool), fine])
    return select(both, place), good[place]


def _row_values(bodies: Bodies, cells: Cells, pose: Floats) -> Floats:
    """Values (R,) [mm] of all rows of some cells at relative poses (P, 3)."""
    rows, h = rows_of(bodies, cells), np.empty(cells.row[-1])
    wall_values(pose, cells.row, *rows.of_pairs(slice(None)), 1.0, h)
    return h
