"""Outer slices: translations of B against A that are not forbidden at every turn of an interval.

What B covers at *all* turns of the interval is a smaller part, its *core*. Where A and the core meet, A and B overlap at every turn of the
interval; so what is left over holds every free translation at any of its turns. Source of the idea: Varava, Carvalho, Kragic and Pokorny,
"Free Space of Rigid Objects" (2020), who shrink B by a disc; here every edge sweeps only the strip that it really passes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Pieces = NDArray[np.object_]

SAFETY_MARGIN = 1e-8
"""Cores are smaller, and outer slices larger, by this share of the pair's size: far above rounding and
above what congruent pairs may differ by, far below any gap."""
ANGLE_TOLERANCE = 1e-9
"""Corners count as able to touch an edge up to this angle [rad] beyond; contacts that cannot happen do no harm."""

MAX_UNCULLED_CORNERS = 120
"""Pairs with fewer corners are looked at whole."""


@dataclass(frozen=True, eq=False)
class PairMaterial:
    """A pair in the axes of A's body, the pivot's place at rest at the origin, B turned as at rest.

    Parameters
    ----------
    a, b : shapely geometries
        Material.
    clearance : float [mm]
        Distance at rest.
    size : float [mm]
        Largest coordinate of the bodies that these are strips of: by a share of it bodies and congruent ones differ. Whole bodies know it.
    """

    a: shapely.Geometry
    b: shapely.Geometry
    clearance: float
    size: float = 0.0

    @cached_property
    def radius(self) -> float:
        """Largest distance of a corner of B from the pivot [mm]."""
        return float(np.hypot(*shapely.get_coordinates(self.b).T).max())

    @cached_property
    def extent(self) -> float:
        """Largest coordinate of both parts, or of the bodies that they are strips of [mm]."""
        low_x, low_y, high_x, high_y = shapely.total_bounds(np.array([self.a, self.b], dtype=object))
        return max(self.size, float(max(high_x, high_y, -low_x, -low_y)))

    @property
    def margin(self) -> float:
        """Length that makes up for rounding, and for what congruent pairs differ by [mm]."""
        return SAFETY_MARGIN * self.extent

    def near(self, reach: float) -> PairMaterial:
        """Less of both parts, all within `reach` [mm] of each other: with less to meet, outer slices stay outer."""
        if shapely.get_num_coordinates(self.a) + shapely.get_num_coordinates(self.b) < MAX_UNCULLED_CORNERS:
            return self
        steps = int(np.ceil(2 * np.log2(reach / self.clearance)))
        return _near(self, self.clearance * 2 ** (steps / 2))

    def strips(self, width: float) -> PairMaterial:
        """What of either part lies within `width` [mm] of the other one; all of both where that is all, or fails."""
        if width >= 4 * self.extent:
            return self
        cut = []
        try:
            for one, other in ((self.a, self.b), (self.b, self.a)):
                # a mitred buffer may cross itself; edges shorter than rounding have no direction
                around = shapely.make_valid(shapely.buffer(other, width, join_style="mitre"))
                strip = shapely.remove_repeated_points(shapely.intersection(one, around), 1e-3 * self.margin)
                cut.append(_areas(strip))
        except shapely.errors.GEOSException:
            return self
        left = shapely.area(self.a) + shapely.area(self.b) - shapely.area(cut).sum()
        if not all(g.is_valid for g in cut) or left <= 1e-9 * (shapely.area(self.a) + shapely.area(self.b)):
            return self
        return PairMaterial(cut[0], cut[1], self.clearance, self.extent)


@lru_cache(maxsize=256)
def _near(material: PairMaterial, reach: float) -> PairMaterial:
    return material.strips(reach)


def core(b: shapely.Geometry, middle: float, half: float, margin: float) -> shapely.Geometry:
    """Points that B covers at every turn within `half` of `middle` [rad], less `margin` [mm], turned to `middle`.

    An edge sweeps a part of the hull of its ends at both turns and of the apexes of the two arcs between.
    """
    swept_by = half * (1 + 1e-9) + 1e-15
    corners, after = loops(b)
    ends = np.stack([corners, corners[after]], 1).reshape(-1, 2)
    both = [rotated(ends, np.full(len(ends), s * swept_by)) for s in (-1, 1)]
    six = np.stack([*both, ends / np.cos(swept_by)], 1).reshape(-1, 6, 1, 2)
    points = (six + margin * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])).reshape(-1, 24, 2)
    swept = shapely.convex_hull(shapely.linestrings(points))
    try:
        left = _areas(shapely.difference(b, shapely.union_all(swept)))
        left = shapely.remove_repeated_points(left, 1e-3 * margin)
    except shapely.errors.GEOSException:
        left = shapely.multipolygons([])  # no core covers nothing: too little, never too much
    return shapely.transform(left, lambda p: rotated(p, np.full(len(p), middle)))


def uncovered(a: shapely.Geometry, b: shapely.Geometry, window: float) -> Pieces:
    """Pieces of the square of half-side `window` [mm] round the origin that no contact of A and B crosses.

    Every piece is wholly free or wholly forbidden, because a translation that is neither has a corner of one part on an
    edge of the other which that corner can touch from outside.
    """
    one, other = corners_of(a), corners_of(b)
    if not len(one[0]) or not len(other[0]):
        return np.array([shapely.box(-window, -window, window, window)], dtype=object)
    lines = np.concatenate([_contacts(one, other, 1.0, window), _contacts(other, one, -1.0, window)])
    w = window
    rim = np.array([[[-w, -w], [w, -w]], [[w, -w], [w, w]], [[w, w], [-w, w]], [[-w, w], [-w, -w]]])
    inside = shapely.box(-w, -w, w, w)
    try:
        noded = shapely.union_all(shapely.linestrings(np.concatenate([lines, rim])))
        pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    except shapely.errors.GEOSException:
        return np.array([inside], dtype=object)
    return pieces[shapely.intersects(inside, shapely.point_on_surface(pieces))]


def forbidden(a: shapely.Geometry, b: shapely.Geometry, pieces: Pieces, thin: float) -> NDArray[np.bool_]:
    """True for the pieces of `uncovered` where A and B certainly overlap; never for one thinner than `thin` [mm]."""
    spots = shapely.point_on_surface(pieces)
    deep = shapely.distance(spots, shapely.boundary(pieces)) > thin
    out = np.zeros(len(pieces), dtype=bool)
    shapely.prepare(a)
    for k in np.flatnonzero(deep):
        at = shapely.get_coordinates(spots[k])
        out[k] = bool(shapely.intersects(a, shapely.transform(b, lambda p, at=at: p + at)))
    return out


def _contacts(
    edges: tuple[Floats, Floats, Floats, Floats],
    corners: tuple[Floats, Floats, Floats, Floats],
    sign: float,
    window: float,
) -> Floats:
    """Lines (k, 2, 2) of translations at which a corner of one part lies on an edge of the other and can touch it there."""
    start, end, _, out = edges
    at, _, come, go = corners
    n = np.column_stack([out[:, 1], -out[:, 0]])
    can = (n @ go.T >= -ANGLE_TOLERANCE) & (n @ come.T <= ANGLE_TOLERANCE)
    for axis in (0, 1):
        one, two = sign * (start[:, axis, None] - at[:, axis]), sign * (end[:, axis, None] - at[:, axis])
        can &= (np.minimum(one, two) <= window) & (np.maximum(one, two) >= -window)
    i, j = np.nonzero(can)
    # always A's corner minus B's, so that contacts that end at the same place end at the same number
    lines = np.stack([start[i], end[i]], 1) - at[j, None] if sign > 0 else at[j, None] - np.stack([start[i], end[i]], 1)
    return _clipped(lines, 1.01 * window)


def _clipped(lines: Floats, window: float) -> Floats:
    """Lines cut off just outside the window, where their ends no longer matter; those that miss it are left out."""
    start, edge = lines[:, 0], lines[:, 1] - lines[:, 0]
    safe = np.where(edge == 0, 1.0, edge)
    one, two = (-window - start) / safe, (window - start) / safe
    flat = (edge == 0) & (np.abs(start) <= window)
    one, two = np.where(flat, -np.inf, np.minimum(one, two)), np.where(flat, np.inf, np.maximum(one, two))
    enter, leave = np.maximum(one.max(1), 0.0), np.minimum(two.min(1), 1.0)
    keep = enter < leave
    lines, start, edge = lines[keep], start[keep], edge[keep]
    enter, leave = enter[keep, None], leave[keep, None]
    return np.stack(
        [np.where(enter > 0, start + enter * edge, start), np.where(leave < 1, start + leave * edge, lines[:, 1])], 1
    )


def corners_of(geometry: shapely.Geometry) -> tuple[Floats, Floats, Floats, Floats]:
    """Corners (n, 2), the next ones, and unit directions in which the boundary comes and goes; material lies on the left."""
    corners, after = loops(geometry)
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    go = corners[after] - corners
    go = go / np.hypot(*go.T)[:, None]
    return corners, corners[after], go[before], go


def loops(geometry: shapely.Geometry) -> tuple[Floats, NDArray[np.int64]]:
    """Corners of all rings, material on the left, and the row of the next corner of each."""
    parts = shapely.get_parts(shapely.orient_polygons(geometry))
    rings = shapely.get_rings(parts)
    points, which = shapely.get_coordinates(rings, return_index=True)
    last = np.flatnonzero(np.diff(which, append=-1))
    keep = np.ones(len(points), dtype=bool)
    keep[last] = False
    which = which[keep]
    count = np.bincount(which, minlength=len(rings))
    first = np.cumsum(count) - count
    row = np.arange(len(which))
    after = np.where(row + 1 == (first + count)[which], first[which], row + 1)
    return points[keep], after


def _areas(geometry: shapely.Geometry) -> shapely.Geometry:
    """Only the polygons of a geometry."""
    parts = shapely.get_parts(geometry)
    parts = parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON]
    return shapely.multipolygons(parts)
