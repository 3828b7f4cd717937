"""Does an assembly of boxes come apart by moves of whole steps: an exhaustive search on the lattice of its coordinates.

Parts made of axis-aligned boxes, as drawn without gaps, have all faces on a lattice. Every path by whole steps is a path of the parts as
made, which are smaller. Where the search ends without a path out, none exists by whole steps; turns, and what the gaps allow besides,
are not seen.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.errors import Stop
from wiggleroom.spatial.solids.spatial_model import Boxes
from wiggleroom.spatial.spatial_prepare import SpatialPrepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ROUNDING = 1e-6
"""Coordinates are whole multiples of this [mm]."""
MAX_CELLS = 20_000_000
"""Most entries of all tables of blocked offsets together."""
MAX_STATES = 100_000
"""Most arrangements that are looked at."""
MAX_BODIES = 60
"""Assemblies of more bodies are not searched by whole steps."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """Bodies of boxes on a lattice.

    Parameters
    ----------
    step : float [mm]
    blocked : (n, n, x, y, z) bool
        Where bodies i and j overlap, j seen from i, from both at rest; the middle is rest. Beyond the ends nothing does.
    stands : (n, 3) bool
        Which bodies may not move along an axis.
    """

    step: float
    blocked: Bools
    stands: Bools


def lattice(ready: SpatialPrepared) -> Lattice | None:
    """The lattice of an assembly.

    None where parts are not boxes along the axes of the world, where they overlap as drawn, and where there are too many cells.
    """
    assembly, grouping = ready.assembly, ready.grouping
    count = len(grouping.bodies.at)
    if assembly.drawing.ignore or count > MAX_BODIES:
        return None
    corners: list[list[Floats]] = [[] for _ in range(count)]
    for part, body in zip(assembly.parts, grouping.body_of.tolist(), strict=True):
        if not isinstance(part.solid, Boxes) or not np.allclose(np.abs(part.R).max(axis=0), 1.0, atol=1e-9):
            return None
        placed = part.solid.boxes @ part.R.T + part.at
        corners[body].append(np.stack([placed.min(axis=1), placed.max(axis=1)], axis=1))
    boxes = [np.vstack(b) for b in corners]
    every = np.vstack(boxes)
    whole = np.round((every - every[0, 0]) / ROUNDING).astype(np.int64)
    unit = int(np.gcd.reduce(whole.ravel()))
    if unit == 0:
        return None
    cells = [np.round((b - every[0, 0]) / ROUNDING).astype(np.int64) // unit for b in boxes]
    low = np.array([c[:, 0].min(axis=0) for c in cells])
    high = np.array([c[:, 1].max(axis=0) for c in cells])
    reach = (np.abs(high[:, None] - low[None]).max(axis=(0, 1))) + 1
    if float(np.prod(2.0 * reach + 1)) * count**2 > MAX_CELLS:
        return None
    solid = []
    for c, lo, hi in zip(cells, low, high, strict=True):
        filled = np.zeros(hi - lo, dtype=bool)
        for one, other in c - lo:
            filled[tuple(map(slice, one, other))] = True
        solid.append(filled)
    blocked = np.zeros((count, count, *(2 * reach + 1)), dtype=bool)
    for i in range(count):
        for j in range(count):
            if i == j:
                continue
            # entry k of the convolution: cells of j moved by d meet cells of i, d = k - (shape of j - 1) - (low j - low i)
            common = _convolved(solid[i], solid[j][::-1, ::-1, ::-1]) > 0.5
            first = low[i] - low[j] - (np.array(solid[j].shape) - 1) + reach
            table = blocked[i, j]
            table[tuple(slice(a, a + n) for a, n in zip(first, common.shape, strict=True))] = common
            if table[tuple(reach)]:
                return None
    free = grouping.bodies.free[:, :3]
    return Lattice(unit * ROUNDING, blocked, ~free)


def _convolved(one: Bools, other: Bools) -> Floats:
    """Convolution of two blocks of cells, by Fourier transforms."""
    shape = [m + n - 1 for m, n in zip(one.shape, other.shape, strict=True)]
    axes = (0, 1, 2)
    return np.fft.irfftn(np.fft.rfftn(one, shape, axes) * np.fft.rfftn(other, shape, axes), shape, axes)


@njit(**OPTIONS)
def moves(blocked, stands, offset, groups, leaves):
    """Fill groups (n, 6, n): bodies that go along when one moves by a step, and leaves (n, 6): True where they go on for ever.

    A group that holds a body that may not move is empty.
    """
    n = len(offset)
    reach = np.array([(blocked.shape[2] - 1) // 2, (blocked.shape[3] - 1) // 2, (blocked.shape[4] - 1) // 2])
    met, ahead = np.zeros((n, n), dtype=np.bool_), np.zeros((n, n), dtype=np.bool_)
    todo = np.empty(n, dtype=np.int64)
    for direction in range(6):
        axis, sign = direction // 2, 1 - 2 * (direction % 2)
        met[:], ahead[:] = False, False
        for i in range(n):
            for j in range(n):
                if i == j:
                    continue
                x = np.empty(3, dtype=np.int64)
                inside = True
                for t in range(3):
                    x[t] = offset[j, t] - offset[i, t] + reach[t]
                    if t != axis and (x[t] < 0 or x[t] >= 2 * reach[t] + 1):
                        inside = False
                if not inside:
                    continue
                for far in range(1, 4 * reach[axis] + 4):
                    y = x[axis] - sign * far
                    if (sign > 0 and y < 0) or (sign < 0 and y > 2 * reach[axis]):
                        break
                    if y < 0 or y > 2 * reach[axis]:
                        continue
                    x[axis], kept = y, x[axis]
                    hit = blocked[i, j, x[0], x[1], x[2]]
                    x[axis] = kept
                    if hit:
                        ahead[i, j] = True
                        met[i, j] = far == 1
                        break
        for first in range(n):
            for kind in range(2):
                table = met if kind == 0 else ahead
                group = np.zeros(n, dtype=np.bool_)
                group[first] = True
                todo[0], top, good = first, 1, not stands[first, axis]
                while top and good:
                    top -= 1
                    i = todo[top]
                    for j in range(n):
                        if table[i, j] and not group[j]:
                            group[j] = True
                            good = good and not stands[j, axis]
                            todo[top] = j
                            top += 1
                if kind == 0:
                    groups[first, direction] = group & good
                else:
                    leaves[first, direction] = good and not group.all()


@dataclass(frozen=True, eq=False)
class LatticeSearch:
    """What an exhaustive search by whole steps found.

    Parameters
    ----------
    offsets : tuple of (n, 3) int64
        Steps of all bodies from rest on, to where some go on for ever; empty where no path out was found.
    axis, sign : int
        The direction in which they go on.
    complete : bool
        True where all arrangements within reach were looked at.
    """

    offsets: tuple[Ints, ...] = ()
    axis: int = 0
    sign: int = 1
    complete: bool = True


def lattice_search(found: Lattice, stop: Stop | None) -> LatticeSearch:
    """Look for a path out by whole steps, breadth first."""
    n = len(found.stands)
    rest = np.zeros((n, 3), dtype=np.int64)
    groups, leaves = np.zeros((n, 6, n), dtype=bool), np.zeros((n, 6), dtype=bool)
    before: dict[bytes, tuple[Ints, bytes | None]] = {rest.tobytes(): (rest, None)}
    todo = deque([rest])
    while todo:
        if len(before) > MAX_STATES or (stop is not None and stop.is_set()):
            return LatticeSearch(complete=False)
        offset = todo.popleft()
        moves(found.blocked, found.stands, offset, groups, leaves)
        if leaves.any():
            key: bytes | None = offset.tobytes()
            path: list[Ints] = []
            while key is not None:
                state, key = before[key]
                path.append(state)
            k = int(np.argwhere(leaves)[0][1])
            return LatticeSearch(tuple(path[::-1]), k // 2, 1 - 2 * (k % 2))
        ahead = {}
        for first, k in np.argwhere(groups.any(axis=2)):
            moved = offset.copy()
            moved[groups[first, k], k // 2] += 1 - 2 * (k % 2)
            ahead[moved.tobytes()] = moved
        for name, moved in ahead.items():
            if name not in before:
                before[name] = (moved, offset.tobytes())
                todo.append(moved)
    return LatticeSearch()


def lattice_motions(ready: SpatialPrepared, found: Lattice, search: LatticeSearch) -> Floats:
    """Motions (k, n, 6) [mm, rad] of the parts along a path by whole steps; steps that go on in the same direction are one."""
    offsets = np.array(search.offsets)
    step = np.diff(offsets, axis=0)
    turns = np.flatnonzero((step[1:] != step[:-1]).any(axis=(1, 2))) + 1
    kept = np.unique(np.concatenate([[0], turns, [len(offsets) - 1]]))
    motions = np.zeros((len(kept), len(ready.assembly.parts), 6))
    motions[:, :, :3] = found.step * offsets[kept][:, ready.grouping.body_of]
    return motions
