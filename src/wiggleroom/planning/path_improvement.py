"""Paths of steps improved for robots: one part after the other where possible, with shortcuts, and with the largest clearance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.audit_outlines import AuditOutlines, outlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.clearance_program import ClearanceProblem, MovingBodies, largest_clearance_path
from wiggleroom.disassembly.remaining import only
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.planning.steps import STILL, Step
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_ALONE = 12
"""Steps in which more parts move at once are not split into steps of one part each."""
TURN_PER_PIECE = 0.05
"""Before waypoints are moved, pieces turn by at most this [rad]."""
PIECE_LENGTH = 0.1
"""Nor are they longer than this share of the drawing's size."""
PART_DEVIATION = 0.02
"""Pieces of parts differ from those of bodies by at most about this share of the clearance."""
KEPT_CLEARANCE = 0.9
"""A waypoint is left out where the path without it keeps this share of the clearance."""


def improved_steps(
    assembly: Assembly, surveyed: Survey, steps: Sequence[Step], context: Context = UNLIMITED
) -> tuple[Step, ...]:
    """Steps that do the same with more room: apart, shortened and widened; each is kept only where it certainly is free.

    Parameters
    ----------
    assembly : Assembly
    surveyed : Survey
        Of the assembly.
    steps : sequence of Step
    context : Context, optional
    """
    todo = list(steps)
    done: list[Step] = []
    judged: dict[bytes, AuditOutlines] = {}

    def free(step: Step) -> bool:
        key = step.there.tobytes()
        if key not in judged:
            judged[key] = outlines(only(assembly, np.flatnonzero(step.there)))
        return audit_path(judged[key], step.path[:, step.there]).free

    while todo:
        plain = todo.pop(0)
        shift = (done[-1].path[-1] if done else plain.path[0]) - plain.path[0]
        shift[np.abs(shift) < STILL] = 0.0
        options = _from(assembly, plain, shift)
        step = next((option for option in options if len(options) < 2 or free(option)), options[0])
        if context.stopped:
            if shift.any() and not free(step):
                return tuple(steps)
            done.append(step)
            continue
        alone = _one_by_one(assembly, step, free)
        if len(alone) > 1:
            step, todo = alone[0], [*alone[1:], *todo]
        better = _with_largest_clearance(assembly, surveyed, step)
        if free(better):
            step = better
        elif not free(step):  # what was gained before is in the way now
            return tuple(steps)
        done.append(step)
    return tuple(done)


def _from(assembly: Assembly, step: Step, shift: Floats) -> list[Step]:
    """The step where all parts are a little elsewhere to begin with.

    Three options for those that move: straight to the next waypoint; the whole path shifted by as much as they are now; or first back to
    its beginning.
    """
    if not shift.any():
        return [step]
    moving = np.isin(assembly.names, step.parts)
    path = step.path.copy()
    path[:, ~moving] += shift[~moving]
    straight, beside = path.copy(), path.copy()
    straight[0, moving] += shift[moving]
    beside[:, moving] += shift[moving]
    back = np.concatenate([straight[:1], path])
    return [replace(step, path=one) for one in (straight, beside, back)]


def _one_by_one(assembly: Assembly, step: Step, free: Callable[[Step], bool]) -> list[Step]:
    """The step as several, of one part each, where they can go one after the other; else itself."""
    if step.as_one or len(step.parts) > MAX_ALONE:
        return [step]
    left, found = list(step.parts), []
    here = step.path[0]
    while left:
        for name in left:
            k = assembly.names.index(name)
            for through in (slice(None), slice(None, None, max(1, len(step.path) - 1))):
                points = step.path[through]
                path = np.repeat(here[None], len(points), 0)
                path[:, k] = points[:, k]
                one = replace(step, parts=(name,), path=path, moves=1, leaves=())
                if free(one):
                    break
            else:
                continue
            break
        else:
            return [step]
        found.append(one)
        here, left = one.path[-1], [n for n in left if n != name]
    found[-1] = replace(found[-1], leaves=step.leaves)
    return found


def _with_largest_clearance(assembly: Assembly, surveyed: Survey, step: Step) -> Step:
    """The step with the largest least clearance that its path allows, and without waypoints that it does not need."""
    bodies = surveyed.bodies
    path = of_bodies(assembly, bodies, step.path)
    who = np.flatnonzero((np.abs(path - path[:1]) > STILL).any(axis=(0, 2)))
    there = np.array([step.there[list(m)].all() for m in bodies.members])
    slide = step.as_one and not np.abs(path[:, who, 2] - path[0, who, 2]).max() > STILL
    moving = MovingBodies(who, slide)
    problem = ClearanceProblem(bodies, there, surveyed.ignored, surveyed.clearance, surveyed.size, moving)
    path = _shortened(problem, path)
    if not slide:  # slides lie where they are best; other paths need freedom to bend
        path = finer(path, TURN_PER_PIECE, PIECE_LENGTH * surveyed.size)
    path = _shortened(problem, largest_clearance_path(problem, path))
    return replace(step, path=for_parts(assembly, surveyed, largest_clearance_path(problem, path)))


def for_parts(assembly: Assembly, surveyed: Survey, path: Floats) -> Floats:
    """Motions (k, n, 3) of the parts from a path of the bodies, with points in between where bodies turn.

    The middles of bodies go straight, so reference points of parts that lie beside them do not quite.
    """
    bodies = surveyed.bodies
    arm = assembly.rest[:, :2] - bodies.rest[bodies.body_of, :2]
    bulge, most = PART_DEVIATION * surveyed.clearance, float(np.hypot(*arm.T).max())
    turn = np.sqrt(8 * bulge / most) if most > bulge else TURN_PER_PIECE
    return of_parts(
        assembly, bodies, finer(path, turn) if np.abs(np.diff(path[..., 2], axis=0)).max() > STILL else path
    )


def _shortened(problem: ClearanceProblem, path: Floats) -> Floats:
    """The path without waypoints that are not needed to keep nearly its clearance."""
    least = problem.least(path)
    k = 1
    while k < len(path) - 1:
        without = np.delete(path, k, axis=0)
        if problem.least(without[k - 1 : k + 1]) >= KEPT_CLEARANCE * least:
            path = without
        else:
            k += 1
    return path


def finer(path: Floats, turn: float, length: float = np.inf) -> Floats:
    """The path (k, n, 3) with points in between, so that no piece turns by more than `turn` [rad] or is longer than `length` [mm]."""
    out = [path[:1]]
    for one, other in pairwise(path):
        change = np.abs(other - one)
        count = max(1, int(np.ceil(max(change[:, 2].max() / turn, change[:, :2].max() / length))))
        out.append(one + (other - one) * (np.arange(1, count + 1) / count)[:, None, None])
    return np.concatenate(out)
