"""Local search, `improve(start) -> incumbent`: solve, keep what is better, ask the moves where to begin next, until none proposes one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop, StoppedError, go_on
from wiggleroom.freespace.cells.cells import Cells, CellWish, concatenated, grow_cells
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import Objective
from wiggleroom.search.active_set import touching
from wiggleroom.search.incumbent import Incumbent, PathSegment, Start, start_at_rest
from wiggleroom.search.path_check import CertainPrefix, CheckedPath, certain_prefix, check_path, missed_at
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.progress import Progress, silent
from wiggleroom.solve import interior_point
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUGH_TOLERANCE, FINE_TOLERANCE = 1e-2, 1e-6
"""Tolerance of the first rounds, which only show where everything wants to go, and of the others."""
MAX_ROUNDS = 200
"""Rounds of one climb at most."""
TOLERANCE_PER_BODY, MAX_TOLERANCE = 1e-8, 5e-5
"""Share of the objective that may be lost for each body, where that is more than the tolerance, and for all together at most."""
MIN_GAIN = 2e-7
"""A gain below this share of the objective for each body is none."""
ESCAPE_DISTANCE = 4.0
"""A body that moves further than this multiple of the drawing's size leaves."""
PERTURBATION = 1e-3
"""Standard deviation of the first, random displacement, in units of the clearance."""
MAX_RESTARTS = 3
"""Most restarts after a pair outside the program was met on the path."""
LARGE_ASSEMBLY = 1000
"""In larger assemblies the other sides of corner contacts are left open, and new cells must bring more to go on."""
CARRYING_ASSEMBLY = 100
"""In larger assemblies rounds begin with multipliers."""
AUDIT_SECONDS, AUDIT_SECONDS_PER_BODY = 8.0, 1e-3
"""Between two audits of a path that is still growing lies at least this processor time [s], and this much more for each body: each
costs about a fiftieth of that beyond the audit of its pieces, which is not repeated at the end."""
FULL_TURN = 2.0 * np.pi + 0.5
"""A body that turns further than this [rad] may turn without limit: whether its motion repeats is looked at then."""


class Move(Protocol):
    """What proposes where to begin next; a start is worked out only when it is asked for."""

    def __call__(self, search: LocalSearch, incumbent: Incumbent, gained: bool, /) -> Iterator[Start]:
        """Starts, the most promising first; `gained` tells whether the incumbent is better than the one before."""


@dataclass(frozen=True)
class Policy:
    """What a search does.

    Parameters
    ----------
    moves : tuple of Move
        Asked in this order.
    stale : callable
        Pairs whose cells are grown anew, from a search and an incumbent.
    unchecked : callable, optional
        Pairs that may meet on the path to an incumbent, as two arrays (k,); by default none are looked for.
    fine : callable
        Tolerance of the last rounds.
    rough : float
        Tolerance of the first rounds.
    mu_may_grow : bool
        Whether a round may begin with more complementarity than the one before.
    most_rounds : int
    interrupt : optional
        What stops the preparation of a round, in place of what stops the search: a drag goes on from what its time allowed to begin.
    """

    moves: tuple[Move, ...]
    stale: Callable[[LocalSearch, Incumbent], Ints]
    fine: Callable[[LocalSearch], float]
    unchecked: Callable[[LocalSearch, Incumbent], tuple[Ints, Ints]] | None = None
    rough: float = ROUGH_TOLERANCE
    mu_may_grow: bool = True
    most_rounds: int = MAX_ROUNDS
    interrupt: Stop | None = None


