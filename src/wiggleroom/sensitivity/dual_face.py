"""The face of optimal multipliers: how far they are unique, and what follows for derivatives by gaps.

At an optimum the multipliers that balance the objective form a face: a polyhedron in which the solver's lie somewhere in
the middle. What a gap is worth is a linear function on it. Where that function is constant the derivative is unique.
Where it is not, a looser gap gains the least of it and a tighter one loses the most, as for any linear program.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class DualFaceSettings:
    """Parameters of the test for unique derivatives.

    Parameters
    ----------
    random_directions : int
        Random directions within the face in which every derivative is tried.
    min_direction : float in (0, 1)
        A random direction of which less than this is left within the face is rounding: the face is a point.
    uniqueness_tolerance : float in (0, 1)
        A derivative that varies by less than this share of itself, or of a thousandth of the largest, is unique.
    """

    random_directions: int = 12
    min_direction: float = 1e-4
    uniqueness_tolerance: float = 1e-3


SETTINGS = DualFaceSettings()


@dataclass(frozen=True, eq=False)
class DualFace:
    """The multipliers of the rows that hold a motion, and directions in which they may change.

    Parameters
    ----------
    force : (k,) float64
        Their multipliers [objective per mm].
    balance : (3F, k) sparse
        What each multiplier contributes to the balance of forces.
    turn : (k, m) float64
        Changes of the multipliers that keep the balance, at random; none makes a multiplier negative.
    back : (m,) float64
        How far each may be run backwards.
    """

    force: Floats
    balance: sp.csr_matrix
    turn: Floats
    back: Floats

    def spread(self, worth: sp.csr_matrix) -> tuple[Floats, Floats]:
        """Least and largest value found of linear functions `worth` (m, k) of the multipliers."""
        value = worth @ self.force
        change = worth @ self.turn
        ends = np.concatenate([np.zeros((len(value), 1)), change, -change * self.back], axis=1)
        return value + ends.min(axis=1), value + ends.max(axis=1)


def face(jacobian: sp.csr_matrix, force: Floats, length: float) -> DualFace:
    """Face of multipliers `force` (k,) at a solution; `jacobian` (k, V) are the derivatives of the rows that carry them.

    Rows count in units of `length` [mm].
    """
    z = null_space_sample((sp.diags_array(force) @ jacobian).tocsr())
    least, most = z.min(axis=0, initial=0.0), z.max(axis=0, initial=0.0)
    ahead = 1 / np.maximum(-least, 1e-300)
    behind = 1 / np.maximum(most, 1e-300)
    some = z.any(axis=0)
    turn = force[:, None] * z * np.where(some, ahead, 0.0)
    back = np.where(some, behind / ahead, 0.0)
    return DualFace(force / length, jacobian.T.tocsr(), turn / length, back)


def null_space_sample(matrix: sp.csr_matrix, z: Floats | None = None) -> Floats:
    """Vectors (k, m), random ones unless given, projected onto the null space of the transpose of a matrix (k, V).

    Random ones of which next to nothing is left are zero.
    """
    normal = (matrix.T @ matrix).tocsc()
    shift = 1e-13 * normal.diagonal().max(initial=1e-300)
    solver = sp.linalg.splu(normal + shift * sp.eye_array(normal.shape[0], format="csc"))
    given = z is not None
    if z is None:
        z = np.random.default_rng(0).standard_normal((matrix.shape[0], SETTINGS.random_directions))
    for _ in range(2):  # the second pass removes what rounding left of the first
        z = z - matrix @ solver.solve(matrix.T @ z)
    if not given:
        z[:, np.hypot.reduce(z, axis=0) < SETTINGS.min_direction] = 0.0
    return z


def is_unique(low: Floats, high: Floats) -> NDArray[np.bool_]:
    """True where the derivative has one value."""
    size = np.maximum(np.abs(low), np.abs(high))
    return high - low <= SETTINGS.uniqueness_tolerance * np.maximum(size, 1e-3 * size.max(initial=0.0))


def shared_with(force: Floats, mean: sp.csr_matrix) -> tuple[Floats, Floats]:
    """The same forces (k,), half of each passed on to contacts (e,) that are means (k, e) of their rows, and what these get."""
    load = np.asarray(mean.sum(axis=1)).ravel()
    most = np.divide(force, 2 * load, out=np.full(len(force), np.inf), where=load > 0)
    least = mean.tocsc(copy=True)
    least.data = most[least.indices]
    more = np.minimum.reduceat(least.data, least.indptr[:-1]) if mean.shape[1] else np.zeros(0)
    return force - mean @ more, more
