"""Bounds of linear programs that rounding cannot spoil: HiGHS finds multipliers, weak duality is evaluated with its rounding error.

For any multipliers y, and boxes least <= x <= most, every x with low <= rows x <= high keeps

    cost . x <= sum of y_k high_k (y_k > 0) or y_k low_k (y_k < 0) + sum over the box of the largest (cost - rows' y)_j x_j.

Bad multipliers give a bad bound, never a wrong one. Source: Neumaier and Shcherbina, "Safe bounds in linear and mixed-integer programming"
(2004).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.errors import see_extra

Floats = NDArray[np.float64]

UNIT_ROUNDOFF = 2.3e-16


def safe_bound(
    cost: Floats, rows: sp.csr_matrix, low: Floats, high: Floats, least: Floats, most: Floats, y: Floats
) -> float:
    """Upper bound of cost . x for all x between `least` and `most` with low <= rows x <= high, by the multipliers `y`.

    Examples
    --------
    >>> rows = sp.csr_matrix([[1.0, 1.0]])
    >>> zero, one = np.zeros(2), np.ones(2)
    >>> round(safe_bound(np.array([1.0, 2.0]), rows, np.array([-np.inf]), np.array([1.5]), zero, one, np.array([1.0])), 9)
    2.5
    """
    return _safe_bound(cost, _turned(rows), low, high, least, most, y)


def _turned(rows: sp.csr_matrix) -> tuple[sp.csr_matrix, sp.csr_matrix, int]:
    """Transposed rows, their absolute values, and how many terms a sum over them has at most."""
    back = rows.T.tocsr()
    return back, abs(back), int(np.diff(back.indptr).max(initial=0)) + 4


def _safe_bound(
    cost: Floats,
    turned: tuple[sp.csr_matrix, sp.csr_matrix, int],
    low: Floats,
    high: Floats,
    least: Floats,
    most: Floats,
    y: Floats,
) -> float:
    back, size, deep = turned
    side = np.where(y > 0, high, low)
    y = np.where(np.isfinite(side) & np.isfinite(y), y, 0.0)
    side = np.where(y == 0, 0.0, side)
    rest = cost - back @ y
    doubt = deep * UNIT_ROUNDOFF * (size @ np.abs(y) + np.abs(cost))
    box = np.maximum(rest * least, rest * most)
    blur = doubt * np.maximum(np.abs(least), np.abs(most))
    terms = np.concatenate([y * side, box, blur])
    return float(terms.sum() + (len(terms) + 4) * UNIT_ROUNDOFF * np.abs(terms).sum())


def need_highs() -> Any:
    """Module highspy.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    see_extra("prove", "proving a bound needs highspy", "highspy")
    import highspy

    return highspy


class LinearBounds:
    """One linear program asked again and again with other costs, each answer starting from the one before.

    Raises
    ------
    MissingExtraError
        If highspy is not installed.
    """

    def __init__(
        self, rows: sp.csr_matrix, low: Floats, high: Floats, least: Floats, most: Floats, limit: float = 60.0
    ) -> None:
        highspy = need_highs()
        rows = rows.tocsr()
        self.turned, self.low, self.high, self.least, self.most = _turned(rows), low, high, least, most
        lp = highspy.HighsLp()
        lp.num_row_, lp.num_col_ = rows.shape
        lp.col_cost_ = np.zeros(rows.shape[1])
        lp.col_lower_, lp.col_upper_ = least, most
        lp.row_lower_, lp.row_upper_ = low, high
        lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = (
            rows.indptr,
            rows.indices,
            rows.data,
        )
        self.highs = highspy.Highs()
        for option, value in (
            ("output_flag", False),
            ("threads", 1),
            ("solver", "simplex"),
            ("presolve", "off"),
            ("time_limit", float(limit)),
        ):
            self.highs.setOptionValue(option, value)
        self.highs.passModel(lp)
        self.every = np.arange(rows.shape[1], dtype=np.int32)
        self.x: Floats = np.zeros(rows.shape[1])
        self.y: Floats = np.zeros(rows.shape[0])

    def most_of(self, cost: Floats) -> float:
        """Safe upper bound of cost . x; where it ended is left in `x`, the multipliers in `y`."""
        self.highs.changeColsCost(len(self.every), self.every, -cost)
        self.highs.run()
        found = self.highs.getSolution()
        terms = np.maximum(cost * self.least, cost * self.most)
        plain = float(terms.sum() + 1e-12 * np.abs(terms).sum())
        if not found.dual_valid:
            self.y = np.zeros(len(self.low))
            return plain
        self.x, self.y = np.array(found.col_value), -np.array(found.row_dual)
        bound = _safe_bound(cost, self.turned, self.low, self.high, self.least, self.most, self.y)
        return min(plain, bound)

    def change_row(self, row: int, low: float, high: float) -> None:
        """Put other sides to one row."""
        self.low, self.high = self.low.copy(), self.high.copy()
        self.low[row], self.high[row] = low, high
        self.highs.changeRowBounds(row, low, high)
