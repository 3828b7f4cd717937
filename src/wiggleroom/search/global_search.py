"""The search beyond the nearest hill: climbs with other objectives first, from states visited before, then with the true one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.objectives import Objective, PointMotion
from wiggleroom.search.incumbent import Incumbent, Start
from wiggleroom.search.loop import LocalSearch, Policy
from wiggleroom.search.moves import ASIDE, CLIMB, THOROUGH
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.state_tree import StateTree
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

MOST_BODIES = 50
"""Assemblies of more free bodies are climbed once."""
WORK = 96
"""By default so many starts divided by the number of free bodies to the power 0.5."""
LEAST_STARTS = 12
BETTER = 1e-4
"""An end better by this share is followed to its own end."""
ALONE = 0.5
"""Share of the random objectives that are about one body."""
SAME = 1e-3
"""Ends that differ by less than this share count as equal."""


@dataclass(frozen=True)
class SearchEffort:
    """What the search beyond the nearest hill came to.

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


def default_starts(ready: Prepared) -> int:
    """So many starts a direct question gets."""
    free = int((~ready.bodies.fixed).sum())
    return 0 if free > MOST_BODIES else max(LEAST_STARTS, int(WORK / np.sqrt(free)))


def search_on(first: LocalSearch, starts: int) -> tuple[LocalSearch, SearchEffort]:
    """Go on after a first search has come to its end.

    Parameters
    ----------
    first : LocalSearch
        Ended on the hill that rest leads to.
    starts : int
        Further climbs.

    Returns
    -------
    LocalSearch
        The search that found the best end whose path is free of overlap, its work that of all.
    SearchEffort

    Source: a tree of states grown by random steps, after LaValle, "Rapidly-exploring random trees" (1998), with climbs as steps.
    """
    whole = _GlobalSearch(first)
    random, sides = np.random.default_rng(0), _turns(first.ready)
    while whole.made < starts and not whole.best.unlimited and not first.stopped:
        if whole.made < len(sides):
            whole.start_from(0, sides[whole.made])
        else:
            whole.start_from(whole.tree.pick(random), _random_objective(first.ready, random))
    whole.best.rounds, whole.best.iterations, whole.best.seconds = whole.rounds, whole.iterations, whole.seconds
    whole.best.ended = whole.best.ended and not first.stopped
    return whole.best, whole.effort


class _GlobalSearch:
    """State of a search: the tree of states, the ends of all climbs, and the search that found the best of them."""

    def __init__(self, first: LocalSearch) -> None:
        self.best, self.made, self.tree = first, 0, StateTree(first.ready)
        self.rounds, self.iterations, self.seconds = first.rounds, first.iterations, dict(first.seconds)
        self.values: list[float] = []
        if first.best is not None:
            self.values.append(first.best.value)
            self.tree.add(first.best, 0)

    @property
    def effort(self) -> SearchEffort:
        """How the ends compare with the best."""
        best = max(self.values, default=0.0) if self.best.best is None else self.best.best.value
        margin = SAME * abs(best)
        others = [value for value in self.values if value < best - margin]
        return SearchEffort(self.made + 1, sum(abs(v - best) <= margin for v in self.values), max(others, default=None))

    def start_from(self, state: int, aside: Objective) -> None:
        """Climb another objective from a state for a short while, and then the true one."""
        self.made += 1
        there = self._climb(aside, ASIDE, state)
        if there.best is None or there.unlimited:
            return
        between = self.tree.add(there.best, state)
        if between is None:
            return
        end = self._climb(self.best.objective, CLIMB, between)
        if end.best is None or end.best.solution.status is SolverStatus.FAILED:
            return
        self.tree.add(end.best, between)
        old = self.best.best
        if (
            end.unlimited
            or old is None
            or end.best.value > old.value + BETTER * max(abs(old.value), self.best.ready.clearance)
        ):
            self._follow(end.best)
        else:
            self.values.append(end.best.value)

    def _follow(self, incumbent: Incumbent) -> None:
        """Follow a better end to its own end; it becomes the best where its path is certain."""
        search = self._search(self.best.objective, THOROUGH)
        found = self._run(search, incumbent.start())
        if found is None or found.solution.status in (SolverStatus.FAILED, SolverStatus.STOPPED):
            return
        old = self.best.best
        if (old is None or search.unlimited or found.value > old.value) and search.way(found).sure:
            self.best = search
            self.values.append(found.value)

    def _climb(self, objective: Objective, policy: Policy, state: int) -> LocalSearch:
        search = self._search(objective, policy)
        self._run(search, self.tree.states[state].start)
        return search

    def _search(self, objective: Objective, policy: Policy) -> LocalSearch:
        first = self.best
        return LocalSearch(first.ready, objective, first.solve, policy, first.stop, first.tell)

    def _run(self, search: LocalSearch, start: Start) -> Incumbent | None:
        """Improve, and count the work."""
        found = search.improve(start)
        self.rounds, self.iterations = self.rounds + search.rounds, self.iterations + search.iterations
        self.seconds = {stage: spent + search.seconds[stage] for stage, spent in self.seconds.items()}
        return found


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
    if random.random() < ALONE:
        free = random.choice(free, 1)
    direction = random.standard_normal((len(free), 2))
    return PointMotion(
        free, direction, np.zeros_like(direction), random.standard_normal(len(free)) * ready.bodies.radius[free]
    )
