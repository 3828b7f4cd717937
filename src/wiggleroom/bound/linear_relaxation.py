"""Linear relaxation: a linear program that every reachable motion satisfies, from all outer regions and envelopes of cos and sin.

Variables of a body: x, y [mm], turn t [rad], C for cos t - 1 and S for sin t. Variables of a pair: the motion tau of its
pivot, as its first body sees it. The pivot moves with both bodies; with arms p, q from their origins to it,

    x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) (p + mid) = mid + R(t_a) (tau - mid)

exactly, where mid is the middle of what tau can be. C and S make the left side linear. On the right R is taken at the
middle angle; it errs by at most |tau - mid| 2 sin(half width / 2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.bound.trigonometric_envelopes import envelope
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion
from wiggleroom.freespace.outer.outer_facets import Facets, facets
from wiggleroom.freespace.outer.outer_region import OuterRegion
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.program.objectives import PointMotion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RANGE_FACTOR = 1 + 1e-4
"""First ranges are wider by this factor, so that facets hold the program up, which can be refined."""
ROW_MARGIN = 1e-12
"""Rows hold a little more than they must, by this share of the drawing's size: their coefficients are rounded."""


@dataclass(frozen=True, eq=False)
class JointConstraints:
    """Pairs of bodies whose relative motion is bounded.

    Parameters
    ----------
    a, b : (P,) int64
    kind : (P,) int64
        Which outer region.
    arm_a, arm_b : (P, 2) float64 [mm]
        From each body's origin to the pivot, at rest, in the world's axes.
    axes : (P,) float64 [rad]
        Angle of A's axes at rest.
    """

    a: Ints
    b: Ints
    kind: Ints
    arm_a: Floats
    arm_b: Floats
    axes: Floats


@dataclass(frozen=True, eq=False)
class AngleRanges:
    """Where bodies can be; infinite where nothing is known.

    Parameters
    ----------
    low, high : (n,) float64 [rad]
        Least and greatest turn.
    far : (n,) float64 [mm]
        Largest shift of the origin.
    """

    low: Floats
    high: Floats
    far: Floats


class InfeasibleRelaxation(Exception):  # noqa: N818
    """No motion lies in the given ranges: they leave this pair no turn."""

    def __init__(self, pair: int) -> None:
        super().__init__(pair)
        self.pair = pair


@dataclass(frozen=True, eq=False)
class LinearRelaxation:
    """max cost . x subject to low <= rows x <= high, least <= x <= most, everything scaled to be near one.

    Parameters
    ----------
    rows : (m, n) sparse
    low, high : (m,) float64
    least, most : (n,) float64
        Finite.
    cost : (n,) float64
    unit : (n,) float64
        A variable times its unit is [mm] or [rad].
    scale : (m,) float64
        Factor of each row.
    turn : (bodies,) int64
        Column of each body's turn, -1 where it has none.
    facet : (R, 2) int64
        Pair and number of its facet of the last R rows.
    cut : dict
        Facets of each pair, in the axes of its first body.
    """

    rows: sp.csr_matrix
    low: Floats
    high: Floats
    least: Floats
    most: Floats
    cost: Floats
    unit: Floats
    scale: Floats
    turn: Ints
    facet: Ints
    cut: dict[int, Facets]


def first_ranges(
    bodies: Bodies, links: JointConstraints, regions: Sequence[OuterRegion | CagingSurface | LocalOuterRegion]
) -> AngleRanges:
    """Turns and shifts add up along ways to fixed bodies; the shortest way counts."""
    root = bodies.fixed
    turns = np.array([regions[k].turns for k in links.kind]).reshape(-1, 2)
    up = _shortest(links, turns[:, 1], -turns[:, 0], root)
    down = _shortest(links, -turns[:, 0], turns[:, 1], root)
    most = np.minimum(np.maximum(up, down), np.pi)
    swing = 2 * np.sin(most / 2)
    far = np.array([regions[k].far for k in links.kind])
    with np.errstate(invalid="ignore"):
        step = far + np.hypot(*links.arm_a.T) * swing[links.a] + np.hypot(*links.arm_b.T) * swing[links.b]
    shift = _shortest(links, step, step, root)
    return AngleRanges(-down * RANGE_FACTOR, up * RANGE_FACTOR, shift * RANGE_FACTOR)


