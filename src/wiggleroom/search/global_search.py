"""Global search: climbs with other objectives first, from states visited before, then with the true one.

It climbs from states of one tree, each to the next optimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import concatenated, grow_cells, replaced, select
from wiggleroom.freespace.translations import OVERLAP_NOISE, edges_of_all, translation_directions
from wiggleroom.geometry.neighbours import ignored_matrix
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.translation_blocking import taken_along
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective, PointMotion
from wiggleroom.search.incumbent import Incumbent, PathSegment, Start, start_at_rest
from wiggleroom.search.local_search import ESCAPE_DISTANCE, LocalSearch, Policy
from wiggleroom.search.moves import CLIMB, RANDOM_CLIMB, THOROUGH
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.recession import MIN_SLOPE, grows
from wiggleroom.search.state_tree import StateTree

Floats = NDArray[np.float64]

MAX_BODIES = 50
"""Assemblies of more free bodies are climbed once."""
WORK_BUDGET = 4000.0
"""Work that a direct question may take, in iterations of a small program: about a millisecond each."""
FEW_BODIES, WORK_BUDGET_OF_FEW = 12, 10_000.0
"""Most free bodies for the larger budget of work: with so few, the climbs meet a fair share of all local optima."""
ROUND_WORK, GROWTH_WORK, ROW_WORK = 4.0, 0.02, 2e-3
"""Work of a round and of its new cells for every row, and of an iteration for every row, in the same unit."""
MAX_KNOWN_PAIRS = 200
"""At most this many pairs that are apart at rest are in the program from the start."""
MIN_IMPROVEMENT = 1e-4
"""An end better by this share is followed to its own end."""
SINGLE_BODY_SHARE = 0.5
"""Share of the random objectives that are about one body."""
HILLS_LEFT, LITTLE_WORK, HILLS_LEFT_EARLY = 0.2, 4000.0, 0.05
"""The search ends where fewer local optima than this, by an estimate, were not met yet; the estimate must be surer before so much work."""
VALUE_TOLERANCE = 1e-3
"""Ends that differ by less than this share count as equal."""

NOVELTY_DISTANCE = 0.5
"""An optimum is new where, against every earlier one, some body is displaced by more than this share of the clearance."""


@dataclass(frozen=True)
class SearchEffort:
    """What the global search came to.

    Parameters
    ----------
    starts : int
        Climbs that were made, the one from rest among them.
    at_value : int
        How many of them ended at the value reported.
    next_best : float or None
        Best value at which others ended; None where all ended at the same.
    """

    starts: int
    at_value: int
    next_best: float | None


def effort(ends: Sequence[float], value: float) -> SearchEffort:
    """How the values at which climbs ended compare with the one reported."""
    margin = VALUE_TOLERANCE * abs(value)
    others = [end for end in ends if end < value - margin]
    return SearchEffort(len(ends), sum(abs(end - value) <= margin for end in ends), max(others, default=None))


def together(first: SearchEffort, second: SearchEffort) -> SearchEffort:
    """What two searches came to, the second from the end of the first, which it counts as well."""
    others = [end for end in (first.next_best, second.next_best) if end is not None]
    return replace(second, starts=first.starts + second.starts - 1, next_best=max(others, default=None))


def search_on(
    first: LocalSearch, starts: int | None = None, ends: Sequence[float] = (), enough: float = np.inf
) -> tuple[LocalSearch, SearchEffort]:
    """Go on after a first search has come to its end.

    Parameters
    ----------
    first : LocalSearch
        Ended at the local optimum that rest leads to.
    starts : int, optional
        Further climbs; by default as many as a fixed amount of work allows, none in large assemblies.
    ends : sequence of float, optional
        Values at which climbs ended before, that of `first` among them.
    enough : float
        The search ends once it has found a motion of this value.

    Returns
    -------
    LocalSearch
        The search that found the best end whose path is free of overlap, its work that of all.
    SearchEffort

    Source: a tree of states grown by random steps, after LaValle, "Rapidly-exploring random trees" (1998), with climbs as steps.
    """
    whole = _GlobalSearch(first, ends, enough)
    if not whole.goes_on(starts):
        return whole.result()
    whole.grow(starts)
    whole.follow_highest()
    return whole.result()


def local_optima(first: LocalSearch, starts: int) -> list[Incumbent]:
    """Optima that some climbs come to after a first search, that of its own among them; the highest first, each value once."""
    whole = _GlobalSearch(first, ())
    if first.best is None or not whole.goes_on(starts):
        return []
    whole.grow(starts)
    found: list[Incumbent] = []
    for one in sorted([first.best, *whole.found], key=lambda one: -one.value):
        if not found or one.value < found[-1].value - VALUE_TOLERANCE * abs(found[-1].value):
            found.append(one)
    return found


class _GlobalSearch:
    """State of a search: the tree of states, the ends of all climbs, and the search that found the best of them."""

    def __init__(self, first: LocalSearch, ends: Sequence[float], enough: float = np.inf) -> None:
        self.first, self.best, self.made, self.enough = first, first, 0, enough
        self.work = _work(first.rounds, first.iterations, len(first.ready.cells.kind))
        self.rounds, self.iterations, self.seconds = first.rounds, first.iterations, dict(first.seconds)
        self.value, self.free = first.certain_value()
        self.values = list(ends) or [self.value]
        self.before = len(self.values)
        self.found: list[Incumbent] = []
        """Ends of climbs, none of them without end."""
        self.optima = {0: self.value}  # values to which the states climbed
        self.highest: tuple[Incumbent, int] | None = None
        """Of the ends that were not followed, and its number among the values."""

    def plant(self) -> None:
        """Begin the tree of states: rest, and the end of the first search."""
        first = self.first
        rest = _rest_of_all_pairs(first.ready)
        self.work += GROWTH_WORK * len(rest.cells.kind)
        self.tree = ClimbTree(rest, first.ready.bodies.radius, first.ready.clearance)
        if first.best is not None and not self.free and first.checked_path(first.best).sure:
            self.optima[self.tree.add(first.best, 0)] = self.value

    def grow(self, starts: int | None) -> None:
        """Climb on, first from rest after each body's turn either way, then from states at random."""
        self.plant()
        random, sides = np.random.default_rng(0), _turns(self.first.ready)
        while self.goes_on(starts):
            if self.made < len(sides):
                self.start_from(0, sides[self.made])
            else:
                self.start_from(self.tree.pick(random), _random_objective(self.first.ready, random))

    def goes_on(self, starts: int | None) -> bool:
        """True while there is more to do."""
        free = int((~self.first.ready.bodies.fixed).sum())
        budget = WORK_BUDGET_OF_FEW if free <= FEW_BODIES else WORK_BUDGET
        more = self.made < starts if starts is not None else free <= MAX_BODIES and self.work < budget
        done = starts is None and (self._saturated or self.value >= self.enough)
        return more and not self.first.stopped and not self.free and not done

    @property
    def _saturated(self) -> bool:
        """True where the number of local optima, as estimated from how often each was met, is that of those that were met.

        Climbs that begin at neighbouring states are no independent samples, so a few that agree say little.

        Source: Boender and Rinnooy Kan, "Bayesian stopping rules for multistart global optimization methods" (1987).
        """
        ends = np.sort(self.values)
        n = len(ends)
        met = 1 + int((np.diff(ends) > VALUE_TOLERANCE * np.abs(ends[1:])).sum())
        left = HILLS_LEFT if self.work >= LITTLE_WORK else HILLS_LEFT_EARLY
        return n > met + 2 and met * (n - 1) / (n - met - 2) <= met + left

    def result(self) -> tuple[LocalSearch, SearchEffort]:
        """The search that found the best end, with the work of all, and how the ends compare with it."""
        best = self.best
        best.rounds, best.iterations, best.seconds = self.rounds, self.iterations, self.seconds
        best.ended = best.ended and not self.first.stopped
        done = effort(self.values, self.value)
        return best, replace(done, starts=self.made + self.before)

    def start_from(self, state: int, aside: Objective) -> None:
        """Climb another objective from a state for a short while, and then the true one."""
        self.made += 1
        between, met = self._step_aside(aside, state)
        if met is not None and met in self.optima:
            self.values.append(self.optima[met])
        if between is None:
            return
        climbed = self._escape_from(between) or self._climb(self.tree.start(between))
        if climbed is None:
            return
        climb, found = climbed
        self.values.append(found.value)
        self.found += [found] if not climb.unlimited else []
        self.optima[between] = found.value
        if not climb.unlimited and self.tree.known(found.motion) is None:
            self.optima[self.tree.add(found, between)] = found.value
        least = MIN_IMPROVEMENT * max(abs(found.value), self.first.ready.clearance)
        whole = replace(found, segments=(*self.tree.segments_to(between), *found.segments[1:]))
        if climb.unlimited or found.value > self.value + least:
            self._follow(whole, len(self.values) - 1)
        elif self.highest is None or found.value > self.highest[0].value:
            self.highest = whole, len(self.values) - 1

    def _escape_from(self, state: int) -> tuple[LocalSearch, Incumbent] | None:
        """A search that has gone on from the end of a straight path out of a state; None where none is known that leads on without end."""
        far = self._escape(self.tree.start(state))
        climbed = None if far is None else self._climb(far)
        return climbed if climbed is not None and climbed[0].unlimited else None

    def _escape(self, start: Start) -> Start | None:
        """Far out on a straight path from a start, along which the true objective grows without end; None where there is none."""
        return translational_escape(self.first.ready, self.first.objective, start)

    def _climb(self, start: Start) -> tuple[LocalSearch, Incumbent] | None:
        """A search that has climbed the true objective for a short while, and its end; None where that is not certainly reached."""
        climb = self._search(self.first.objective, CLIMB)
        found = self._run(climb, start)
        return (climb, found) if found is not None and climb.ended and climb.checked_path(found).sure else None

    def follow_highest(self) -> None:
        """Follow the highest of the ends that were hardly better than the best at the time, where it is better than the best of all."""
        if self.highest is not None and self.highest[0].value > self.value and not self.first.stopped and not self.free:
            self._follow(*self.highest)

    def _follow(self, incumbent: Incumbent, number: int) -> None:
        """Follow a better end, of this number among the values, to its own end; it becomes the best where its path is certain."""
        search = self._search(self.first.objective, THOROUGH)
        found = self._run(search, incumbent.start())
        if found is None or not search.ended:
            return
        value, free = search.certain_value()
        if free or value > self.value:
            self.best, self.value, self.free = search, value, free
            self.values[number] = value

    def _step_aside(self, objective: Objective, state: int) -> tuple[int | None, int | None]:
        """Climb from a state: the new state where the end is one that is certainly reached, or the known one that it is."""
        search = self._search(objective, RANDOM_CLIMB)
        found = self._run(search, self.tree.start(state))
        if found is None or search.stopped:
            return None, None
        known = self.tree.known(found.motion)
        if known is not None or not search.checked_path(found).sure:
            return None, known
        return self.tree.add(found, state), None

    def _search(self, objective: Objective, policy: Policy) -> LocalSearch:
        first = self.first
        asked = first.ready, objective, first.solve, policy, first.stop, first.tell, first.turn_limit
        return LocalSearch(*asked, rounds=self.rounds)

    def _run(self, search: LocalSearch, start: Start) -> Incumbent | None:
        """Improve, and count the work."""
        found = search.improve(start)
        rounds, self.rounds = search.rounds - self.rounds, search.rounds
        self.iterations += search.iterations
        self.seconds = {stage: spent + search.seconds[stage] for stage, spent in self.seconds.items()}
        self.work += _work(rounds, search.iterations, len(start.cells.kind))
        return found


