"""The search for an escape path: everything is pulled and turned in every direction, and from new places the search goes on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.translation import TranslationEscape, translation_escape
from wiggleroom.drawing.model import Goal, Pull, Turn
from wiggleroom.errors import WiggleroomError
from wiggleroom.flex_walls import MotionQuery, flex_walls
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.search.answer import Answer
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared
from wiggleroom.search.progress import Progress
from wiggleroom.search.state_tree import Exit, Level, StateTree
from wiggleroom.verdict import PathState, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PULL_DIRECTIONS = 8
"""Directions in which every group is pulled."""
MAX_QUESTIONS = 300
"""At most this many questions are asked; beyond that the search counts as cut short."""
MAX_STATES = 12
"""The search goes on from at most this many places besides rest."""
NOVELTY_DISTANCE = 3.0
"""A place is new where some neighbours lie otherwise than in all places before by more than this multiple of the clearance."""
EXIT_TESTS = 8
"""At most this many waypoints of an answer are tested for a straight escape path."""

GoalSequence = tuple[tuple[Goal, ...], ...]
"""Goals that are asked one after the other, each from where the one before ended."""


@dataclass(frozen=True, eq=False)
class EscapeSearch:
    """What the search came to.

    Parameters
    ----------
    path : (k, n, 3) float64 [mm, mm, rad] or None
        Checked motions of all bodies to where `exit` begins.
    exit : TranslationEscape or None
    whole : bool
        True where every question that was planned was asked, from all places that it went on from.
    more_places : bool
        True where there were more new places than it went on from.
    questions, unanswered : int
        How many were asked, and how many of them found no answer, or none whose path is certain.
    asked : tuple of goals
        What was asked one after the other on the way to `exit`.
    """

    path: Floats | None
    exit: TranslationEscape | None
    whole: bool
    more_places: bool
    questions: int
    unanswered: int
    asked: GoalSequence = ()


@dataclass(frozen=True, eq=False)
class _Ended:
    """The end of a motion, and where neighbours (k,) lie to each other there (k, 3); at rest there is no answer."""

    answer: Answer | None
    place: Floats


def search_for_escape(
    ready: Prepared,
    ground: int,
    group: Ints,
    most: int = MAX_QUESTIONS,
    only_turns: bool = False,
    context: Context = UNLIMITED,
) -> EscapeSearch:
    """Pull and turn every group in every direction, look for a straight escape path along each answer, and go on from new places.

    Parameters
    ----------
    ready : Prepared
    ground : int
        The fixed body; others that are fixed belong to its group.
    group : (n,) int64
        Bodies of the same number are known not to leave each other.
    most : int
        Questions asked at most.
    only_turns : bool
        True where it is known where slides lead: nobody is pulled alone, and from new places it does not go on.
    context : Context, optional
    """
    bodies = ready.bodies
    if context.stopped:
        return EscapeSearch(None, None, False, False, 0, 0)
    near = neighbours(bodies, placed(bodies), NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
    rest = _Ended(None, relative_pose(bodies, near.a, near.b))
    tree: StateTree[_Ended, tuple[Goal, ...]] = StateTree(
        rest, lambda end, _: all(_differ(ready, near.b, end.place, p.state.place) for p in tree.states), 1 + MAX_STATES
    )
    questions, unanswered, spent = 0, 0, False

    def motions(here: int) -> Iterator[tuple[_Ended, tuple[Goal, ...]] | Exit[EscapeSearch]]:
        nonlocal questions, unanswered, spent
        for goals in _questions(ready, ground, group, only_turns):
            spent = questions >= most
            if spent:
                return
            context.go_on()
            questions += 1
            context.tell(Progress("search", questions))
            answer = answer_or_none(ready, goals, tree.states[here].state.answer, context)
            if answer is None or answer.path != PathState.CHECKED:
                unanswered += 1
                continue
            unanswered += answer.verdict is Verdict.STOPPED
            path = of_bodies(ready.assembly, bodies, answer.waypoints)
            found = escape_path(ready, ground, group, path, EXIT_TESTS, context)
            if found is not None:
                asked = (*tree.steps_to(here), goals)
                yield Exit(EscapeSearch(*found, True, False, questions, unanswered, asked))
            if not only_turns:
                yield _Ended(answer, relative_pose(bodies, near.a, near.b, path[-1])), goals

    found = tree.search(Level(motions, lambda: spent), context=context)
    return found or EscapeSearch(None, None, tree.whole and not spent, tree.full, questions, unanswered)


def escape_by_goals(
    ready: Prepared, ground: int, group: Ints, asked: GoalSequence, context: Context
) -> tuple[Floats, TranslationEscape] | None:
    """The path (k, n, 3) on which bodies leave when goals are asked one after the other, as at another gap; None where they do not."""
    answer: Answer | None = None
    for goals in asked:
        answer = answer_or_none(ready, goals, answer, context)
        if answer is None or answer.path != PathState.CHECKED:
            return None
    if answer is None:
        return None
    motions = of_bodies(ready.assembly, ready.bodies, answer.waypoints)
    return escape_path(ready, ground, group, motions, EXIT_TESTS, context)


def answer_or_none(ready: Prepared, goals: tuple[Goal, ...], start: Answer | None, context: Context) -> Answer | None:
    """The answer to one question, or None where the engine gave up."""
    try:
        return flex_walls(ready, MotionQuery(goals, start=start, periods=False, context=context.silent.with_grace))
    except WiggleroomError:
        return None


def escape_path(
    ready: Prepared, ground: int, group: Ints, motions: Floats, looks: int | None = None, context: Context = UNLIMITED
) -> tuple[Floats, TranslationEscape] | None:
    """Return the path (k, n, 3) up to where bodies leave straight; `looks` of its waypoints are looked at, or all."""
    last = len(motions) - 1
    for k in np.unique(np.linspace(last, 1, min(looks or last, last)).round().astype(int)):
        found = translation_escape(ready, motions[k], ground, group, context)
        if found is not None:
            return motions[: k + 1], found
    return None


def _differ(ready: Prepared, b: Ints, one: Floats, other: Floats) -> bool:
    """True where any pair lies otherwise."""
    change = one - other
    moved = np.hypot(change[:, 0], change[:, 1]) + ready.bodies.radius[b] * np.abs(change[:, 2])
    return bool(moved.max(initial=0.0) > NOVELTY_DISTANCE * ready.clearance)


def _questions(ready: Prepared, ground: int, group: Ints, only_turns: bool) -> Iterator[tuple[Goal, ...]]:
    """All at once, then every group: outwards first, then the other directions and turns."""
    bodies, rest = ready.bodies, ready.bodies.rest
    middle = rest[ground, :2]
    out = rest[:, :2] - middle
    parts = ready.assembly.names
    names = [parts[members[0]] for members in bodies.members]
    free = np.flatnonzero(~bodies.fixed)
    weight = 1.0 / len(free)
    for sign in (1.0, -1.0):
        yield tuple(
            Pull(names[b], _pair(sign * out[b]), _pair(rest[b, :2]), weight) for b in free if np.hypot(*out[b]) > 0
        )
    groups = [np.flatnonzero(group == g) for g in np.unique(group[free]) if g != group[ground]]
    for rank in range(0 if only_turns else PULL_DIRECTIONS):
        for who in groups:
            away = out[who].mean(0)
            base = np.arctan2(away[1], away[0])
            step = (rank + 1) // 2 * (1 if rank % 2 else -1)
            # whole eighths of a turn, the one nearest to outwards first: drawings lie along the axes
            angle = (np.round(base / (2 * np.pi) * PULL_DIRECTIONS) + step) * 2 * np.pi / PULL_DIRECTIONS
            d = (float(np.cos(angle)), float(np.sin(angle)))
            yield tuple(Pull(names[b], d, _pair(rest[b, :2]), 1.0 / len(who)) for b in who)
    for sense in ("ccw", "cw"):
        for who in groups:
            yield tuple(Turn(names[b], sense, 1.0 / len(who)) for b in who)


def _pair(v: Floats) -> tuple[float, float]:
    return float(v[0]), float(v[1])
