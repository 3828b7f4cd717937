"""What the gaps of single joints are worth: each moves only the edges that face each other, and the corners between those and others."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.joint_edges import JointEdges, joint_edges
from wiggleroom.assembly.mitre import STEP_COSINE
from wiggleroom.program.gap_sensitivity import Gains
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.active_set import feet

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_PLACE = 1e-9
"""Joints whose parts lie to each other alike, to this share of the assembly's size, are the same."""


class JointGains:
    """The joints of walls that hold a motion, and what the gap of each does to these walls.

    Parameters
    ----------
    assembly : Assembly
    program : Program
    some : Gains
        Of the walls.

    Attributes
    ----------
    joints : (m, 2) int64
        Pairs of parts.
    """

    def __init__(self, assembly: Assembly, program: Program, some: Gains) -> None:
        pairs = np.sort(np.column_stack([some.edge_part, some.corner_part]), axis=1)
        self.joints: Ints = np.unique(pairs, axis=0).reshape(-1, 2)
        self._assembly, self._program = assembly, program
        self._before = np.argsort(program.bodies.shapes.after)
        self._of: list[list[tuple[int, JointEdges]]] = [[] for _ in assembly.parts]
        """Joints of each part, and what of its outlines they move."""
        known: dict[tuple[object, ...], tuple[JointEdges, JointEdges] | None] = {}
        alone = {name for joint in assembly.drawing.gaps for name in joint.parts}
        for k, (a, b) in enumerate(self.joints.tolist()):
            key = self._key(a, b) if alone.isdisjoint((assembly.names[a], assembly.names[b])) else (k,)
            if key not in known:
                known[key] = joint_edges(assembly.drawing, (a, b))
            for part, edges in zip((a, b), known[key] or (), strict=False):
                self._of[part].append((k, edges))

    def _key(self, a: int, b: int) -> tuple[object, ...]:
        """What is alike where two joints are."""
        one, other = (self._assembly.drawing.parts[k] for k in (a, b))
        x, y, angle = np.subtract(other.at, one.at)
        c, s = np.cos(one.at[2]), np.sin(one.at[2])
        size = SAME_PLACE * self._assembly.size
        place = np.round(np.array([c * x + s * y, c * y - s * x, angle * self._assembly.size]) / size)
        return (id(one.regions), one.offset, id(other.regions), other.offset, *place.tolist())

    def at(self, some: Gains, u: Floats, holds: Ints) -> sp.csr_matrix:
        """Gain (m, k) of each of k rows at u (3F,) for 1 mm more gap in each joint."""
        shapes = self._program.bodies.shapes
        foot = np.clip(feet(self._program, u, holds[some.column]), 0.0, 1.0)[:, None]
        before = self._before[some.corner]
        spot = shapes.corner[some.edge] + foot * (shapes.corner[shapes.after[some.edge]] - shapes.corner[some.edge])
        value, joint, column = [], [], []
        for part in np.unique(self.joints).tolist():
            edges, corners = np.flatnonzero(some.edge_part == part), np.flatnonzero(some.corner_part == part)
            for k, moved in self._of[part]:
                there = self._moves(moved, part, some.edge_body[edges], spot[edges], some.edge[edges])
                value.append(there)
                own = some.corner_body[corners], shapes.corner[some.corner[corners]]
                behind, ahead = (self._moves(moved, part, *own, e[corners]) for e in (before, some.corner))
                normals = shapes.normal[before[corners]], shapes.normal[some.corner[corners]]
                value.append(_corner_gain(some.toward[corners], *normals, behind, ahead))
                column += [some.column[edges], some.column[corners]]
                joint += [np.full(len(c), k) for c in column[-2:]]
        flat = [np.concatenate(x) if x else np.zeros(0) for x in (value, joint, column)]
        return sp.csr_matrix(
            (flat[0], (flat[1].astype(int), flat[2].astype(int))), shape=(len(self.joints), len(holds))
        )

    def _moves(self, moved: JointEdges, part: int, body: Ints, point: Floats, edge: Ints) -> Floats:
        """How far edges (q,) of a part move at points (q, 2) of the frames of their bodies."""
        if not len(edge):
            return np.zeros(0)
        normal = self._program.bodies.shapes.normal[edge]
        x, y, angle = self._program.bodies.rest[body[0]]  # the part's, so one for all
        px, py, its = self._assembly.parts[part].at
        turn = _rotation(angle - its)
        shift = np.array([x - px, y - py]) @ _rotation(its)
        return moved.at(point @ turn.T + shift, np.column_stack([-normal[:, 1], normal[:, 0]]) @ turn.T)


def _rotation(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _corner_gain(toward: Floats, one: Floats, other: Floats, behind: Floats, ahead: Floats) -> Floats:
    """What walls gain where the edges before and after their corners move inward by `behind` and `ahead` (q,).

    With the edges' outward normals `one` and `other` (q, 2) a corner moves by m with one . m = -behind and other . m = -ahead. Where
    edges that turn little move differently a step joins them, and the nearer of its two corners counts.
    """
    total, apart = one + other, one - other
    mean, half = (behind + ahead) / 2, (behind - ahead) / 2
    along = [(toward * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-18) for d in (total, apart)]
    mitred = -2 * (mean * along[0] + np.where(half != 0, half * along[1], 0.0))
    stepped = np.minimum(-behind * (toward * one).sum(axis=1), -ahead * (toward * other).sum(axis=1))
    return np.where((half != 0) & ((one * other).sum(axis=1) > STEP_COSINE), stepped, mitred)
