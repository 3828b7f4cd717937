"""Steps made ready for robots: one motion after the other where possible, shortened, and as far from everything as they can be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.audit_outlines import AuditOutlines, outlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.disassembly.remaining import only
from wiggleroom.errors import Stop
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.planning.clearance_program import Carried, ClearanceProblem, widened
from wiggleroom.planning.steps import STILL, Step, finer
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_ALONE = 12
"""Of more parts that move at once nobody tries whether they go one after the other."""
TURN_PER_PIECE = 0.05
"""Before way-points are moved, pieces turn by at most this [rad]."""
PIECE_LENGTH = 0.1
"""Nor are they longer than this share of the drawing's size."""
STRAY = 0.02
"""Pieces of parts differ from those of bodies by at most about this share of the clearance."""
KEPT_CLEARANCE = 0.9
"""A way-point is left out where the way without it keeps this share of the clearance."""


def eased(assembly: Assembly, ground: Survey, steps: Sequence[Step], stop: Stop | None = None) -> tuple[Step, ...]:
    """Steps that do the same with more room: apart, shortened and widened; each is kept only where it certainly is free.

    Parameters
    ----------
    assembly : Assembly
    ground : Survey
        Of the assembly.
    steps : sequence of Step
    stop : optional
        Asked before each step; those that are left stay as they are.
    """
    todo = list(steps)
    done: list[Step] = []
    judged: dict[bytes, AuditOutlines] = {}

    def free(step: Step) -> bool:
        key = step.there.tobytes()
        if key not in judged:
            judged[key] = outlines(only(assembly, np.flatnonzero(step.there)))
        return audit_path(judged[key], step.way[:, step.there]).free

    while todo:
        plain = todo.pop(0)
        shift = (done[-1].way[-1] if done else plain.way[0]) - plain.way[0]
        shift[np.abs(shift) < STILL] = 0.0
        options = _from(assembly, plain, shift)
        step = next((option for option in options if len(options) < 2 or free(option)), options[0])
        if stop is not None and stop.is_set():
            if shift.any() and not free(step):
                return tuple(steps)
            done.append(step)
            continue
        alone = _one_by_one(assembly, step, free)
        if len(alone) > 1:
            step, todo = alone[0], [*alone[1:], *todo]
        better = _widened(assembly, ground, step)
        if free(better):
            step = better
        elif not free(step):  # what was gained before is in the way now
            return tuple(steps)
        done.append(step)
    return tuple(done)


def _from(assembly: Assembly, step: Step, shift: Floats) -> list[Step]:
    """The step where all parts are a little elsewhere to begin with.

    Those that move go on straight to where they would have gone; or beside their way as far as they are now; or back to its beginning
    first.
    """
    if not shift.any():
        return [step]
    moving = np.isin(assembly.names, step.parts)
    way = step.way.copy()
    way[:, ~moving] += shift[~moving]
    straight, beside = way.copy(), way.copy()
    straight[0, moving] += shift[moving]
    beside[:, moving] += shift[moving]
    back = np.concatenate([straight[:1], way])
    return [replace(step, way=one) for one in (straight, beside, back)]


def _one_by_one(assembly: Assembly, step: Step, free: Callable[[Step], bool]) -> list[Step]:
    """The step as several, of one part each, where they can go one after the other; else itself."""
    if step.as_one or len(step.parts) > MAX_ALONE:
        return [step]
    left, found = list(step.parts), []
    here = step.way[0]
    while left:
        for name in left:
            k = assembly.names.index(name)
            for through in (slice(None), slice(None, None, max(1, len(step.way) - 1))):
                points = step.way[through]
                way = np.repeat(here[None], len(points), 0)
                way[:, k] = points[:, k]
                one = replace(step, parts=(name,), way=way, moves=1, leaves=())
                if free(one):
                    break
            else:
                continue
            break
        else:
            return [step]
        found.append(one)
        here, left = one.way[-1], [n for n in left if n != name]
    found[-1] = replace(found[-1], leaves=step.leaves)
    return found


def _widened(assembly: Assembly, ground: Survey, step: Step) -> Step:
    """The step with the largest least clearance that its way allows, and without way-points that it does not need."""
    bodies = ground.bodies
    way = of_bodies(assembly, bodies, step.way)
    who = np.flatnonzero((np.abs(way - way[:1]) > STILL).any(axis=(0, 2)))
    there = np.array([step.there[list(m)].all() for m in bodies.members])
    slide = step.as_one and not np.abs(way[:, who, 2] - way[0, who, 2]).max() > STILL
    moving = Carried(who, slide)
    problem = ClearanceProblem(bodies, there, ground.ignored, ground.clearance, ground.size, moving)
    way = _shortened(problem, way)
    if not slide:  # slides lie where they are best; other ways need freedom to bend
        way = finer(way, TURN_PER_PIECE, PIECE_LENGTH * ground.size)
    way = _shortened(problem, widened(problem, way))
    return replace(step, way=for_parts(assembly, ground, widened(problem, way)))


def for_parts(assembly: Assembly, ground: Survey, way: Floats) -> Floats:
    """Motions (k, n, 3) of the parts from a way of the bodies, with points in between where bodies turn.

    The middles of bodies go straight, so reference points of parts that lie beside them do not quite.
    """
    bodies = ground.bodies
    arm = assembly.rest[:, :2] - bodies.rest[bodies.body_of, :2]
    bulge, most = STRAY * ground.clearance, float(np.hypot(*arm.T).max())
    turn = np.sqrt(8 * bulge / most) if most > bulge else TURN_PER_PIECE
    return of_parts(assembly, bodies, finer(way, turn) if np.abs(np.diff(way[..., 2], axis=0)).max() > STILL else way)


def _shortened(problem: ClearanceProblem, way: Floats) -> Floats:
    """The way without way-points that are not needed to keep nearly its clearance."""
    least = problem.least(way)
    k = 1
    while k < len(way) - 1:
        without = np.delete(way, k, axis=0)
        if problem.least(without[k - 1 : k + 1]) >= KEPT_CLEARANCE * least:
            way = without
        else:
            k += 1
    return way
