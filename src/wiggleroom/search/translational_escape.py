"""Who leaves straight from a state that a search has reached: one that is asked about, with all that it pushes ahead of it.

A climb among cells may end at a local optimum although a straight path leads out, past corners that its cells do not let it pass.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import grow_cells, replaced, select
from wiggleroom.freespace.translations import OVERLAP_NOISE, edges_of_all, translation_directions
from wiggleroom.geometry.neighbours import ignored_matrix
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.translation_blocking import taken_along
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective
from wiggleroom.search.incumbent import PathSegment, Start
from wiggleroom.search.local_search import ESCAPE_DISTANCE
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.recession import MIN_SLOPE, grows

Floats = NDArray[np.float64]

FAR_OUT = 2 * ESCAPE_DISTANCE + 1
"""An escape is followed this many drawing sizes: from any state that counts as near it ends where a body counts as gone."""


def translational_escape(ready: Prepared, objective: Objective, start: Start) -> Start | None:
    """Where a search begins far out on a straight path from a state, along which the objective grows without end; None where none leaves.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    start : Start
        At the state, strictly inside cells.

    Source: the blocking graph of a direction, to the end of the path (Wilson and Latombe, "Geometric reasoning about mechanical assembly",
    1994): what is reached from a body along its arcs moves along with it.
    """
    bodies, motion = ready.bodies, start.inner
    slope = objective.gradient(motion)
    slope[bodies.fixed] = 0.0
    asked = np.flatnonzero((slope[:, :2] != 0).any(axis=1))
    if not len(asked):
        return None
    edges, first = edges_of_all(placed(bodies, motion))
    directions = np.concatenate([slope[asked, :2], slope[:, :2].sum(axis=0, keepdims=True)])
    length = np.hypot(*directions.T)
    directions = np.concatenate([directions[length > 0] / length[length > 0, None], translation_directions(edges)])
    n = len(motion)
    never = ignored_matrix(ready.ignored, n)
    for body in asked:
        gain = directions @ slope[body, :2]
        for k in np.argsort(-gain, kind="stable"):
            if gain[k] <= MIN_SLOPE * np.hypot(*slope[body, :2]):
                break
            who = np.zeros(n, dtype=np.bool_)
            who[body] = True
            leaves = taken_along(edges, first, directions[k], never, bodies.fixed, ready.size * OVERLAP_NOISE, who)
            if leaves and grows(ready, objective, motion, who, directions[k]):
                return _far_out(ready, start, who, directions[k])
    return None


def _far_out(ready: Prepared, start: Start, who: NDArray[np.bool_], direction: Floats) -> Start | None:
    """The start after some bodies have gone straight so far that they count as gone; None where no cells grow there."""
    bodies, cells = ready.bodies, start.cells
    motion = start.inner.copy()
    motion[who, :2] += FAR_OUT * ready.size * direction
    parted = np.flatnonzero(who[cells.a] != who[cells.b])  # the others lie to each other as they did
    a, b = cells.a[parted], cells.b[parted]
    grown, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, motion), np.full(len(a), ready.clearance))
    if not good.all():
        return None
    program = build_program(bodies, select(cells, np.zeros(0, dtype=np.int64)), ZERO_MOTION, length=ready.clearance)
    leg = PathSegment(program, (program.variables(start.inner), program.variables(motion)))
    return replace(start, cells=replaced(cells, parted, grown), inner=motion, segments=(*start.segments, leg))
