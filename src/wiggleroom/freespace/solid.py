"""Material of one body as edges under a tree of discs, and how deep a point lies in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from wiggleroom.freespace.kernel import INNER

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DEEPEST_TREE = 96
"""Room for the nodes that wait while a tree is walked."""


@dataclass(frozen=True, eq=False)
class Solid:
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


def solid(material: shapely.Geometry, origin: Floats) -> Solid:
    """Solid of a polygon or of several that do not overlap, measured from `origin` (2,) [mm].

    Examples
    --------
    >>> import numpy as np, shapely
    >>> square = solid(shapely.box(0, 0, 2, 2), np.array([1.0, 1.0]))
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
        ring = ring[np.r_[True, np.any(ring[1:] != ring[:-1], axis=1)]] - origin
        along = ring[1:] - ring[:-1]
        normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
        edges.append(np.hstack([ring[:-1], ring[1:]]))
        normals.append(np.stack([normal, normal + np.roll(normal, 1, 0), normal + np.roll(normal, -1, 0)], 1))
    edge = np.concatenate(edges)
    discs: list[tuple[float, float, float]] = []
    kids: list[tuple[int, int]] = []
    _grow(edge, 0, len(edge), discs, kids)
    return Solid(edge, np.concatenate(normals), np.array(discs), np.array(kids, dtype=np.int64))


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


@njit(**INNER)
def depth_at(x, y, edge, normal, disc, kid, stack):
    """Signed distance of a point from the boundary, negative inside the material."""
    best, sign = np.inf, 1.0
    stack[0] = 0
    count = 1
    while count:
        count -= 1
        node = stack[count]
        dx, dy = x - disc[node, 0], y - disc[node, 1]
        if np.sqrt(dx * dx + dy * dy) - disc[node, 2] >= best:
            continue
        if kid[node, 0] >= 0:
            one, other = kid[node, 0], kid[node, 1]
            ox, oy = x - disc[one, 0], y - disc[one, 1]
            px, py = x - disc[other, 0], y - disc[other, 1]
            if ox * ox + oy * oy < px * px + py * py:  # the nearer one is looked at first
                one, other = other, one
            stack[count] = one
            stack[count + 1] = other
            count += 2
            continue
        e = kid[node, 1]
        ax, ay = edge[e, 0], edge[e, 1]
        ex, ey = edge[e, 2] - ax, edge[e, 3] - ay
        t = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey)
        t = min(max(t, 0.0), 1.0)
        qx, qy = x - ax - t * ex, y - ay - t * ey
        d = np.sqrt(qx * qx + qy * qy)
        if d < best:
            best = d
            which = 1 if t <= 0.0 else (2 if t >= 1.0 else 0)
            sign = 1.0 if qx * normal[e, which, 0] + qy * normal[e, which, 1] >= 0.0 else -1.0
    return sign * best
