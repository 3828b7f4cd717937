"""Bodies that are linked like the rings of a chain: curves inside them that no motion pulls apart."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece
from wiggleroom.spatial.inscribed_ball import inscribed_ball
from wiggleroom.spatial.solid_angle import solid_angles
from wiggleroom.spatial.solids.separating_axis import separation

if TYPE_CHECKING:
    import networkx as nx

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_PLANE = 1e-7
"""Faces whose distance is below this share of the size lie in one plane."""
LEAST_AREA = 1e-3
"""Two faces share a place where they overlap by more than this share of the smaller one."""
AT_ONCE = 200_000
"""Pairs of segments whose solid angles are worked out at once."""
INTEGER = 1e-3
"""Rounding leaves a linking number nearer than this to the integer that it is."""


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
