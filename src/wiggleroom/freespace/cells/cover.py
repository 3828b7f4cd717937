"""Cover the free space of one pair with cells, and say what share of it they cover."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import njit
from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.cells.cells import Cells, concatenated, grow_cells, select
from wiggleroom.freespace.cells.walls import clip_polygon
from wiggleroom.freespace.slices import Slice, SliceSequence
from wiggleroom.geometry.bodies import Bodies, BodyShapes
from wiggleroom.geometry.relative_pose import PairFrames, rotated
from wiggleroom.geometry.row_kinds import B_EDGE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Geometries = NDArray[np.object_]

MAX_UNCOVERED = 0.002
"""Share of the free space that may stay uncovered."""
MIN_COVERAGE_GAIN = 2e-5
"""Cells that cover less new space than this share are left out."""
SEEDS_PER_ROUND = 16
"""Places where a cell is tried in one round."""
MAX_COVER_ROUNDS = 60
"""Rounds at most, for one number of slices."""
SLICE_COUNTS = (48, 96, 192, 384)
"""Numbers of slices looked at; each after the first is also a fresh test of the cells so far."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Cells and what they were measured against.

    Parameters
    ----------
    cells : Cells
    slices : tuple of Slice [mm]
        Evenly spaced, in the middle of equal angle intervals.
    coverage : float
        Share of the volume of the slices that the cells cover.
    """

    cells: Cells
    slices: tuple[Slice, ...]
    coverage: float


def cover(
    bodies: Bodies, pair: tuple[int, int], relation: PairFrames, space: SliceSequence, stop: Stop | None = None
) -> Cover:
    """Grow cells in the largest uncovered pieces until hardly anything is left or nothing is gained.

    Parameters
    ----------
    bodies : Bodies
    pair : (a, b)
        Rows of the bodies.
    relation : Relative
    space : SliceSequence
        The exact free space.
    stop : optional
        Anything with `is_set()`, asked now and then; StoppedError is raised where it is set.
    """
    work = _Work(bodies, pair, relation, space, stop)
    cells = work.grown(np.zeros((1, 3)))
    for count in SLICE_COUNTS:
        slices = _evenly(space, count, stop)
        left = work.uncovered(cells, slices)
        first = _share(left, slices)
        cells, left = work.filled(cells, left, slices)
        if first <= MAX_UNCOVERED or _share(left, slices) > MAX_UNCOVERED:
            break
    return Cover(cells, slices, 1.0 - _share(left, slices))


def _evenly(space: SliceSequence, count: int, stop: Stop | None) -> tuple[Slice, ...]:
    low, high = space.ends
    found = []
    for phi in low + (high - low) * (np.arange(count) + 0.5) / count:
        go_on(stop)
        found.append(space.at(float(phi)))
    return tuple(s for s in found if s is not None)


def _share(left: Geometries, slices: tuple[Slice, ...]) -> float:
    return float(shapely.area(left).sum() / sum(s.area for s in slices))


@dataclass(frozen=True, eq=False)
class _Work:
    bodies: Bodies
    pair: tuple[int, int]
    relation: PairFrames
    space: SliceSequence
    stop: Stop | None

    def grown(self, seeds: Floats) -> Cells:
        """Cells grown at some shifts of the pivot and turns (k, 3), those that could be."""
        a, b = (np.full(len(seeds), k, dtype=np.int64) for k in self.pair)
        pose = self.relation.pose(seeds[:, :2], seeds[:, 2])
        cells, good = grow_cells(self.bodies, a, b, pose, np.full(len(seeds), self.space.pair.clearance))
        return select(cells, np.flatnonzero(good))

    def uncovered(self, cells: Cells, slices: tuple[Slice, ...]) -> Geometries:
        """Return what the cells leave of every slice."""
        left = np.array([s.region for s in slices], dtype=object)
        for c in range(len(cells.a)):
            go_on(self.stop)
            at, polygons = self.polygons(cells, c, slices)
            left[at] = _without(left[at], polygons)
        return left

    def polygons(self, cells: Cells, c: int, slices: tuple[Slice, ...]) -> tuple[Ints, Geometries]:
        """Which slices a cell meets, and its own polygon in each."""
        angle = np.array([s.angle for s in slices])
        psi = self.relation.psi + angle
        if self.space.full:
            psi = cells.seed[c, 2] + np.remainder(psi - cells.seed[c, 2] + np.pi, 2 * np.pi) - np.pi
        at = np.flatnonzero((psi > cells.ends[c, 0]) & (psi < cells.ends[c, 1]))
        boxes = np.array([slices[k].region.bounds for k in at]).reshape(-1, 4)
        normal, offset = half_planes_at_angles(self.bodies.shapes, cells, c, self.relation, psi[at], angle[at])
        corners, count = _clipped(normal, offset, boxes)
        some = count >= 3
        return at[some], _as_polygons(corners[some], count[some])

    def filled(self, cells: Cells, left: Geometries, slices: tuple[Slice, ...]) -> tuple[Cells, Geometries]:
        """Add cells while they gain something, the best of each round first."""
        volume = sum(s.area for s in slices)
        for _ in range(MAX_COVER_ROUNDS):
            go_on(self.stop)
            if _share(left, slices) <= MAX_UNCOVERED / 2:
                break
            seeds = _seeds(left, slices, self.space.pair.clearance)
            if not len(seeds):
                break
            new = self.grown(seeds)
            own = [self.polygons(new, c, slices) for c in range(len(new.a))]
            use = []
            for c in sorted(range(len(own)), key=lambda c: -float(shapely.area(own[c][1]).sum())):
                at, polygons = own[c]
                rest = _without(left[at], polygons)
                if float((shapely.area(left[at]) - shapely.area(rest)).sum()) > MIN_COVERAGE_GAIN * volume:
                    left[at] = rest
                    use.append(c)
            if not use:
                break
            cells = concatenated(cells, select(new, np.array(use)))
        return cells, left


def _without(left: Geometries, polygons: Geometries) -> Geometries:
    """Take the polygons from `left`; nothing, so no credit for the cell, where the overlay fails or cannot be right.

    Nearly coincident edges make GEOS return, rarely, an invalid polygon of negative area without complaint.
    """
    before, taken = shapely.area(left), shapely.area(polygons)
    unsure, rest = np.ones(len(left), dtype=bool), left
    for grid in (None, 1e-9 * float(np.sqrt(before.max(initial=0.0)))):
        try:
            tried = shapely.difference(left, polygons, grid_size=grid)
        except shapely.errors.GEOSException:
            continue
        area, slack = shapely.area(tried), 1e-6 * before
        right = shapely.is_valid(tried) & (area <= before + slack) & (area >= before - taken - slack)
        rest = np.where(unsure & right, tried, rest)
        unsure &= ~right
        if not unsure.any():
            break
    return rest


def _seeds(left: Geometries, slices: tuple[Slice, ...], clearance: float) -> Floats:
    """Middles (k, 3) of the largest uncovered pieces, not two in the same spot at nearly the same angle."""
    pieces, where = shapely.get_parts(left, return_index=True)
    areas, apart = shapely.area(pieces), len(slices) // SEEDS_PER_ROUND
    seeds: list[tuple[float, float, float]] = []
    taken = np.zeros(len(pieces), dtype=bool)
    for k in np.argsort(-areas):
        if areas[k] <= 0 or len(seeds) == SEEDS_PER_ROUND:
            break
        if taken[k]:
            continue
        taken |= (np.abs(where - where[k]) <= apart) & shapely.intersects(pieces, pieces[k])
        middle, room = _roomy_point(pieces[k])
        if room > 1e-4 * clearance:
            seeds.append((*middle, slices[where[k]].angle))
    return np.array(seeds).reshape(-1, 3)


def _roomy_point(piece: shapely.Polygon) -> tuple[Floats, float]:
    """Return a point inside, the middle of the largest triangle's incircle, and that circle's radius."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(piece))
    radius = 2 * shapely.area(triangles) / shapely.length(triangles)
    best = int(radius.argmax())
    corner = shapely.get_coordinates(triangles[best])[:3]
    opposite = np.hypot(*(np.roll(corner, -1, 0) - np.roll(corner, 1, 0)).T)
    return opposite @ corner / opposite.sum(), float(radius[best])


