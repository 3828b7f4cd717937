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
from wiggleroom.freespace.subdivision.box_search import (
    CLOSED,
    FOUND,
    HALF_SIDES,
    PAUSED,
    across_of_one_box,
    best_corner,
    search_boxes,
)
from wiggleroom.freespace.subdivision.disc_tree import disc_tree
from wiggleroom.freespace.subdivision.passage import (
    COORDINATE_ROUNDING,
    WINDOW_OFFSET,
    middle_of_contact,
    rim_point,
    rounding_slack,
    shortcut,
    waypoints_through,
)
from wiggleroom.geometry.rigid_motions import about

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_DEPTH = 30
"""Boxes are halved at most this often."""
GOALS_PER_PASS = 256
"""Paths that are looked at in one pass."""
STOP_CHECK_BOXES = 2000
"""After this many boxes it is asked again whether to stop."""
MAX_TURN_OF_PIECE = 0.05
"""Turns of the pieces of a path [rad] that are straight about another point instead."""
CHORD = np.pi / 16
"""Angle of the chords [rad] by which a body goes round another outside the window."""
MAX_TURN = 2.2 * np.pi
"""Turns are followed up to this [rad] both ways where a turn itself is asked for."""


@dataclass(frozen=True, eq=False)
class PulledBody:
    """What is asked of a body `b` past `a`.

    Parameters
    ----------
    body : int
        Number of the body b, for whoever asks.
    a, b : shapely polygons [mm]
        Material at rest, not touching; a stands.
    pull : (2,) float64
        Sum of the directions in which b is pulled.
    lever : (2,) float64 [mm]
        Sums of direction . arm and of arm x direction, with the arms from the origin of assembly coordinates to the pulled points.
    turn : float
        Weight of the turn.
    """

    body: int
    a: shapely.Geometry
    b: shapely.Geometry
    pull: Floats
    lever: Floats
    turn: float