def _shortest(links: JointConstraints, forth: Floats, back: Floats, root: NDArray[np.bool_]) -> Floats:
    """Shortest ways (n,) from the roots where link k costs forth[k] >= 0 from a to b and back[k] the other way."""
    source, target = np.concatenate([links.a, links.b]), np.concatenate([links.b, links.a])
    length = np.concatenate([forth, back])
    way = np.where(root, 0.0, np.inf)
    while True:
        shorter = way.copy()
        np.minimum.at(shorter, target, way[source] + length)
        if not (shorter < way).any():
            return way
        way = shorter


def relaxation(
    bodies: Bodies,
    links: JointConstraints,
    regions: Sequence[OuterRegion | CagingSurface],
    ranges: AngleRanges,
    goal: PointMotion,
    unit: float,
    size: float,
) -> LinearRelaxation:
    """Put regions, envelopes and the goal into one linear program.

    Parameters
    ----------
    unit : float [mm]
        Typical clearance.
    size : float [mm]
        Of the drawing.

    Raises
    ------
    NothingLeft
        If the ranges leave a pair no turn at all.
    """
    return _RowBuilder(bodies, links, regions, ranges, unit, size).build(goal)


class _RowBuilder:
    """Rows as they are collected; columns of a body are x, y, t, C, S, those of a pair follow."""

    def __init__(
        self,
        bodies: Bodies,
        links: JointConstraints,
        regions: Sequence[OuterRegion | CagingSurface],
        ranges: AngleRanges,
        unit: float,
        size: float,
    ) -> None:
        self.links, self.regions, self.ranges = links, regions, ranges
        self.pad = ROW_MARGIN * size
        moving = np.flatnonzero(~bodies.fixed & np.isfinite(ranges.far))
        self.column = np.full(len(bodies.fixed), -1, dtype=np.int64)
        self.column[moving] = 5 * np.arange(len(moving))
        self.moving, self.pairs = moving, 5 * len(moving)
        self.length, self.angle = unit, unit / float(bodies.radius.mean())
        self.parts: list[tuple[Ints, Ints, Floats]] = []
        self.low: list[Floats] = []
        self.high: list[Floats] = []
        self.count = 0
        self.cut: dict[int, Facets] = {}

    def add(self, columns: Ints, values: Floats, low: Floats, high: Floats) -> None:
        """Rows (k, e) of columns and values; column -1 is a variable that is nought."""
        row = self.count + np.repeat(np.arange(len(low)), columns.shape[1]).reshape(columns.shape)
        keep = columns >= 0
        self.parts.append((row[keep], columns[keep], values[keep]))
        self.low.append(low - self.pad)
        self.high.append(high + self.pad)
        self.count += len(low)

    def build(self, goal: PointMotion) -> LinearRelaxation:
        least, most = self._boxes()
        self._envelopes()
        facet = self._pairs(least, most)
        row, column, value = (np.concatenate(p) for p in zip(*self.parts, strict=True))
        rows = sp.csr_matrix((value, (row, column)), shape=(self.count, len(least)))
        unit = np.full(len(least), self.length)
        for k in (2, 3, 4):
            unit[k : self.pairs : 5] = self.angle
        rows = rows @ sp.diags(unit)
        scale = 1.0 / np.maximum(abs(rows).max(axis=1).toarray().ravel(), 1e-300)
        rows = (sp.diags(scale) @ rows).tocsr()
        low, high = np.concatenate(self.low) * scale, np.concatenate(self.high) * scale
        turns = np.where(self.column >= 0, self.column + 2, -1)
        return LinearRelaxation(
            rows,
            low,
            high,
            least / unit,
            most / unit,
            self._cost(goal, len(least)) * unit,
            unit,
            scale,
            turns,
            facet,
            self.cut,
        )

    def _boxes(self) -> tuple[Floats, Floats]:
        n = self.pairs + 2 * len(self.links.a)
        least, most = np.zeros(n), np.zeros(n)
        far, low, high = (v[self.moving] for v in (self.ranges.far, self.ranges.low, self.ranges.high))
        for k, (one, other) in enumerate(((-far, far), (-far, far), (low, high))):
            least[k : self.pairs : 5], most[k : self.pairs : 5] = one, other
        least[3 : self.pairs : 5], most[3 : self.pairs : 5] = -2.0 - ROW_MARGIN, ROW_MARGIN
        least[4 : self.pairs : 5], most[4 : self.pairs : 5] = -1.0 - ROW_MARGIN, 1.0 + ROW_MARGIN
        return least, most

    def _envelopes(self) -> None:
        rows, most = envelope(self.ranges.low[self.moving], self.ranges.high[self.moving])
        column = self.column[self.moving][:, None, None] + np.array([3, 4, 2])
        columns = np.broadcast_to(column, rows.shape).reshape(-1, 3)
        pad, self.pad = self.pad, 1e-15
        self.add(columns, rows.reshape(-1, 3), np.full(most.size, -np.inf), most.ravel())
        self.pad = pad

    def _pairs(self, least: Floats, most: Floats) -> Ints:
        links, lo, hi = self.links, self.ranges.low, self.ranges.high
        known = np.flatnonzero(np.isfinite(self.ranges.far[links.a]) & np.isfinite(self.ranges.far[links.b]))
        a, b = links.a[known], links.b[known]
        turns = np.column_stack([lo[b] - hi[a], hi[b] - lo[a]])
        cut = [self._region(int(p), *t) for p, t in zip(known, turns, strict=True)]
        middle, reach = np.array([f.middle for f in cut]).reshape(-1, 2), np.array([f.reach for f in cut])
        tau = self.pairs + 2 * known
        least[self.pairs :: 2][known], most[self.pairs :: 2][known] = middle[:, 0] - reach, middle[:, 0] + reach
        least[self.pairs + 1 :: 2][known], most[self.pairs + 1 :: 2][known] = middle[:, 1] - reach, middle[:, 1] + reach
        mid, half = (lo[a] + hi[a]) / 2, (hi[a] - lo[a]) / 2
        c, s = np.cos(mid), np.sin(mid)
        blur = reach * 2 * np.sin(np.minimum(half, np.pi) / 2) * (1 + 1e-12)
        p, q = links.arm_a[known] + middle, links.arm_b[known]
        i, j = self.column[a], self.column[b]
        own = [np.where(i >= 0, i + k, -1) for k in range(5)], [np.where(j >= 0, j + k, -1) for k in range(5)]
        one = np.ones(len(known))
        at_x = middle[:, 0] - (c * middle[:, 0] - s * middle[:, 1])
        at_y = middle[:, 1] - (s * middle[:, 0] + c * middle[:, 1])
        self.add(
            np.column_stack([own[1][0], own[1][3], own[1][4], own[0][0], own[0][3], own[0][4], tau, tau + 1]),
            np.column_stack([one, q[:, 0], -q[:, 1], -one, -p[:, 0], p[:, 1], -c, s]),
            at_x - blur, at_x + blur,
        )  # fmt: skip
        self.add(
            np.column_stack([own[1][1], own[1][4], own[1][3], own[0][1], own[0][4], own[0][3], tau, tau + 1]),
            np.column_stack([one, q[:, 0], q[:, 1], -one, -p[:, 0], -p[:, 1], -s, -c]),
            at_y - blur, at_y + blur,
        )  # fmt: skip
        count = np.array([len(f.offset) for f in cut], dtype=np.int64)
        which = np.repeat(np.arange(len(known)), count)
        normal, offset = np.concatenate([f.normal for f in cut]), np.concatenate([f.offset for f in cut])
        columns = np.column_stack([tau[which], tau[which] + 1, own[1][2][which], own[0][2][which]])
        self.add(columns, np.column_stack([normal, -normal[:, 2]]), np.full(len(which), -np.inf), offset)
        number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
        return np.column_stack([known[which], number])

    def _region(self, p: int, low: float, high: float) -> Facets:
        """Facets of a pair in the world's axes at rest."""
        found = facets(self.regions[self.links.kind[p]], low, high)
        if found is None:
            raise InfeasibleRelaxation(p)
        self.cut[p] = found
        angle = np.full(1, self.links.axes[p])
        normal = np.column_stack([turn(found.normal[:, :2], angle), found.normal[:, 2]])
        return replace(found, normal=normal, middle=turn(found.middle[None], angle)[0])

    def _cost(self, goal: PointMotion, n: int) -> Floats:
        cost = np.zeros(n)
        for body, direction, arm, turns in zip(goal.body, goal.direction, goal.arm, goal.turn, strict=True):
            k = self.column[body]
            if k >= 0:
                dx, dy = direction
                cost[k : k + 5] += (dx, dy, turns, dx * arm[0] + dy * arm[1], dy * arm[0] - dx * arm[1])
        return cost


def narrowed(ranges: AngleRanges, low: Floats, high: Floats) -> AngleRanges:
    """The same ranges with turns cut to the given ones."""
    return replace(ranges, low=np.maximum(ranges.low, low), high=np.minimum(ranges.high, high))
