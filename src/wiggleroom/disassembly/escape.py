"""The next bodies that leave, with their path: straight, as one rigid piece, or found by search; or what shows that none do."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.disassembly.closed_pairs import BOXES_PER_PAIR, ClosedPairs, closed_pairs, decide_more_pairs
from wiggleroom.disassembly.disassembly_sequence import NO_BODIES, Stage
from wiggleroom.disassembly.enclosure import enclosed_by_held
from wiggleroom.disassembly.escape_by_pairs import escape_by_known_pairs, escape_by_pairs
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.escape_search import (
    EXIT_TESTS,
    answer_or_none,
    escape_by_goals,
    escape_path,
    search_for_escape,
)
from wiggleroom.disassembly.remaining import displaced, without_parts
from wiggleroom.disassembly.rigid_subassembly import RigidEscape, leaves_as_one
from wiggleroom.disassembly.slide_search import MoveSequence, SlideSearch, Tilt, slide_search
from wiggleroom.disassembly.slide_space import SlideSpace, slide_axes
from wiggleroom.disassembly.translation import TranslationEscape, translation_escapes
from wiggleroom.drawing.model import Turn
from wiggleroom.errors import FreeSpaceError, WiggleroomError
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.search.prepare import Prepared, Survey, prepare_without_cells
from wiggleroom.search.prepare_walls import prepare_walls
from wiggleroom.search.progress import Progress
from wiggleroom.verdict import Certainty, PathState, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FRAME_WORK = 2000.0
"""Work, about milliseconds, for the bound on how far the parts of a frame can move."""

EXIT_DISTANCE = 0.1
"""Parts that left end this share of the drawing's size beyond all others."""


def next_stage(
    assembly: Assembly,
    surveyed: Survey,
    begin: ClosedPairs,
    effort: EscapeEffort,
    targets: Ints,
    holding_cost: Callable[[Ints], int] | None = None,
    context: Context = UNLIMITED,
) -> Stage:
    """The next parts that leave, those first that are cheapest to find.

    Parameters
    ----------
    assembly : Assembly
        At rest where all parts are now.
    surveyed : Survey
        Of the assembly.
    begin : ClosedPairs
        What is tied already.
    effort : EscapeEffort
    targets : (k,) int64
        Bodies that are to leave, rather than others; none where all are to.
    holding_cost : callable, optional
        How much trouble it makes that some bodies leave; the least comes first.
    context : Context, optional
    """
    bodies, n = surveyed.bodies, len(surveyed.bodies.fixed)
    ground = int(np.flatnonzero(bodies.fixed)[0])
    rest = np.zeros((1, n, 3))
    still = MoveSequence(rest, NO_BODIES)
    context.tell(Progress("straight paths"))
    found = translation_escapes(surveyed, rest[0], ground, begin.group, context=context)
    first = _with_largest_clearance(surveyed, found, targets, holding_cost)
    straight = None if first is None else leave(assembly, surveyed, still, first)
    if straight is not None and _wanted(straight.who, targets):
        return straight
    context.tell(Progress("slides"))
    slid = _slide(surveyed, targets, effort.work, context)
    if slid.path is not None:
        out = TranslationEscape(slid.path.last.who, slid.path.last.direction)
        if straight is None or _wanted(out.who, targets):
            stage = leave(assembly, surveyed, slid.path.before, out)
            if stage is not None:
                return replace(stage, states=slid.states, whole=slid.whole, turned=slid.turned)
    if straight is not None:
        return straight
    stage = _beyond_slides(assembly, surveyed, begin, effort, slid, context)
    if first is not None and stage.certainty is Certainty.SEARCHED and stage.ended is Separability.INTERLOCKED:
        stage = replace(stage, ended=Separability.UNKNOWN)  # rounding decides whether the straight path is free
    return replace(stage, states=slid.states, whole=slid.whole, turned=slid.turned)


