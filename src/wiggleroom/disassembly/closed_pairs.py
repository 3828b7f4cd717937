"""Which bodies certainly never leave each other, by enclosure and pair by pair: the cheap proof that something interlocks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.enclosure import Enclosed
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.rigid_subassembly import passage_or_enclosure
from wiggleroom.disassembly.slide_search import slide_search
from wiggleroom.disassembly.slide_space import SlideSpace
from wiggleroom.drawing.outlines.connected_components import components
from wiggleroom.freespace.subdivision.passage import Passage, passage
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared

Ints = NDArray[np.int64]

PAIR_BATCH = 50
"""Pairs that are measured between two looks whether to stop."""
BOXES_PER_PAIR = 20_000
"""Boxes judged at most for a pair among many."""
PAIR_WORK = 2e6
"""Work of the search over slides of a pair."""
BOXES_PER_DECISIVE_PAIR = 400_000
"""Boxes judged at most for a pair on which it depends whether all are tied: near the gap at which a tab slips out, each takes seconds."""


@dataclass(frozen=True, eq=False)
class ClosedPairs:
    """Bodies tied to each other.

    Parameters
    ----------
    group : (n,) int64
        Bodies of the same number certainly never leave each other.
    held : (n,) int64
        Bodies of the same number certainly never turn half round against each other either.
    undecided : (k, 2) int64
        Pairs that a few boxes do not decide, those that lie along each other longest first.
    """

    group: Ints
    held: Ints
    undecided: Ints

    @property
    def all_tied(self) -> bool:
        """True where all bodies are tied together."""
        return bool((self.group == self.group[0]).all())


def enclosed_links(fixed: NDArray[np.bool_], around: Enclosed) -> ClosedPairs:
    """Tie together what stands, and what lies in closed holes to what it lies in.

    Parameters
    ----------
    fixed : (n,) bool
        Bodies that stand.
    around : Enclosed
    """
    fixed_bodies = np.flatnonzero(fixed)
    standing = [(int(fixed_bodies[0]), int(k)) for k in fixed_bodies]
    pairs = [(int(a), int(b)) for a, b in around.pairs]
    still = [(a, b) for a, b in pairs if around.held[a] and around.held[b]]
    none = np.zeros((0, 2), dtype=np.int64)
    return ClosedPairs(_labels(len(fixed), standing + pairs), _labels(len(fixed), standing + still), none)


def closed_pairs(
    ready: Prepared, begin: ClosedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> ClosedPairs:
    """Tie bodies together wherever the free space of a pair alone is certainly closed.

    What two bodies cannot do while all others are taken away they cannot do among them either. Pairs that lie along each other longest come
    first, congruent pairs are looked at once, and pairs that are held already are left out.

    Parameters
    ----------
    ready : Prepared
    begin : ClosedPairs
        What is tied to begin with; of that nothing more is asked.
    passages : PassagesByGap
        Those known from other gaps; what is found is added.
    context : Context, optional
    """
    bodies, n = ready.bodies, len(ready.bodies.fixed)
    if context.stopped:
        return begin
    geometry = placed(bodies)
    near = neighbours(bodies, geometry, NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
    tied, held = _ties(begin.group), _ties(begin.held)
    undecided: list[tuple[int, int]] = []
    if len(near.a):
        first, label = congruence_classes(bodies, near.a, near.b, relative_pose(bodies, near.a, near.b))
        along = _along(geometry[near.a[first]], geometry[near.b[first]], ready.clearance, context)[label]
        known: dict[int, Passage | None] = {}  # none where slides lead apart
        for k in np.argsort(-along, kind="stable"):
            a, b, c = int(near.a[k]), int(near.b[k]), int(label[k])
            if context.stopped:
                break
            labels = _labels(n, held)
            if labels[a] == labels[b] or begin.group[a] == begin.group[b]:
                continue
            if c not in known:
                known[c] = alone(ready, a, b, passages, context)
            found = known[c]
            if found is None:
                continue
            if found.held:
                held.append((a, b))
            if found.closed:
                tied.append((a, b))
            elif found.path is None:
                undecided.append((a, b))
    return ClosedPairs(_labels(n, tied), _labels(n, held), np.array(undecided, dtype=np.int64).reshape(-1, 2))


def alone(ready: Prepared, a: int, b: int, passages: PassagesByGap, context: Context) -> Passage | None:
    """What is known about b leaving a while all others are taken away; None where slides lead out."""

    def look() -> Passage | None:
        if _slides_apart(ready, a, b, context):
            return None
        one, other = placed(ready.bodies, None, np.array([a, b]))[[a, b]]
        return passage_or_enclosure(one, other, BOXES_PER_PAIR, context)

    return passages.look(ready, np.array([a]), np.array([b]), BOXES_PER_PAIR, look, context)


def decisive_passage(ready: Prepared, a: int, b: int, passages: PassagesByGap, context: Context) -> Passage | None:
    """The passage of b out of a, by as many boxes as a pair on which much depends is given; None where slides are known to lead out."""

    def look() -> Passage:
        one, other = placed(ready.bodies, None, np.array([a, b]))[[a, b]]
        return passage(one, other, most=BOXES_PER_DECISIVE_PAIR, stop=context.stop)

    return passages.look(ready, np.array([a]), np.array([b]), BOXES_PER_DECISIVE_PAIR, look, context)


def _slides_apart(ready: Prepared, a: int, b: int, context: Context) -> bool:
    """True where slides of b lead out of a: a cheap look before boxes of motions are judged."""
    them = ready.bodies
    pair = np.array([a, b])
    bodies = replace(
        them, shape=them.shape[pair], rest=them.rest[pair], fixed=np.array([True, False]),
        body_of=np.arange(2), members=((0,), (1,)),
    )  # fmt: skip
    rest, none = np.zeros((2, 3)), np.zeros(0, dtype=np.int64)
    space = SlideSpace(bodies, none, ready.clearance, ready.size, rest, np.ones(2, dtype=np.bool_))
    found = slide_search(space, rest, none, budget=PAIR_WORK, turn_budget=0.0, context=context.silent)
    return found.path is not None


def decide_more_pairs(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> ClosedPairs:
    """Look again, with many more boxes, at pairs that were not decided, for as long as that can still tie all bodies together.

    The group with the fewest such pairs comes first: where none of them is closed, the others need not be looked at.
    """
    a, b = known.undecided.T
    _, label = congruence_classes(ready.bodies, a, b, relative_pose(ready.bodies, a, b))
    seen: dict[int, Passage | None] = {}
    group, held = known.group, known.held
    while True:
        open_ = group[a] != group[b]
        count = np.bincount(group[np.concatenate([a[open_], b[open_]])], minlength=group.max() + 1)[np.unique(group)]
        weakest = np.unique(group)[count.argmin()]
        for k in np.flatnonzero(open_ & ((group[a] == weakest) | (group[b] == weakest))):
            if context.stopped:
                return replace(known, group=group, held=held)
            c = int(label[k])
            if c not in seen:
                seen[c] = decisive_passage(ready, int(a[k]), int(b[k]), passages, context)
            found = seen[c]
            if found is not None and found.closed:
                held = np.where(held == held[b[k]], held[a[k]], held) if found.held else held
                group = np.where(group == group[b[k]], group[a[k]], group)
                break
        else:
            return replace(known, group=group, held=held)


def _ties(group: Ints) -> list[tuple[int, int]]:
    """Pairs that tie together what has the same number."""
    _, first, label = np.unique(group, return_index=True, return_inverse=True)
    return [(int(first[g]), k) for k, g in enumerate(label.tolist())]


def _along(a: NDArray[np.object_], b: NDArray[np.object_], clearance: float, context: Context) -> NDArray[np.float64]:
    """How long two bodies lie along each other [mm], zero for those that come after a request to stop."""
    found = np.zeros(len(a))
    for k in range(0, len(a), PAIR_BATCH):
        if context.stopped:
            break
        some = slice(k, k + PAIR_BATCH)
        near = shapely.buffer(b[some], 1.5 * NEIGHBOUR_REACH * clearance, quad_segs=2)
        found[some] = shapely.length(shapely.intersection(shapely.boundary(a[some]), near))
    return found


def _labels(n: int, ties: list[tuple[int, int]]) -> Ints:
    """Number of the group (n,) that each body is tied to."""
    table = np.array(ties, dtype=np.int64).reshape(-1, 2)
    return np.unique(components(n, table[:, 0], table[:, 1]), return_inverse=True)[1]
