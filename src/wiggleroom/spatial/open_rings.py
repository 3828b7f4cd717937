"""Bodies linked although one is an open ring, as with a C hook in a closed eye, whose opening the other's material is too thick to pass.

A closed curve follows the material of the open ring and goes straight across its opening. Where its linking number with a closed curve in
the other body is not 0, the bodies part only if the curves cross. Material does not cross material; and where a point of the other curve is
in the opening, one end of that is nearer than half its width, inside a ball of material about the point: the bodies overlap.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.spatial.linking_number import SAME_PLANE, CurveGraph, linked, piece_graph
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.solids.convex import ConvexPiece
from wiggleroom.spatial.solids.face_planes import face_planes
from wiggleroom.spatial.solids.spatial_model import Surface

if TYPE_CHECKING:
    import networkx as nx

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FACING = 0.9
"""Faces look at each other across an opening where the cosine between their normals and the line between them is larger."""
COVERED = 1.02
"""Balls inside the material are larger than half the opening by this factor."""
SAMPLES, MOVES = 800, 60
"""The distance of a curve from the surface is worked out at so many points of it, which are moved so often at most."""
ROUNDED = 9
"""Points of a curve that agree to so many decimals are one [mm]."""
MAX_OPENINGS = 4
"""Of more openings of a body the narrowest are looked at."""


@dataclass(frozen=True, eq=False)
class Opening:
    """An opening of a body.

    Parameters
    ----------
    ends : (2, 3) float64 [mm]
        Middles of two faces that look at each other.
    """

    ends: Floats

    @property
    def width(self) -> float:
        """Distance of its ends [mm]."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))


@dataclass(frozen=True, eq=False)
class RingBody:
    """A body at rest whose openings are looked at.

    Parameters
    ----------
    pieces : sequence of ConvexPiece
    surfaces : sequence of Surface
        Of its parts: a ball that touches none of them, about a point of the material, is inside.
    closed : CurveGraph
        Closed curves in its material.
    """

    pieces: Sequence[ConvexPiece]
    surfaces: Sequence[Surface]
    closed: CurveGraph

    @cached_property
    def graph(self) -> nx.Graph:
        """Pieces that hang together."""
        return piece_graph(self.pieces)


def held_by_opening(ring: RingBody, other: RingBody, stop: Stop | None = None) -> bool:
    """True where a curve through an opening of a ring is linked with closed curves in another body, which is too thick to pass it."""
    if not len(other.closed.cycles):
        return False
    for opening in _openings(ring):
        if stop is not None and stop.is_set():
            return False
        through = _curve_through(ring, opening)
        if through is None or not linked(through, other.closed):
            continue
        inner = _inner_curves(other, COVERED / 2 * opening.width)
        if inner is not None and linked(through, inner):
            return True
    return False


def _openings(body: RingBody) -> list[Opening]:
    """Narrowest openings between two faces of one part."""
    found = []
    for surface in body.surfaces:
        middle, normal = _faces(surface)
        for i in range(len(middle) - 1):
            across = middle[i + 1 :] - middle[i]
            width = np.linalg.norm(across, axis=1)
            least = FACING * width
            ahead = (across @ normal[i] > least) & (np.einsum("kd,kd->k", across, -normal[i + 1 :]) > least)
            facing = np.flatnonzero(ahead)
            nearest = facing[np.argsort(width[facing], kind="stable")[:MAX_OPENINGS]]
            found += [Opening(middle[[i, j]]) for j in (i + 1 + nearest).tolist()]
    return sorted(found, key=lambda opening: opening.width)[:MAX_OPENINGS]


def _faces(surface: Surface) -> tuple[Floats, Floats]:
    """Middles (f, 3) [mm] and outward unit normals (f, 3) of the flat faces of a surface that have an area."""
    normal, _, face = face_planes(surface)
    corners = surface.vertices[surface.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weighted = area[:, None] * corners.mean(axis=1)
    moment = np.column_stack([np.bincount(face, along, len(normal)) for along in weighted.T])
    total = np.bincount(face, area, len(normal))
    some = total > 0
    return moment[some] / total[some, None], normal[some]


def _curve_through(body: RingBody, opening: Opening) -> CurveGraph | None:
    """A closed curve across an opening and through the material; None where there is none."""
    import networkx as nx

    begin, end = opening.ends
    i, j = (next((k for k, p in enumerate(body.pieces) if _holds(p, point)), -1) for point in (begin, end))
    if i < 0 or j < 0 or not nx.has_path(body.graph, i, j):
        return None
    chain = nx.shortest_path(body.graph, i, j)
    points = [begin]
    for k, (p, q) in enumerate(itertools.pairwise(chain)):
        points += [body.pieces[p].corners.mean(axis=0)] * (k > 0) + [body.graph.edges[p, q]["shared"]]
    ring = np.array([*points, end])
    segments = np.stack([np.roll(ring, 1, axis=0), ring], axis=1)
    return CurveGraph(segments, np.ones((1, len(segments)), dtype=np.int64))


def _holds(piece: ConvexPiece, point: Floats) -> bool:
    """True where a point (3,) is in a convex piece, but for rounding."""
    heights, level = piece.corners @ piece.normals.T, piece.normals @ point
    near = SAME_PLANE * float(np.ptp(piece.corners, axis=0).max())
    return bool((level <= heights.max(axis=0) + near).all() and (level >= heights.min(axis=0) - near).all())


def _inner_curves(body: RingBody, radius: float) -> CurveGraph | None:
    """The closed curves of a body moved so that balls of a radius [mm] round all their points are inside; None where that fails.

    Points move away from what is nearest on the surface; curves that get longer are cut anew.
    """
    used = body.closed.cycles.any(axis=0)
    segments, cycles = body.closed.segments[used], body.closed.cycles[:, used]
    step = float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()) / SAMPLES
    triangles = np.ascontiguousarray(np.vstack([s.vertices[s.faces] for s in body.surfaces]))
    for _ in range(MOVES):
        length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        count = np.maximum(np.ceil(length / step), 1).astype(np.int64)
        if count.sum() > 4 * SAMPLES:
            return None
        cycles, segments = np.repeat(cycles, count, axis=1), _subdivided(segments, count)
        points, where = np.unique(segments.reshape(-1, 3).round(ROUNDED), axis=0, return_inverse=True)
        away = np.empty_like(points)
        room = surface_distances(triangles, points, away)
        length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        if (room[where].reshape(-1, 2).min(axis=1) - length / 2 >= radius).all():
            return CurveGraph(points[where].reshape(-1, 2, 3), cycles)
        lacks = np.clip(radius + step - room, 0.0, np.minimum(room, radius) / 4)
        segments = (points + lacks[:, None] * away)[where].reshape(-1, 2, 3)
    return None


def _subdivided(segments: Floats, count: Ints) -> Floats:
    """Segments (s, 2, 3), each cut into as many equal ones as a count (s,) says."""
    whole, number = np.repeat(segments, count, axis=0), np.repeat(count, count)[:, None]
    place = (np.arange(len(whole)) - np.repeat(np.cumsum(count) - count, count))[:, None]
    along = whole[:, 1] - whole[:, 0]
    return np.stack([whole[:, 0] + place / number * along, whole[:, 0] + (place + 1) / number * along], axis=1)
