"""The disassembly sequence: which sets of parts leave, one after the other; each begins where the one before ended."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.interlock_result import Escape
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NO_BODIES = np.zeros(0, dtype=np.int64)
"""None of them."""


@dataclass(frozen=True, eq=False)
class Stage:
    """What becomes of the bodies that are left: a path of some of them, or the end.

    Parameters
    ----------
    ended : Separability
    certainty : Certainty
    who : (k,) int64
        Bodies that leave.
    path : (k, n, 3) float64 [mm, mm, rad] or None
        Motions of all bodies on which they leave, from where all are to where those who leave are beyond all others.
    held : (n,) int64
        Bodies of the same number certainly never turn half round against each other; empty where something leaves.
    questions, unanswered : int
        Largest motions that were searched, and how many of them found no end whose path is certain.
    states : int
        States that slides, and turns of single bodies, led to.
    whole : bool
        True where these are all states to which slides lead.
    turned : int
        Of these states those in which every body was turned both ways.
    moves : (k - 1,) int64
        Number of the move that each piece of the path belongs to.
    reach : float [mm]
        No point of a body gets further from where it is, as all lie in closed holes of what stands; infinite where some do not.
    """

    ended: Separability
    certainty: Certainty
    who: Ints
    path: Floats | None
    held: Ints
    questions: int = 0
    unanswered: int = 0
    states: int = 0
    whole: bool = True
    turned: int = 0
    moves: Ints = field(default_factory=lambda: NO_BODIES)
    reach: float = np.inf


@dataclass(frozen=True, eq=False)
class Departure:
    """Parts that leave together, and the path to there.

    Parameters
    ----------
    parts : (k,) int64
    path : (k, n, 3) float64 [mm, mm, rad], in space (k, n, 6) [mm, rad]
        Motions of all parts about their reference points, from where the departure before ended (the first from rest) to where `parts`
        are beyond all others; straight in between. Parts that left before stay where they were put, out of the game.
    there : (n,) bool
        Parts that had not left before.
    moves : (k - 1,) int64
        Number of the move that each piece of the path belongs to.
    """

    parts: Ints
    path: Floats
    there: NDArray[np.bool_]
    moves: Ints

    def round_trip(self) -> Floats:
        """The path, and back along it for those that did not leave, while those that did are where they are in the end."""
        stay = self.there.copy()
        stay[self.parts] = False
        if not self.path[-1, stay].any():
            return self.path
        back = self.path[::-1].copy()
        back[:, ~stay] = self.path[-1, ~stay]
        moved = (back[1:] != back[:-1]).any(axis=(1, 2))
        return np.concatenate([self.path, back[1:][moved]])


@dataclass(frozen=True, eq=False)
class Stages:
    """What of a disassembly differs between the plane and space.

    Parameters
    ----------
    left : callable
        Parts (k,) of the assembly as made, at rest where the motion (n, d) of all has taken them; None where none of them can leave.
    next : callable
        Given these, the numbers of the parts and that motion: the stage of those parts, its path about where they are now.
    continued : callable
        Motions of some parts since rest, given those before (k, d) and those of a path (m, k, d) that begins there.
    """

    left: Callable[[Ints, Floats], Assembly | None]
    next: Callable[[Assembly, Ints, Floats], Stage]
    continued: Callable[[Floats, Floats], Floats]


@dataclass(eq=False)
class Disassembly:
    """Parts taken away one after the other.

    Parameters
    ----------
    names : tuple of str
        Of all parts.
    stages : Stages
    motion : (n, d) float64
        Where all parts are; at first at rest.
    returning : bool
        True: those that did not leave are at rest again after each departure, back along its path.
    last : Stage
        What became of the parts that were left when all were taken apart.
    together : tuple of names
        Parts that left with others from which they do not part.
    departures : list of Departure
    questions, unanswered : int
        Largest motions that were searched in all stages, and how many of them found no end whose path is certain.
    states, turned : int
        States to which slides and turns of single bodies led, and those in which every body was turned both ways.
    """

    names: tuple[str, ...]
    stages: Stages
    motion: Floats
    returning: bool = False
    last: Stage = field(init=False)
    together: tuple[str, ...] = ()
    departures: list[Departure] = field(default_factory=list)
    questions: int = 0
    unanswered: int = 0
    states: int = 0
    turned: int = 0

    @property
    def remaining(self) -> Ints:
        """Numbers of the parts that did not leave."""
        gone = [k for one in self.departures for k in one.parts.tolist()]
        return np.setdiff1d(np.arange(len(self.names)), np.array(gone, dtype=np.int64))

    @property
    def escapes(self) -> tuple[Escape, ...]:
        """Departures that each begin at rest, as paths after which all that did not leave are at rest again."""
        return tuple(Escape(tuple(self.names[k] for k in one.parts), one.round_trip()) for one in self.departures)

    def take_apart(self, who: Ints, *, targets: Collection[str] = (), every: bool = True) -> Stage:
        """Take parts away from some (k,) as long as any leave: what became of those that are left.

        It ends once all `targets` have left, or anything where not `every` part is to.
        """
        there = np.isin(np.arange(len(self.names)), who)
        begun = len(self.departures)
        while True:
            alive = np.flatnonzero(there)
            left = self.stages.left(alive, self.motion)
            if left is None:
                return ended(Separability.INTERLOCKED)
            gone = len(self.departures) > begun
            if gone and (not every or (targets and not {self.names[k] for k in alive} & set(targets))):
                return ended(Separability.COMES_APART)
            stage = self.stages.next(left, alive, self.motion)
            self.questions += stage.questions
            self.unanswered += stage.unanswered
            self.states += stage.states
            self.turned += stage.turned
            if stage.path is None:
                return stage
            path = np.repeat(self.motion[None], len(stage.path), 0)
            path[:, alive] = self.stages.continued(self.motion[alive], stage.path)
            gone_now = alive[stage.who]
            self.departures.append(Departure(gone_now, path, there.copy(), stage.moves))
            there[gone_now] = False
            self.motion = path[-1].copy()
            if self.returning:
                self.motion[there] = 0.0


def ended(verdict: Separability) -> Stage:
    """The end of a sequence after which nothing is asked."""
    return Stage(verdict, Certainty.PROVEN, NO_BODIES, None, NO_BODIES)
