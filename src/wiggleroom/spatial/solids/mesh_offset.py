"""Meshes whose faces cannot all move inward and meet again: each corner moves as far as its faces let it.

Made is what is no nearer to the surface as drawn than half the gap, with mitres where faces meet in a sharp concave edge. A corner goes
where no face at it moves further, and where no triangle comes to lie deeper than that, so that the moved surface goes round all that is
made. Where it is less deep, the solid inside is larger than made.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface
from wiggleroom.errors import Stop, go_on
from wiggleroom.spatial.solids.face_planes import face_planes, shared_edges
from wiggleroom.spatial.solids.solid_angle import winding_numbers
from wiggleroom.spatial.solids.triangle_distances import nearest_triangles

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHARP = np.pi / 6
"""Concave edges that bend by more keep their mitre [rad]; elsewhere no place lies deeper than half the gap."""
MITRE = 3**0.5
"""Nowhere does a mitre go deeper than that of the corner of a box, as a multiple of half the gap."""
FLAT_SHARES = (1e-3, 0.1, 0.3, 0.6)
"""Singular values of the normals at a corner below these shares of the largest are taken for none: faces that are nearly parallel meet far
away, and where they end before they do a nearer place is better."""
LEAP = 2.0
"""What is further away than this factor of what is allowed is taken for no further at a time."""
HALVINGS = 20
"""How far a corner gets is found by so many halvings."""
MAX_SHORTER = 30
"""The corners of a triangle that goes too deep between them are moved less far so often."""
SHORTER = 1 - 1e-4
"""And by this factor further than seems enough."""
BEYOND = 1.01
"""Distances are found a little beyond the deepest that is allowed, as a factor."""
DEEP = 0.9
"""Corners less deep than this share of half the gap are moved away from the faces that they are too near to."""
MAX_MOVES = 30
"""They are moved so often."""
MAX_QUARTERS = 6
"""A corner that came out on another side goes a quarter of the way, so often."""
BLOCK = 250
"""Points, or triangles, whose distances are found together."""
WITHIN = np.array([(i, j, 3 - i - j) for i in range(4) for j in range(4 - i)]) / 3
"""Places on a triangle, as shares of its corners, whose depths are looked at."""
MOSTLY = 0.95
"""The share of the area for which it is said by how much the solid is larger."""


def mesh_offset(drawn: Surface, inward: float, stop: Stop | None = None) -> tuple[Surface, float, float] | None:
    """A closed surface round what lies `inward` [mm] or more below a surface, and by how much less deep it is.

    Returns
    -------
    Surface, float, float, or None
        One with the same faces, which may cross itself where these are smaller than they move; by how much [mm] it lies less deep than
        `inward` at most, and on 95 % of its area. None where there is none.
    """
    normal, _, label = face_planes(drawn)
    allowed = inward * _mitres(drawn, normal, label)
    near = _Near(drawn, BEYOND * float(allowed.max()), stop)
    shift = _shifts(drawn, normal, label, near, inward, allowed)
    limit = allowed[drawn.faces].max(axis=1)
    depth, some = np.empty((len(WITHIN), len(limit))), np.arange(len(limit))
    for _ in range(MAX_SHORTER):
        places = _places(drawn.vertices + shift, drawn.faces[some])
        depth[:, some] = near.distances(places.reshape(-1, 3))[0].reshape(len(WITHIN), -1)
        wrong = np.flatnonzero(depth.max(axis=0) > limit * (1 + 1e-6))
        if not len(wrong):
            break
        scale, ratio = (
            np.ones(len(shift)),
            SHORTER * limit[wrong] / np.minimum(depth[:, wrong].max(axis=0), LEAP * limit[wrong]),
        )
        for corner in drawn.faces[wrong].T:
            np.minimum.at(scale, corner, ratio)
        shift *= scale[:, None]
        some = np.flatnonzero((scale < 1)[drawn.faces].any(axis=1))
    else:
        return None
    order = np.argsort(depth, axis=None, kind="stable")
    a, b, c = near.triangles.transpose(1, 0, 2)
    area = np.cumsum(np.tile(np.linalg.norm(np.cross(b - a, c - a), axis=1), len(WITHIN))[order])
    mostly = depth.ravel()[order][np.searchsorted(area, (1 - MOSTLY) * area[-1])]
    moved = Surface(drawn.vertices + shift, drawn.faces)
    least = _least_distance(moved, near.triangles, inward, stop)
    return moved, inward - least, float(max(inward - mostly, 0.0))


class _Near:
    """Distances of points from a surface, as far as they are less than a reach [mm]."""

    def __init__(self, surface: Surface, reach: float, stop: Stop | None) -> None:
        self.triangles = surface.vertices[surface.faces]
        self._flat = np.argsort(np.ptp(surface.vertices, axis=0))[1:]
        self._low, self._high = self.triangles.min(axis=1) - reach, self.triangles.max(axis=1) + reach
        self._tree = shapely.STRtree(shapely.box(*self._low[:, self._flat].T, *self._high[:, self._flat].T))
        self._reach, self._stop = reach, stop

    def distances(self, points: Floats) -> tuple[Floats, Floats]:
        """Distances (p,) [mm], infinite beyond the reach, and unit vectors (p, 3) from the nearest place to the point."""
        from trimesh.triangles import closest_point

        found, away = np.full(len(points), np.inf), np.zeros((len(points), 3))
        for k in range(0, len(points), BLOCK):
            go_on(self._stop)
            some = points[k : k + BLOCK]
            point, triangle = self._tree.query(shapely.points(some[:, self._flat]))
            near = ((self._low[triangle] <= some[point]) & (some[point] <= self._high[triangle])).all(axis=1)
            point, triangle = point[near], triangle[near]
            step = some[point] - closest_point(self.triangles[triangle], some[point])
            far = np.linalg.norm(step, axis=1)
            order = np.lexsort((far, point))
            who, first = np.unique(point[order], return_index=True)
            best = order[first]
            found[k + who] = np.where(far[best] <= self._reach, far[best], np.inf)
            away[k + who] = step[best] / np.maximum(far[best], 1e-300)[:, None]
        return found, away

    def inside(self, points: Floats) -> NDArray[np.bool_]:
        """Which points lie inside the surface."""
        found = np.empty(len(points), dtype=bool)
        for k in range(len(points)):
            go_on(self._stop)
            found[k] = winding_numbers(self.triangles, points[k : k + 1])[0] > 0.5
        return found


def _least_distance(surface: Surface, triangles: Floats, reach: float, stop: Stop | None) -> float:
    """Least distance [mm] of a surface from triangles (t, 3, 3), or `reach` where that is less."""
    own, least = surface.vertices[surface.faces], reach
    for k in range(0, len(own), BLOCK):
        go_on(stop)
        _, _, p, q = nearest_triangles(own[k : k + BLOCK], triangles, least)
        least = min(least, float(np.linalg.norm(q - p, axis=1).min(initial=least)))
    return least


def _places(vertices: Floats, faces: Ints) -> Floats:
    """Places (10, f, 3) on all triangles."""
    return np.einsum("pc,fck->pfk", WITHIN, vertices[faces])


def _shifts(drawn: Surface, normal: Floats, label: Ints, near: _Near, inward: float, allowed: Floats) -> Floats:
    """How all corners move (v, 3), no further from the surface than allowed (v,) [mm]."""
    corner, plane = np.unique(np.column_stack([drawn.faces.ravel(), np.repeat(label, 3)]), axis=0).T
    first = np.searchsorted(corner, np.arange(len(drawn.vertices)))
    count = np.diff([*first.tolist(), len(plane)])
    best, shift = np.full(len(first), -np.inf), np.zeros_like(drawn.vertices)
    for flat in FLAT_SHARES:
        open_ = np.flatnonzero(best < DEEP * inward)
        if not len(open_):
            break
        way = _directions(normal, plane, first, count, flat)
        depth = np.minimum.reduceat(-np.einsum("kj,kj->k", normal[plane], way[corner]), first)[open_]
        far = _reached(drawn.vertices[open_], way[open_], near, inward, allowed[open_])
        better = far * depth > best[open_]
        best[open_[better]] = (far * depth)[better]
        shift[open_[better]] = (far[:, None] * way[open_])[better]

    def deepest(who: Ints, moved: Floats) -> Floats:
        """How deep some corners lie below the planes of their own faces at most [mm]."""
        at = [slice(first[v], first[v] + count[v]) for v in who]
        return np.array([-(normal[plane[own]] @ move).min() for own, move in zip(at, moved, strict=True)])

    return _deeper(drawn, shift, near, inward, deepest)


def _reached(start: Floats, way: Floats, near: _Near, inward: float, allowed: Floats) -> Floats:
    """How far points (k, 3) may go along ways (k, 3), `inward` at most, before they are too far from the surface."""
    far = np.full(len(start), inward)
    for _ in range(2):  # where the distance grows evenly this is enough
        ratio = near.distances(start + far[:, None] * way)[0] / allowed
        far /= np.clip(ratio * (1 - 1e-9), 1.0, LEAP)
    beyond = np.flatnonzero(near.distances(start + far[:, None] * way)[0] > allowed * (1 + 1e-9))
    low, high = np.zeros(len(beyond)), np.full(len(beyond), inward)
    for _ in range(HALVINGS if len(beyond) else 0):
        middle = (low + high) / 2
        reached = near.distances(start[beyond] + middle[:, None] * way[beyond])[0] <= allowed[beyond]
        low, high = np.where(reached, middle, low), np.where(reached, high, middle)
    far[beyond] = low
    return far


def _directions(normal: Floats, plane: Ints, first: Ints, count: Ints, flat: float) -> Floats:
    """How corners move (v, 3) so that none of their faces moves inward by more than 1, and all by nearly as much."""
    way = np.empty((len(first), 3))
    for k in np.unique(count).tolist():
        who = np.flatnonzero(count == k)
        N = normal[plane[first[who][:, None] + np.arange(k)]]
        step = -np.linalg.pinv(N, rcond=flat).sum(axis=2)
        most = -np.einsum("vij,vj->vi", N, step).min(axis=1)
        way[who] = step / np.maximum(most, 1e-3)[:, None]
    return way


def _mitres(drawn: Surface, normal: Floats, label: Ints) -> Floats:
    """How deep corners (v,) may come to lie, as multiples of what faces move: more than 1 at sharp concave edges."""
    ends, faces = shared_edges(drawn)
    one, other = normal[label[faces]].transpose(1, 0, 2)
    along = drawn.vertices[ends[:, 1]] - drawn.vertices[ends[:, 0]]
    half = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other)) / 2
    sharp = (np.einsum("ij,ij->i", np.cross(one, other), along) < 0) & (2 * half > SHARP)
    found = np.ones(len(drawn.vertices))
    mitre = np.minimum(1 / np.maximum(np.cos(half[sharp]), 1 / MITRE), MITRE)
    for end in ends[sharp].T:
        np.maximum.at(found, end, mitre)
    return found


def _deeper(
    drawn: Surface, shift: Floats, near: _Near, inward: float, deepest: Callable[[Ints, Floats], Floats]
) -> Floats:
    """The same shifts (v, 3), but for corners that come too near to other faces.

    They go away from these, as long as that helps and none of their own faces moves too far.
    """
    found = drawn.vertices + shift
    low = np.flatnonzero(near.distances(found)[0] < DEEP * inward)
    for k in range(MAX_QUARTERS):
        outside = low[~near.inside(found[low])]
        found[outside] = drawn.vertices[outside] + shift[outside] / 4 ** (k + 1)
    here, best = found[low], near.distances(found[low])[0]
    for _ in range(MAX_MOVES):
        if not len(low):
            break
        depth, away = near.distances(here)
        here = here + (inward - depth)[:, None] * away
        depth, inside = near.distances(here)[0], near.inside(here)
        level = deepest(low, here - drawn.vertices[low]) <= inward * (
            1 + 1e-9
        )  # else a face of its own would go too deep
        better = inside & level & (depth > best)
        best[better], found[low[better]] = depth[better], here[better]
        more = inside & (depth < DEEP * inward)
        low, here, best = low[more], here[more], best[more]
    return found - drawn.vertices
