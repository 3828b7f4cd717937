"""Linear programs with many sparse rows: PIQP where it is installed, else HiGHS on the dual.

The dual has as many equations as the program has variables, and far fewer of those than rows: HiGHS is many times faster on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LP_TOLERANCE = 1e-9
"""Tolerance, absolute and relative."""
MAX_ITERATIONS = 120
"""Of PIQP."""


@dataclass(frozen=True, eq=False)
class LinearSolution:
    """Where it ended: `x` (n,), None where there is no solution, and how many iterations it took."""

    x: Floats | None
    iterations: int


def linear_solver() -> str:
    """Name of the solver that `maximise` uses here: "piqp" or "highs"."""
    try:
        import piqp  # noqa: F401
    except ImportError:
        return "highs"
    return "piqp"


def maximise(cost: Floats, rows: sp.csr_matrix, least: Floats, bound: Floats, solver: str = "") -> LinearSolution:
    """Largest cost . x where rows x >= least and |x| <= bound.

    Parameters
    ----------
    cost : (n,) float64
    rows : (m, n) sparse
    least : (m,) float64
    bound : (n,) float64
    solver : str
        "piqp" or "highs"; by default `linear_solver()`.

    Examples
    --------
    >>> rows = sp.csr_matrix([[-1.0, -1.0]])
    >>> found = maximise(np.array([1.0, 2.0]), rows, np.array([-1.5]), np.ones(2), "highs")
    >>> found.x.round(6)
    array([0.5, 1. ])
    """
    return (_piqp if (solver or linear_solver()) == "piqp" else _highs)(cost, rows, least, bound)


def _piqp(cost: Floats, rows: sp.csr_matrix, least: Floats, bound: Floats) -> LinearSolution:
    import piqp

    n = len(cost)
    solver: Any = piqp.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = LP_TOLERANCE
    solver.settings.max_iter = MAX_ITERATIONS
    zero = sp.csc_matrix((n, n))
    solver.setup(zero, -cost, None, None, sp.csc_matrix(rows), least, None, -bound, bound)
    status = solver.solve()
    good = status == piqp.PIQP_SOLVED
    return LinearSolution(np.array(solver.result.x) if good else None, int(solver.result.info.iter))


def _highs(cost: Floats, rows: sp.csr_matrix, least: Floats, bound: Floats) -> LinearSolution:
    from scipy.optimize import linprog

    # least (-least) . y + bound . (p + q) where -rows^T y + p - q = cost; its multipliers are x
    n = len(cost)
    one = sp.eye(n)
    matrix = sp.hstack([-sp.csr_matrix(rows).T, one, -one]).tocsc()
    right = np.concatenate([-least, bound, bound])
    found = linprog(right, A_eq=matrix, b_eq=cost, bounds=(0, None), method="highs")
    return LinearSolution(np.array(found.eqlin.marginals) if found.status == 0 else None, int(found.nit))
