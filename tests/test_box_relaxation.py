"""Rows of boxes of motions hold at every free motion, which general polygon geometry tells."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.assembly.assembly import place
from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.freespace.subdivision.box_relaxation import MAX_EDGES, MAX_ROWS, add_rows, linear_program_maximum
from wiggleroom.freespace.subdivision.disc_tree import disc_tree


@njit(**OPTIONS)
def relaxed(at, half, swing, a, b, goal):
    """Rows of both bodies' corners in a box, and the largest value of a goal that they allow."""
    a_edge, a_disc, a_kid = a
    b_edge, b_disc, b_kid = b
    stack, nodes = np.empty(512, dtype=np.int64), np.empty(512, dtype=np.int64)
    some, one = np.empty(MAX_EDGES + 1, dtype=np.int64), np.empty(1, dtype=np.int64)
    line, rows = np.empty(3), np.empty((MAX_ROWS, 4))
    m = add_rows(
        at[0], at[1], at[2], half, swing, True, b_edge, b_disc, b_kid, a_edge, a_disc, a_kid, stack, nodes, some, one, line, rows, 0,
    )  # fmt: skip
    m = add_rows(
        at[0], at[1], at[2], half, swing, False, a_edge, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, some, one, line, rows, m,
    )  # fmt: skip
    return rows[:m], linear_program_maximum(goal[0], goal[1], goal[2], rows, m, np.empty((3, 4)), np.empty((3, 3)))


def moved(shape, motion):
    return shapely.transform(shape, lambda points: place(points, tuple(motion)))


@pytest.mark.parametrize("shift", [(0.0, 0.0), (-1.0, 0.0), (0.3, -0.7)])
@pytest.mark.parametrize(("joint", "gap"), [("tee", 0.08), ("tee", 0.02), ("jigsaw", 0.05), ("revolute", 0.02)])
def test_rows_hold_at_free_motions(joint, gap, shift):
    """At gap 0.08 the flanges of the tee's pocket have no width left: they are spikes."""
    rng = np.random.default_rng(0)
    shapes = [moved(shapely.Polygon(p.regions[0].outer), p.at) for p in wr.patterns.chain(2, joint, gap).parts]
    one, other = (moved(shape, (*shift, 0.0)) for shape in shapes)
    a, b = disc_tree(one, np.zeros(2)), disc_tree(other, np.zeros(2))
    looked_at = 0
    for _ in range(700):
        free = rng.normal(size=3) * np.exp(rng.uniform(-7, 0.5))
        if shapely.relate_pattern(one, moved(other, free), "T********"):
            free = np.zeros(3)
        half, swing, z, goal = (
            np.exp(rng.uniform(-8, 0)),
            np.exp(rng.uniform(-8, 0.3)),
            rng.uniform(-1, 1, 3),
            rng.normal(size=3),
        )
        rows, most = relaxed(
            free - z * (half, half, swing), half, swing, (a.edge, a.disc, a.kid), (b.edge, b.disc, b.kid), goal
        )
        assert (rows[:, :3] @ z <= rows[:, 3] + 1e-9).all()
        assert most >= goal @ z - 1e-9
        looked_at += len(rows)
    assert looked_at > 300
