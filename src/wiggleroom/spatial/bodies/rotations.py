"""Rotations of space: matrices, rotation vectors, and the exponential map between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def unit_vector(v: ArrayLike) -> Floats:
    """A vector (3,) other than zero made one long, however short or long it is.

    >>> unit_vector([0.0, 3e-320, 4e-320]).round(3).tolist()
    [0.0, 0.6, 0.8]
    """
    v = np.asarray(v, dtype=float)
    scaled = v / np.abs(v).max()
    return scaled / np.linalg.norm(scaled)


def exponential(w: Floats) -> Floats:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3) [rad], by the formula of Rodrigues.

    >>> exponential(np.array([0.0, 0.0, np.pi / 2])).round(12).tolist()[0]
    [0.0, -1.0, 0.0]
    """
    w = np.asarray(w, dtype=float)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    half = angle / 2
    cross = np.zeros((*w.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[..., i, j], cross[..., j, i] = -w[..., k], w[..., k]
    first = np.sinc(angle / np.pi)
    second = np.sinc(half / np.pi) ** 2 / 2  # (1 - cos) / angle^2 without cancellation
    return np.eye(3) + first * cross + second * (cross @ cross)


def logarithm(R: Floats) -> Floats:
    """Rotation vectors (..., 3) [rad], at most half a turn long, of rotation matrices (..., 3, 3).

    >>> logarithm(exponential(np.array([0.1, -0.2, 3.0]))).round(9).tolist()
    [0.1, -0.2, 3.0]
    """
    q = quaternion(R)
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, q[..., :1])
    return q[..., 1:] * np.where(sine > 1e-150, angle / np.maximum(sine, 1e-150), 2.0)


def quaternion(R: Floats) -> Floats:
    """Unit quaternions (..., 4), scalar first, of rotation matrices (..., 3, 3).

    Source: Shepperd 1978, the largest of the four components first.
    """
    R = np.asarray(R, dtype=float)
    x, y, z = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    rows = np.empty((*R.shape[:-2], 4, 4))
    for i, square in enumerate((1 + x + y + z, 1 + x - y - z, 1 - x + y - z, 1 - x - y + z)):
        rows[..., i, i] = square
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        rows[..., 0, i + 1] = rows[..., i + 1, 0] = R[..., k, j] - R[..., j, k]
        rows[..., j + 1, k + 1] = rows[..., k + 1, j + 1] = R[..., k, j] + R[..., j, k]
    best = np.diagonal(rows, axis1=-2, axis2=-1).argmax(axis=-1)
    q = rows.reshape(-1, 4, 4)[np.arange(best.size), best.ravel()].reshape(*best.shape, 4)
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def fixed_axes(degrees: Floats) -> Floats:
    """Rotation matrix (3, 3) that turns about the fixed x, then y, then z axis by these angles (3,) [deg].

    Multiples of 90 degrees give exact entries.

    >>> fixed_axes(np.array([90.0, 0.0, 0.0])).tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    """
    R = np.eye(3)
    for axis, angle in enumerate(degrees):
        quarter = (angle / 90) % 4 % 4  # a tiny negative angle leaves 4
        exact = (1.0, 0.0, -1.0, 0.0)[int(quarter)] if quarter == int(quarter) else float(np.cos(np.radians(angle)))
        sine = (0.0, 1.0, 0.0, -1.0)[int(quarter)] if quarter == int(quarter) else float(np.sin(np.radians(angle)))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = exact, -sine, sine, exact
        R = turn @ R
    return R + 0.0
