"""Solid angles of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def solid_angles(a: Floats, b: Floats, c: Floats) -> Floats:
    """Signed solid angles (k,) of triangles seen from the origin [sr].

    Source: van Oosterom and Strackee, "The solid angle of a plane triangle" (1983).

    Examples
    --------
    >>> x, y, z = np.eye(3)[:, None]
    >>> float(solid_angles(x, y, z)[0] / np.pi)
    0.5
    """
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("ki,ki->k", a, np.cross(b, c))
    below = x * y * z + (a * b).sum(axis=1) * z + (b * c).sum(axis=1) * x + (c * a).sum(axis=1) * y
    return np.asarray(2 * np.arctan2(volume, below))
