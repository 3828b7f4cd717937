"""Outer regions: everything that B can reach against A, as prisms (an interval of turns, a convex polygon) and as facets of their hull.

A path from rest stays inside. In every interval the boundary of an outer slice is forbidden at all its turns, so a path leaves a piece only
through the end of the interval, into a piece of the next one that meets it; all those are taken in, forwards and back, until nothing is
new. Beyond the last intervals nothing is left over: no turn leads through them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.outer_slices import PairMaterial, Pieces, core, forbidden, uncovered
from wiggleroom.freespace.outer.outer_walls import cut_corners, polyhedron

Floats = NDArray[np.float64]
Shapes = dict[tuple[float, float], Floats]
Ints = NDArray[np.int64]

FIRST_BLUR = 0.15
"""The first intervals blur outer slices by this share of the clearance."""
MAX_HALF_WIDTH = 0.05
"""Half of the widest interval [rad]."""
REFINEMENT_FACTOR = 4
"""Factor by which intervals are divided where they are refined."""
MAX_INTERVALS = 1100
"""At most this many intervals are looked at to see whether B can turn all the way round."""
SLICE_WORK, SLICE_WORK_PER_CORNER = 3.5, 0.065
"""Work of a slice, and for each corner of both outlines where they are near each other."""
POLYHEDRON_SHARE = 0.5
"""A slice's polyhedra take this share of the work of the slice."""
MAX_CONFINED_INTERVALS = 100
"""At most this many intervals share the turns of a confined pair."""


@dataclass(frozen=True, eq=False)
class Confinement:
    """Relative motions that a pair never leaves, known from what holds its bodies elsewhere.

    Parameters
    ----------
    translations : shapely polygon [mm]
        Convex, round the origin.
    low, high : float [rad]
        Least and greatest turn.
    """

    translations: shapely.Polygon
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class OuterRegion:
    """Relative motions (tau, phi) of a pair that can be reached at all, and some more.

    tau [mm] is the motion of B's pivot in the axes of A's body, phi [rad] the turn.

    Parameters
    ----------
    material : PairMaterial
    lever : float [mm]
        A turn by one radian blurs an outer slice by this.
    low, high : (K,) float64 [rad]
        Intervals of turns.
    pieces : tuple of K arrays of shapely polygons [mm]
        What is left over in each.
    corner : (N, 3) float64 [mm, mm, rad]
        Corners of convex polyhedra that hold what is free of the pieces, one interval after the other.
    which : (N,) int64
        Interval of each corner.
    confinement : Confinement or None
        What keeps the pair together where it does not do so by itself.
    """

    material: PairMaterial
    lever: float
    low: Floats
    high: Floats
    pieces: tuple[Pieces, ...]
    corner: Floats
    which: Ints
    confinement: Confinement | None = None

    @property
    def turns(self) -> tuple[float, float]:
        """Least and largest turn [rad]."""
        return float(self.low.min()), float(self.high.max())

    @property
    def far(self) -> float:
        """Largest motion of the pivot [mm]."""
        return float(np.hypot(*self.corner[:, :2].T).max()) + 4 * self.material.margin

    @property
    def blur(self) -> Floats:
        """How much too large the slice of each interval is at most, about (K,) [mm]."""
        return self.lever * (self.high - self.low)

    def points(self, low: float = -np.inf, high: float = np.inf) -> tuple[Floats, Ints]:
        """Corners (M, 3) of the polyhedra, cut to turns between `low` and `high`, and the interval of each (M,)."""
        return cut_corners(self.corner, self.which, self.low, self.high, low, high)


def _outer(
    material: PairMaterial,
    lever: float,
    low: Floats,
    high: Floats,
    pieces: list[Pieces],
    known: Shapes,
    confinement: Confinement | None = None,
) -> OuterRegion:
    """Region of these intervals; polyhedra of intervals that were there before are taken over."""
    corners = [
        known[one, other]
        if (one, other) in known
        else polyhedron(material, material.near(_apart(material, one, other, _window(p))), one, other, p)
        for one, other, p in zip(low.tolist(), high.tolist(), pieces, strict=True)
    ]
    which = np.repeat(np.arange(len(corners)), [len(c) for c in corners])
    return OuterRegion(material, lever, low, high, tuple(pieces), np.vstack(corners), which, confinement)


def _window(pieces: Pieces) -> float:
    """Half the side of the square round the origin that holds some pieces [mm]."""
    return float(np.abs(shapely.bounds(pieces)).max())


def _apart(material: PairMaterial, low: float, high: float, window: float) -> float:
    """How far from each other parts of A and B may lie that meet at these turns within a window [mm]."""
    return 3 * window + 2 * np.sin(min(max(-low, high), np.pi) / 2) * material.radius


