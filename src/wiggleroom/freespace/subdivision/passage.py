"""Can one body leave another? Answered for certain where boxes of motions decide it, with the path where it can."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.errors import Stop
from wiggleroom.freespace.subdivision.box_search import (
    CLOSED,
    HALF_SIDES,
    PAUSED,
    SPENT,
    across_of_one_box,
    search_boxes,
)
from wiggleroom.freespace.subdivision.classify_box import is_free_segment
from wiggleroom.freespace.subdivision.disc_tree import disc_tree
from wiggleroom.geometry.outline_distances import OutlineDistances

Floats = NDArray[np.float64]

MAX_DEPTH = 22
"""Boxes are halved at most this often."""
STOP_CHECK_SECONDS = 0.2
"""About this often the search is asked whether it should stop [s]; it goes on as if it had not been interrupted."""
WINDOW_OFFSET = np.array([0.0371, 0.0213, 0.0157])
"""The window's middle lies a little beside rest, as a share of its half sides: rest must not lie on the faces of boxes."""
COORDINATE_ROUNDING = 64 * float(np.finfo(np.float64).eps)
"""Places at rest and in motion are as exact as this share of the largest coordinate."""
NOTHING_ASKED = np.array([0.0, 0.0, 0.0, 0.0, 0.0, np.inf, np.inf])
"""Only the rim is a goal."""


@dataclass(frozen=True, eq=False)
class Passage:
    """What is known about a body leaving another.

    Parameters
    ----------
    held : bool
        True where it certainly neither leaves nor turns half round.
    closed : bool
        True where it certainly does not leave.
    path : (k, 3) float64 [mm, mm, rad] or None
        Free motions of b past a about `pivot`, in assembly axes, from rest to where discs round both are apart; straight between them.
    pivot : (2,) float64 [mm]
        Assembly coordinates.
    """

    held: bool
    closed: bool
    path: Floats | None
    pivot: Floats


def passage(a: shapely.Geometry, b: shapely.Geometry, *, most: int = 50_000, stop: Stop | None = None) -> Passage:
    """Look for a path of `b` out of `a`, or a proof that there is none.

    Parameters
    ----------
    a, b : shapely polygons [mm]
        Material at rest, not touching; a stands.
    most : int
        Boxes judged at most; where they do not suffice, neither `closed` nor `path` is said.
    stop : optional
        Asked now and then; then neither is said.

    Examples
    --------
    >>> import shapely
    >>> ring = shapely.box(0, 0, 9, 9) - shapely.box(3, 3, 6, 6)
    >>> passage(ring, shapely.box(3.2, 3.2, 5.8, 5.8)).held
    True
    """
    pivot = middle_of_contact(a, b)
    one, other = disc_tree(a, pivot), disc_tree(b, pivot)
    scale = np.array([1.1 * (one.radius + other.radius), np.pi, rounding_slack(a, b)])
    origin = WINDOW_OFFSET * scale[[0, 0, 1]]
    middle, upper = np.zeros((most, 3)), np.full(most, np.inf)
    level, state = np.zeros((2, most), dtype=np.int8)
    first, path, across = np.full(most, -1, dtype=np.int32), np.zeros(most, dtype=np.int32), across_of_one_box(most)
    count = 1
    unlimited = np.array([0, np.iinfo(np.int64).max])
    pair = (*one.arrays, other.edge, other.disc, other.kid)
    for turning in (True, False):  # first without going round, which is the smaller question
        how, pace = PAUSED, 1000
        while how == PAUSED:
            if stop is not None and stop.is_set():
                return Passage(False, False, None, pivot)
            began, before = time.perf_counter(), count
            how, count, length, _ = search_boxes(
                middle, level, state, first, across, upper, count, count + pace, origin, scale, MAX_DEPTH, turning,
                NOTHING_ASKED, 1, *pair, path, unlimited,
            )  # fmt: skip
            pace = max(100, int((count - before) * STOP_CHECK_SECONDS / max(time.perf_counter() - began, 1e-9)))
        if how == CLOSED:
            return Passage(turning, True, None, pivot)
        if how == SPENT:
            break
        if not turning:
            points = waypoints_through(path[:length], middle, level, origin, scale)
            points = np.vstack([points, rim_point(middle[path[length - 1]], origin, scale)])
            return Passage(False, False, shortcut(points, pair), pivot)
    return Passage(False, False, None, pivot)


def rounding_slack(a: shapely.Geometry, b: shapely.Geometry) -> float:
    """How far points of two bodies may lie elsewhere [mm] than they should: by rounding, and by overlaps that count as none.

    Rounding is a share of the largest coordinate. Where bodies are far from the origin for their size, or play is small, it counts: what
    touches would else seem to overlap, and the best motion lie beyond its bound.
    """
    bounds = np.array([shapely.bounds(a), shapely.bounds(b)])
    size = (bounds[:, 2:].max(0) - bounds[:, :2].min(0)).max()
    return float(COORDINATE_ROUNDING * np.abs(bounds).max() + OVERLAP_TOLERANCE * size)


def middle_of_contact(a: shapely.Geometry, b: shapely.Geometry) -> Floats:
    """Middle of the place where both are nearest: points there are carried least far by a turn about it."""
    apart = float(OutlineDistances(np.array([a, b])).between([0], [1])[0])
    near = shapely.intersection(shapely.boundary(b), shapely.buffer(a, 3 * apart))
    box = shapely.bounds(b if shapely.is_empty(near) else near)
    return (box[:2] + box[2:]) / 2


def waypoints_through(
    path: NDArray[np.int32], middle: Floats, level: NDArray[np.int8], origin: Floats, scale: Floats
) -> Floats:
    """Waypoints: rest, middles of boxes and of the faces between them, turns unwrapped."""
    box, half = middle[path].copy(), HALF_SIDES[level[path]]
    for k in range(1, len(box)):
        box[k, 2] += 2 * np.round((box[k - 1, 2] - box[k, 2]) / 2)
    low = np.maximum(box[:-1] - half[:-1, None], box[1:] - half[1:, None])
    high = np.minimum(box[:-1] + half[:-1, None], box[1:] + half[1:, None])
    points = np.empty((2 * len(box) - 1, 3))
    points[::2], points[1::2] = box, (low + high) / 2
    return np.vstack([np.zeros(3), origin + points * scale[[0, 0, 1]]])


def rim_point(box: Floats, origin: Floats, scale: Floats) -> Floats:
    """The motion (3,) where a box meets the rim of the window; its middle, here in unit coordinates, may lie far inside."""
    point = box.copy()
    axis = int(np.abs(box[:2]).argmax())
    point[axis] = np.sign(box[axis])
    return np.asarray(origin + point * scale[[0, 0, 1]])


def shortcut(points: Floats, pair: tuple) -> Floats:
    """The path without the detours from box to box: as long straight pieces as are certainly free."""
    kept, k = [0], 0
    while k < len(points) - 1:
        step = len(points) - 1 - k
        while step > 1 and not is_free_segment(points[k], points[k + step], *pair, 1e-4):
            step = step // 2
        k += step
        kept.append(k)
    return points[kept]
