"""Slanted sides of outer slices: walls that hold at every turn of an interval.

An outer slice is too large by what B's edges sweep. Where one of its sides comes from a corner of one part and an edge
of the other, the true side moves with the turn. It may be used if, wherever the slice reaches beyond it, that corner lies
*inside* the other part: then nothing free is cut off. Such walls bend so little over an interval that the prism of a slice
becomes a polyhedron which is too large only by terms of second order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.freespace.outer.outer_slices import PairMaterial, Pieces, corners_of
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_CONTACTS_PER_SIDE = 3
"""Number of contacts that are tried for each side."""
MIN_HULL_AREA = 1e-6
"""A hull of less area than this share of its length squared is replaced by its box."""
NORMAL_TOLERANCE = 1e-8
"""Planes whose normals differ by less are left to others."""


def polyhedron(material: PairMaterial, near: PairMaterial, low: float, high: float, pieces: Pieces) -> Floats:
    """Corners (n, 3) [mm, mm, rad] of a polyhedron that holds all that is free of `pieces` at turns between `low` and `high`."""
    region = shapely.multipolygons(pieces)
    hull = shapely.convex_hull(region)
    if shapely.area(hull) < MIN_HULL_AREA * shapely.length(hull) ** 2:
        hull = shapely.envelope(shapely.buffer(hull, material.margin))
    ring = shapely.get_coordinates(shapely.orient_polygons(hull))
    along = np.diff(ring, axis=0)
    long = np.hypot(*along.T)
    start, along, long = ring[:-1][long > 0], along[long > 0], long[long > 0]
    out = np.column_stack([along[:, 1], -along[:, 0]]) / long[:, None]
    flat = np.column_stack([out, np.zeros(len(out)), (out * start).sum(1)])
    try:
        slanted = _walls(material, near, low, high, region, _Sides(start + along / 2, out, long))
    except shapely.errors.GEOSException:
        slanted = []
    for planes in (np.vstack([flat, *slanted]), flat):
        planes[:, 3] += material.margin
        corners = corners_between(planes, low, high)
        if len(corners):
            break
    return corners


@dataclass(frozen=True, eq=False)
class _Sides:
    """Sides of a polygon: their middles (k, 2), outward normals (k, 2) and lengths (k,)."""

    at: Floats
    out: Floats
    long: Floats


def _walls(
    material: PairMaterial,
    near: PairMaterial,
    low: float,
    high: float,
    region: shapely.Geometry,
    sides: _Sides,
) -> list[Floats]:
    """Planes (normal, slope by turn, offset) of walls that lie near some sides and hold throughout."""
    at, out, long = sides.at, sides.out, sides.long
    middle, half = (low + high) / 2, (high - low) / 2 * (1 + 1e-9) + 1e-14
    a, b = corners_of(near.a), corners_of(near.b)
    seen = tuple(rotated(v, np.full(len(v), middle)) for v in b)
    spots = shapely.get_coordinates(region)
    width = float(np.hypot(*np.ptp(spots, axis=0)))
    reach = 2 * np.sin(half / 2)
    tried: dict[tuple[int, ...], Floats | None] = {}
    for kind, (edges, corners, wall) in enumerate(((a, seen, _corner_of_b), (seen, a, _corner_of_a))):
        sign = 1.0 if kind == 0 else -1.0
        start, end, _, go = edges
        corner, _, come, away = corners
        normal = np.column_stack([go[:, 1], -go[:, 0]])
        alike = -sign * normal @ out.T > 1 - 0.51 * (2 * half + 1e-6) ** 2
        for side in np.flatnonzero(long > 1e-3 * material.clearance):
            rows = np.flatnonzero(alike[:, side])
            n, e = normal[rows], go[rows]
            place = corner + sign * at[side]
            room = n @ place.T - (n * start[rows]).sum(1)[:, None]
            foot = e @ place.T
            lever = np.hypot(*(corner.T if kind == 0 else place.T))
            can = (n @ away.T >= -reach) & (n @ come.T <= reach) & (np.abs(room) <= 3 * reach * lever + material.margin)
            can &= foot >= (e * start[rows]).sum(1)[:, None] - width
            can &= foot <= (e * end[rows]).sum(1)[:, None] + width
            i, j = np.nonzero(can)
            for k in np.argsort(room[i, j])[:MAX_CONTACTS_PER_SIDE]:
                edge, v = int(rows[i[k]]), int(j[k])
                if (kind, edge, v) in tried:
                    continue
                points = [corner[v]]
                # where the corner may slip off the end of the edge, a point of the side that lies along it takes its place
                points += [corner[v] + width * w for w in (away[v], -come[v]) if abs(normal[edge] @ w) <= reach]
                for point in points:
                    plane = wall(material, low, high, region, normal[edge], start[edge], point)
                    tried[kind, edge, v] = plane
                    if plane is not None:
                        break
    return [p for p in tried.values() if p is not None]


def _corner_of_b(
    material: PairMaterial, low: float, high: float, region: shapely.Geometry, n: Floats, a: Floats, v: Floats
) -> Floats | None:
    """Wall of A's edge (a, n) and B's corner v, turned to the middle: n . (tau + R v - a) >= 0."""
    half = (high - low) / 2 * (1 + 1e-9) + 1e-14
    ends = [rotated(v, np.array([t]))[0] for t in (-half, half)]
    swept = np.array([*ends, v / np.cos(half)])
    beyond = _beyond(region, -n, float((swept @ n).min() - n @ a), material.margin)
    for part in shapely.get_parts(beyond):
        places = (shapely.get_coordinates(part)[:, None] + swept).reshape(-1, 2)
        if not _inside(material.a, places, n, a, material.margin):
            return None
    c = [float(n @ a - n @ v) for v in ends]
    return _plane(-n, [-c[0], -c[1]], low, high, float(np.hypot(*v)), material.margin)


def _corner_of_a(
    material: PairMaterial, low: float, high: float, region: shapely.Geometry, n: Floats, b: Floats, u: Floats
) -> Floats | None:
    """Wall of B's edge (b, n), turned to the middle, and A's corner u: R n . (u - tau) >= R n . R b."""
    half = (high - low) / 2 * (1 + 1e-9) + 1e-14
    middle = (low + high) / 2
    spots = shapely.get_coordinates(shapely.convex_hull(region))
    far = float(np.hypot(*(u - spots).T).max())
    beyond = _beyond(region, n, float(n @ u - n @ b) - 2 * np.sin(half / 2) * far, material.margin)
    for part in shapely.get_parts(beyond):
        seen = u - shapely.get_coordinates(part)
        places = np.vstack([*(rotated(seen, np.full(len(seen), t)) for t in (-half, half)), seen / np.cos(half)])
        back = rotated(places, np.full(len(places), -middle))
        m, start = rotated(np.stack([n, b]), np.full(2, -middle))
        if not _inside(material.b, back, m, start, material.margin):
            return None
    centre = (spots.min(0) + spots.max(0)) / 2
    round_it = float(np.hypot(*(spots - centre).T).max())
    normals = [rotated(n, np.array([t]))[0] for t in (-half, half)]
    mean = (normals[0] + normals[1]) / 2
    # n(t) . (u - tau) >= n . b, about the slice's middle
    level = [float(m @ (u - centre) - n @ b + mean @ centre) for m in normals]
    return _plane(mean, level, low, high, far, material.margin + np.sin(half) * round_it)


def _plane(normal: Floats, level: list[float], low: float, high: float, bend: float, more: float) -> Floats:
    """Normal . tau <= the straight line from level[0] at `low` to level[1] at `high`, and what second derivatives up to `bend` add."""
    slope = (level[1] - level[0]) / (high - low)
    room = bend * (high - low + 1e-13) ** 2 / 8 * (1 + 1e-9) + 2 * more
    return np.array([[*normal, -slope, level[0] - slope * low + room]])


def _beyond(region: shapely.Geometry, n: Floats, level: float, margin: float) -> Pieces:
    """Hulls of what of `region` has n . tau >= level, and a little more."""
    size = 10 * float(np.abs(shapely.bounds(region)).max()) + abs(level)
    parts = shapely.get_parts(shapely.intersection(region, _half_plane(n * (level - margin), n, size)))
    return shapely.convex_hull(parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON])


def _half_plane(foot: Floats, n: Floats, size: float) -> shapely.Polygon:
    """What lies beyond `foot` in the direction `n`, as far as `size`."""
    side = np.array([-n[1], n[0]])
    return shapely.polygons(foot + size * np.array([-side, side, side + n, n - side]))


def _inside(material: shapely.Geometry, places: Floats, n: Floats, at: Floats, margin: float) -> bool:
    """Whether the hull of `places`, as far as it lies behind the line (at, n), lies in the material."""
    spread = margin / 4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    hull = shapely.convex_hull(shapely.multipoints((places[:, None] + spread).reshape(-1, 2)))
    side, middle = np.array([-n[1], n[0]]), places.mean(0)
    size = 10 * float(np.abs(places - middle).max() + np.abs(at - middle).max() + margin)
    foot = n * (n @ at - margin) + side * (side @ middle)
    behind = shapely.intersection(hull, _half_plane(foot, -n, size))
    return bool(shapely.is_empty(behind) or shapely.covers(material, behind))


def corners_between(planes: Floats, low: float, high: float) -> Floats:
    """Corners of {(tau, t): planes[:, :3] . (tau, t) <= planes[:, 3], low <= t <= high}: ends of the lines in which two planes meet."""
    return np.unique(_corners_between(planes, low, high), axis=0)


@njit(**OPTIONS)
def _corners_between(planes: Floats, low: float, high: float) -> Floats:
    count, found = len(planes), 0
    out = np.empty((count * (count - 1), 3))
    for i in range(count):
        for j in range(i + 1, count):
            det = planes[i, 0] * planes[j, 1] - planes[i, 1] * planes[j, 0]
            if abs(det) <= NORMAL_TOLERANCE:
                continue
            # along the line tau = fixed + moving t; every plane k leaves t with gain t <= room
            fixed_x = (planes[i, 3] * planes[j, 1] - planes[j, 3] * planes[i, 1]) / det
            fixed_y = (planes[i, 0] * planes[j, 3] - planes[j, 0] * planes[i, 3]) / det
            moving_x = (planes[j, 2] * planes[i, 1] - planes[i, 2] * planes[j, 1]) / det
            moving_y = (planes[j, 0] * planes[i, 2] - planes[i, 0] * planes[j, 2]) / det
            slack = 1e-13 * (1 + max(abs(fixed_x), abs(fixed_y)))
            first, last = low, high
            for k in range(count):
                if k in (i, j):
                    continue
                gain = moving_x * planes[k, 0] + moving_y * planes[k, 1] + planes[k, 2]
                room = planes[k, 3] - fixed_x * planes[k, 0] - fixed_y * planes[k, 1]
                if gain > 1e-15:
                    last = min(last, room / gain)
                elif gain < -1e-15:
                    first = max(first, room / gain)
                elif room < -slack:
                    first = np.inf
                if first > last + 1e-13 * (high - low):
                    break
            if first <= last + 1e-13 * (high - low):
                for t in (first, last):
                    out[found] = fixed_x + moving_x * t, fixed_y + moving_y * t, t
                    found += 1
    return out[:found]


def cut_corners(
    corner: Floats, which: Ints, starts: Floats, ends: Floats, low: float, high: float
) -> tuple[Floats, Ints]:
    """Corners (N, 3) of convex polyhedra over intervals of turns, cut to turns between `low` and `high`; and the interval of each.

    `which` (N,) is the interval of each corner, from `starts` to `ends` (K,) [rad].
    """
    inside = (starts[which] >= low) & (ends[which] <= high)
    found, interval = [corner[inside]], [which[inside]]
    for k in np.flatnonzero((starts <= high) & (ends >= low) & ((starts < low) | (ends > high))):
        cut = _cut(corner[which == k], low, high)
        found.append(cut)
        interval.append(np.full(len(cut), k))
    return np.vstack(found), np.concatenate(interval)


def _cut(corner: Floats, low: float, high: float) -> Floats:
    """Corners (and a few points more) of what a convex polyhedron has at turns between `low` and `high`."""
    t = corner[:, 2]
    found = [corner[(t >= low) & (t <= high)]]
    for level in (low, high):
        below, above = corner[t <= level], corner[t >= level]
        if len(below) and len(above):
            one, other = np.repeat(below, len(above), 0), np.tile(above, (len(below), 1))
            rise = other[:, 2] - one[:, 2]
            share = np.where(rise > 0, (level - one[:, 2]) / np.where(rise > 0, rise, 1.0), 0.0)
            found.append(
                np.column_stack([one[:, :2] + share[:, None] * (other - one)[:, :2], np.full(len(one), level)])
            )
    return np.vstack(found)
