"""The next bodies that leave, with their path: straight, as one rigid piece, or found by search; or what shows that none do."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.disassembly.closed_pairs import BOXES_PER_PAIR, ClosedPairs, closed_pairs, decide_more_pairs
from wiggleroom.disassembly.disassembly_stage import NO_BODIES, Stage, leave, leave_after_motion, leave_moving
from wiggleroom.disassembly.enclosure import enclosed_by_held
from wiggleroom.disassembly.escape_by_motions import escape_by_motions
from wiggleroom.disassembly.escape_by_pairs import NamedPairs, escape_by_known_pairs, escape_by_pairs
from wiggleroom.disassembly.escape_search import (
    MAX_QUESTIONS,
    GoalSequence,
    escape_by_goals,
    escape_path,
)
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.remaining import without_parts
from wiggleroom.disassembly.rigid_subassembly import RigidEscape, leaves_as_one
from wiggleroom.disassembly.slide_search import WORK_BUDGET, MoveSequence, SlideSearch, slide_search
from wiggleroom.disassembly.slide_space import SlideSpace, slide_axes
from wiggleroom.disassembly.translation import TranslationEscape, translation_escapes
from wiggleroom.errors import FreeSpaceError, Stop
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.search.prepare import Prepared, Survey, prepare_without_cells
from wiggleroom.search.prepare_walls import prepare_walls
from wiggleroom.search.progress import Progress
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BOXES_FOR_ONE_BODY = 150_000
"""Boxes judged at most where one body alone can leave; a few seconds."""
BOXES_FOR_NEAR_EXIT = 40_000
"""Boxes judged at most for a set of bodies that would leave straight if there were a little more room."""
EXTRA_CLEARANCES = 0.02, 0.05, 0.1, 0.25, 0.5, 1.0
"""Extra inward offsets of outlines that are tried to find sets that nearly leave, as shares of the clearance."""
MAX_NEAR_EXITS = 8
"""So many sets that nearly leave are kept; each is looked at with boxes of motions."""
FRAME_WORK = 2000.0
"""Work, about milliseconds, for the bound on how far the parts of a frame can move."""


@dataclass(frozen=True, eq=False)
class EscapeEffort:
    """How long is looked for the next parts that leave.

    Parameters
    ----------
    boxes : int
        Boxes of motions judged at most for the only body that can leave, before largest motions are searched.
    questions : int
        Largest motions searched at most.
    work : float
        Work of the search over slides, in pairs of edges compared.
    passages : PassagesByGap
        Those known from other gaps of the assembly at rest; what is found is added.
    exits : list of goals
        What led apart at other gaps, the newest last, which is asked first; what is found is added.
    passed : list of pairs of names
        The same of bodies that were led out.
    """

    boxes: int = BOXES_FOR_ONE_BODY
    questions: int = MAX_QUESTIONS
    work: float = WORK_BUDGET
    passages: PassagesByGap = field(default_factory=PassagesByGap)
    exits: list[GoalSequence] = field(default_factory=list)
    passed: list[NamedPairs] = field(default_factory=list)


def next_stage(
    assembly: Assembly,
    surveyed: Survey,
    begin: ClosedPairs,
    effort: EscapeEffort,
    targets: Ints,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    holding_cost: Callable[[Ints], int] | None = None,
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
    stop, tell
        As for `flex`.
    holding_cost : callable, optional
        How much trouble it makes that some bodies leave; the least comes first.
    """
    bodies, n = surveyed.bodies, len(surveyed.bodies.fixed)
    ground = int(np.flatnonzero(bodies.fixed)[0])
    rest = np.zeros((1, n, 3))
    still = MoveSequence(rest, NO_BODIES)
    tell(Progress("straight paths"))
    found = translation_escapes(bodies, rest[0], ground, surveyed.ignored, surveyed.size, begin.group, stop=stop)
    first = _with_largest_clearance(surveyed, found, targets, holding_cost)
    straight = None if first is None else leave(assembly, surveyed, still, first)
    if straight is not None and _wanted(straight.who, targets):
        return straight
    tell(Progress("slides"))
    slid = _slide(surveyed, targets, effort.work, stop, tell)
    if slid.path is not None:
        out = TranslationEscape(slid.path.last.who, slid.path.last.direction)
        if straight is None or _wanted(out.who, targets):
            stage = leave(assembly, surveyed, slid.path.before, out)
            if stage is not None:
                return replace(stage, states=slid.states, whole=slid.whole, turned=slid.turned)
    if straight is not None:
        return straight
    stage = _beyond_slides(assembly, surveyed, begin, effort, slid, stop, tell)
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


def _slide(
    surveyed: Survey, targets: Ints, work: float, stop: Stop | None, tell: Callable[[Progress], None]
) -> SlideSearch:
    """What leaves by slides from where all are."""
    bodies, n = surveyed.bodies, len(surveyed.bodies.fixed)
    rest = np.zeros((n, 3))
    space = SlideSpace(bodies, surveyed.ignored, surveyed.clearance, surveyed.size, rest, np.ones(n, dtype=np.bool_))
    return slide_search(space, rest, targets, stop=stop, tell=tell, budget=work)


