"""Which active walls are real contacts, and which are virtual: the line of an edge beyond its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE
from wiggleroom.program.nonlinear_program import Program

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EDGE_END_TOLERANCE = 1e-6
"""A foot within this share of an edge's length from its end is at the end."""
ACTIVE_TOLERANCE = 1e-6
"""A row that would gain less than this share of the objective by giving way a whole clearance holds nothing."""


@dataclass(frozen=True, eq=False)
class ActiveSet:
    """Active rows at a point.

    Parameters
    ----------
    row, pair : (k,) int64
    force : (k,) float64
        Objective per mm.
    place : (k,) float64
        Foot of the corner along the edge: 0 at its start, 1 at its end; nan for rows that bound the angle.
    """

    row: Ints
    pair: Ints
    force: Floats
    place: Floats

    @property
    def virtual(self) -> NDArray[np.bool_]:
        """Rows that stop the motion although nothing touches there."""
        return ~((self.place > -EDGE_END_TOLERANCE) & (self.place < 1 + EDGE_END_TOLERANCE))

    @property
    def at_end(self) -> NDArray[np.bool_]:
        """Corner on corner: the path past either corner is another branch."""
        return ~self.virtual & ((self.place < EDGE_END_TOLERANCE) | (self.place > 1 - EDGE_END_TOLERANCE))

    def lines_at_end(self, program: Program, pairs: Ints) -> Ints:
        """Kind and edge (k, 2) of a line that a corner touches at its end, for each of some pairs; -1 where there is none."""
        out = np.full((len(pairs), 2), -1, dtype=np.int64)
        for k in np.flatnonzero(self.at_end & np.isin(self.pair, pairs)):
            row = self.row[k]
            out[np.searchsorted(pairs, self.pair[k])] = program.cells.kind[row], program.cells.edge[row]
        return out


def target_poses(program: Program, u: Floats, active: ActiveSet, pairs: Ints) -> Floats:
    """Relative poses (k, 3) of some pairs one clearance further where their virtual walls push back: where they would go without them."""
    at = program.linearise(u)
    push = np.zeros((len(program.cells.a), 3))
    row = active.row[active.virtual]
    np.add.at(push, program.cells.pair[row], -at.d[row] * active.force[active.virtual, None])
    push = push[pairs]
    lever = np.minimum(program.bodies.radius[program.cells.a[pairs]], program.bodies.radius[program.cells.b[pairs]])
    push[:, 2] /= lever  # to a length
    size = np.hypot(np.hypot(push[:, 0], push[:, 1]), push[:, 2])
    push *= np.where(size > 0, program.length / np.maximum(size, 1e-300), 0.0)[:, None]
    push[:, 2] /= lever
    return at.g[pairs] + push


def touching(program: Program, u: Floats, lam: Floats) -> ActiveSet:
    """Rows with a force at u (3F,), from the multipliers `lam` (R,) of a solution."""
    h, force = program.values(u), lam / program.length
    value = abs(program.objective.value(program.motion(u)))
    # strict complementarity: the share of the objective that a row holds outweighs what is left of its gap
    row = np.flatnonzero((lam > ACTIVE_TOLERANCE * max(value, program.length)) & (lam > h * program.length))
    return ActiveSet(row, program.cells.pair[row], force[row], feet(program, u, row))


def feet(program: Program, u: Floats, row: Ints) -> Floats:
    """Where corners of rows stand along their edges (k,) at u (3F,): 0 at the start, 1 at the end; nan for rows that bound the angle."""
    pair = program.cells.pair[row]
    place = np.full(len(row), np.nan)
    g, _ = program.relative(program.motion(u))
    x, y, psi = g[pair].T
    c, s = np.cos(psi), np.sin(psi)
    shapes, cells = program.bodies.shapes, program.cells
    for kind in (A_EDGE, B_EDGE):
        k = np.flatnonzero(cells.kind[row] == kind)
        edge, corner = cells.edge[row[k]], shapes.corner[cells.corner[row[k]]]
        if kind == A_EDGE:
            spot = np.column_stack(
                [c[k] * corner[:, 0] - s[k] * corner[:, 1] + x[k], s[k] * corner[:, 0] + c[k] * corner[:, 1] + y[k]]
            )
        else:
            dx, dy = corner[:, 0] - x[k], corner[:, 1] - y[k]
            spot = np.column_stack([c[k] * dx + s[k] * dy, -s[k] * dx + c[k] * dy])
        normal = shapes.normal[edge]
        along = np.column_stack([-normal[:, 1], normal[:, 0]])
        place[k] = ((spot - shapes.corner[edge]) * along).sum(1) / shapes.length[edge]
    return place
