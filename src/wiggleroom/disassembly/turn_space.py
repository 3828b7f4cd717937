"""Turns of single bodies in places to which slides lead: to where their edges lie along the axes again, or as far as there is room."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.slide_space import SlideSpace
from wiggleroom.disassembly.turn_moves import straight, turn_in_steps
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import exchange_classes
from wiggleroom.geometry.rotational_symmetry import symmetry_order

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

WORK_BUDGET = 6e8
"""Corners that are compared with edges at most; some seconds."""
REACH = 1.0
"""A body that turns goes no further than this multiple of its radius from where it began."""
MIN_TILT = 0.02
"""A smaller turn is none [rad]."""
MAX_POINTS = 1500
"""Poses of one turn that there is room for."""
SYMMETRY = 0.1
"""Images of a shape are the same up to this share of the clearance."""
MAX_AXIS_ORDER = 6
"""Axes that repeat after pi over an order up to this one are seen to do so: those of squares, triangles, hexagons."""


@dataclass(frozen=True, eq=False)
class LocalTurn:
    """One body turns while all others stand.

    Parameters
    ----------
    who : int
    path : (k, 3) float64 [mm, mm, rad]
        Poses of the body, relative to the first.
    aligned : bool
        True where its edges lie along the axes in the end, on the lattice where there is one; else it got no further.
    """

    who: int
    path: Floats
    aligned: bool

    @property
    def angle(self) -> float:
        """By how much it turned, either way [rad]."""
        return abs(float(self.path[-1, 2]))


class TurnSpace:
    """Turns of single bodies among the others, each tried once in every surrounding.

    Parameters
    ----------
    space : SlideSpace
    named : (k,) int64
        Bodies that the question distinguishes from others.
    """

    def __init__(self, space: SlideSpace, named: Ints) -> None:
        bodies = space.bodies
        self.kind = exchange_classes(bodies, space.ignored, named)
        """Class (n,) of exchangeable bodies that each belongs to."""
        self._space, self._seen = space, set[bytes]()
        self._free = np.flatnonzero(~bodies.fixed & space.there)
        half = len(space.directions) // 2
        self._axes, self._units = space.directions[:half], space.units[:half]
        self._quantum = axis_quantum(self._axes)
        self.order = _orders(bodies, SYMMETRY * space.clearance)
        """Of the symmetry of every shape that moves."""
        self._level = np.array([self._levels(b, bodies.rest[b]) for b in range(len(bodies.fixed))])
        self._path = np.empty((MAX_POINTS, 3))
        self.work = 0
        """Corners that were compared with edges."""
        self.places = 0
        """Surroundings of a body in which turns were tried."""

    def turns(self, motion: Floats) -> Iterator[LocalTurn]:
        """All turns from a state that were not tried in the same surroundings before."""
        bodies = self._space.bodies
        shapes, pose = bodies.shapes, bodies.rest + motion
        for b in self._free.tolist():
            near = self._near(b, pose)
            if self._known(b, near, pose):
                continue
            self.places += 1
            period = 2 * np.pi / self.order[bodies.shape[b]]
            for sense in (1.0, -1.0):
                start, parts, left = pose, [pose[b][None]], min(period, np.pi)
                while left > MIN_TILT:
                    step = min(self._quantum, left)
                    count, work = turn_in_steps(
                        shapes.corner, shapes.after, shapes.first, shapes.radius, bodies.shape, start, near, b,
                        sense * step, self._space.clearance, REACH * bodies.radius[b], self._path,
                    )  # fmt: skip
                    self.work += work
                    piece = self._path[:count].copy()
                    parts.append(piece[1:])
                    start = start.copy()
                    start[b] = piece[-1]
                    turned = abs(piece[-1, 2] - piece[0, 2])
                    left -= step
                    path = np.concatenate(parts)
                    if turned < step - 1e-9:
                        if abs(path[-1, 2] - path[0, 2]) > MIN_TILT:
                            yield LocalTurn(b, path - path[0], False)
                        break
                    if left > MIN_TILT:  # else it lies on its own image
                        yield from self._aligned(b, near, start, path)

    def _aligned(self, b: int, near: Bools, pose: Floats, path: Floats) -> Iterator[LocalTurn]:
        """The turn continued to a place on the lattice."""
        on = np.flatnonzero(self._units > 0)[:2]
        if not len(on):
            yield LocalTurn(b, path - path[0], True)
            return
        bodies = self._space.bodies
        off, unit = (self._level[b] - self._levels(b, pose[b]))[on], self._units[on]
        off -= np.round(off / unit) * unit
        shifts = [
            np.linalg.lstsq(self._axes[on], off + np.array(k) * unit, rcond=None)[0]
            for k in product((0, 1, -1), repeat=len(on))
        ]
        for shift in sorted(shifts, key=lambda s: float(np.hypot(*s))):
            end = pose[b] + [shift[0], shift[1], 0.0]
            if straight(
                bodies.shapes.corner, bodies.shapes.after, bodies.shapes.first, bodies.shape, pose, near, b, pose[b],
                end, self._space.clearance,
            ):  # fmt: skip
                yield LocalTurn(b, np.concatenate([path, end[None]]) - path[0], True)

    def _near(self, b: int, pose: Floats) -> Bools:
        """Bodies that a turn of b may meet."""
        bodies, space = self._space.bodies, self._space
        apart = np.hypot(*(pose[:, :2] - pose[b, :2]).T) - bodies.radius - bodies.radius[b]
        near: Bools = (apart < REACH * bodies.radius[b] + space.clearance) & space.there & ~space.ignored[b]
        near[b] = False
        return near

    def _known(self, b: int, near: Bools, pose: Floats) -> bool:
        """True where b was turned in the same surroundings before."""
        bodies, cell = self._space.bodies, 0.5 * self._space.clearance
        who = np.append(np.flatnonzero(near), b)
        at = pose[who] - [*pose[b, :2], 0.0]
        at[:, 2] %= 2 * np.pi / self.order[bodies.shape[who]]
        cells = np.round(at / [cell, cell, cell / max(1e-12, float(bodies.radius.max()))]).astype(np.int64)
        rows = np.column_stack([self.kind[who], cells])
        key = rows[-1].tobytes() + rows[np.lexsort(rows.T)].tobytes()
        known = key in self._seen
        self._seen.add(key)
        return known

    def _levels(self, b: int, pose: Floats) -> Floats:
        """How far back the body reaches along each axis [mm]."""
        shapes, s = self._space.bodies.shapes, self._space.bodies.shape[b]
        corner = shapes.corner[shapes.first[s] : shapes.first[s + 1]]
        c, sine = np.cos(pose[2]), np.sin(pose[2])
        at = corner @ np.array([[c, sine], [-sine, c]]) + pose[:2]
        return np.asarray((at @ self._axes.T).min(axis=0))


def _orders(bodies: Bodies, tolerance: float) -> Ints:
    shapes = bodies.shapes
    order = np.ones(len(shapes.first) - 1, dtype=np.int64)
    for s in np.unique(bodies.shape[~bodies.fixed]):
        some = slice(int(shapes.first[s]), int(shapes.first[s + 1]))
        order[s] = symmetry_order(shapes.corner[some], shapes.after[some] - some.start, tolerance)
    return order


def axis_quantum(axes: Floats) -> float:
    """Smallest angle [rad] by which all axes (k, 2) can be turned so that they lie on themselves.

    Examples
    --------
    >>> axis_quantum(np.array([[1.0, 0.0], [0.0, 1.0]])) == np.pi / 2
    True
    >>> axis_quantum(np.array([[1.0, 0.0]])) == np.pi
    True
    """
    angle = np.arctan2(axes[:, 1], axes[:, 0])
    for order in range(MAX_AXIS_ORDER, 1, -1):
        off = np.abs((angle[:, None] + np.pi / order - angle + np.pi / 2) % np.pi - np.pi / 2)
        if (off.min(axis=1) < 1e-3).all():
            return np.pi / order
    return np.pi
