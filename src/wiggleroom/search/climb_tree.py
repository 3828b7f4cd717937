"""The tree of states that the global search climbs to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.incumbent import Incumbent, PathSegment, Start
from wiggleroom.search.state_tree import StateTree

Floats = NDArray[np.float64]

NOVELTY_DISTANCE = 0.5
"""An optimum is new where, against every earlier one, some body is displaced by more than this share of the clearance."""


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
