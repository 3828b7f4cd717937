"""The complete search of one body among others that stand: its reachable motions are covered by boxes, so the best of them is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes, PulledBody
from wiggleroom.freespace.subdivision.round_room import furthest_along, round_body, way_along
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.answer import PROVEN_WITHIN
from wiggleroom.search.incumbent import Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.turn_in_place import better_climb, start_after

Floats = NDArray[np.float64]

MAX_BOXES = 400_000
"""Boxes judged at most."""
MIN_IMPROVEMENT, PROVEN_GAP = 1e-4, 9e-4
"""Motions better by the first share are looked for in the end, until none better by the second is left."""
MIN_SHARE, MAX_SHARE, LAST_RATIO = 0.3, 0.4, 1.003
"""Once a better motion was found, one between the best value and the bound is asked for, at these shares of their ratio's logarithm."""
MAX_VISITS, VISITS_OF_A_QUESTION = 20_000_000, 800_000
"""Boxes that all searches for paths go over at most, and those of one question about such a value."""
SIMPLIFIED_COST = 4.0
"""Outlines with fewer corners may cost this multiple of what they were moved out by."""
MAX_CLIMBS = 40
"""Ends looked for at most, each better than the one before."""


@dataclass(frozen=True, eq=False)
class CompleteSearch:
    """What a complete search came to.

    Parameters
    ----------
    best : LocalSearch
        That which found the best motion.
    at_most : float or None
        A value that no motion exceeds, where one was found.
    ends : tuple of float
        Values at which the climbs ended, the first search's among them.
    settled : bool
        True where a round body got as far as it can, but for what outlines with more corners may show: no search of these shows more.
    """

    best: LocalSearch
    at_most: float | None
    ends: tuple[float, ...]
    settled: bool = False


def complete_search(first: LocalSearch) -> CompleteSearch:
    """Look for better motions of the only free body wherever it gets, until there certainly is none.

    First it is asked whether anything is better at all. If so, a value between the best and the bound is asked about, again and again:
    either one is found and climbed from, or the bound falls. So the many local optima of a motion that ripples are not climbed one by one.
    Boxes are of the parts as drawn, also where climbs are of outlines with fewer corners.

    Parameters
    ----------
    first : LocalSearch
        Ended.
    """
    pulled = None if first.stopped else pulled_body(first)
    best, at_most = first, None
    ends: tuple[float, ...] = (first.certain_value()[0],)
    if pulled is not None:
        best, at_most, ends = round_search(first, pulled)
        cost = SIMPLIFIED_COST * first.ready.simplified * float(np.hypot(*pulled.pull))
        if at_most is not None and at_most <= best.certain_value()[0] * (1 + PROVEN_GAP) + cost:
            return CompleteSearch(best, at_most, ends, settled=True)
    boxes = None if pulled is None else MotionBoxes(pulled, MAX_BOXES)
    most = reach = np.inf if boxes is None else boxes.largest_value if at_most is None else at_most
    while boxes is not None and len(ends) <= MAX_CLIMBS:
        value, free = best.certain_value()
        if free or value <= 0 or most <= value * (1 + PROVEN_GAP):
            break
        last = len(ends) == 1 or reach <= LAST_RATIO * value
        if last:
            asked = value * (1 + MIN_IMPROVEMENT), value * (1 + PROVEN_GAP)
        else:
            asked = value * (reach / value) ** MIN_SHARE, value * (reach / value) ** MAX_SHARE
        allowed = MAX_VISITS if last else min(boxes.visits + VISITS_OF_A_QUESTION, MAX_VISITS)
        bound, path = boxes.beyond(*asked, allowed, first.stop)
        if bound is not None:
            at_most = most = reach = max(bound, value)
            continue
        if path is None:
            if last:
                break
            reach = asked[0]  # too much is asked for
            continue
        climb = _climbed(best, boxes, path)
        if climb is None:
            break
        further, free = climb.certain_value()
        ends = (*ends, further)
        if not (free or further > value):
            break
        best = climb
    best.ended = best.ended and not first.stopped
    return CompleteSearch(best, at_most, ends)


def _climbed(best: LocalSearch, boxes: MotionBoxes, path: Floats) -> LocalSearch | None:
    """A search that has climbed from the end of a path of boxes, its work that of all; None where no cells grow there."""
    start = _start(best.ready, boxes, path)
    if start is None:
        return None
    climb = LocalSearch(best.ready, best.objective, best.solve, THOROUGH, best.stop, best.tell, rounds=best.rounds)
    climb.improve(start)
    climb.iterations += best.iterations
    climb.seconds = {stage: spent + best.seconds[stage] for stage, spent in climb.seconds.items()}
    return climb if climb.ended else None


def _start(ready: Prepared, boxes: MotionBoxes, path: Floats) -> Start | None:
    """Where a search begins at the end of a path of boxes; None where no cells grow there."""
    bodies, body = ready.bodies, boxes.pulled.body
    spot = ready.assembly.rest[bodies.members[body][0], :2]  # a path is straight about the reference points of parts
    path = boxes.straightened(path, spot)
    motions = np.zeros((len(path), len(bodies.fixed), 3))
    motions[:, body] = about(path[:, None], (bodies.rest[body, :2] - spot)[None])[:, 0]
    return start_after(ready, motions)


def pulled_body(search: LocalSearch) -> PulledBody | None:
    """The body that the goal is about, as drawn; None unless it alone is free, meets something, and the goal is of points and turns."""
    ready, goal = search.ready, search.objective
    if not isinstance(goal, PointMotion) or (~ready.bodies.fixed).sum() != 1:
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
    start = _start_of_round(ready, pulled.body, searched.middle, float(np.arctan2(beta, alpha)), way)
    if start is None:
        return first, at_most, ends
    best, others = better_climb(first, start)
    return best, at_most, (*others, best.certain_value()[0])


def _start_of_round(ready: Prepared, body: int, middle: Floats, turn: float, way: Floats) -> Start | None:
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
