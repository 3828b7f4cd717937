"""A tree of visited states, on which searches that look beyond the nearest hill grow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.incumbent import Incumbent, PathSegment, Start

Floats = NDArray[np.float64]

NOVELTY_DISTANCE = 0.5
"""A state is new where a body lies otherwise than in every state before by more than this share of the clearance."""


@dataclass(frozen=True, eq=False)
class VisitedState:
    """A state, and how it was reached.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad]
        Of the bodies.
    start : Start
        Where a search from here begins; its only leg is the point where it does.
    parent : int
        State from which it was reached; -1 for rest.
    segments : tuple of PathSegment
        The path from where the search from the parent begins to where that from here does.
    """

    motion: Floats
    start: Start
    parent: int = -1
    segments: tuple[PathSegment, ...] = ()


@dataclass(eq=False)
class StateTree:
    """States that were reached from rest, which is the first of them.

    Parameters
    ----------
    rest : Start
    radius : (n,) float64 [mm]
        Of the bodies.
    clearance : float [mm]
    """

    rest: Start
    radius: Floats
    clearance: float
    states: list[VisitedState] = field(default_factory=list)
    visits: list[int] = field(default_factory=list)
    """How often a search began at each state."""

    def __post_init__(self) -> None:
        """Begin with rest."""
        self._append(VisitedState(self.rest.inner, self.rest))

    def add(self, end: Incumbent, parent: int) -> int:
        """Keep the end of a search from a state; its number."""
        start = end.start()
        here = PathSegment(start.segments[-1].program, start.segments[-1].points[-1:])
        self._append(VisitedState(end.motion, replace(start, segments=(here,)), parent, start.segments))
        return len(self.states) - 1

    def segments_to(self, state: int) -> tuple[PathSegment, ...]:
        """The path from rest to where the search from a state begins."""
        segments: tuple[PathSegment, ...] = ()
        while state >= 0:
            segments, state = (*self.states[state].segments, *segments), self.states[state].parent
        return segments

    def known(self, motion: Floats) -> int | None:
        """The state at which no body lies otherwise by more than a share of the clearance; None where the motion is new."""
        change = np.abs(np.array([state.motion for state in self.states]) - motion)
        moved = (np.hypot(change[..., 0], change[..., 1]) + self.radius * change[..., 2]).max(axis=1)
        nearest = int(moved.argmin())
        return nearest if moved[nearest] <= NOVELTY_DISTANCE * self.clearance else None

    def pick(self, random: np.random.Generator) -> int:
        """A state to go on from: at random, those that were seldom chosen rather than others."""
        weight = 1.0 / (1.0 + np.array(self.visits)) ** 2
        chosen = int(random.choice(len(weight), p=weight / weight.sum()))
        self.visits[chosen] += 1
        return chosen

    def _append(self, state: VisitedState) -> None:
        self.states.append(state)
        self.visits.append(0)
