"""Ends of congruent joints, offered to each other: where pairs hang together as a tree, each can take the path of another alone.

A joint may end in several ways that are nearly as good, and which is best depends on the other joints. A pair that is
congruent to another has the same free space, so the path by which the other went is legal for it too, and in a tree no
other pair notices.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells, replaced, select
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.relative_pose import relative_pose, rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

POSE_TOLERANCE = 0.05
"""Ends of two joints that differ by less than this share of the clearance are the same."""
MAX_SWAPS = 64
"""Joints are tried one by one where there are no more tries than this."""


@dataclass(frozen=True, eq=False)
class CongruentSwap:
    """Pairs `who` (k,) that take the path of the pair `like`."""

    who: Ints
    like: int


def congruent_swaps(bodies: Bodies, cells: Cells, motion: Floats, clearance: float) -> list[CongruentSwap]:
    """What to try at the end of a motion (n, 3) [mm, mm, rad]: each end for all joints of its kind, and for each joint alone.

    None where the pairs do not hang together as a tree, or there would be too many.
    """
    rest = relative_pose(bodies, cells.a, cells.b)
    if not _is_tree(bodies, cells):
        return []
    _, label = congruence_classes(bodies, cells.a, cells.b, rest)
    end = relative_pose(bodies, cells.a, cells.b, motion) - rest
    end[:, 2] *= np.maximum(bodies.radius[cells.a], bodies.radius[cells.b])
    together: list[CongruentSwap] = []
    alone: list[CongruentSwap] = []
    for kind in range(int(label.max(initial=-1)) + 1):
        same = np.flatnonzero(label == kind)
        for k, like in enumerate(same):
            far = np.abs(end[same] - end[like]).max(axis=1) > POSE_TOLERANCE * clearance
            if not far[:k].all():  # an end that was met before
                continue
            others = same[far]
            if len(others):
                together.append(CongruentSwap(others, int(like)))
                alone += [CongruentSwap(np.array([one]), int(like)) for one in others]
    return [*together, *alone] if len(together) + len(alone) <= MAX_SWAPS else []


def exchanged(bodies: Bodies, cells: Cells, swap: CongruentSwap) -> Cells:
    """The same cells, but `swap.who` with those of `swap.like`."""
    rest = relative_pose(bodies, cells.a, cells.b)
    theirs = select(cells, np.full(len(swap.who), swap.like))
    turns = rest[swap.who] - rest[swap.like]
    turns[:, :2] = 0.0  # congruent, up to whole turns
    mine = replace(
        theirs,
        a=cells.a[swap.who],
        b=cells.b[swap.who],
        ends=theirs.ends + turns[:, 2:],
        seed=theirs.seed + turns,
    )
    return replaced(cells, swap.who, mine)


def followed(bodies: Bodies, cells: Cells, swap: CongruentSwap, motions: Floats) -> Floats:
    """The motions (k, n, 3) [mm, mm, rad] in which `swap.who` are where `swap.like` is, and all other pairs where they were."""
    rest = relative_pose(bodies, cells.a, cells.b)
    now = np.stack([relative_pose(bodies, cells.a, cells.b, motion) for motion in motions], axis=1)
    now[swap.who] = rest[swap.who, None] + (now[swap.like] - rest[swap.like])
    pose, out = bodies.rest + motions, motions.copy()
    for pair, forward in _outwards(bodies, cells):
        a, b = int(cells.a[pair]), int(cells.b[pair])
        if forward:
            pose[:, b, 2] = pose[:, a, 2] + now[pair, :, 2]
            pose[:, b, :2] = pose[:, a, :2] + rotated(now[pair, :, :2], pose[:, a, 2])
        else:
            pose[:, a, 2] = pose[:, b, 2] - now[pair, :, 2]
            pose[:, a, :2] = pose[:, b, :2] - rotated(now[pair, :, :2], pose[:, a, 2])
        moved = b if forward else a
        out[:, moved] = pose[:, moved] - bodies.rest[moved]
    still = ~motions.any(axis=(1, 2))  # rest stays rest, to the last digit
    out[still] = 0.0
    return out


def _is_tree(bodies: Bodies, cells: Cells) -> bool:
    """True where every free body hangs on others, or on what is fixed, by one chain of pairs only."""
    return len(_outwards(bodies, cells)) == len(cells.a)


def _outwards(bodies: Bodies, cells: Cells) -> list[tuple[int, bool]]:
    """Pairs in the order in which they are met from what is fixed, and whether each leads from A to B; none that closes a loop."""
    at: list[list[tuple[int, int, bool]]] = [[] for _ in bodies.fixed]
    for pair, (a, b) in enumerate(zip(cells.a.tolist(), cells.b.tolist(), strict=True)):
        at[a].append((pair, b, True))
        at[b].append((pair, a, False))
    known = bodies.fixed.copy()
    found: list[tuple[int, bool]] = []
    for root in [*np.flatnonzero(bodies.fixed), *np.flatnonzero(~bodies.fixed)]:
        if known[root] and not bodies.fixed[root]:
            continue
        known[root] = True
        todo = deque([int(root)])
        while todo:
            for pair, other, forward in at[todo.popleft()]:
                if not known[other]:
                    known[other] = True
                    found.append((pair, forward))
                    todo.append(other)
    return found
