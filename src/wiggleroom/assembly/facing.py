"""Which stretches of two outlines face each other: where a joint's own gap applies."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.loops import SAME, Loops
from wiggleroom.drawing.model import Points

OPPOSITE = -np.cos(np.radians(15.0))
"""Edges face each other where their directions are opposite to within this; flattened curves need some room."""


LEEWAY = 1e-3
"""Sides of a joint may lie apart by this share of the smaller part's size more than its parts do: drawings are not exact."""


@dataclass(frozen=True)
class Stretch:
    """Part of one edge, from `low` to `high` [mm] along it, that moves inward by `inward` [mm], for joint `joint` of the drawing."""

    edge: int
    low: float
    high: float
    inward: float
    joint: int


def joint_reach(drawn: float, deep: float, size: float, room: float = 0.0) -> tuple[float, float]:
    """How far apart two sides of a joint may lie [mm], and how far behind each other; edges in the plane, faces in space.

    Only the parts as drawn have a say: the same sides face each other whatever the gaps are, so parts only get smaller as these grow.

    Parameters
    ----------
    drawn : float [mm]
        Distance of both parts.
    deep : float [mm]
        How far they overlap, where they are drawn larger than they will be.
    size : float [mm]
        Of the smaller part.
    room : float [mm]
        For flattened curves.
    """
    near = room + LEEWAY * size
    return 1.1 * drawn + near, max(0.1 * drawn, deep) + near


def facing_stretches(a: Loops, b: Loops, reach: float, slack: float) -> list[tuple[int, float, float]]:
    """Stretches of `a` that face `b`, as (edge, from, to) with lengths along the edge [mm].

    Parameters
    ----------
    a, b : Loops [mm]
        Outlines of two parts in assembly coordinates, material left of every edge.
    reach : float [mm]
        Edges further apart do not face each other. Stretches are joined across, and run on to a corner over,
        this length.
    slack : float [mm]
        How far `b` may lie behind an edge of `a`.

    Examples
    --------
    >>> from wiggleroom.assembly.loops import chained
    >>> brick = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    >>> facing_stretches(chained([brick]), chained([brick + (2.0, 0.5)]), 1e-6, 1e-6)
    [(1, 0.5, 1.0)]
    """
    low, high, lengths = _overlaps(a, b, reach, slack)
    found = []
    for edge in np.flatnonzero((high - low > reach * 1e-3).any(axis=1)):
        faces = np.flatnonzero(high[edge] - low[edge] > reach * 1e-3)
        order = faces[np.argsort(low[edge, faces])]
        found += [(int(edge), *s) for s in _joined(low[edge, order], high[edge, order], reach, lengths[edge])]
    return found


def _overlaps(a: Loops, b: Loops, reach: float, slack: float) -> tuple[Points, Points, NDArray[np.float64]]:
    """Where each edge of `b` (columns) lies before each edge of `a` (rows): from, to, and lengths of a's edges."""
    edge_a, edge_b = a.points[a.after] - a.points, b.points[b.after] - b.points
    lengths = np.hypot(*edge_a.T)
    along = edge_a / lengths[:, None]
    out = np.column_stack([along[:, 1], -along[:, 0]])
    opposite = along @ (edge_b / np.hypot(*edge_b.T)[:, None]).T < OPPOSITE
    first, last = (p[None, :] - a.points[:, None] for p in (b.points[b.after], b.points))
    s0, s1 = (np.einsum("ijk,ik->ij", p, along) for p in (first, last))
    h0, h1 = (np.einsum("ijk,ik->ij", p, out) for p in (first, last))
    span = np.where(opposite, s1 - s0, 1.0)
    slope = (h1 - h0) / span
    level = np.abs(h1 - h0) <= 1e-3 * reach
    steep = np.where(level, 1.0, slope)
    near, far = s0 + (-slack - h0) / steep, s0 + (reach - h0) / steep
    middle = (h0 + h1) / 2
    beside = opposite & (~level | ((middle >= -slack) & (middle <= reach)))
    low = np.maximum(np.maximum(s0, 0.0), np.where(level, -np.inf, np.minimum(near, far)))
    high = np.minimum(np.minimum(s1, lengths[:, None]), np.where(level, np.inf, np.maximum(near, far)))
    return np.where(beside, low, 0.0), np.where(beside, high, -1.0), lengths


def _joined(low: Points, high: Points, reach: float, length: float) -> list[tuple[float, float]]:
    """Sorted stretches of one edge, joined where less than `reach` lies between them or before a corner."""
    merged: list[tuple[float, float]] = []
    for start, end in zip(low.tolist(), high.tolist(), strict=True):
        if merged and start - merged[-1][1] <= reach:
            merged[-1] = (merged[-1][0], max(end, merged[-1][1]))
        else:
            merged.append((start, end))
    return [(0.0 if s <= reach else s, float(length) if length - e <= reach else e) for s, e in merged]


def split_ring(ring: Points, inward: float, stretches: list[Stretch]) -> tuple[Points, NDArray[np.float64]]:
    """Ring (n, 2) [mm] with corners added where stretches end, and the displacement of every edge [mm].

    Where stretches overlap the last one counts.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> split_ring(square, 0.1, [Stretch(0, 1.0, 4.0, 0.5, 0)])[1].tolist()
    [0.1, 0.5, 0.1, 0.1, 0.1]
    """
    points, amounts = [], []
    for edge, (start, end) in enumerate(zip(ring, np.roll(ring, -1, axis=0), strict=True)):
        mine = [s for s in stretches if s.edge == edge]
        length = float(np.hypot(*(end - start)))
        inner = np.unique([v for s in mine for v in (s.low, s.high) if v < length * (1 - SAME)])
        ends = [0.0, *inner[np.diff(inner, prepend=0.0) > length * SAME].tolist(), length]
        for low, high in pairwise(ends):
            middle = (low + high) / 2
            points.append(start + (end - start) * (low / length))
            amounts.append(next((s.inward for s in reversed(mine) if s.low < middle < s.high), inward))
    return np.array(points), np.array(amounts)
