"""The loop of the search, begun at a state that was reached before instead of at rest, within the time there is."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from threading import Event

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.errors import Stop
from wiggleroom.freespace.cells.cells import Cells, CellWish, grow_cells, replaced, select
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective
from wiggleroom.search.incumbent import BARRIER_GROWTH, Incumbent, Start
from wiggleroom.search.local_search import FINE_TOLERANCE, LocalSearch, Policy
from wiggleroom.search.moves import regrow_stale, stale, tighten
from wiggleroom.search.path_check import missed_at
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared
from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.interior_point import solve
from wiggleroom.solve.interior_point_settings import INITIAL_BARRIER
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LIVE_TOLERANCE, DRAG_TOLERANCE = 1e-3, 2e-4
"""Share of the objective that a live answer may lose, and a drag, where motion sideways to the target gains little."""
SKETCH_TOLERANCE = 0.03
"""Tolerance of the first rounds: they only show which cells are left."""
VISIBLE_DISTANCE = 5e-3
"""A drag ends within this share of the clearance of where it could."""
TOLERATED_LOSS = 0.5
"""Share of that which virtual walls may hold back, were they all to give way by a clearance."""
FIRST_BARRIER = 3e-3
"""Complementarity that the next request begins with at least, as a share of the largest derivative of the objective."""
MAX_LIVE_ROUNDS = 30
"""Rounds of one request at most, whatever its time."""
PATH_SAMPLES = 8
"""Number of the path's points that show where it leads: the solver's steps are not straight."""
WANTED_ROOM, MIN_ROOM, SLACK_ROW_WEIGHT, MAX_PUSHES = 2e-3, 1e-6, 1e-6, 8
"""Room that a push aims at, and is content with [clearances]; weight of rows that need none; most pushes that are tried."""
PICTURE_TOLERANCE = 1e-6
"""Slacks that are right to this share of the clearance are exact enough for a picture, where all walls hold."""
FINISHED = (SolverStatus.CONVERGED, SolverStatus.ENOUGH)
"""Ends of a solve after which its last iterate is in all walls."""
ASIDE_SHARES = (0.01, 0.05, 0.2)
"""Shares of the clearance by which pairs that touch are taken aside to grow their cells."""
MIN_LIVE_ITERATIONS = 8
"""Least iterations of a round, whatever the time: without them a large assembly would make no progress."""


@dataclass(frozen=True, eq=False)
class State:
    """Where a live assembly is.

    Parameters
    ----------
    cells : Cells
        One a pair; between them and those at rest leads a chain of cells, each sharing a point with the next.
    inner : (n, 3) float64 [mm, mm, rad]
        Motion of the bodies strictly inside all cells, where the next search begins.
    motion : (n, 3) float64 [mm, mm, rad]
        Motion that is shown, in cells that share a point with these; free of overlap.
    mu : float
        Complementarity to begin with.
    near : bool
        True where the end cannot be far: no rough rounds are needed.
    linked : bool
        False where that chain is not known: the motion was followed from a larger gap, whose parts may pass where these do not.
    ended : (P, 3) float64 [mm, mm, rad], optional
        Where the pairs were seen when a search for the same goals came to its end: new cells brought nothing there.
    """

    cells: Cells
    inner: Floats
    motion: Floats
    mu: float = INITIAL_BARRIER
    near: bool = False
    linked: bool = True
    ended: Floats | None = None


def state_at_rest(ready: Prepared) -> State:
    """Return the state at rest."""
    still = np.zeros((len(ready.bodies.fixed), 3))
    return State(ready.cells, still, still)


def state_at(ready: Prepared, motion: Floats, inner: Floats | None = None) -> State | None:
    """Return the state at a motion (n, 3) of the bodies, its cells grown there; None where they overlap or no free space is found.

    `inner` is a motion nearby at which nothing touches, where one is known. Cells of pairs that touch are grown from a pose of that pair
    a little aside.
    """
    if not free_of_overlap(ready, motion):
        return None
    cells = _cells_at(ready, motion, motion if inner is None else inner, kept=True)
    return (
        None if cells is None else pushed(ready, State(cells, motion if inner is None else inner, motion, linked=False))
    )


def state_beside(ready: Prepared, motion: Floats) -> State | None:
    """Return a state next to a motion (n, 3) that is known to single precision, where parts that touch may overlap by rounding."""
    cells = _cells_at(ready, motion, motion, kept=False)
    found = None if cells is None else pushed(ready, State(cells, motion, motion, linked=False))
    return None if found is None or not free_of_overlap(ready, found.inner) else replace(found, motion=found.inner)


def _cells_at(ready: Prepared, motion: Floats, inner: Floats, *, kept: bool) -> Cells | None:
    """Return a cell of each pair round `inner`, or round a pose a little aside where it touches; with `kept` the motion lies in all."""
    bodies, a, b = ready.bodies, ready.cells.a, ready.cells.b
    there, room = relative_pose(bodies, a, b, motion), np.full(len(a), ready.clearance)
    keep = there[:, None, :] if kept else there[:, None, :][:, :0]
    cells, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, inner), room, wish=CellWish(keep))
    for share, angle in product(ASIDE_SHARES, np.pi / 4 * np.arange(8)):
        bad = np.flatnonzero(~good)
        if not len(bad):
            break
        aside = there[bad] + share * ready.clearance * np.array([np.cos(angle), np.sin(angle), 0.0])
        grown, fits = grow_cells(bodies, a[bad], b[bad], aside, room[bad], wish=CellWish(keep[bad]))
        cells = replaced(cells, bad[fits], select(grown, np.flatnonzero(fits)))
        good[bad[fits]] = True
    return cells if good.all() else None


def seated(ready: Prepared, state: State) -> State:
    """The same state, its inner point near the motion that is shown: a search that stopped may have left it far behind."""
    behind = state.inner - state.motion
    far = np.hypot(behind[:, 0], behind[:, 1]) + ready.bodies.radius * np.abs(behind[:, 2])
    if far.max(initial=0.0) <= ready.clearance:
        return state
    there = state_at(ready, state.motion)
    return state if there is None else replace(there, linked=state.linked)


@dataclass(eq=False)
class TimeBudget:
    """Stops at a time, or on another request to stop, `interrupt`, that is never made where nobody can; asked every iteration."""

    seconds: float
    stop: Stop | None = None

    def __post_init__(self) -> None:
        """Start the clock."""
        self._end, self._asked = time.perf_counter() + self.seconds, 0
        self.interrupt: Stop = Event() if self.stop is None else self.stop

    def is_set(self) -> bool:
        """True to stop."""
        self._asked += 1
        return self.interrupt.is_set() or (self._asked > MIN_LIVE_ITERATIONS and time.perf_counter() > self._end)


@dataclass(eq=False)
class WarmSearch:
    """A search from a state, for live questions.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    state : State
    until : TimeBudget
    enough : float, optional
        For a drag: the search ends once the objective is worth so much.
    """

    ready: Prepared
    objective: Objective
    state: State
    until: TimeBudget
    enough: float | None = None
    search: LocalSearch = field(init=False)
    _seen: tuple[Incumbent, tuple[Ints, Ints]] | None = None

    def __post_init__(self) -> None:
        """Choose moves and tolerances."""
        policy = Policy(
            moves=(regrow_stale, tighten), stale=self._stale, fine=self._tolerance, unchecked=self._unchecked,
            rough=SKETCH_TOLERANCE, mu_may_grow=False, most_rounds=MAX_LIVE_ROUNDS,
            interrupt=self.until.interrupt,
        )  # fmt: skip
        solver = partial(solve, enough=np.inf if self.enough is None else self.enough, exact=PICTURE_TOLERANCE)
        self.search = LocalSearch(self.ready, self.objective, solver, policy, self.until)

    @property
    def best(self) -> Incumbent | None:
        """The best motion of the search."""
        return self.search.best

    def reach(self) -> tuple[State, bool]:
        """Search, and return the state that was reached, and whether the search came to its end.

        The motion of the new state is free of overlap and no pair outside the program can have met on the path to it; where none was
        found that is better, it is that of the old state. Somebody who does not wait for the end of its time gets the old state.
        """
        before, search = self.state, self.search
        near = search.policy.fine(search) if before.near else None
        start = Start(before.cells, before.inner, mu=before.mu, tolerance=near)
        found = search.improve(start)
        if self.until.interrupt.is_set():  # to look whether parts overlap would take as long as the search did
            return before, False
        motion = None if found is None else self._safe_end(found)
        if found is not None and motion is None:
            search.go_back(start)  # parts meet there that no cell keeps apart: the next search begins before that
        settled = search.ended and motion is not None
        value = self.objective.value
        if motion is None or (not settled and value(motion) < value(before.motion)):
            motion = before.motion
        return self._state(motion, settled), settled

    def _tolerance(self, search: LocalSearch) -> float:
        """Of the last rounds: a drag that gained much may still have little left to gain, which should be seen."""
        if self.enough is None:
            return LIVE_TOLERANCE
        if search.best is None or search.best.value <= 0:
            return DRAG_TOLERANCE
        pull = float(np.abs(self.objective.gradient(search.best.motion)[:, :2]).max())
        return float(
            np.clip(VISIBLE_DISTANCE * self.ready.clearance * pull / search.best.value, FINE_TOLERANCE, DRAG_TOLERANCE)
        )

    def _stale(self, search: LocalSearch, found: Incumbent) -> Ints:
        """Pairs whose cells stop the motion although nothing touches there, without those that together hold hardly anything."""
        active, pairs = found.active, stale(search, found)
        if found.solution.status is SolverStatus.FAILED or not len(pairs):
            return pairs
        held = np.bincount(active.pair[active.virtual], active.force[active.virtual])[pairs] * self._room(found)[pairs]
        order = np.argsort(held)
        least = (
            TOLERATED_LOSS * found.tolerance * max(abs(found.value), self.ready.clearance * float(active.force.max()))
        )
        return pairs[np.sort(order[np.cumsum(held[order]) > least])]

    def _room(self, found: Incumbent) -> Floats:
        """By how much (P,) [mm] each pair's virtual walls may give way: a clearance, or as far as it has come since they gave nothing."""
        bodies, cells, clearance = self.ready.bodies, found.program.cells, self.ready.clearance
        room, ended = np.full(len(cells.a), clearance), self.state.ended
        if ended is not None and self.state.near and self.enough is None:
            a, b = cells.a[: len(ended)], cells.b[: len(ended)]
            come = np.abs(relative_pose(bodies, a, b, found.motion) - ended)
            come[:, 2] *= np.minimum(bodies.radius[a], bodies.radius[b])
            room[: len(ended)] = np.minimum(come.sum(axis=1), clearance)
        return room

    def _safe_end(self, found: Incumbent) -> Floats | None:
        """The motion of an incumbent; None where something overlaps there or may have met on the path."""
        motion = found.motion
        if found.solution.status not in FINISHED:  # the last iterate may be on its way through a wall; these are not
            motion = found.program.motion(found.solution.path[-1] if found.solution.path else found.begin)
        if not free_of_overlap(self.ready, motion):
            return None
        return None if len(self._unchecked(self.search, found)[0]) else motion

    def _unchecked(self, _: LocalSearch, found: Incumbent) -> tuple[Ints, Ints]:
        """Pairs outside the program that may meet on the path, seen at some of its points."""
        if self._seen is not None and self._seen[0] is found:
            return self._seen[1]
        ready = self.ready
        points = [(segment.program, u) for segment in found.path for u in segment.points]
        some = np.unique(np.linspace(0, len(points) - 1, PATH_SAMPLES).round().astype(int))
        motions = np.array([points[k][0].motion(points[k][1]) for k in some])
        self._seen = found, missed_at(ready, motions, found.program)
        return self._seen[1]

    def _state(self, motion: Floats, settled: bool) -> State:
        """The state at a motion, without the pairs that were added on the way and are far apart now."""
        before, last, coming = self.state, self.search.last, self.search.coming
        cells, inner, mu = before.cells, before.inner, before.mu
        if coming is not None:
            cells, inner, mu = coming.cells, coming.inner, coming.mu
        if last is not None and last.program.cells is cells:
            inner = last.program.motion(last.solution.inner)
            mu = min(
                mu, last.solution.inner_mu * (1.0 if last.solution.status is SolverStatus.STOPPED else BARRIER_GROWTH)
            )
        first, rounds = len(self.ready.cells.a), self.search.rounds
        ended = relative_pose(self.ready.bodies, cells.a, cells.b, motion) if settled else None
        if before.ended is not None and rounds == 1:  # nothing was grown: how far it has come adds up
            ended = before.ended
        late = np.arange(len(cells.a)) >= first
        place, radius = (self.ready.bodies.rest + motion)[:, :2], self.ready.bodies.radius
        apart = np.hypot(*(place[cells.b] - place[cells.a]).T) - radius[cells.a] - radius[cells.b]
        far = late & (apart > NEIGHBOUR_REACH * self.ready.clearance)
        if far.any():
            cells, ended = select(cells, np.flatnonzero(~far)), ended if ended is None else ended[~far[: len(ended)]]
        fine = coming is not None and coming.tolerance is not None and coming.tolerance < SKETCH_TOLERANCE
        near = not settled and (before.near or fine)
        return State(cells, inner, motion, max(mu, FIRST_BARRIER) if settled else mu, near, before.linked, ended)


