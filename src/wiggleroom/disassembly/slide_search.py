"""The search over states for what leaves by slides: breadth first, so that the fewest moves are found first."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.slide_space import Slide, SlideSpace
from wiggleroom.errors import Stop, StoppedError
from wiggleroom.search.loop import Progress
from wiggleroom.search.state_tree import StateTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WORK_BUDGET = 2e9
"""Pairs of edges that are compared at most; some ten seconds."""
OFF_LATTICE_SHARE = 0.25
"""Where stops lie on no lattice there is no end of states; so much of the work is spent on them."""
STATE_WORK = 30_000
"""Work of a state besides its edges, in pairs of edges."""
ROUNDING = 0.5
"""States in which every body lies in the same cell of this share of the clearance are the same."""
ROUNDING_OFFSET = 0.382
"""Cells lie a little beside whole units: states on a lattice would else fall on their borders."""
TELL_EVERY = 50


@dataclass(frozen=True, eq=False)
class SlideWay:
    """What leaves by slides, and the way to there.

    Parameters
    ----------
    slides : tuple of Slide
        One after the other; with the last, which has no end, they leave.
    states : (k, n, 3) float64 [mm, mm, rad]
        Motions of all bodies before each of them.
    """

    slides: tuple[Slide, ...]
    states: Floats


@dataclass(frozen=True, eq=False)
class SlideSearch:
    """How a search over slides ended.

    Parameters
    ----------
    way : SlideWay or None
    states : int
        Different states that were visited.
    whole : bool
        True where no state is left to go on from.
    on_lattice : bool
        True where every stop lies on a lattice: then these are all states, while off it others lie between.
    """

    way: SlideWay | None
    states: int
    whole: bool
    on_lattice: bool


def slide_search(
    space: SlideSpace,
    motion: Floats,
    targets: Ints,
    *,
    stop: Stop | None = None,
    tell: Callable[[Progress], None],
    budget: float = WORK_BUDGET,
) -> SlideSearch:
    """Visit all states that slides lead to, those of the fewest slides first, until something leaves.

    Parameters
    ----------
    space : SlideSpace
    motion : (n, 3) float64 [mm, mm, rad]
        Where all bodies are to begin with.
    targets : (k,) int64
        Bodies one of which is to leave; what else leaves is taken only where these do not. None: whatever leaves first.
    stop, tell
        As for `flex`.
    budget : float
        Work at most.
    """
    key = _Canonical(space, targets).key
    tree: StateTree[Slide | None] = StateTree(space.bodies.radius, space.clearance)
    tree.append(motion, -1, None)
    seen, waiting = {key(motion)}, deque([0])
    begin, other = space.work, None
    budget *= 1.0 if space.on_lattice else OFF_LATTICE_SHARE
    while waiting:
        if len(tree.states) % TELL_EVERY == 0:
            tell(Progress("slides", len(tree.states)))
        spent = space.work - begin + STATE_WORK * len(tree.states)
        if spent > budget or (stop is not None and stop.is_set()):
            return SlideSearch(other, len(tree.states), False, space.on_lattice)
        here = waiting.popleft()
        state = tree.states[here].motion
        try:
            found = space.slides(state, stop)
        except StoppedError:
            return SlideSearch(other, len(tree.states), False, space.on_lattice)
        leaving = sorted((s for s in found if np.isinf(s.length)), key=lambda s: len(s.who))
        for last in leaving:
            if not len(targets) or np.isin(targets, last.who).any():
                return SlideSearch(_way(tree, here, last), len(tree.states), True, space.on_lattice)
        if other is None and leaving:
            other = _way(tree, here, leaving[0])
        for slide in found:
            if np.isinf(slide.length):
                continue
            after = state.copy()
            after[slide.who, :2] += slide.length * slide.direction
            named = key(after)
            if named not in seen:
                seen.add(named)
                waiting.append(tree.append(after, here, slide))
    return SlideSearch(other, len(tree.states), True, space.on_lattice)


def _way(tree: StateTree[Slide | None], state: int, last: Slide) -> SlideWay:
    line = [tree.states[k] for k in tree.line(state)]
    slides = (*(s.step for s in line if s.step is not None), last)
    return SlideWay(slides, np.array([s.motion for s in line]))


class _Canonical:
    """Keys of states: the same for states that differ by rounding, or by an exchange of bodies of the same shape."""

    def __init__(self, space: SlideSpace, named: Ints) -> None:
        bodies = space.bodies
        self._rest, self._free = bodies.rest, np.flatnonzero(~bodies.fixed & space.there)
        cell = ROUNDING * space.clearance
        self._cell = np.array([cell, cell, cell / max(1e-12, float(bodies.radius.max()))])
        kind = bodies.shape.copy()
        for k, b in enumerate(named.tolist()):
            kind[b] = kind.max() + 1 + k
        self._kind = kind[self._free]

    def key(self, motion: Floats) -> bytes:
        pose = (self._rest + motion)[self._free]
        pose[:, 2] %= 2 * np.pi
        cells = np.floor(pose / self._cell + ROUNDING_OFFSET).astype(np.int64)
        order = np.lexsort((cells[:, 2], cells[:, 1], cells[:, 0], self._kind))
        return cells[order].tobytes()
