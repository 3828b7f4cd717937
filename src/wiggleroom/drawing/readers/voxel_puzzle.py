"""Read voxel puzzles: the numbers of the pieces in a block of cells (.puz), and projects of BurrTools (.xmpuzzle)."""

from __future__ import annotations

import gzip
import io
import math
import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Boxes, Drawing, Part
from wiggleroom.drawing.readers.source import Source, load, read_bytes
from wiggleroom.drawing.readers.xmltree import Element, parse_xml
from wiggleroom.errors import InputError

Ints = NDArray[np.int64]

CELL, GAP = 10.0, 0.2
"""Side of a cell, and the gap that is taken where none is asked for [mm]."""
MOST_BYTES = 10_000_000
"""Bytes of a file at most, and how far from the origin a piece may lie [cells]."""
MOST_CELLS, MOST_RODS = 1_000_000, 10_000
"""Cells of a puzzle, and rows of filled cells along x of all pieces, at most."""
MOST_PIECES = 1000
"""Pieces of a puzzle at most."""
UNPLACED = "x"
"""Stands for a piece that is not used."""
TURNS = 24
"""Orientations of a cube; from this number on they are mirrored."""
_VOXEL = re.compile(r"([#+_])(\d*)")


def read_puzzle(path: Path, solution: int = 0) -> Drawing:
    """Pieces of a voxel puzzle where they lie when it is put together [mm].

    Parameters
    ----------
    path : Path
        File whose name ends in .puz or .xmpuzzle.
    solution : int
        Which solution of the first solved problem of a project, from 0.

    Raises
    ------
    InputError
        If the file is none, or does not say where the pieces lie.
    """
    if path.suffix.lower() == ".xmpuzzle":
        return _burrtools(path, solution)
    return _plain(path)


