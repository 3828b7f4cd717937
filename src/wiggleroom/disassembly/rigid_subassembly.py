"""Paths on which some bodies leave as one while all others stay at rest."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.audit.audit_outlines import outlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.enclosure import cages
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.freespace.subdivision.passage import Passage, passage
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import about, of_parts
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_TURN_STEP = 0.02
"""Waypoints are no further apart than this [rad]."""
MAX_SPLITS = 4
"""A path that the audit does not pass is sampled twice as finely at most this many times."""
BOXES_FOR_ENCLOSED = 4000
"""Boxes judged at most where it is known already that a body does not leave."""


@dataclass(frozen=True, eq=False)
class RigidEscape:
    """What is known about some bodies leaving as one.

    Parameters
    ----------
    held : bool
        True where they certainly neither leave nor turn half round.
    closed : bool
        True where they certainly do not leave.
    path : (k, n, 3) float64 [mm, mm, rad] or None
        Motions of all bodies on which they leave.
    """

    held: bool
    closed: bool
    path: Floats | None


def leaves_as_one(
    ready: Prepared, who: Ints, most: int, passages: PassagesByGap, context: Context = UNLIMITED
) -> RigidEscape:
    """Look for a path on which the bodies `who` leave as one, the others staying where they are.

    Parameters
    ----------
    ready : Prepared
    who : (k,) int64
    most : int
        Boxes judged at most.
    passages : PassagesByGap
        Those known from other gaps; what is found is added.
    context : Context, optional
    """
    bodies, n = ready.bodies, len(ready.bodies.fixed)
    geometry = placed(bodies)
    others = np.setdiff1d(np.arange(n), who)
    a, b = ready.ignored // n, ready.ignored % n
    if (np.isin(a, who) != np.isin(b, who)).any():  # pairs that pass through each other are not one solid
        return RigidEscape(False, False, None)

    def look() -> Passage:
        return passage_or_enclosure(
            shapely.union_all(geometry[others]), shapely.union_all(geometry[who]), most, context
        )

    found = passages.look(ready, others, who, most, look, context)
    if found is None:  # slides of a pair lead apart: with other boxes the path is found here
        found = look()
    if found.path is None:
        return RigidEscape(found.held, found.closed, None)
    points = _finer(found.path)
    parts = outlines(ready.assembly)
    for _ in range(MAX_SPLITS):
        motions = np.zeros((len(points), n, 3))
        motions[:, who] = about(np.repeat(points[:, None], len(who), 1), bodies.rest[who, :2] - found.pivot)
        if audit_path(parts, of_parts(ready.assembly, bodies, motions)).free:
            return RigidEscape(False, False, motions)
        points = np.insert(points, np.arange(1, len(points)), (points[1:] + points[:-1]) / 2, axis=0)
    return RigidEscape(False, False, None)


def passage_or_enclosure(a: shapely.Geometry, b: shapely.Geometry, most: int, context: Context) -> Passage:
    """The passage of `b` out of `a` by boxes of motions; by few of them where one has a head that is too thick for the other's mouth.

    What the boxes still tell then is whether it turns half round.
    """
    closed = cages(a, b) or cages(b, a)
    found = passage(a, b, most=min(most, BOXES_FOR_ENCLOSED) if closed else most, stop=context.stop)
    return replace(found, closed=True) if closed else found


def _finer(points: Floats) -> Floats:
    """The same path with points in between where it turns: those of other points of the body are straight only nearly."""
    count = np.maximum(1, np.ceil(np.abs(np.diff(points[:, 2])) / MAX_TURN_STEP)).astype(int)
    pieces = [
        one + (other - one) * np.arange(k)[:, None] / k
        for one, other, k in zip(points[:-1], points[1:], count, strict=True)
    ]
    return np.concatenate([*pieces, points[-1:]])
