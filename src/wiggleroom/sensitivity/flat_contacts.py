"""Where two edges lie flat on each other: they touch all along, not only at the corners whose walls hold.

A stretch of an edge that a joint's gap moves may end between these corners. With more gap, or less, a step stands up there, and one of its
corners carries what a corner beyond it did.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import BodyShapes
from wiggleroom.program.gap_sensitivity import Gains

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PARALLEL = 1e-9
"""Edges whose unit normals differ by less are on one line where a corner touches both."""


@dataclass(frozen=True, eq=False)
class FlatSide:
    """One of both edges (f,) of contacts between flat edges.

    Parameters
    ----------
    part, body, edge : (f,) int64
    start, end : (f, 2) float64 [mm]
        Where it touches with the first and the second wall, in the frame of its body.
    """

    part: Ints
    body: Ints
    edge: Ints
    start: Floats
    end: Floats


@dataclass(frozen=True, eq=False)
class FlatContacts:
    """Contacts between flat edges: two walls each (f, 2), numbers among the gains, and both sides of what touches between them."""

    walls: Ints
    sides: tuple[FlatSide, FlatSide]


def flat_contacts(shapes: BodyShapes, some: Gains, foot: Floats) -> FlatContacts:
    """Contacts between flat edges, among walls that hold; `foot` (w, 2) is where each corner stands on its edge, in the edge's frame.

    Two corners at the ends of one edge stand on one line; or a corner of each body stands on the edge of the other that ends at its own.
    """
    of_pair = defaultdict(list)
    for wall, bodies in enumerate(np.sort(np.column_stack([some.edge_body, some.corner_body]), axis=1).tolist()):
        of_pair[tuple(bodies)].append(wall)
    found = []
    for walls in of_pair.values():
        for i, j in combinations(walls, 2):
            beside = _edge_between(shapes, some, i, j)
            if beside >= 0:
                found.append((i, j, beside))
    first, last, edge = np.array(found, dtype=np.int64).reshape(-1, 3).T
    mixed = (some.edge_body[first] != some.edge_body[last])[:, None]
    spot = shapes.corner[some.corner]
    ends = np.where(mixed, spot[last], foot[last]), np.where(mixed, foot[last], spot[last])
    one = FlatSide(some.edge_part[first], some.edge_body[first], some.edge[first], foot[first], ends[0])
    other = FlatSide(some.corner_part[first], some.corner_body[first], edge, spot[first], ends[1])
    return FlatContacts(np.column_stack([first, last]), (one, other))


def _edge_between(shapes: BodyShapes, some: Gains, i: int, j: int) -> int:
    """The edge of the corner's body that lies flat on that of wall i from its corner to where wall j touches; -1 where none does."""
    corner, edge, after = some.corner, some.edge, shapes.after
    if some.edge_body[i] == some.edge_body[j]:
        apart = shapes.normal[edge[i]] - shapes.normal[edge[j]]
        if np.abs(apart).max() > PARALLEL:
            return -1
        if after[corner[i]] == corner[j]:
            return int(corner[i])
        return int(corner[j]) if after[corner[j]] == corner[i] else -1
    ends = (edge[i], after[edge[i]]), (edge[j], after[edge[j]])
    return int(edge[j]) if corner[j] in ends[0] and corner[i] in ends[1] else -1
