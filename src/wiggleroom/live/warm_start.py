"""The loop of the search, begun at a state that was reached before instead of at rest, within the time there is."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.freespace.cells.cells import Cells, select
from wiggleroom.geometry.neighbours import relative_rest
from wiggleroom.geometry.overlap import OVERLAP_TOLERANCE, Overlaps, overlaps
from wiggleroom.program.nonlinear_program import build
from wiggleroom.program.objectives import ZERO_MOTION, Objective
from wiggleroom.search.loop import AGAIN, FINE, Found, Search, silent
from wiggleroom.search.path_check import strangers
from wiggleroom.search.prepare import REACH, Prepared
from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.interior_point import INITIAL_BARRIER, solve

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR, NEARER = 1e-3, 2e-4
"""Share of the objective that a live answer may leave on the table, and a drag, where motion sideways to the target gains little."""
SKETCH = 0.03
"""Tolerance of the first rounds: they only show which cells are left."""
SEEN = 5e-3
"""A drag ends within this share of the clearance of where it could."""
LEFT = 0.5
"""Share of that which virtual walls may hold back, were they all to give way by a clearance."""
FIRST = 3e-3
MOST_ROUNDS = 30
SOME = 8
"""So many of a way's points show where it leads: the solver's steps wander."""
ROOM, LEAST_ROOM, SOFTER, MOST_PUSHES = 2e-3, 1e-6, 1e-6, 8
"""Room that a push aims at and is content with, in clearances; weight of rows that need none; so many pushes are tried."""
SHARP = 1e-6
"""Slacks that are right to this share of the clearance are exact enough for a picture, where all walls hold."""
ENDED = ("converged", "enough")
LEAST_ASKED = 8
"""A round is given so many iterations whatever the time: else a large assembly would never get anywhere."""
MOST_TRIES = 3
"""So often a shot is begun again because a part may meet another on its way that was not thought of."""


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


def at_rest(ready: Prepared) -> State:
    """Return the state at rest."""
    still = np.zeros((len(ready.bodies.fixed), 3))
    return State(ready.cells, still, still)


@dataclass(eq=False)
class Until:
    """Stops at a time, or when somebody else says so; asked every iteration."""

    seconds: float
    stop: Stop | None = None

    def __post_init__(self) -> None:
        """Start the clock."""
        self._end, self._asked = time.perf_counter() + self.seconds, 0

    def is_set(self) -> bool:
        """True to stop."""
        self._asked += 1
        told = self.stop is not None and self.stop.is_set()
        return told or (self._asked > LEAST_ASKED and time.perf_counter() > self._end)


@dataclass(eq=False)
class Warm(Search):
    """The search from a state. Other sides of corner contacts are not tried; the way from the state is looked at by `reach`."""

    state: State = field(kw_only=True)
    precise: bool = False
    last: Found | None = None
    mu: float = INITIAL_BARRIER
    near: bool = False
    done: bool = False
    seen: tuple[Floats, Overlaps] | None = None

    def begin(self) -> None:
        """Begin at the state, knowing of no way before it."""
        self.cells, self.inner, self.first_mu = self.state.cells, self.state.inner, self.state.mu
        self.legs, self.best, self.last = (), None, None

    def run(self) -> None:
        """Go through the rounds: roughly while that brings something, then as well as a picture needs."""
        self.near, mu, self.done = self.state.near, self.first_mu, False
        while self.rounds < MOST_ROUNDS:
            found = self._round(self._tolerance if self.near else SKETCH, mu)
            self.last, self.mu = found, mu
            if found.solution.status == "stopped":
                self._keep(found)
                return
            if self._add_missed(found):
                continue
            gained = self._keep(found)
            best = self.best or found
            stale = self._stale(best)
            mu = min(mu, AGAIN * best.solution.inner_mu)  # near walls, more would drive it out
            again = gained and len(stale) > 0
            fine = found.tolerance <= 2 * self._tolerance  # a first round does not know yet how much there is to gain
            if self.unlimited or found.solution.status == "enough" or (self.near and not again and fine):
                break
            self.near = self.near or not again
            self._rebuild(best, stale)
            if self.stopped:
                return
        self.done = True

    @property
    def _tolerance(self) -> float:
        """Of the last rounds: a drag that gained much may still have little left to gain, which should be seen."""
        if not self.precise:
            return NEAR
        if self.best is None or self.best.value <= 0:
            return NEARER
        pull = float(np.abs(self.objective.gradient(self.best.motion)[:, :2]).max())
        return float(np.clip(SEEN * self.ready.clearance * pull / self.best.value, FINE, NEARER))

    def _stale(self, found: Found) -> Ints:
        """Pairs whose cells stop the motion although nothing touches there, without those that together hold hardly anything."""
        touch, pairs = found.touch, super()._stale(found)
        if found.solution.status == "failed" or not len(pairs):
            return pairs
        held = np.bincount(touch.pair[touch.virtual], touch.force[touch.virtual])[pairs] * self._room(found)[pairs]
        order = np.argsort(held)
        least = LEFT * found.tolerance * max(abs(found.value), self.ready.clearance * float(touch.force.max()))
        return pairs[np.sort(order[np.cumsum(held[order]) > least])]

    def _room(self, found: Found) -> Floats:
        """By how much (P,) [mm] each pair's virtual walls may give way: a clearance, or as far as it has come since they gave nothing."""
        bodies, cells, clearance = self.ready.bodies, found.program.cells, self.ready.clearance
        room, ended = np.full(len(cells.a), clearance), self.state.ended
        if ended is not None and self.state.near and not self.precise:
            a, b = cells.a[: len(ended)], cells.b[: len(ended)]
            come = np.abs(relative_rest(bodies, a, b, found.motion) - ended)
            come[:, 2] *= np.minimum(bodies.radius[a], bodies.radius[b])
            room[: len(ended)] = np.minimum(come.sum(axis=1), clearance)
        return room

    def reach(self) -> tuple[State, bool]:
        """Search, and return the state that was reached, and whether the search came to its end.

        The motion of the new state is free of overlap and no pair outside the program can have met on the way to it; where none was
        found that is better, it is that of the old state.
        """
        before = self.state
        for _ in range(MOST_TRIES):
            self.run()
            found = self.best
            if found is None:
                break
            motion = self._end(found)
            if motion is None and not self.stopped:
                continue
            settled = self.done and motion is not None
            if motion is None or (not settled and self.objective.value(motion) < self.objective.value(before.motion)):
                motion = before.motion
            return self._state(motion, before), settled
        return replace(before, cells=self.cells, inner=self.inner, mu=INITIAL_BARRIER), False

    @property
    def stopped(self) -> bool:
        """True where it was asked to stop."""
        return self.stop is not None and self.stop.is_set()

    def _end(self, found: Found) -> Floats | None:
        """Safe motion at the end of a search; None where there is none, and the pairs that were missed are in the program."""
        motion = found.motion
        if found.solution.status not in ENDED:  # the last iterate may be on its way through a wall; these are not
            motion = found.program.motion(found.solution.way[-1] if found.solution.way else found.begin)
        if self._overlaps(motion).deepest > OVERLAP_TOLERANCE * self.ready.size:
            self.begin()
            self._add_missed(found)
            return None
        return None if self._meets_strangers(found) else motion

    def _missed(self, found: Found, known: Ints) -> Overlaps:
        all_pairs = self._overlaps(found.motion)
        new = ~np.isin(all_pairs.a * len(found.motion) + all_pairs.b, known)
        return Overlaps(all_pairs.a[new], all_pairs.b[new], all_pairs.depth[new])

    def _overlaps(self, motion: Floats) -> Overlaps:
        """Everything that overlaps at a motion; asked for twice where a search ends, worked out once."""
        if self.seen is None or self.seen[0] is not motion:
            self.seen = motion, overlaps(self.ready.bodies, motion, self.ready.barred)
        return self.seen[1]

    def _meets_strangers(self, found: Found) -> bool:
        """Begin again with the pairs that were not in the program and may meet on the way; True where there were any."""
        cells, n, ready = found.program.cells, len(found.motion), self.ready
        legs = (*found.legs, found.leg(found.solution.u))
        points = [(leg.program, u) for leg in legs for u in leg.points]
        some = np.unique(np.linspace(0, len(points) - 1, SOME).round().astype(int))
        motions = np.array([points[k][0].motion(points[k][1]) for k in some])
        a, b = strangers(ready.bodies, ready.arm, motions, cells.a * n + cells.b, ready.barred)
        if len(a):
            self._begin_with(np.concatenate([cells.a * n + cells.b, a * n + b]), found.motion)
        return len(a) > 0

    def _state(self, motion: Floats, before: State) -> State:
        """The state at a motion, without the pairs that were added on the way and are far apart now."""
        inner, mu, last = self.inner, self.first_mu, self.last
        if last is not None and last.program.cells is self.cells:
            inner = last.program.motion(last.solution.inner)
            mu = last.solution.inner_mu * (1.0 if last.solution.status == "stopped" else AGAIN)
            mu = min(mu, self.mu)
        cells, first = self.cells, len(self.ready.cells.a)
        ended = relative_rest(self.ready.bodies, cells.a, cells.b, motion) if self.done else None
        if before.ended is not None and self.rounds == 1:  # nothing was grown: how far it has come adds up
            ended = before.ended
        late = np.arange(len(cells.a)) >= first
        place, radius = (self.ready.bodies.rest + motion)[:, :2], self.ready.bodies.radius
        apart = np.hypot(*(place[cells.b] - place[cells.a]).T) - radius[cells.a] - radius[cells.b]
        far = late & (apart > REACH * self.ready.clearance)
        if far.any():
            cells, ended = select(cells, np.flatnonzero(~far)), ended if ended is None else ended[~far[: len(ended)]]
        return State(
            cells,
            inner,
            motion,
            mu if not self.done else max(mu, FIRST),
            self.near and not self.done,
            before.linked,
            ended,
        )


def warm(ready: Prepared, objective: Objective, state: State, stop: Stop | None, enough: float | None = None) -> Warm:
    """Return a search that begins at a state; a drag, where it ends once the objective is worth `enough`."""
    solver = partial(solve, enough=np.inf if enough is None else enough, exact=SHARP)
    return Warm(ready, objective, solver, stop, silent, thorough=False, state=state, precise=enough is not None)


def pushed(ready: Prepared, state: State) -> State | None:
    """Return the state with its inner point moved a little, until it is strictly inside all cells; None where that does not help."""
    program = build(ready.bodies, state.cells, ZERO_MOTION, length=ready.clearance)
    u, matrix = program.variables(state.inner), factor(program.pattern)
    for _ in range(MOST_PUSHES):
        at = program.linearise(u)
        short = np.maximum(ROOM - at.h, 0.0)
        if at.h.min(initial=np.inf) > LEAST_ROOM:
            return replace(state, inner=program.motion(u))
        weight = np.where(at.h < 2 * ROOM, 1.0, SOFTER)
        shift = SOFTER
        while not matrix.update(at.condensed(weight, np.zeros_like(weight), share=0.0), shift):
            shift *= 100
        u = u + matrix.solve(at.against(short))
    return None
