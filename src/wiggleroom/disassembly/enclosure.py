"""Which bodies lie in closed holes of others: what is enclosed never leaves, however it moves.

A point of a body that keeps clear of a wall stays in the same connected piece of what the wall leaves free. The middle of a disc inside the
body moreover keeps the disc's radius away from the wall: it stays in the same connected piece of what the wall, made thicker by that
radius, leaves free. Where such a piece is bounded, the body never leaves. So a closed hole holds, and so does one whose mouth is narrower
than the disc.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.offset_walls import hole_round, inner_offset

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DISC_MARGIN = 0.98
"""A disc counts with this share of its radius: buffers are polygons, and wrong by up to one part in a hundred."""
RADIUS_RATIO = 1.01
"""Radii are rounded down to powers of this: congruent bodies share a thickened wall."""
SURELY_LARGER = 1.03
"""A disc by this much larger that gets out shows that the disc itself does, though buffers are polygons."""
INSCRIBED_TOLERANCE = 1e-4
"""The middle of the largest disc in a body is found to this share of its size: any disc inside would do."""


@dataclass(frozen=True, eq=False)
class Disc:
    """A disc inside a body: `middle` (2,) [mm] and `radius` [mm]."""

    middle: Floats
    radius: float


@dataclass(frozen=True, eq=False)
class Enclosed:
    """Bodies that lie in closed holes of others.

    Parameters
    ----------
    pairs : (k, 2) int64
        Bodies that certainly never leave each other; all that stand count as one, named by the first of them.
    far : (n,) float64 [mm]
        Distance that no point of a body exceeds in any motion that starts at rest: zero for what stands, infinite where it is not known.
    held : (n,) bool
        True for what stands, and for bodies that certainly never turn half round in their hole.
    """

    pairs: Ints
    far: Floats
    held: NDArray[np.bool_]


class Wall:
    """Bodies of `group` that count as one obstacle, each time but for those that another body passes through (`ignored`)."""

    def __init__(self, geometry: NDArray[np.object_], group: Ints, ignored: Ints) -> None:
        self._geometry, self._group, self._ignored = geometry, group, ignored
        self._made: dict[tuple[bytes, float], shapely.Geometry] = {}

    def hole(self, b: int, disc: Disc, radius: float) -> shapely.Polygon | None:
        """What is left free round the middle of a disc in body b by the wall made thicker by up to `radius`, where it is bounded."""
        if disc.radius <= 0:  # its middle need not lie in the body
            return None
        n, group = len(self._geometry), self._group
        passed = np.isin(np.minimum(group, b) * n + np.maximum(group, b), self._ignored)
        thicker = RADIUS_RATIO ** np.floor(np.log(radius) / np.log(RADIUS_RATIO)) if radius > 0 else 0.0
        key = passed.tobytes(), thicker
        if key not in self._made:
            whole = shapely.union_all(self._geometry[group[~passed]])
            self._made[key] = whole if thicker == 0 else shapely.buffer(whole, thicker, quad_segs=8)
        return hole_round(self._made[key], disc.middle)


def enclosed(bodies: Bodies, geometry: NDArray[np.object_], ignored: Ints, context: Context = UNLIMITED) -> Enclosed:
    """Find the bodies that lie in closed holes of what stands, or of any other body; so what moves about something that stands, too.

    Parameters
    ----------
    bodies : Bodies
    geometry : (n,) shapely geometries
        Material at rest; no two overlap.
    ignored : (k,) int64
        Keys a * n + b of pairs that pass through each other.
    context : Context, optional
    """
    stands, movers = np.flatnonzero(bodies.fixed), np.flatnonzero(~bodies.fixed)
    far, held = np.where(bodies.fixed, 0.0, np.inf), bodies.fixed.copy()
    wall, pairs, discs = Wall(geometry, stands, ignored), [], {}
    for b in movers.tolist():
        if context.stopped:
            break
        body, disc = geometry[b], largest_disc(geometry[b])
        discs[b] = disc
        hole = wall.hole(b, disc, 0.0)
        if hole is not None and shapely.covers(hole, body):
            far[b], held[b] = _longest(hole, body), _too_long(hole, body)
        elif (hole := wall.hole(b, disc, DISC_MARGIN * disc.radius)) is not None:
            middle = shapely.Point(disc.middle)
            far[b] = _longest(hole, middle) + 2 * _longest(body, middle)
        if hole is not None:
            pairs.append((int(stands[0]), b))
    discs |= {b: largest_disc(geometry[b]) for b in stands.tolist()}
    loose = [b for b in discs if np.isinf(far[b]) or bodies.fixed[b]]
    points = shapely.points([discs[b].middle for b in loose]) if loose else np.zeros(0, dtype=object)
    inner, outer = shapely.STRtree(shapely.convex_hull(geometry[movers])).query(points, predicate="within")
    for k, a in zip(inner.tolist(), movers[outer].tolist(), strict=True):
        if context.stopped:
            break
        disc = discs[loose[k]]
        around = Wall(geometry, np.array([a]), ignored)
        if a != loose[k] and around.hole(loose[k], disc, DISC_MARGIN * disc.radius) is not None:
            pairs.append((a, loose[k]))
    return Enclosed(np.array(pairs, dtype=np.int64).reshape(-1, 2), far, held)


def enclosed_by_held(
    geometry: NDArray[np.object_], group: Ints, ignored: Ints, far: float, context: Context = UNLIMITED
) -> Ints:
    """Bodies that bodies held together enclose, though these can move a little.

    Where no point of a wall gets further than `far`, the wall made thicker by a radius always covers the wall at rest made thicker by that
    radius less `far`. So a disc counts with a radius that is smaller by `far`.

    Parameters
    ----------
    geometry : (n,) shapely geometries
        Material at rest; no two overlap.
    group : (k,) int64
        The wall: bodies of which no point gets further than `far` [mm] from where it is at rest.
    ignored
        As for `enclosed`.
    context : Context, optional
    """
    wall, found = Wall(geometry, group, ignored), []
    for b in np.setdiff1d(np.arange(len(geometry)), group).tolist():
        if context.stopped:
            break
        disc = largest_disc(geometry[b])
        radius = DISC_MARGIN * disc.radius - far
        if radius > 0 and wall.hole(b, disc, radius) is not None:
            found.append(b)
    return np.array(found, dtype=np.int64)


def cages(wall: shapely.Geometry, body: shapely.Geometry) -> bool:
    """True where a body, or that piece of it that lies among the wall, has a head that is certainly too thick for its mouth.

    Examples
    --------
    >>> import shapely
    >>> socket = shapely.box(0, 0, 9, 9) - shapely.box(2, 2, 7, 5) - shapely.box(4, 5, 5, 9)
    >>> cages(socket, shapely.box(3, 2.5, 6, 4.5) | shapely.box(4.2, 4.5, 4.8, 20))
    True
    """
    for piece in (body, *shapely.get_parts(shapely.intersection(body, shapely.convex_hull(wall)))):
        disc = largest_disc(piece) if shapely.area(piece) > 0 else None
        if disc is None or disc.radius <= 0 or _leads_out(wall, disc):
            continue
        if hole_round(inner_offset(wall, disc.radius), disc.middle) is not None:
            return True
    return False


def _leads_out(wall: shapely.Geometry, disc: Disc) -> bool:
    """True where even a disc that is a little larger gets out from among the wall, which is quick to see and ends most questions."""
    thicker = shapely.buffer(wall, SURELY_LARGER * disc.radius, quad_segs=8)
    inside = bool(shapely.contains_xy(thicker, *disc.middle))
    return not inside and hole_round(thicker, disc.middle) is None


def largest_disc(body: shapely.Geometry) -> Disc:
    """The largest disc inside, nearly."""
    x0, y0, x1, y1 = shapely.bounds(body)
    spoke = shapely.maximum_inscribed_circle(body, INSCRIBED_TOLERANCE * max(x1 - x0, y1 - y0))
    middle = shapely.get_coordinates(spoke)[0]
    inside = bool(shapely.contains_xy(body, *middle))
    return Disc(middle, float(shapely.distance(shapely.Point(middle), shapely.boundary(body))) if inside else 0.0)


def _longest(one: shapely.Geometry, other: shapely.Geometry) -> float:
    """Largest distance between a point of one and a point of the other [mm]."""
    a, b = (shapely.get_coordinates(shapely.convex_hull(g)) for g in (one, other))
    return float(np.hypot(*(a[:, None] - b).transpose(2, 0, 1)).max())


def _too_long(hole: shapely.Polygon, body: shapely.Geometry) -> bool:
    """True where the body is longer than its hole is wide: to turn half round it would have to lie across."""
    room = shapely.get_coordinates(shapely.convex_hull(hole))
    along = np.diff(room, axis=0)
    across = room @ (np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]).T
    return bool(_longest(body, body) > np.ptp(across, axis=0).min())
