"""Boxes of motions that are said to be forbidden hold no free motion: looked at by drawing and by general polygon geometry."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import affinity

from wiggleroom.freespace.subdivision.box_search import search_boxes
from wiggleroom.freespace.subdivision.classify_box import FORBIDDEN
from wiggleroom.freespace.subdivision.disc_tree import solid
from wiggleroom.freespace.subdivision.passage import passage

INSIDE = 1e-9
"""What overlaps by no more than this lies beside each other."""


def flower(random: np.random.Generator, corners: int) -> shapely.Polygon:
    """A round outline with some waves, as a polygon of many corners."""
    angle = np.sort(random.uniform(0, 2 * np.pi, corners))
    waves = [(k, random.uniform(0, 0.6 / k), random.uniform(0, 6)) for k in (2, 3, 5)]
    radius = 3 + sum(size * np.cos(k * angle + begin) for k, size, begin in waves)
    return shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def socket(inner: shapely.Polygon, room: float, mouth: float) -> shapely.Geometry:
    """A plate with a hole round an outline, and a mouth through which it may come out."""
    plate = shapely.box(-6, -6, 6, 6) - inner.buffer(room, quad_segs=4)
    return shapely.get_parts(plate - shapely.box(-mouth, 0, mouth, 7)).tolist()[0]


@pytest.mark.parametrize("seed", range(12))
def test_forbidden_boxes_hold_no_free_motion(seed: int) -> None:
    random = np.random.default_rng(seed)
    inner = flower(random, int(random.integers(5, 90)))
    outer = socket(inner, random.uniform(0.02, 0.3), random.uniform(0.5, 3.2))
    a, b = solid(outer, np.zeros(2)), solid(inner, np.zeros(2))
    scale, most = np.array([1.1 * (a.radius + b.radius), np.pi]), 6000
    origin = np.array([0.0371, 0.0213, 0.0157]) * scale[[0, 0, 1]]
    middle, level = np.zeros((most, 3)), np.zeros(most, dtype=np.int64)
    state, first, upper = np.zeros(most, dtype=np.int64), np.full(most, -1), np.full(most, np.inf)
    asked = np.array([0.0, 0.0, 0.0, 0.0, 0.0, np.inf, np.inf])
    visits, path = np.array([0, np.iinfo(np.int64).max]), np.zeros(most, dtype=np.int64)
    _, count, _ = search_boxes(
        middle, level, state, first, upper, 1, most, origin, scale, 22, True, False, asked, 1, *a.arrays, b.edge, b.disc,
        b.kid, path, visits,
    )  # fmt: skip
    leaves = np.flatnonzero((state[:count] == FORBIDDEN) & (first[:count] < 0))
    assert len(leaves) > 100
    for n in random.choice(leaves, 400):
        half = 0.5 ** level[n]
        at = origin + (middle[n] + half * random.uniform(-1, 1, 3)) * scale[[0, 0, 1]]
        moved = affinity.translate(affinity.rotate(inner, at[2], origin=(0, 0), use_radians=True), at[0], at[1])
        assert shapely.area(shapely.intersection(moved, outer)) > INSIDE


@pytest.mark.parametrize("beyond", [-0.02, -0.002, 0.15])
def test_a_knob_leaves_its_socket_where_it_is_narrower_than_the_neck(beyond: float) -> None:
    """A disc of many corners in a round socket: the width of the mouth decides."""
    corners = np.exp(2j * np.pi * np.arange(120) / 120)
    disc = shapely.Polygon(np.column_stack([corners.real, corners.imag]))
    hole = shapely.Polygon(1.08 * np.column_stack([corners.real, corners.imag]))
    mouth = np.cos(np.pi / 120) + beyond  # half the width between flats
    plate = shapely.box(-2, -2, 2, 2) - hole - shapely.box(-mouth, 0, mouth, 3)
    found = passage(plate, disc, most=60_000)
    assert found.closed == (beyond < 0)
    assert (found.path is None) == (beyond < 0)
