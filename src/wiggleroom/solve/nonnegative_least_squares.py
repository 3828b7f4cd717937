"""Nonnegative least squares with few rows, compiled: the library's own takes longer to import than most questions take to answer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit

Floats = NDArray[np.float64]

STATIONARY = 1e-12
"""A column brings nothing whose product with what is left is less than this share of its own length times that of the right side."""


def nonnegative_least_squares(columns: Floats, right: Floats) -> tuple[Floats, float]:
    """Weights x >= 0 (k,) that bring the sum of weighted columns (k, m) nearest to `right` (m,), and the distance that is left.

    Source: Lawson and Hanson 1974, chapter 23.

    Examples
    --------
    >>> x, left = nonnegative_least_squares(np.array([[1.0, 0.0], [1.0, 1.0], [0.0, -1.0]]), np.array([2.0, 1.0]))
    >>> x.round(9).tolist(), round(left, 9)
    ([1.0, 1.0, 0.0], 0.0)
    """
    x = np.zeros(len(columns))
    return x, float(_active_set(np.ascontiguousarray(columns), right, x))


@njit(**OPTIONS)
def _active_set(columns, right, x):
    """Fill x (k,), zero at first: take in the column that brings most, give up those whose weight falls to zero; the distance left."""
    k, m = columns.shape
    taken, many = np.empty(m, np.int64), 0
    z, left = np.empty(m), right.copy()
    least = STATIONARY * np.sqrt((right * right).sum() * (columns * columns).sum(axis=1))
    for _ in range(3 * k):
        most, best = 0.0, -1
        for j in range(k):
            gain = (columns[j] * left).sum()
            if x[j] == 0.0 and gain > max(most, least[j]):
                most, best = gain, j
        if best < 0 or many == m:  # as many columns as rows leave nothing
            break
        taken[many], many = best, many + 1
        while True:
            _least_squares(columns, taken[:many], right, z)
            share, first = 1.0, -1
            for i in range(many):
                if z[i] <= 0.0:
                    weight = x[taken[i]]
                    ratio = weight / (weight - z[i]) if weight > 0.0 else 0.0
                    if ratio <= share:
                        share, first = ratio, i
            for i in range(many):
                x[taken[i]] += share * (z[i] - x[taken[i]])
            if first < 0:
                break
            x[taken[first]] = 0.0
            taken[first : many - 1] = taken[first + 1 : many].copy()
            many -= 1
        left[:] = right
        for i in range(many):
            left -= x[taken[i]] * columns[taken[i]]
    return np.sqrt((left * left).sum())


@njit(**OPTIONS)
def _least_squares(columns, taken, right, z):
    """Fill z with the weights of some columns that come nearest to `right`; a column that depends on those before it gets none."""
    many, m = len(taken), columns.shape[1]
    Q, R = np.zeros((many, m)), np.zeros((many, many))
    left = right.copy()
    for i in range(many):  # modified Gram-Schmidt
        v = columns[taken[i]].copy()
        size = np.sqrt((v * v).sum())
        for h in range(i):
            R[h, i] = (Q[h] * v).sum()
            v -= R[h, i] * Q[h]
        R[i, i] = np.sqrt((v * v).sum())
        if R[i, i] > STATIONARY * size:
            Q[i] = v / R[i, i]
        z[i] = (Q[i] * left).sum()
        left -= z[i] * Q[i]
    for i in range(many - 1, -1, -1):
        for h in range(i + 1, many):
            z[i] -= R[i, h] * z[h]
        z[i] = z[i] / R[i, i] if R[i, i] > 0.0 else 0.0
