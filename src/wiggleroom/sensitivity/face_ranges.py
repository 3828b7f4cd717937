"""Least and largest value of linear functions on a face of multipliers, by linear programs that share their equations.

Each equation of the balance is one part along one axis, or turning. Many depend on others: those of parts that can move freely, and
those that hold only because the motion is an optimum. Rounding makes them contradict each other a little, which would cut off much of the
face, so only independent ones are asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.sensitivity.dual_face import DualFace
from wiggleroom.solve.dual_linear_program import need_highs, quiet_solver, standard_form

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Minimum = Callable[[Floats], float]

DEPENDENT = 1e-12
"""Equations whose squared distance from the span of others is below this share of the largest square depend on them."""


def ranges(face: DualFace, worth: sp.csr_matrix, stop: Stop | None = None) -> Floats:
    """Least and largest value (m, 2) of linear functions `worth` (m, k) of the multipliers; nan where it is not known.

    An end is not known if nothing bounds the function there, or if `stop` was set before it was found.
    """
    share = face.force / face.force.max(initial=1e-300)
    balance = (face.balance @ sp.diags_array(share)).tocsr()  # of multipliers in units of those that the solver found
    balance = balance[independent_rows(balance)]
    minimum = _from_the_last_basis(balance, stop) if find_spec("highspy") else _from_no_basis(balance)
    out = np.full((worth.shape[0], 2), np.nan)
    for k, row in enumerate(worth):
        cost = row.toarray().ravel() * face.force
        for side, sign in enumerate((1.0, -1.0)):
            if stop is not None and stop.is_set():
                return out
            out[k, side] = sign * minimum(sign * cost)
    return out


def independent_rows(matrix: sp.csr_matrix) -> Ints:
    """As many rows of a matrix (m, k) as do not depend on each other, in order.

    Examples
    --------
    >>> independent_rows(sp.csr_matrix([[1.0, 1.0], [3.0, 3.0], [0.0, 1.0], [0.0, 0.0]]))
    array([1, 2])

    Source: Higham, Accuracy and Stability of Numerical Algorithms, section 10.3 (Cholesky factorisation with complete pivoting).
    """
    from scipy.linalg.lapack import dpstrf

    gram = (matrix @ matrix.T).toarray()
    if not gram.any():
        return np.zeros(0, np.int64)
    _, pivot, rank, _ = dpstrf(gram, tol=DEPENDENT * gram.diagonal().max(), lower=1)
    return np.sort(pivot[:rank] - 1).astype(np.int64)


def _from_the_last_basis(balance: sp.csr_matrix, stop: Stop | None) -> Minimum:
    """Minimum of a cost (k,) over x >= 0 with the same balance as x = 1: each begins at the vertex where the last one ended."""
    highspy = need_highs()
    rows, count = balance.shape
    solver = quiet_solver(highspy, lambda: stop is not None and stop.is_set(), rows)
    solver.setOptionValue("simplex_strategy", highspy.simplex_constants.kSimplexStrategyPrimal.value)
    solver.passModel(standard_form(highspy, np.zeros(count), balance.tocsc(), balance @ np.ones(count)))
    every = np.arange(count, dtype=np.int32)

    def minimum(cost: Floats) -> float:
        solver.changeColsCost(count, every, cost)
        solver.run()
        known = solver.getModelStatus() == highspy.HighsModelStatus.kOptimal
        return float(solver.getInfo().objective_function_value) if known else np.nan

    return minimum


def _from_no_basis(balance: sp.csr_matrix) -> Minimum:
    """The same by what scipy carries of HiGHS, about ten times as slow."""
    from scipy.optimize import linprog

    total = balance @ np.ones(balance.shape[1])

    def minimum(cost: Floats) -> float:
        found = linprog(cost, A_eq=balance, b_eq=total, bounds=(0, None), method="highs")
        return float(found.fun) if found.status == 0 else np.nan

    return minimum
