"""Multipliers to begin with where rows have changed: their forces on each pair of bodies stay as nearly as can be what they were.

A point is near the central path where products of slack and multiplier are even and forces are in balance. New rows of a pair begin
with even products, and are then changed as little as can be, relative to what they are, until their wrench is that of the old rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.jit_options import NO_ALLOCATION, njit
from wiggleroom.program.nonlinear_program import Linearised

Floats = NDArray[np.float64]

MOST_CHANGE = 10.0
"""A multiplier becomes at most this many times larger or smaller."""
REPETITIONS = 3
LEAST_CARRIED_SLACK = 1e-7
"""Slacks begin no smaller, as a share of `program.length`: a new wall may pass through the point itself."""


def wrenches(at: Linearised, lam: Floats) -> Floats:
    """Force and torque (P, 3) of the rows of each pair, from their multipliers (R,)."""
    return np.add.reduceat(at.d * lam[:, None], at.program.cells.row[:-1])


def even_multipliers(at: Linearised, mu: float, wrench: Floats, given: Floats) -> Floats:
    """Multipliers (R,) with products near `mu` at a point inside all rows, whose wrenches come near `wrench` (P, 3).

    Rows with a number in `given` (R,) keep that one; in pairs of which all rows have one nothing changes.
    """
    program, bodies = at.program, at.program.bodies
    pairs = program.cells
    lam = np.where(np.isnan(given), mu / np.maximum(at.h, LEAST_CARRIED_SLACK), given)
    lever = np.minimum(bodies.radius[pairs.a], bodies.radius[pairs.b])
    fit_wrenches(pairs.row, at.d, np.isnan(given[pairs.row[:-1]]), wrench, lever, np.empty((3, 4)), lam)
    return lam


@njit(**NO_ALLOCATION)
def fit_wrenches(row, d, fresh, wrench, lever, room, lam):
    """Change the multipliers of pairs that are `fresh` so that their wrenches come near `wrench`; `room` (3, 4) is worked in."""
    for p in range(len(row) - 1):
        if not fresh[p]:
            continue
        share = 1.0 / lever[p]  # a torque becomes a force
        for _ in range(REPETITIONS):
            for i in range(3):
                room[i, 3] = wrench[p, i] * (share if i == 2 else 1.0)
                for j in range(3):
                    room[i, j] = 0.0
            for k in range(row[p], row[p + 1]):
                x, y, z, f = d[k, 0], d[k, 1], d[k, 2] * share, lam[k]
                room[0, 3] -= f * x
                room[1, 3] -= f * y
                room[2, 3] -= f * z
                room[0, 0] += f * f * x * x
                room[0, 1] += f * f * x * y
                room[0, 2] += f * f * x * z
                room[1, 1] += f * f * y * y
                room[1, 2] += f * f * y * z
                room[2, 2] += f * f * z * z
            small = 1e-9 * (room[0, 0] + room[1, 1] + room[2, 2]) + 1e-300
            # Cholesky of the 3 x 3 matrix
            l00 = np.sqrt(room[0, 0] + small)
            l10, l20 = room[0, 1] / l00, room[0, 2] / l00
            l11 = np.sqrt(max(room[1, 1] + small - l10 * l10, small))
            l21 = (room[1, 2] - l20 * l10) / l11
            l22 = np.sqrt(max(room[2, 2] + small - l20 * l20 - l21 * l21, small))
            b0 = room[0, 3] / l00
            b1 = (room[1, 3] - l10 * b0) / l11
            b2 = (room[2, 3] - l20 * b0 - l21 * b1) / l22
            y2 = b2 / l22
            y1 = (b1 - l21 * y2) / l11
            y0 = (b0 - l10 * y1 - l20 * y2) / l00
            limit = MOST_CHANGE ** (1.0 / REPETITIONS)
            for k in range(row[p], row[p + 1]):
                f = lam[k]
                change = f * (d[k, 0] * y0 + d[k, 1] * y1 + d[k, 2] * share * y2)
                lam[k] = f * min(max(1.0 + change, 1.0 / limit), limit)
