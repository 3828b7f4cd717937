"""The largest motion of one body among others that stand, by branch and bound over boxes of motions: the best there is, and the proof.

All that can be reached from rest lies in the boxes that are joined to the one at rest by boxes not certainly forbidden. Where none of
these may hold a motion worth more than a value, no motion is; where one that is certainly free and reached by free ones does, a better
motion is found. Boxes that leave that open are halved.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.freespace.subdivision.classify_box import CLOSED, FOUND, PAUSED, best_corner, search
from wiggleroom.freespace.subdivision.disc_tree import solid
from wiggleroom.freespace.subdivision.passage import WINDOW_OFFSET, middle_of_contact, shorter, way_through

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_DEPTH = 30
"""Boxes are halved at most this often."""
GOALS_PER_PASS = 256
"""Ways looked at in every lap."""
STOP_CHECK_BOXES = 2000
"""After so many boxes, whether to stop is asked again."""
MAX_VISITS = 2_500_000
"""Boxes that all searches for ways go over at most: where many motions are nearly the best, each of many searches brings little."""
MAX_TURN = 2.2 * np.pi
"""Turns are followed so far [rad] both ways where turning itself is asked for."""


@dataclass(eq=False)
class MotionBoxes:
    """Boxes of motions of `b` past `a`, cut where a question needs it; one question after the other uses the same boxes.

    Parameters
    ----------
    a, b : shapely polygons [mm]
        Material at rest, not touching; a stands.
    pull : (2,) float64
        Sum of the directions in which b is pulled.
    lever : (2,) float64 [mm]
        Sums of direction . arm and of arm x direction, with the arms from the origin of assembly coordinates to the pulled points.
    turn : float
        Weight of the turn.
    most : int
        Boxes judged at most.
    """

    a: shapely.Geometry
    b: shapely.Geometry
    pull: Floats
    lever: Floats
    turn: float
    most: int
    count: int = 1
    pivot: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Begin with one box."""
        self.pivot = middle_of_contact(self.a, self.b)
        one, other = solid(self.a, self.pivot), solid(self.b, self.pivot)
        self._pair = (*one.arrays, other.edge, other.disc, other.kid)
        self._wrap = self.turn == 0.0
        self._scale = np.array([1.1 * (one.radius + other.radius), np.pi if self._wrap else MAX_TURN])
        self._origin = WINDOW_OFFSET * self._scale[[0, 0, 1]]
        self._middle, self._level = np.zeros((self.most, 3)), np.zeros(self.most, dtype=np.int64)
        self._state, self._first = np.zeros(self.most, dtype=np.int64), np.full(self.most, -1)
        self._upper, self._way = np.full(self.most, np.inf), np.zeros(self.most, dtype=np.int64)
        self._visits = np.array([0, MAX_VISITS])
        x, y = self.pivot
        dx, dy = self.pull
        # arms are measured from the pivot
        alpha, beta = self.lever[0] - (dx * x + dy * y), self.lever[1] - (x * dy - y * dx)
        self._asked = np.array([dx, dy, alpha, beta, self.turn, np.inf, np.inf])

    def beyond(self, least: float, most: float, stop: Stop | None = None) -> tuple[bool, Floats | None]:
        """Look for a motion worth more than `least`, or a proof that none is worth more than `most`.

        Returns
        -------
        closed : bool
            True where that is proven.
        way : (k, 3) float64 [mm, mm, rad] or None
            Free motions about `pivot` from rest to one that is worth more, straight between them.
        """
        self._asked[5:] = most, least
        self._state[: self.count][self._state[: self.count] == 3] = 0
        how = PAUSED
        while how == PAUSED and not (stop is not None and stop.is_set()):
            how, self.count, length = search(
                self._middle, self._level, self._state, self._first, self._upper, self.count, self.count + STOP_CHECK_BOXES, self._origin,
                self._scale, MAX_DEPTH, self._wrap, not self._wrap, self._asked, GOALS_PER_PASS, *self._pair, self._way, self._visits,
            )  # fmt: skip
        if how != FOUND:
            return how == CLOSED, None
        way = self._way[:length]
        if self._at_rim(int(way[-1])):
            return False, None
        points = way_through(way, self._middle, self._level, self._origin, self._scale)
        half = 0.5 ** self._level[way[-1]] * self._scale
        x, y, turn = points[-1]
        _, turn = best_corner(self._asked, x, y, turn, *half)
        corner = [x + np.copysign(half[0], self.pull[0]), y + np.copysign(half[0], self.pull[1]), turn]
        return False, np.vstack([shorter(points, self._pair), corner])

    def _at_rim(self, n: int) -> bool:
        reach = np.abs(self._middle[n]) + 0.5 ** self._level[n]
        return bool(reach[:2].max() >= 1.0 or (not self._wrap and reach[2] >= 1.0))
