"""The complete search of one body among others that stand: its reachable motions are covered by boxes, so the best of them is known."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import grow_cells, select
from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes
from wiggleroom.geometry.neighbours import placed, relative_pose
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.program.nonlinear_program import build
from wiggleroom.program.objectives import ZERO_MOTION, PointMotion
from wiggleroom.search.incumbent import PathSegment, Start
from wiggleroom.search.loop import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]

MAX_BOXES = 120_000
"""Boxes judged at most."""
MIN_IMPROVEMENT, PROVEN_GAP = 1e-4, 9e-4
"""Motions better by the first share are looked for, until none better by the second is left."""
MAX_CLIMBS = 30


def complete(first: LocalSearch) -> tuple[LocalSearch, float | None]:
    """Look for better motions of the only free body wherever it gets, until there certainly is none.

    Parameters
    ----------
    first : LocalSearch
        Ended.

    Returns
    -------
    LocalSearch
        That which found the best.
    float or None
        A value that no motion exceeds; None where there are more free bodies, or the boxes did not suffice.
    """
    ready, best = first.ready, first
    boxes = _boxes(first)
    if boxes is None:
        return first, None
    for _ in range(MAX_CLIMBS):
        value, free = best.certain_value()
        if free or value <= 0:
            break
        most = value * (1 + PROVEN_GAP)
        closed, way = boxes.beyond(value * (1 + MIN_IMPROVEMENT), most, first.stop)
        if closed:
            return best, most
        start = None if way is None else _start(ready, boxes, way)
        if start is None:
            break
        climb = LocalSearch(ready, first.objective, first.solve, THOROUGH, first.stop, first.tell, rounds=best.rounds)
        climb.improve(start)
        climb.iterations += best.iterations
        climb.seconds = {stage: spent + best.seconds[stage] for stage, spent in climb.seconds.items()}
        further, free = climb.certain_value()
        if not climb.ended or not (free or further > value):
            break
        best = climb
    best.ended = best.ended and not first.stopped
    return best, None


def _boxes(search: LocalSearch) -> MotionBoxes | None:
    """Boxes of the motions of the only free body; None where there are more, or the goal is not about points and turns."""
    ready, goal = search.ready, search.objective
    free = np.flatnonzero(~ready.bodies.fixed)
    if len(free) != 1 or not isinstance(goal, PointMotion):
        return None
    body, n = int(free[0]), len(ready.bodies.fixed)
    others = np.flatnonzero(ready.bodies.fixed)
    low, high = np.minimum(others, body), np.maximum(others, body)
    others = others[~np.isin(low * n + high, ready.ignored)]
    geometry = placed(ready.bodies)
    mine = goal.body == body
    direction, spot = goal.direction[mine], goal.arm[mine] + ready.bodies.rest[body, :2]
    lever = np.array([(direction * spot).sum(), (spot[:, 0] * direction[:, 1] - spot[:, 1] * direction[:, 0]).sum()])
    return MotionBoxes(
        shapely.union_all(geometry[others]),
        geometry[body],
        direction.sum(0),
        lever,
        float(goal.turn[mine].sum()),
        MAX_BOXES,
    )


def _start(ready: Prepared, boxes: MotionBoxes, way: Floats) -> Start | None:
    """Where a search begins at the end of a path of boxes; None where no cells grow there."""
    bodies, cells = ready.bodies, ready.cells
    body = int(np.flatnonzero(~bodies.fixed)[0])
    motions = np.zeros((len(way), len(bodies.fixed), 3))
    motions[:, body] = about(way[:, None], (bodies.rest[body, :2] - boxes.pivot)[None])[:, 0]
    n = len(bodies.fixed)
    keys = np.union1d(cells.a * n + cells.b, ready.corners)
    a, b = keys // n, keys % n
    grown, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, motions[-1]), np.full(len(a), ready.clearance))
    if not good.all():
        return None
    program = build(bodies, select(cells, np.zeros(0, dtype=np.int64)), ZERO_MOTION, length=ready.clearance)
    segment = PathSegment(program, tuple(program.variables(motion) for motion in motions))
    return Start(grown, motions[-1], (segment,))
