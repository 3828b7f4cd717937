"""The loop: solve, rebuild the cells that stopped the motion without a contact, look for pairs that were missed, repeat."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.freespace.cells.cells import Cells, grow_cells, joined, replaced, select
from wiggleroom.geometry.neighbours import relative_rest
from wiggleroom.geometry.overlap import OVERLAP_TOLERANCE, Overlaps, overlaps
from wiggleroom.program.nonlinear_program import Program, build
from wiggleroom.program.objectives import Objective
from wiggleroom.search.active_set import Touch, touching, wishes
from wiggleroom.search.congruent_swap import Twin, exchanged, followed, twins
from wiggleroom.search.path_check import Way, whole_way
from wiggleroom.search.prepare import Prepared
from wiggleroom.solve.interior_point import INITIAL_BARRIER, Solution

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUGH, FINE = 1e-2, 1e-6
"""Tolerance of the first rounds, which only show where everything wants to go, and of the others."""
AGAIN = 5.0
"""A round begins with this multiple of the complementarity at the inner point of the one before: its new cells leave more to gain."""
MOST_ROUNDS = 200
EACH, COARSE = 1e-8, 5e-5
"""Share of the objective that each body may leave on the table, where that is more than the tolerance, and all together at most."""
GAIN = 2e-7
"""A gain below this share of the objective for each body is none."""
FAR = 4.0
"""A body that moves further than this multiple of the drawing's size leaves."""
NUDGE = 1e-3
"""Standard deviation of the first, random displacement, in units of the clearance."""
FEW = 8, 100
"""Up to so many corner contacts are tried one by one, in an assembly of up to so many bodies."""
NEARER = 2
"""So often pairs whose virtual walls stay are rebuilt from nearer to the end."""
MOST_RESTARTS = 3
"""So often the search begins again because a part may meet another on the way that was not thought of."""
MANY = 1000
"""In larger assemblies the other sides of corner contacts are left open, and new cells must bring more to go on."""
ROUND = 2.0 * np.pi + 0.5
"""A body that turns further than this [rad] can turn without limit."""


@dataclass(frozen=True)
class Progress:
    """What a progress callback is told: stage ("pairs", "free spaces", "solve" or "check"), round, iteration and objective [mm]."""

    stage: str
    round: int = 0
    iteration: int = 0
    objective: float = 0.0


@dataclass(frozen=True, eq=False)
class Leg:
    """A piece of the way inside the cells of one program: points in its scaled variables."""

    program: Program
    points: tuple[Floats, ...]


@dataclass(frozen=True, eq=False)
class Found:
    """A safe motion, and how it was found.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad]
        Of the bodies.
    value : float
        Objective there.
    program, solution, touch
        The round that gave it, and its active rows.
    legs : tuple of Leg
        The way from rest to where the round began.
    begin : (3F,) float64
        Where the round began.
    tolerance : float
        Of the round.
    """

    motion: Floats
    value: float
    program: Program
    solution: Solution
    touch: Touch
    legs: tuple[Leg, ...]
    begin: Floats
    tolerance: float

    def nearer(self, level: int) -> Floats:
        """A legal point (3F,) of the round's way nearer to its end than the inner one: level 1 half as near in steps, 2 a quarter."""
        way, inner = self.solution.way, self.solution.inner
        start = next((k for k, u in enumerate(way) if u is inner), -1)  # else it stands before the way
        steps = (len(way) - 1 - start) // 2**level
        return way[len(way) - 1 - steps] if way else inner

    def can_be_nearer(self, level: int) -> bool:
        """True where that is another point than one level before."""
        return self.nearer(level) is not (self.nearer(level - 1) if level > 1 else self.solution.inner)

    def leg(self, end: Floats) -> Leg:
        """The round's piece of the way, up to its point `end` or to its solution."""
        points = [self.begin, *self.solution.way, self.solution.u]
        last = next(k for k, point in enumerate(points) if point is end or np.array_equal(point, end))
        return Leg(self.program, tuple(points[: last + 1]))


