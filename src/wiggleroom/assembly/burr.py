"""Six-piece burrs from the numbers of their pieces."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Boxes, Drawing, Part
from wiggleroom.drawing.readers.voxel_puzzle import CELL, GAP, TURNS, lumps, orientation, rods
from wiggleroom.errors import InputError

Ints = NDArray[np.int64]
Cell = tuple[int, int, int]
Placement = tuple[frozenset[Cell], ...]
"""Cells of the sticks of an assembly, in the order of the numbers asked for."""

PIECES, MOST_NUMBER, MOST_LENGTH = 6, 4096, 100
CUBES = (
    *((x, y, 0) for y in (-1, 0) for x in (-2, -1, 0, 1)),
    *((x, y, -1) for y in (-1, 0) for x in (-1, 0)),
)
"""The cubes that may be missing from a stick along x, the least bit of its number first; z looks to the middle of the burr."""


def burr(numbers: Sequence[int], gap: float = GAP, cell: float = CELL, length: int = 6, way: int = 1) -> Drawing:
    """Six-piece burr of the sticks that have some numbers, put together.

    A stick is 2 x 2 cells wide. Twelve of its cubes may be missing; cube k counts 2^k, and the number of a stick is 1 more than the sum of
    those that are missing. The four cubes of each row of the notched side come first, then the two below the middle of each row.

    Parameters
    ----------
    numbers : sequence of int
        Six numbers from 1, the solid stick, to 4096.
    gap, cell : float [mm]
        Clearance between sticks; side of a cube.
    length : int
        Cells in the length of a stick, even, at least 6.
    way : int
        Which of the ways to put these sticks together, from 1.

    Returns
    -------
    Drawing
        Its parts, where they lie when the burr is put together.

    Raises
    ------
    InputError
        If a number is none of a stick, a stick falls to pieces, or the sticks do not go together.

    Examples
    --------
    >>> [part.name for part in burr([1, 256, 824, 928, 975, 1024]).parts]
    ['b1', 'b256', 'b824', 'b928', 'b975', 'b1024']

    Source: the numbers of H. Kaenel and W. Cutler (IBM Research, The burr puzzles site, Def. 9.1).
    """
    wrong = _misfits(numbers, gap, cell, length)
    if wrong:
        raise InputError(wrong)
    ways = list(_ways([_stick(k, length) for k in numbers]))
    said = " ".join(map(str, numbers))
    if not ways:
        message = f"burr {said}: these six sticks do not go together as a six-piece burr; choose others"
        raise InputError(message)
    if not 1 <= way <= len(ways):
        message = f"burr {said}: there is no way {way} to put these sticks together; there are {len(ways)}, from 1"
        raise InputError(message)
    parts = tuple(
        Part(name, solid=Boxes(cell * rods(_array(cells))))
        for name, cells in zip(_names(numbers), ways[way - 1], strict=True)
    )
    notes = (f"way {way} of {len(ways)} to put these sticks together",) if len(ways) > 1 else ()
    return Drawing(parts, gap, source=f"burr {said}", notes=notes)


def _misfits(numbers: Sequence[int], gap: float, cell: float, length: int) -> list[str]:
    """One line for each thing that makes no burr."""
    wrong = []
    if len(numbers) != PIECES:
        wrong.append(f"burr: {len(numbers)} numbers; a six-piece burr has {PIECES}")
    if not 6 <= length <= MOST_LENGTH or length % 2:
        wrong.append(f"burr: length {length}; it must be even, from 6 to {MOST_LENGTH} cells")
    if not (math.isfinite(cell) and cell > 0):
        wrong.append(f"burr: cell {cell:g}; it must be more than 0")
    elif not 0 <= gap < cell:
        wrong.append(f"burr: gap {gap:g}; it must be from 0 to less than a cell, {cell:g} mm")
    for k in numbers:
        if not 1 <= k <= MOST_NUMBER:
            wrong.append(f"burr: stick {k}; numbers go from 1 to {MOST_NUMBER}")
        elif lumps(_array(_stick(k, 6))) > 1:
            wrong.append(f"burr: stick {k} falls to pieces; choose another number")
    return wrong


def _stick(number: int, length: int) -> set[Cell]:
    """Cells of a stick along x by their lower corners, the notched side at z = 0."""
    missing = {cube for k, cube in enumerate(CUBES) if number - 1 >> k & 1}
    every = itertools.product(range(-length // 2, length // 2), (-1, 0), (-1, 0))
    return {cube for cube in every if cube not in missing}


def _ways(sticks: Sequence[set[Cell]]) -> Iterator[Placement]:
    """Ways to put six sticks together, those that are turned into each other once.

    The rotations of the burr take every place to every other one, so the first stick stays where it is.
    """
    lying = [_orientations(stick) for stick in sticks]
    placed = [[(place, _placed(one, place)) for place in range(PIECES) for one in some] for some in lying]
    seen: set[frozenset[frozenset[Cell]]] = set()
    front: list[tuple[Placement, frozenset[Cell], int]] = [((one,), one, 1) for place, one in placed[0] if not place]
    while front:
        way, filled, taken = front.pop()
        if len(way) == PIECES:
            if seen.isdisjoint(frozenset(_turned(cells, orientation(k)) for cells in way) for k in range(TURNS)):
                seen.add(frozenset(way))
                yield way
            continue
        for place, cells in placed[len(way)]:
            if not taken >> place & 1 and filled.isdisjoint(cells):
                front.append(((*way, cells), filled | cells, taken | 1 << place))


def _orientations(stick: set[Cell]) -> list[frozenset[Cell]]:
    """A stick turned about its length and end for end, wherever only cubes that may be missing are; each shape once."""
    length = max(x for x, _, _ in stick) + 1
    always = _stick(MOST_NUMBER, 2 * length)
    turned = (_turned(stick, orientation(k)) for k in range(TURNS))
    return sorted({cells for cells in turned if always <= cells}, key=sorted)


def _placed(stick: frozenset[Cell], place: int) -> frozenset[Cell]:
    """Cells of a stick at one of the six places of a burr: along an axis, to one side of the middle along the next axis."""
    axis, side = place // 2, 1 if place % 2 else -1
    turn = np.zeros((3, 3), dtype=np.int64)
    turn[axis, 0], turn[(axis + 1) % 3, 2] = 1, -side
    turn[:, 1] = np.cross(turn[:, 2], turn[:, 0])
    return _turned(stick, turn, side * np.eye(3, dtype=np.int64)[(axis + 1) % 3])


def _turned(cells: Collection[Cell], turn: Ints, shift: Ints | int = 0) -> frozenset[Cell]:
    """Lower corners of cells that are turned about the origin and shifted."""
    middles = 2 * _array(cells) + 1
    return frozenset((x, y, z) for x, y, z in ((middles @ turn.T - 1) // 2 + shift).tolist())


def _array(cells: Collection[Cell]) -> Ints:
    return np.array(sorted(cells), dtype=np.int64)


def _names(numbers: Sequence[int]) -> list[str]:
    return [f"b{k}" if numbers.index(k) == i else f"b{k}_{numbers[: i + 1].count(k)}" for i, k in enumerate(numbers)]