@dataclass(eq=False)
class MotionBoxes:
    """Boxes of motions of a body past others, cut where a question needs it; one question after the other uses the same boxes.

    Parameters
    ----------
    pulled : PulledBody
    most : int
        Boxes judged at most.
    """

    pulled: PulledBody
    most: int
    count: int = 1
    pivot: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Begin with one box."""
        self.pivot = middle_of_contact(self.pulled.a, self.pulled.b)
        one, other = disc_tree(self.pulled.a, self.pivot), disc_tree(self.pulled.b, self.pivot)
        self._pair = (*one.arrays, other.edge, other.disc, other.kid)
        self._wrap = self.pulled.turn == 0.0
        self._scale = np.array(
            [
                1.1 * (one.radius + other.radius),
                np.pi if self._wrap else MAX_TURN,
                rounding_slack(self.pulled.a, self.pulled.b),
            ]
        )
        self._origin = WINDOW_OFFSET * self._scale[[0, 0, 1]]
        self._middle, self._upper = np.zeros((self.most, 3)), np.full(self.most, np.inf)
        self._level, self._state = np.zeros((2, self.most), dtype=np.int8)
        self._first, self._path = np.full(self.most, -1, dtype=np.int32), np.zeros(self.most, dtype=np.int32)
        self._across = across_of_one_box(self.most)
        self._visits = np.zeros(2, dtype=np.int64)
        x, y = self.pivot
        dx, dy = self.pulled.pull
        # arms are measured from the pivot
        alpha, beta = self.pulled.lever[0] - (dx * x + dy * y), self.pulled.lever[1] - (x * dy - y * dx)
        self._asked = np.array([dx, dy, alpha, beta, self.pulled.turn, np.inf, np.inf])
        terms = (
            np.abs(self.pulled.lever).sum()
            + np.abs(self.pulled.pull).sum() * np.abs(self.pivot).sum()
            + self.largest_value
        )
        self._rounding = COORDINATE_ROUNDING * float(terms)

    @property
    def visits(self) -> int:
        """Boxes that all searches for paths have gone over."""
        return int(self._visits[0])

    @property
    def largest_value(self) -> float:
        """A value that no motion inside the window exceeds."""
        x, y = np.abs(self._origin[:2]) + self._scale[0]
        alpha, beta, turn = self._asked[2:5]
        swing = abs(self._origin[2]) + self._scale[1]
        return float(np.abs(self.pulled.pull) @ (x, y) + 2 * abs(alpha) + abs(beta) + abs(turn) * swing)

    def beyond(
        self, least: float, most: float, visits: int, stop: Stop | None = None
    ) -> tuple[float | None, Floats | None]:
        """Look for a motion worth more than `least`, or a proof that none is worth more than `most`.

        Parameters
        ----------
        least, most : float
        visits : int
            Boxes that all searches for paths since the first question go over at most; where that does not suffice, nothing is known.
        stop : optional
            Asked now and then.

        Returns
        -------
        at_most : float or None
            A value that no motion exceeds, larger than `most` by rounding at most, where that is proven.
        path : (k, 3) float64 [mm, mm, rad] or None
            Free motions about `pivot` from rest to one that is worth more, or out of the window; straight about it between them.
        """
        self._asked[5:] = most, least
        self._visits[1] = visits
        self._state[: self.count][self._state[: self.count] == 3] = 0
        how = PAUSED
        while how == PAUSED and not (stop is not None and stop.is_set()):
            how, self.count, length, largest = search_boxes(
                self._middle, self._level, self._state, self._first, self._across, self._upper, self.count, self.count + STOP_CHECK_BOXES,
                self._origin, self._scale, MAX_DEPTH, not self._wrap, self._asked, GOALS_PER_PASS, *self._pair, self._path, self._visits,
            )  # fmt: skip
        if how != FOUND:
            return (largest + self._rounding if how == CLOSED else None), None
        path = self._path[:length]
        points = waypoints_through(path, self._middle, self._level, self._origin, self._scale)
        reach = np.abs(self._middle[path[-1]]) + HALF_SIDES[self._level[path[-1]]]
        if reach[:2].max() >= 1.0:
            return None, np.vstack([points, self._round(rim_point(self._middle[path[-1]], self._origin, self._scale))])
        if not self._wrap and reach[2] >= 1.0:
            return None, points
        half = HALF_SIDES[self._level[path[-1]]] * self._scale[:2]
        x, y, turn = points[-1]
        _, turn = best_corner(self._asked, x, y, turn, *half)
        corner = [x + np.copysign(half[0], self.pulled.pull[0]), y + np.copysign(half[0], self.pulled.pull[1]), turn]
        return None, np.vstack([points, corner])

    def straightened(self, path: Floats, spot: Floats) -> Floats:
        """The same path (k, 3) as motions about another point (2,) [mm], with as few pieces straight about that point as are free."""
        count = np.maximum(np.ceil(np.abs(np.diff(path[:, 2])) / MAX_TURN_OF_PIECE), 1).astype(int)
        finer = [
            np.linspace(one, other, n, endpoint=False) for one, other, n in zip(path, path[1:], count, strict=False)
        ]
        points = about(np.concatenate([*finer, path[-1:]])[:, None], (spot - self.pivot)[None])[:, 0]
        one, other = disc_tree(self.pulled.a, spot), disc_tree(self.pulled.b, spot)
        return shortcut(points, (*one.arrays, other.edge, other.disc, other.kid))

    def _round(self, last: Floats) -> Floats:
        """From where a is left behind, on a circle round it to where the pull leads away from it."""
        if not self.pulled.pull.any():
            return last[None]
        radius, begin = np.hypot(*last[:2]), np.arctan2(last[1], last[0])
        turn = (np.arctan2(self.pulled.pull[1], self.pulled.pull[0]) - begin + np.pi) % (2 * np.pi) - np.pi
        angle = begin + np.linspace(0, turn, 1 + int(np.ceil(abs(turn) / CHORD)))
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), last[2])])
