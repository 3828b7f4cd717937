"""The complete search of one body among others that stand: its reachable motions are covered by boxes, so the best of them is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.search.incumbent import Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.pulled_body import pulled_body
from wiggleroom.search.round_search import round_search
from wiggleroom.search.turn_in_place import start_after

Floats = NDArray[np.float64]

MAX_BOXES = 400_000
"""Boxes judged at most."""
MIN_IMPROVEMENT, PROVEN_GAP = 1e-4, 9e-4
"""Motions better by the first share are looked for in the end, until none better by the second is left."""
MIN_SHARE, MAX_SHARE, LAST_RATIO = 0.3, 0.4, 1.003
"""Once a better motion was found, one between the best value and the bound is asked for, at these shares of their ratio's logarithm."""
MAX_VISITS, VISITS_OF_A_QUESTION = 20_000_000, 800_000
"""Boxes that all searches for paths go over at most, and those of one question about such a value."""
VISITS_OF_ONE_OF_SEVERAL = 1_000_000
"""The same where the body is one of several free ones."""
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

    Where there are a few more, the body that the goal is about is led past the others where these lie at rest: nothing is proven then, but
    it may come to where a climb of all goes further.

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
    alone = int((~first.ready.bodies.fixed).sum()) == 1
    if pulled is not None:
        best, at_most, ends = round_search(first, pulled)
        cost = SIMPLIFIED_COST * first.ready.simplified * float(np.hypot(*pulled.pull))
        if alone and at_most is not None and at_most <= best.certain_value()[0] * (1 + PROVEN_GAP) + cost:
            return CompleteSearch(best, at_most, ends, settled=True)
    boxes = None if pulled is None else MotionBoxes(pulled, MAX_BOXES)
    visits = MAX_VISITS if alone else VISITS_OF_ONE_OF_SEVERAL
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
        allowed = visits if last else min(boxes.visits + VISITS_OF_A_QUESTION, visits)
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
    return CompleteSearch(best, at_most if alone else None, ends)


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
