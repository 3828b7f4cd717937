"""Rows h >= 0 of a program from the regions of its pairs: one function for each kind of region."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.freespace.models.halfspaces import Halfspaces
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.row_kinds import FACE
from wiggleroom.geometry.vertex_edge_pairs import VertexEdgePairs

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shorts = NDArray[np.int32]
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
    """Rows by number: in a large assembly a copy of its line and its corner for each would be most of what there is.

    Parameters
    ----------
    kind : (R,) int8
        As in `row_kinds`.
    line, point : (R,) int32
        Which line and which point a row is about; those of turns are about none.
    lever : (P,) float64 [mm]
        What turns of a pair are multiplied with.
    ends : (P, 2) float64 [rad]
        Between which it may turn.
    normal, off, per_turn : (L, 2), (L,), (L,) float64
        Of lines, see `wiggleroom.program.contact_functions`; none turns where no row is a FACE.
    corner : (V, 2) float64 [mm]
        The points.
    """

    kind: Kinds
    line: Shorts
    point: Shorts
    lever: Floats
    ends: Floats
    normal: Floats
    off: Floats
    per_turn: Floats
    corner: Floats

    def of_pairs(self, some: slice) -> tuple[Any, ...]:
        """What the kernels are given for some pairs, after where these are and which rows they have."""
        return (
            self.lever[some], self.ends[some], self.kind, self.line, self.point, self.normal, self.off, self.per_turn, self.corner,
        )  # fmt: skip


def rows_of(bodies: Bodies, regions: Regions) -> Rows:
    """Rows of any registered kind of region."""
    return ROWS[type(regions)](bodies, regions)


def wall_rows(bodies: Bodies, cells: Cells) -> Rows:
    """Corners before lines of edges, and the ends of the verified angles."""
    shapes = bodies.shapes
    lever = np.minimum(bodies.radius[cells.a], bodies.radius[cells.b])
    return Rows(
        cells.kind, cells.edge, cells.corner, lever, cells.ends, shapes.normal, shapes.level, np.zeros(0), shapes.corner
    )


def face_rows(_: Bodies, faces: Halfspaces) -> Rows:
    """Flat faces: h = -(N g + D)."""
    pair = faces.pair
    return Rows(
        np.full(len(pair), FACE, dtype=np.int8),
        np.arange(len(pair), dtype=np.int32),
        pair.astype(np.int32),
        np.zeros(0),
        np.zeros((0, 2)),
        -faces.normal[:, :2],
        faces.offset - (faces.normal * faces.rest[pair]).sum(1),
        -faces.normal[:, 2],
        faces.point,
    )


def distance_rows(_: Bodies, near: VertexEdgePairs) -> Rows:
    """Distances of corners from edges: they are worked out from the shapes, at each point anew."""
    none, nothing = np.zeros(0), np.zeros((0, 2))
    return Rows(near.kind, near.edge, near.corner, none, nothing, nothing, none, none, nothing)


ROWS: dict[type, Callable[..., Rows]] = {Cells: wall_rows, Halfspaces: face_rows, VertexEdgePairs: distance_rows}
"""Registry: kind of region and the function that makes rows of it."""
