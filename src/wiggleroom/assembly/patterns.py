"""Assemblies of equal blocks, and a jigsaw of different ones, for examples, tests and comparisons.

Blocks are squares of side `pitch` [mm] with a joint on each side; a block's reference point is its centre. Names count
columns and rows from 1: "b3-1" is the third block of the bottom row. The first block is fixed, the last one is pulled
in +y.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.joints import Jigsaw, joint
from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Drawing, Part, Points, Pull, Region
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
    region = block(_profile(joint, sizes), "-o-t", pitch)
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
    """`nx` by `ny` pieces, no two knobs alike: side, place, size and slenderness are drawn by lot.

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
        (i, j): _outline((floors[i][j], facing(walls[i + 1][j]), facing(floors[i][j + 1]), walls[i][j]), pitch)
        for j in range(ny)
        for i in range(nx)
    }
    return _assembly(pieces, _name, gap, pitch)


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
    lines = {"t": profile, "o": facing(profile), "-": profile[[0, -1]]}
    return _outline(tuple(lines[side] for side in sides), pitch)


def facing(profile: Points) -> Points:
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
    region = block(_profile(family, sizes), "toot", pitch)
    return _assembly(dict.fromkeys(places, region), _name, gap, pitch)


def _assembly(regions: dict[Place, Region], name: Callable[[int, int], str], gap: float, pitch: float) -> Assembly:
    """Blocks at their places, the first fixed, the last pulled up."""
    shared = {id(region): (region,) for region in regions.values()}
    parts = tuple(
        Part(name(i, j), shared[id(region)], at=(i * pitch, j * pitch, 0.0), fixed=k == 0)
        for k, ((i, j), region) in enumerate(regions.items())
    )
    return assemble(Drawing(parts, gap=gap, goals=(Pull(parts[-1].name, (0.0, 1.0)),)))


def _name(i: int, j: int) -> str:
    return f"b{i + 1}-{j + 1}"


def _profile(family: str, sizes: dict[str, float]) -> Points:
    return joint(family, **sizes).profile()


def _at_least(least: int, **counts: int) -> None:
    """Refuse patterns of too few blocks."""
    wrong = [f"{name} is {n}: it must be at least {least}" for name, n in counts.items() if n < least]
    if wrong:
        raise InputError(wrong)
