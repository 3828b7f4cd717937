"""The incumbent of a search in the canonical frame, carried to the frame of the question: later questions start from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import CellWish, grow_cells, select
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective
from wiggleroom.search.answer import Answer
from wiggleroom.search.canonical_frame import CanonicalFrame
from wiggleroom.search.incumbent import Incumbent, PathSegment, Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import WITHOUT_BRANCHES
from wiggleroom.search.prepare import Prepared
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SAME_END

Floats = NDArray[np.float64]

ONE_ROUND = replace(WITHOUT_BRANCHES, moves=())
"""The same end, solved again in new cells."""


def carried_incumbent(
    ready: Prepared,
    objective: Objective,
    solve: Callable[..., Solution],
    found: Answer,
    frame: CanonicalFrame,
    waypoints: Floats,
) -> Incumbent | None:
    """Solve the last program of a search again in this frame, in more rounds where one is not enough; None where cells do not grow.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    solve : callable
        Solver.
    found : Answer
        In the other frame.
    frame : CanonicalFrame
    waypoints : (k, parts, 3) float64 [mm, mm, rad]
        Of that answer, in this frame.
    """
    there = found.warm_start
    if there is None:
        return None
    program, bodies = there.program, ready.bodies
    inner = of_parts(frame.assembly, program.bodies, program.motion(there.solution.inner)[None])
    path = of_bodies(ready.assembly, bodies, np.concatenate([waypoints[:-1], frame.motions(inner), waypoints[-1:]]))
    body = np.array([bodies.body_of[frame.order[members[0]]] for members in program.bodies.members])
    n = len(body)
    one, other = body[program.cells.a], body[program.cells.b]
    key = np.minimum(one, other) * n + np.maximum(one, other)
    a, b = key // n, key % n
    keep = relative_pose(bodies, a, b, path[-1])[:, None]
    room = np.full(len(a), ready.clearance)
    cells, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, path[-2]), room, wish=CellWish(keep))
    if not good.all():
        return None
    free = build_program(bodies, select(cells, np.zeros(0, dtype=np.int64)), ZERO_MOTION, length=ready.clearance)
    segment = PathSegment(free, tuple(free.variables(motion) for motion in path[:-1]))
    search = LocalSearch(ready, objective, solve, ONE_ROUND)
    mu = there.solution.inner_mu / frame.worth
    once = search.improve(Start(cells, path[-2], (segment,), mu=mu, tolerance=there.tolerance))
    end = objective.value(path[-1])
    if once is None or once.value >= end - SAME_END * abs(end):
        return once
    # held by the border of a new cell, where nothing touches: its forces say nothing about contacts
    return LocalSearch(ready, objective, solve, WITHOUT_BRANCHES).improve(once.start())
