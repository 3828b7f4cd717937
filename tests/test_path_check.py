"""Pairs that a path meets and its program does not know."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely

from tests.flexing import box
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.cells.cells import select
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION
from wiggleroom.search.path_check import missed_at
from wiggleroom.search.prepare import Prepared, prepare_as_drawn

SIDE, GAP = 10.0, 0.2


def tiles(*glue: tuple[str, str]) -> Prepared:
    """Nine squares in three rows, a gap between neighbours; the first stands."""
    at = [(i, j) for j in range(3) for i in range(3)]
    parts = [
        box(f"t{k}", i * (SIDE + GAP), j * (SIDE + GAP), i * (SIDE + GAP) + SIDE, j * (SIDE + GAP) + SIDE, fixed=k == 0)
        for k, (i, j) in enumerate(at)
    ]
    return prepare_as_drawn(assemble(Drawing(tuple(parts), glue=glue, gap=0.0)))


@pytest.mark.parametrize("glue", [(), (("t1", "t2"), ("t4", "t8")), (("t3", "t6"),)])
def test_only_pairs_outside_the_program_are_missed(glue):
    ready = tiles(*glue)
    bodies, rng = ready.bodies, np.random.default_rng(len(glue))
    n = len(bodies.fixed)
    half = select(ready.cells, np.arange(0, len(ready.cells.a), 2))
    program = build_program(bodies, half, ZERO_MOTION, length=ready.clearance)
    known = set(zip(half.a.tolist(), half.b.tolist(), strict=True))
    pitch = SIDE + GAP
    squares = [shapely.box(x, y, x + SIDE, y + SIDE) for y in (0, pitch, 2 * pitch) for x in (0, pitch, 2 * pitch)]
    met = 0
    for _ in range(20):
        motion = np.where(bodies.fixed[:, None], 0.0, rng.uniform(-0.3, 0.3, (n, 3)) * (1, 1, 0))
        moved = [shapely.affinity.translate(square, *motion[bodies.body_of[k], :2]) for k, square in enumerate(squares)]
        truth = set()
        for p, q in itertools.combinations(range(9), 2):
            a, b = sorted((int(bodies.body_of[p]), int(bodies.body_of[q])))
            if a != b and moved[p].intersection(moved[q]).area > 1e-6:
                truth.add((a, b))
        met += len(truth & known)
        found = missed_at(ready, motion[None], program)
        assert set(zip(*(one.tolist() for one in found), strict=True)) == truth - known
    assert met  # some overlap that the program answers for
