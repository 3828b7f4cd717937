"""Bodies linked although one is an open ring, as with a C hook or two glued halves, whose openings the other is too thick to pass.

A closed curve follows the material of the open ring and goes straight across its openings, where it is nowhere farther from that material
than some width. Where its linking number with a closed curve in the other body is not 0, the bodies part only if the curves cross.
Material does not cross material; and where a point of the other curve is in an opening, material of the ring is nearer than that width,
inside a ball of material about the point: the bodies overlap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece, Surface
from wiggleroom.spatial.inscribed_ball import inscribed_ball
from wiggleroom.spatial.linking_number import (
    CurveGraph,
    closed_curves,
    linked,
    links,
    near_pairs,
    piece_graph,
)
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.solids.separating_axis import nearest_difference, separation

if TYPE_CHECKING:
    import networkx as nx

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Opening = tuple[float, int, int, Floats]
"""How far the middle of an opening is from the pieces beside it [mm], their numbers, and the middle (3,)."""

COVERED = 1.02
"""Balls inside the material are larger by this factor than what is left between a curve and material."""
SAMPLES, MOVES = 800, 60
"""The distance of a curve from the surface is worked out at so many points of it, which are moved so often at most."""
ROUNDED = 9
"""Points of a curve that agree to so many decimals are one [mm]."""
PROJECTIONS = 10
"""The nearest points of two pieces are approached by so many projections onto each."""
MAX_OPENINGS = 64
"""Of more openings of a body the narrowest are looked at."""


@dataclass(frozen=True, eq=False)
class RingBody:
    """A rigid body at rest whose openings are looked at.

    Parameters
    ----------
    pieces : sequence of ConvexPiece
    surfaces : sequence of Surface
        Of its parts: a ball that touches none of them, about a point of the material, is inside.
    """

    pieces: Sequence[ConvexPiece]
    surfaces: Sequence[Surface]

    @cached_property
    def graph(self) -> nx.Graph:
        """Pieces that hang together."""
        return piece_graph(self.pieces)

    @cached_property
    def closed(self) -> CurveGraph:
        """Closed curves in its material."""
        return closed_curves(self.pieces, self.graph)

    @cached_property
    def thickness(self) -> float:
        """Radius of the largest ball inside a convex piece [mm]."""
        return max(inscribed_ball(piece)[1] for piece in self.pieces)


def held_by_opening(ring: RingBody, other: RingBody) -> bool:
    """True where a curve through openings of a ring is linked with closed curves in another body, which is too thick to pass them."""
    if not len(other.closed.cycles):
        return False
    widths, through = _curves_through(ring, _openings(ring, other.thickness))
    around = np.flatnonzero(links(through, other.closed))
    if not len(around):
        return False
    narrowest = around[0]
    inner = _inner_curves(other, COVERED * widths[narrowest])
    return inner is not None and linked(replace(through, cycles=through.cycles[narrowest, None]), inner)


def _curves_through(body: RingBody, openings: list[Opening]) -> tuple[list[float], CurveGraph]:
    """For each opening that closes a curve its width [mm], ascending, and that curve: through it, and through no wider ones."""
    import networkx as nx

    graph = body.graph.copy()
    nx.set_edge_attributes(graph, 0.0, "width")
    graph.add_edges_from((i, j, {"shared": middle, "width": width}) for width, i, j, middle in openings)
    tree = nx.minimum_spanning_tree(graph, weight="width")
    closing = [(width, i, j) for width, i, j, _ in openings if not tree.has_edge(i, j)]
    cycles = [nx.shortest_path(tree, i, j) for _, i, j in closing]
    return [width for width, _, _ in closing], closed_curves(body.pieces, graph, cycles)


def _openings(body: RingBody, limit: float) -> list[Opening]:
    """Openings between pieces that are no wider than a limit [mm], the narrowest first."""
    pieces, apart = body.pieces, []
    for i, j in near_pairs(pieces, 2 * limit):
        P, Q = pieces[i], pieces[j]
        room = separation(P.corners, P.normals, P.edges, Q.corners, Q.normals, Q.edges, np.empty(3))
        if 0 < room < 2 * limit and not body.graph.has_edge(i, j):
            apart.append((float(room), i, j))
    found = []
    for _, i, j in sorted(apart)[:MAX_OPENINGS]:
        middle = _between(pieces[i], pieces[j])
        width = max(float(np.linalg.norm(middle - _nearest(pieces[k], middle))) for k in (i, j))
        if width < limit:
            found.append((width, i, j, middle))
    return sorted(found, key=lambda opening: opening[:3])


def _between(P: ConvexPiece, Q: ConvexPiece) -> Floats:
    """The point (3,) half way between the nearest points of two convex pieces [mm].

    Source: alternating projections, Cheney and Goldstein 1959.
    """
    q = inscribed_ball(P, Q)[0]
    for _ in range(PROJECTIONS):
        p = _nearest(P, q)
        q = _nearest(Q, p)
    return (p + q) / 2


def _nearest(piece: ConvexPiece, point: Floats) -> Floats:
    """The point (3,) of a convex piece nearest to a point (3,) outside it [mm]."""
    return point - nearest_difference(piece.corners, point[None], point - piece.corners[0])


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
