"""Paths of boxes of motions, looked at by shapely: free all along, and out of reach where they are said to lead out."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely
from shapely import affinity

from wiggleroom.freespace.subdivision.box_search import across_of_one_box, add_octants, neighbour_leaves
from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes, PulledBody
from wiggleroom.freespace.subdivision.passage import passage

STEPS = 60


def cup(rng: np.random.Generator) -> tuple[shapely.Polygon, shapely.Polygon]:
    """A bent bar in a cup with a mouth that lets it out, both turned anyhow."""
    wide, deep, thick = rng.uniform(2, 4), rng.uniform(1.5, 3), rng.uniform(0.3, 1.5)
    wall = shapely.box(-wide - thick, -deep - thick, wide + thick, deep)
    lip = rng.uniform(0.1, 0.6) * wide
    outer = wall - shapely.box(-wide, -deep, wide, deep - 0.2) - shapely.box(-wide + lip, 0, wide, deep + 1)
    bar = shapely.box(-0.8 * wide, -0.7 * deep, 0.3 * wide, -0.4 * deep) | shapely.box(
        0, -0.7 * deep, 0.3 * wide, 0.2 * deep
    )
    angle = rng.uniform(0, 360)
    return tuple(affinity.rotate(shape, angle, origin=(0, 0)) for shape in (outer, bar))


def overlap_along(a: shapely.Geometry, b: shapely.Geometry, path: np.ndarray, pivot: np.ndarray) -> float:
    """Largest area that both share at any of many moments of a path of b about a pivot."""
    share = np.linspace(0, 1, STEPS, endpoint=False)
    moments = np.concatenate(
        [one + share[:, None] * (two - one) for one, two in itertools.pairwise(path)] + [path[-1:]]
    )
    moved = [
        affinity.translate(affinity.rotate(b, turn, origin=tuple(pivot), use_radians=True), x, y)
        for x, y, turn in moments
    ]
    return float(shapely.area(shapely.intersection(np.array(moved), a)).max())


@pytest.mark.parametrize("seed", range(5))
def test_a_path_out_ends_beyond_reach_and_goes_round_freely(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = cup(rng)
    out = passage(a, b)
    assert out.path is not None
    assert overlap_along(a, b, out.path, out.pivot) == 0.0
    radius = [shapely.hausdorff_distance(shapely.Point(out.pivot), shape) for shape in (a, b)]
    assert np.hypot(*out.path[-1, :2]) > sum(radius)
    pull = rng.normal(size=2)
    boxes = MotionBoxes(PulledBody(0, a, b, pull, np.zeros(2), 0.0), 50_000)
    _, path = boxes.beyond(2.0 * sum(radius), 2.0 * sum(radius), 10**6)
    assert path is not None
    assert overlap_along(a, b, path, boxes.pivot) == 0.0
    assert path[-1, :2] @ pull > 0.9 * np.hypot(*pull) * np.hypot(*path[-1, :2])


def test_neighbours_of_a_box_are_the_leaves_that_share_a_face_with_it():
    rng, most = np.random.default_rng(0), 3000
    middle, level, first = np.zeros((most, 3)), np.zeros(most, dtype=np.int8), np.full(most, -1, dtype=np.int32)
    across, waiting, out = across_of_one_box(most), *np.empty((2, 3 * most), dtype=np.int32)
    count = 1
    while count + 8 <= most:
        leaves = np.flatnonzero(first[:count] < 0)
        neighbour_leaves(rng.choice(leaves), middle, level, first, across, waiting, out)  # kept for the next time
        coarse = leaves[level[leaves] < rng.integers(1, 10)]
        add_octants(rng.choice(coarse if len(coarse) else leaves), middle, level, first, across, count)
        count += 8
    leaves = np.flatnonzero(first[:count] < 0)
    low, high = (middle[leaves] + sign * 0.5 ** level[leaves][:, None] for sign in (-1, 1))
    for k in rng.choice(len(leaves), 300, replace=False):
        expected: set[int] = set()
        for lap in (-2.0, 0.0, 2.0):  # the turn closes on itself
            shift = np.array([0.0, 0.0, lap])
            shared = np.minimum(high[k] + shift, high) - np.maximum(low[k] + shift, low)
            face = (np.sort(shared, axis=1)[:, 0] == 0) & (np.sort(shared, axis=1)[:, 1] > 0)
            expected |= set(leaves[face].tolist())
        found = neighbour_leaves(leaves[k], middle, level, first, across, waiting, out)
        assert set(out[:found].tolist()) == expected
