"""Of motions that are worth the same the one that moves few others: parts that nothing asks about rest where there is room for that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.audit.audit_outlines import outlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Pull, part_of
from wiggleroom.drawing.writers.glue_groups import body_numbers
from wiggleroom.errors import Stop
from wiggleroom.search.answer import Answer
from wiggleroom.verdict import PathState

Floats = NDArray[np.float64]

MAX_TRIED = 40
"""So many bodies at most are tried one by one, those that go farthest first."""
STILL_FROM = (0.0, 0.125, 0.25, 0.5)
"""Shares of the path after which a body is tried at rest, one after the other: at the beginning it may be in the way."""


def with_bystanders_at_rest(answer: Answer, stop: Stop | None = None) -> Answer:
    """A motion worth the same in which what nothing asks about rests, wholly or from some place on, as far as the path stays free.

    What is pulled and leaves goes straight where that way is free with all others at rest; else it moves as it was found to. Whether a
    path is free is judged from the outlines alone. A question about all parts, and a motion that repeats, stay as they are.

    Parameters
    ----------
    answer : Answer
    stop : optional
        Once it is set, what has been tried counts.
    """
    asked = [part_of(goal) for goal in answer.goals]
    if answer.path != PathState.CHECKED or not answer.collision_free or answer.period is not None or None in asked:
        return answer
    assembly, points = answer.assembly, answer.waypoints
    names = assembly.names
    body = np.array(body_numbers(names, assembly.drawing.glue))
    busy = {*asked, *(name for contact in answer.contacts if contact.force > 0 for name in contact.parts)}
    needed = {int(body[k]) for k, name in enumerate(names) if name in busy}
    far = np.zeros(int(body.max()) + 1)
    np.maximum.at(far, body, np.abs(points).max(axis=(0, 2)))
    others = [int(b) for b in np.argsort(-far, kind="stable") if far[b] > 0 and int(b) not in needed]
    if not others:
        return answer
    judged = outlines(assembly)
    straight = _straight(answer, body)
    if straight is not None and audit_path(judged, straight, stop).free:
        return _with_path(answer, straight, {name for k, name in enumerate(names) if not straight[-1, k].any()})

    def still(now: Floats, bodies: list[int], share: float) -> Floats | None:
        """The path with some bodies at rest from a share of it on; None where that is not free."""
        k = round(share * (len(now) - 1))
        mine = np.isin(body, bodies)
        tried = now.copy()
        tried[k:, mine] = now[k, mine]
        return tried if audit_path(judged, tried, stop, changed=mine).free else None

    if not audit_path(judged, points, stop).free:
        return answer
    calm: set[int] = set()
    whole = still(points, others, 0.0)
    if whole is not None:
        points, calm = whole, set(others)
    else:
        for b in others[:MAX_TRIED]:
            found = next((path for share in STILL_FROM if (path := still(points, [b], share)) is not None), None)
            if found is not None:
                points = found
                calm.add(b)
    resting = {name for k, name in enumerate(names) if int(body[k]) in calm}
    return _with_path(answer, points, resting) if resting else answer


def _straight(answer: Answer, body: NDArray[np.int64]) -> Floats | None:
    """What is pulled straight the way that it is pulled, as far as it was found to go; None where something else is asked, or it ends."""
    if answer.objective is not None or not all(isinstance(goal, Pull) for goal in answer.goals):
        return None
    points = np.zeros((2, len(body), 3))
    names = answer.assembly.names
    for goal in answer.goals:
        assert isinstance(goal, Pull)
        k = names.index(goal.part)
        if points[1, k].any():
            return None  # it is pulled twice
        along = np.array(goal.direction) / np.linalg.norm(goal.direction)
        points[1, body == body[k], :2] = np.hypot(*answer.motion[k, :2]) * along
    return points


def _with_path(answer: Answer, points: Floats, resting: set[str]) -> Answer:
    """The answer with another path, on which some parts rest."""
    return replace(
        answer,
        waypoints=points,
        motion=points[-1],
        leaves=tuple(name for name in answer.leaves if name not in resting),
        turns=tuple(name for name in answer.turns if name not in resting),
    )
