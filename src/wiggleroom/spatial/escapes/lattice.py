"""The lattice on which the parts of an assembly lie, turned anywhere: recognised in their faces, as they are made.

Faces that look up lie a little below the planes of a lattice, those that look down a little above, by up to the clearance. Then every part
lies in the cells that it fills, and every motion that is free for these is free for the parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import placed_surface
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.solids.orthogonal import filled, orthogonal_faces

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ROUNDING = 1e-4
"""Faces nearer to a plane of the lattice than this share of the assembly's size lie in it."""
LOOSEST = 0.2
"""Faces lie at most this share of a step inside their cells."""
MAX_STEPS = 200
"""A lattice has at most so many steps along an axis."""
MAX_CELLS = 50_000_000
"""Most cells of all bodies together, and entries of all tables of blocked offsets."""
MAX_BODIES = 100
"""Assemblies of more bodies are not searched by whole steps."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """Bodies as cells of a lattice.

    Parameters
    ----------
    frame : (3, 3) float64
        Its axes, as columns.
    step : (3,) float64 [mm]
    clearance : float [mm]
        Two parts that fill neighbouring cells are at most so far apart.
    blocked : (k,) uint8
        For every two bodies a table (x, y, z) of the offsets of j from i, both counted from rest. Bit 0: they overlap. Bits 1 and 2:
        they do at this or a smaller, at this or a larger offset along x; 3 to 6 so along y and z. Outside the table they do not.
    first : (n, n) int64
        Where the table of two bodies begins.
    shape, low : (n, n, 3) int64
        Its shape, and the offset of its first entry.
    stands : (n, 3) bool
        Which bodies may not move along an axis.
    """

    frame: Floats
    step: Floats
    clearance: float
    blocked: NDArray[np.uint8]
    first: Ints
    shape: Ints
    low: Ints
    stands: Bools


def lattice(ready: SpatialPrepared) -> Lattice | None:
    """The lattice of an assembly.

    None where faces are not all along three axes at right angles, or on no lattice, where cells are shared, and where there are too many.
    """
    assembly, grouping = ready.assembly, ready.grouping
    count = len(grouping.bodies.at)
    if assembly.drawing.ignore or count > MAX_BODIES:
        return None
    placed = [placed_surface(part, made.surface) for part, made in zip(assembly.parts, assembly.solids, strict=True)]
    triangles = [surface.vertices[surface.faces] for surface in placed]
    owner = np.repeat(np.arange(len(triangles)), [len(t) for t in triangles])
    near = ROUNDING * ready.size
    faces = orthogonal_faces(np.concatenate(triangles), near)
    if faces is None:
        return None
    apart = assembly.widest_gap > near
    fits = [fitted_steps(faces.levels(axis, False), faces.levels(axis, True), near, apart) for axis in range(3)]
    if any(fit is None for fit in fits):
        return None
    step, origin, inset = np.array(fits, dtype=float).T
    whole = np.round((faces.corners.reshape(-1, 3) - origin) / step)
    low, high = whole.min(axis=0), whole.max(axis=0)
    if np.prod(high - low) * count > MAX_CELLS:
        return None
    x, y, z = (origin[k] + step[k] * np.arange(low[k], high[k] + 1) for k in range(3))
    solid: list[Bools] = [np.zeros((len(x) - 1, len(y) - 1, len(z) - 1), dtype=bool) for _ in range(count)]
    for part, body in enumerate(grouping.body_of.tolist()):
        cells = filled(faces, owner == part, (x, y, z))
        if cells is None or not cells.any():
            return None
        solid[body] |= cells
    if np.sum(solid, axis=0).max() > 1:
        return None
    tables = _tables(solid)
    if tables is None:
        return None
    locked = ~grouping.bodies.free[:, :3]
    stands: Bools = np.asarray((locked[:, :, None] & (np.abs(faces.frame) > ROUNDING)[None]).any(axis=1))
    return Lattice(faces.frame, step, 2 * float(inset.max()), *tables, stands)


def fitted_steps(lower: Floats, upper: Floats, near: float, apart: bool = False) -> tuple[float, float, float] | None:
    """Step and origin of the coarsest lattice along one axis, and how far faces lie inside its cells at most [mm].

    None where there is none. Faces all as far inside are preferred: then they tell step and clearance apart. Where parts are `apart`,
    lattices in whose planes all faces lie come last: parts would scrape along each other.

    Parameters
    ----------
    lower, upper : (k,) float64 [mm]
        Where faces lie that look down, and up.
    near : float [mm]
        Errors of these.
    apart : bool
        Whether parts have a gap.

    Examples
    --------
    >>> step, origin, inset = fitted_steps(np.array([0.1, 2.1, 6.1]), np.array([1.9, 3.9, 7.9]), 1e-6)
    >>> round(step, 6), round(abs(origin), 6), round(inset, 6)
    (2.0, 0.0, 0.1)
    """
    lower, upper = _distinct(lower, near), _distinct(upper, near)
    spread = max(np.ptp(lower), np.ptp(upper))
    if spread <= near:
        return float(upper[0] - lower[0]), float(lower[0]), 0.0
    touching = None
    for alike in (True, False):
        for count in range(1, MAX_STEPS + 1):
            step, origin, inset = _fit(lower, upper, spread / count)
            least, most = inset.min(), inset.max()
            if least >= -near and most <= LOOSEST * step + near and (not alike or most - least <= 2 * near):
                found = step, origin, max(float(most), 0.0)
                if not apart or most > near:
                    return found
                touching = touching or found
    return touching


def _distinct(levels: Floats, near: float) -> Floats:
    levels = np.sort(levels)
    groups = np.split(levels, np.flatnonzero(np.diff(levels) > near) + 1)
    return np.array([group.mean() for group in groups])


def _fit(lower: Floats, upper: Floats, step: float) -> tuple[float, float, Floats]:
    """Step and origin by least squares from a first guess of the step, and how far all faces are inside their cells."""
    down, up = (float(np.angle(np.exp(2j * np.pi * x / step).mean())) * step / (2 * np.pi) for x in (lower, upper))
    apart = (down - up) % step
    apart -= step if apart > 0.75 * step else 0.0
    levels = np.concatenate([lower, upper])
    sign = np.repeat([1.0, -1.0], [len(lower), len(upper)])
    whole = np.round((levels - up - apart / 2) / step)
    rows = np.column_stack([whole, np.ones_like(whole), sign])
    found = np.linalg.lstsq(rows, levels, rcond=None)[0]
    return float(found[0]), float(found[1]), sign * (levels - whole * found[0] - found[1])


def _tables(solid: list[Bools]) -> tuple[NDArray[np.uint8], Ints, Ints, Ints] | None:
    """Tables of blocked offsets for every two bodies, where they begin, their shapes and their first offsets; None where too large."""
    count = len(solid)
    lows = [np.argwhere(cells).min(axis=0) for cells in solid]
    cut = []
    for cells, low in zip(solid, lows, strict=True):
        high = np.argwhere(cells).max(axis=0) + 1
        cut.append(cells[tuple(map(slice, low, high))])
    shape = np.zeros((count, count, 3), dtype=np.int64)
    low = np.zeros((count, count, 3), dtype=np.int64)
    for i in range(count):
        for j in range(count):
            if i != j:
                # entry k of the convolution: cells of j moved by d meet cells of i, d = k - (shape of j - 1) - (low j - low i)
                shape[i, j] = np.array(cut[i].shape) + cut[j].shape - 1
                low[i, j] = lows[i] - lows[j] - np.array(cut[j].shape) + 1
    length = shape.prod(axis=2)
    if length.sum() > MAX_CELLS:
        return None
    first = (np.cumsum(length.ravel()) - length.ravel()).reshape(count, count)
    blocked = np.zeros(int(length.sum()), dtype=np.uint8)
    for i in range(count):
        for j in range(i):
            common = _convolved(cut[i], cut[j][::-1, ::-1, ::-1]) > 0.5
            for a, b, table in ((i, j, common), (j, i, common[::-1, ::-1, ::-1])):
                bits = table.astype(np.uint8)
                for axis in range(3):
                    bits |= np.logical_or.accumulate(table, axis=axis).astype(np.uint8) << (1 + 2 * axis)
                    back = np.flip(np.logical_or.accumulate(np.flip(table, axis), axis=axis), axis)
                    bits |= back.astype(np.uint8) << (2 + 2 * axis)
                blocked[first[a, b] : first[a, b] + length[a, b]] = bits.ravel()
    return blocked, first, shape, low


def _convolved(one: Bools, other: Bools) -> Floats:
    """Convolution of two blocks of cells, by Fourier transforms."""
    shape = [m + n - 1 for m, n in zip(one.shape, other.shape, strict=True)]
    axes = (0, 1, 2)
    return np.fft.irfftn(np.fft.rfftn(one, shape, axes) * np.fft.rfftn(other, shape, axes), shape, axes)