def _work(rounds: int, iterations: int, rows: int) -> float:
    """Work of some rounds and iterations with `rows` rows, in iterations of a small program."""
    return rounds * (ROUND_WORK + GROWTH_WORK * rows) + iterations * (1 + ROW_WORK * rows)


def _rest_of_all_pairs(ready: Prepared) -> Start:
    """Rest, with cells for all pairs of bodies where these are few: what moves far would else pass through what it did not know."""
    rest, bodies, cells = start_at_rest(ready), ready.bodies, ready.cells
    n = len(bodies.fixed)
    a, b = np.triu_indices(n, 1)
    key = a * n + b
    new = ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(key, np.concatenate([ready.ignored, cells.a * n + cells.b]))
    if new.sum() > MAX_KNOWN_PAIRS:
        return rest
    a, b = a[new], b[new]
    grown, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b), np.full(len(a), ready.clearance))
    return replace(rest, cells=concatenated(cells, select(grown, np.flatnonzero(good))))


def _turns(ready: Prepared) -> list[Objective]:
    """Every free body's turn, either way."""
    free = np.flatnonzero(~ready.bodies.fixed)
    return [
        PointMotion(free[k : k + 1], np.zeros((1, 2)), np.zeros((1, 2)), sense * ready.bodies.radius[free[k : k + 1]])
        for k in range(len(free))
        for sense in (1.0, -1.0)
    ]


