"""The largest ball inside a convex piece, or inside what several have in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece

Floats = NDArray[np.float64]


def inscribed_ball(*pieces: ConvexPiece) -> tuple[Floats, float]:
    """Middle (3,) and radius [mm] of the largest ball inside all of some convex pieces; the radius is negative where they are apart.

    Source: the Chebyshev centre, Boyd and Vandenberghe, "Convex Optimization" (2004), section 8.5.1.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.convex import cuboid
    >>> middle, radius = inscribed_ball(cuboid(np.zeros(3), np.array([4.0, 2.0, 6.0])))
    >>> middle.round(9)[1].item(), round(radius, 9)
    (1.0, 1.0)
    """
    from scipy.optimize import linprog

    along = [p.corners @ p.normals.T for p in pieces]
    A = np.vstack([sign * p.normals for p in pieces for sign in (1, -1)])
    b = np.concatenate([heights for s in along for heights in (s.max(axis=0), -s.min(axis=0))])
    found = linprog([0, 0, 0, -1.0], np.column_stack([A, np.ones(len(A))]), b, bounds=(None, None))
    middle = np.asarray(found.x[:3])
    return middle, float((b - A @ middle).min())
