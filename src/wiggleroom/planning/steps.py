"""Steps of a plan: who moves, along which path, with how much room, past which parts that must be held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.disassembly_sequence import Departure
from wiggleroom.displayable import Displayable

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STILL = 1e-12
"""A smaller change of a motion is none [mm, rad]."""
SAME_DIRECTION = 1e-9
"""Two straight pieces of the same parts are one move where their directions differ by less."""
HELD_REACH = 1.5
"""A loose part that comes nearer to what moves than this multiple of the least clearance may be dragged along, and is held."""
MAX_CLEARANCE = 0.1
"""Clearances are worked out up to this share of the drawing's size."""


@dataclass(frozen=True, eq=False)
class Step(Displayable):
    """One step of a plan: some parts move, all others stay.

    Parameters
    ----------
    parts : tuple of names
        The moving parts, as one or each on its own path.
    path : (k, n, 3) float64 [mm, mm, rad], in space (k, n, 6)
        Motions of all parts about their reference points, since rest; straight in between.
    moves : int
        Number of moves.
    leaves : tuple of names
        Parts that have left at its end.
    there : (n,) bool
        True for parts that have not left before it.
    clearance : float [mm]
        Least distance along the path between moving parts and all others, and between parts that move differently; in space turns are
        sampled.
    room : float [mm]
        Largest error of position, in any direction, at which the moving parts still pass.
    turn_room : float [rad]
        Error of angle, either way, about the middle of the moving parts, at which they certainly still pass: no corner moves further than
        the clearance.
    axis : (2,) or (3,) float64
        Unit vector along which the parts go in on assembly: opposite to the last straight piece.
    held : tuple of names
        Loose parts to hold because the moving parts may drag them along.
    falling : tuple of names
        Loose parts to hold because they would fall; empty without gravity.
    """

    parts: tuple[str, ...]
    path: Floats
    moves: int
    leaves: tuple[str, ...]
    there: NDArray[np.bool_]
    clearance: float = 0.0
    room: float = 0.0
    turn_room: float = 0.0
    axis: tuple[float, ...] = (0.0, 0.0)
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
        turned = np.abs(first[..., axes_of(first) :]).max() > STILL
        return bool(moving.sum() == 1 or (not turned and np.ptp(first[:, moving], axis=1).max() <= STILL))


def moves_of(path: Floats) -> Ints:
    """Number of the move (k - 1,) that each piece of a path (k, n, 3), in space (k, n, 6), belongs to.

    Pieces of the same parts are one move where they go on in the same direction, or turn.

    >>> moves_of(np.array([[[0.0, 0, 0]], [[1, 0, 0]], [[3, 0, 0]], [[3, 2, 0]]])).tolist()
    [0, 0, 1]
    """
    change, axes = np.diff(path, axis=0), axes_of(path)
    found = np.zeros(len(change), dtype=np.int64)
    for k, (one, other) in enumerate(pairwise(change)):
        same = np.array_equal((np.abs(one) > STILL).any(axis=1), (np.abs(other) > STILL).any(axis=1))
        turning = np.abs(one[:, axes:]).max() > STILL and np.abs(other[:, axes:]).max() > STILL
        found[k + 1] = found[k] + (not (same and (turning or _parallel(one[:, :axes], other[:, :axes]))))
    return found


def without_rests(path: Floats) -> Floats:
    """The path (k, n, 3), in space (k, n, 6), without pieces in which nothing moves.

    >>> without_rests(np.array([[[0.0, 0, 0]], [[1, 0, 0]], [[1, 0, 0]], [[3, 0, 0]]]))[:, 0, 0].tolist()
    [0.0, 1.0, 3.0]
    """
    moved = (np.abs(np.diff(path, axis=0)) > STILL).any(axis=(1, 2))
    return path[np.flatnonzero(np.append(True, moved))]


def axes_of(path: Floats) -> int:
    """Number of translations in a path: 2 in the plane, 3 in space."""
    return 2 if path.shape[-1] == 3 else 3


def _parallel(one: Floats, other: Floats) -> bool:
    """True where all parts go on in their directions."""
    lengths = np.linalg.norm(one), np.linalg.norm(other)
    return bool(min(lengths) > STILL and np.abs(one / lengths[0] - other / lengths[1]).max() < SAME_DIRECTION)


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


@dataclass(frozen=True, eq=False)
class StepRoom:
    """How near bodies come to each other in a step.

    Parameters
    ----------
    body_of : (n,) int64
        Body of every part.
    fixed : (m,) bool
    places : (m, d) float64 [mm]
        Reference points of the bodies at rest.
    radius : (m,) float64 [mm]
        How far their furthest corners are from these.
    apart : (m, m) float64 [mm]
        Least distances of those that move against each other; `most` where they are further apart or do not.
    most : float [mm]
    """

    body_of: Ints
    fixed: NDArray[np.bool_]
    places: Floats
    radius: Floats
    apart: Floats
    most: float


def with_room(step: Step, names: Sequence[str], its: StepRoom) -> Step:
    """The step with its clearance, room for errors, axis and held parts."""
    all_names = np.array(names, dtype=object)
    there = np.array([step.there[its.body_of == b].all() for b in range(len(its.fixed))])
    moving = np.unique(its.body_of[np.isin(all_names, step.parts)])
    clearance = max(float(its.apart[moving].min(initial=its.most)), 0.0)
    resting = np.setdiff1d(np.flatnonzero(~its.fixed & there), moving)
    dragged = resting[its.apart[resting][:, moving].min(axis=1, initial=its.most) < HELD_REACH * clearance]
    held = tuple(n for b in dragged for n in all_names[its.body_of == b])
    middle = its.places[moving].mean(axis=0) if len(moving) > 1 else its.places[moving[0]]
    reach = float((np.linalg.norm(its.places[moving] - middle, axis=1) + its.radius[moving]).max())
    axes = its.places.shape[1]
    last = np.diff(step.path, axis=0)[-1, :, :axes]
    lengths = np.linalg.norm(last, axis=1)
    k = int(lengths.argmax())
    axis = tuple((-last[k] / lengths[k]).tolist()) if lengths[k] > STILL else (0.0,) * axes
    return replace(step, clearance=clearance, room=clearance, turn_room=clearance / reach, axis=axis, held=held)