def half_planes_at_angles(
    shapes: BodyShapes, cells: Cells, c: int, relation: PairFrames, psi: Floats, phi: Floats
) -> tuple[Floats, Floats]:
    """Walls of one cell at some angles: normal (k, R, 2) and offset (k, R) of n . shift >= offset."""
    rows = np.arange(cells.row[c], cells.row[c + 1])
    rows = rows[cells.is_wall[rows]]
    edge, corner = cells.edge[rows], shapes.corner[cells.corner[rows]]
    n, start = shapes.normal[edge], shapes.corner[edge]
    angles = psi[:, None] + np.zeros(len(rows))
    of_b = cells.kind[rows] == B_EDGE
    turned = rotated(n, angles)
    q_normal = np.where(of_b[:, None], -turned, n)
    least = np.where(
        of_b, (n * start).sum(-1) - (turned * corner).sum(-1), (n * (start - rotated(corner, angles))).sum(-1)
    )
    origin = relation.apart + rotated(relation.origin, phi)
    normal = rotated(q_normal, np.full(angles.shape, relation.turned))
    return normal, least - (normal * origin[:, None]).sum(-1)


@njit(cache=True, nogil=True, error_model="numpy")
def _clipped(normal: Floats, offset: Floats, boxes: Floats) -> tuple[Floats, Ints]:
    """Corners (k, R + 4, 2) and their count (k,) of each box cut by the half-planes n . x >= offset."""
    many, rows = offset.shape
    out, count = np.zeros((many, rows + 4, 2)), np.zeros(many, dtype=np.int64)
    poly, spare = np.zeros((2 * rows + 8, 2)), np.zeros((2 * rows + 8, 2))
    for k in range(many):
        x0, y0, x1, y1 = boxes[k]
        poly[0, 0], poly[0, 1], poly[1, 0], poly[1, 1] = x0, y0, x1, y0
        poly[2, 0], poly[2, 1], poly[3, 0], poly[3, 1] = x1, y1, x0, y1
        n = 4
        for r in range(rows):
            n = clip_polygon(poly, n, normal[k, r, 0], normal[k, r, 1], offset[k, r], spare)
            poly, spare = spare, poly
            if n < 3:
                break
        count[k] = n
        for i in range(min(n, rows + 4)):
            out[k, i] = poly[i]
    return out, count


def _as_polygons(corners: Floats, count: Ints) -> Geometries:
    used = np.arange(corners.shape[1]) < count[:, None]
    rings = shapely.linearrings(corners[used], indices=np.repeat(np.arange(len(count)), count))
    return shapely.polygons(rings)
