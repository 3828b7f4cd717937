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
from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes, PulledBody


@njit(**OPTIONS)
def relaxed(at, half, swing, a, b, goal):
    """Rows of both bodies' corners in a box, and the largest value of a goal that they allow."""
    a_edge, a_disc, a_kid = a
    b_edge, b_disc, b_kid = b
    stack, nodes = np.empty(512, dtype=np.int64), np.empty(512, dtype=np.int64)
    some, one = np.empty(MAX_EDGES + 1, dtype=np.int64), np.empty(1, dtype=np.int64)
    line, rows = np.empty(3), np.empty((MAX_ROWS, 4))
    m = add_rows(
        at[0], at[1], at[2], half, swing, 0.0, True, b_edge, b_disc, b_kid, a_edge, a_disc, a_kid, stack, nodes, some, one, line, rows, 0,
    )  # fmt: skip
    m = add_rows(
        at[0], at[1], at[2], half, swing, 0.0, False, a_edge, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, some, one, line, rows, m,
    )  # fmt: skip
    return rows[:m], linear_program_maximum(goal[0], goal[1], goal[2], rows, m, np.empty((3, 4)), np.empty((3, 3)))


def moved(shape, motion):
    return shapely.transform(shape, lambda points: place(points, tuple(motion)))


@pytest.mark.parametrize("seed", range(3))
def test_no_bound_lies_below_the_play_however_small_and_far_from_the_origin(seed):
    """A rectangle in a hole that is wider by its play all round: pulled along its side it moves by the play."""
    rng = np.random.default_rng(seed)
    w, h = rng.uniform(0.5, 2, 2)
    play, far, angle = 10 ** rng.uniform(-6, -4), 10 ** rng.uniform(4, 6), rng.uniform(0, 7)
    peg = np.array([[-w, -h], [w, -h], [w, h], [-w, h]]) / 2
    middle = rng.uniform(-far, far, 2)
    hole, peg = (place(corners, (*middle, angle)) for corners in (peg + play * np.sign(peg), peg))
    block = shapely.Polygon(place(np.array([[-3, -3], [3, -3], [3, 3], [-3, 3]]), (*middle, angle)), [hole])
    pull = np.array([np.cos(angle), np.sin(angle)])
    lever = np.array([pull @ middle, middle[0] * pull[1] - middle[1] * pull[0]])
    boxes = MotionBoxes(PulledBody(1, block, shapely.Polygon(peg), pull, lever, 0.0), 60_000)
    told = [boxes.beyond(np.inf, play * (1 + share), 300_000)[0] for share in (1e-2, 1e-4, 1e-6, 1e-8)]
    at_most = [bound for bound in told if bound is not None]
    assert at_most
    assert all(bound >= play for bound in at_most)


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
