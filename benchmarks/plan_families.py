"""Puzzles of known truth: nested latches, sliding trays, pinwheels, locks, frames of many parts; and a grid search that judges the trays.

Everything lies on a lattice of unit squares of `CELL` mm; the gap is drawn by the assembly.
"""

from __future__ import annotations

from collections import deque

import numpy as np
import shapely
from numpy.typing import NDArray

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Drawing, Part, Region

Cells = frozenset[tuple[int, int]]

CELL = 10.0
GAP = 0.6


def assembled(parts: dict[str, shapely.Geometry], fixed: str, gap: float = GAP, turn: float = 0.0) -> Assembly:
    """An assembly of polygons [mm], all turned by an angle [rad]."""
    made = []
    for name, shape in parts.items():
        turned = shapely.affinity.rotate(shape, turn, origin=(0, 0), use_radians=True)
        pieces = [turned] if turned.geom_type == "Polygon" else list(turned.geoms)
        regions = tuple(Region(_corners(p.exterior), tuple(_corners(r) for r in p.interiors)) for p in pieces)
        made.append(Part(name, regions, (0.0, 0.0, 0.0), fixed=name == fixed))
    return wr.assemble(Drawing(tuple(made)), gap=gap)


def _corners(ring: shapely.LinearRing) -> NDArray[np.float64]:
    return np.array(ring.normalize().simplify(1e-9).coords)[:-1]


def squares(cells: Cells) -> shapely.Geometry:
    """The union of unit squares [mm]."""
    return shapely.union_all([shapely.box(CELL * x, CELL * y, CELL * (x + 1), CELL * (y + 1)) for x, y in cells])


def latches(count: int, turn: float = 0.0, gap: float = GAP) -> Assembly:
    """A bolt behind a latch that is held by a latch, and so on: each can move aside only after the next has."""
    bolt = {(1, 1), (2, 1)}
    latch: list[set[tuple[int, int]]] = []
    room = {(x, 1) for x in range(1, 20 + count)}
    x, y = 3, 1
    for k in range(count):
        if k % 2 == 0:  # upright, goes up by one
            latch.append({(x, y), (x, y + 1)})
            room |= {(x, y), (x, y + 1), (x, y + 2)}
            y += 2
        else:  # lying, goes right by one
            latch.append({(x, y), (x + 1, y)})
            room |= {(x, y), (x + 1, y), (x + 2, y)}
            x += 2
    wide, high = max(a for a, b in room if b > 1) + 2, max(b for _, b in room) + 2
    room = {(a, b) for a, b in room if b > 1 or a < wide}
    frame = {(a, b) for a in range(wide) for b in range(high)} - room
    parts = {"frame": squares(frozenset(frame)), "bolt": squares(frozenset(bolt))}
    parts |= {f"latch{k + 1}": squares(frozenset(cells)) for k, cells in enumerate(latch)}
    return assembled(parts, "frame", gap, turn)


SHAPES = [
    {(0, 0)}, {(0, 0), (1, 0)}, {(0, 0), (0, 1)}, {(0, 0), (1, 0), (0, 1)}, {(0, 0), (1, 0), (1, 1)},
    {(0, 0), (1, 0), (0, 1), (1, 1)},
]  # fmt: skip


def random_tray(seed: int, side: int = 4, free: int = 3) -> tuple[dict[str, Cells], Cells]:
    """Pieces of a tray of `side` x `side` squares with an opening one or two squares wide, and the cells of its wall."""
    random = np.random.default_rng(seed)
    empty = {(x, y) for x in range(side) for y in range(side)}
    pieces: dict[str, Cells] = {}
    tries = 0
    while len(empty) > free and tries < 200:
        tries += 1
        shape = SHAPES[random.integers(len(SHAPES))]
        x, y = random.integers(0, side, 2)
        cells = frozenset((x + a, y + b) for a, b in shape)
        if cells <= empty and len(empty) - len(cells) >= free - 1:
            pieces[f"p{len(pieces) + 1}"] = cells
            empty -= cells
    begin, wide = int(random.integers(0, side)), int(random.integers(1, 3))
    opening = {(side, y) for y in range(begin, min(side, begin + wide))}
    wall = {(x, y) for x in range(-1, side + 1) for y in range(-1, side + 1)}
    wall -= {(x, y) for x in range(side) for y in range(side)} | opening
    return pieces, frozenset(wall)


