"""Which active walls are real contacts, and which are virtual: the line of an edge beyond its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program import kernel
from wiggleroom.program.build import Program

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

END = 1e-6
"""A foot within this share of an edge's length from its end is at the end."""
ACTIVE = 1e-7
"""Forces below this share of the largest derivative of the objective hold nothing."""


@dataclass(frozen=True, eq=False)
class Touch:
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
        return ~((self.place > -END) & (self.place < 1 + END))

    @property
    def at_end(self) -> NDArray[np.bool_]:
        """Corner on corner: the way past either corner is another branch."""
        return ~self.virtual & ((self.place < END) | (self.place > 1 - END))

    def lines_at_end(self, program: Program, pairs: Ints) -> Ints:
        """Kind and edge (k, 2) of a line that a corner touches at its end, for each of some pairs; -1 where there is none."""
        out = np.full((len(pairs), 2), -1, dtype=np.int64)
        for k in np.flatnonzero(self.at_end & np.isin(self.pair, pairs)):
            row = self.row[k]
            out[np.searchsorted(pairs, self.pair[k])] = program.cells.kind[row], program.cells.edge[row]
        return out


def touching(program: Program, u: Floats, lam: Floats) -> Touch:
    """Rows with a force at u (3F,), from the multipliers `lam` (R,) of a solution."""
    h = program.values(u)
    force = lam / program.length
    unit = float(np.abs(program.objective.gradient(program.motion(u))[:, :2]).max(initial=0.0)) or float(
        np.abs(program.objective.gradient(program.motion(u))).max()
    )
    # strict complementarity decides at a well-centred point: the force counts where it outweighs what is left of the gap
    scaled = lam / (unit * program.length)
    row = np.flatnonzero((scaled > np.maximum(h, ACTIVE)))
    pair = program.cells.pair[row]
    place = np.full(len(row), np.nan)
    g, _ = program.relative(program.motion(u))
    x, y, psi = g[pair].T
    c, s = np.cos(psi), np.sin(psi)
    shapes, cells = program.bodies.shapes, program.cells
    for kind in (kernel.A_EDGE, kernel.B_EDGE):
        k = np.flatnonzero(cells.kind[row] == kind)
        edge, corner = cells.edge[row[k]], shapes.corner[cells.corner[row[k]]]
        if kind == kernel.A_EDGE:
            spot = np.column_stack([c[k] * corner[:, 0] - s[k] * corner[:, 1] + x[k], s[k] * corner[:, 0] + c[k] * corner[:, 1] + y[k]])
        else:
            dx, dy = corner[:, 0] - x[k], corner[:, 1] - y[k]
            spot = np.column_stack([c[k] * dx + s[k] * dy, -s[k] * dx + c[k] * dy])
        normal = shapes.normal[edge]
        along = np.column_stack([-normal[:, 1], normal[:, 0]])
        place[k] = ((spot - shapes.corner[edge]) * along).sum(1) / shapes.length[edge]
    return Touch(row, pair, force[row], place)
