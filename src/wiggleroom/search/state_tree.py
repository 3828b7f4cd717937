"""A tree of visited states, on which searches that look beyond the nearest hill grow."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.incumbent import Incumbent, Start, at_rest
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]

NOVEL = 0.5
"""A state is new where a body lies otherwise than in every state before by more than this share of the clearance."""


@dataclass(frozen=True, eq=False)
class VisitedState:
    """A state, and how it was reached from rest.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad]
        Of the bodies.
    start : Start
        Where a search from here begins: the path from rest is that of its legs.
    parent : int
        State from which it was reached; -1 for rest.
    """

    motion: Floats
    start: Start
    parent: int


@dataclass(eq=False)
class StateTree:
    """States that were reached from rest; the first is rest."""

    ready: Prepared
    states: list[VisitedState] = field(default_factory=list)
    visits: list[int] = field(default_factory=list)
    """How often a search began at each state."""

    def __post_init__(self) -> None:
        """Begin with rest."""
        start = at_rest(self.ready)
        self._append(VisitedState(start.inner, start, -1))

    def add(self, end: Incumbent, parent: int) -> int | None:
        """Keep the end of a search if it is new; its number, or None."""
        if not self.novel(end.motion):
            return None
        self._append(VisitedState(end.motion, end.start(), parent))
        return len(self.states) - 1

    def novel(self, motion: Floats) -> bool:
        """True where a body lies otherwise than in every state before."""
        change = np.abs(np.array([state.motion for state in self.states]) - motion)
        moved = np.hypot(change[..., 0], change[..., 1]) + self.ready.bodies.radius * change[..., 2]
        return bool(moved.max(axis=1).min() > NOVEL * self.ready.clearance)

    def pick(self, random: np.random.Generator) -> int:
        """A state to go on from: at random, those that were seldom chosen rather than others."""
        weight = 1.0 / (1.0 + np.array(self.visits)) ** 2
        chosen = int(random.choice(len(weight), p=weight / weight.sum()))
        self.visits[chosen] += 1
        return chosen

    def _append(self, state: VisitedState) -> None:
        self.states.append(state)
        self.visits.append(0)