@dataclass(eq=False)
class Search:
    """State of the loop: the cells of the coming round, the point strictly inside them where it begins, and the best motion so far."""

    ready: Prepared
    objective: Objective
    solve: Callable[..., Solution]
    stop: Stop | None
    tell: Callable[[Progress], None]
    cells: Cells = field(init=False)
    inner: Floats = field(init=False)
    legs: tuple[Leg, ...] = ()
    best: Found | None = None
    first_mu: float = INITIAL_BARRIER
    restarts: int = 0
    rounds: int = 0
    iterations: int = 0
    branches_left: bool = False
    thorough: bool = True
    """False: other sides of corner contacts are not tried, and the way is not checked."""
    checked: tuple[Found, Way] | None = None
    seconds: dict[str, float] = field(default_factory=lambda: {"freespace": 0.0, "solve": 0.0, "check": 0.0})

    def __post_init__(self) -> None:
        """Begin at rest."""
        self.begin()

    def begin(self) -> None:
        """Begin at rest, knowing of no way yet."""
        self.cells, self.legs, self.best = self.ready.cells, (), None
        self.inner = np.zeros((len(self.ready.bodies.fixed), 3))

    def resume(self, found: Found) -> None:
        """Begin near an earlier motion, with the cells it was found in."""
        self.cells = found.program.cells
        self.inner = found.program.motion(found.solution.inner)
        self.legs = (*found.legs, found.leg(found.solution.inner))
        self.first_mu = AGAIN * found.solution.inner_mu

    def run(self) -> None:
        """Search until every active wall is a real contact, nothing stops the motion, or it was asked to stop."""
        fine = min(max(FINE, EACH * len(self.inner)), COARSE)
        tolerance, mu = ROUGH, self.first_mu
        polished = False
        nearer = 0  # the last rebuildings began so much nearer to the end
        # other sides of corner contacts and ends of other joints still to be tried
        branches: list[Ints | Twin] | None = None
        while self.rounds < MOST_ROUNDS:
            found = self._round(tolerance, mu)
            if tolerance > fine and self._add_missed(found):
                continue
            gained = self._keep(found)
            if found.solution.status == "stopped":
                return
            if self.unlimited:
                if self._meets_strangers(found):
                    tolerance, mu = ROUGH, INITIAL_BARRIER
                    continue
                return
            best, mu = self.best or found, AGAIN * found.solution.inner_mu
            stale = self._stale(found)
            if gained and len(stale):
                branches, nearer = None, 0
                if found.solution.status == "failed":  # still on its way: go on in larger steps
                    tolerance, mu = ROUGH, INITIAL_BARRIER
                self._rebuild(found, stale)
            elif tolerance == ROUGH and found.value >= best.value - ROUGH * abs(best.value):
                tolerance = fine
                self._rebuild(found, stale)
            elif best.tolerance > fine and not polished:
                # new cells led elsewhere: finish the rough answer in its own cells
                tolerance = fine
                polished, mu = True, best.solution.inner_mu
                self._rebuild(best, stale[:0])
            elif best.touch.virtual.any() and nearer < NEARER and not self.large and best.can_be_nearer(nearer + 1):
                # past a corner, the walls that matter show only from where the corner has been passed
                nearer, mu = nearer + 1, AGAIN * best.solution.inner_mu
                self._rebuild(best, self._stale(best), nearer=nearer)
            else:
                if branches is None or gained:
                    branches = self._branches(best) if self.thorough else []
                if not branches:
                    if self._add_missed(best):
                        self.best = branches = None
                    elif self.thorough and self._meets_strangers(best):
                        tolerance, mu, branches = ROUGH, INITIAL_BARRIER, None
                    else:
                        return
                    continue
                mu = AGAIN * best.solution.inner_mu
                branch = branches.pop()
                if isinstance(branch, Twin):
                    self._follow(best, branch)
                else:
                    self._rebuild(best, branch, other_side=True)

    def _stale(self, found: Found) -> Ints:
        """Pairs whose cells stop the motion although nothing touches there; all that moved, where the solver did not get to an end."""
        if found.solution.status != "failed":
            return np.unique(found.touch.pair[found.touch.virtual])
        cells = found.program.cells
        moved = relative_rest(self.ready.bodies, cells.a, cells.b, found.motion) - cells.seed
        return np.flatnonzero(np.hypot(moved[:, 0], moved[:, 1]) > self.ready.clearance)

    @property
    def large(self) -> bool:
        """True where the last hundredth of a per cent would cost more than all before."""
        return len(self.ready.bodies.fixed) > MANY

    @property
    def unlimited(self) -> bool:
        """True where a body that the objective is about has moved or turned so far that nothing stops it."""
        if self.best is None:
            return False
        asked = (self.objective.gradient(self.best.motion) != 0).any(axis=1)
        far = np.hypot(*self.best.motion[asked, :2].T).max(initial=0.0) > FAR * self.ready.size
        return bool(far or np.abs(self.best.motion[asked, 2]).max(initial=0.0) > ROUND)

    def _round(self, tolerance: float, mu: float) -> Found:
        """Build and solve the program of the present cells."""
        began = time.perf_counter()
        program = build(self.ready.bodies, self.cells, self.objective, length=self.ready.clearance)
        self.rounds += 1
        number, begin = self.rounds, program.variables(self.inner)
        solution = self.solve(
            program, begin if self.legs else nudged(program, begin), mu=mu, tolerance=tolerance,
            horizon=FAR * self.ready.size, stop=self.stop,
            progress=lambda iteration, value: self.tell(Progress("solve", number, iteration, value)),
        )  # fmt: skip
        self.iterations += solution.iterations
        motion = program.motion(solution.u)
        touch = touching(program, solution.u, solution.lam)
        self.seconds["solve"] += time.perf_counter() - began
        return Found(motion, self.objective.value(motion), program, solution, touch, self.legs, begin, tolerance)

    def _keep(self, found: Found) -> bool:
        """Keep what is better than the best so far, or surer and not much worse; True where it is better by more than it might err."""
        rough = self.best.tolerance if self.best and self.large else found.tolerance
        least = max(GAIN * len(found.motion), 0.3 * rough) * max(abs(found.value), self.ready.clearance)
        before = self.best.value if self.best else 0.0
        surer = self.best is not None and (
            found.tolerance < self.best.tolerance
            or (self.best.solution.status, found.solution.status) == ("failed", "converged")
        )
        gained = found.value - before > least
        # as good is not enough where walls hold it that nothing touches
        worse = self.best is not None and bool(found.touch.virtual.any()) and not self.best.touch.virtual.any()
        allowed = 0.1 * ROUGH * abs(before) if surer else 0.0
        if self.best is None or gained or (found.value >= before - allowed and (surer or not worse)):
            self.best = found
        return gained

    def _add_missed(self, found: Found) -> bool:
        """Add the pairs that overlap at the solution and were not in the program; True where there were any."""
        began = time.perf_counter()
        self.tell(Progress("check", self.rounds, found.solution.iterations, found.value))
        n = len(self.ready.bodies.fixed)
        known = self.cells.a * n + self.cells.b
        missed = self._missed(found, known)
        if len(missed.a):
            key = np.unique(
                np.concatenate([missed.a * n + missed.b, self.ready.corners[~np.isin(self.ready.corners, known)]])
            )
            self.add(key // n, key % n, found.motion)
        self.seconds["check"] += time.perf_counter() - began
        return len(missed.a) > 0

    def _missed(self, found: Found, known: Ints) -> Overlaps:
        """Pairs that overlap at the solution, apart from those with known keys a * n + b."""
        return overlaps(self.ready.bodies, found.motion, np.concatenate([self.ready.barred, known]))

    def way(self, found: Found) -> Way:
        """The way to a motion, checked; worked out once."""
        if self.checked is None or self.checked[0] is not found:
            bodies, cells = self.ready.bodies, found.program.cells
            legs = [(leg.program, leg.points) for leg in (*found.legs, found.leg(found.solution.u))]
            known = cells.a * len(bodies.fixed) + cells.b
            slack = 0.1 * OVERLAP_TOLERANCE * self.ready.size
            self.checked = found, whole_way(bodies, self.ready.arm, legs, known, self.ready.barred, slack)
        return self.checked[1]

    def _meets_strangers(self, found: Found) -> bool:
        """Begin again with the pairs that were not in the program and may meet on the way; True where there were any."""
        began = time.perf_counter()
        cells, n, way = found.program.cells, len(found.motion), self.way(found)
        a, b = way.strangers
        again = len(a) > 0 and self.restarts < MOST_RESTARTS
        if again:
            self.restarts += 1
            self._begin_with(np.concatenate([cells.a * n + cells.b, a * n + b]), found.motion)
        self.seconds["check"] += time.perf_counter() - began
        return again

    def _begin_with(self, known: Ints, wanted: Floats) -> None:
        """Begin again with the pairs of known keys a * n + b, those that are new with room towards a motion (n, 3)."""
        n = len(wanted)
        self.begin()
        extra = np.setdiff1d(known, self.cells.a * n + self.cells.b)
        grown, _ = self._grown(extra // n, extra % n, wanted)
        self.cells = joined(self.cells, grown)

    def add(self, a: Ints, b: Ints, wanted: Floats) -> None:
        """Put more pairs into the program, with room towards the motion `wanted` (n, 3); begin again where some overlap as it stands."""
        grown, good = self._grown(a, b, wanted)
        if good.all():
            self.cells = joined(self.cells, grown)
        else:
            n = len(wanted)
            self._begin_with(np.concatenate([self.cells.a * n + self.cells.b, a * n + b]), wanted)

    def _grown(self, a: Ints, b: Ints, wanted: Floats) -> tuple[Cells, NDArray[np.bool_]]:
        """Cells of some pairs where the coming round begins, and which of them lie free there."""
        bodies = self.ready.bodies
        seed, wish = relative_rest(bodies, a, b, self.inner), relative_rest(bodies, a, b, wanted)
        return grow_cells(bodies, a, b, seed, np.full(len(a), self.ready.clearance), wish=wish)

    def _rebuild(self, found: Found, pairs: Ints, other_side: bool = False, nearer: int = 0) -> None:
        """Begin the next round near `found`, with new cells for some pairs grown there.

        The new cells keep the solution itself inside, so the next round can only be better. With `other_side` they avoid the line that a
        corner touches at its very end: the way past the other side of the corner. With `nearer` the round begins nearer to the solution.

        """
        began = time.perf_counter()
        self.tell(Progress("free spaces", self.rounds, found.solution.iterations, found.value))
        bodies, old, solution = self.ready.bodies, found.program.cells, found.solution
        inner = found.nearer(nearer) if nearer else solution.inner
        self.inner = found.program.motion(inner)
        self.legs = (*found.legs, found.leg(inner))
        a, b = old.a[pairs], old.b[pairs]
        seed, keep = relative_rest(bodies, a, b, self.inner), relative_rest(bodies, a, b, found.motion)
        room = np.full(len(pairs), self.ready.clearance)
        wish = None if other_side else wishes(found.program, solution.u, found.touch, pairs)
        bar = found.touch.lines_at_end(found.program, pairs) if other_side else None
        turned_out = np.isin(pairs, found.touch.pair[np.isnan(found.touch.place)])
        grown, good = grow_cells(
            bodies, a, b, seed, room, keep=keep[:, None, :], bar=bar, wish=wish, to_the_end=turned_out
        )
        self.cells = replaced(old, pairs[good], select(grown, np.flatnonzero(good)))
        self.seconds["freespace"] += time.perf_counter() - began

    def _follow(self, best: Found, twin: Twin) -> None:
        """Begin the next round where some joints have gone the way of another one."""
        bodies = self.ready.bodies
        legs = []
        for leg in (*best.legs, best.leg(best.solution.inner)):
            cells = leg.program.cells
            program = build(bodies, exchanged(bodies, cells, twin), self.objective, length=self.ready.clearance)
            ways = followed(bodies, cells, twin, np.array([leg.program.motion(point) for point in leg.points]))
            legs.append(Leg(program, tuple(program.variables(motion) for motion in ways)))
        self.legs, self.cells = tuple(legs), legs[-1].program.cells
        self.inner = legs[-1].program.motion(legs[-1].points[-1])

    def _branches(self, best: Found) -> list[Ints | Twin]:
        """What else to try, the last first.

        Corner contacts from their other side, all at once and, where they are few, each alone; then, in small assemblies, joints that go
        the way of a congruent one.
        """
        touch = best.touch
        corners = np.unique(touch.pair[touch.at_end])
        few = len(corners) <= FEW[0] and len(best.motion) <= FEW[1]
        self.branches_left = bool(touch.virtual.any()) or not (few or len(corners) == 0)
        alone = [corners[k : k + 1] for k in range(len(corners))] if few and len(corners) > 1 else []
        sides = [*alone, corners] if len(corners) and not self.large else []
        cells = best.program.cells
        whole = all(len(leg.program.cells.a) == len(cells.a) for leg in best.legs)
        small = len(best.motion) <= FEW[1] and whole
        joints = twins(self.ready.bodies, cells, best.motion, self.ready.clearance) if small else []
        return [*reversed(joints), *sides]


def silent(_: Progress) -> None:
    """Tell nobody."""


def nudged(program: Program, u: Floats) -> Floats:
    """A point beside u: a symmetric assembly would else stay on the ridge between two equal ways."""
    aside = u + NUDGE * np.random.default_rng(0).standard_normal(len(u))
    return aside if (program.values(aside) > 0.5 * program.values(u)).all() else u