def _with_largest_clearance(
    surveyed: Survey, found: list[TranslationEscape], targets: Ints, holding_cost: Callable[[Ints], int] | None
) -> TranslationEscape | None:
    """Of the smallest sets that leave straight, and that are wanted, that with the largest clearance; along edges rather than not.

    Those of the least burden come first, where that is asked.
    """
    order = [
        (not _wanted(e.who, targets), 0 if holding_cost is None else holding_cost(e.who), len(e.who)) for e in found
    ]
    best = [e for e, place in zip(found, order, strict=True) if place == min(order)]
    if len(best) < 2:
        return best[0] if best else None

    axes = slide_axes(
        surveyed.bodies, np.zeros_like(surveyed.bodies.rest), np.ones(len(surveyed.bodies.fixed), dtype=np.bool_)
    )

    def rank(escape: TranslationEscape) -> tuple[float, bool]:
        path = np.zeros((2, len(surveyed.bodies.fixed), 3))
        path[1, escape.who, :2] = 2 * surveyed.size * escape.direction
        there = np.ones(path.shape[1], dtype=np.bool_)
        apart = least_distances(surveyed.bodies, path, there, surveyed.ignored, surveyed.clearance)
        along = np.abs(axes @ escape.direction).max() > 1 - 1e-9
        return round(float(apart[escape.who].min()) / surveyed.clearance, 6), bool(along)

    return max(best, key=rank)


def _wanted(who: Ints, targets: Ints) -> bool:
    return not len(targets) or bool(np.isin(targets, who).any())


def _slide(surveyed: Survey, targets: Ints, work: float, context: Context) -> SlideSearch:
    """What leaves by slides from where all are."""
    bodies, n = surveyed.bodies, len(surveyed.bodies.fixed)
    rest = np.zeros((n, 3))
    space = SlideSpace(bodies, surveyed.ignored, surveyed.clearance, surveyed.size, rest, np.ones(n, dtype=np.bool_))
    return slide_search(space, rest, targets, budget=work, context=context)


def _beyond_slides(
    assembly: Assembly, surveyed: Survey, begin: ClosedPairs, effort: EscapeEffort, slid: SlideSearch, context: Context
) -> Stage:
    """Bodies that leave otherwise than by slides, or what shows that none do."""
    bodies = surveyed.bodies
    ground = int(np.flatnonzero(bodies.fixed)[0])
    still = MoveSequence(np.zeros((1, len(bodies.fixed), 3)), NO_BODIES)
    context.tell(Progress("free spaces"))
    refused: FreeSpaceError | None = None
    try:
        ready = simpler = prepare_walls(assembly, surveyed, context.stop)
    except FreeSpaceError as why:  # boxes of motions may decide it all the same
        ready, refused = prepare_without_cells(assembly, surveyed), why
        simpler = ready
    if simpler.simplified:  # what holds larger parts need not hold these: proofs are about the outlines as they are
        ready = replace(simpler, bodies=bodies, simplified=0.0)
    # near the gap at which it comes apart, proofs of pairs take far longer than these
    for goals in () if refused else effort.exits[::-1]:
        known_exit = escape_by_goals(simpler, ground, begin.group, goals, context)
        if known_exit is not None and (stage := leave_after_motion(surveyed, simpler, still, *known_exit)) is not None:
            return replace(stage, questions=len(goals))
    for pairs in effort.passed[::-1] if effort.questions else ():
        again = escape_by_known_pairs(ready, begin.group, pairs, effort.passages, context)
        if again is not None and (stage := leave_moving(assembly, surveyed, still, again.path, again.exit)) is not None:
            return stage
    known, tries = _rigid(ready, begin, effort, context)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    known = _walled_in(ready, known, context)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    for rigid in tries:
        if context.stopped:
            break
        out = None if rigid.path is None else escape_path(ready, ground, known.group, rigid.path, context=context)
        if out is not None and (stage := leave_moving(assembly, surveyed, still, *out)) is not None:
            return stage
    known = decide_more_pairs(ready, known, effort.passages, context)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    found = escape_by_pairs(ready, known, effort.passages, context) if effort.questions else None
    if found is not None and (stage := leave_moving(assembly, surveyed, still, found.path, found.exit)) is not None:
        effort.passed.append(found.pairs)
        return stage
    if refused:
        raise refused
    return escape_by_motions(surveyed, simpler, known, effort, slid, context)


def _rigid(
    ready: Prepared, begin: ClosedPairs, effort: EscapeEffort, context: Context
) -> tuple[ClosedPairs, Iterator[RigidEscape]]:
    """What is tied to what, and for each group that may leave what is known about its leaving as one."""
    free = np.flatnonzero(~ready.bodies.fixed)
    if len(free) == 1:
        rigid = leaves_as_one(ready, free, effort.boxes, effort.passages, context)
        alone = (~ready.bodies.fixed).astype(np.int64)
        return ClosedPairs(
            alone * (not rigid.closed), alone * (not rigid.held), np.zeros((0, 2), dtype=np.int64)
        ), iter([rigid])
    known = closed_pairs(ready, begin, effort.passages, context)
    fixed_group = known.group[np.flatnonzero(ready.bodies.fixed)[0]]
    groups = (np.flatnonzero(known.group == g) for g in np.unique(known.group) if g != fixed_group)
    return known, (
        leaves_as_one(ready, who, BOXES_PER_PAIR, effort.passages, context) for who in groups if not context.stopped
    )


