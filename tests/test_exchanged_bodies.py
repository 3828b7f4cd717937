"""Bodies of one shape count as the same only where nothing tells them apart: judged by exhaustive search, and by telling the same anew."""

from __future__ import annotations

import json
from collections import deque
from dataclasses import dataclass

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.drawing.readers.assembly_file import read_assembly
from wiggleroom.verdict import Separability

CELL, GAP = 10.0, 0.6
Cell = tuple[int, int]


@dataclass(frozen=True)
class SlidePuzzle:
    """Pieces of unit squares in a tray, whose openings are closed by fixed parts that some pieces pass through."""

    cells: dict[str, frozenset[Cell]]
    fixed: frozenset[str]
    ignore: frozenset[frozenset[str]]
    glue: tuple[tuple[str, str], ...]
    offset: dict[str, float]

    def drawing(self, order: list[str], called: dict[str, str], corner: str = "") -> dict:
        """As a file: parts in some order, by other names; one of them with one more corner, 1e-3 mm further out."""
        parts = []
        for name in order:
            if name == "frame":
                entry = {"outline": _ring(self.cells["frame"])}
            else:
                low, high = np.min(list(self.cells[name]), axis=0), np.max(list(self.cells[name]), axis=0) + 1
                w, h = ((high - low) * CELL).tolist()
                outline = [[0, 0], *([[w / 2, -1e-3]] if name == corner else []), [w, 0], [w, h], [0, h]]
                entry = {"outline": outline, "at": [*(low * CELL).tolist(), 0]}
            entry |= {"offset": self.offset[name]} if name in self.offset else {}
            parts.append({"name": called[name], **entry, **({"fixed": True} if name in self.fixed else {})})
        glue = [[called[n] for n in pair] for pair in self.glue]
        ignore = sorted(sorted(called[n] for n in pair) for pair in self.ignore)
        return {"format": "wiggleroom/1", "gap": GAP, "parts": parts, "ignore": ignore, "glue": glue}

    def slides_apart(self) -> bool:
        """Whether steps of one cell lead anything out: all states, each group pushed as far as it pushes others."""
        free = sorted(set(self.cells) - self.fixed)
        wall = {n: self.cells[n] for n in self.fixed}
        reach, glued = 5, {**dict(self.glue), **{b: a for a, b in self.glue}}
        meets = {(a, b): frozenset((a, b)) not in self.ignore for a in self.cells for b in self.cells if a != b}

        def pushed(state: dict[str, frozenset[Cell]], first: str, step: Cell) -> set[str] | None:
            group, todo = {first}, [first]
            while todo:
                mover = todo.pop()
                if mover in glued and glued[mover] not in group:
                    group.add(glued[mover])
                    todo.append(glued[mover])
                ahead = {(x + step[0], y + step[1]) for x, y in state[mover]}
                for other, cells in {**wall, **state}.items():
                    if other != mover and other not in group and meets[mover, other] and ahead & cells:
                        if other in wall:
                            return None
                        group.add(other)
                        todo.append(other)
            return group

        start = {n: self.cells[n] for n in free}
        seen = {tuple(map(min, start.values()))}
        todo = deque([start])
        while todo:
            state = todo.popleft()
            for name in free:
                for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                    group = pushed(state, name, step)
                    if group is None:
                        continue
                    after = {
                        n: frozenset((x + step[0], y + step[1]) for x, y in c) if n in group else c
                        for n, c in state.items()
                    }
                    if any(abs(v) > reach for c in after.values() for p in c for v in p):
                        return True
                    key = tuple(map(min, after.values()))
                    if key not in seen:
                        seen.add(key)
                        todo.append(after)
        return False


def _ring(border: frozenset[Cell]) -> list[list[float]]:
    """The border of a tray as one ring."""
    whole = shapely.union_all([shapely.box(x * CELL, y * CELL, (x + 1) * CELL, (y + 1) * CELL) for x, y in border])
    assert isinstance(whole, shapely.Polygon)
    assert not whole.interiors
    return [list(p) for p in whole.exterior.coords[:-1]]


def _puzzle(seed: int) -> SlidePuzzle:
    random = np.random.default_rng(seed)
    w, h = 3, 2
    border = {(x, y) for x in range(-1, w + 1) for y in range(-1, h + 1)} - {(x, y) for x in range(w) for y in range(h)}
    side = int(random.integers(0, h))
    gate = {(-1, side)}
    cells = {"frame": frozenset(border - gate), "gate": frozenset(gate)}
    inside = [(x, y) for x in range(w) for y in range(h)]
    random.shuffle(inside)
    taken: set[Cell] = set()
    holes = int(random.integers(1, 3))
    for k, (x, y) in enumerate(inside):
        if (x, y) in taken or w * h - len(taken) <= holes:
            continue
        other = (x + 1, y) if random.random() < 0.5 else (x, y + 1)
        two = {(x, y), other}
        if random.random() < 0.25 and other in inside and not two & taken and w * h - len(taken) - 2 >= holes:
            cells[f"p{k}"] = frozenset(two)
        else:
            cells[f"p{k}"] = frozenset({(x, y)})
        taken |= cells[f"p{k}"]
    pieces = sorted(set(cells) - {"frame", "gate"})
    fixed = {"frame", "gate"}
    if random.random() < 0.3:
        fixed.add(pieces.pop(int(random.integers(len(pieces)))))
    near = [
        (a, b)
        for a in pieces
        for b in pieces
        if a < b and any(abs(x - u) + abs(y - v) == 1 for x, y in cells[a] for u, v in cells[b])
    ]
    glue = [near[int(random.integers(len(near)))]] if near and random.random() < 0.4 else []
    offset = {str(n): -0.05 for n in pieces if random.random() < 0.2}
    pairs = {frozenset((str(random.choice(pieces)), "gate"))}
    for _ in range(int(random.integers(0, 2))):
        a, b = random.choice(pieces, 2, replace=False)
        pairs.add(frozenset((str(a), str(b))))
    together = {a: {a, b} for pair in glue for a, b in (pair, pair[::-1])}
    ignore = {
        frozenset((x, y)) for a, b in map(sorted, pairs) for x in together.get(a, {a}) for y in together.get(b, {b})
    }
    whole = frozenset(pair for pair in ignore if len(pair) == 2 and pair not in set(map(frozenset, glue)))
    return SlidePuzzle(cells, frozenset(fixed), whole, tuple(glue), offset)


def _comes_apart(drawing: dict) -> bool:
    found = wr.check(wr.assemble(read_assembly(json.dumps(drawing))), boxes=100, questions=0, every=False)
    return found.verdict is Separability.COMES_APART


SLOW = [pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 4, 8, 9)]


@pytest.mark.parametrize("seed", [0, 3, 38, *SLOW])
def test_what_slides_apart_on_a_grid_comes_apart_whatever_its_parts_are_called(seed):
    puzzle, random = _puzzle(seed), np.random.default_rng(seed)
    names = sorted(puzzle.cells)
    plain = _comes_apart(puzzle.drawing(names, {n: n for n in names}))
    assert plain or not puzzle.slides_apart()
    called = dict(zip(names, [f"q{k}" for k in random.permutation(len(names))], strict=True))
    order = [str(n) for n in random.permutation(names)]
    special = next(n for pair in sorted(map(sorted, puzzle.ignore)) if "gate" in pair for n in pair if n != "gate")
    assert _comes_apart(puzzle.drawing(order, called)) == plain
    assert _comes_apart(puzzle.drawing(names, {n: n for n in names}, corner=special)) == plain