def _random_objective(ready: Prepared, random: np.random.Generator) -> Objective:
    """A pull and a turn of one body or of all, at random."""
    free = np.flatnonzero(~ready.bodies.fixed)
    if random.random() < SINGLE_BODY_SHARE:
        free = random.choice(free, 1)
    direction = random.standard_normal((len(free), 2))
    return PointMotion(
        free, direction, np.zeros_like(direction), random.standard_normal(len(free)) * ready.bodies.radius[free]
    )


FAR_OUT = 2 * ESCAPE_DISTANCE + 1
"""An escape is followed this many drawing sizes: from any state that counts as near it ends where a body counts as gone."""


def translational_escape(ready: Prepared, objective: Objective, start: Start) -> Start | None:
    """Where a search begins far out on a straight path from a state, along which the objective grows without end; None where none leaves.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    start : Start
        At the state, strictly inside cells.

    Source: the blocking graph of a direction, to the end of the path (Wilson and Latombe, "Geometric reasoning about mechanical assembly",
    1994): what is reached from a body along its arcs moves along with it.
    """
    bodies, motion = ready.bodies, start.inner
    slope = objective.gradient(motion)
    slope[bodies.fixed] = 0.0
    asked = np.flatnonzero((slope[:, :2] != 0).any(axis=1))
    if not len(asked):
        return None
    edges, first = edges_of_all(placed(bodies, motion))
    directions = np.concatenate([slope[asked, :2], slope[:, :2].sum(axis=0, keepdims=True)])
    length = np.hypot(*directions.T)
    directions = np.concatenate([directions[length > 0] / length[length > 0, None], translation_directions(edges)])
    n = len(motion)
    never = ignored_matrix(ready.ignored, n)
    for body in asked:
        gain = directions @ slope[body, :2]
        for k in np.argsort(-gain, kind="stable"):
            if gain[k] <= MIN_SLOPE * np.hypot(*slope[body, :2]):
                break
            who = np.zeros(n, dtype=np.bool_)
            who[body] = True
            leaves = taken_along(edges, first, directions[k], never, bodies.fixed, ready.size * OVERLAP_NOISE, who)
            if leaves and grows(ready, objective, motion, who, directions[k]):
                return _far_out(ready, start, who, directions[k])
    return None


