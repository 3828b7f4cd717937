"""A round body among others that stand: where its middle gets, whatever its turn, and how far that carries the points that are pulled.

While a disc inside the body is kept out of the walls, its middle stays in one piece of what the walls, made thicker by the disc's radius,
leave free: a bound. A disc round the body that keeps out of them may turn as it likes: a motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.subdivision.passage import rounding_slack
from wiggleroom.geometry.offset_walls import CHORD_ANGLE, grid_size, hole_round, inner_offset
from wiggleroom.geometry.outer_simplification import simplified_inward

Floats = NDArray[np.float64]

MIN_CORNERS = 12
"""A body of fewer corners is not round."""
TOLERANCE, FINE_TOLERANCE = 0.02, 1e-4
"""For a bound, outlines of walls are moved back by up to this share of the clearance, and by this where it is at its furthest."""
MAX_REFINEMENTS = 8
"""Walls are refined at most this many times."""
PATH_MARGIN = 0.01
"""A path keeps this share of the clearance away from the walls."""
WINDOW = 3.0
"""What is free is followed to a square of so many times the size of all."""


@dataclass(frozen=True, eq=False)
class RoundBody:
    """Discs about the middle of a body.

    Parameters
    ----------
    middle : (2,) float64 [mm]
    inner, outer : float [mm]
        Radii of the largest disc inside, and of the smallest round it.
    """

    middle: Floats
    inner: float
    outer: float


def round_body(body: shapely.Geometry, walls: shapely.Geometry, clearance: float) -> RoundBody | None:
    """The discs of a body that is round to the clearance [mm] and has no wall in its holes; None where it is not."""
    if body.geom_type != "Polygon" or len(body.exterior.coords) <= MIN_CORNERS:
        return None
    filled = shapely.Polygon(body.exterior)
    middle = shapely.get_coordinates(shapely.centroid(filled))[0]
    outer = float(np.hypot(*(shapely.get_coordinates(filled) - middle).T).max())
    inner = float(shapely.distance(shapely.Point(middle), filled.exterior))
    if outer - inner > clearance or shapely.intersects(filled, walls):
        return None
    return RoundBody(middle, inner, outer)


def furthest_along(body: RoundBody, walls: shapely.Geometry, pull: Floats, clearance: float) -> float | None:
    """How far the middle of a body gets along a pull at most, times the length of that; None where it may get out of the walls.

    Walls of many corners are given fewer, a little further back, but hardly where the disc meets them at its furthest.
    """
    slack = 2 * rounding_slack(walls, shapely.Point(body.middle).buffer(body.outer))
    near, most = np.zeros((0, 2)), np.inf
    for _ in range(MAX_REFINEMENTS):
        fewer = simplified_inward(walls, clearance, TOLERANCE * clearance, near, FINE_TOLERANCE * clearance)
        hole = hole_round(inner_offset(fewer, body.inner - slack), body.middle)
        if hole is None:
            return None
        corners = shapely.get_coordinates(hole)
        between = (corners[:-1] + corners[1:]) / 2
        if shapely.distance(fewer, shapely.points(np.vstack([corners, between]))).max() > body.inner:
            return None  # rounding has made the walls thicker than they are
        along = (corners - body.middle) @ pull
        if along.max() >= most:
            break
        most = float(along.max())
        met = shapely.Point(corners[along.argmax()]).buffer(body.inner + TOLERANCE * clearance)
        places = shapely.get_parts(shapely.intersection(fewer, met))
        near = np.concatenate([near, *(_nearest(place, corners[along.argmax()]) for place in places)])
    return most + slack * float(np.hypot(*pull))


def way_along(body: RoundBody, walls: shapely.Geometry, pull: Floats, clearance: float) -> Floats | None:
    """Places (k, 2) [mm] of the middle of a body on a way along a pull, as far as it leads; None where the body cannot turn at rest.

    Along the pull to a wall, along that to its furthest point, and on, up to the furthest point of all.
    """
    margin = PATH_MARGIN * clearance
    reach = body.outer + margin
    thick = inner_offset(walls, (reach + margin + 3 * grid_size(walls)) / np.cos(CHORD_ANGLE / 2))
    x0, y0, x1, y1 = shapely.bounds(walls)
    far = WINDOW * max(x1 - x0, y1 - y0)
    room = hole_round(thick, body.middle) or shapely.Point(body.middle).buffer(far, quad_segs=1)
    pieces = shapely.get_parts(shapely.difference(room, thick))
    free = next((piece for piece in pieces if shapely.contains_xy(piece, *body.middle)), None)
    if free is None:
        return None
    return _fewer(_bug_path(free, body.middle, pull, far), walls, reach)


def _bug_path(free: shapely.Polygon, begin: Floats, pull: Floats, far: float) -> Floats:
    """Straight along the pull from `begin`, round what is met to its furthest point, and on, up to the edge of all that is free.

    Source: Lumelsky and Stepanov, "Path-planning strategies for a point mobile automaton" (1987), with the map known.
    """
    along = 2 * far * pull / np.hypot(*pull)
    path, at = [begin[None]], begin
    rings = [free.exterior, *free.interiors]
    left = dict(enumerate(rings))
    while left:
        ray = shapely.LineString([at, at + along])
        met = [
            (float((place - at) @ pull), k, place)
            for k, ring in left.items()
            for place in shapely.get_coordinates(shapely.intersection(ray, ring))
        ]
        if not met:
            break
        _, k, place = min(met, key=lambda one: one[:2])
        ring = shapely.get_coordinates(left.pop(k))
        ring = np.roll(ring[:-1], -_edge_of(ring, place), axis=0)
        best = int((ring @ pull).argmax())
        path += [place[None], ring[: best + 1] if best <= len(ring) / 2 else ring[: best - 1 : -1]]
        at = ring[best]
        if k == 0:
            break
    return np.concatenate(path)


def _edge_of(ring: Floats, place: Floats) -> int:
    """Number of the corner at the end of the edge of a closed ring (k, 2) on which a place lies."""
    edges = shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1))
    return (int(shapely.distance(edges, shapely.Point(place)).argmin()) + 1) % (len(ring) - 1)


def _fewer(path: Floats, walls: shapely.Geometry, reach: float) -> Floats:
    """The path without the corners that it does not need to keep `reach` [mm] away from the walls."""
    shapely.prepare(walls)
    kept, k = [0], 0
    while k < len(path) - 1:
        step = len(path) - 1 - k
        while step > 1 and shapely.dwithin(walls, shapely.LineString(path[[k, k + step]]), reach):
            step //= 2
        k += step
        kept.append(k)
    return path[kept]


def _nearest(wall: shapely.Geometry, point: Floats) -> Floats:
    """The point (1, 2) of a wall that is nearest to another."""
    return shapely.get_coordinates(shapely.shortest_line(wall, shapely.Point(point)))[:1]
