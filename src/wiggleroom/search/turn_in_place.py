"""Round bodies turned about the middle of their outlines, to where a pull gains most by it.

Round outlines are polygons whose corners catch on each other in many shallow local optima. Turning in place passes them all.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.audit.path_audit import audit_path
from wiggleroom.freespace.cells.cells import Cells, grow_cells, select
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import about, of_parts
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective, PointMotion
from wiggleroom.search.incumbent import PathSegment, Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]

MIN_CORNERS = 12
"""A ring of fewer corners is not round."""
ANGLES = 720
"""Turns that are compared."""
TURN_STEP = 0.1
"""Waypoints of the turn are at most so far apart [rad]."""
EQUAL = 1e-6
"""Values that differ by less than this share are the same: parts do not turn for nothing."""


def turned_in_place(ready: Prepared, objective: Objective) -> Start | None:
    """Where a search begins after the only body that is pulled has been turned; None where it is not round, or would hit something."""
    if not isinstance(objective, PointMotion) or objective.turn.any() or len(np.unique(objective.body)) != 1:
        return None
    body = int(objective.body[0])
    if ready.bodies.fixed[body]:
        return None
    angle = np.linspace(-np.pi, np.pi, ANGLES + 1)
    for middle in round_middles(ready, body):
        values = np.array([objective.value(motion) for motion in turned_about(ready, body, middle, angle)])
        if values.max() <= 0:
            continue
        equal = angle[values >= (1 - EQUAL) * values.max()]
        best = float(equal[np.abs(equal).argmin()])
        for whole in (best, best - np.copysign(2 * np.pi, best)):
            steps = int(np.ceil(abs(whole) / TURN_STEP)) + 1
            motions = turned_about(ready, body, middle, np.linspace(0.0, whole, steps))
            if audit_path(ready.outlines, of_parts(ready.assembly, ready.bodies, motions)).free:
                return start_after(ready, motions)
    return None


def better_climb(first: LocalSearch, start: Start) -> tuple[LocalSearch, tuple[float, ...]]:
    """The better of a search and of one from another start, its work that of both, and the value at which the other ended."""
    climb = LocalSearch(
        first.ready, first.objective, first.solve, first.policy, first.stop, first.tell, rounds=first.rounds
    )
    climb.improve(start)
    climb.iterations += first.iterations
    climb.seconds = {stage: spent + first.seconds[stage] for stage, spent in climb.seconds.items()}
    one, other = first.certain_value(), climb.certain_value()
    if climb.ended and (other[1] or other[0] > one[0] + EQUAL * abs(one[0])):
        return climb, (one[0],)
    first.rounds, first.iterations, first.seconds = climb.rounds, climb.iterations, climb.seconds
    return first, (other[0],)


def start_after(ready: Prepared, motions: Floats) -> Start | None:
    """Where a search begins at the end of a path (k, n, 3) of the bodies that is free of overlap; None where no cells grow there."""
    grown = cells_round(ready, motions[-1])
    if grown is None:
        return None
    none = select(ready.cells, np.zeros(0, dtype=np.int64))
    program = build_program(ready.bodies, none, ZERO_MOTION, length=ready.clearance)
    segment = PathSegment(program, tuple(program.variables(motion) for motion in motions))
    return Start(grown, motions[-1], (segment,))


def cells_round(ready: Prepared, motion: Floats) -> Cells | None:
    """Cells of all pairs round a motion (n, 3) of the bodies; None where not all grow."""
    bodies, n = ready.bodies, len(ready.bodies.fixed)
    keys = np.union1d(ready.cells.a * n + ready.cells.b, ready.corners)
    a, b = keys // n, keys % n
    grown, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, motion), np.full(len(a), ready.clearance))
    return grown if good.all() else None


def round_middles(ready: Prepared, body: int) -> list[Floats]:
    """Middles (2,) [mm] at rest of the rings of a body that are round to the clearance, the widest first."""
    bodies, shapes = ready.bodies, ready.bodies.shapes
    first = slice(int(shapes.first[bodies.shape[body]]), int(shapes.first[bodies.shape[body] + 1]))
    corner, after = shapes.corner[first], shapes.after[first] - first.start
    ends = np.flatnonzero(after != np.arange(1, len(after) + 1)) + 1
    x, y, turn = bodies.rest[body]
    c, s = np.cos(turn), np.sin(turn)
    found = []
    for ring in np.split(corner, ends[:-1]):
        if len(ring) < MIN_CORNERS:
            continue
        middle = np.array(shapely.Polygon(ring).centroid.coords[0])
        radius = np.hypot(*(ring - middle).T)
        if np.ptp(radius) <= ready.clearance:
            place = np.array([c * middle[0] - s * middle[1] + x, s * middle[0] + c * middle[1] + y])
            found.append((float(radius.max()), place))
    return [place for _, place in sorted(found, key=lambda one: -one[0])]


def turned_about(ready: Prepared, body: int, middle: Floats, angle: Floats) -> Floats:
    """Motions (k, n, 3) in which a body turns about a place by some angles (k,), and nothing else moves."""
    motions = np.zeros((len(angle), len(ready.bodies.fixed), 3))
    turn = np.zeros((len(angle), 1, 3))
    turn[:, 0, 2] = angle
    motions[:, body] = about(turn, (ready.bodies.rest[body, :2] - middle)[None])[:, 0]
    return motions
