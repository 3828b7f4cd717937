"""Slides of bodies and of what they push: the directions, the places at which they stop, and what leaves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.slide_moves import MAX_STOPS, alignments, all_levels, slide_distances, slides
from wiggleroom.geometry.bodies import Bodies, corners
from wiggleroom.geometry.neighbours import ignored_matrix

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MAX_AXES = 6
"""Bodies slide both ways along at most this many directions of edges, the longest edges first."""
MIN_AXIS_SHARE = 0.05
"""Least total length of the edges along an axis, as a share of those along the first."""
MARGIN = 0.02
"""A slide leaves at least this share of the clearance beside what slides."""
UNIT_TOLERANCE = 0.1
"""Edges lie on a lattice where they do so to this share of the clearance."""
MIN_UNIT = 4.0
"""A lattice's unit is at least this multiple of the clearance."""
MAX_UNIT_PARTS = 8
"""The shortest distance of two edges is at most this many units."""
MIN_LEVELS, EXACT = 6, 1e-3
"""Of fewer distances some unit fits by chance: then edges must lie on the lattice to this share of the tolerance."""
MAX_UNITS = 60
"""A lattice spans at most this many units."""
MAX_SLIDES = 4000
"""Slides of one state that there is room for; no more are looked for."""
STOP_CHECK_PAIRS = 50_000_000
"""After this many pairs of bodies it is asked again whether to stop."""


@dataclass(frozen=True, eq=False)
class Slide:
    """Bodies that slide as one.

    Parameters
    ----------
    who : (k,) int64
    direction : (2,) float64
        A unit vector.
    length : float [mm]
        Infinity where they leave.
    """

    who: Ints
    direction: Floats
    length: float


