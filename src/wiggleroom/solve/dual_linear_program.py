"""One linear program asked again and again with other costs, given to HiGHS in its dual form.

max cost . x with low <= rows x <= high and least <= x <= most has far fewer variables than rows. Its dual has a variable for each
side of a row or a box and one equation for each x, so a basis is as small as x is. Another cost only changes right sides:
the old basis stays dual feasible, and the dual simplex method goes on from it. What HiGHS says is not believed here: its
multipliers prove bounds that are worked out elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.deadline import WorkBudget
from wiggleroom.errors import require_extra

if TYPE_CHECKING:
    import scipy.sparse as sp

Floats = NDArray[np.float64]

ITERATION_WORK, ITERATION_WORK_PER_ENTRY = 0.025, 1.2e-5
"""Work of an iteration, and for each entry of the matrix."""
BUILD_ITERATIONS = 30
"""A program takes the work of so many iterations before the first one."""
MAX_ITERATIONS_PER_ROW, MIN_ITERATION_LIMIT = 25, 10_000
"""A simplex method that takes more iterations than this for each of its rows is taken to cycle, but never before the second number."""


def need_highs() -> Any:
    """Module highspy.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    require_extra("prove", "proving a bound needs highspy", "highspy")
    import highspy

    return highspy


class DualLinearProgram:
    """A linear program that is asked for the largest value of other and other costs.

    Parameters
    ----------
    rows : (m, n) sparse
    low, high : (m,) float64
    least, most : (n,) float64
        Finite.
    budget : WorkBudget, optional
        Every iteration is charged to it; where it ends, the question ends with the multipliers that it has.

    Raises
    ------
    MissingExtraError
        If highspy is not installed.

    Examples
    --------
    >>> import scipy.sparse as sp
    >>> rows, zero, one = sp.csr_matrix([[1.0, 1.0]]), np.zeros(2), np.ones(2)
    >>> program = DualLinearProgram(rows, np.array([-np.inf]), np.array([1.5]), zero, one)
    >>> program.ask(np.array([1.0, 2.0])), program.x.round(6)
    (array([1.]), array([0.5, 1. ]))
    """

    def __init__(
        self,
        rows: sp.csr_matrix,
        low: Floats,
        high: Floats,
        least: Floats,
        most: Floats,
        budget: WorkBudget | None = None,
    ) -> None:
        import scipy.sparse as sp  # slow to import, and not always needed

        highspy = need_highs()
        self.up, self.down = np.flatnonzero(np.isfinite(high)), np.flatnonzero(np.isfinite(low))
        (self.count, n), self.more = rows.shape, False
        rows = rows.tocsr()
        one = sp.identity(n, format="csr")
        matrix = sp.hstack([rows[self.up].T, -rows[self.down].T, one, -one]).tocsc()
        cost = np.concatenate([high[self.up], -low[self.down], most, -least])
        self.work = ITERATION_WORK + ITERATION_WORK_PER_ENTRY * matrix.nnz
        budget = budget or WorkBudget()
        budget.spend(BUILD_ITERATIONS * self.work)
        self.highs = quiet_solver(highspy, partial(budget.spend, self.work), n)
        self.highs.passModel(standard_form(highspy, cost, matrix, np.zeros(n)))
        self.every = np.arange(n, dtype=np.int32)
        self.x: Floats = np.zeros(n)

    def with_row(self, row: Floats, low: float, budget: WorkBudget) -> DualLinearProgram:
        """The same program with one more row (n,), row . x >= low, which begins where this one ended; it is charged to another budget."""
        highspy = need_highs()
        other: DualLinearProgram = object.__new__(DualLinearProgram)
        other.up, other.down, other.every, other.x = self.up, self.down, self.every, self.x
        other.count, other.more = self.count, True
        other.work = self.work
        other.highs = quiet_solver(highspy, partial(budget.spend, self.work), len(self.every))
        other.highs.passModel(self.highs.getLp())
        other.highs.setBasis(self.highs.getBasis())
        used = np.flatnonzero(row).astype(np.int32)
        other.highs.addCol(-low, 0.0, highspy.kHighsInf, len(used), used, -row[used])
        return other

    def ask(self, cost: Floats, *, interior: bool = False) -> Floats:
        """Multipliers (m,) of the rows, positive where a row's upper side holds; where it ended is left in `x`.

        `interior` solves it by an interior-point method that leaves no basis to go on from: many times as quick for a large program.
        The same is done where the simplex method cycles.
        """
        self.highs.changeRowsBounds(len(self.every), self.every, cost, cost)
        for solver in ("ipm",) if interior else ("simplex", "ipm"):
            self.highs.setOptionValue("solver", solver)
            self.highs.run()
            if self.highs.getModelStatus() != need_highs().HighsModelStatus.kIterationLimit:
                break
        found = self.highs.getSolution()
        y = np.zeros(self.count + self.more)
        value = np.array(found.col_value)
        if len(value) and np.isfinite(value).all():
            value = np.maximum(value, 0.0)
            y[self.up] += value[: len(self.up)]
            y[self.down] -= value[len(self.up) : len(self.up) + len(self.down)]
            if self.more:
                y[-1] = -value[-1]
            self.x = np.array(found.row_dual)
        return y

    @property
    def iterations(self) -> int:
        """Of the simplex method, in the last question."""
        return int(self.highs.getInfo().simplex_iteration_count)


def standard_form(highspy: Any, cost: Floats, matrix: sp.csc_matrix, total: Floats) -> Any:
    """Program of HiGHS: min cost . x with matrix x = total and x >= 0; `matrix` (m, k) by columns."""
    lp = highspy.HighsLp()
    lp.num_row_, lp.num_col_ = matrix.shape
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = cost, np.zeros(len(cost)), np.full(len(cost), highspy.kHighsInf)
    lp.row_lower_ = lp.row_upper_ = total
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = matrix.indptr, matrix.indices, matrix.data
    return lp


def quiet_solver(highspy: Any, over: Callable[[], bool], rows: int) -> Any:
    """Simplex method of HiGHS that prints nothing, for programs with so many rows, which asks at every iteration whether it is `over`."""

    class Silent(highspy.Highs):  # type: ignore[misc]
        """Prints nothing: where its constructor asks for callbacks, HiGHS 1.16 would print a line before it can be told."""

        def enableCallbacks(self) -> None:  # noqa: N802
            self.setOptionValue("output_flag", False)
            super().enableCallbacks()

    solver = Silent()

    def interrupt(kind: Any, message: str, found: Any, answer: Any, more: Any) -> None:  # noqa: ARG001
        answer.user_interrupt = over()

    solver.setCallback(interrupt, None)
    for kind in ("kCallbackSimplexInterrupt", "kCallbackIpmInterrupt"):
        solver.startCallback(getattr(highspy.cb.HighsCallbackType, kind))
    for option, value in (
        ("output_flag", False),
        ("simplex_iteration_limit", max(MAX_ITERATIONS_PER_ROW * rows, MIN_ITERATION_LIMIT)),
        ("threads", 1),
        ("solver", "simplex"),
        ("presolve", "off"),
        ("run_crossover", "off"),
    ):
        solver.setOptionValue(option, value)
    return solver