def _plain(path: Path) -> Drawing:
    """A block of numbers: its size, perhaps the sides of a cell, then the piece of every cell, x first, 0 for none."""
    source = load(path, opening="\0", name="puzzle")
    lines = [line.split() for line in source.text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    try:
        size = [int(word) for word in lines[0]]
        sides = len(lines) > 1 and len(lines[1]) == 3 and any("." in word for word in lines[1])
        numbers = [int(word) for line in lines[1 + sides :] for word in line]
    except (ValueError, IndexError):
        message = (
            f"{source.name}: is no voxel puzzle; it must be three sizes, and then the number of a piece for every cell"
        )
        raise InputError(message) from None
    if len(size) != 3 or min(size) < 1 or len(numbers) != math.prod(size) or min(numbers) < 0:
        what = " x ".join(map(str, size[:4]))
        message = (
            f"{source.name}: has {len(numbers)} numbers for {what} cells; after three sizes there must be one for every "
            "cell, 0 or the number of a piece"
        )
        raise InputError(message)
    if len(numbers) > MOST_CELLS:
        message = f"{source.name}: has {len(numbers)} cells; at most {MOST_CELLS} are read"
        raise InputError(message)
    block = np.array(numbers).reshape(size[::-1]).transpose()
    pieces = [(f"p{k}", np.argwhere(block == k)) for k in np.unique(block[block > 0]).tolist()]
    notes = ["sides of a cell in the file are left out"] if sides else []
    return _drawing(source.name, pieces, notes)


@dataclass(frozen=True)
class _Stored:
    """A solved problem of a project: its number and name, the shapes of the pieces that its solutions place, and these."""

    number: int
    name: str
    pieces: list[int]
    assemblies: list[str]
    grouped: bool


def _burrtools(path: Path, solution: int) -> Drawing:
    """Shapes as the solution of a problem places them."""
    root = parse_xml(_unpacked(path))
    if root.tag != "puzzle":
        message = f"{path.name}: is no project of BurrTools; its outermost element must be puzzle"
        raise InputError(message)
    grid = _first(root, "gridType")
    if grid is not None and grid.attributes.get("type", "0") != "0":
        message = f"{path.name}: has cells of gridType {grid.attributes['type'][:20]}; only cubes, type 0, are read"
        raise InputError(message)
    shapes = _first(root, "shapes")
    problems = _first(root, "problems")
    every = problems.children if problems is not None else []
    solved = [found for k, element in enumerate(every) if (found := _stored(path.name, k, element)) is not None]
    if shapes is None or not solved or solution >= len(solved[0].assemblies):
        message = (
            f"{path.name}: no problem has a stored solution that says where the pieces lie: solve it in BurrTools and save it "
            "with its solutions"
        )
        raise InputError(message)
    chosen = solved[0]
    placed = _placements(path.name, chosen.assemblies[solution])
    if len(placed) > len(chosen.pieces):
        message = f"{path.name}: a solution places {len(placed)} pieces, but its problem has {len(chosen.pieces)}"
        raise InputError(message)
    pieces: list[tuple[str, Ints]] = []
    for shape, place in zip(chosen.pieces, placed, strict=False):
        if place is not None:
            if not 0 <= shape < len(shapes.children):
                message = f"{path.name}: a problem uses shape {shape}, but there are {len(shapes.children)} shapes"
                raise InputError(message)
            element = shapes.children[shape]
            cells = _cells(path.name, shape, element)
            spot = np.array([_number(path.name, element, key) for key in ("hx", "hy", "hz")])
            name = element.attributes.get("name", "").strip() or f"S{shape + 1}"
            pieces.append((name, (cells - spot) @ orientation(place[3]).T + place[:3]))
    return _drawing(path.name, pieces, _left_out(root, len(every), chosen, solution))


def _unpacked(path: Path) -> Source:
    raw = read_bytes(path)
    if raw[:2] == b"\x1f\x8b":
        try:
            with gzip.open(io.BytesIO(raw)) as packed:
                raw = packed.read(MOST_BYTES + 1)
        except (OSError, EOFError, zlib.error):
            message = f"{path.name}: is packed and cannot be unpacked; save it again"
            raise InputError(message) from None
    if len(raw) > MOST_BYTES:
        message = f"{path.name}: has more than {MOST_BYTES} characters; save it with fewer solutions"
        raise InputError(message)
    return Source(path.name, raw.decode("utf-8", "replace"))


def _stored(file: str, number: int, element: Element) -> _Stored | None:
    """A problem whose solutions are in the file; None where there are none."""
    solutions = _first(element, "solutions")
    texts = [] if solutions is None else [_first(s, "assembly") for s in solutions.children]
    assemblies = [found.text for found in texts if found is not None]
    shapes = _first(element, "shapes")
    if not assemblies or shapes is None:
        return None
    pieces: list[int] = []
    for shape in shapes.children:
        most = shape.attributes.get("count") or shape.attributes.get("max", "1")
        if not most.isdecimal() or len(most) > len(str(MOST_PIECES)) or len(pieces) + int(most) > MOST_PIECES:
            message = (
                f'{file}: line {shape.line}: a shape is used "{most[:20]}" times; at most {MOST_PIECES} pieces are read'
            )
            raise InputError(message)
        pieces += [_number(file, shape, "id")] * int(most)
    grouped = any("group" in shape.attributes for shape in shapes.children)
    return _Stored(number, element.attributes.get("name", ""), pieces, assemblies, grouped)


def _placements(file: str, text: str) -> list[tuple[int, int, int, int] | None]:
    """Place and orientation of each piece; None for one that is not used."""
    words = text.split()
    found: list[tuple[int, int, int, int] | None] = []
    k = 0
    while k < len(words):
        if words[k] == UNPLACED:
            found.append(None)
            k += 1
            continue
        try:
            x, y, z, turn = (int(word) for word in words[k : k + 4])
        except ValueError:
            turn = x = y = z = -1
        if not 0 <= turn < 2 * TURNS or max(map(abs, (x, y, z))) > MOST_BYTES:
            said = " ".join(words[k : k + 4])[:40]
            message = f'{file}: a solution has "{said}" for a piece; it must be x, y, z and one of 48 orientations'
            raise InputError(message)
        found.append((x, y, z, turn))
        k += 4
    return found


def orientation(number: int) -> Ints:
    """Matrix (3, 3) of an orientation of a cube: quarter turns about x, then x goes to one of six directions, and perhaps a mirror."""
    to, about = divmod(number % TURNS, 4)
    turn = np.linalg.matrix_power(_quarter(0, 1), about)
    turn = (np.linalg.matrix_power(_quarter(1, -1), to) if to < 4 else _quarter(2, 1 if to == 4 else -1)) @ turn
    return np.diag([-1, 1, 1]) @ turn if number >= TURNS else turn


def _quarter(axis: int, sense: int) -> Ints:
    """A quarter turn about an axis, right hand where `sense` is 1."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn = np.zeros((3, 3), dtype=np.int64)
    turn[axis, axis], turn[other, one], turn[one, other] = 1, sense, -sense
    return turn


def _cells(file: str, number: int, element: Element) -> Ints:
    """Filled cells (k, 3) of a shape."""
    size = [_number(file, element, key) for key in ("x", "y", "z")]
    text = "".join(element.text.split())
    found = _VOXEL.findall(text)
    if min(size) < 1 or len(found) != math.prod(size) or sum(len(a) + len(b) for a, b in found) != len(text):
        message = (
            f"{file}: line {element.line}: shape {number} of {' x '.join(map(str, size))} cells has {len(found)} of them; "
            "each must be #, + or _, perhaps with a colour"
        )
        raise InputError(message)
    filled = np.array([state == "#" for state, _ in found]).reshape(size[::-1]).transpose()
    return np.argwhere(filled)


def _left_out(root: Element, problems: int, chosen: _Stored, solution: int) -> list[str]:
    """What the file says besides."""
    notes = []
    others = [(problems - 1, "problem"), (len(chosen.assemblies) - 1, "solution")]
    more = " and ".join(f"{n} other {what}{'s' if n > 1 else ''}" for n, what in others if n)
    if more:
        named = f" ({chosen.name})" if chosen.name else ""
        notes.append(f"pieces lie as in problem {chosen.number + 1}{named}, solution {solution + 1}; {more} left out")
    unused = chosen.assemblies[solution].split().count(UNPLACED)
    if unused:
        notes.append(f"{unused} pieces that this solution does not use are left out")
    colours = _first(root, "colors")
    if colours is not None and colours.children:
        notes.append("colours are left out")
    if chosen.grouped:
        notes.append("groups of pieces that may stay together are left out")
    return notes


def _first(element: Element, tag: str) -> Element | None:
    return next((child for child in element.children if child.tag == tag), None)


def _number(file: str, element: Element, key: str) -> int:
    value = element.attributes.get(key, "0")
    if not re.fullmatch(r"-?[0-9]{1,9}", value):
        message = f'{file}: line {element.line}: {element.tag} has {key}="{value[:20]}"; it must be a whole number'
        raise InputError(message)
    return int(value)


def _drawing(file: str, pieces: Sequence[tuple[str, Ints]], notes: Sequence[str]) -> Drawing:
    """Parts of cells (k, 3)."""
    if not pieces:
        message = f"{file}: has no pieces; some cells must be filled"
        raise InputError(message)
    if len(pieces) > MOST_PIECES:
        message = f"{file}: has {len(pieces)} pieces; at most {MOST_PIECES} are read"
        raise InputError(message)
    count: dict[str, int] = {}
    parts, total = [], 0
    for name, cells in pieces:
        count[name] = count.get(name, 0) + 1
        own = name if count[name] == 1 else f"{name}_{count[name]}"
        if not len(cells):
            message = f'{file}: piece "{own}" has no cells; some must be filled'
            raise InputError(message)
        boxes = rods(cells)
        total += len(boxes)
        if total > MOST_RODS:
            message = f"{file}: pieces have more than {MOST_RODS} rows of cells; draw larger cells"
            raise InputError(message)
        count_of_lumps = lumps(cells)
        if count_of_lumps > 1:
            notes = [*notes, f'piece "{own}" has {count_of_lumps} lumps whose cells share no face; they move as one']
        parts.append(Part(own, solid=Boxes(CELL * boxes)))
    said = f"cells have no size; they are read as {CELL:g} mm, with a gap of {GAP:g} mm where none is asked for"
    return Drawing(tuple(parts), GAP, source=file, notes=tuple(f"{file}: {note}" for note in (said, *notes)))


def lumps(cells: Ints) -> int:
    """How many pieces of matter cells (k, 3) are that hang together by faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    number = {tuple(cell): k for k, cell in enumerate(cells.tolist())}
    pairs = [
        (k, number[beside])
        for (x, y, z), k in number.items()
        for beside in ((x + 1, y, z), (x, y + 1, z), (x, y, z + 1))
        if beside in number
    ]
    i, j = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return int(connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(len(cells),) * 2))[0])


def rods(cells: Ints) -> NDArray[np.float64]:
    """Boxes (k, 2, 3) of cells in a row along x."""
    order = cells[np.lexsort((cells[:, 0], cells[:, 1], cells[:, 2]))]
    begins = np.concatenate([[True], (np.diff(order, axis=0) != [1, 0, 0]).any(axis=1)])
    first = np.flatnonzero(begins)
    last = np.concatenate([first[1:], [len(order)]]) - 1
    return np.stack([order[first], order[last] + 1], axis=1).astype(float)
