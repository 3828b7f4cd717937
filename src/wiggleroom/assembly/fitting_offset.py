"""The largest offset of all outlines at which no two parts overlap as drawn, in the plane.

Parts only grow with the offset, so the smallest offset of all pairs is sought: where some pairs overlap, that of the deepest is found, and
the others are looked at again there, until none overlaps. Corners stay mitred, as those of a gap do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.loops import Loops, are_valid, placed_loops, polygons
from wiggleroom.assembly.mitre import offset_ring, resolved
from wiggleroom.assembly.overlaps import overlap_width
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.errors import Stop, go_on

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EXACT = 1e-10
"""The offset of a pair is enclosed to this share of the size of the assembly."""
ROUNDING = 1e-12
"""Overlaps no wider than this share of the size are rounding."""
BINDING = 1e-6
"""Pairs that overlap where outlines lie further out by this share of the size bind."""


@dataclass(frozen=True, eq=False)
class FittingOffset:
    """The offset, and the pairs that allow no more.

    Parameters
    ----------
    offset : float or None [mm]
        Positive outward; None where there is none.
    binding : (m, 2) int64
        Indices of parts.
    why : str
        Why there is no offset.
    beyond : (float, float) or None [mm]
        An offset next above, and how deep parts overlap at it.
    """

    offset: float | None
    binding: Ints
    why: str = ""
    beyond: tuple[float, float] | None = None


def fitting_offset(assembly: Assembly, stop: Stop | None = None) -> FittingOffset:
    """The largest offset of all outlines as made at which no two parts overlap that are neither glued nor ignored.

    Raises
    ------
    StoppedError
        If it was asked to stop.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> round(fitting_offset(wr.patterns.chain(2, joint="tee", gap=0.02)).offset, 9)
    0.01
    """
    outlines = _Outlines(assembly)
    size = assembly.size
    first = offset = outlines.overlap_free()
    if offset is None:
        return FittingOffset(None, np.zeros((0, 2), dtype=np.int64), "no two parts can meet")
    i, j = outlines.near(offset + BINDING * size)
    known = overlapping = outlines.overlapping(i, j, offset + BINDING * size)
    while len(overlapping := outlines.overlapping(i[overlapping], j[overlapping], offset, overlapping)):
        go_on(stop)
        k = overlapping[0]
        lower = outlines.offset_of_pair(int(i[k]), int(j[k]), offset)
        if lower is None:
            names = " and ".join(f'"{assembly.names[n]}"' for n in sorted({*outlines.owner[[i[k], j[k]]].tolist()}))
            return FittingOffset(None, outlines.parts_of(i[[k]], j[[k]]), f"parts {names} overlap at every offset")
        offset = lower
    bind = known if offset == first else outlines.overlapping(i[known], j[known], offset + BINDING * size, known)
    return FittingOffset(offset, outlines.parts_of(i[bind], j[bind]))


def largest_free(free: Callable[[float], bool | None], high: float, step: float, exact: float) -> float | None:
    """The largest offset below one at which two shapes overlap where they do not, enclosed to `exact`; None where there is none.

    Parameters
    ----------
    free : callable
        Whether they do not overlap at an offset; None where one of them cannot be made.
    high : float [mm]
        An offset at which they overlap.
    step : float [mm]
        How far below it the search begins.
    exact : float [mm]

    Examples
    --------
    >>> round(largest_free(lambda offset: None if offset < -3 else offset <= -2, 0.0, 0.25, 1e-9), 6)
    -2.0
    """
    low = high - step
    while (state := free(low)) is False:
        high, step = low, 2 * step
        low = high - step
    while state is None and high - low > exact:  # between there may be room all the same
        middle = (low + high) / 2
        there = free(middle)
        if there is False:
            high = middle
        else:
            low, state = middle, there
    if state is None:
        return None
    while high - low > exact:
        middle = (low + high) / 2
        low, high = (middle, high) if free(middle) else (low, middle)
    return low


class _Outlines:
    """Outlines of all regions where they lie, to be moved in and out.

    Parameters
    ----------
    assembly : Assembly
    """

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.loops, self.region, self.owner = placed_loops(assembly.parts)
        self.tolerance = ROUNDING * assembly.size
        self._first = np.searchsorted(self.region, np.arange(len(self.owner) + 1))
        self._rings = self.loops.rings()

    def moved(self, regions: Iterable[int], offset: float) -> NDArray[np.object_]:
        """Regions with their outlines further out [mm]."""
        chosen = list(regions)
        counts = [self._first[r + 1] - self._first[r] for r in chosen]
        rings = [ring for r in chosen for ring in self._rings[self._first[r] : self._first[r + 1]]]
        loops = Loops(np.concatenate(rings), np.array([len(ring) for ring in rings], dtype=np.int64))
        of = np.repeat(np.arange(len(chosen)), counts)
        if offset == 0:
            return polygons(loops, of)
        new, forward = offset_ring(loops, np.full(len(loops.points), -offset))
        made = polygons(new, of)
        fine = np.ones(len(chosen), dtype=bool)
        np.logical_and.at(fine, of, forward)
        fine &= are_valid(made)
        for k in np.flatnonzero(~fine).tolist():
            mine = Loops(loops.points[of[loops.owner] == k], loops.counts[of == k])
            made[k] = shapely.MultiPolygon(resolved(mine, np.full(len(mine.points), -offset)))
        return made

    def near(self, offset: float) -> tuple[Ints, Ints]:
        """Regions of different parts that are neither glued nor ignored, and that meet at an offset."""
        shapes = self.moved(range(len(self.owner)), offset)
        i, j = shapely.STRtree(shapes).query(shapes, predicate="intersects")
        return self._of_pairs(i, j)

    def _of_pairs(self, i: Ints, j: Ints) -> tuple[Ints, Ints]:
        keep = self.owner[i] < self.owner[j]
        i, j = i[keep], j[keep]
        drawing, names = self.assembly.drawing, self.assembly.names
        if drawing.glue or drawing.ignore:
            may = collidable(drawing.glue, drawing.ignore)
            both = zip(self.owner[i].tolist(), self.owner[j].tolist(), strict=True)
            keep = np.array([may(names[a], names[b]) for a, b in both], dtype=bool)
            i, j = i[keep], j[keep]
        return i, j

    def overlap_free(self) -> float | None:
        """An offset that is no less than the one sought: half the least distance; None where no two parts can meet."""
        shapes = self.moved(range(len(self.owner)), 0.0)
        tree, reach = shapely.STRtree(shapes), 1e-3 * self.assembly.size
        while True:
            i, j = self._of_pairs(*tree.query(shapes, predicate="dwithin", distance=reach))
            if len(i):
                return float(shapely.distance(shapes[i], shapes[j]).min()) / 2
            if reach > 2 * self.assembly.size:
                return None
            reach *= 4

    def overlapping(self, i: Ints, j: Ints, offset: float, numbers: Ints | None = None) -> Ints:
        """Numbers of the pairs of regions that overlap at an offset, the deepest first, about."""
        if not len(i):
            return np.zeros(0, dtype=np.int64)
        used, both = np.unique(np.concatenate([i, j]), return_inverse=True)
        shapes = self.moved(used.tolist(), offset)
        one, other = shapes[both[: len(i)]], shapes[both[len(i) :]]
        depth = self._depths(one, other)
        order = np.argsort(-depth, kind="stable")
        found = order[depth[order] > 0]
        return found if numbers is None else numbers[found]

    def _depths(self, one: NDArray[np.object_], other: NDArray[np.object_]) -> Floats:
        """About how deep regions overlap (k,) [mm], 0 where that is rounding."""
        depth = np.zeros(len(one))
        meet = np.flatnonzero(shapely.intersects(one, other))
        meet = meet[~shapely.touches(one[meet], other[meet])]
        pieces, of = shapely.get_parts(shapely.intersection(one[meet], other[meet]), return_index=True)
        low, high = np.split(shapely.bounds(pieces), 2, axis=1)
        # a convex piece is no wider than twice its area by its length, and others are less wide
        width = 2 * shapely.area(pieces) / np.maximum((high - low).max(axis=1, initial=0.0), 1e-300)
        for k in np.flatnonzero(width > self.tolerance).tolist():
            if width[k] > 100 * self.tolerance or overlap_width(pieces[k]) > self.tolerance:
                depth[meet[of[k]]] = max(depth[meet[of[k]]], width[k])
        return depth

    def offset_of_pair(self, i: int, j: int, high: float) -> float | None:
        """The largest offset below one at which two regions overlap where they do not; None where one of them vanishes before."""
        exact = EXACT * self.assembly.size
        return largest_free(lambda offset: self._free(i, j, offset), high, max(exact, 1e-3 * abs(high)), exact)

    def _free(self, i: int, j: int, offset: float) -> bool | None:
        """Whether two regions do not overlap at an offset; None where one of them has vanished."""
        both = self.moved((i, j), offset)
        if shapely.is_empty(both).any():
            return None
        return not len(np.flatnonzero(self._depths(both[:1], both[1:])))

    def parts_of(self, i: Ints, j: Ints) -> Ints:
        """Indices (m, 2) of the parts of pairs of regions."""
        return np.unique(np.column_stack([self.owner[i], self.owner[j]]), axis=0)