def free_of_overlap(ready: Prepared, motion: Floats, known: Floats | None = None) -> bool:
    """True where no two bodies overlap at a motion (n, 3) of theirs, by exact geometry; `known` is another that is free."""
    if known is None and audit_path(ready.outlines, of_parts(ready.assembly, ready.bodies, motion[None])).free:
        return True  # quicker, but it has no word on parts that overlap by a rounding error
    moved = None if known is None else (motion != known).any(axis=1)
    return overlaps(ready.bodies, motion, ready.ignored, moved).deepest <= OVERLAP_TOLERANCE * ready.size


def pushed(ready: Prepared, state: State) -> State | None:
    """Return the state with its inner point moved a little, until it is strictly inside all cells; None where that does not help."""
    program = build_program(ready.bodies, state.cells, ZERO_MOTION, length=ready.clearance)
    u, matrix = program.variables(state.inner), factor(program.pattern)
    for _ in range(MAX_PUSHES):
        at = program.linearise(u)
        short = np.maximum(WANTED_ROOM - at.h, 0.0)
        if at.h.min(initial=np.inf) > MIN_ROOM:
            return replace(state, inner=program.motion(u))
        weight = np.where(at.h < 2 * WANTED_ROOM, 1.0, SLACK_ROW_WEIGHT)
        shift = SLACK_ROW_WEIGHT
        while not matrix.update(at.condensed(weight, np.zeros_like(weight), share=0.0), shift):
            shift *= 100
        u = u + matrix.solve(at.transposed_jacobian_product(short))
    return None
