"""Assemblies of equal blocks, a jigsaw of different ones, pictures made of blocks and burrs, for examples, tests and comparisons.

Blocks are squares of side `pitch` [mm] with a joint on each side; a block's reference point is its centre. Names count
columns and rows from 1: "b3-1" is the third block of the bottom row. The first block is fixed, the last one is pulled
in +y.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly import joints
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.burr import burr as burr
from wiggleroom.assembly.joints import Jigsaw
from wiggleroom.drawing.model import Drawing, Goal, Part, Points, Pull, Region
from wiggleroom.errors import InputError

QUARTER_TURNS = np.array([[[1, 0], [0, 1]], [[0, 1], [-1, 0]], [[-1, 0], [0, -1]], [[0, -1], [1, 0]]], dtype=float)
"""Row vectors times these turn by 0, 90, 180 and 270 degrees, exactly."""

Place = tuple[int, int]


def chain(n: int, joint: str = "tee", gap: float = 0.01, pitch: float = 1.0, **sizes: float) -> Assembly:
    """`n` blocks in a row: tab on the left side, pocket on the right, plain top and bottom.

    Parameters
    ----------
    n : int
        Number of blocks, the fixed one included.
    joint : str
        Family, see `wiggleroom.assembly.joints.JOINTS`.
    gap, pitch : float [mm]
        Clearance across every joint; side of a block.
    **sizes : float
        Sizes of the joint as fractions of the pitch.

    Raises
    ------
    InputError
        If there is no such joint or size, or the blocks cannot be made so.

    Examples
    --------
    >>> chain(3).names
    ('b1', 'b2', 'b3')
    """
    _at_least(2, n=n)
    region = block(joints.joint(joint, **sizes).profile(), "-o-t", pitch)
    return _assembly({(i, 0): region for i in range(n)}, lambda i, _: f"b{i + 1}", gap, pitch)


def grid(nx: int, ny: int, joint: str = "tee", gap: float = 0.01, pitch: float = 1.0, **sizes: float) -> Assembly:
    """`nx` by `ny` blocks: tab at the bottom and the left side, pocket at the top and the right, also at the border.

    Parameters, errors: see `chain`.

    Examples
    --------
    >>> grid(2, 2).names
    ('b1-1', 'b2-1', 'b1-2', 'b2-2')
    """
    _at_least(1, nx=nx, ny=ny)
    _at_least(2, blocks=nx * ny)
    return _blocks(((i, j) for j in range(ny) for i in range(nx)), joint, gap, pitch, sizes)


def frame(nx: int, ny: int, joint: str = "tee", gap: float = 0.01, pitch: float = 1.0, **sizes: float) -> Assembly:
    """Only the border of a grid of `nx` by `ny` blocks: a closed ring, 56 blocks for 15 by 15.

    Parameters, errors: see `chain`.

    Examples
    --------
    >>> len(frame(15, 15).parts)
    56
    """
    _at_least(2, nx=nx, ny=ny)
    ring = ((i, j) for j in range(ny) for i in range(nx) if i in (0, nx - 1) or j in (0, ny - 1))
    return _blocks(ring, joint, gap, pitch, sizes)


def jigsaw(nx: int, ny: int, gap: float = 0.01, pitch: float = 1.0, seed: int = 0) -> Assembly:
    """`nx` by `ny` pieces, no two knobs alike: side, place, size and slenderness are drawn at random.

    Parameters
    ----------
    nx, ny : int
        Columns and rows.
    gap, pitch : float [mm]
    seed : int
        Same seed, same puzzle.

    Examples
    --------
    >>> [len(p.regions[0].outer) for p in jigsaw(2, 1).parts]
    [29, 29]
    """
    _at_least(1, nx=nx, ny=ny)
    _at_least(2, pieces=nx * ny)
    random = np.random.default_rng(seed)
    plain = np.array([(-0.5, 0.0), (0.5, 0.0)])
    floors = [[_knob(random) if 0 < j < ny else plain for j in range(ny + 1)] for _ in range(nx)]
    walls = [[_knob(random) if 0 < i < nx else plain for _ in range(ny)] for i in range(nx + 1)]
    pieces = {
        (i, j): _outline(
            (floors[i][j], mating_profile(walls[i + 1][j]), mating_profile(floors[i][j + 1]), walls[i][j]), pitch
        )
        for j in range(ny)
        for i in range(nx)
    }
    return _assembly(pieces, _name, gap, pitch)


def image(
    dark: NDArray[np.bool_],
    joint: str = "tee",
    gap: float = 0.01,
    pitch: float = 1.0,
    islands: str = "largest",
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    **sizes: float,
) -> Assembly:
    """A block for every dark cell of a picture, joined to its neighbours on four sides, plain where it has none.

    Holes stay open. Blocks are named by column and row of the whole picture, from the bottom left.

    Parameters
    ----------
    dark : (rows, columns) bool
        The first row is the top one, as from `wiggleroom.drawing.read_bitmap`.
    joint, gap, pitch, **sizes
        See `chain`.
    islands : str
        "largest": only the largest set of blocks that hang together by their sides; the drawing's notes say what is
        left out. "all": every block; the first block of each island is fixed.
    fix : sequence of names
        Blocks that stand; by default the first one, leftmost in the bottom row.
    goals : sequence of Pull, Turn or W
        By default the last block that is free, rightmost in the top row, is pulled in +y.

    Raises
    ------
    InputError
        If fewer than two blocks are left, a name is unknown, or the joints cannot be made so.

    Examples
    --------
    >>> ring = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], dtype=bool)
    >>> made = image(ring)
    >>> len(made.parts), made.names[3]
    (8, 'b1-2')
    """
    from scipy import ndimage

    if islands not in ("largest", "all"):
        message = f'islands is "{islands}": it must be largest or all'
        raise InputError(message)
    cells = np.asarray(dark, dtype=bool)
    if cells.ndim != 2:
        message = f"dark has {cells.ndim} dimensions: it must be rows and columns"
        raise InputError(message)
    cells = cells[::-1]
    label, count = ndimage.label(cells)
    notes = []
    if count > 1 and islands == "largest":
        kept = 1 + int(np.bincount(label[cells])[1:].argmax())
        lost = int((cells & (label != kept)).sum())
        notes.append(f"left out: {_many(lost, 'block')} in {_many(count - 1, 'island')} not joined to the largest one")
        cells = label == kept
    if cells.sum() < 2:
        message = f"{_many(int(cells.sum()), 'dark cell')} of the picture hang together: at least 2 are needed"
        raise InputError(message)
    padded = np.pad(cells, 1)
    beside = [padded[:-2, 1:-1], padded[1:-1, 2:], padded[2:, 1:-1], padded[1:-1, :-2]]  # bottom, right, top, left
    kinds: dict[tuple[bool, ...], Region] = {}
    regions: dict[Place, Region] = {}
    profile = joints.joint(joint, **sizes).profile()
    for j, i in np.argwhere(cells).tolist():
        sides = tuple(bool(side[j, i]) for side in beside)
        if sides not in kinds:
            letters = "".join(letter if has else "-" for letter, has in zip("toot", sides, strict=True))
            kinds[sides] = block(profile, letters, pitch)
        regions[i, j] = kinds[sides]
    first = {int(label[j, i]): _name(i, j) for i, j in reversed(regions)}  # of each island
    fixed = set(fix) or set(first.values())
    last = next((name for i, j in reversed(regions) if (name := _name(i, j)) not in fixed), "")
    if not last:
        message = "every block is fixed; at least one must be free to move"
        raise InputError(message)
    return _assembly(regions, _name, gap, pitch, fixed, goals or (Pull(last, (0.0, 1.0)),), notes)


def block(profile: Points, sides: str, pitch: float) -> Region:
    """Square block with a joint on its bottom, right, top and left side.

    Parameters
    ----------
    profile : (n, 2) float64
        Line of a joint of pitch 1, see `wiggleroom.assembly.joints`.
    sides : str
        A letter a side: t tab, o pocket, - plain.
    pitch : float [mm]

    Examples
    --------
    >>> from wiggleroom.assembly.joints import Tee
    >>> len(block(Tee().profile(), "toot", 1.0).outer)
    36
    """
    lines = {"t": profile, "o": mating_profile(profile), "-": profile[[0, -1]]}
    return _outline(tuple(lines[side] for side in sides), pitch)


def mating_profile(profile: Points) -> Points:
    """Return the line of a joint as the block on its other side draws it."""
    return -profile[::-1]


def _outline(sides: tuple[Points, ...], pitch: float) -> Region:
    """Block of four lines: bottom, right, top, left."""
    turned = [(line[:-1] - (0.0, 0.5)) @ turn for line, turn in zip(sides, QUARTER_TURNS, strict=True)]
    return Region(np.vstack(turned) * pitch)


def _knob(random: np.random.Generator) -> Points:
    """Line of one knob: tab or pocket, within bounds that keep the knobs of a piece apart."""
    radius, slender, fillet = random.uniform((0.085, 1.2, 0.04), (0.115, 1.4, 0.06))
    line = Jigsaw(radius, radius * slender, fillet, shift=random.uniform(-0.1, 0.1)).profile()
    return line * (1.0, random.choice((-1.0, 1.0)))


def _blocks(places: Iterable[Place], family: str, gap: float, pitch: float, sizes: dict[str, float]) -> Assembly:
    region = block(joints.joint(family, **sizes).profile(), "toot", pitch)
    return _assembly(dict.fromkeys(places, region), _name, gap, pitch)


def _assembly(
    regions: dict[Place, Region],
    name: Callable[[int, int], str],
    gap: float,
    pitch: float,
    fixed: Iterable[str] = (),
    goals: Sequence[Goal] = (),
    notes: Sequence[str] = (),
) -> Assembly:
    """Blocks at their places; by default the first is fixed, the last pulled up."""
    shared = {id(region): (region,) for region in regions.values()}
    parts = tuple(
        Part(name(i, j), shared[id(region)], at=(i * pitch, j * pitch, 0.0)) for (i, j), region in regions.items()
    )
    goals = tuple(goals) or (Pull(parts[-1].name, (0.0, 1.0)),)
    return assemble(Drawing(parts, gap=gap, goals=goals, notes=tuple(notes)), fix=tuple(fixed) or (parts[0].name,))


def _many(n: int, thing: str) -> str:
    """Count with a word.

    >>> _many(1, "block"), _many(3, "island")
    ('1 block', '3 islands')
    """
    return f"{n} {thing}" if n == 1 else f"{n} {thing}s"


def _name(i: int, j: int) -> str:
    return f"b{i + 1}-{j + 1}"


def _at_least(least: int, **counts: int) -> None:
    """Refuse patterns of too few blocks."""
    wrong = [f"{name} is {n}: it must be at least {least}" for name, n in counts.items() if n < least]
    if wrong:
        raise InputError(wrong)
