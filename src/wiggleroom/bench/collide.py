"""Do two parts overlap: an exact test of polygons for very many relative motions, apart from all models.

Two polygons overlap where a pair of their edges crosses properly, or where one holds a corner of the other.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import njit

Floats = NDArray[np.float64]


def overlapping(a: shapely.Geometry, b: shapely.Geometry, relative: Floats) -> NDArray[np.bool_]:
    """Whether the interiors meet (k,) when b turns about the origin and moves; contact within rounding may go either way.

    Parameters
    ----------
    a, b : shapely polygons [mm]
        Both in the axes of a's frame at rest, the point that b turns about at the origin.
    relative : (k, 3) float64 [mm, mm, rad]

    Examples
    --------
    >>> import numpy as np
    >>> plate, peg = shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1), shapely.box(-0.9, -0.9, 0.9, 0.9)
    >>> overlapping(plate, peg, np.array([[0.09, 0.0, 0.0], [0.11, 0.0, 0.0], [0.0, 0.0, 0.2]]))
    array([False,  True,  True])
    """
    return _any(_edges(a), _edges(b), np.ascontiguousarray(relative, dtype=float))


def _edges(geometry: shapely.Geometry) -> Floats:
    """Edges (n, 4) of all rings: x0, y0, x1, y1."""
    rings = [r for part in shapely.get_parts(geometry) for r in (part.exterior, *part.interiors)]
    corners = [shapely.get_coordinates(r) for r in rings]
    return np.vstack([np.hstack([c[:-1], c[1:]]) for c in corners])


@njit(cache=True, nogil=True)
def _inside(x: float, y: float, edges: Floats) -> bool:
    """Even-odd rule."""
    odd = False
    for k in range(len(edges)):
        x0, y0, x1, y1 = edges[k]
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            odd = not odd
    return odd


@njit(cache=True, nogil=True)
def _cross(a: Floats, b: Floats, low: Floats, high: Floats) -> bool:
    """Whether an edge of `a` properly crosses one of `b`; `low`, `high` (n, 2) are the boxes of the edges of `a`."""
    for j in range(len(b)):
        bx0, by0, bx1, by1 = b[j]
        low_x, high_x = min(bx0, bx1), max(bx0, bx1)
        low_y, high_y = min(by0, by1), max(by0, by1)
        bx, by = bx1 - bx0, by1 - by0
        for i in range(len(a)):
            if high[i, 0] < low_x or low[i, 0] > high_x or high[i, 1] < low_y or low[i, 1] > high_y:
                continue
            ax0, ay0, ax1, ay1 = a[i]
            s0 = bx * (ay0 - by0) - by * (ax0 - bx0)
            s1 = bx * (ay1 - by0) - by * (ax1 - bx0)
            if not (s0 > 0 > s1 or s0 < 0 < s1):
                continue
            ax, ay = ax1 - ax0, ay1 - ay0
            t0 = ax * (by0 - ay0) - ay * (bx0 - ax0)
            t1 = ax * (by1 - ay0) - ay * (bx1 - ax0)
            if t0 > 0 > t1 or t0 < 0 < t1:
                return True
    return False


@njit(cache=True, nogil=True)
def _any(a: Floats, b: Floats, samples: Floats) -> NDArray[np.bool_]:
    """Whether the polygons meet, for every sample (k, 3)."""
    out = np.zeros(len(samples), dtype=np.bool_)
    low = np.column_stack((np.minimum(a[:, 0], a[:, 2]), np.minimum(a[:, 1], a[:, 3])))
    high = np.column_stack((np.maximum(a[:, 0], a[:, 2]), np.maximum(a[:, 1], a[:, 3])))
    placed = np.empty_like(b)
    for k in range(len(samples)):
        x, y, phi = samples[k]
        c, s = np.cos(phi), np.sin(phi)
        for j in range(len(b)):
            for i in (0, 2):
                placed[j, i] = c * b[j, i] - s * b[j, i + 1] + x
                placed[j, i + 1] = s * b[j, i] + c * b[j, i + 1] + y
        out[k] = _cross(a, placed, low, high)
        if not out[k]:
            out[k] = _inside(placed[0, 0], placed[0, 1], a) or _inside(a[0, 0], a[0, 1], placed)
    return out
