"""What the gaps of parts do to the program: every wall is linear in the displacement of its edge and of its corner.

A wall h = n . (R v + q) - off gains 1 for each unit that its edge moves inward, and n . R m for each unit that the part of
its corner does, where m is the corner's mitre (`wiggleroom.geometry.offset_bodies.mitres`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.offset_bodies import mitres
from wiggleroom.geometry.row_kinds import A_EDGE
from wiggleroom.program.nonlinear_program import Program

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

OUTLINE_TOLERANCE = 1e-9
"""Outlines that agree to this share of the drawing's size are the same."""


def carried(cells: Cells, before: Bodies, after: Bodies) -> Cells:
    """The same cells for bodies from `wiggleroom.geometry.offset_bodies.offset_bodies`: every wall follows its edge and its corner.

    Nothing is searched. What the walls hid before may show when outlines have moved much: whoever uses these cells
    checks the motion by exact geometry.
    """
    edge_of, corner_of = _owners(cells)
    shift = (after.shapes.first[after.shape] - before.shapes.first[before.shape]).astype(np.int32)
    wall = cells.is_wall
    return replace(
        cells,
        edge=cells.edge + np.where(wall, shift[edge_of], 0),
        corner=cells.corner + np.where(wall, shift[corner_of], 0),
    )


def _owners(cells: Cells) -> tuple[Ints, Ints]:
    """Body (R,) of each row's edge, and of its corner."""
    pair, mine = cells.pair, cells.kind == A_EDGE
    a, b = cells.a[pair], cells.b[pair]
    return np.where(mine, a, b), np.where(mine, b, a)


@dataclass(frozen=True, eq=False)
class Gains:
    """What walls gain [mm per mm] when outlines move inward.

    Parameters
    ----------
    column : (k,) int64
        Which of the rows that were asked about each wall is.
    edge, corner : (k,) int64
        The wall's edge and corner, as rows of the outlines.
    edge_part, corner_part : (k,) int64
        Parts that they belong to.
    edge_body, corner_body : (k,) int64
    toward : (k, 2) float64
        The edge's outward normal in the frame of the corner's body: the wall gains as much as the corner moves along it.
    """

    column: Ints
    edge: Ints
    corner: Ints
    edge_part: Ints
    corner_part: Ints
    edge_body: Ints
    corner_body: Ints
    toward: Floats

    def by_part(self, bodies: Bodies, holds: int) -> sp.csr_matrix:
        """Gain (n, k) of each of k rows for 1 mm that the outline of each part moves inward."""
        mitre = (self.toward * mitres(bodies.shapes)[self.corner]).sum(axis=1)
        value = np.concatenate([np.ones(len(self.edge)), mitre])
        part, column = np.concatenate([self.edge_part, self.corner_part]), np.tile(self.column, 2)
        return sp.csr_matrix((value, (part, column)), shape=(len(bodies.body_of), holds))


def gains(program: Program, u: Floats, holds: Ints) -> Gains:
    """Derivatives of the walls among some rows (k,) at u (3F,) by how far outlines move inward."""
    cells, bodies = program.cells, program.bodies
    shapes = bodies.shapes
    column = np.flatnonzero(cells.is_wall[holds])
    row = holds[column]
    edge_of, corner_of = (who[row] for who in _owners(cells))
    edge, corner = cells.edge[row].astype(np.int64), cells.corner[row].astype(np.int64)
    g, _ = program.relative(program.motion(u))
    psi = g[cells.pair[row], 2] * np.where(cells.kind[row] == A_EDGE, 1.0, -1.0)
    c, s = np.cos(psi), np.sin(psi)
    nx, ny = shapes.normal[edge].T
    start = np.cumsum([0, *map(len, bodies.members)])
    parts = np.concatenate([np.asarray(m, dtype=np.int64) for m in bodies.members])
    return Gains(
        column,
        edge,
        corner,
        parts[start[edge_of] + shapes.member[edge]],
        parts[start[corner_of] + shapes.member[corner]],
        edge_of,
        corner_of,
        np.column_stack([nx * c + ny * s, ny * c - nx * s]),
    )
