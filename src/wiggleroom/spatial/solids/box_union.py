"""Unions of axis-aligned boxes: what is left when every face moves inward, and overlapping boxes that cover it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

ROUNDING = 1e-9
"""Coordinates nearer than this share of the size are the same."""


@dataclass(frozen=True, eq=False)
class BoxGrid:
    """Cells of an uneven grid: coordinates `lines` of each axis [mm], and which cells are `solid`."""

    lines: tuple[Floats, Floats, Floats]
    solid: Bools

    @property
    def volume(self) -> float:
        """Volume [mm3]."""
        x, y, z = (np.diff(line) for line in self.lines)
        return float(np.einsum("ijk,i,j,k->", self.solid.astype(float), x, y, z))

    @property
    def centroid(self) -> Floats:
        """Centroid (3,) [mm]."""
        sides = [np.diff(line) for line in self.lines]
        middles = [(line[1:] + line[:-1]) / 2 for line in self.lines]
        weight = self.solid * sides[0][:, None, None] * sides[1][None, :, None] * sides[2][None, None, :]
        total = weight.sum()
        return np.array([(weight.sum(axis=tuple({0, 1, 2} - {k})) @ middles[k]) / total for k in range(3)])

    @property
    def lumps(self) -> int:
        """Number of pieces that hang together through faces."""
        from scipy.ndimage import label

        return int(label(self.solid)[1])


def union_of_boxes(boxes: Floats, inward: float = 0.0) -> BoxGrid:
    """Union of boxes (k, 2, 3) [mm] with every face moved inward, or outward where that is negative.

    Moving the faces of a union of axis-aligned boxes inward, mitred, takes away what lies within a cube of that half side from outside;
    moving them outward adds what lies within such a cube from inside.

    >>> union_of_boxes(np.array([[[0.0, 0.0, 0.0], [4.0, 2.0, 2.0]]]), 0.5).volume
    3.0
    """
    if inward < 0:
        return union_of_boxes(boxes + np.array([inward, -inward])[:, None])
    size = float(np.ptp(boxes.reshape(-1, 3), axis=0).max())
    fine = [_distinct(boxes[:, :, k].ravel(), ROUNDING * size) for k in range(3)]
    solid = _filled(boxes, fine)
    if inward == 0.0:
        return BoxGrid((fine[0], fine[1], fine[2]), solid)
    lines = [_distinct(np.concatenate([f - inward, f + inward]), ROUNDING * size) for f in fine]
    count = np.pad(solid.astype(np.int64), 1).cumsum(0).cumsum(1).cumsum(2)
    count = np.pad(count, ((1, 0), (1, 0), (1, 0)))
    low, high = [], []
    for f, line in zip(fine, lines, strict=True):
        middle = (line[1:] + line[:-1]) / 2
        low.append(np.searchsorted(f, middle - inward + ROUNDING * size, side="right"))
        high.append(np.searchsorted(f, middle + inward - ROUNDING * size, side="left") + 1)
    total = np.zeros([len(m) for m in low], dtype=np.int64)
    for pick in np.ndindex(2, 2, 2):
        corner = [high[k] if pick[k] else low[k] for k in range(3)]
        total += (-1) ** (3 - sum(pick)) * count[np.ix_(*corner)]
    wanted = np.ones_like(total)
    for k in range(3):
        wanted = wanted * (high[k] - low[k]).reshape([-1 if j == k else 1 for j in range(3)])
    return BoxGrid((lines[0], lines[1], lines[2]), total == wanted)


def _filled(boxes: Floats, lines: list[Floats]) -> Bools:
    solid = np.zeros([len(line) - 1 for line in lines], dtype=bool)
    for low, high in boxes:
        cells = []
        for k in range(3):
            middle = (lines[k][1:] + lines[k][:-1]) / 2
            cells.append(slice(*np.searchsorted(middle, [low[k], high[k]])))
        solid[tuple(cells)] = True
    return solid


def _distinct(values: Floats, tolerance: float) -> Floats:
    values = np.sort(values)
    return values[np.concatenate([[True], np.diff(values) > tolerance])]


def covering_boxes(grid: BoxGrid) -> Floats:
    """Boxes (k, 2, 3) [mm] that overlap each other and together are the solid; each as large as it can grow."""
    solid, open_ = grid.solid, grid.solid.copy()
    found = []
    while open_.any():
        seed = np.argwhere(open_)[0]
        best: tuple[int, Floats, Floats] | None = None
        for order in permutations(range(3)):
            low, high = seed.copy(), seed + 1
            for axis in order:
                _grow(solid, low, high, axis)
            gained = int(open_[tuple(map(slice, low, high))].sum())
            if best is None or gained > best[0]:
                best = gained, low, high
        _, low, high = best  # type: ignore[misc]
        open_[tuple(map(slice, low, high))] = False
        found.append([[grid.lines[k][e[k]] for k in range(3)] for e in (low, high)])
    return np.array(found).reshape(-1, 2, 3)


def _grow(solid: Bools, low: NDArray[np.int64], high: NDArray[np.int64], axis: int) -> None:
    """Move both ends of a block of cells along an axis as far as all cells are solid."""
    across = [slice(lo, hi) for lo, hi in zip(low, high, strict=True)]
    across[axis] = slice(None)
    full: Bools = np.asarray(solid[tuple(across)].all(axis=tuple(k for k in range(3) if k != axis)))
    while low[axis] > 0 and full[low[axis] - 1]:
        low[axis] -= 1
    while high[axis] < len(full) and full[high[axis]]:
        high[axis] += 1
