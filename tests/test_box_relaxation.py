"""Rows of boxes of motions hold at every free motion, which general polygon geometry tells."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from wiggleroom.assembly.assembly import place
from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes, PulledBody


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