@dataclass(eq=False)
class LocalSearch:
    """A search for one objective, and what it has come to.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    solve : callable
        Solver.
    policy : Policy
    stop, tell
        Asked every iteration; told a `Progress`.
    turn_limit : float [rad]
        A turn beyond this ends the search.

    Attributes
    ----------
    best : Incumbent or None
    last : Incumbent or None
        Of the last round.
    coming : Start or None
        Where the last round began, or the next one would.
    ended : bool
        True where no move proposed anything more, nothing stops the motion, or it is good enough.
    certain : CertainPrefix
        Of the path to where the search is.
    audited : float
        Processor time when that was looked at last.
    rounds, iterations, seconds
        Work done.
    """

    ready: Prepared
    objective: Objective
    solve: Callable[..., Solution]
    policy: Policy
    stop: Stop | None = None
    tell: Callable[[Progress], None] = silent
    turn_limit: float = FULL_TURN
    best: Incumbent | None = None
    last: Incumbent | None = None
    coming: Start | None = None
    ended: bool = False
    rounds: int = 0
    iterations: int = 0
    restarts: int = 0
    checked: tuple[Incumbent, CheckedPath] | None = None
    certain: CertainPrefix = field(default_factory=CertainPrefix)
    audited: float = field(default_factory=time.process_time)
    seconds: dict[str, float] = field(default_factory=lambda: {"freespace": 0.0, "solve": 0.0, "check": 0.0})

    def improve(self, start: Start) -> Incumbent | None:
        """Search from a start until no move proposes anything, nothing stops the motion, or it was asked to stop."""
        self.best, self.ended, self.restarts = None, False, 0
        most = self.rounds + self.policy.most_rounds
        proposals: Iterator[Start] = iter((start,))
        while self.rounds < most:
            if self.preparation_stop is not None and self.preparation_stop.is_set() and self.best is not None:
                break
            try:
                begin = next(proposals, None)
                if begin is None:
                    begin = self._with_more_pairs(start)
                    self.ended = begin is None
                    if begin is None:
                        break
            except StoppedError:
                break
            self.coming = begin
            if self.stopped and self.best is not None:
                break
            found = self.last = self._round(begin)
            status = found.solution.status
            if status is not SolverStatus.STOPPED and found.tolerance > self.fine:
                try:
                    more = self._with_missed(found, start)
                except StoppedError:
                    self._keep(found)
                    break
                if more:
                    proposals = iter((more,))
                    continue
            before = self.best
            gained = self._keep(found)
            if status is SolverStatus.STOPPED:
                break
            if self.unlimited:
                proposals = iter(())
            elif status is SolverStatus.ENOUGH:
                self.ended = True
                break
            elif before is None or gained or self._goes_on_from(found, before):
                proposals = self._moves(found, gained)
        return self.best

    def _moves(self, incumbent: Incumbent, gained: bool) -> Iterator[Start]:
        """All that the moves propose, one move after the other."""
        return chain.from_iterable(move(self, incumbent, gained) for move in self.policy.moves)

    def _goes_on_from(self, found: Incumbent, before: Incumbent) -> bool:
        """True where an incumbent that gained nothing is surer than the one before, or rough and nearly as good."""
        surer = self.best is found and found.tolerance < before.tolerance
        return surer or (
            found.tolerance > self.fine and found.value >= before.value - ROUGH_TOLERANCE * abs(before.value)
        )

    @property
    def stopped(self) -> bool:
        """True where it was asked to stop."""
        return self.stop is not None and self.stop.is_set()

    @property
    def preparation_stop(self) -> Stop | None:
        """What stops the preparation of a round; None where nothing does."""
        return self.stop if self.policy.interrupt is None else self.policy.interrupt

    @property
    def fine(self) -> float:
        """Tolerance of the last rounds."""
        return self.policy.fine(self)

    @property
    def large(self) -> bool:
        """True where the last hundredth of a per cent would cost more than all before."""
        return len(self.ready.bodies.fixed) > LARGE_ASSEMBLY

    @property
    def carries_multipliers(self) -> bool:
        """True where a round begins with the multipliers of the one before, and so takes fewer iterations."""
        return len(self.ready.bodies.fixed) > CARRYING_ASSEMBLY and self.solve is interior_point.solve

    @property
    def unlimited(self) -> bool:
        """True where a body that is asked about has moved so far, or turned so far and gains by it, that perhaps nothing stops it."""
        if self.best is None:
            return False
        motion = self.best.motion
        asked = (self.objective.gradient(motion) != 0).any(axis=1)
        if np.hypot(*motion[asked, :2].T).max(initial=0.0) > ESCAPE_DISTANCE * self.ready.size:
            return True
        turned = asked & (np.abs(motion[:, 2]) > self.turn_limit)
        if not turned.any():
            return False
        once_more = motion.copy()
        once_more[turned, 2] += 2 * np.pi * np.sign(motion[turned, 2])
        value = self.objective.value(motion)
        return bool(self.objective.value(once_more) > value + MIN_GAIN * abs(value))

    def certain_value(self) -> tuple[float, bool]:
        """Value up to which the path to the best motion is certain, and whether it is all the way and nothing stops it there."""
        if self.best is None:
            return 0.0, False
        checked = self.checked_path(self.best)
        if checked.sure:
            return self.best.value, self.unlimited
        return self.objective.value(checked.motion(max(checked.certain, 1) - 1)), False

    def checked_path(self, found: Incumbent) -> CheckedPath:
        """The path to a motion, checked; worked out once."""
        if self.checked is None or self.checked[0] is not found:
            self.checked = found, check_path(self.ready, found.path, self.stop, self.certain)
        return self.checked[1]

    def along(self, segments: tuple[PathSegment, ...], program: Program, begin: Floats) -> dict[str, Any]:
        """What a solver is given so that the path which it follows is audited now and then: where it is stopped, that much is certain."""
        if not self.carries_multipliers:
            return {}
        points, wait = [begin], max(AUDIT_SECONDS, AUDIT_SECONDS_PER_BODY * len(self.ready.bodies.fixed))

        def reached(u: Floats) -> None:
            points.append(u)
            if time.process_time() - self.audited > wait:
                path = (*segments, PathSegment(program, tuple(points)))
                self.certain = certain_prefix(self.ready, path, self.stop, self.certain)
                self.audited = time.process_time()

        return {"reached": reached}

    def _round(self, start: Start) -> Incumbent:
        """Build and solve the program of some cells."""
        began = time.perf_counter()
        before = start.segments[-1].program if start.segments else None
        program = build_program(
            self.ready.bodies, start.cells, self.objective, length=self.ready.clearance, like=before
        )
        self.rounds += 1
        number, begin = self.rounds, program.variables(start.inner)
        tolerance = self.policy.rough if start.tolerance is None else start.tolerance
        carried = {} if start.multipliers is None else {"multipliers": start.multipliers}
        carried |= self.along(start.segments, program, begin)
        solution = self.solve(
            program, begin if start.segments else nudged(program, begin), mu=start.mu, tolerance=tolerance,
            horizon=ESCAPE_DISTANCE * self.ready.size, stop=self.stop,
            progress=lambda iteration, value: self.tell(Progress("solve", number, iteration, value)), **carried,
        )  # fmt: skip
        self.iterations += solution.iterations
        motion = program.motion(solution.u)
        active = touching(program, solution.u, solution.lam)
        self.seconds["solve"] += time.perf_counter() - began
        value = self.objective.value(motion)
        return Incumbent(motion, value, program, solution, active, start.segments, begin, tolerance, start.mu)

    def _keep(self, found: Incumbent) -> bool:
        """Keep what is better than the best so far, or surer and not much worse; True where it is better by more than it might err."""
        rough = self.best.tolerance if self.best and self.large else found.tolerance
        least = max(MIN_GAIN * len(found.motion), 0.3 * rough) * max(abs(found.value), self.ready.clearance)
        before = self.best.value if self.best else 0.0
        surer = self.best is not None and (
            found.tolerance < self.best.tolerance
            or (self.best.solution.status, found.solution.status) == (SolverStatus.FAILED, SolverStatus.CONVERGED)
        )
        gained = found.value - before > least
        # as good is not enough where walls hold it that nothing touches
        worse = self.best is not None and bool(found.active.virtual.any()) and not self.best.active.virtual.any()
        allowed = 0.1 * ROUGH_TOLERANCE * abs(before) if surer else 0.0
        if self.best is None or gained or (found.value >= before - allowed and (surer or not worse)):
            self.best = found
        return gained

    def go_back(self, start: Start) -> None:
        """Leave the best motion, which is not safe; coming is a start with the pairs that it or its path lacks."""
        self.coming = start
        with suppress(StoppedError):
            self.coming = self._with_more_pairs(start) or start
        self.best = self.last = None

    def _with_more_pairs(self, start: Start) -> Start | None:
        """Where to begin with the pairs that the best motion or its path lacks; None where it lacks none."""
        best = self.best
        if best is None:
            return None
        more = self._with_missed(best, start)
        if more is None and self.policy.unchecked is not None and self.restarts < MAX_RESTARTS:
            began = time.perf_counter()
            a, b = self.policy.unchecked(self, best)
            if len(a):
                self.restarts += 1
                more = self._gone_back(start, best, a, b)
            self.seconds["check"] += time.perf_counter() - began
        if more is not None:
            self.best = None
        return more

    def _with_missed(self, found: Incumbent, start: Start) -> Start | None:
        """The start of a round with the pairs that overlap at its end and were not in its program; None where there are none."""
        began = time.perf_counter()
        self.tell(Progress("check", self.rounds, found.solution.iterations, found.value))
        go_on(self.preparation_stop)
        cells, n = found.program.cells, len(found.motion)
        known = cells.a * n + cells.b
        (a, b), more = missed_at(self.ready, found.motion[None], found.program), None
        go_on(self.preparation_stop)
        if len(a):
            corners = self.ready.corners[~np.isin(self.ready.corners, known)]
            key = np.unique(np.concatenate([a * n + b, corners]))
            a, b = key // n, key % n
            inner = found.program.motion(found.begin)
            grown, good = self._grown(a, b, inner, found.motion)
            if good.all():
                more = Start(concatenated(cells, grown), inner, found.segments, found.mu, found.tolerance)
            else:  # some overlap where the round began
                more = self._begun_with(start, found, a, b)
        self.seconds["check"] += time.perf_counter() - began
        return more

    def _begun_with(self, start: Start, found: Incumbent, a: Ints, b: Ints) -> Start | None:
        """The start with all pairs of a round and some more, with room towards the round's end; None where not all have cells there."""
        n, cells = len(found.motion), found.program.cells
        known = np.concatenate([cells.a * n + cells.b, a * n + b])
        extra = np.setdiff1d(known, start.cells.a * n + start.cells.b)
        grown, good = self._grown(extra // n, extra % n, start.inner, found.motion)
        return replace(start, cells=concatenated(start.cells, grown), multipliers=None) if good.all() else None

    def _gone_back(self, start: Start, best: Incumbent, a: Ints, b: Ints) -> Start | None:
        """Where the path to the best motion is certain for the last time, with the pairs that it meets then; None without cells there."""
        kept = self.checked_path(best).kept
        segment = kept[-1]
        if not isinstance(segment.program.cells, Cells):  # the climb before there were cells
            return self._begun_with(start_at_rest(self.ready), best, a, b)
        if segment.program.bodies is not self.ready.bodies or not len(segment.program.cells.a):  # led to the start
            return self._begun_with(start, best, a, b)
        inner = segment.program.motion(segment.points[-1])
        grown, good = self._grown(a, b, inner, best.motion)
        if (len(kept) == 1 and len(segment.points) == 1) or not good.all():
            return self._begun_with(start, best, a, b)
        return Start(concatenated(segment.program.cells, grown), inner, kept)

    def _grown(self, a: Ints, b: Ints, inner: Floats, wanted: Floats) -> tuple[Cells, NDArray[np.bool_]]:
        """Cells of some pairs where a round begins, with room towards a motion, and which of them lie free there."""
        bodies = self.ready.bodies
        seed, target = relative_pose(bodies, a, b, inner), relative_pose(bodies, a, b, wanted)
        room = np.full(len(a), self.ready.clearance)
        return grow_cells(bodies, a, b, seed, room, wish=CellWish(target=target), stop=self.preparation_stop)


def nudged(program: Program, u: Floats) -> Floats:
    """A point beside u, always the same: a symmetric assembly would else stay at the saddle point between two equal motions."""
    aside = u + PERTURBATION * np.random.default_rng(0).standard_normal(len(u))
    return aside if (program.values(aside) > 0.5 * program.values(u)).all() else u