def outer_region(
    material: PairMaterial, lever: float, limit: float, budget: WorkBudget | None = None
) -> OuterRegion | None:
    """Outer region in coarse intervals; None where it does not end within `limit` [mm], or where the budget ends first."""
    found = reached_slices(material, lever, limit, budget)
    if found is None:
        return None
    if budget is not None:
        budget.spend(POLYHEDRON_SHARE * len(found.low) * slice_work(material.a, material.b))
    return _outer(material, lever, found.low, found.high, list(found.pieces), {})


def confined_region(
    material: PairMaterial, lever: float, confinement: Confinement, budget: WorkBudget | None = None
) -> OuterRegion | None:
    """Outer region of a pair that is held together from elsewhere; None where the budget ends first.

    Slices end at the rim of the confinement, and so do turns: no path leads on from there.
    """
    half = min(FIRST_BLUR * material.clearance / (2 * lever), MAX_HALF_WIDTH)
    half = max(half, (confinement.high - confinement.low) / (2 * MAX_CONFINED_INTERVALS))
    window = 1.01 * _window(np.array([confinement.translations], dtype=object))
    found = _followed(material, half, window, budget, confinement)
    if not isinstance(found, dict) or not found:
        return None
    slices = _sorted(found, half)
    if budget is not None:
        budget.spend(POLYHEDRON_SHARE * len(slices.low) * slice_work(material.a, material.b))
    return _outer(material, lever, slices.low, slices.high, list(slices.pieces), {}, confinement)


@dataclass(frozen=True, eq=False)
class ReachedSlices:
    """Pieces that can be reached, for intervals of turns from `low` to `high` (K,) [rad]."""

    low: Floats
    high: Floats
    pieces: tuple[Pieces, ...]


def reached_slices(
    material: PairMaterial, lever: float, limit: float, budget: WorkBudget | None = None
) -> ReachedSlices | None:
    """Follow what is left over from rest both ways, in coarse intervals; None where it does not end within `limit`, or the budget does.

    Parameters
    ----------
    material : PairMaterial
    lever : float [mm]
        From `pivot_of`.
    limit : float [mm]
        The pivot is followed so far.
    budget : WorkBudget, optional
        Every slice is charged to it.
    """
    half = min(FIRST_BLUR * material.clearance / (2 * lever), MAX_HALF_WIDTH)
    window = min(4 * material.clearance, limit)
    while True:
        found = _followed(material, half, window, budget)
        if found is None or (isinstance(found, dict) and not found):  # rest itself is nowhere: rounding
            return None
        if isinstance(found, dict):
            break
        if found and window < limit:
            window = min(2 * window, limit)
        elif (
            not found and REFINEMENT_FACTOR * np.pi / half < MAX_INTERVALS
        ):  # perhaps it only seems to turn all the way round
            half /= REFINEMENT_FACTOR
        else:
            return None
    return _sorted(found, half)


def _sorted(found: dict[int, Pieces], half: float) -> ReachedSlices:
    """Pieces in order of their turns; interval k lies round 2 k half."""
    order = sorted(found)
    ends = np.array([(2 * k - 1) * half for k in (*order, order[-1] + 1)])
    return ReachedSlices(ends[:-1], ends[1:], tuple(found[k] for k in order))


def _followed(
    material: PairMaterial,
    half: float,
    window: float,
    budget: WorkBudget | None,
    confinement: Confinement | None = None,
) -> dict[int, Pieces] | bool | None:
    """Reached pieces of all intervals; True where one meets the rim of the window, False where B turns all the way round.

    None where the budget ended first. A confined pair meets neither.
    """
    budget = budget or WorkBudget()
    slices: dict[int, Leftover] = {}
    reached: dict[int, NDArray[np.bool_]] = {}
    todo: list[int] = []

    def reach(k: int, met: shapely.Geometry) -> None:
        if k not in slices:
            slices[k] = leftover(material, 2 * k * half, half, window, confinement)
            budget.spend(slices[k].work)
            reached[k] = np.zeros(len(slices[k].pieces), dtype=bool)
        new = ~reached[k] & shapely.dwithin(slices[k].pieces, met, material.margin)
        new[new] = slices[k].open(new)
        if new.any():
            reached[k] |= new
            todo.append(k)

    reach(0, shapely.Point(0, 0))
    while todo:
        if budget.is_set():
            return None
        k = todo.pop()
        here = slices[k].pieces[reached[k]]
        if confinement is None and _window(here) >= window * (1 - 1e-9):
            return True
        if abs(k) * half > np.pi:
            return False
        for other in (k - 1, k + 1):
            if confinement is None or (
                (2 * other - 1) * half <= confinement.high and (2 * other + 1) * half >= confinement.low
            ):
                reach(other, shapely.multipolygons(here))
    return {k: slices[k].pieces[reached[k]] for k in slices if reached[k].any()}


