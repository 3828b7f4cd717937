"""Steps of a plan: who moves, along which path, with how much room, past which parts that must be held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.disassembly.disassembly_sequence import Departure
from wiggleroom.displayable import Displayable
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STILL = 1e-12
"""A smaller change of a motion is none [mm, rad]."""
HELD_REACH = 1.5
"""A loose part that comes nearer to what moves than this multiple of the least clearance may be dragged along, and is held."""
TURN_PER_PIECE = 0.02
"""Clearances are worked out on pieces that turn by at most this [rad]."""
MAX_CLEARANCE = 0.1
"""Clearances are worked out up to this share of the drawing's size."""


@dataclass(frozen=True, eq=False)
class Step(Displayable):
    """One step of a plan: some parts move, all others stay.

    Parameters
    ----------
    parts : tuple of names
        Those that move, as one or each on its own path.
    path : (k, n, 3) float64 [mm, mm, rad]
        Motions of all parts about their reference points, since rest; straight in between.
    moves : int
        Of how many moves it consists.
    leaves : tuple of names
        Those that have left at its end.
    there : (n,) bool
        Parts that have not left before it.
    clearance : float [mm]
        Least distance along the path between what moves and all else, and between parts that move differently.
    room : float [mm]
        The largest error of position: shifted by up to this in any direction, what moves still passes.
    turn_room : float [rad]
        An error of angle, either way, about the middle of what moves, under which it certainly still passes: no corner is carried further
        than the clearance.
    axis : (2,) float64
        Unit vector along which the parts go in when they are put together: opposite to the last straight piece.
    held : tuple of names
        Loose parts that must be held, because what moves comes so near that it may drag them along.
    falling : tuple of names
        Loose parts that must be held by hand, because their weight would carry them away; none where gravity was not looked at.
    """

    parts: tuple[str, ...]
    path: Floats
    moves: int
    leaves: tuple[str, ...]
    there: NDArray[np.bool_]
    clearance: float = 0.0
    room: float = 0.0
    turn_room: float = 0.0
    axis: tuple[float, float] = (0.0, 0.0)
    held: tuple[str, ...] = ()
    falling: tuple[str, ...] = ()

    @property
    def all_held(self) -> tuple[str, ...]:
        """Names of all that must be held, for either reason."""
        return (*self.held, *(name for name in self.falling if name not in self.held))

    @property
    def as_one(self) -> bool:
        """True where all parts that move do so as one rigid piece."""
        first = self.path - self.path[:1]
        moving = (np.abs(first) > STILL).any(axis=(0, 2))
        turned = np.abs(first[..., 2]).max() > STILL
        return bool(moving.sum() == 1 or (not turned and np.ptp(first[:, moving], axis=1).max() <= STILL))


def steps_of(assembly: Assembly, departures: Sequence[Departure]) -> tuple[Step, ...]:
    """The steps of some departures; their clearances, axes and held parts are not worked out yet."""
    return tuple(step for departure in departures for step in _split(assembly, departure))


def _split(assembly: Assembly, departure: Departure) -> list[Step]:
    """Steps of one departure: as long as the same parts move, it is one step."""
    names, path, moves = assembly.names, departure.path, departure.moves
    moved: NDArray[np.bool_] = np.any(np.abs(np.diff(path, axis=0)) > STILL, axis=2)
    found: list[Step] = []
    begin, pieces = 0, len(path) - 1
    for k in range(1, pieces + 1):
        if k < pieces and (np.array_equal(moved[k], moved[begin]) or moves[k] == moves[k - 1]):
            continue
        parts = tuple(names[p] for p in np.flatnonzero(moved[begin:k].any(axis=0)))
        found.append(Step(parts, path[begin : k + 1], len(np.unique(moves[begin:k])), (), departure.there))
        begin = k
    found[-1] = replace(found[-1], leaves=tuple(names[p] for p in departure.parts))
    return found


def measured(assembly: Assembly, surveyed: Survey, step: Step) -> Step:
    """The step with its clearance, room for errors, axis and held parts."""
    bodies, names = surveyed.bodies, np.array(assembly.names, dtype=object)
    fine, stray = _finely(assembly, surveyed, step.path)
    path = of_bodies(assembly, bodies, fine)
    there = np.array([step.there[list(m)].all() for m in bodies.members])
    most = MAX_CLEARANCE * surveyed.size
    apart = least_distances(bodies, path, there, surveyed.ignored, most)
    moving = np.unique(bodies.body_of[np.isin(names, step.parts)])
    clearance = max(float(apart[moving].min(initial=most)) - stray, 0.0)
    resting = np.setdiff1d(np.flatnonzero(~bodies.fixed & there), moving)
    dragged = resting[apart[resting][:, moving].min(axis=1, initial=most) < HELD_REACH * clearance]
    held = tuple(n for b in dragged for n in names[list(bodies.members[b])])
    reach = (
        float(bodies.radius[moving].max()) if len(moving) == 1 else _reach(bodies.rest[moving], bodies.radius[moving])
    )
    last = np.diff(step.path, axis=0)[-1]
    k = int(np.hypot(last[:, 0], last[:, 1]).argmax())
    length = float(np.hypot(*last[k, :2]))
    axis = (-float(last[k, 0]) / length, -float(last[k, 1]) / length) if length > STILL else (0.0, 0.0)
    return replace(step, clearance=clearance, room=clearance, turn_room=clearance / reach, axis=axis, held=held)


def finer(path: Floats, turn: float, length: float = np.inf) -> Floats:
    """The path (k, n, 3) with points in between, so that no piece turns by more than `turn` [rad] or is longer than `length` [mm]."""
    out = [path[:1]]
    for one, other in pairwise(path):
        change = np.abs(other - one)
        count = max(1, int(np.ceil(max(change[:, 2].max() / turn, change[:, :2].max() / length))))
        out.append(one + (other - one) * (np.arange(1, count + 1) / count)[:, None, None])
    return np.concatenate(out)


def _finely(assembly: Assembly, surveyed: Survey, path: Floats) -> tuple[Floats, float]:
    """The path with many points where it turns, and how far bodies may be from straight between them [mm].

    Reference points of parts go straight, so the middles of their bodies do not quite.
    """
    fine = finer(path, TURN_PER_PIECE)
    turn = float(np.abs(np.diff(fine[..., 2], axis=0)).max())
    arm = assembly.rest[:, :2] - surveyed.bodies.rest[surveyed.bodies.body_of, :2]
    return fine, 2 * float(np.hypot(*arm.T).max()) * turn**2 / 8


def _reach(rest: Floats, radius: Floats) -> float:
    """Radius about the middle of some bodies that move as one."""
    middle = rest[:, :2].mean(axis=0)
    return float((np.hypot(*(rest[:, :2] - middle).T) + radius).max())
