"""What holds for cos, sin and the angle itself at every angle of an interval, whatever its width."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ROUNDING_MARGIN = 1e-13
"""Supports are larger by this share of their terms."""


def support(alpha: Floats, beta: Floats, gamma: Floats, half: Floats) -> Floats:
    """Largest alpha cos v + beta sin v + gamma v over |v| <= half, rounded upwards; arguments broadcast.

    Examples
    --------
    >>> support(np.array(1.0), np.array(0.0), np.array(0.0), np.array(0.3)).round(9)
    np.float64(1.0)
    >>> support(np.array(-1.0), np.array(0.0), np.array(0.0), np.array(np.pi)).round(9)
    np.float64(1.0)
    """
    alpha, beta, gamma, half = np.broadcast_arrays(alpha, beta, gamma, half)
    size = np.hypot(alpha, beta)
    terms = np.abs(alpha) + np.abs(beta) + np.abs(gamma) * half
    most = np.full(alpha.shape, -np.inf)
    for v in (-half, half):
        most = np.maximum(most, alpha * np.cos(v) + beta * np.sin(v) + gamma * v)
    # the slope is size cos(v + shift) + gamma
    shift = np.arctan2(alpha, beta)
    turn = np.arccos(np.clip(-gamma / np.where(size > 0, size, 1.0), -1.0, 1.0))
    for sign in (-1.0, 1.0):
        for rounds in range(-2, 3):
            v = np.clip(sign * turn - shift + 2 * np.pi * rounds, -half, half)
            most = np.maximum(most, alpha * np.cos(v) + beta * np.sin(v) + gamma * v)
    # more than once round nothing is left to look at
    most = np.where(half > np.pi, size + np.abs(gamma) * half, most)
    return most + ROUNDING_MARGIN * terms


def envelope(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Rows that C = cos t - 1, S = sin t and t keep for every t between `low` and `high`.

    Parameters
    ----------
    low, high : (n,) float64 [rad]

    Returns
    -------
    rows : (n, m, 3)
        Coefficients of C, S and t.
    most : (n, m)
        rows . (C, S, t) <= most.
    """
    middle, half = ((low + high) / 2)[:, None], ((high - low) / 2 * (1 + 1e-15) + 1e-15)[:, None]
    quarter = np.minimum(half, np.pi / 2)
    one, nought = np.ones_like(half), np.zeros_like(half)
    small = np.where(half > 0, half, 1.0)
    # in v = t - middle: cosine from below and, by tangents, from above; sine about its tangent and its chords
    turned = [(-one, nought, nought)]
    turned += [(one, nought, np.sin(p)) for p in (-quarter, -quarter / 2, nought, quarter / 2, quarter)]
    for slope in (one, np.sin(small) / small, np.cos(quarter)):
        turned += [(nought, one, -slope), (nought, -one, slope)]
    turned += [(np.cos(p) * one, np.sin(p) * one, nought) for p in (half / 2, -half / 2, half, -half)]
    alpha, beta, gamma = (np.concatenate([row[k] for row in turned], axis=1) for k in range(3))
    most = support(alpha, beta, gamma, half)
    c, s = np.cos(middle), np.sin(middle)
    # cos v = c (C + 1) + s S, sin v = c S - s (C + 1)
    on_c, on_s = alpha * c - beta * s, alpha * s + beta * c
    most = most - on_c + gamma * middle
    return np.stack([on_c, on_s, gamma], -1), most + ROUNDING_MARGIN * (
        np.abs(on_c) + np.abs(on_s) + np.abs(gamma * middle) + 1
    )