def tray(pieces: dict[str, Cells], wall: Cells, gap: float = GAP, turn: float = 0.0) -> Assembly:
    """The assembly of a tray."""
    return assembled(
        {"tray": squares(wall), **{name: squares(cells) for name, cells in pieces.items()}}, "tray", gap, turn
    )


def grid_search(pieces: dict[str, Cells], wall: Cells, most: int = 400_000) -> tuple[set[str], bool]:
    """All pieces that leave a tray by unit moves of one piece or of what it pushes, by exhaustive search; and whether it was exhaustive.

    A piece is the set of bits of its cells, in a grid that is six cells wider than the wall on every side: what gets to its rim has left
    and is taken away. States that hold the same sets of bits are one, whichever of two equal pieces lies where.
    """
    xs, ys = [x for x, _ in wall], [y for _, y in wall]
    left, low, wide, high = min(xs) - 6, min(ys) - 6, max(xs) - min(xs) + 13, max(ys) - min(ys) + 13

    def bits(cells: Cells | set[tuple[int, int]]) -> int:
        return sum(1 << int((y - low) * wide + x - left) for x, y in cells)

    rim = bits(
        {(left + x, low + y) for x in range(wide) for y in range(high) if x in (0, wide - 1) or y in (0, high - 1)}
    )
    names, state, solid = list(pieces), tuple(bits(c) for c in pieces.values()), bits(wall)
    gone: set[str] = set()
    exhausted = True
    while names:
        out, state, whole = _first_to_leave(state, solid, rim, wide, most)
        exhausted = exhausted and whole
        if not out:
            break
        gone |= {names[k] for k in out}
        names = [n for k, n in enumerate(names) if k not in out]
        state = tuple(c for k, c in enumerate(state) if k not in out)
    return gone, exhausted


def _first_to_leave(
    state: tuple[int, ...], solid: int, rim: int, wide: int, most: int
) -> tuple[set[int], tuple[int, ...], bool]:
    """Which pieces get to the rim first, where all are then, and whether all states were visited if none does."""
    seen, waiting = {tuple(sorted(state))}, deque([state])
    while waiting:
        if len(seen) > most:
            return set(), state, False
        here = waiting.popleft()
        for step in (1, -1, wide, -wide):
            moved = [c << step if step > 0 else c >> -step for c in here]
            for k in range(len(here)):
                moving, swept = {k}, moved[k]
                while True:
                    met = {m for m, c in enumerate(here) if m not in moving and c & swept}
                    if not met or swept & solid:
                        break
                    moving |= met
                    for m in met:
                        swept |= moved[m]
                if swept & solid:
                    continue
                after = tuple(moved[m] if m in moving else c for m, c in enumerate(here))
                out = {m for m in moving if moved[m] & rim}
                if out:
                    return out, after, True
                named = tuple(sorted(after))
                if named not in seen:
                    seen.add(named)
                    waiting.append(after)
    return set(), state, True


