"""The search over states for what leaves by slides, or else after turns: breadth first, so that the fewest slides are found first."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.disassembly.slide_space import Slide, SlideSpace
from wiggleroom.disassembly.turn_space import MIN_TILT, LocalTurn, TurnSpace
from wiggleroom.disassembly.turn_space import WORK_BUDGET as TURN_BUDGET
from wiggleroom.errors import StoppedError
from wiggleroom.search.progress import Progress
from wiggleroom.search.state_tree import StateTree

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
        True where no state is left to go on from.
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
    turns = TurnSpace(space, targets)
    search = _BreadthFirst(space, turns, motion, targets, budget, context)
    whole = search.slide()
    if search.path is not None or not whole:
        return search.result(whole)
    # no slide leads out: bodies are turned in every state, and slide on from where that leads
    turned, tilts = 0, dict[int, tuple[float, int, LocalTurn]]()
    while turned < len(search.tree.states):
        if turns.work > turn_budget or context.stopped:
            whole = False
            break
        state = search.tree.states[turned].motion
        for turn in turns.turns(state):
            if turn.aligned:
                search.reach(turn_end(state, turn), turned, turn)
                continue
            kind, angle = int(turns.kind[turn.who]), turn.angle
            if kind not in tilts or angle > tilts[kind][0] + MIN_TILT:
                tilts[kind] = angle, turned, turn
        turned += 1
        whole = search.slide()
        if search.path is not None or not whole:
            break
    most = sorted(tilts.values(), key=lambda t: -t[0])
    return search.result(whole, turned, tuple(Tilt(search.sequence(k), t.who, t.angle) for _, k, t in most))


def turn_end(state: Floats, turn: LocalTurn) -> Floats:
    """Motions of all bodies after a turn."""
    after = state.copy()
    after[turn.who] += turn.path[-1]
    return after


class _BreadthFirst:
    """The tree of states and those that wait to be gone on from."""

    def __init__(
        self, space: SlideSpace, turns: TurnSpace, motion: Floats, targets: Ints, budget: float, context: Context
    ) -> None:
        self.space, self.targets, self._context = space, targets, context
        self.tree: StateTree[Slide | LocalTurn | None] = StateTree(space.bodies.radius, space.clearance)
        self.path: SlidePath | None = None
        self._key = _Canonical(space, turns.kind, turns.order).key
        self._seen: set[bytes] = set()
        self._waiting: deque[int] = deque()
        self._begin = space.work
        self._budget = budget * (1.0 if space.on_lattice else OFF_LATTICE_SHARE)
        self.reach(motion, -1, None)

    def reach(self, motion: Floats, parent: int, step: Slide | LocalTurn | None) -> None:
        """Keep a state if it is new."""
        named = self._key(motion)
        if named not in self._seen:
            self._seen.add(named)
            self._waiting.append(self.tree.append(motion, parent, step))

    def slide(self) -> bool:
        """Go on from all that wait until something leaves; False where the work, or the time, was over before."""
        while self._waiting:
            if len(self.tree.states) % TELL_EVERY == 0:
                self._context.tell(Progress("slides", len(self.tree.states)))
            spent = self.space.work - self._begin + STATE_WORK * len(self.tree.states)
            if spent > self._budget or self._context.stopped:
                return False
            here = self._waiting.popleft()
            state = self.tree.states[here].motion
            try:
                found = self.space.slides(state, self._context)
            except StoppedError:
                return False
            leaving = sorted((s for s in found if np.isinf(s.length)), key=lambda s: len(s.who))
            for last in leaving:
                if not len(self.targets) or np.isin(self.targets, last.who).any():
                    self.path = SlidePath(self.sequence(here), last)
                    return True
            if self.path is None and leaving:
                self.path = SlidePath(self.sequence(here), leaving[0])
            for slide in found:
                if np.isinf(slide.length):
                    continue
                after = state.copy()
                after[slide.who, :2] += slide.length * slide.direction
                self.reach(after, here, slide)
        return True

    def sequence(self, state: int) -> MoveSequence:
        """The moves to a state."""
        line = [self.tree.states[k] for k in self.tree.line(state)]
        states, moves = [line[0].motion], list[int]()
        for number, (before, after) in enumerate(pairwise(line)):
            step = after.step
            if isinstance(step, LocalTurn):
                path = np.repeat(before.motion[None], len(step.path) - 1, 0)
                path[:, step.who] += step.path[1:]
                states += list(path)
                moves += [number] * len(path)
            else:
                states.append(after.motion)
                moves.append(number)
        return MoveSequence(np.array(states), np.array(moves, dtype=np.int64))

    def result(self, whole: bool, turned: int = 0, tilts: tuple[Tilt, ...] = ()) -> SlideSearch:
        """How it ended."""
        return SlideSearch(self.path, len(self.tree.states), whole, self.space.on_lattice, turned, tilts)


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
