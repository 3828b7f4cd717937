"""The tree of visited states, which global searches grow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.incumbent import Incumbent, PathSegment, Start

Floats = NDArray[np.float64]

NOVELTY_DISTANCE = 0.5
"""A state is new where, against every earlier state, some body is displaced by more than this share of the clearance."""

Transition = TypeVar("Transition")


@dataclass(frozen=True, eq=False)
class VisitedState(Generic[Transition]):
    """A state, and how it was reached.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad]
        Of the bodies.
    parent : int
        State from which it was reached; -1 for the first.
    step : Transition
        What leads from the parent to it.
    """

    motion: Floats
    parent: int
    step: Transition


@dataclass(eq=False)
class StateTree(Generic[Transition]):
    """States that were reached from the first of them.

    Parameters
    ----------
    radius : (n,) float64 [mm]
        Of the bodies.
    clearance : float [mm]
    """

    radius: Floats
    clearance: float
    states: list[VisitedState[Transition]] = field(default_factory=list, init=False)

    def append(self, motion: Floats, parent: int, step: Transition) -> int:
        """Keep a state; its number."""
        self.states.append(VisitedState(motion, parent, step))
        return len(self.states) - 1

    def line(self, state: int) -> list[int]:
        """Numbers of the states from the first one to a state."""
        found = [state]
        while self.states[found[-1]].parent >= 0:
            found.append(self.states[found[-1]].parent)
        return found[::-1]

    def known(self, motion: Floats) -> int | None:
        """The state at which no body lies otherwise by more than a share of the clearance; None where the motion is new."""
        change = np.abs(np.array([state.motion for state in self.states]) - motion)
        moved = (np.hypot(change[..., 0], change[..., 1]) + self.radius * change[..., 2]).max(axis=1)
        nearest = int(moved.argmin())
        return nearest if moved[nearest] <= NOVELTY_DISTANCE * self.clearance else None


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


class ClimbTree(StateTree[Climbed]):
    """States that were reached from rest, which is the first of them, by climbing objectives.

    Parameters
    ----------
    rest : Start
    radius, clearance
        As for `StateTree`.
    """

    def __init__(self, rest: Start, radius: Floats, clearance: float) -> None:
        super().__init__(radius, clearance)
        self.visits = [0]
        """How often a search began at each state."""
        self.append(rest.inner, -1, Climbed(rest))

    def add(self, end: Incumbent, parent: int) -> int:
        """Keep the end of a search from a state; its number."""
        start = end.start()
        here = PathSegment(start.segments[-1].program, start.segments[-1].points[-1:])
        self.visits.append(0)
        return self.append(end.motion, parent, Climbed(replace(start, segments=(here,)), start.segments))

    def segments_to(self, state: int) -> tuple[PathSegment, ...]:
        """The path from rest to where the search from a state begins."""
        return tuple(segment for k in self.line(state) for segment in self.states[k].step.segments)

    def pick(self, random: np.random.Generator) -> int:
        """A state to go on from: at random, those that were seldom chosen rather than others."""
        weight = 1.0 / (1.0 + np.array(self.visits)) ** 2
        chosen = int(random.choice(len(weight), p=weight / weight.sum()))
        self.visits[chosen] += 1
        return chosen
