"""Congruent pairs of bodies, for which one computation serves all, and bodies that can be exchanged for each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


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


def exchange_classes(bodies: Bodies, never: Bools, named: Ints) -> Ints:
    """Class (n,) of each body: bodies of one class can be exchanged in any state, and every question has the same answer.

    They have the same shape as made (gaps, offsets and glue included), they move, they are not named in the question, and every other body
    meets all of them or none. What stands is not exchanged: each such body is a class of its own, as is each that is named.

    Parameters
    ----------
    bodies : Bodies
    never : (n, n) bool
        Pairs that never collide, both ways round.
    named : (k,) int64
        Bodies that the question distinguishes from others: targets, goals, what is held.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> from wiggleroom.geometry.bodies import bodies
    >>> row = bodies(wr.patterns.chain(5, joint="tee", gap=0.01))
    >>> never, named = np.zeros((5, 5), dtype=bool), np.array([3])
    >>> exchange_classes(row, never, named).tolist()
    [0, 1, 1, 3, 1]
    >>> never[0, 4] = never[4, 0] = True
    >>> exchange_classes(row, never, named).tolist()
    [0, 1, 1, 3, 4]
    """
    label = np.arange(len(bodies.shape))
    alone = bodies.fixed.copy()
    alone[named] = True
    for shape in np.unique(bodies.shape[~alone]):
        members = np.flatnonzero((bodies.shape == shape) & ~alone)
        for k, b in enumerate(members[1:], 1):
            for a in members[:k][label[members[:k]] == members[:k]]:  # the first of each class so far
                differ = never[a] != never[b]
                differ[[a, b]] = False
                if not differ.any():
                    label[b] = a
                    break
    return label
