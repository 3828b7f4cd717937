"""Corners of bodies and edges of their neighbours that are near each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.row_kinds import A_EDGE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shorts = NDArray[np.int32]
Kinds = NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class VertexEdgePairs:
    """Corners and edges of each of P pairs that are near each other.

    Parameters
    ----------
    a, b : (P,) int64
        Bodies.
    row : (P + 1,) int64
        Rows of pair p are row[p] .. row[p + 1].
    kind : (R,) int8
        A_EDGE or B_EDGE of `row_kinds`.
    edge, corner : (R,) int32
        Rows of `BodyShapes`.
    seed : (P, 3) float64 [mm, mm, rad]
        Relative poses at which they were listed.
    """

    a: Ints
    b: Ints
    row: Ints
    kind: Kinds
    edge: Shorts
    corner: Shorts
    seed: Floats

    @property
    def pair(self) -> Ints:
        """Pair of each row (R,)."""
        return np.repeat(np.arange(len(self.a)), np.diff(self.row))


def near_vertices(
    bodies: Bodies, a: Ints, b: Ints, motion: Floats, reach: Floats, beside: Floats, behind: float
) -> VertexEdgePairs:
    """Corners and edges of pairs of bodies that are near each other at a motion (n, 3); congruent pairs are looked at once.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
    motion : (n, 3) float64 [mm, mm, rad]
    reach : (P,) float64 [mm]
        Farthest distance of a corner from an edge.
    beside : (P,) float64 [mm]
        How far beyond the ends of the edge it may lie.
    behind : float [mm]
        How far behind its line: further back, material may lie between.
    """
    shapes, seed = bodies.shapes, relative_pose(bodies, a, b, motion)
    _, congruent = congruence_classes(bodies, a, b, seed)
    _, first, label = np.unique(
        np.column_stack([congruent, reach, beside]), axis=0, return_index=True, return_inverse=True
    )
    label = label.ravel()
    one, other = bodies.shape[a[first]], bodies.shape[b[first]]
    row = np.zeros(len(first) + 1, dtype=np.int64)
    table = shapes.first, shapes.corner, shapes.normal, shapes.length, reach[first], beside[first], behind
    near_pairs(seed[first], one, other, *table, row, *_lists(0), False)
    kind, edge, corner = _lists(int(row[-1]))
    near_pairs(seed[first], one, other, *table, row, kind, edge, corner, True)
    count = np.diff(row)[label]
    start = np.concatenate([[0], np.cumsum(count)])
    take = np.repeat(row[label] - start[:-1], count) + np.arange(start[-1])
    return VertexEdgePairs(a, b, start, kind[take], edge[take], corner[take], seed)


def _lists(rows: int) -> tuple[Kinds, Shorts, Shorts]:
    """Room for kind, edge and corner of so many rows."""
    return np.empty(rows, dtype=np.int8), np.empty(rows, dtype=np.int32), np.empty(rows, dtype=np.int32)


@njit(**NO_ALLOCATION)
def near_pairs(
    g, shape_a, shape_b, first, corner, normal, length, reach, beside, behind, row, kind, edge, vertex, fill
):
    """Corners and edges that are near at relative poses g (P, 3): counted into row (P + 1,), and listed where `fill`."""
    at = 0
    for p in range(len(shape_a)):
        row[p], far = at, reach[p]
        c, s = np.cos(g[p, 2]), np.sin(g[p, 2])
        for k in range(2):
            own, other = (shape_a[p], shape_b[p]) if k == A_EDGE else (shape_b[p], shape_a[p])
            low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
            for e in range(first[own], first[own + 1]):
                low_x, high_x = min(low_x, corner[e, 0]), max(high_x, corner[e, 0])
                low_y, high_y = min(low_y, corner[e, 1]), max(high_y, corner[e, 1])
            for v in range(first[other], first[other + 1]):
                if k == A_EDGE:
                    x = c * corner[v, 0] - s * corner[v, 1] + g[p, 0]
                    y = s * corner[v, 0] + c * corner[v, 1] + g[p, 1]
                else:
                    dx, dy = corner[v, 0] - g[p, 0], corner[v, 1] - g[p, 1]
                    x, y = c * dx + s * dy, -s * dx + c * dy
                if x < low_x - far or x > high_x + far or y < low_y - far or y > high_y + far:
                    continue
                for e in range(first[own], first[own + 1]):
                    rx, ry = x - corner[e, 0], y - corner[e, 1]
                    ahead = normal[e, 0] * rx + normal[e, 1] * ry
                    if ahead < -behind or ahead > far:
                        continue
                    along = normal[e, 0] * ry - normal[e, 1] * rx
                    beyond = max(-along, along - length[e], 0.0)
                    if (
                        (beyond == 0.0 and ahead < 0.0)
                        or beyond * beyond + ahead * ahead > far * far
                        or beyond > beside[p]
                    ):
                        continue
                    if fill:
                        kind[at], edge[at], vertex[at] = k, e, v
                    at += 1
    row[len(shape_a)] = at
