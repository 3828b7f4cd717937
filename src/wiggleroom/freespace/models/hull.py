"""The paper's model of one pair: the convex hull of the free slices at nc, 0 and pc.

A stands; B is centred in its slice, then turned in place until it first touches, both ways: the angles nc and pc. The
slices at nc, 0 and pc are those pieces of the free translations that hold B. Their convex hull over (x, y, angle) is
neither inside nor outside the free space.

Open slices are made bounded and convex, as the paper does it: extend the nearby edges, or keep to the radius of its Lemma 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.scipy_extensions import qhull
from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.models.halfspaces import Halfspaces, seen_point, spread
from wiggleroom.freespace.models.pair_models import Hull
from wiggleroom.freespace.slices import PairOutlines, Slice, pair_outlines, parallelograms, slice_near, slice_sequence
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CONTACT_TOLERANCE = 1e-7
"""B touches where it is nearer than this share of the clearance at rest."""
MIN_CENTRING_GAIN = 1e-3
"""Rest is kept where no other place has this share more room."""
MAX_MARCH_STEPS = 2000
"""Steps of the march to the first touch at most."""

EDGE_REACH = 3.0
"""Edges of a slice no further from B's place than this multiple of the clearance are extended."""
AREA_TOLERANCE = 1e-9
"""Share of an area that rounding may add."""
TIE = 1e-9
"""Sides are equally near where their distances differ by less than this share of the window."""
BALL_CORNERS = 32
"""Corners of the polygon in the ball of Lemma 1."""


@dataclass(frozen=True, eq=False)
class PairHull:
    """Polyhedron N g + D <= 0 over (shift of the pivot, turn) of B against A.

    Parameters
    ----------
    normal : (m, 3) float64
    offset : (m,) float64 [mm]
    slices : tuple of Slice [mm]
        What it is the hull of: closed pieces as they are, open ones bounded.
    ends : (nc, pc) [rad]
    closed : bool
        True where all slices end by themselves.
    """

    normal: Floats
    offset: Floats
    slices: tuple[Slice, ...]
    ends: tuple[float, float]
    closed: bool


def pair_hull(pair: PairOutlines, model: Hull, reach: float) -> PairHull | None:
    """Hull of a pair at rest, or None where rest is not free.

    Parameters
    ----------
    pair : PairOutlines
        Its pivot is the point that B turns about.
    model : Hull
    reach : float [mm]
        Open slices are followed this far.

    Examples
    --------
    >>> from wiggleroom.freespace.slices import pair_outlines
    >>> peg, ring = shapely.box(-0.9, -0.9, 0.9, 0.9), shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1)
    >>> hull = pair_hull(pair_outlines(ring, peg), Hull(), reach=1.0)
    >>> len(hull.offset), round(hull.ends[1], 5)  # two pyramids on a square, a lid on each; 0.9 (cos + sin) = 1
    (10, 0.11839)

    Source: Mind the Gap, sections 4.1 and 4.2.
    """
    rest = slice_near(pair, 0.0, shapely.Point(0, 0))
    limit = np.inf
    if rest is not None and not rest.closed:
        limit = reach
        rest = slice_near(pair, 0.0, shapely.Point(0, 0), limit)
    if rest is None:
        return None
    centre = _centre(pair, rest)
    if model.slices == 3:
        ends = (_first_touch(pair, centre, -1.0), _first_touch(pair, centre, 1.0))
        found = [_slice(pair, phi, centre, limit) for phi in ends]
        slices = [found[0], rest, found[1]]
    else:
        space = slice_sequence(pair, reach)
        ends, limit = space.ends, space.limit
        angles = np.linspace(*ends, model.slices)
        slices = [s for phi in angles if (s := space.at(float(phi))) is not None]
    closed = all(s.closed for s in slices)
    slices = [s if s.closed else bounded(pair, s, centre, min(limit, pair.far)) for s in slices]
    return PairHull(*_polyhedron(slices, pair.clearance), tuple(slices), ends, closed)


def _centre(pair: PairOutlines, rest: Slice) -> Floats:
    """Translation (2,) [mm] that leaves B as much room as there is; open pairs are taken to rest there."""
    if not rest.closed:
        return np.zeros(2)
    widest = shapely.maximum_inscribed_circle(rest.region, tolerance=0.1 * MIN_CENTRING_GAIN * pair.clearance)
    here = shapely.distance(shapely.Point(0, 0), shapely.boundary(rest.region))
    if here >= (1 - MIN_CENTRING_GAIN) * shapely.length(widest):
        return np.zeros(2)
    return shapely.get_coordinates(widest)[0]


