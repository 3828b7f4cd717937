"""Which pairs of bodies are congruent: what is worked out for one of them holds for all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def congruence_classes(bodies: Bodies, a: Ints, b: Ints, pose: Floats, tolerance: float = 1e-9) -> tuple[Ints, Ints]:
    """Congruent pairs: same shapes in the same relative pose, wherever they lie and however they are turned.

    Parameters
    ----------
    a, b : (P,) int64
    pose : (P, 3) [mm, mm, rad]
        Relative poses.
    tolerance : float
        Poses are the same up to this share of the larger body's radius and this angle [rad].

    Returns
    -------
    first : (C,) int64
        One pair of each class.
    label : (P,) int64
        Class of each pair.
    """
    unit = tolerance * np.maximum(bodies.radius[a], bodies.radius[b])
    angle = np.remainder(pose[:, 2] + 1e-6, 2 * np.pi) - 1e-6
    place = np.round(pose[:, :2] / unit[:, None])
    key = np.column_stack([bodies.shape[a], bodies.shape[b], place, np.round(angle / tolerance)])
    order = np.lexsort(key.T[::-1])
    new = np.ones(len(key), dtype=bool)
    new[1:] = (np.diff(key[order], axis=0) != 0).any(axis=1)
    label = np.empty(len(key), dtype=np.int64)
    label[order] = np.cumsum(new) - 1
    return order[new], label
