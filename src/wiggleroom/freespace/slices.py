"""Slices: all free translations of B against A at one turn, exactly.

An edge of A and an edge of B meet for the translations in one parallelogram. A connected piece of a window that no
parallelogram covers is therefore wholly free or wholly forbidden, and one point of it decides.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]

SLIVER_ANGLE = 1e-9
"""Parallelograms whose sides differ in direction by less than this [rad] are left out: others cover the same."""
MIN_THICKNESS = 1e-12
"""Pieces thinner than this share of the clearance are rounding."""
ANGLE_NUDGES = (0.0, 1e-9, -1e-9, 1e-8)
"""Angles [rad] tried one after the other where the union of the parallelograms fails or loses the piece."""
MAX_PARALLELOGRAMS = 20000
"""Windows that more parallelograms touch are not widened: the free space counts as open."""
BATCH_SIZE = 12
"""Parallelograms cut off at a time."""
ANGLE_TOLERANCE = 1e-7
"""How closely the last free angle is found [rad]."""
MAX_ANGLE_STEP = 0.05
"""Longest step of the march [rad]."""


@dataclass(frozen=True, eq=False)
class PairOutlines:
    """A pair as slices see it, in the axes of part a's frame; translations are shifts of the pivot from rest.

    Parameters
    ----------
    a, b : (n, 2, 2) float64 [mm]
        Start and end of each edge: of A about the pivot's place at rest, of B about the pivot, unturned.
    material : two shapely geometries
        The same outlines as areas.
    clearance : float [mm]
        Distance at rest.
    far : float [mm]
        No free piece that reaches beyond this ends at all.
    """

    a: Floats
    b: Floats
    material: tuple[shapely.Geometry, shapely.Geometry]
    clearance: float
    far: float

    @property
    def radius(self) -> float:
        """Largest distance of a corner of B from the pivot [mm]."""
        return float(np.hypot(*self.b[:, 0].T).max())


@dataclass(frozen=True, eq=False)
class Slice:
    """Free space at one turn.

    Parameters
    ----------
    angle : float [rad]
    region : shapely polygon or multipolygon [mm]
        Free translations that are connected to rest.
    closed : bool
        False where the region is cut off by the window.
    area : float [mm2]
    """

    angle: float
    region: shapely.Geometry
    closed: bool
    area: float


def pair_outlines(a: shapely.Geometry, b: shapely.Geometry) -> PairOutlines:
    """Pair of two areas in the axes of part a's frame with the pivot at the origin, both at rest.

    Examples
    --------
    >>> pair = pair_outlines(shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1), shapely.box(-0.9, -0.9, 0.9, 0.9))
    >>> round(slice_near(pair, 0.0, shapely.Point(0, 0)).area, 6)  # the peg's centre has a square of side 0.2
    0.04
    """
    edges = [edges_of(g) for g in (a, b)]
    for geometry in (a, b):
        shapely.prepare(geometry)
    far = sum(float(np.hypot(*e[:, 0].T).max()) for e in edges)
    return PairOutlines(edges[0], edges[1], (a, b), float(shapely.distance(a, b)), far)


def edges_of(geometry: shapely.Geometry) -> Floats:
    """Edges (n, 2, 2) of all rings."""
    rings = [r for part in shapely.get_parts(geometry) for r in (part.exterior, *part.interiors)]
    corners = [shapely.get_coordinates(r) for r in rings]
    return np.vstack([np.stack([c[:-1], c[1:]], 1) for c in corners])


def slice_near(
    pair: PairOutlines,
    phi: float,
    near: shapely.Geometry,
    limit: float = np.inf,
    nudges: Sequence[float] = ANGLE_NUDGES,
) -> Slice | None:
    """Free pieces at the turn `phi` that meet `near`, or None where there are none.

    Parameters
    ----------
    pair : PairOutlines
    phi : float [rad]
    near : shapely geometry [mm]
        A free translation, or the region of a slice at a turn close by.
    limit : float [mm]
        Half the side of the largest window, a square round rest; without it the window grows until it holds the pieces.
    nudges : sequence of float [rad]
        Added to the angle one after the other, until a piece is found.
    """
    for nudge in nudges:
        try:
            found = _grown(pair, phi + nudge, near, limit)
        except shapely.errors.GEOSException:
            continue
        if found is not None:
            return replace(found, angle=phi)
    return None


def _grown(pair: PairOutlines, phi: float, near: shapely.Geometry, limit: float) -> Slice | None:
    """Slice in a window that grows until no piece meets its rim, or as far as it may."""
    low, high = np.array(near.bounds).reshape(2, 2)
    largest = min(limit, pair.far)
    margin = 0.5 * pair.clearance + 0.15 * float((high - low).max())
    while True:
        box = (*np.maximum(low - margin, -largest), *np.minimum(high + margin, largest))
        quads = parallelograms(pair, phi, box)
        pieces = _pieces(quads, box, near)
        pieces = pieces[[_free(pair, phi, p) for p in pieces]]
        if not len(pieces):
            return None
        rim = shapely.box(*box).exterior
        closed = not bool(shapely.intersects(pieces, rim).any())
        most = max(map(abs, box)) >= largest and min(abs(low - margin).min(), abs(high + margin).min()) >= largest
        if closed or most or (len(quads) > MAX_PARALLELOGRAMS and limit == np.inf):
            region = pieces[0] if len(pieces) == 1 else shapely.multipolygons(pieces)
            return Slice(phi, region, closed, float(shapely.area(region)))
        margin *= 2


def parallelograms(pair: PairOutlines, phi: float, box: Box) -> Floats:
    """Corners (k, 4, 2) of the translations in which two edges meet, for all edge pairs that touch the box."""
    b = rotated(pair.b.reshape(-1, 2), np.array([phi])).reshape(-1, 2, 2)
    low, high = np.array(box).reshape(2, 2)
    a = _in_reach(pair.a, b.min(axis=(0, 1)) + low, b.max(axis=(0, 1)) + high)
    if len(a):
        b = _in_reach(b, a.min(axis=(0, 1)) - high, a.max(axis=(0, 1)) - low)
    (a_low, a_high), (b_low, b_high) = ((e.min(axis=1), e.max(axis=1)) for e in (a, b))
    near = np.ones((len(a), len(b)), dtype=bool)
    for axis in (0, 1):
        near &= a_low[:, axis, None] - b_high[:, axis] <= high[axis]
        near &= a_high[:, axis, None] - b_low[:, axis] >= low[axis]
    i, j = np.nonzero(near)
    e, f = a[i, 1] - a[i, 0], b[j, 1] - b[j, 0]
    cross = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    keep = np.abs(cross) > SLIVER_ANGLE * np.hypot(*e.T) * np.hypot(*f.T)
    start = a[i, 0] - b[j, 0]
    middle, half = (low + high) / 2, (high - low) / 2
    for own, other in ((e, f), (f, e)):  # the box lies beyond one of the sides
        n = np.column_stack([-own[:, 1], own[:, 0]])
        width = np.where(own is e, -1.0, 1.0) * (n * other).sum(1)
        at = ((middle - start) * n).sum(1)
        room = np.abs(n) @ half
        keep &= (at + room >= np.minimum(width, 0)) & (at - room <= np.maximum(width, 0))
    start, e, f = start[keep], e[keep], f[keep]
    return np.stack([start, start + e, start + e - f, start - f], axis=1)


def _in_reach(edges: Floats, low: Floats, high: Floats) -> Floats:
    """Edges (k, 2, 2) whose boxes meet a box."""
    return edges[((edges.min(axis=1) <= high) & (edges.max(axis=1) >= low)).all(axis=1)]


def _pieces(quads: Floats, box: Box, near: shapely.Geometry) -> NDArray[np.object_]:
    """Pieces of the box that meet `near` and that no parallelogram covers; none where the overlay cannot be right.

    Cut off a batch at a time, the nearest first, so that most of the others miss what is left.
    """
    pieces = np.array([shapely.box(*box)], dtype=object)
    todo = shapely.polygons(quads)
    todo = todo[np.argsort(shapely.distance(todo, shapely.centroid(near)), kind="stable")]
    while len(todo):
        region = shapely.difference(shapely.multipolygons(pieces), shapely.union_all(todo[:BATCH_SIZE]))
        if not shapely.is_valid(region):
            return pieces[:0]
        pieces = shapely.get_parts(region)
        pieces = pieces[
            (shapely.get_type_id(pieces) == shapely.GeometryType.POLYGON) & shapely.intersects(pieces, near)
        ]
        left = shapely.multipolygons(pieces)
        shapely.prepare(left)
        todo = todo[BATCH_SIZE:]
        todo = todo[shapely.intersects(left, todo)]
    return pieces


def _free(pair: PairOutlines, phi: float, piece: shapely.Polygon) -> bool:
    """One point decides; a piece too thin to hold one is rounding."""
    if piece.area <= MIN_THICKNESS * pair.clearance * piece.length:
        return False
    spot = shapely.get_coordinates(shapely.point_on_surface(piece))
    a, b = pair.material
    moved = shapely.transform(b, lambda p: rotated(p, np.array([phi])) + spot)
    return not shapely.intersects(a, moved)


@dataclass(frozen=True, eq=False)
class SliceSequence:
    """Slices from one end of the free space to the other.

    Parameters
    ----------
    pair : PairOutlines
    slices : tuple of Slice
        By angle; each overlaps the next.
    ends : (low, high) [rad]
    full : bool
        True where B can turn all the way round.
    limit : float [mm]
        Half the side of the window; infinite where the free space is closed.
    """

    pair: PairOutlines
    slices: tuple[Slice, ...]
    ends: tuple[float, float]
    full: bool
    limit: float

    def at(self, phi: float) -> Slice | None:
        """Slice at any turn between the ends [rad]."""
        k = bisect([s.angle for s in self.slices], phi)
        beside = [s.region for s in self.slices[max(k - 1, 0) : k + 1]]
        return slice_near(self.pair, phi, shapely.union_all(beside), self.limit)


def slice_sequence(pair: PairOutlines, reach: float, stop: Stop | None = None) -> SliceSequence:
    """Follow the free space from rest both ways until it ends.

    Parameters
    ----------
    pair : PairOutlines
    reach : float [mm]
        Half the side of the window to keep to where the free space is open.
    stop : optional
        Asked before every slice.

    Raises
    ------
    ValueError
        If rest is not free.
    StoppedError
        If it was asked to stop.

    Examples
    --------
    >>> pair = pair_outlines(shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1), shapely.box(-0.9, -0.9, 0.9, 0.9))
    >>> round(slice_sequence(pair, reach=1.0).ends[1], 6)  # 0.9 (cos + sin) = 1
    0.118387
    """
    for limit in (np.inf, reach):
        rest = slice_near(pair, 0.0, shapely.Point(0, 0), limit)
        if rest is None:
            raise ValueError("rest is not free")
        if limit == np.inf and not rest.closed:
            continue
        up = _followed(pair, rest, 2 * np.pi, limit, stop)
        full = up[-1].angle >= 2 * np.pi
        down = [rest] if full else _followed(pair, rest, up[-1].angle - 2 * np.pi, limit, stop)
        slices = _folded_back(pair, [*down[:0:-1], *up], limit, stop)
        if limit < np.inf or all(s.closed for s in slices):
            break
    return SliceSequence(pair, tuple(slices), (slices[0].angle, slices[-1].angle), full, limit)


def _followed(pair: PairOutlines, rest: Slice, goal: float, limit: float, stop: Stop | None) -> list[Slice]:
    """Slices from rest towards the turn `goal`, closer together where they change quickly and at the end."""
    found = [rest]
    step = float(np.sign(goal)) * min(pair.clearance / (4 * pair.radius), MAX_ANGLE_STEP)
    while abs(step) > ANGLE_TOLERANCE and found[-1].angle != goal:
        go_on(stop)
        here = found[-1]
        there = min(here.angle + step, goal) if goal > 0 else max(here.angle + step, goal)
        beside = slice_near(pair, there, here.region, limit, nudges=(0.0,))  # half a step is another angle too
        if beside is None or not _overlap_well(here, beside):
            step /= 2
            continue
        found.append(beside)
        if limit == np.inf and not beside.closed:
            break
        step = float(np.clip(1.5 * step, -MAX_ANGLE_STEP, MAX_ANGLE_STEP))
    return found


def _overlap_well(one: Slice, other: Slice) -> bool:
    """Whether two slices share a good part of the smaller one."""
    return float(shapely.area(shapely.intersection(one.region, other.region))) > 0.3 * min(one.area, other.area)


def _folded_back(pair: PairOutlines, slices: list[Slice], limit: float, stop: Stop | None) -> list[Slice]:
    """Add pieces that are reached only by turning further and coming back."""
    slices = list(slices)
    for order in (range(len(slices) - 2, -1, -1), range(1, len(slices))):
        for k in order:
            go_on(stop)
            mine = slices[k]
            beside = slices[k + 1 if order.step < 0 else k - 1]
            if abs(beside.angle - mine.angle) < 100 * ANGLE_TOLERANCE or not _sticks_out(beside, mine):
                continue
            wider = slice_near(pair, mine.angle, shapely.union_all([mine.region, beside.region]), limit)
            if wider is not None and wider.area > mine.area * (1 + 1e-9):
                slices[k] = wider
    return slices


def _sticks_out(one: Slice, other: Slice) -> bool:
    """Whether a good part of `one` lies outside `other`: only then may a second piece be near."""
    return float(shapely.area(shapely.difference(one.region, other.region))) > 1e-3 * one.area