def tray_of_squares(wide: int, high: int, holes: int) -> tuple[dict[str, Cells], Cells]:
    """A tray full of single squares but for some holes in its lower right corner, with an opening at the lower left."""
    cells = [(x, y) for y in range(high) for x in range(wide)]
    empty = {(wide - 1 - k % wide, k // wide) for k in range(holes)}
    pieces = {f"p{k + 1}": frozenset([c]) for k, c in enumerate(c for c in cells if c not in empty)}
    wall = {(x, y) for x in range(-1, wide + 1) for y in range(-1, high + 1)} - set(cells) - {(wide, high - 1)}
    return pieces, frozenset(wall)


def pinwheel(count: int, gap: float = 0.3, tilt: float = 0.0) -> Assembly:
    """Sectors of a disc with a tongue across each border, `tilt` [rad] off its normal: where all spread at once every tongue comes out.

    An odd number leaves only all together; an even one in halves too. The first is fixed.
    """
    step = 2 * np.pi / count
    arc = np.linspace(0, step, 13)
    sector = shapely.Polygon([(0, 0), *(40 * np.column_stack([np.cos(arc), np.sin(arc)]))])
    tongue = shapely.affinity.rotate(shapely.box(18, -3, 26, 6), tilt, origin=(22, 0), use_radians=True)
    sectors = [shapely.affinity.rotate(sector, k * step, origin=(0, 0), use_radians=True) for k in range(count)]
    tongues = [shapely.affinity.rotate(tongue, k * step, origin=(0, 0), use_radians=True) for k in range(count)]
    parts = {}
    for k in range(count):  # its lower border's tongue is the neighbour's, its upper border's its own
        own = tongues[(k + 1) % count]
        parts[f"w{k + 1}"] = shapely.set_precision((sectors[k] | own) - tongues[k], 1e-6)
    return assembled(parts, "w1", gap)


def tumbler_lock(count: int = 3, turn: float = 0.0, gap: float = GAP) -> Assembly:
    """A bolt that slides out once all tumblers, each held down by its own slide, were lifted out of its notches."""
    wide = 4 * count + 3
    room = {(x, 1) for x in range(1, wide)}
    bolt = {(x, 1) for x in range(1, wide - 1)}
    parts: dict[str, set[tuple[int, int]]] = {}
    for k in range(count):
        x = 2 + 4 * k
        tumbler = {(x, 1), (x, 2), (x, 3)}
        bolt -= {(x, 1)}
        room |= {(x, 2), (x, 3), (x, 4), (x + 1, 4), (x + 2, 4)}
        parts[f"tumbler{k + 1}"] = tumbler
        parts[f"slide{k + 1}"] = {(x, 4), (x + 1, 4)}
    bolt |= {(x, 0) for x in range(1, wide - 1)}
    room |= {(x, 0) for x in range(1, wide)}
    frame = {(x, y) for x in range(wide) for y in range(-1, 6)} - room
    shapes = {"frame": squares(frozenset(frame)), "bolt": squares(frozenset(bolt))}
    return assembled(shapes | {n: squares(frozenset(c)) for n, c in parts.items()}, "frame", gap, turn)


def turning_room(turn: float = 0.0, gap: float = GAP) -> Assembly:
    """A bar of three squares that fits through its door upright only, and the door is shut by a bolt that slides aside."""
    room = {(x, y) for x in range(1, 6) for y in range(1, 6)}
    door = {(5, 6), (5, 7), (5, 8)}
    pocket = {(6, 7), (7, 7)}
    frame = {(x, y) for x in range(9) for y in range(9)} - room - door - pocket
    parts = {"frame": frame, "bar": {(1, 2), (2, 2), (3, 2)}, "bolt": {(5, 7), (6, 7)}}
    return assembled({n: squares(frozenset(c)) for n, c in parts.items()}, "frame", gap, turn)


def frame_puzzle(rows: int = 4, columns: int = 5, gap: float = GAP) -> Assembly:
    """A frame open to the right, full of rows of T-shaped blocks that hold each other sideways: 20 parts and the frame."""
    wide, high = 3 * columns, 3 * rows
    parts: dict[str, set[tuple[int, int]]] = {}
    for r in range(rows):
        for c in range(columns):
            cells = {(3 * c + i, 3 * r + j) for i in range(3) for j in range(3)}
            parts[f"b{r + 1}{c + 1}"] = cells
    for r in range(rows - 1):  # a tongue of each row in a groove of the next
        for c in range(columns):
            tongue = {(3 * c + i, 3 * r + 3) for i in range(3)} if (r + c) % 2 == 0 else set()
            parts[f"b{r + 1}{c + 1}"] |= tongue
            parts[f"b{r + 2}{c + 1}"] -= tongue
    frame = {(x, y) for x in range(-1, wide) for y in range(-1, high + 1)}
    frame -= {(x, y) for x in range(wide) for y in range(high)}
    frame |= {(wide, 0), (wide, -1)}  # a lip in front of the lowest row
    shapes = {n: squares(frozenset(c)) for n, c in parts.items()}
    return assembled({"frame": squares(frozenset(frame)), **shapes}, "frame", gap)
