"""Bodies that are linked like the rings of a chain: curves inside them that no motion pulls apart.

Bodies may be linked although one is an open ring, as with a C hook or two glued halves, whose openings the other is too thick to pass. A
closed curve follows the material of the open ring and goes straight across its openings, where it is nowhere farther from that material
than some width. Where its linking number with a closed curve in the other body is not 0, the bodies part only if the curves cross.
Material does not cross material; and where a point of the other curve is in an opening, material of the ring is nearer than that width,
inside a ball of material about the point: the bodies overlap.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece, Surface
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.proof.inscribed_ball import inscribed_ball
from wiggleroom.spatial.solids.separating_axis import nearest_difference, separation
from wiggleroom.spatial.solids.solid_angle import solid_angles

if TYPE_CHECKING:
    import networkx as nx


Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Opening = tuple[float, int, int, Floats]

SAME_PLANE = 1e-7
"""Faces whose distance is below this share of the size lie in one plane."""
LEAST_AREA = 1e-3
"""Two faces share a place where they overlap by more than this share of the smaller one."""
AT_ONCE = 200_000
"""Pairs of segments whose solid angles are worked out at once."""
INTEGER = 1e-3
"""Rounding leaves a linking number nearer than this to the integer that it is."""

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
class CurveGraph:
    """Segments inside a body, and the closed curves that they make.

    Parameters
    ----------
    segments : (s, 2, 3) float64 [mm]
        From the middle of a convex piece to a point that it has in common with a neighbour.
    cycles : (c, s) int64
        How often, and in which direction, each closed curve goes along each segment; together a basis of all.
    """

    segments: Floats
    cycles: Ints


def piece_graph(pieces: Sequence[ConvexPiece]) -> nx.Graph:
    """Convex pieces that overlap or share faces; every edge has a point that both have in common, `shared` (3,) [mm]."""
    import networkx as nx

    graph = nx.Graph()
    for i, j in near_pairs(pieces):
        shared = common_point(pieces[i], pieces[j])
        if shared is not None:
            graph.add_edge(i, j, shared=shared)
    return graph


def closed_curves(
    pieces: Sequence[ConvexPiece], graph: nx.Graph, cycles: Sequence[Sequence[int]] | None = None
) -> CurveGraph:
    """Curves along cycles of a graph of convex pieces, by default a basis of all, through the point `shared` (3,) [mm] of every edge.

    Every segment joins points of one convex piece; curves go over to the next in the middle of what both have in common.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.convex import cuboid
    >>> bars = [([0, 0, 0], [3, 1, 1]), ([2, 1, 0], [3, 2, 1]), ([0, 2, 0], [3, 3, 1]), ([0, 1, 0], [1, 2, 1])]
    >>> pieces = [cuboid(*np.array(bar, dtype=float)) for bar in bars]
    >>> closed_curves(pieces, piece_graph(pieces)).cycles.shape
    (1, 8)
    """
    import networkx as nx

    cycles = nx.cycle_basis(graph) if cycles is None else cycles
    middles = [p.corners.mean(axis=0) for p in pieces]
    number = {frozenset(edge): k for k, edge in enumerate(graph.edges)}
    segments = [s for i, j, at in graph.edges.data("shared") for s in ([middles[i], at], [at, middles[j]])]
    rows = np.zeros((len(cycles), len(segments)), dtype=np.int64)
    begins = [i for i, _ in graph.edges]
    for row, cycle in zip(rows, cycles, strict=True):
        for i, j in itertools.pairwise([*cycle, cycle[0]]):
            k = number[frozenset((i, j))]
            row[2 * k : 2 * k + 2] = 1 if begins[k] == i else -1
    return CurveGraph(np.array(segments).reshape(-1, 2, 3), rows)


def linking_numbers(one: CurveGraph, other: CurveGraph) -> Floats:
    """Linking numbers (c, d) of the closed curves of two graphs; integers but for rounding.

    The integral of Gauss is additive over segments, and that of two segments is the solid angle of the parallelogram of their differences.

    Source: Gauss 1833.
    """
    used, used_other = one.cycles.any(axis=0), other.cycles.any(axis=0)
    p, q = one.segments[used], other.segments[used_other]
    angles = np.empty((len(p), len(q)))
    for rows in np.array_split(np.arange(len(p)), len(p) * len(q) // AT_ONCE + 1):
        p0, p1 = p[rows, None, 0], p[rows, None, 1]
        a, b, c, d = q[:, 0] - p0, q[:, 1] - p0, q[:, 1] - p1, q[:, 0] - p1
        angles[rows] = solid_angles(a, b, c) + solid_angles(a, c, d)
    return one.cycles[:, used] @ angles @ other.cycles[:, used_other].T / (4 * np.pi)


def links(one: CurveGraph, other: CurveGraph) -> NDArray[np.bool_]:
    """For each closed curve (c,) of a graph, whether it is linked with one of another."""
    numbers = linking_numbers(one, other)
    nearest = np.round(numbers)
    return ((nearest != 0) & (np.abs(numbers - nearest) < INTEGER)).any(axis=1)


def linked(one: CurveGraph, other: CurveGraph) -> bool:
    """True where closed curves inside two bodies go through each other: then no motion without collision takes the bodies apart.

    Examples
    --------
    >>> ring = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    >>> whole = np.ones((1, 4), dtype=np.int64)
    >>> flat = CurveGraph(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1), whole)
    >>> upright = CurveGraph(flat.segments[..., [0, 2, 1]] + [1.0, 0, 0], whole)
    >>> linked(flat, upright), linked(flat, CurveGraph(upright.segments + [1.5, 0, 0], whole))
    (True, False)
    """
    return bool(links(one, other).any())


def near_pairs(pieces: Sequence[ConvexPiece], reach: float = 0.0) -> list[tuple[int, int]]:
    """Pairs i < j of pieces whose boxes touch, or come within a reach [mm] of each other."""
    import shapely

    low = np.array([p.corners.min(axis=0) for p in pieces])
    high = np.array([p.corners.max(axis=0) for p in pieces])
    reach = max(reach / 2, SAME_PLANE * float((high - low).max()))
    flat = shapely.box(*(low[:, :2] - reach).T, *(high[:, :2] + reach).T)
    i, j = shapely.STRtree(flat).query(flat)
    keep = (i < j) & (low[i, 2] <= high[j, 2] + 2 * reach) & (low[j, 2] <= high[i, 2] + 2 * reach)
    return sorted(zip(i[keep].tolist(), j[keep].tolist(), strict=True))


def common_point(P: ConvexPiece, Q: ConvexPiece) -> Floats | None:
    """A point (3,) inside two pieces that overlap, or inside a face that they share [mm]; None where they do neither."""
    apart = separation(P.corners, P.normals, P.edges, Q.corners, Q.normals, Q.edges, np.empty(3))
    flat = SAME_PLANE * max(float(np.ptp(piece.corners, axis=0).max()) for piece in (P, Q))
    if apart > flat:
        return None
    return inscribed_ball(P, Q)[0] if apart < -flat else _middle_of_shared_face(P, Q, flat)


def _middle_of_shared_face(P: ConvexPiece, Q: ConvexPiece, flat: float) -> Floats | None:
    import shapely

    for normal in (*P.normals, *-P.normals):
        p, q = P.corners @ normal, Q.corners @ normal
        level = p.max()
        if abs(q.min() - level) > flat:
            continue
        across = np.linalg.svd(normal[None])[2][1:]
        faces = [
            shapely.MultiPoint(corners[np.abs(height - level) <= 2 * flat] @ across.T).convex_hull
            for corners, height in ((P.corners, p), (Q.corners, q))
        ]
        common = faces[0].intersection(faces[1])
        if common.area > LEAST_AREA * min(face.area for face in faces):
            x, y = common.centroid.coords[0]
            return np.asarray(x * across[0] + y * across[1] + level * normal)
    return None


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
