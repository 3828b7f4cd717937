"""Steps of a plan: who moves, along which way, with how much room, past which parts that must be held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.departures import Departure
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.planning.clearance import distances
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STILL = 1e-12
"""A smaller change of a motion is none [mm, rad]."""
HELD_REACH = 1.5
"""A loose part that comes nearer to what moves than this multiple of the least clearance may be dragged along, and is held."""
MOST_CLEARANCE = 0.1
"""Clearances are worked out up to this share of the drawing's size."""


@dataclass(frozen=True, eq=False)
class Step:
    """One step of a plan: some parts move, all others stay.

    Parameters
    ----------
    parts : tuple of names
        Those that move, as one or each in its own way.
    way : (k, n, 3) float64 [mm, mm, rad]
        Motions of all parts about their reference points, since rest; straight in between.
    moves : int
        Of how many moves it consists.
    leaves : tuple of names
        Those that have left at its end.
    there : (n,) bool
        Parts that have not left before it.
    clearance : float [mm]
        Least distance on the way between what moves and all else, and between parts that move in different ways.
    room : float [mm]
        The largest ball of errors of position: shifted by up to so much, what moves still passes.
    turn_room : float [rad]
        The largest error of angle, either way: turned by up to so much about the middle of what moves, it still passes.
    axis : (2,) float64
        Unit vector along which the parts go in when they are put together: opposite to the last straight piece.
    held : tuple of names
        Loose parts that must be held, because what moves comes so near that it may drag them along.
    """

    parts: tuple[str, ...]
    way: Floats
    moves: int
    leaves: tuple[str, ...]
    there: NDArray[np.bool_]
    clearance: float = 0.0
    room: float = 0.0
    turn_room: float = 0.0
    axis: tuple[float, float] = (0.0, 0.0)
    held: tuple[str, ...] = ()

    @property
    def as_one(self) -> bool:
        """True where all parts that move do so as one rigid piece."""
        first = self.way - self.way[:1]
        moving = (np.abs(first) > STILL).any(axis=(0, 2))
        turned = np.abs(first[..., 2]).max() > STILL
        return bool(moving.sum() == 1 or (not turned and np.ptp(first[:, moving], axis=1).max() <= STILL))


def steps_of(assembly: Assembly, ground: Survey, departures: Sequence[Departure]) -> tuple[Step, ...]:
    """The steps of some departures, with all that is to be known of each."""
    return tuple(measured(assembly, ground, s) for d in departures for s in _split(assembly, d))


def _split(assembly: Assembly, departure: Departure) -> list[Step]:
    """Steps of one departure: as long as the same parts move, it is one step."""
    names, way, slides = assembly.names, departure.way, departure.slides
    moved: NDArray[np.bool_] = np.any(np.abs(np.diff(way, axis=0)) > STILL, axis=2)
    found: list[Step] = []
    begin, pieces = 0, len(way) - 1
    for k in range(1, pieces + 1):
        if k < pieces and (np.array_equal(moved[k], moved[begin]) or (slides < 0 and k < pieces - 1)):
            continue
        parts = tuple(names[p] for p in np.flatnonzero(moved[begin:k].any(axis=0)))
        found.append(Step(parts, way[begin : k + 1], k - begin if slides >= 0 else 1, (), departure.there))
        begin = k
    found[-1] = replace(found[-1], leaves=tuple(names[p] for p in departure.parts))
    return found


def measured(assembly: Assembly, ground: Survey, step: Step) -> Step:
    """The step with its clearance, room for errors, axis and held parts."""
    bodies, names = ground.bodies, np.array(assembly.names, dtype=object)
    way = of_bodies(assembly, bodies, step.way)
    there = np.array([step.there[list(m)].all() for m in bodies.members])
    most = MOST_CLEARANCE * ground.size
    apart = distances(bodies, way, there, ground.ignored, most)
    moving = np.unique(bodies.body_of[np.isin(names, step.parts)])
    clearance = float(apart[moving].min(initial=most))
    resting = np.setdiff1d(np.flatnonzero(~bodies.fixed & there), moving)
    dragged = resting[apart[resting][:, moving].min(axis=1, initial=most) < HELD_REACH * clearance]
    held = tuple(n for b in dragged for n in names[list(bodies.members[b])])
    reach = (
        float(bodies.radius[moving].max()) if len(moving) == 1 else _reach(bodies.rest[moving], bodies.radius[moving])
    )
    last = np.diff(step.way, axis=0)[-1]
    k = int(np.hypot(last[:, 0], last[:, 1]).argmax())
    length = float(np.hypot(*last[k, :2]))
    axis = (-float(last[k, 0]) / length, -float(last[k, 1]) / length) if length > STILL else (0.0, 0.0)
    return replace(step, clearance=clearance, room=clearance, turn_room=clearance / reach, axis=axis, held=held)


def _reach(rest: Floats, radius: Floats) -> float:
    """Radius about the middle of some bodies that move as one."""
    middle = rest[:, :2].mean(axis=0)
    return float((np.hypot(*(rest[:, :2] - middle).T) + radius).max())
