"""Random burrs on a grid: `check` in space against an exhaustive search of all moves by whole cells.

`python -m benchmarks.spatial_burrs 20 3 1` compares 20 burrs of three pieces from seed 1. Where the grid says that nothing comes apart, a
way out by turning may still exist; where it says that something does, `check` must find it.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections import Counter, deque

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Boxes, Drawing, Part
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

STEPS = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
STICKS = {
    3: [((-3, -1, -1), (3, 1, 1)), ((-1, -3, -1), (1, 3, 1)), ((-1, -1, -3), (1, 1, 3))],
    6: [
        ((-3, -1, 0), (3, 1, 2)), ((-3, -1, -2), (3, 1, 0)), ((0, -3, -1), (2, 3, 1)),
        ((-2, -3, -1), (0, 3, 1)), ((-1, 0, -3), (1, 2, 3)), ((-1, -2, -3), (1, 0, 3)),
    ],
}  # fmt: skip


def connected(cells: set) -> bool:
    todo, seen = [next(iter(cells))], set()
    while todo:
        v = todo.pop()
        if v in seen:
            continue
        seen.add(v)
        todo += [w for s in STEPS if (w := (v[0] + s[0], v[1] + s[1], v[2] + s[2])) in cells]
    return len(seen) == len(cells)


def random_burr(rng: np.random.Generator, count: int) -> list[set]:
    """Crossed sticks; cells that several share go to one of them."""
    sticks = STICKS[3 if count <= 3 else 6][:count]
    owners: dict = {}
    for k, (low, high) in enumerate(sticks):
        for v in itertools.product(*[range(a, b) for a, b in zip(low, high, strict=True)]):
            owners.setdefault(v, []).append(k)
    while True:
        parts: list[set] = [set() for _ in sticks]
        for v, who in owners.items():
            parts[who[int(rng.integers(len(who)))]].add(v)
        if all(p and connected(p) for p in parts):
            return parts


def hollowed(parts: list[set], rng: np.random.Generator, share: float) -> list[set]:
    """The parts without some of their cells, each still connected."""
    found = []
    for part in parts:
        left = set(part)
        for v in sorted(part):
            if rng.random() < share and len(left) > 1 and connected(left - {v}):
                left.remove(v)
        found.append(left)
    return found


def comes_apart_on_grid(parts: list[set], most: int = 20_000) -> bool | None:
    """Whether some parts get away from the others by moves of whole cells; None where the search was cut short."""
    count = len(parts)
    start = ((0, 0, 0),) * count
    seen, todo = {start}, deque([start])
    while todo:
        if len(seen) > most:
            return None
        place = todo.popleft()
        own = {}
        for k, (cells, o) in enumerate(zip(parts, place, strict=True)):
            for v in cells:
                own[v[0] + o[0], v[1] + o[1], v[2] + o[2]] = k
        if any(leaves(parts, place, first, step) for first, step in itertools.product(range(count), STEPS)):
            return True
        for first, step in itertools.product(range(count), STEPS):
            group, open_ = {first}, [first]
            while open_:
                k = open_.pop()
                o = place[k]
                for v in parts[k]:
                    other = own.get((v[0] + o[0] + step[0], v[1] + o[1] + step[1], v[2] + o[2] + step[2]))
                    if other is not None and other not in group:
                        group.add(other)
                        open_.append(other)
            if len(group) == count:
                continue
            moved = [tuple(np.add(o, step).tolist()) if k in group else o for k, o in enumerate(place)]
            if (
                max(
                    abs(a - b)
                    for k in group
                    for j in set(range(count)) - group
                    for a, b in zip(moved[k], moved[j], strict=True)
                )
                > 8
            ):
                return True
            shifted = tuple(tuple(np.subtract(o, moved[0]).tolist()) for o in moved)
            if shifted not in seen:
                seen.add(shifted)
                todo.append(shifted)
    return False


def fewest_moves(parts: list[set], most: int = 20_000) -> int:
    """Least number of moves to where some parts are out, by any set of parts any number of cells along an axis; 0 where none get out.

    It tries all sets of parts and all distances, cell by cell.
    """
    count = len(parts)
    sets = [set(s) for k in range(1, count) for s in itertools.combinations(range(count), k)]
    start = ((0, 0, 0),) * count
    depth, todo = {start: 0}, deque([start])
    while todo:
        place = todo.popleft()
        if len(depth) > most:
            raise ValueError("too many places")
        for group, step in itertools.product(sets, STEPS):
            moved = place
            for far in itertools.count(1):
                moved = tuple(tuple(np.add(o, step).tolist()) if k in group else o for k, o in enumerate(moved))
                cells = [
                    {(v[0] + o[0], v[1] + o[1], v[2] + o[2]) for v in p} for p, o in zip(parts, moved, strict=True)
                ]
                if any(cells[i] & cells[j] for i in group for j in set(range(count)) - group):
                    break
                if far > 14:
                    return depth[place] + 1
                shifted = tuple(tuple(np.subtract(o, moved[0]).tolist()) for o in moved)
                if shifted not in depth:
                    depth[shifted] = depth[place] + 1
                    todo.append(shifted)
    return 0


def leaves(parts: list[set], place: tuple, first: int, step: tuple[int, int, int], far: int = 14) -> bool:
    """Whether a piece goes straight until it is out, alone or with others that it meets."""
    cells = [{(v[0] + o[0], v[1] + o[1], v[2] + o[2]) for v in p} for p, o in zip(parts, place, strict=True)]
    group = {first}
    while len(group) < len(parts):
        moving = set().union(*(cells[k] for k in group))
        met = {
            k
            for k in set(range(len(parts))) - group
            if any(
                (v[0] + d * step[0], v[1] + d * step[1], v[2] + d * step[2]) in cells[k]
                for d in range(1, far)
                for v in moving
            )
        }
        if not met:
            return True
        group |= met
    return False


def assembled(parts: list[set], gap: float = 0.05) -> Assembly:
    drawn = tuple(
        Part(f"p{k}", solid=Boxes(np.array([[v, np.add(v, 1)] for v in sorted(cells)], float)))
        for k, cells in enumerate(parts)
    )
    return assemble_spatial(Drawing(drawn, gap))


def main(count: int, pieces: int, seed: int) -> None:
    rng, seen = np.random.default_rng(seed), Counter()
    began = time.process_time()
    for number in range(count):
        parts = random_burr(rng, pieces)
        truth = comes_apart_on_grid(parts)
        found = check_spatial(assembled(parts))
        seen[f"grid {truth}, check {found.verdict}"] += 1
        if truth and found.verdict != "comes apart":
            print(f"burr {number} of seed {seed}: comes apart on the grid, check says {found.verdict}")
    for key, value in sorted(seen.items()):
        print(f"{value:5d} {key}")
    print(f"{time.process_time() - began:.0f} s of processor time")


if __name__ == "__main__":
    main(*(int(a) for a in sys.argv[1:4]))
