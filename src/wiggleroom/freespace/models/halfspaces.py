"""Half-spaces: the region of each pair as a convex polyhedron, N g + D <= 0, as the paper and half-plane methods have it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Halfspaces:
    """One polyhedron for each of P pairs, in relative motions g = (tau, phi) of a point of B against A.

    Parameters
    ----------
    a, b : (P,) int64
        Bodies.
    row : (P + 1,) int64
        Rows of pair p are row[p] .. row[p + 1].
    normal : (R, 3) float64
        N: outward normals, in the axes of A's frame and per radian.
    offset : (R,) float64 [mm]
        D; N g + D <= 0 inside.
    point : (P, 2) float64 [mm]
        The point of B, in B's frame, whose motion tau is.
    rest : (P, 3) float64 [mm, mm, rad]
        Where that point and B's angle are seen from A where g is zero.

    Source: Mind the Gap, Eq. (1) and (3); g as in Eq. (2), corrected, because as printed it is not zero at zero motion.
    """

    a: Ints
    b: Ints
    row: Ints
    normal: Floats
    offset: Floats
    point: Floats
    rest: Floats

    @property
    def pair(self) -> Ints:
        """Pair of each row (R,)."""
        return np.repeat(np.arange(len(self.a)), np.diff(self.row))


def seen_point(pose: Floats, point: Floats) -> Floats:
    """Where A sees points (P, 2) of B (P, 3) [mm, mm, rad], from the relative poses (P, 3) of the bodies."""
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x, y = point.T
    return np.column_stack([pose[:, 0] + c * x - s * y, pose[:, 1] + s * x + c * y, pose[:, 2]])


def spread(rows: list[tuple[Floats, Floats]], label: Ints) -> tuple[Ints, Floats, Floats]:
    """First row of each pair (P + 1,), normals and offsets of all pairs, from those of every class and the class of each pair."""
    count = np.array([len(offset) for _, offset in rows], dtype=np.int64)
    start = np.concatenate([[0], np.cumsum(count)])
    row = np.concatenate([[0], np.cumsum(count[label])])
    take = np.repeat(start[label] - row[:-1], count[label]) + np.arange(row[-1])
    normal = np.concatenate([n for n, _ in rows]) if rows else np.zeros((0, 3))
    offset = np.concatenate([o for _, o in rows]) if rows else np.zeros(0)
    return row, normal[take], offset[take]
