"""The program whose rows are distances of corners from edges: all of the free space near where the bodies are, without cells."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.vertex_edge_pairs import VertexEdgePairs
from wiggleroom.parallel.batches import in_batches
from wiggleroom.program import vertex_edge_distances as kernel
from wiggleroom.program.nonlinear_program import Program, build_program, row_of
from wiggleroom.program.objectives import Objective

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DistanceProgram(Program):
    """max objective(motion) subject to distances >= 0; fields as of `Program`, which its cells are `VertexEdgePairs` in."""

    @property
    def _listed(self) -> tuple[Any, ...]:
        """Kind, edge and corner of every row, and the edges they refer to."""
        near, shapes = self.cells, self.bodies.shapes
        return near.kind, near.edge, near.corner, shapes.corner, shapes.normal, shapes.length

    def row_values(self, g: Floats) -> Floats:
        """Distances (R,) in units of `length` at relative poses g (P, 3)."""
        h = np.empty(self.rows)

        def fill(some: slice) -> None:
            kernel.distance_values(g[some], row_of(self.cells.row, some), *self._listed, self.length, h)

        in_batches(len(g), self.batches, fill)
        return h

    def rows_at(self, g: Floats, h: Floats, d: Floats) -> None:
        """Fill in distances h (R,) and their derivatives d (R, 3) with respect to (q, psi), in units of `length`."""

        def fill(some: slice) -> None:
            kernel.distance_gradients(g[some], row_of(self.cells.row, some), *self._listed, self.length, h, d)

        in_batches(len(g), self.batches, fill)

    def pair_blocks(self, g: Floats, d: Floats, weight: Floats, lam: Floats) -> tuple[Floats, Floats]:
        """D^T diag(weight) D - sum lam h'' of every pair (P, 6), by (q, psi), made positive semidefinite, and D^T lam (P, 2) by q."""
        near, radius = self.cells, self.bodies.radius
        M, force = np.zeros((len(near.a), 6)), np.zeros((len(near.a), 2))
        lever = np.minimum(radius[near.a], radius[near.b])

        def fill(some: slice) -> None:
            kernel.distance_blocks(
                g[some], row_of(near.row, some), *self._listed, d, weight, lam, self.length, lever[some], np.empty((2, 3, 3)), M[some],
                force[some],
            )  # fmt: skip

        in_batches(len(g), self.batches, fill)
        return M, force


def build_distances(bodies: Bodies, near: VertexEdgePairs, objective: Objective, *, length: float) -> DistanceProgram:
    """Put all distances and the objective into one program; arguments as for `build_program`."""
    program = build_program(bodies, near, objective, length=length)
    return DistanceProgram(**{field.name: getattr(program, field.name) for field in fields(program)})
