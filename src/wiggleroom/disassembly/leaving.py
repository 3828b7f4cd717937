"""Motions continued straight until the bodies that leave are beyond all others."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.disassembly.disassembly_sequence import NO_BODIES, Stage
from wiggleroom.disassembly.slide_search import MoveSequence
from wiggleroom.disassembly.translation import TranslationEscape
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.search.prepare import Prepared, Survey
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EXIT_DISTANCE = 0.1
"""Parts that left end this share of the drawing's size beyond all others."""


def leave_after_motion(
    surveyed: Survey, simpler: Prepared, still: MoveSequence, path: Floats, found: TranslationEscape
) -> Stage | None:
    """A largest motion of the simpler bodies that was searched, continued straight; None where that is not free."""
    assembly = simpler.assembly
    motions = of_bodies(assembly, surveyed.bodies, of_parts(assembly, simpler.bodies, path))
    return leave_moving(assembly, surveyed, still, motions, found)


def leave_moving(
    assembly: Assembly, surveyed: Survey, before: MoveSequence, path: Floats, found: TranslationEscape
) -> Stage | None:
    """One motion, after some moves, continued straight; None where that is not free.

    It is still one move where those who leave are all that moved.
    """
    number = before.moves.max(initial=-1) + 1
    states = np.concatenate([before.states, before.states[-1] + path[1:]])
    moves = np.append(before.moves, np.full(len(path) - 1, number))
    stage = leave(assembly, surveyed, MoveSequence(states, moves), found)
    moved = np.flatnonzero((np.abs(path) > 0).any(axis=(0, 2)))
    if stage is not None and np.array_equal(moved, found.who):
        stage.moves[-1] = number
    return stage


def leave(assembly: Assembly, surveyed: Survey, before: MoveSequence, found: TranslationEscape) -> Stage | None:
    """Moves continued straight until those who leave are beyond all others; None where that is not free."""
    bodies, who, path = surveyed.bodies, found.who, before.states
    others = np.setdiff1d(np.arange(len(bodies.fixed)), who)

    def along(some: Ints, motion: Floats) -> Floats:
        return np.asarray(shapely.get_coordinates(placed(bodies, motion, some)[some]) @ found.direction)

    # beyond where the others are now, and wherever they pass on their way back
    length = max(along(others, m).max() for m in path) - along(who, path[-1]).min()
    length += EXIT_DISTANCE * surveyed.size
    out = path[-1].copy()
    out[who, :2] += max(length, EXIT_DISTANCE * surveyed.size) * found.direction
    whole = np.concatenate([path, out[None]])
    if not audit_path(assembly, of_parts(assembly, bodies, whole)).free:
        return None
    moves = np.append(before.moves, before.moves.max(initial=-1) + 1)
    return Stage(Separability.COMES_APART, Certainty.PROVEN, who, whole, NO_BODIES, moves=moves)
