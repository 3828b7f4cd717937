"""Exact slices against closed forms and the independent slices of the oracle; where the middle of a round body gets."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from benchmarks.attack import drawing
from scipy import ndimage

from tests.oracle.closed_forms import rectangle_turn_limit, square_turn_limit
from tests.oracle.random_joints import peg_pair, tab_pair
from tests.oracle.slices import Slices
from wiggleroom.freespace.slices import pair_outlines, slice_near, slice_sequence
from wiggleroom.freespace.subdivision.round_room import furthest_along, round_body, way_along
from wiggleroom.geometry.offset_walls import CHORD_ANGLE, inner_offset
from wiggleroom.geometry.outer_simplification import simplified_inward

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


# -- where the middle of a round body gets ---------------------------------------------------------------------------


def star(rng: np.random.Generator) -> shapely.Polygon:
    """A polygon with corners at random round the origin."""
    count = rng.integers(3, 12)
    angle, radius = np.sort(rng.uniform(0, 2 * np.pi, count)), rng.uniform(0.2, 1, count)
    return shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def test_walls_made_thicker_hold_what_is_nearer_than_the_radius():
    rng, looked = np.random.default_rng(0), 0
    for _ in range(200):
        wall, radius = star(rng), rng.uniform(0.01, 1)
        places = rng.uniform(-2, 2, (2000, 2))
        if not wall.is_valid:
            continue
        looked += 1
        inside = shapely.contains_xy(inner_offset(wall, radius), places)
        apart = shapely.distance(wall, shapely.points(places))
        assert not (inside & (apart > radius)).any()
        assert inside[apart < radius * np.cos(CHORD_ANGLE / 2) - 1e-9].all()
    assert looked > 150


def test_walls_are_simplified_inward():
    room = shapely.buffer(shapely.LineString([(0, 0), (-0.6, 0), (-0.6, 0.7), (0.8, 0.7)]), 0.22, quad_segs=200)
    wall = shapely.union_all([drawing.cut(drawing.box(-2, -2, 2, 2), room), drawing.disc(0.05, 700, (-0.4, 0.35))])
    fewer = simplified_inward(wall, 0.02, 4e-4, np.zeros((0, 2)), 2e-6)
    assert shapely.get_num_coordinates(fewer) < shapely.get_num_coordinates(wall) / 4
    assert shapely.area(shapely.difference(fewer, wall)) < 1e-12
    assert shapely.hausdorff_distance(shapely.boundary(fewer), shapely.boundary(wall), densify=0.01) < 4.1e-4


def rooms(seed: int) -> tuple[shapely.Geometry, shapely.Polygon, np.ndarray, float] | None:
    """Walls round a random channel with a wider place and perhaps an island, a round body in it, a direction, and the clearance."""
    rng = np.random.default_rng([seed, 5])
    radius, heading, points = rng.uniform(0.15, 0.4), rng.uniform(0, 2 * np.pi), [np.zeros(2)]
    gap = radius * float(rng.choice([0.04, 0.1, 0.2]))
    for _ in range(int(rng.integers(1, 5))):
        heading += rng.uniform(-2, 2)
        points.append(points[-1] + rng.uniform(0.2, 1.4) * np.array([np.cos(heading), np.sin(heading)]))
    room = shapely.buffer(shapely.LineString(points), radius + gap, quad_segs=int(rng.choice([2, 8, 60])))
    wide = points[int(rng.integers(1, len(points)))]
    room = shapely.union(room, drawing.disc(rng.uniform(1.5, 4) * radius, 20, wide))
    if rng.random() < 0.6:
        room = shapely.difference(room, drawing.disc(rng.uniform(0.1, 1) * radius, 12, wide + rng.normal(0, 0.1, 2)))
    x0, y0, x1, y1 = shapely.bounds(room)
    walls = drawing.cut(drawing.box(x0 - 0.4, y0 - 0.4, x1 + 0.4, y1 + 0.4), room)
    body = drawing.disc(radius, int(rng.choice([12, 24, 80, 300])), phase=rng.uniform(0, 1))
    angle = rng.uniform(0, 2 * np.pi)
    return (walls, body, np.array([np.cos(angle), np.sin(angle)]), gap) if not walls.intersects(body) else None


@pytest.mark.parametrize("seed", range(6))
def test_the_bound_holds_on_a_grid_and_the_way_is_free(seed):
    made = rooms(seed)
    if made is None:
        pytest.skip("the island lies on the body")
    walls, material, pull, gap = made
    body = round_body(material, walls, gap)
    if body is None:
        assert 0.4 * (1 - np.cos(np.pi / 12)) > gap / 2  # the body is not round to the clearance
        pytest.skip("not round")
    step = 0.01
    x0, y0, x1, y1 = shapely.bounds(walls)
    x, y = (np.arange(-np.ceil((m - low) / step), np.ceil((high - m) / step) + 1) * step + m
            for m, low, high in zip(body.middle, (x0, y0), (x1, y1), strict=True))  # fmt: skip
    place = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
    apart = shapely.distance(walls, shapely.points(place))
    rest = tuple(np.rint((body.middle - (x[0], y[0])) / step).astype(int))

    def reached(radius: float, neighbours: np.ndarray | None) -> float:
        """Furthest place that the middle of a disc reaches on the grid from rest; it stays free on the way from place to place."""
        label, _ = ndimage.label(apart >= radius, structure=neighbours)
        among = label == label[rest] if label[rest] else np.zeros_like(label, dtype=bool)
        return float(((place - body.middle) @ pull)[among].max(initial=-np.inf))

    certain = reached(body.inner + step / 2, None)
    possible = reached(body.inner - 0.71 * step, np.ones((3, 3))) + 0.71 * step
    bound = furthest_along(body, walls, pull, gap)
    assert bound is not None
    assert certain <= bound <= possible + 1e-6
    way = way_along(body, walls, pull, gap)
    if way is not None:
        assert way[0] == pytest.approx(body.middle)
        assert (way[-1] - body.middle) @ pull <= bound
        assert min(shapely.distance(walls, shapely.LineString(piece)) for piece in pairwise(way)) > body.outer
    certain = reached(body.outer + 0.03 * gap + step / 2, None)
    assert certain == -np.inf or (way is not None and (way[-1] - body.middle) @ pull >= certain)
