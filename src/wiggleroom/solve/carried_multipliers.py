"""Initial multipliers for changed rows: the forces on each pair of bodies stay as near as possible to the previous ones.

A point is near the central path if the products of slack and multiplier are even and forces balance. New rows of a pair begin with even
products, lam0 = mu / h, changed as little as possible in the metric 1 / lam until the wrench of the pair is that of the old rows:

    lam = lam0 + diag(lam0)^2 D (D^T diag(lam0)^2 D)^-1 (w - D^T lam0),    w = D_old^T lam_old,

a 3 x 3 system per pair.
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
