"""Directions of recession: bodies go straight, or turn as one, without end, push along what is in front, and no fixed body is among it."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.program.objectives import Objective
from wiggleroom.search.prepare import Prepared, Survey

Floats = NDArray[np.float64]

DIRECTIONS = 32
"""Directions evenly round that are tried, besides that of the motion and that of the objective."""
FAR = 1e4
"""This many drawing sizes along a direction stand for infinity."""
NEAR = 1e-6
"""What comes nearer to a circle than this share of its radius is taken along by what turns in it."""
MIN_SLOPE = 1e-3
"""An objective is unbounded where it grows by this share of its slope times the distance or the turn, and on a line by nearly as much again
over twice the distance."""


def recession_direction(ready: Prepared | Survey, objective: Objective, motion: Floats) -> Floats | None:
    """A direction (2,) in which some bodies leave without end from a motion (n, 3), and the objective grows; None where none was found.

    Source: a direction of recession of the free motions (Rockafellar, "Convex Analysis", section 8), of bodies that only translate. What
    the convex hull of a body would run into is taken along.
    """
    shapes = placed(ready.bodies, motion)
    slope = objective.gradient(motion)
    slope[ready.bodies.fixed] = 0.0
    asked = np.flatnonzero((slope != 0).any(axis=1))
    angle = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    directions = [slope[:, :2].sum(axis=0), *motion[asked, :2], *np.column_stack([np.cos(angle), np.sin(angle)])]
    for direction in directions:
        length = float(np.hypot(*direction))
        if length == 0:
            continue
        for body in asked:
            who = _taken_along(ready, shapes, int(body), direction / length)
            if who is not None and grows(ready, objective, motion, who, direction / length):
                return direction / length
    return None


def _taken_along(
    ready: Prepared | Survey, shapes: NDArray[np.object_], body: int, direction: Floats
) -> NDArray[np.bool_] | None:
    """Bodies (n,) that move along with one that goes straight; None where one of them stands."""
    n = len(shapes)
    low, high = np.divmod(ready.ignored, n)
    passes = np.zeros((n, n), dtype=bool)
    passes[low, high] = passes[high, low] = True
    box = shapely.total_bounds(shapes)
    far = 2 * direction * np.hypot(*(box[2:] - box[:2]))
    who = np.zeros(n, dtype=bool)
    waiting = [body]
    who[body] = True
    while waiting:
        one = waiting.pop()
        hull = shapely.convex_hull(shapes[one])
        ahead = shapely.transform(hull, lambda points: points + far)
        swept = shapely.convex_hull(shapely.union_all([hull, ahead]))
        met = shapely.intersects(swept, shapes) & ~who & ~passes[one]
        if ready.bodies.fixed[met].any():
            return None
        who |= met
        waiting += np.flatnonzero(met).tolist()
    return who


def grows(
    ready: Prepared | Survey, objective: Objective, motion: Floats, who: NDArray[np.bool_], direction: Floats
) -> bool:
    """True where the objective grows without end."""
    away = np.zeros_like(motion)
    away[who, :2] = FAR * ready.size * direction
    here, there, twice = (objective.value(motion + k * away) for k in (0, 1, 2))
    least = MIN_SLOPE * FAR * ready.size * float(np.abs(objective.gradient(motion)[:, :2]).max())
    return there - here > least and twice - there > (1 - MIN_SLOPE) * (there - here)


def turns_for_ever(ready: Prepared | Survey, objective: Objective, motion: Floats) -> bool:
    """True where a body that is asked to turn does so without end from a motion (n, 3), together with what is near, clear of all else."""
    shapes, value = placed(ready.bodies, motion), objective.value(motion)
    slope = objective.gradient(motion)[:, 2]
    for body in np.flatnonzero((slope != 0) & ~ready.bodies.fixed):
        who = np.zeros(len(shapes), dtype=bool)
        who[body], grows = True, True
        while grows and not (who & ready.bodies.fixed).any():
            together = shapely.union_all(shapes[who])
            middle = shapely.centroid(shapely.minimum_bounding_circle(together))
            reach = shapely.distance(middle, shapely.points(shapely.get_coordinates(together))).max()
            near = shapely.distance(middle, shapes) <= reach * (1 + NEAR)
            grows = bool((near & ~who).any())
            who |= near
        if (who & ready.bodies.fixed).any():
            continue
        once_more = motion.copy()
        once_more[who, 2] += 2 * np.pi * np.sign(slope[body])
        if objective.value(once_more) - value > MIN_SLOPE * 2 * np.pi * abs(slope[body]):
            return True
    return False
