"""A round body among others that stand is led as far as it gets, which is known without a search of motions."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.subdivision.largest_motion import PulledBody
from wiggleroom.freespace.subdivision.round_room import furthest_along, round_body, way_along
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.search.answer import PROVEN_WITHIN
from wiggleroom.search.incumbent import Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.pulled_body import among_others
from wiggleroom.search.turn_in_place import better_climb, start_after

Floats = NDArray[np.float64]

TURN_STEP, TURN_DEVIATION = 0.1, 0.1
"""Waypoints of the turn are at most so far apart [rad], and between them nothing is further off than this share of the clearance."""


def round_search(first: LocalSearch, pulled: PulledBody) -> tuple[LocalSearch, float | None, tuple[float, ...]]:
    """The better of a search and of one from where a round body gets furthest; what no motion of it exceeds; and where both ended.

    The body turns about its middle first, to where the pulled points gain most, and then goes there.
    """
    ready, ends = first.ready, (first.certain_value()[0],)
    if pulled.turn != 0.0 or not pulled.pull.any() or shapely.is_empty(pulled.a):
        return first, None, ends
    body = round_body(pulled.b, pulled.a, ready.clearance)
    if body is None:
        return first, None, ends
    x, y = body.middle
    dx, dy = pulled.pull
    alpha, beta = pulled.lever[0] - (dx * x + dy * y), pulled.lever[1] - (x * dy - y * dx)  # arms from the middle
    gain = float(np.hypot(alpha, beta) - alpha)  # of the turn
    furthest = furthest_along(body, pulled.a, pulled.pull, ready.clearance)
    at_most = None if furthest is None else furthest + gain
    if at_most is not None and at_most <= PROVEN_WITHIN * ends[0]:
        return first, at_most, ends
    walls, material = among_others(ready.bodies, pulled.body, ready.ignored)
    searched = round_body(material, walls, ready.clearance)
    way = None if searched is None else way_along(searched, walls, pulled.pull, ready.clearance)
    if searched is None or way is None:
        return first, at_most, ends
    start = _start(ready, pulled.body, searched.middle, float(np.arctan2(beta, alpha)), way)
    if start is None:
        return first, at_most, ends
    best, others = better_climb(first, start)
    return best, at_most, (*others, best.certain_value()[0])


def _start(ready: Prepared, body: int, middle: Floats, turn: float, way: Floats) -> Start | None:
    """Where a search begins once a body has turned about its middle, which then went a way (k, 2); None where no cells grow there."""
    arm = ready.bodies.rest[body, :2] - middle
    step = min(TURN_STEP, np.sqrt(8 * TURN_DEVIATION * ready.clearance / max(np.hypot(*arm), ready.clearance)))
    turns = np.linspace(0.0, turn, 1 + int(np.ceil(abs(turn) / step)))
    path = np.zeros((len(turns) + len(way) - 1, 1, 3))
    path[: len(turns), 0, 2], path[len(turns) :, 0, 2] = turns, turn
    path[len(turns) :, 0, :2] = way[1:] - middle
    motions = np.zeros((len(path), len(ready.bodies.fixed), 3))
    motions[:, body] = about(path, arm[None])[:, 0]
    return start_after(ready, motions)