def _walled_in(ready: Prepared, known: ClosedPairs, context: Context) -> ClosedPairs:
    """Tie what lies inside a frame of several bodies that are tied together and can move but little."""
    bodies, geometry = ready.bodies, placed(ready.bodies)
    fixed_group = known.group[np.flatnonzero(bodies.fixed)[0]]
    frame = np.flatnonzero(known.group == fixed_group)
    if context.stopped:
        return known
    if bodies.fixed[frame].all() or not len(enclosed_by_held(geometry, frame, ready.ignored, 0.0, context)):
        return known
    others = np.flatnonzero(known.group[bodies.body_of] != fixed_group)
    far = furthest(without_parts(ready.assembly, others), FRAME_WORK, context.stop)
    inside = (
        np.zeros(0, dtype=np.int64) if far is None else enclosed_by_held(geometry, frame, ready.ignored, far, context)
    )
    return replace(known, group=np.where(np.isin(known.group, known.group[inside]), fixed_group, known.group))


MAX_TILTS = 4
"""Largest turns are searched from at most this many states besides the first, in which a body can be turned."""


def escape_by_motions(
    surveyed: Survey,
    simpler: Prepared,
    known: ClosedPairs,
    effort: EscapeEffort,
    slid: SlideSearch,
    context: Context,
) -> Stage:
    """Bodies that leave along largest motions and turns, or how far these showed that none do.

    Parameters
    ----------
    surveyed : Survey
        Of the assembly, at rest where all parts are now.
    simpler : Prepared
        Its bodies, or larger ones with fewer corners, with walls.
    known : ClosedPairs
        What is tied.
    effort : EscapeEffort
        What leads apart is added.
    slid : SlideSearch
        What slides led to.
    context : Context
    """
    bodies = surveyed.bodies
    ground = int(np.flatnonzero(bodies.fixed)[0])
    still = MoveSequence(np.zeros((1, len(bodies.fixed), 3)), NO_BODIES)
    loose = slid.states > 1 and slid.whole and slid.on_lattice
    searched = search_for_escape(simpler, ground, known.group, effort.questions, only_turns=loose, context=context)
    if searched.path is not None and searched.exit is not None:
        stage = leave_after_motion(surveyed, simpler, still, searched.path, searched.exit)
        if stage is not None:
            effort.exits.append(searched.asked)
            return replace(stage, questions=searched.questions)
    count = searched.questions
    for tilt in slid.tilts[:MAX_TILTS]:
        asked, tilted = _from_tilt(simpler.assembly, surveyed, tilt, known.group, context)
        count += asked
        if tilted is not None:
            return replace(tilted, questions=count)
    stopped = context.stopped
    # where all states of a lattice were visited and every body was turned in each, more places and open questions are no gap in that
    sure = slid.on_lattice and slid.turned == slid.states
    answered = sure or (searched.unanswered == 0 and not searched.more_places)
    whole = slid.whole and searched.whole and searched.path is None and answered and not stopped
    ended: Separability = Separability.INTERLOCKED if whole else Separability.UNKNOWN
    return Stage(ended, Certainty.SEARCHED, NO_BODIES, None, known.held, count, unanswered=searched.unanswered)


def _from_tilt(
    assembly: Assembly, surveyed: Survey, tilt: Tilt, group: Ints, context: Context
) -> tuple[int, Stage | None]:
    """How many largest turns were searched from a state in which a body can be turned, and what leaves along them."""
    bodies, before = surveyed.bodies, tilt.before
    ground = int(np.flatnonzero(bodies.fixed)[0])
    moved = displaced(assembly, of_parts(assembly, bodies, before.states)[-1])
    try:
        ready = prepare_walls(moved, stop=context.stop)
    except WiggleroomError:
        return 0, None
    name = assembly.names[bodies.members[tilt.who][0]]
    asked = 0
    for sense in ("ccw", "cw"):
        if context.stopped:
            break
        answer = answer_or_none(ready, (Turn(name, sense),), None, context)
        asked += 1
        if answer is None or answer.path != PathState.CHECKED:
            continue
        path = of_bodies(moved, ready.bodies, answer.waypoints)
        out = escape_path(ready, ground, group, path, EXIT_TESTS, context)
        if out is None:
            continue
        stage = leave_moving(assembly, surveyed, before, *out)
        if stage is not None:
            return asked, stage
    return asked, None


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