def _far_out(ready: Prepared, start: Start, who: NDArray[np.bool_], direction: Floats) -> Start | None:
    """The start after some bodies have gone straight so far that they count as gone; None where no cells grow there."""
    bodies, cells = ready.bodies, start.cells
    motion = start.inner.copy()
    motion[who, :2] += FAR_OUT * ready.size * direction
    parted = np.flatnonzero(who[cells.a] != who[cells.b])  # the others lie to each other as they did
    a, b = cells.a[parted], cells.b[parted]
    grown, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, motion), np.full(len(a), ready.clearance))
    if not good.all():
        return None
    program = build_program(bodies, select(cells, np.zeros(0, dtype=np.int64)), ZERO_MOTION, length=ready.clearance)
    leg = PathSegment(program, (program.variables(start.inner), program.variables(motion)))
    return replace(start, cells=replaced(cells, parted, grown), inner=motion, segments=(*start.segments, leg))


@dataclass(frozen=True, eq=False)
class Climbed:
    """How a search climbed to a state.

    Parameters
    ----------
    start : Start
        Where a search from the state begins; its only segment is the point where it does.
    segments : tuple of PathSegment
        The path from where the search from the parent begins to where that from the state does.
    """

    start: Start
    segments: tuple[PathSegment, ...] = ()


class ClimbTree(StateTree[Floats, Climbed]):
    """Motions (n, 3) of bodies that were reached from rest, which is the first of them, by climbing objectives.

    Parameters
    ----------
    rest : Start
    radius : (n,) float64 [mm]
        Of the bodies.
    clearance : float [mm]
    """

    def __init__(self, rest: Start, radius: Floats, clearance: float) -> None:
        super().__init__(rest.inner, lambda motion, _: self.known(motion) is None)
        self._rest, self._radius, self._clearance = rest, radius, clearance
        self.visits = [0]
        """How often a search began at each state."""

    def start(self, state: int) -> Start:
        """Where a search from a state begins."""
        step = self.states[state].step
        return self._rest if step is None else step.start

    def known(self, motion: Floats) -> int | None:
        """The state at which no body lies otherwise by more than a share of the clearance; None where the motion is new."""
        change = np.abs(np.array([visited.state for visited in self.states]) - motion)
        moved = (np.hypot(change[..., 0], change[..., 1]) + self._radius * change[..., 2]).max(axis=1)
        nearest = int(moved.argmin())
        return nearest if moved[nearest] <= NOVELTY_DISTANCE * self._clearance else None

    def add(self, end: Incumbent, parent: int) -> int:
        """Keep the end of a search from a state; its number."""
        start = end.start()
        here = PathSegment(start.segments[-1].program, start.segments[-1].points[-1:])
        self.visits.append(0)
        return self.append(end.motion, parent, Climbed(replace(start, segments=(here,)), start.segments))

    def segments_to(self, state: int) -> tuple[PathSegment, ...]:
        """The path from rest to where the search from a state begins."""
        return tuple(segment for climbed in self.steps_to(state) for segment in climbed.segments)

    def pick(self, random: np.random.Generator) -> int:
        """A state to go on from: at random, those that were seldom chosen rather than others."""
        weight = 1.0 / (1.0 + np.array(self.visits)) ** 2
        chosen = int(random.choice(len(weight), p=weight / weight.sum()))
        self.visits[chosen] += 1
        return chosen
