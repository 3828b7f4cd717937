"""A linear program that every reachable motion satisfies: its multipliers prove a bound.

Variables of a body: x, y [mm], turn t [rad], C for cos t - 1 and S for sin t. Variables of a joint: the motion tau of its
pivot, as its first body sees it, and the products U = v d_x, W = v d_y, d = tau less the middle of what tau can be and v the first
body's turn less its middle. The pivot moves with both bodies; with arms p, q from their origins to it,

    x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) (p + mid) = mid + R(middle) (d + v J d) + remainder

exactly. C and S make the left side linear; a product of bounded factors keeps four inequalities (McCormick 1976). Rows that
couple C and S of two joined bodies know that both turn nearly alike. Where a turn is known too badly for products, R is
taken at its middle alone.

What the program says is not believed: `multipliers` is what matters, see `joint_multipliers`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints
from wiggleroom.bound.joint_multipliers import (
    COSINE,
    CURVATURE,
    FORCE_X,
    FORCE_Y,
    MEAN_SLOPE,
    MOMENT,
    MULTIPLIERS,
    SINE,
    TURN_SLOPE,
)
from wiggleroom.bound.joint_ranges import JointRanges
from wiggleroom.bound.trigonometric_envelopes import envelope
from wiggleroom.geometry.relative_pose import rotated

if TYPE_CHECKING:
    import scipy.sparse as sp

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

WIDEST_PRODUCT = 1.0
"""Products of turn and tau are kept where the half width of the turn is less [rad]."""
CURVED_REACH = 4.0
"""|v d| <= |d| (r + v^2 / r) / 2 is a row for r this many times what d can be, divided by the body's radius; for turns less than twice r
it says nothing new."""
ROUNDING_MARGIN = 1e-12
"""Boxes are larger by this."""
BODY, JOINT = 5, 4
"""Number of variables of each."""


@dataclass(frozen=True, eq=False)
class LinearRelaxation:
    """max cost . x subject to low <= rows x <= high, least <= x <= most, everything scaled to be near one.

    Parameters
    ----------
    rows : (m, n) sparse
    low, high : (m,) float64
    least, most : (n,) float64
        Finite.
    unit : (n,) float64
        A variable times its unit is [mm] or [rad].
    column : (bodies,) int64
        First column of each body, -1 where it has none.
    reading : (8 P, m) sparse
        Multipliers of joints from those of rows.
    facet : (R, 2) int64
        Joint and number of its facet of the last R rows.
    """

    rows: sp.csr_matrix
    low: Floats
    high: Floats
    least: Floats
    most: Floats
    unit: Floats
    column: Ints
    reading: sp.csr_matrix
    facet: Ints

    def cost(self, weights: Floats) -> Floats:
        """Cost (n,) of weights (5 bodies,) of x, y, C - 1, S and t."""
        held = np.flatnonzero(self.column >= 0)
        out = np.zeros(len(self.unit))
        columns = self.column[held][:, None] + np.array([0, 1, 3, 4, 2])
        out[columns] = weights.reshape(-1, 5)[held]
        return out * self.unit

    def multipliers(self, y: Floats) -> Floats:
        """Multipliers (K, P, 8) of joints from those of rows (K, m)."""
        return np.asarray((self.reading @ y.T).T).reshape(len(y), -1, MULTIPLIERS)


def relaxation(
    fixed: Bools, radius: Floats, joints: JointConstraints, at: JointRanges, ranges: AngleRanges, unit: float
) -> LinearRelaxation:
    """Put regions, envelopes, products and couplings into one linear program; `unit` [mm] is a typical clearance."""
    return _RowBuilder(fixed, radius, joints, at, ranges, unit).build()


class _RowBuilder:
    """Rows as they are collected; columns of a body are x, y, t, C, S, those of a joint follow: tau and both products."""

    def __init__(
        self,
        fixed: Bools,
        radius: Floats,
        joints: JointConstraints,
        at: JointRanges,
        ranges: AngleRanges,
        unit: float,
    ) -> None:
        self.joints, self.at, self.ranges = joints, at, ranges
        self.moving = np.flatnonzero(~fixed & np.isfinite(ranges.far))
        self.column = np.full(len(fixed), -1, dtype=np.int64)
        self.column[self.moving] = BODY * np.arange(len(self.moving))
        self.first = BODY * len(self.moving)
        self.tau = self.first + JOINT * np.arange(len(joints.a))
        self.split = CURVED_REACH * at.half.max(axis=1, initial=0.0) / radius[joints.a]
        self.curved = (at.half_turn < WIDEST_PRODUCT) & (at.half_turn > 2 * self.split) & (self.column[joints.a] >= 0)
        self.least = 1 - at.half_turn**2 / 12  # 1 - cos v is at least this share of v^2 / 2
        self.length, self.angle = unit, unit / float(radius.mean())
        self.parts: list[tuple[Ints, Ints, Floats]] = []
        self.read: list[tuple[Ints, Ints, Floats]] = []
        self.low: list[Floats] = []
        self.high: list[Floats] = []
        self.count = 0
        own = [np.where(self.column[k] >= 0, self.column[k], -BODY) for k in (joints.a, joints.b)]
        self.own = [[np.where(k >= 0, k + v, -1) for v in range(BODY)] for k in own]

    def add(
        self,
        columns: list[Ints],
        values: Sequence[Floats | float],
        low: Floats | float,
        high: Floats | float,
        reading: dict[int, Floats | float] | None = None,
        which: Ints | None = None,
    ) -> None:
        """Rows of columns and values, (k,) each; column -1 is a variable that is nought.

        `reading` says what multipliers of the joints `which` (k,) a row's own counts for.
        """
        count = len(columns[0])
        column, value = np.column_stack(columns), np.column_stack([np.broadcast_to(v, count) for v in values])
        row = np.broadcast_to((self.count + np.arange(count))[:, None], column.shape)
        keep = column >= 0
        self.parts.append((row[keep], column[keep], value[keep]))
        for multiplier, factor in (reading or {}).items():
            joint = np.arange(count) if which is None else which
            self.read.append(
                (MULTIPLIERS * joint + multiplier, self.count + np.arange(count), np.broadcast_to(factor, count))
            )
        self.low.append(np.broadcast_to(low, count).astype(float))
        self.high.append(np.broadcast_to(high, count).astype(float))
        self.count += count

    def build(self) -> LinearRelaxation:
        import scipy.sparse as sp  # slow to import, and not always needed

        least, most = self._boxes()
        self._envelopes()
        self._pivots()
        self._products()
        self._couplings()
        facet = self._facets()
        shape = (self.count, len(least))
        row, column, value = (np.concatenate(p) for p in zip(*self.parts, strict=True))
        rows = sp.csr_matrix((value, (row, column)), shape=shape)
        unit = np.full(len(least), self.length)
        for k in (2, 3, 4):
            unit[k : self.first : BODY] = self.angle
        for k in (2, 3):
            unit[self.first + k :: JOINT] = self.length * self.angle
        rows = rows @ sp.diags(unit)
        scale = 1.0 / np.maximum(abs(rows).max(axis=1).toarray().ravel(), 1e-300)
        rows = (sp.diags(scale) @ rows).tocsr()
        low, high = np.concatenate(self.low) * scale, np.concatenate(self.high) * scale
        row, column, value = (np.concatenate(p) for p in zip(*self.read, strict=True))
        reading = sp.csr_matrix((value, (row, column)), shape=(MULTIPLIERS * len(self.joints.a), self.count))
        return LinearRelaxation(
            rows, low, high, least / unit, most / unit, unit, self.column, (reading @ sp.diags(scale)).tocsr(), facet
        )

    def _boxes(self) -> tuple[Floats, Floats]:
        n, at = self.first + JOINT * len(self.joints.a), self.at
        least, most = np.zeros(n), np.zeros(n)
        far, low, high = (v[self.moving] for v in (self.ranges.far, self.ranges.low, self.ranges.high))
        one = np.ones(len(far))
        for k, (start, end) in enumerate(((-far, far), (-far, far), (low, high), (-2 * one, 0 * one), (-one, one))):
            least[k : self.first : BODY], most[k : self.first : BODY] = start - ROUNDING_MARGIN, end + ROUNDING_MARGIN
        product = at.half_turn[:, None] * at.half + ROUNDING_MARGIN
        for k in (0, 1):
            least[self.tau + k], most[self.tau + k] = -at.half[:, k], at.half[:, k]
            least[self.tau + 2 + k], most[self.tau + 2 + k] = -product[:, k], product[:, k]
        return least, most

    def _envelopes(self) -> None:
        rows, most = envelope(self.ranges.low[self.moving], self.ranges.high[self.moving])
        column = self.column[self.moving][:, None, None] + np.array([3, 4, 2])
        columns = np.broadcast_to(column, rows.shape).reshape(-1, 3)
        self.add([*columns.T], [*rows.reshape(-1, 3).T], -np.inf, most.ravel())

    def _pivots(self) -> None:
        """The equation above, in x and in y."""
        at, (a, b) = self.at, self.own
        p, q = self.joints.arm_a + at.middle, self.joints.arm_b
        c, s = np.cos(at.turn), np.sin(at.turn)
        kept = at.half_turn < WIDEST_PRODUCT
        error = np.where(kept, at.bend, at.blur)
        dx, dy = self.tau, self.tau + 1
        vx, vy = (np.where(kept, self.tau + k, -1) for k in (2, 3))
        one = np.ones(len(c))
        # of turns that are known badly the remainder is a share of 1 - cos v
        share = np.where(self.curved, at.reach * (1 + at.half_turn / 3) / self.least, 0.0)
        error = np.where(self.curved, 0.0, error) + share * (1 - c)
        for k, force, columns, values in (
            (
                0,
                FORCE_X,
                [b[0], b[3], b[4], a[0], a[3], a[4], dx, dy, vx, vy],
                [one, q[:, 0], -q[:, 1], -one, -p[:, 0], p[:, 1], -c, s, s, c],
            ),
            (
                1,
                FORCE_Y,
                [b[1], b[4], b[3], a[1], a[4], a[3], dx, dy, vx, vy],
                [one, q[:, 0], q[:, 1], -one, -p[:, 0], -p[:, 1], -s, -c, -c, s],
            ),
        ):
            middle = at.middle[:, k]
            plain = np.flatnonzero(~self.curved)
            mine = [v[plain] for v in columns], [v[plain] for v in values]
            self.add(*mine, middle[plain] - error[plain], middle[plain] + error[plain], {force: 1.0}, plain)
            some = np.flatnonzero(self.curved)
            for sign in (1.0, -1.0):
                bent = sign * share[some]
                self.add(
                    [*(v[some] for v in columns), a[3][some], a[4][some]],
                    [*(v[some] for v in values), bent * c[some], bent * s[some]],
                    -np.inf if sign > 0 else middle[some] - error[some],
                    middle[some] + error[some] if sign > 0 else np.inf,
                    {force: 1.0, CURVATURE: bent},
                    some,
                )

    def _products(self) -> None:
        """(h -+ v) (D -+ d) >= 0 for both products of a turn that is known well enough, and what 1 - cos v leaves of them."""
        at, turned = self.at, self.own[0][2]
        some = np.flatnonzero((at.half_turn < WIDEST_PRODUCT) & (turned >= 0))
        h, middle = at.half_turn[some], at.turn[some]
        for k in (0, 1):
            most = at.half[some, k]
            for one in (1.0, -1.0):
                for two in (1.0, -1.0):
                    self.add(
                        [self.tau[some] + 2 + k, self.tau[some] + k, turned[some]],
                        [-one * two, two * h, one * most],
                        -np.inf,
                        h * most + one * most * middle,
                        {TURN_SLOPE: -one * most},
                        some,
                    )
        some = np.flatnonzero(self.curved)
        c, s = np.cos(at.turn[some]), np.sin(at.turn[some])
        for k in (0, 1):
            most = at.half[some, k]
            share = most / (self.split[some] * self.least[some])
            for one in (1.0, -1.0):
                self.add(
                    [self.tau[some] + 2 + k, self.own[0][3][some], self.own[0][4][some]],
                    [one, share * c, share * s],
                    -np.inf,
                    most * self.split[some] / 2 + share * (1 - c),
                    {CURVATURE: share},
                    some,
                )

    def _couplings(self) -> None:
        """Sines and cosines of two joined bodies differ by their relative turn times the cosine and sine of their mean."""
        at, (a, b) = self.at, self.own
        some = np.flatnonzero(at.coupled)
        c, s, f = np.cos(at.mean[some]), np.sin(at.mean[some]), at.chord[some]
        columns = [v[some] for v in (b[3], a[3], b[4], a[4], b[2], a[2])]
        self.add(
            columns, [-s, s, c, -c, -f, f], -at.sag[some], at.sag[some], {SINE: -1.0, MOMENT: -f}, some
        )  # fmt: skip
        h, mean, skew = at.half_mean[some], at.mean[some], at.skew[some]
        for end, one in ((at.low[some], -1.0), (at.high[some], 1.0)):
            # u phi >= end u + one h (phi - end) or <= end u - one h (phi - end)
            for side in (1.0, -1.0):
                slope = side * one * h
                self.add(
                    columns,
                    [-side * c, side * c, -side * s, side * s, -side * end / 2 - side * slope, -side * end / 2 + side * slope],
                    -skew - side * (end * mean + slope * end),
                    np.inf,
                    {COSINE: side, MEAN_SLOPE: side * end, MOMENT: -side * slope},
                    some,
                )  # fmt: skip
        self.add([columns[4], columns[5]], [1.0, -1.0], at.low[some], at.high[some], {MOMENT: 1.0}, some)

    def _facets(self) -> Ints:
        at = self.at
        count = np.array([len(cut.offset) for cut in at.cuts], dtype=np.int64)
        which = np.repeat(np.arange(len(count)), count)
        normal = np.concatenate([cut.normal for cut in at.cuts])
        plane = rotated(normal[:, :2], self.joints.axes[which])
        offset = np.concatenate([cut.offset for cut in at.cuts]) - (plane * at.middle[which]).sum(1)
        a, b = self.own[0][2][which], self.own[1][2][which]
        tilt = normal[:, 2]
        self.add(
            [self.tau[which], self.tau[which] + 1, b, a],
            [plane[:, 0], plane[:, 1], tilt, -tilt],
            -np.inf,
            offset,
            {MOMENT: tilt},
            which,
        )
        number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
        return np.column_stack([which, number])
