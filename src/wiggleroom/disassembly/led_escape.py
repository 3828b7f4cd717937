"""Bodies that leave their neighbours one after the other, each along the path that is free for the two alone, while others make room.

Near the gap at which tabs slip out of their sockets, such a path is a needle's eye: boxes of motions find it for two bodies, searches for
largest motions of all do not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.closed_pairs import BOXES_PER_DECISIVE_PAIR, ClosedPairs, alone
from wiggleroom.disassembly.escape_search import EXIT_TESTS, escape_path
from wiggleroom.disassembly.led_motion import Lead, LedMotion, led
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.translation import TranslationEscape
from wiggleroom.errors import Stop
from wiggleroom.freespace.subdivision.passage import Passage, passage
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_SETS = 6
"""So many sets of bodies are led out, those first that have the fewest neighbours."""
MAX_PASSAGES = 4
"""Sets that have to pass more neighbours than this are left out."""
BEYOND = 6.0
"""Once it is past a neighbour, a body is led on by this multiple of the clearance."""


@dataclass(frozen=True, eq=False)
class PairPassage:
    """How body b passes body a: a path that is free for the two alone."""

    a: int
    b: int
    passage: Passage


def led_escape(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, stop: Stop | None = None
) -> tuple[Floats, TranslationEscape] | None:
    """The path (k, n, 3) of all bodies to where some leave straight; None where none of the sets that were led out does.

    Parameters
    ----------
    ready : Prepared
    known : ClosedPairs
        Sets that are led are those that are tied together; pairs that are not decided are looked at with more boxes.
    passages : PassagesByGap
        Those known of pairs; what is found is added.
    stop : optional
        Asked now and then.
    """
    for pairs in _sets(ready, known, passages, stop):
        for first in range(len(pairs)):
            found = _led_out(ready, known.group, [pairs[first], *pairs[:first], *pairs[first + 1 :]], stop)
            if found is not None:
                return found
    return None


def _sets(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, stop: Stop | None
) -> Iterator[list[PairPassage]]:
    """The neighbours that each set of bodies tied together has to pass, sets with the fewest first."""
    bodies, geometry = ready.bodies, placed(ready.bodies)
    near = neighbours(bodies, geometry, NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
    one, other = known.group[near.a], known.group[near.b]
    loose = np.setdiff1d(known.group, known.group[bodies.fixed])
    beside = {int(g): np.flatnonzero((one != other) & ((one == g) | (other == g))) for g in loose}
    undecided = {(int(a), int(b)) for a, b in known.undecided}
    for g in sorted(beside, key=lambda g: len(beside[g]))[:MAX_SETS]:
        found: list[PairPassage] = []
        for a, b in zip(near.a[beside[g]].tolist(), near.b[beside[g]].tolist(), strict=True):
            if stop is not None and stop.is_set():
                return
            if (a, b) in undecided:
                look = partial(passage, geometry[a], geometry[b], most=BOXES_PER_DECISIVE_PAIR, stop=stop)
                way = passages.look(ready, np.array([a]), np.array([b]), BOXES_PER_DECISIVE_PAIR, look, stop)
            else:
                way = alone(ready, a, b, passages, stop)
            if way is not None:  # where slides lead apart it needs not be led
                found.append(PairPassage(a, b, way))
        if 0 < len(found) <= MAX_PASSAGES and all(one.passage.path is not None for one in found):
            yield found


def _led_out(
    ready: Prepared, group: Ints, pairs: list[PairPassage], stop: Stop | None
) -> tuple[Floats, TranslationEscape] | None:
    """Bodies led past one neighbour after the other, of those that are left past the first that they can be led past."""
    ground = int(np.flatnonzero(ready.bodies.fixed)[0])
    path, left = np.zeros((1, *ready.bodies.rest.shape)), list(pairs)
    while left:
        for one in left:
            past = _led_past(ready, path[-1], one, stop)
            if past is not None:
                break
        else:
            return None
        left.remove(one)
        out = escape_path(ready, ground, group, past, EXIT_TESTS, stop)
        if out is not None:
            return np.concatenate([path, out[0][1:]]), out[1]
        path = np.concatenate([path, past[1:]])
    return None


def _led_past(ready: Prepared, motion: Floats, one: PairPassage, stop: Stop | None) -> Floats | None:
    """Motions (k, n, 3) of all bodies on which one body passes another, from where all are on; None where others are in the way."""
    assert one.passage.path is not None
    bodies, pivot, points = ready.bodies, one.passage.pivot, one.passage.path
    path = motion[None]
    back = Lead(one.a, one.b, pivot, _motion_past(ready, motion, one), points[0], free=False)
    pieces = [Lead(one.a, one.b, pivot, begin, end, free=True) for begin, end in zip(points, points[1:], strict=False)]
    for lead in [back, *pieces]:
        last = lead is pieces[-1]
        most = BEYOND * ready.clearance if last else np.inf
        found: LedMotion = led(ready, ready.outlines, path[-1], lead, most, stop)
        path = np.concatenate([path, found.path[1:]])
        if found.share < 1 and not last:
            return None
    return path


def _motion_past(ready: Prepared, motion: Floats, one: PairPassage) -> Floats:
    """Motion (3,) of b about the pivot in assembly axes, as if a had stayed at rest."""
    bodies, pivot = ready.bodies, one.passage.pivot
    x, y, turn = relative_pose(bodies, np.array([one.a]), np.array([one.b]), motion)[0]
    at = bodies.rest[one.a]
    moved = np.append(at[:2] + rotated(np.array([x, y]), at[2]), at[2] + turn) - bodies.rest[one.b]
    return np.asarray(about(moved[None], (pivot - bodies.rest[one.b, :2])[None])[0])