@dataclass(frozen=True, eq=False)
class Leftover:
    """Pieces that no contact of A and B's core crosses, for the turns of one interval."""

    pieces: Pieces
    a: shapely.Geometry
    core: shapely.Geometry
    margin: float

    @property
    def work(self) -> float:
        """About how long it took, in milliseconds of one machine."""
        return slice_work(self.a, self.core)

    def open(self, which: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """True for those of some pieces that are not certainly forbidden."""
        return ~forbidden(self.a, self.core, self.pieces[which], self.margin)


def slice_work(a: shapely.Geometry, b: shapely.Geometry) -> float:
    """About how long a slice of two outlines takes, in milliseconds of one machine: from their corners alone."""
    return SLICE_WORK + SLICE_WORK_PER_CORNER * float(shapely.get_num_coordinates([a, b]).sum())


def leftover(
    material: PairMaterial, middle: float, half: float, window: float, confinement: Confinement | None = None
) -> Leftover:
    """Pieces of the window, and of the confinement, at all turns within `half` of `middle`."""
    near = material.near(_apart(material, middle - half, middle + half, window))
    smaller = core(near.b, middle, half, material.margin)
    pieces = uncovered(near.a, smaller, window)
    if confinement is not None:
        within = shapely.get_parts(shapely.intersection(pieces, confinement.translations))
        pieces = within[shapely.get_type_id(within) == shapely.GeometryType.POLYGON]
    return Leftover(pieces, near.a, smaller, material.margin)


def with_narrower_intervals(outer: OuterRegion, wanted: Ints) -> OuterRegion:
    """The same region with some intervals cut into narrower ones, whose slices are smaller.

    Free pieces of a narrower interval lie each inside one of the interval that it was cut from.
    """
    lows, highs, pieces = [], [], []
    cut = np.isin(np.arange(len(outer.low)), wanted)
    for k, mine in enumerate(outer.pieces):
        ends = np.linspace(outer.low[k], outer.high[k], REFINEMENT_FACTOR + 1 if cut[k] else 2)
        for one, other in pairwise(ends):
            left = mine
            if cut[k]:
                window = 1.001 * _window(mine)
                # the ends are rounded: what is looked at is a little wider
                found = leftover(
                    outer.material, (one + other) / 2, (other - one) / 2 + 1e-14, window, outer.confinement
                )
                spots = shapely.point_on_surface(found.pieces)
                inside = shapely.dwithin(spots, shapely.multipolygons(mine), outer.material.margin)
                left = found.pieces[inside][found.open(inside)]
            if len(left):
                lows.append(one)
                highs.append(other)
                pieces.append(left)
    known = {
        (one, other): outer.corner[outer.which == k]
        for k, (one, other) in enumerate(zip(outer.low.tolist(), outer.high.tolist(), strict=True))
        if not cut[k]
    }
    return _outer(outer.material, outer.lever, np.array(lows), np.array(highs), pieces, known, outer.confinement)


def pivot_of(a: shapely.Geometry, b: shapely.Geometry, reach: float) -> tuple[Floats, float]:
    """The point about which turning B moves its edges near A along themselves, as far as there is one, and the lever left over [mm].

    An edge blurs by its motion across itself: per radian, the coordinate of its ends along it, seen from the pivot.
    """
    edges = _edges_near(b, a, reach)
    along = edges[:, 1] - edges[:, 0]
    long = np.hypot(*along.T)
    e = along / long[:, None]
    middle = edges.mean(1)
    weight = (long[:, None, None] * e[:, :, None]) * e[:, None, :]
    right = (weight @ middle[:, :, None]).sum(0)[:, 0]
    centre = (long[:, None] * middle).sum(0) / long.sum()
    steady = 1e-3 * weight.sum(0).trace() * np.eye(2)
    pivot = np.linalg.solve(weight.sum(0) + steady, right + steady @ centre)
    lever = float(np.abs(((edges - pivot) * e[:, None]).sum(2)).max())
    return pivot, lever


def _edges_near(b: shapely.Geometry, a: shapely.Geometry, reach: float) -> Floats:
    """Pieces (k, 2, 2) of B's boundary within `reach` of A."""
    around = shapely.make_valid(shapely.buffer(a, reach, join_style="mitre"))  # a mitred buffer may cross itself
    near = shapely.intersection(shapely.boundary(b), around)
    lines = shapely.get_parts(shapely.line_merge(near))
    lines = lines[shapely.get_type_id(lines) == shapely.GeometryType.LINESTRING]
    if not len(lines):
        lines = shapely.get_parts(shapely.boundary(b))
    points, which = shapely.get_coordinates(lines, return_index=True)
    same = which[1:] == which[:-1]
    return np.stack([points[:-1][same], points[1:][same]], 1)
