"""Bodies that leave their neighbours one after the other, each along the path that is free for the two alone, while others make room.

Near the gap at which tabs slip out of their sockets, such a path is a needle's eye: boxes of motions find it for two bodies, searches for
largest motions of all do not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.closed_pairs import ClosedPairs, alone, decisive_passage
from wiggleroom.disassembly.escape_search import EXIT_TESTS, escape_path
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.path_following import RelativeSegment, follow
from wiggleroom.disassembly.translation import TranslationEscape
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_BODIES = 200
"""Where more bodies than this are loose, nothing is led: all are audited at every step."""
MAX_SETS = 4
"""So many sets of bodies are led out, those first that have the fewest neighbours."""
MAX_PASSAGES = 4
"""Sets that have to pass more neighbours than this are left out."""
MAX_LENGTH = 40.0
"""Paths that are longer than this multiple of the clearance before they go straight on are left out: steps are of half a clearance."""
BEYOND = 6.0
"""Once it is past a neighbour, a body is led on by this multiple of the clearance."""


NamedPairs = tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class RelativePath:
    """A path of body b past body a that is free for the two alone.

    Parameters
    ----------
    a, b : int
    pivot : (2,) float64 [mm]
    path : (k, 3) float64 [mm, mm, rad]
        Motions of b about the pivot while a is at rest; straight between them.
    """

    a: int
    b: int
    pivot: Floats
    path: Floats


@dataclass(frozen=True, eq=False)
class EscapeByPairs:
    """Bodies led out.

    Parameters
    ----------
    path : (k, n, 3) float64 [mm, mm, rad]
        Audited motions of all bodies to where `exit` begins.
    exit : TranslationEscape
    pairs : tuple of pairs of names
        Who was led past whom, one after the other, by the first part of each body.
    """

    path: Floats
    exit: TranslationEscape
    pairs: NamedPairs


def escape_by_pairs(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> EscapeByPairs | None:
    """The first set of bodies tied together that can be led out past all of its neighbours; None where none is.

    Parameters
    ----------
    ready : Prepared
    known : ClosedPairs
        Of its pairs that are not decided those that matter are looked at with more boxes.
    passages : PassagesByGap
        Those known of pairs; what is found is added.
    context : Context, optional
    """
    if not 2 <= (~ready.bodies.fixed).sum() <= MAX_BODIES:  # nobody else makes room, or every step takes long
        return None
    for pairs in _sets(ready, known, passages, context):
        for first in range(len(pairs)):
            found = _out_by_pairs(ready, known.group, [pairs[first], *pairs[:first], *pairs[first + 1 :]], context)
            if found is not None:
                return found
    return None


def escape_by_known_pairs(
    ready: Prepared, group: Ints, pairs: NamedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> EscapeByPairs | None:
    """The same by what led out at another gap; None where it does not at this one."""
    names, found = [ready.assembly.names[members[0]] for members in ready.bodies.members], []
    for pair in pairs:
        if not set(pair) <= set(names):
            return None
        a, b = (names.index(name) for name in pair)
        way = decisive_passage(ready, a, b, passages, context)
        if way is None or way.path is None:
            return None
        found.append(RelativePath(a, b, way.pivot, way.path))
    return _out_by_pairs(ready, group, found, context)


def _sets(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, context: Context
) -> Iterator[list[RelativePath]]:
    """The neighbours that each set of bodies tied together has to pass, sets with the fewest first."""
    bodies = ready.bodies
    near = neighbours(bodies, placed(bodies), NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
    one, other = known.group[near.a], known.group[near.b]
    loose = np.setdiff1d(known.group, known.group[bodies.fixed])
    beside = {int(g): np.flatnonzero((one != other) & ((one == g) | (other == g))) for g in loose}
    undecided = {(int(a), int(b)) for a, b in known.undecided}
    for g in sorted(beside, key=lambda g: len(beside[g]))[:MAX_SETS]:
        found: list[RelativePath] = []
        for a, b in zip(near.a[beside[g]].tolist(), near.b[beside[g]].tolist(), strict=True):
            if context.stopped:
                return
            look = decisive_passage if (a, b) in undecided else alone
            way = look(ready, a, b, passages, context)
            if way is None:  # slides lead apart: it needs not be led
                continue
            if way.path is None or len(found) == MAX_PASSAGES:
                break
            found.append(RelativePath(a, b, way.pivot, way.path))
        else:
            if found:
                yield found


def _out_by_pairs(ready: Prepared, group: Ints, pairs: list[RelativePath], context: Context) -> EscapeByPairs | None:
    """Bodies led past one neighbour after the other, each time the first of those left that they can be led past."""
    ground = int(np.flatnonzero(ready.bodies.fixed)[0])
    path, left, done = np.zeros((1, *ready.bodies.rest.shape)), list(pairs), []
    names = [ready.assembly.names[members[0]] for members in ready.bodies.members]
    while left:
        for one in left:
            past = _past_neighbour(ready, path[-1], one, context)
            if past is not None:
                break
        else:
            return None
        left.remove(one)
        done.append((names[one.a], names[one.b]))
        out = escape_path(ready, ground, group, past, EXIT_TESTS, context)
        if out is not None:
            return EscapeByPairs(np.concatenate([path, out[0][1:]]), out[1], tuple(done))
        path = np.concatenate([path, past[1:]])
    return None


def _past_neighbour(ready: Prepared, motion: Floats, one: RelativePath, context: Context) -> Floats | None:
    """Motions (k, n, 3) of all bodies on which one body passes another, from where all are on; None where others are in the way."""
    path = motion[None]
    back = RelativeSegment(one.a, one.b, one.pivot, _motion_past(ready, motion, one), one.path[0], free=False)
    pieces = [RelativeSegment(one.a, one.b, one.pivot, begin, end, free=True) for begin, end in pairwise(one.path)]
    if sum(segment.length(ready.bodies) for segment in pieces[:-1]) > MAX_LENGTH * ready.clearance:
        return None
    for segment in [back, *pieces]:
        last = segment is pieces[-1]
        most = BEYOND * ready.clearance if last else np.inf
        found = follow(ready, ready.outlines, path[-1], segment, most, context)
        path = np.concatenate([path, found.path[1:]])
        if found.share < 1 and not last:
            return None
    return path


def _motion_past(ready: Prepared, motion: Floats, one: RelativePath) -> Floats:
    """Motion (3,) of b about the pivot in assembly axes, as if a had stayed at rest."""
    bodies, pivot = ready.bodies, one.pivot
    x, y, turn = relative_pose(bodies, np.array([one.a]), np.array([one.b]), motion)[0]
    at = bodies.rest[one.a]
    moved = np.append(at[:2] + rotated(np.array([x, y]), at[2]), at[2] + turn) - bodies.rest[one.b]
    return np.asarray(about(moved[None], (pivot - bodies.rest[one.b, :2])[None])[0])
