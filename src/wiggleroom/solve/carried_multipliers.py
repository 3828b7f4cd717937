"""Multipliers to begin with where rows have changed: their forces on each pair of bodies stay as nearly as can be what they were.

A point is near the central path where products of slack and multiplier are even and forces are in balance. New rows of a pair begin
with even products, and are then changed as little as can be, relative to what they are, until their wrench is that of the old rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised
from wiggleroom.solve.row_operations import fit_wrenches

Floats = NDArray[np.float64]

MIN_CARRIED_SLACK = 1e-7
"""Slacks begin no smaller, as a share of `program.length`: a new wall may pass through the point itself."""


def pair_wrenches(at: Linearised, lam: Floats) -> Floats:
    """Force and torque (P, 3) of the rows of each pair, from their multipliers (R,)."""
    return np.add.reduceat(at.d * lam[:, None], at.program.cells.row[:-1])


def even_multipliers(at: Linearised, mu: float, wrench: Floats, given: Floats) -> Floats:
    """Multipliers (R,) with products near `mu` at a point inside all rows, whose wrenches come near `wrench` (P, 3).

    Rows with a number in `given` (R,) keep that one; in pairs of which all rows have one nothing changes.
    """
    program, bodies = at.program, at.program.bodies
    pairs = program.cells
    lam = np.where(np.isnan(given), mu / np.maximum(at.h, MIN_CARRIED_SLACK), given)
    lever = np.minimum(bodies.radius[pairs.a], bodies.radius[pairs.b])
    fit_wrenches(pairs.row, at.d, np.isnan(given[pairs.row[:-1]]), wrench, lever, np.empty((3, 4)), lam)
    return lam