def _beyond_slides(
    assembly: Assembly,
    surveyed: Survey,
    begin: ClosedPairs,
    effort: EscapeEffort,
    slid: SlideSearch,
    stop: Stop | None,
    tell: Callable[[Progress], None],
) -> Stage:
    """Bodies that leave otherwise than by slides, or what shows that none do."""
    bodies = surveyed.bodies
    ground = int(np.flatnonzero(bodies.fixed)[0])
    still = MoveSequence(np.zeros((1, len(bodies.fixed), 3)), NO_BODIES)
    tell(Progress("free spaces"))
    refused: FreeSpaceError | None = None
    try:
        ready = simpler = prepare_walls(assembly, surveyed, stop)
    except FreeSpaceError as why:  # boxes of motions may decide it all the same
        ready, refused = prepare_without_cells(assembly, surveyed), why
        simpler = ready
    if simpler.simplified:  # what holds larger parts need not hold these: proofs are about the outlines as they are
        ready = replace(simpler, bodies=bodies, simplified=0.0)
    # near the gap at which it comes apart, proofs of pairs take far longer than these
    for goals in () if refused else effort.exits[::-1]:
        known_exit = escape_by_goals(simpler, ground, begin.group, goals, stop)
        if (
            known_exit is not None
            and (stage := leave_after_motion(assembly, surveyed, simpler, still, *known_exit)) is not None
        ):
            return replace(stage, questions=len(goals))
    for pairs in effort.passed[::-1] if effort.questions else ():
        again = escape_by_known_pairs(ready, begin.group, pairs, effort.passages, stop)
        if again is not None and (stage := leave_moving(assembly, surveyed, still, again.path, again.exit)) is not None:
            return stage
    known, tries = _rigid(ready, begin, effort, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    known = _walled_in(ready, known, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    nearly = _nearly(ready, ground, known.group, stop)
    for rigid in itertools.chain(
        tries, (leaves_as_one(ready, e.who, BOXES_FOR_NEAR_EXIT, effort.passages, stop) for e in nearly)
    ):
        if stop is not None and stop.is_set():
            break
        out = None if rigid.path is None else escape_path(ready, ground, known.group, rigid.path, stop=stop)
        if out is not None and (stage := leave_moving(assembly, surveyed, still, *out)) is not None:
            return stage
    known = decide_more_pairs(ready, known, effort.passages, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, known.held)
    found = escape_by_pairs(ready, known, effort.passages, stop) if effort.questions else None
    if found is not None and (stage := leave_moving(assembly, surveyed, still, found.path, found.exit)) is not None:
        effort.passed.append(found.pairs)
        return stage
    if refused:
        raise refused
    return escape_by_motions(
        assembly, surveyed, simpler, known, nearly, effort.questions, effort.exits, slid, stop, tell
    )


def _rigid(
    ready: Prepared, begin: ClosedPairs, effort: EscapeEffort, stop: Stop | None
) -> tuple[ClosedPairs, Iterator[RigidEscape]]:
    """What is tied to what, and for each group that may leave what is known about its leaving as one."""
    free = np.flatnonzero(~ready.bodies.fixed)
    if len(free) == 1:
        rigid = leaves_as_one(ready, free, effort.boxes, effort.passages, stop)
        alone = (~ready.bodies.fixed).astype(np.int64)
        return ClosedPairs(
            alone * (not rigid.closed), alone * (not rigid.held), np.zeros((0, 2), dtype=np.int64)
        ), iter([rigid])
    known = closed_pairs(ready, begin, effort.passages, stop)
    fixed_group = known.group[np.flatnonzero(ready.bodies.fixed)[0]]
    groups = (np.flatnonzero(known.group == g) for g in np.unique(known.group) if g != fixed_group)
    return known, (
        leaves_as_one(ready, who, BOXES_PER_PAIR, effort.passages, stop)
        for who in groups
        if stop is None or not stop.is_set()
    )


def _walled_in(ready: Prepared, known: ClosedPairs, stop: Stop | None) -> ClosedPairs:
    """Tie what lies inside a frame of several bodies that are tied together and can move but little."""
    bodies, geometry = ready.bodies, placed(ready.bodies)
    fixed_group = known.group[np.flatnonzero(bodies.fixed)[0]]
    frame = np.flatnonzero(known.group == fixed_group)
    if stop is not None and stop.is_set():
        return known
    if bodies.fixed[frame].all() or not len(enclosed_by_held(geometry, frame, ready.ignored, 0.0, stop)):
        return known
    others = np.flatnonzero(known.group[bodies.body_of] != fixed_group)
    far = furthest(without_parts(ready.assembly, others), FRAME_WORK, stop)
    inside = np.zeros(0, dtype=np.int64) if far is None else enclosed_by_held(geometry, frame, ready.ignored, far, stop)
    return replace(known, group=np.where(np.isin(known.group, known.group[inside]), fixed_group, known.group))


def _nearly(ready: Prepared, ground: int, group: Ints, stop: Stop | None) -> list[TranslationEscape]:
    """Sets of bodies that would leave straight if there were a little more room: the first to look at."""
    if len(np.unique(group)) < 3:
        return []
    rest = np.zeros((len(group), 3))
    found: dict[tuple[int, ...], TranslationEscape] = {}
    for share in EXTRA_CLEARANCES:
        thinner = share * ready.clearance
        for e in translation_escapes(ready.bodies, rest, ground, ready.ignored, ready.size, group, thinner, stop):
            found.setdefault(tuple(e.who.tolist()), e)
        if len(found) >= MAX_NEAR_EXITS or (stop is not None and stop.is_set()):
            break
    return list(found.values())[:MAX_NEAR_EXITS]
