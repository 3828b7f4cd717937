"""The one body that a goal is about, among others that stand where they are."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.subdivision.largest_motion import PulledBody
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.local_search import LocalSearch

Floats = NDArray[np.float64]

MAX_FREE = 12
"""Of so many free bodies at most one is looked at alone."""


def pulled_body(search: LocalSearch) -> PulledBody | None:
    """The body that the goal is about, as drawn; None where there are several, it meets nothing, or it is not about points and turns."""
    ready, goal = search.ready, search.objective
    if not isinstance(goal, PointMotion) or not 0 < (~ready.bodies.fixed).sum() <= MAX_FREE:
        return None
    if len(np.unique(goal.body)) != 1 or ready.bodies.fixed[goal.body[0]]:
        return None
    body = int(goal.body[0])
    drawn = bodies(ready.assembly) if ready.simplified else ready.bodies
    a, b = among_others(drawn, body, ready.ignored)
    if a.is_empty:
        return None
    mine = goal.body == body
    direction, spot = goal.direction[mine], goal.arm[mine] + ready.bodies.rest[body, :2]
    lever = np.array([(direction * spot).sum(), (spot[:, 0] * direction[:, 1] - spot[:, 1] * direction[:, 0]).sum()])
    return PulledBody(body, a, b, direction.sum(0), lever, float(goal.turn[mine].sum()))


def among_others(them: Bodies, body: int, ignored: NDArray[np.int64]) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Material at rest of all that a body must not meet, and of the body."""
    n = len(them.fixed)
    others = np.delete(np.arange(n), body)
    low, high = np.minimum(others, body), np.maximum(others, body)
    geometry = placed(them)
    return shapely.union_all(geometry[others[~np.isin(low * n + high, ignored)]]), geometry[body]
