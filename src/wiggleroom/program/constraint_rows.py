"""Rows h >= 0 of a program from the regions of its pairs: one function for each kind of region."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.freespace.models.halfspaces import Halfspaces
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.row_kinds import FACE, HIGH_TURN, LOW_TURN
from wiggleroom.geometry.vertex_edge_pairs import VertexEdgePairs

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Kinds = NDArray[np.int8]


class Regions(Protocol):
    """What a program asks of the regions of its pairs, whichever pair model made them."""

    @property
    def a(self) -> Ints:
        """First body of each pair (P,)."""

    @property
    def b(self) -> Ints:
        """Second body of each pair (P,)."""

    @property
    def row(self) -> Ints:
        """Rows of pair p are row[p] .. row[p + 1]."""

    @property
    def pair(self) -> Ints:
        """Pair of each row (R,)."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Geometry of rows, see `wiggleroom.program.contact_functions`: kind (R,), normal (R, 2), per_turn (R,), off (R,), corner (R, 2)."""

    kind: Kinds
    normal: Floats
    per_turn: Floats
    off: Floats
    corner: Floats


def rows_of(bodies: Bodies, regions: Regions) -> Rows:
    """Rows of any registered kind of region."""
    return ROWS[type(regions)](bodies, regions)


def wall_rows(bodies: Bodies, cells: Cells) -> Rows:
    """Corners before lines of edges, and the ends of the verified angles."""
    shapes = bodies.shapes
    level = (shapes.normal * shapes.corner).sum(1)
    normal, corner, off = shapes.normal[cells.edge], shapes.corner[cells.corner], level[cells.edge]
    pair = cells.pair
    lever = np.minimum(bodies.radius[cells.a], bodies.radius[cells.b])
    for kind, end in ((LOW_TURN, 0), (HIGH_TURN, 1)):
        rows = np.flatnonzero(cells.kind == kind)
        normal[rows], corner[rows] = 0.0, 0.0
        normal[rows, 0] = lever[pair[rows]]
        off[rows] = cells.ends[pair[rows], end]
    return Rows(cells.kind, normal, np.zeros(len(off)), off, corner)


def face_rows(_: Bodies, faces: Halfspaces) -> Rows:
    """Flat faces: h = -(N g + D)."""
    pair = faces.pair
    return Rows(
        np.full(len(pair), FACE, dtype=np.int8),
        -faces.normal[:, :2],
        -faces.normal[:, 2],
        faces.offset - (faces.normal * faces.rest[pair]).sum(1),
        faces.point[pair],
    )


def distance_rows(_: Bodies, near: VertexEdgePairs) -> Rows:
    """Distances of corners from edges: they are worked out from the shapes, at each point anew."""
    none = np.zeros((0, 2))
    return Rows(near.kind, none, none[:, 0], none[:, 0], none)


ROWS: dict[type, Callable[..., Rows]] = {Cells: wall_rows, Halfspaces: face_rows, VertexEdgePairs: distance_rows}
"""Registry: kind of region and the function that makes rows of it."""
