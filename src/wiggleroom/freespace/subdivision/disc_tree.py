"""Material of one body as edges under a tree of discs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class DiscTree:
    """Material, its boundary as a tree.

    Parameters
    ----------
    edge : (m, 4) float64 [mm]
        Start and end of every edge; material lies left of it.
    normal : (m, 3, 2) float64
        Outward unit normal of the edge itself, and the sums of both normals at its start and at its end.
    disc : (k, 3) float64 [mm]
        Middle and radius of a disc round the edges below each node; the first is the root.
    kid : (k, 2) int64
        The two nodes below, or (-1, edge) at a leaf.
    """

    edge: Floats
    normal: Floats
    disc: Floats
    kid: Ints

    @property
    def radius(self) -> float:
        """Largest distance of a corner from the origin [mm]."""
        return float(np.hypot(*self.edge[:, :2].T).max())

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Ints]:
        """What the kernels take."""
        return self.edge, self.normal, self.disc, self.kid


def disc_tree(material: shapely.Geometry, origin: Floats) -> DiscTree:
    """Solid of a polygon or of several that do not overlap, measured from `origin` (2,) [mm].

    Examples
    --------
    >>> import numpy as np, shapely
    >>> square = disc_tree(shapely.box(0, 0, 2, 2), np.array([1.0, 1.0]))
    >>> square.edge.shape, round(square.radius, 3)
    ((4, 4), 1.414)
    """
    rings = [
        shapely.get_coordinates(ring)
        for piece in shapely.get_parts(shapely.normalize(material))
        for ring in (shapely.orient_polygons(piece).exterior, *shapely.orient_polygons(piece).interiors)
    ]
    edges, normals = [], []
    for ring in rings:
        ring = ring - origin
        ring = ring[np.r_[True, np.any(ring[1:] != ring[:-1], axis=1)]]
        along = ring[1:] - ring[:-1]
        normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
        edges.append(np.hstack([ring[:-1], ring[1:]]))
        normals.append(np.stack([normal, normal + np.roll(normal, 1, 0), normal + np.roll(normal, -1, 0)], 1))
    edge = np.concatenate(edges)
    discs: list[tuple[float, float, float]] = []
    kids: list[tuple[int, int]] = []
    _grow(edge, 0, len(edge), discs, kids)
    return DiscTree(edge, np.concatenate(normals), np.array(discs), np.array(kids, dtype=np.int64))


def _grow(edge: Floats, i: int, j: int, discs: list, kids: list) -> int:
    """Add the node of edges i to j and all below it; returns its number."""
    points = edge[i:j].reshape(-1, 2)
    middle = (points.min(0) + points.max(0)) / 2
    number = len(discs)
    discs.append((*middle.tolist(), float(np.hypot(*(points - middle).T).max())))
    kids.append((-1, i))
    if j - i > 1:
        half = (i + j) // 2
        kids[number] = (_grow(edge, i, half, discs, kids), _grow(edge, half, j, discs, kids))
    return number