def _first_touch(pair: PairOutlines, centre: Floats, sense: float) -> float:
    """Angle [rad] up to which B turns about the pivot, moved to `centre`, before it first touches A; half a turn where it never does.

    No point of B moves further than radius times angle, so a turn by distance over radius is free.
    """
    a, b = pair.material
    angle = 0.0
    for _ in range(MAX_MARCH_STEPS):
        moved = shapely.transform(b, lambda p: rotated(p, np.array([sense * angle])) + centre)  # noqa: B023
        apart = float(shapely.distance(a, moved))
        if apart < CONTACT_TOLERANCE * pair.clearance or angle >= np.pi:
            break
        angle += apart / pair.radius
    return sense * min(angle, np.pi)


def _slice(pair: PairOutlines, phi: float, centre: Floats, limit: float) -> Slice:
    """Slice that holds B at `centre`; that one point where there is no more room than to touch on all sides."""
    spot = shapely.Point(centre)
    found = slice_near(pair, phi, spot, limit)
    if found is None and limit == np.inf:
        return Slice(phi, spot, True, 0.0)
    return found if found is not None else Slice(phi, spot, True, 0.0)


def _polyhedron(slices: list[Slice], clearance: float) -> tuple[Floats, Floats]:
    """Faces N (m, 3) and D (m,) of the convex hull of slices."""
    points = np.vstack(
        [np.insert(shapely.get_coordinates(shapely.convex_hull(s.region)), 2, s.angle, axis=1) for s in slices]
    )
    unit = np.array([clearance, clearance, np.abs(points[:, 2]).max()])
    equations = qhull().ConvexHull(points / unit).equations
    faces = np.unique(np.round(equations, 10), axis=0)  # triangles of one face are one row
    return faces[:, :3] * clearance / unit, faces[:, 3] * clearance


def bounded(pair: PairOutlines, one: Slice, spot: Floats, window: float) -> Slice:
    """Convex bounded part of an open slice round `spot` (2,) [mm], or round a point of the slice where it does not hold `spot`.

    The lines of the nearby edges cut the window; the piece that holds B is taken, unless it takes in forbidden space. Then the ball of
    Lemma 1 is, cut by the lines of the edges it could reach.

    Source: Mind the Gap, section 4.1; what counts as nearby, and the window, are ours.
    """
    region = one.region
    if not shapely.dwithin(region, shapely.Point(spot), AREA_TOLERANCE * window):
        spot = shapely.get_coordinates(shapely.point_on_surface(region))[0]
    piece = _extended(region, spot, EDGE_REACH * pair.clearance, window)
    if shapely.area(shapely.difference(piece, region)) > AREA_TOLERANCE * window**2 or not shapely.area(piece):
        piece = _ball(pair, one.angle, spot, window)
    return replace(one, region=piece, area=float(shapely.area(piece)))


def _extended(region: shapely.Geometry, spot: Floats, near: float, window: float) -> shapely.Polygon:
    """Piece of the window that holds `spot` between the lines of all edges nearby."""
    ring = _square(window)
    for part in shapely.get_parts(shapely.orient_polygons(region)):  # free space lies left of all edges
        for boundary in (part.exterior, *part.interiors):
            corners = shapely.get_coordinates(boundary)
            start, end = corners[:-1], corners[1:]
            rim = (np.abs(np.abs(start) - window) < AREA_TOLERANCE * window) & (
                np.abs(start - end) < AREA_TOLERANCE * window
            )
            lines = shapely.linestrings(np.stack([start, end], axis=1))
            solid = (
                np.hypot(*(end - start).T) > AREA_TOLERANCE * window
            )  # shorter edges are rounding and have no direction
            close = (shapely.distance(lines, shapely.Point(spot)) <= near) & ~rim.any(axis=1) & solid
            for k in np.flatnonzero(close):
                edge = end[k] - start[k]
                ring = _cut(ring, np.array([-edge[1], edge[0]]), start[k], spot)
    return shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon()


def _cut(ring: Floats, normal: Floats, at: Floats, spot: Floats) -> Floats:
    """What a line leaves of a convex polygon on the side of `spot`, or on the side of `normal` where the line meets `spot`."""
    size = np.hypot(*normal)
    if size == 0 or not len(ring):
        return ring
    n = normal / size
    if (spot - at) @ n < -1e-12 * max(1.0, np.abs(ring).max()):
        n = -n
    return clipped(ring, n, float(n @ at))


def clipped(ring: Floats, normal: Floats, off: float) -> Floats:
    """Part of a convex polygon (k, 2) where normal . x >= off."""
    height = ring @ normal - off
    after, rise = np.roll(ring, -1, axis=0), np.roll(height, -1)
    crosses = (height > 0) != (rise > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, height / (height - rise), 0.0)
    meets = ring + share[:, None] * (after - ring)
    rows = np.stack([ring, meets], axis=1).reshape(-1, 2)
    return rows[np.stack([height > 0, crosses], axis=1).ravel()]


