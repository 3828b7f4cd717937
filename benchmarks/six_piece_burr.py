"""Six-piece burrs with a key, by exhaustive search: which notched sticks lock each other until the key is pulled, and then come apart.

`python -m benchmarks.six_piece_burr` looks at all ways to share the cells where six crossed sticks meet, the key being a whole stick, and
keeps those whose other sticks hang together, have no blind corners, and cannot move before the key has left. It prints how many of them
come apart after that, and the one that takes most moves as a file of format wiggleroom/2.
"""

from __future__ import annotations

import itertools
import json
from collections import deque

import numpy as np

from benchmarks.spatial_burrs import STEPS, STICKS, connected
from wiggleroom.compiled.jit_options import OPTIONS, njit

CELL, GAP = 10, 0.5
"""Side of a cell and gap of the file [mm]."""


def contested() -> dict[tuple[int, int, int], list[int]]:
    """Sticks that reach into each cell."""
    owners: dict[tuple[int, int, int], list[int]] = {}
    for k, (low, high) in enumerate(STICKS[6]):
        for v in itertools.product(*[range(a, b) for a, b in zip(low, high, strict=True)]):
            owners.setdefault(v, []).append(k)
    return owners


def without_blind_corners(cells: set, stick: int) -> bool:
    """True where no notch ends in a corner of three walls: such a stick can be sawn."""
    low, high = STICKS[6][stick]
    for v in itertools.product(*[range(a, b) for a, b in zip(low, high, strict=True)]):
        if v not in cells and all(
            any(tuple(np.add(v, sign * np.eye(3, dtype=int)[axis]).tolist()) in cells for sign in (1, -1))
            for axis in range(3)
        ):
            return False
    return True


@njit(**OPTIONS)
def locked(owner, ahead, count):
    """True where, of `count` pieces, only the first alone, or all others together, can go a step in any direction.

    `ahead` (6, c) is the cell that lies ahead of each cell, -1 where that is nobody's; `owner` (c,) the piece that has it.
    """
    full = (1 << count) - 1
    for way in range(6):
        met = np.zeros(count, dtype=np.int64)
        for v in range(len(owner)):
            w = ahead[way, v]
            if w >= 0 and owner[v] != owner[w]:
                met[owner[v]] |= 1 << owner[w]
        for first in range(count):
            group, before = 1 << first, 0
            while group != before:
                before = group
                for k in range(count):
                    if group >> k & 1:
                        group |= met[k]
            if group not in (full, 1, full - 1):
                return False
    return True


def burrs() -> list[list[set]]:
    """All burrs with a key as wanted, as cells of six sticks; the first one is the key."""
    owners = contested()
    cells = sorted(owners)
    place = {v: k for k, v in enumerate(cells)}
    ahead = np.array([[place.get(tuple(np.add(v, s).tolist()), -1) for v in cells] for s in STEPS])
    open_cells = [v for v in cells if 0 not in owners[v] and len(owners[v]) > 1]
    own: list[set] = [{v for v in cells if owners[v][0] == k and (len(owners[v]) == 1 or k == 0)} for k in range(6)]
    good: list[dict[frozenset, bool]] = [{} for _ in range(6)]

    def sound(k: int, cells: set) -> bool:
        key = frozenset(cells)
        if key not in good[k]:
            good[k][key] = connected(cells) and without_blind_corners(cells, k)
        return good[k][key]

    # cells are shared out in an order in which sticks are complete as early as can be
    open_cells.sort(key=lambda v: sorted(owners[v]))
    last = {k: max(i for i, v in enumerate(open_cells) if k in owners[v]) for k in range(1, 6)}
    owner = np.array([owners[v][0] for v in cells])
    found: list[list[set]] = []

    def share(i: int) -> None:
        if any(last[k] == i - 1 and not sound(k, own[k]) for k in range(1, 6)):
            return
        if i == len(open_cells):
            if locked(owner, ahead, 6):
                found.append([set(p) for p in own])
            return
        v = open_cells[i]
        for k in owners[v]:
            own[k].add(v)
            owner[place[v]] = k
            share(i + 1)
            own[k].discard(v)

    share(0)
    return found


def moves_apart(parts: list[set]) -> list[int] | None:
    """Moves by a cell until some pieces are off, then of both halves, until each is alone; None where pieces stay together."""
    counts, groups = [], [list(parts)]
    while groups:
        together = groups.pop()
        if len(together) < 2:
            continue
        found = first_apart(together)
        if found is None:
            return None
        moves, gone = found
        counts.append(moves)
        groups += [[p for k, p in enumerate(together) if (k in gone) == side] for side in (True, False)]
    return counts


def first_apart(parts: list[set]) -> tuple[int, set[int]] | None:
    """Least number of moves by a cell until some pieces are off, and which; None where none ever are."""
    n = len(parts)
    start = ((0, 0, 0),) * n
    depth, todo = {start: 0}, deque([start])
    while todo:
        place = todo.popleft()
        cells = [{tuple(np.add(v, o).tolist()) for v in p} for p, o in zip(parts, place, strict=True)]
        for first, step in itertools.product(range(n), STEPS):
            if len(gone := pushed(cells, first, step, 16)) < n:
                return depth[place] + 1, gone
        for first, step in itertools.product(range(n), STEPS):
            if len(group := pushed(cells, first, step)) == n:
                continue
            moved = [tuple(np.add(o, step).tolist()) if k in group else o for k, o in enumerate(place)]
            shifted = tuple(tuple(np.subtract(o, moved[0]).tolist()) for o in moved)
            if shifted not in depth:
                depth[shifted] = depth[place] + 1
                todo.append(shifted)
    return None


def pushed(cells: list[set], first: int, step: tuple[int, int, int], far: int = 2) -> set[int]:
    """Pieces that go along when one goes so many steps less one."""
    group = {first}
    while True:
        moving = set().union(*(cells[k] for k in group))
        more = {
            k
            for k in set(range(len(cells))) - group
            if any((v[0] + d * step[0], v[1] + d * step[1], v[2] + d * step[2]) in cells[k] for d in range(1, far) for v in moving)
        }  # fmt: skip
        if not more:
            return group
        group |= more


def as_boxes(cells: set) -> list[list[int]]:
    """Cells as boxes [mm], grown as far as they go, one axis after the other."""
    left, boxes = set(cells), []
    while left:
        low = np.array(min(left))
        high = low + 1
        for axis in range(3):
            while True:
                more = high.copy()
                more[axis] += 1
                block = set(itertools.product(*[range(a, b) for a, b in zip(low, more, strict=True)]))
                if not block <= cells:
                    break
                high = more
        left -= set(itertools.product(*[range(a, b) for a, b in zip(low, high, strict=True)]))
        boxes.append([*(CELL * low).tolist(), *(CELL * high).tolist()])
    return boxes


def main() -> None:
    every = burrs()
    apart = [(moves, parts) for parts in every if (moves := moves_apart(parts)) is not None]
    print(f"{len(every)} burrs with a key lock; {len(apart)} of them come apart")
    best = max(apart, key=lambda found: (sum(found[0]), -sum(len(as_boxes(p)) for p in found[1])))
    print(f"moves until the next sticks are off: {best[0]}")
    names = ["key", *(f"stick{k}" for k in range(1, 6))]
    parts = [{"name": n, "boxes": as_boxes(p)} for n, p in zip(names, best[1], strict=True)]
    parts[1]["fixed"] = True
    print(json.dumps({"format": "wiggleroom/2", "gap": GAP, "parts": parts}))


if __name__ == "__main__":
    main()
