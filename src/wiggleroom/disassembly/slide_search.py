"""The search over states for what leaves by slides, or else after turns: breadth first, so that the fewest slides are found first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.disassembly.slide_space import Slide, SlideSpace
from wiggleroom.disassembly.turn_space import MIN_TILT, LocalTurn, TurnSpace
from wiggleroom.disassembly.turn_space import WORK_BUDGET as TURN_BUDGET
from wiggleroom.search.progress import Progress
from wiggleroom.search.state_tree import EqualKeys, Exit, Level, StateTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WORK_BUDGET = 2e9
"""Pairs of edges that are compared at most; some ten seconds."""
OFF_LATTICE_SHARE = 0.25
"""Where stops lie on no lattice there is no end of states; this share of the work is spent on them."""
STATE_WORK = 30_000
"""Work of a state besides its edges, in pairs of edges."""
ROUNDING = 0.5
"""States in which every body lies in the same cell of this share of the clearance are the same."""
ROUNDING_OFFSET = 0.382
"""Cells lie a little beside whole units: states on a lattice would else fall on their borders."""
TELL_EVERY = 50
"""Progress is told after this many states."""


@dataclass(frozen=True, eq=False)
class MoveSequence:
    """Moves from where all were to begin with.

    Parameters
    ----------
    states : (k, n, 3) float64 [mm, mm, rad]
        Motions of all bodies, straight in between.
    moves : (k - 1,) int64
        Number of the move that each piece belongs to: a slide has one piece, a turn many.
    """

    states: Floats
    moves: Ints


@dataclass(frozen=True, eq=False)
class SlidePath:
    """What leaves by slides, after slides and turns of single bodies.

    Parameters
    ----------
    before : MoveSequence
    last : Slide
        Without end: it leaves.
    """

    before: MoveSequence
    last: Slide


@dataclass(frozen=True, eq=False)
class Tilt:
    """A state in which a body can be turned, though not until its edges lie along the axes again.

    Parameters
    ----------
    before : MoveSequence
        To the state.
    who : int
    angle : float [rad]
        So far it turns while all others stand.
    """

    before: MoveSequence
    who: int
    angle: float


@dataclass(frozen=True, eq=False)
class SlideSearch:
    """How a search over slides ended.

    Parameters
    ----------
    path : SlidePath or None
    states : int
        Different states that were visited.
    whole : bool
        True where no state is left to go on from, and nothing leaves.
    on_lattice : bool
        True where every stop lies on a lattice: then these are all states, while off it others lie between.
    turned : int
        States in which every body was turned both ways; none where something left before.
    tilts : tuple of Tilt
        Of every class of exchangeable bodies the largest, the largest first.
    """

    path: SlidePath | None
    states: int
    whole: bool
    on_lattice: bool
    turned: int = 0
    tilts: tuple[Tilt, ...] = ()


def slide_search(
    space: SlideSpace,
    motion: Floats,
    targets: Ints,
    *,
    budget: float = WORK_BUDGET,
    turn_budget: float = TURN_BUDGET,
    context: Context,
) -> SlideSearch:
    """Visit all states that slides lead to, those of the fewest slides first, until something leaves; then those that turns lead to.

    Parameters
    ----------
    space : SlideSpace
    motion : (n, 3) float64 [mm, mm, rad]
        Where all bodies are to begin with.
    targets : (k,) int64
        Bodies one of which is to leave; what else leaves is taken only where these do not. None: whatever leaves first.
    budget, turn_budget : float
        Work at most, on slides and on turns.
    context : Context
    """
    search = _SlidesAndTurns(space, motion, targets, context)
    found = search.tree.search(
        Level(search.slides, lambda: search.work > budget * (1.0 if space.on_lattice else OFF_LATTICE_SHARE)),
        Level(search.turns, lambda: search.unwanted is not None or search.turn_space.work > turn_budget),
        context=context,
    )
    most = sorted(search.tilts.values(), key=lambda t: -t[0])
    return SlideSearch(
        found or search.unwanted,
        len(search.tree.states),
        search.tree.whole,
        space.on_lattice,
        search.turned,
        tuple(Tilt(search.sequence(k), t.who, t.angle) for _, k, t in most),
    )


def turn_end(state: Floats, turn: LocalTurn) -> Floats:
    """Motions of all bodies after a turn."""
    after = state.copy()
    after[turn.who] += turn.path[-1]
    return after


class _SlidesAndTurns:
    """The steps from states: slides from all of them before turns from any."""

    def __init__(self, space: SlideSpace, motion: Floats, targets: Ints, context: Context) -> None:
        self.turn_space = TurnSpace(space, targets)
        key = _Canonical(space, self.turn_space.kind, self.turn_space.order).key
        self.tree: StateTree[Floats, Slide | LocalTurn] = StateTree(motion, EqualKeys(motion, key))
        self.unwanted: SlidePath | None = None
        """What leaves first, where it is not to."""
        self.turned, self.tilts = 0, dict[int, tuple[float, int, LocalTurn]]()
        self._space, self._targets, self._context, self._begin = space, targets, context, space.work

    @property
    def work(self) -> float:
        """Work of all slides, in pairs of edges compared."""
        return self._space.work - self._begin + STATE_WORK * len(self.tree.states)

    def slides(self, here: int) -> Iterator[tuple[Floats, Slide] | Exit[SlidePath]]:
        """Slides from a state; one without end where something leaves that is to."""
        if len(self.tree.states) % TELL_EVERY == 0:
            self._context.tell(Progress("slides", len(self.tree.states)))
        state = self.tree.states[here].state
        found = self._space.slides(state, self._context)
        leaving = sorted((s for s in found if np.isinf(s.length)), key=lambda s: len(s.who))
        for last in leaving:
            if not len(self._targets) or np.isin(self._targets, last.who).any():
                yield Exit(SlidePath(self.sequence(here), last))
        if leaving and self.unwanted is None:
            self.unwanted = SlidePath(self.sequence(here), leaving[0])
        for slide in found:
            if np.isfinite(slide.length):
                after = state.copy()
                after[slide.who, :2] += slide.length * slide.direction
                yield after, slide

    def turns(self, here: int) -> Iterator[tuple[Floats, LocalTurn]]:
        """Turns of single bodies from a state."""
        state = self.tree.states[here].state
        for turn in self.turn_space.turns(state):
            if turn.aligned:
                yield turn_end(state, turn), turn
                continue
            kind, angle = int(self.turn_space.kind[turn.who]), turn.angle
            if kind not in self.tilts or angle > self.tilts[kind][0] + MIN_TILT:
                self.tilts[kind] = angle, here, turn
        self.turned += 1

    def sequence(self, state: int) -> MoveSequence:
        """The moves to a state."""
        line = [self.tree.states[k] for k in self.tree.line(state)]
        states, moves = [line[0].state], list[int]()
        for number, (before, after) in enumerate(pairwise(line)):
            step = after.step
            if isinstance(step, LocalTurn):
                path = np.repeat(before.state[None], len(step.path) - 1, 0)
                path[:, step.who] += step.path[1:]
                states += list(path)
                moves += [number] * len(path)
            else:
                states.append(after.state)
                moves.append(number)
        return MoveSequence(np.array(states), np.array(moves, dtype=np.int64))


class _Canonical:
    """Keys of states: the same for states that differ by rounding, or by an exchange of bodies of one class of `kind` (n,)."""

    def __init__(self, space: SlideSpace, kind: Ints, order: Ints) -> None:
        bodies = space.bodies
        self._rest, self._free = bodies.rest, np.flatnonzero(~bodies.fixed & space.there)
        cell = ROUNDING * space.clearance
        self._cell = np.array([cell, cell, cell / max(1e-12, float(bodies.radius.max()))])
        self._kind = kind[self._free]
        self._period = 2 * np.pi / order[bodies.shape[self._free]]

    def key(self, motion: Floats) -> bytes:
        pose = (self._rest + motion)[self._free]
        pose += ROUNDING_OFFSET * self._cell
        pose[:, 2] %= self._period
        cells = np.floor(pose / self._cell).astype(np.int64)
        order = np.lexsort((cells[:, 2], cells[:, 1], cells[:, 0], self._kind))
        return cells[order].tobytes()
