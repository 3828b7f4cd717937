"""The edges that the gap of one joint moves: what a little more of it does to the outlines of both parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.facing import split_ring
from wiggleroom.assembly.gaps import joint_stretches, outline_shapes
from wiggleroom.drawing.model import Drawing, JointGap, Points

AT_JOINT = 0.5
"""A joint's gap moves each of both outlines by half of it."""


@dataclass(frozen=True, eq=False)
class JointEdges:
    """Outlines of a part as drawn, cut where gaps of its joints begin and end, and how the gap of one joint moves them.

    Parameters
    ----------
    start, end : (k, 2) float64 [mm]
        Edges in the part's own frame, material on their left.
    inward : (k,) float64 [mm]
        How far each lies inward as it is made.
    moves : (k,) float64
        How far each moves inward for 1 mm more gap in the joint.
    """

    start: Points
    end: Points
    inward: NDArray[np.float64]
    moves: NDArray[np.float64]


def gaps_beside(gaps: Sequence[JointGap], pair: tuple[str, str], usual: float) -> tuple[tuple[JointGap, ...], int]:
    """Gaps of all joints that two parts have, that of their own last unless it is stated, and the number of that among them."""
    near = {frozenset(joint.parts): joint for joint in gaps if set(pair) & set(joint.parts)}
    near.setdefault(frozenset(pair), JointGap(pair, usual))
    return tuple(near.values()), list(near).index(frozenset(pair))


def joint_edges(drawing: Drawing, pair: tuple[int, int]) -> tuple[JointEdges, JointEdges] | None:
    """What the gap of the joint of two parts moves, as `gaps` of an assembly file says it; None where they face each other nowhere.

    Parameters
    ----------
    drawing : Drawing [mm]
    pair : (int, int)
        Numbers of both parts.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> brick = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    >>> low, high = joint_edges(Drawing((Part("a", (brick,)), Part("b", (brick,), (0.0, 1.0, 0.0)))), (0, 1))
    >>> low.moves.tolist(), high.moves.tolist()
    ([0.0, 0.0, 0.5, 0.0], [0.5, 0.0, 0.0, 0.0])
    """
    names = drawing.parts[pair[0]].name, drawing.parts[pair[1]].name
    gaps, number = gaps_beside(drawing.gaps, names, drawing.gap)
    near = {name for joint in gaps for name in joint.parts} - set(names)
    parts = (*(drawing.parts[k] for k in pair), *(p for p in drawing.parts if near and p.name in near))
    some = replace(drawing, parts=parts, gaps=gaps)
    shapes = outline_shapes(some)
    stretches, _ = joint_stretches(some, shapes)
    found = []
    for part in (0, 1):
        shape = int(shapes.shape[part])
        mine = stretches.get(shape, [])
        if not any(s.joint == number for s in mine):
            return None
        pieces = []
        for loop in np.flatnonzero(shapes.loop_shape == shape).tolist():
            ring = shapes.loops.rings()[loop]
            own = shapes.on_loop(loop, mine)
            points, inward = split_ring(ring, drawing.gap / 2 - float(shapes.outward[loop]), own)
            moves = [replace(s, inward=AT_JOINT if s.joint == number else 0.0) for s in own]
            pieces.append((points, np.roll(points, -1, axis=0), inward, split_ring(ring, 0.0, moves)[1]))
        found.append(JointEdges(*(np.concatenate(column) for column in zip(*pieces, strict=True))))
    return found[0], found[1]
