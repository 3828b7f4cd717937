"""Does an assembly on a lattice come apart by moves of whole steps: an exhaustive search.

A move takes some bodies as one any number of steps along an axis. Every path of the cells is a path of the parts, which lie in them. Where
the search ends without a path out, none exists by whole steps; turns, and what clearances allow besides, are not seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.context import Context
from wiggleroom.search.state_tree import EqualKeys, Exit, Level, StateTree
from wiggleroom.spatial.escapes.lattice import Lattice
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared

Floats = NDArray[np.float64]
Steps = NDArray[np.int16]

MAX_STATES, MAX_PAIRS = 300_000, 15_000_000
"""Most arrangements that are looked at, and most pairs of bodies in all of them."""
MAX_GROUPS = 128
"""Most sets of bodies that are moved in one direction from one arrangement."""
MAX_NEXT = 8192
"""Most arrangements that follow one."""


@njit(**OPTIONS)
def ahead_of(blocked, first, shape, low, offset, direction, met, ahead):
    """Fill met (n, n) and ahead (n, n): True where body i, moved in a direction, meets j after one step, and ever."""
    axis, back = direction // 2, direction % 2
    n = len(offset)
    for i in range(n):
        for j in range(n):
            met[i, j] = ahead[i, j] = False
            if i == j:
                continue
            index, within = 0, True
            y = 0
            for t in range(3):
                x = offset[j, t] - offset[i, t] - low[i, j, t]
                size = shape[i, j, t]
                if t == axis:
                    y = x + 1 if back else x - 1
                    x = min(max(y, 0), size - 1)
                    within = within and (y <= size - 1 if back else y >= 0)
                elif x < 0 or x >= size:
                    within = False
                index = index * size + x
            if within:
                bits = blocked[first[i, j] + index]
                ahead[i, j] = bits >> (1 + direction) & 1
                met[i, j] = 0 <= y < shape[i, j, axis] and bits & 1


@njit(**OPTIONS)
def meets(blocked, first, shape, low, offset, axis, step, group):
    """True where a group (n,), moved by a step along an axis, meets another body."""
    n = len(offset)
    for i in range(n):
        for j in range(n):
            if not group[i] or group[j]:
                continue
            index, within = 0, True
            for t in range(3):
                x = offset[j, t] - offset[i, t] - low[i, j, t] - (step if t == axis else 0)
                within = within and 0 <= x < shape[i, j, t]
                index = index * shape[i, j, t] + x
            if within and blocked[first[i, j] + index] & 1:
                return True
    return False


@njit(**OPTIONS)
def pushed(table, stands, start, axis, group):
    """Fill a group (n,) with a body and all that it pushes; False where one of them stands."""
    n = len(group)
    group[:] = False
    group[start] = True
    todo = np.empty(n, dtype=np.int64)
    todo[0], top = start, 1
    while top:
        top -= 1
        i = todo[top]
        if stands[i, axis]:
            return False
        for j in range(n):
            if table[i, j] and not group[j]:
                group[j] = True
                todo[top] = j
                top += 1
    return True


@njit(**OPTIONS)
def added(groups, count, group):
    """Number of groups once another one is among them."""
    for k in range(count):
        if (groups[k] == group).all():
            return count
    if count < len(groups):
        groups[count] = group
        count += 1
    return count


@njit(**OPTIONS)
def next_steps(blocked, first, shape, low, stands, offset, out):
    """Fill the arrangements (m, n, 3) one move away: how many, and a direction in which some go on for ever, or -1.

    Moved are sets of bodies that push no others: what single ones push, and unions of these.
    """
    n = len(offset)
    met, ahead = np.zeros((n, n), dtype=np.bool_), np.zeros((n, n), dtype=np.bool_)
    groups, group = np.zeros((MAX_GROUPS, n), dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    found = 0
    for direction in range(6):
        axis, step = direction // 2, 1 - 2 * (direction % 2)
        ahead_of(blocked, first, shape, low, offset, direction, met, ahead)
        count = 0
        for start in range(n):
            if pushed(ahead, stands, start, axis, group) and not group.all():
                return 0, direction
            if pushed(met, stands, start, axis, group):
                count = added(groups, count, group)
        single, k = count, 0
        while k < count:
            for other in range(single):
                count = added(groups, count, groups[k] | groups[other])
            k += 1
        for k in range(count):
            if groups[k].all():
                continue
            moved, free = offset.copy(), True
            while free and found < len(out):
                for i in range(n):
                    if groups[k, i]:
                        moved[i, axis] += step
                out[found] = moved
                found += 1
                free = not meets(blocked, first, shape, low, moved, axis, step, groups[k])
    return found, -1


@dataclass(frozen=True, eq=False)
class LatticeSearch:
    """What an exhaustive search by whole steps found.

    Parameters
    ----------
    offsets : tuple of (n, 3) int16
        Steps of all bodies from rest on, to where some go on for ever; empty where no path out was found.
    axis, sign : int
        The direction in which they go on.
    complete : bool
        True where all arrangements within reach were looked at.
    arrangements : tuple of (n, 3) int16
        Those, as steps of all bodies from rest, which is the first.
    before : tuple of int
        Number of the one from which each was reached first; -1 for rest.
    """

    offsets: tuple[Steps, ...] = ()
    axis: int = 0
    sign: int = 1
    complete: bool = True
    arrangements: tuple[Steps, ...] = ()
    before: tuple[int, ...] = ()


def lattice_search(found: Lattice, context: Context) -> LatticeSearch:
    """Look for a path out by whole steps, breadth first over moves, so that it has as few as any such path."""
    n = len(found.stands)
    rest = np.zeros((n, 3), dtype=np.int16)
    tree: StateTree[Steps, None] = StateTree(rest, EqualKeys(rest, lambda steps: steps.tobytes()))
    out = np.empty((MAX_NEXT, n, 3), dtype=np.int16)
    most = min(MAX_STATES, MAX_PAIRS // n**2)
    complete = True

    def moves(here: int) -> Iterator[tuple[Steps, None] | Exit[LatticeSearch]]:
        nonlocal complete
        count, away = next_steps(
            found.blocked, found.first, found.shape, found.low, found.stands, tree.states[here].state, out
        )
        if away >= 0:
            path = tuple(tree.states[k].state for k in tree.line(here))
            yield Exit(LatticeSearch(path, away // 2, 1 - 2 * (away % 2)))
        complete = complete and count < MAX_NEXT
        for k in range(count):
            yield out[k].copy(), None

    ended = tree.search(Level(moves, lambda: len(tree.states) > most), context=context)
    if ended is not None:
        return ended
    seen = tree.states
    return LatticeSearch(
        complete=complete and tree.whole,
        arrangements=tuple(v.state for v in seen),
        before=tuple(v.parent for v in seen),
    )


def lattice_motions(ready: SpatialPrepared, found: Lattice, steps: Sequence[Steps]) -> Floats:
    """Motions (k, n, 6) [mm, rad] of the parts where all bodies are whole steps (k, n, 3) from rest."""
    offsets = np.array(steps)[:, ready.grouping.body_of]
    motions = np.zeros((len(offsets), len(ready.assembly.parts), 6))
    motions[:, :, :3] = (offsets * found.step) @ found.frame.T
    return motions