def _ball(pair: PairOutlines, phi: float, spot: Floats, window: float) -> shapely.Polygon:
    """Ball of Lemma 1 round `spot`, cut by the line of the nearest side of every pair of edges.

    The radius is the least distance, over all pairs of edges, of an end of the side nearest to `spot`. Where a corner is nearest, both its
    sides are; the one whose line is further away is taken, as the other one may run through `spot` itself and leave nothing.
    """
    box = (*(spot - 2 * window), *(spot + 2 * window))
    quads = parallelograms(pair, phi, box)
    if not len(quads):
        return shapely.box(*(spot - window), *(spot + window))
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2)  # (k, 4, 2, 2)
    away = shapely.distance(shapely.linestrings(sides), shapely.Point(spot))
    along, to = np.moveaxis(sides[:, :, 1] - sides[:, :, 0], 2, 0), np.moveaxis(spot - sides[:, :, 0], 2, 0)
    beyond = np.abs(along[0] * to[1] - along[1] * to[0]) / np.hypot(*along)
    tied = away <= away.min(axis=1)[:, None] + TIE * window
    nearest = np.where(tied, beyond, -1.0).argmax(axis=1)
    side = sides[np.arange(len(quads)), nearest]
    radius = min(float(np.hypot(*(side - spot).transpose(2, 0, 1)).min()), window)
    angles = 2 * np.pi * np.arange(BALL_CORNERS) / BALL_CORNERS
    ring = spot + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    edge = side[:, 1] - side[:, 0]
    normal = np.column_stack([-edge[:, 1], edge[:, 0]]) / np.hypot(*edge.T)[:, None]
    off = (normal * side[:, 0]).sum(1)
    flip = (quads.mean(axis=1) * normal).sum(1) > off  # the pair meets on the other side
    normal[flip], off[flip] = -normal[flip], -off[flip]
    for k in np.flatnonzero(normal @ spot - off < radius):
        ring = clipped(ring, normal[k], float(off[k]))
    return (
        shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon(shapely.Point(spot).buffer(AREA_TOLERANCE * window))
    )


def _square(half: float) -> Floats:
    return half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@dataclass(frozen=True, eq=False)
class Hulls:
    """Hulls of P pairs: the faces of all, and the distinct hulls (C,) with the class (P,) of each pair."""

    faces: Halfspaces
    distinct: tuple[PairHull, ...]
    label: Ints


def hulls(
    bodies: Bodies,
    a: Ints,
    b: Ints,
    reference: Floats,
    model: Hull,
    motion: Floats | None = None,
    stop: Stop | None = None,
) -> Hulls | None:
    """Hull of every pair, worked out where the bodies lie now; None where two of them touch there.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
        Pairs.
    reference : (n, 2) float64 [mm]
        Reference point of every body in its own frame.
    model : Hull
    motion : (n, 3) float64 [mm, mm, rad], optional
        Where the bodies lie; by default at rest.
    stop : optional
        Asked before every pair.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    pose = relative_pose(bodies, a, b, motion)
    first, label = congruence_classes(bodies, a, b, pose)
    key = np.column_stack([label, np.round(reference[b] / (1e-9 * bodies.radius[b, None]))])
    _, first, label = np.unique(key, axis=0, return_index=True, return_inverse=True)
    label = label.ravel()
    geometry = placed(bodies, motion, np.unique(np.concatenate([a[first], b[first]])))
    where = bodies.rest if motion is None else bodies.rest + motion
    found, points = [], np.zeros((len(first), 2))
    for k, pair in enumerate(first):
        go_on(stop)
        one, other = int(a[pair]), int(b[pair])
        material = geometry[one], geometry[other]
        if model.about == "joint":
            pivot = joint_point(*material)
            points[k] = rotated(pivot - where[other, :2], np.array([-where[other, 2]]))[0]
        else:
            points[k] = reference[other]
            pivot = where[other, :2] + rotated(points[k], where[other, 2:])[0]
        own = [shapely.transform(g, lambda p: rotated(p - pivot, np.array([-where[one, 2]]))) for g in material]  # noqa: B023
        hull = pair_hull(pair_outlines(own[0], own[1]), model, float(bodies.radius[[one, other]].max()))
        if hull is None:
            return None
        found.append(hull)
    row, normal, offset = spread([(h.normal, h.offset) for h in found], label)
    point = points[label]
    return Hulls(Halfspaces(a, b, row, normal, offset, point, seen_point(pose, point)), tuple(found), label)


def joint_point(a: shapely.Geometry, b: shapely.Geometry) -> Floats:
    """Middle (x, y) [mm] of the material of b that lies near a."""
    near = shapely.intersection(b, shapely.buffer(a, 2 * shapely.distance(a, b)))
    return shapely.get_coordinates(shapely.centroid(near))[0]
