"""The next bodies that leave, with their way: straight, as one rigid piece, or found by search; or what shows that none do."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.audit.path_audit import audit_path
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.disassembly.closed_pairs import BOXES_PER_PAIR, ClosedPairs, closed_pairs, surer
from wiggleroom.disassembly.enclosure import enclosed_by_held
from wiggleroom.disassembly.explore import explore, way_out
from wiggleroom.disassembly.remaining import without
from wiggleroom.disassembly.rigid_subassembly import RigidEscape, leaves_as_one
from wiggleroom.disassembly.translation import TranslationEscape, translation_escape, translation_escapes
from wiggleroom.errors import Stop
from wiggleroom.geometry.neighbours import placed
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.search.loop import Progress
from wiggleroom.search.prepare import Prepared
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BOXES_FOR_ONE_BODY = 150_000
"""Boxes judged at most where one body alone can leave; a few seconds."""
BOXES_FOR_NEAR_EXIT = 40_000
"""Boxes judged at most for a set of bodies that would leave straight if there were a little more room."""
EXTRA_CLEARANCES = 0.02, 0.05, 0.1, 0.25, 0.5, 1.0
"""So much further inward outlines lie then, as shares of the clearance."""
MAX_NEAR_EXITS = 8
FRAME_SECONDS = 2.0
"""Seconds that a distance may take which no part of a frame exceeds."""
EXIT_DISTANCE = 0.1
"""Parts that left end this share of the drawing's size beyond all others."""


@dataclass(frozen=True, eq=False)
class Stage:
    """What becomes of the bodies that are left: a way of some of them, or the end.

    Parameters
    ----------
    ended : Separability
    certainty : Certainty
    who : (k,) int64
        Bodies that leave.
    way : (k, n, 3) float64 [mm, mm, rad] or None
        Motions of all bodies on which they leave.
    held : (n,) int64
        Bodies of the same number certainly never turn half round against each other; empty where something leaves.
    questions : int
        Largest motions that were searched.
    """

    ended: Separability
    certainty: Certainty
    who: Ints
    way: Floats | None
    held: Ints
    questions: int


def next_stage(
    ready: Prepared, begin: ClosedPairs, boxes: int, questions: int, stop: Stop | None, tell: Callable[[Progress], None]
) -> Stage:
    """The next parts that leave, the cheapest ways of finding them first; `begin` says what is tied already."""
    bodies, n = ready.bodies, len(ready.bodies.fixed)
    stands = np.flatnonzero(bodies.fixed)
    ground = int(stands[0])
    none = np.zeros(0, dtype=np.int64)
    rest = np.zeros((1, n, 3))
    tell(Progress("straight ways"))
    found = translation_escape(bodies, rest[0], ground, ready.ignored, ready.size, begin.group, stop)
    if found is not None:
        return _leave(ready, rest, found)
    tell(Progress("free spaces"))
    known, tries = _rigid(ready, begin, boxes, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, none, None, known.held, 0)
    known = _walled_in(ready, known, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, none, None, known.held, 0)
    nearly = _nearly(ready, ground, known.group, stop)
    for rigid in itertools.chain(tries, (leaves_as_one(ready, e.who, BOXES_FOR_NEAR_EXIT, stop) for e in nearly)):
        if stop is not None and stop.is_set():
            break
        out = None if rigid.way is None else way_out(ready, ground, known.group, rigid.way, stop=stop)
        if out is not None and (stage := _leave(ready, *out)).way is not None:
            return stage
    known = surer(ready, known, stop)
    if known.all_tied:
        return Stage(Separability.INTERLOCKED, Certainty.PROVEN, none, None, known.held, 0)
    searched = explore(ready, ground, known.group, nearly, stop, tell, questions)
    if searched.way is not None and searched.exit is not None:
        return replace(_leave(ready, searched.way, searched.exit), questions=searched.questions)
    ended: Separability = Separability.INTERLOCKED if searched.whole else Separability.UNKNOWN
    return Stage(ended, Certainty.SEARCHED, none, None, known.held, searched.questions)


def _rigid(
    ready: Prepared, begin: ClosedPairs, boxes: int, stop: Stop | None
) -> tuple[ClosedPairs, Iterator[RigidEscape]]:
    """What is tied to what, and for each group that may leave what is known about its leaving as one."""
    free = np.flatnonzero(~ready.bodies.fixed)
    if len(free) == 1:
        rigid = leaves_as_one(ready, free, boxes, stop)
        alone = (~ready.bodies.fixed).astype(np.int64)
        return ClosedPairs(
            alone * (not rigid.closed), alone * (not rigid.held), np.zeros((0, 2), dtype=np.int64)
        ), iter([rigid])
    known = closed_pairs(ready, begin, stop)
    ground = known.group[np.flatnonzero(ready.bodies.fixed)[0]]
    groups = (np.flatnonzero(known.group == g) for g in np.unique(known.group) if g != ground)
    return known, (
        leaves_as_one(ready, who, BOXES_PER_PAIR, stop) for who in groups if stop is None or not stop.is_set()
    )


def _walled_in(ready: Prepared, known: ClosedPairs, stop: Stop | None) -> ClosedPairs:
    """Tie what lies inside a frame of several bodies that are tied together and can move but little."""
    bodies, geometry = ready.bodies, placed(ready.bodies)
    ground = known.group[np.flatnonzero(bodies.fixed)[0]]
    frame = np.flatnonzero(known.group == ground)
    if stop is not None and stop.is_set():
        return known
    if bodies.fixed[frame].all() or not len(enclosed_by_held(geometry, frame, ready.ignored, 0.0, stop)):
        return known
    others = np.flatnonzero(known.group[bodies.body_of] != ground)
    far = furthest(without(ready.assembly, others), FRAME_SECONDS, stop)
    inside = np.zeros(0, dtype=np.int64) if far is None else enclosed_by_held(geometry, frame, ready.ignored, far, stop)
    return replace(known, group=np.where(np.isin(known.group, known.group[inside]), ground, known.group))


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


def _leave(ready: Prepared, way: Floats, found: TranslationEscape) -> Stage:
    """The way continued straight until those who leave are beyond all others, which then go back to rest."""
    bodies, who = ready.bodies, found.who
    others = np.setdiff1d(np.arange(len(bodies.fixed)), who)

    def along(some: Ints, motion: Floats) -> Floats:
        return np.asarray(shapely.get_coordinates(placed(bodies, motion, some)[some]) @ found.direction)

    # beyond where the others are now, and wherever they pass on their way back
    length = max(along(others, m).max() for m in way) - along(who, way[-1]).min()
    length += EXIT_DISTANCE * ready.size
    out = way[-1].copy()
    out[who, :2] += max(length, EXIT_DISTANCE * ready.size) * found.direction
    back = way[::-1][1:].copy() if way[-1, others].any() else way[:0]
    back[:, who] = out[who]
    whole = np.concatenate([way, out[None], back])
    none = np.zeros(0, dtype=np.int64)
    if not audit_path(ready.assembly, of_parts(ready.assembly, bodies, whole)).free:
        return Stage(Separability.UNKNOWN, Certainty.SEARCHED, none, None, none, 0)
    return Stage(Separability.COMES_APART, Certainty.PROVEN, who, whole, none, 0)
