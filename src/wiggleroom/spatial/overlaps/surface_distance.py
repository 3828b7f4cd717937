"""How far points lie from a surface, and where on it is nearest (compiled)."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.spatial.solids.separating_axis import nearest_difference


@njit(**OPTIONS)
def surface_distances(triangles, points, away):
    """Distances (p,) [mm] of points (p, 3) from triangles (t, 3, 3), or a little less.

    `away` (p, 3) become units, from the nearest place to the point. A distance is how far all corners of a triangle lie along that.
    """
    found, axis, unit = np.full(len(points), np.inf), np.empty(3), np.empty(3)
    for p in range(len(points)):
        point = points[p]
        for t in range(len(triangles)):
            corners = triangles[t]
            box = 0.0
            for k in range(3):
                low = min(corners[0, k], corners[1, k], corners[2, k]) - point[k]
                high = point[k] - max(corners[0, k], corners[1, k], corners[2, k])
                box += max(low, high, 0.0) ** 2
            if box >= found[p] ** 2:
                continue
            for k in range(3):
                axis[k] = (corners[0, k] + corners[1, k] + corners[2, k]) / 3 - point[k]
            if axis[0] == 0.0 and axis[1] == 0.0 and axis[2] == 0.0:
                axis[0] = 1.0
            axis /= np.sqrt((axis**2).sum())
            near = nearest_difference(corners, points[p : p + 1], axis)
            length = np.sqrt((near**2).sum())
            apart = 0.0
            if length > 0:
                for sign in (1.0, -1.0):
                    least = np.inf
                    for c in range(3):
                        along = 0.0
                        for k in range(3):
                            along += sign * near[k] / length * (corners[c, k] - point[k])
                        least = min(least, along)
                    if least > apart:
                        apart = least
                        unit[:] = -sign * near / length
            if apart < found[p]:
                found[p] = apart
                away[p] = unit
    return found