class SlideSpace:
    """What stays the same while bodies slide.

    Parameters
    ----------
    bodies : Bodies
    ignored : (k,) int64
        Keys a * n + b of pairs that never collide.
    clearance, size : float [mm]
        Typical clearance, and size of the drawing.
    motion : (n, 3) float64 [mm, mm, rad]
        Where all are to begin with.
    there : (n,) bool
        Bodies that have not left.
    """

    def __init__(
        self, bodies: Bodies, ignored: Ints, clearance: float, size: float, motion: Floats, there: Bools
    ) -> None:
        n = len(bodies.fixed)
        self.bodies, self.clearance, self.size, self.there = bodies, clearance, size, there
        self.ignored = ignored_matrix(ignored, n) | (bodies.fixed[:, None] & bodies.fixed)
        """Pairs that never collide, both ways round; what stands counts among them."""
        axes = slide_axes(bodies, motion, there)
        self.directions = np.concatenate([axes, -axes])
        units = [self._unit(axis, motion) for axis in axes]
        self.units = np.array([*units, *units])
        self.work = 0
        """Pairs of edges that were compared."""
        d = len(self.directions)
        self._distance = np.empty((d, n, n))
        self._stops, self._count = np.zeros((d, n, MAX_STOPS)), np.zeros((d, n), dtype=np.int64)
        self._who, self._along = np.zeros((MAX_SLIDES, n), dtype=np.bool_), np.zeros(MAX_SLIDES, dtype=np.int64)
        self._length = np.zeros(MAX_SLIDES)

    @property
    def on_lattice(self) -> bool:
        """True where every stop lies on a lattice, so that there are finitely many states, all of which can be visited."""
        return bool((self.units > 0).all())

    def slides(self, motion: Floats, context: Context = UNLIMITED) -> list[Slide]:
        """Slides from a state, and what leaves from it, with a length of infinity.

        Raises
        ------
        StoppedError
            If it was asked to stop.
        """
        shapes, bodies = self.bodies.shapes, self.bodies
        d, n = self._count.shape
        pose = bodies.rest + motion
        outlines = shapes.corner, shapes.after, shapes.first, bodies.shape, pose
        for k0, k1 in _blocks(d, STOP_CHECK_PAIRS // n**2):
            context.go_on()
            self.work += slide_distances(
                *outlines, self.there, self.directions[k0:k1], self.ignored, MARGIN * self.clearance, self._distance[k0:k1]
            )  # fmt: skip
        count = 0
        for i0, i1 in _blocks(d * n, STOP_CHECK_PAIRS // (MAX_STOPS * n)):
            context.go_on()
            alignments(
                i0, i1, *outlines, bodies.fixed, self.there, self.directions, self.units, self.clearance, self._distance,
                self._stops, self._count,
            )  # fmt: skip
        for i0, i1 in _blocks(d * n, STOP_CHECK_PAIRS // (MAX_STOPS * n**2)):
            context.go_on()
            count = slides(
                i0, i1, self._distance, bodies.fixed, self.there, self._stops, self._count, self.units, self.clearance,
                3 * self.size, self._who, self._along, self._length, count,
            )  # fmt: skip
            if count == MAX_SLIDES:
                break
        return [
            Slide(np.flatnonzero(self._who[k]), self.directions[self._along[k]], float(self._length[k]))
            for k in range(count)
        ]

    def _unit(self, axis: Floats, motion: Floats) -> float:
        """The lattice's unit along an axis [mm]; zero where edges do not lie on one."""
        shapes, bodies = self.bodies.shapes, self.bodies
        out = np.empty(int((np.diff(shapes.first)[bodies.shape] + 2).sum()))
        count = all_levels(
            shapes.corner, shapes.after, shapes.first, bodies.shape, bodies.rest + motion, self.there, axis,
            self.clearance, out,
        )  # fmt: skip
        return lattice_unit(out[:count], UNIT_TOLERANCE * self.clearance, MIN_UNIT * self.clearance)


def _blocks(count: int, many: int) -> Iterator[tuple[int, int]]:
    """Consecutive ranges of `many` of `count` items, at least one each."""
    many = max(many, 1)
    return ((k, min(k + many, count)) for k in range(0, count, many))


def lattice_unit(levels: Floats, tolerance: float, least: float) -> float:
    """Largest length of which all differences of some numbers are multiples; zero where there is none.

    Parameters
    ----------
    levels : (k,) float64 [mm]
    tolerance : float [mm]
        Differences may be wrong by so much.
    least : float [mm]
        Shorter lengths are none.

    Examples
    --------
    >>> lattice_unit(np.array([0.0, 10.0, 25.0, 40.0]), 0.1, 1.0)
    5.0
    >>> lattice_unit(np.array([0.0, 10.0, 13.7]), 0.1, 1.0)
    0.0
    """
    levels = np.sort(levels)
    gaps = np.diff(levels)
    gaps = gaps[gaps > 2 * tolerance]
    if not len(gaps):
        return 0.0
    for parts in range(1, MAX_UNIT_PARTS + 1):
        unit = gaps.min() / parts
        if unit < least or (levels[-1] - levels[0]) / unit > MAX_UNITS:
            break
        multiples = np.round((levels - levels[0]) / unit)
        unit = float((multiples @ (levels - levels[0])) / (multiples @ multiples))  # least squares
        off = np.ptp(levels - multiples * unit)
        if off <= (2 * tolerance if len(gaps) >= MIN_LEVELS else EXACT * tolerance):
            return unit
    return 0.0


def slide_axes(bodies: Bodies, motion: Floats, there: Bools) -> Floats:
    """Unit vectors (k, 2) along the edges, the longest together first."""
    shapes = bodies.shapes
    body, _ = corners(bodies)
    count = np.diff(shapes.first)[bodies.shape]
    row = np.arange(len(body)) + np.repeat(shapes.first[bodies.shape] - (np.cumsum(count) - count), count)
    angle = np.arctan2(shapes.normal[row, 0], -shapes.normal[row, 1]) + (bodies.rest + motion)[body, 2]
    angle, length = angle % np.pi, shapes.length[row] * there[body]
    slot = np.round(angle / 1e-4).astype(np.int64) % round(np.pi / 1e-4)
    total = np.bincount(slot, weights=length)
    longest = np.argsort(-total, kind="stable")[:MAX_AXES]
    longest = longest[total[longest] > MIN_AXIS_SHARE * total[longest[0]]]
    exact = np.array([angle[np.flatnonzero((slot == s) & (length > 0))[0]] for s in longest])
    return np.column_stack([np.cos(exact), np.sin(exact)])
