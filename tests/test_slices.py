"""Exact slices against closed forms and against the independent slices of the oracle."""

import numpy as np
import pytest
import shapely

from tests.oracle.closed_forms import rectangle_turn_limit, square_turn_limit
from tests.oracle.random_joints import peg_pair, tab_pair
from tests.oracle.slices import Slices
from wiggleroom.freespace.slices import pair_outlines, slice_near, slice_sequence

REST = shapely.Point(0, 0)


def frame(width, height, wall=1.0):
    return shapely.box(-width / 2 - wall, -height / 2 - wall, width / 2 + wall, height / 2 + wall).difference(
        shapely.box(-width / 2, -height / 2, width / 2, height / 2)
    )


def block(width, height):
    return shapely.box(-width / 2, -height / 2, width / 2, height / 2)


@pytest.mark.parametrize("phi", [0.0, 0.02, -0.05, 0.09])
def test_a_square_peg_is_free_in_a_square_that_shrinks_with_the_turn(phi):
    found = slice_near(pair_outlines(frame(1.1, 1.1), block(1, 1)), phi, REST)
    side = 1.1 - np.cos(phi) - abs(np.sin(phi))
    assert found.closed
    assert found.area == pytest.approx(side**2, abs=1e-14)
    assert np.allclose(found.region.bounds, [-side / 2, -side / 2, side / 2, side / 2], atol=1e-14)


def test_the_march_ends_where_the_peg_no_longer_fits():
    assert np.allclose(
        slice_sequence(pair_outlines(frame(1.1, 1.1), block(1, 1)), 1.0).ends,
        square_turn_limit(1, 0.05) * np.array([-1, 1]),
        atol=2e-7,
    )
    slot = slice_sequence(pair_outlines(frame(3.6, 1.1), block(3, 1)), 1.0)
    assert slot.ends[1] == pytest.approx(rectangle_turn_limit(3, 1, 0.3, 0.05), abs=2e-7)
    assert slot.limit == np.inf


@pytest.mark.parametrize("pair", [tab_pair(3), tab_pair(5, holes=True), peg_pair(0), peg_pair(3, holes=True)])
def test_random_pairs_agree_with_the_oracle(pair):
    A, B, D = pair.local()
    truth = Slices(A, B, D)
    pivot = np.asarray(D)
    own = slice_sequence(pair_outlines(shapely.transform(A, lambda p: p - pivot), B), 0.1)
    assert np.allclose(own.ends, [truth.low, truth.high], atol=2e-7)
    for phi in np.linspace(truth.low, truth.high, 9)[1:-1]:
        exact = shapely.union_all(truth.at(float(phi)))
        assert shapely.area(shapely.symmetric_difference(own.at(float(phi)).region, exact)) < 1e-9 * exact.area


def test_a_bolt_that_turns_out_of_its_keyhole_is_open():
    """A bar that fits through a slot only when turned a quarter: closed at rest, open later."""
    head = shapely.box(-0.4, -0.1, 0.4, 0.1)
    hole = shapely.Polygon(np.column_stack([np.cos(t := np.linspace(0, 2 * np.pi, 41)[:-1]), np.sin(t)]) * 0.45)
    keyhole = shapely.box(-1, -1, 1, 1).difference(hole).difference(shapely.box(-0.15, 0, 0.15, 2))
    found = slice_sequence(pair_outlines(keyhole, head), 0.1)
    assert found.limit == 0.1
    assert found.full
    assert slice_near(pair_outlines(keyhole, head), 0.0, REST).closed


def test_a_square_that_touches_nothing_turns_all_the_way():
    found = slice_sequence(pair_outlines(block(1, 1), shapely.box(2.5, -0.5, 3.5, 0.5)), 0.2)
    assert found.full
    assert found.limit == 0.2
    assert all(s.area == pytest.approx(0.16) for s in found.slices[:2])


def test_rest_without_room_is_refused():
    with pytest.raises(ValueError, match="not free"):
        slice_sequence(pair_outlines(frame(1, 1), block(1.1, 1.1)), 0.1)


def test_many_corners_have_the_closed_form():
    """Ring and disc of 400 corners: 160,000 edge pairs, of which the window leaves few."""
    t = 2 * np.pi * np.arange(400) / 400
    disc = np.column_stack([np.cos(t), np.sin(t)])
    ring = shapely.box(-2, -2, 2, 2).difference(shapely.Polygon(1.02 * disc))
    pair = pair_outlines(ring, shapely.Polygon(disc))
    found = slice_near(pair, np.pi / 400, REST)
    assert found.closed
    assert found.area == pytest.approx(np.pi * 0.02**2, rel=0.02)


def test_symmetric_pairs_have_symmetric_slices():
    found = slice_sequence(pair_outlines(frame(1.2, 1.1), block(1, 1)), 1.0)
    assert found.ends[0] == pytest.approx(-found.ends[1], abs=2e-7)
    for phi in (0.01, 0.05):
        assert found.at(phi).area == pytest.approx(found.at(-phi).area, rel=1e-12)
