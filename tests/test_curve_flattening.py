"""Flattening: the bound holds, chords are few, and whoever draws a curve gets the same points."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from wiggleroom.drawing.strokes.curves import Arcs, flatten_arcs, flatten_cubics
from wiggleroom.drawing.strokes.flatten import Curved
from wiggleroom.drawing.strokes.pathdata import arc_between, parse_path
from wiggleroom.drawing.strokes.strokes import mapped
from wiggleroom.drawing.strokes.transforms import Affine

SAME = Affine()
coordinate = st.floats(-100, 100, allow_subnormal=False)
points4 = st.lists(st.builds(complex, coordinate, coordinate), min_size=4, max_size=4)


def distance_to_chords(samples: np.ndarray, chain: np.ndarray) -> np.ndarray:
    """Distance of complex samples from the nearest chord of a chain."""
    start, step = chain[:-1], np.diff(chain)
    along = ((samples[:, None] - start) * np.conj(step)).real / np.maximum(np.abs(step) ** 2, 1e-300)
    return np.abs(samples[:, None] - start - np.clip(along, 0, 1) * step).min(axis=1)


def bezier(control: np.ndarray, t: np.ndarray) -> np.ndarray:
    """De Casteljau, as a second way."""
    layer = [np.full(t.shape, point) for point in control]
    while len(layer) > 1:
        layer = [a + t * (b - a) for a, b in itertools.pairwise(layer)]
    return layer[0]


@settings(max_examples=80, deadline=None)
@given(points4, st.sampled_from([0.01, 0.1, 3.0]))
def test_cubic_stays_within_the_bound(control, tolerance):
    control = np.array(control)
    inner = flatten_cubics(control[None], tolerance)[0]
    chain = np.concatenate([control[:1], inner, control[3:]])
    samples = bezier(control, np.linspace(0, 1, 1000))
    assert distance_to_chords(samples, chain).max() <= tolerance * (1 + 1e-6) + 1e-9


@settings(max_examples=80, deadline=None)
@given(points4, st.sampled_from([0.01, 0.5]))
def test_reversed_cubic_has_the_same_points(control, tolerance):
    assume(control != control[::-1])  # there and back on one way: its reverse is the curve itself
    control = np.array([control, control[::-1]])
    there, back = flatten_cubics(control, tolerance)
    assert there.tolist() == back[::-1].tolist()
    assert flatten_cubics(control[1:], tolerance)[0].tolist() == back.tolist()


def test_chords_are_few():
    """No way of placing chords needs fewer than taking the longest one that is allowed each time."""
    rng = np.random.default_rng(1)
    ours = least = 0
    for control in rng.normal(size=(20, 4, 2)) @ [10, 10j]:
        ours += len(flatten_cubics(control[None], 0.01)[0]) + 1
        t = np.linspace(0, 1, 4001)
        samples, here = bezier(control, t), 0
        while here < 4000:
            low, high = here + 1, 4000
            while low < high:
                middle = (low + high + 1) // 2
                away = distance_to_chords(samples[here : middle + 1], samples[[here, middle]]).max()
                low, high = (middle, high) if away <= 0.01 else (low, middle - 1)
            here, least = low, least + 1
    assert ours <= 1.08 * least


@pytest.mark.parametrize("control", [[0, 1, 2, 3], [0, 0, 3, 3], [1 + 1j] * 4, [0, 2 + 2j, 1 + 1j, 3 + 3j]])
def test_straight_cubic_has_no_corners(control):
    assert flatten_cubics(np.array([control], dtype=complex), 1e-6)[0].size == 0


def test_circle_needs_as_many_chords_as_theory_says():
    circle = Arcs(*(np.array([value]) for value in (2j, 5 + 0j, 5j, 0.0, 2 * np.pi)))
    inner = flatten_arcs(circle, 0.01, np.array([False]))[0]
    needed = np.pi / np.arccos(1 - 0.01 / 5)
    assert needed <= len(inner) + 1 <= needed + 4
    assert (len(inner) + 1) % 4 == 0
    np.testing.assert_allclose(np.abs(inner - 2j), 5, rtol=1e-14)


def corners(data: str, matrix: Affine = SAME, tolerance: float = 0.01) -> np.ndarray:
    curved = Curved()
    curved.add(mapped(parse_path(data)[0], matrix))
    return curved.corners(tolerance)[0]


@pytest.mark.parametrize("matrix", [Affine(), Affine(1, 0.3, -0.8, 2, 5, 7), Affine(0.5, 0, 0, -3)])
def test_arc_and_its_reverse(matrix):
    there = corners("M3 4A7 3 25 1 0 9 5z", matrix)
    back = corners("M9 5A7 3 25 1 1 3 4z", matrix)
    assert there.tolist() == back[::-1].tolist()
    assert len(there) > 10


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("sweep", [False, True])
def test_arc_flags(large, sweep):
    """Against the ellipse's own equation, the turning sense and the share of the way round."""
    start, end, rx, ry, turn = 1 + 2j, 4 + 3j, 3.0, 2.0, 0.4
    arc = arc_between(start, end, rx, ry, turn, large, sweep)
    angles = arc.start + arc.sweep * np.linspace(0, 1, 9)
    points = arc.centre + arc.u * np.cos(angles) + arc.v * np.sin(angles)
    points = points[::-1] if arc.flipped else points
    np.testing.assert_allclose([points[0], points[-1]], [start, end], atol=1e-12)
    flat = (points - arc.centre) * np.exp(-1j * turn)
    np.testing.assert_allclose((flat.real / rx) ** 2 + (flat.imag / ry) ** 2, 1, atol=1e-12)
    assert (abs(arc.sweep) > np.pi) == large
    assert ((np.conj(points[0] - arc.centre) * (points[1] - arc.centre)).imag > 0) == sweep


@pytest.mark.parametrize(
    ("data", "same"),
    [
        ("M1 1h4v4h-4z", "M1,1L5,1L5,5L1,5Z"),
        ("m1 1 4 0 0 4-4 0z", "M1,1L5,1L5,5L1,5Z"),
        ("M0 0q2 4 4 0t4 0z", "M0 0Q2 4 4 0Q6-4 8 0z"),
        ("M0 0c0 2 4 2 4 0s4-2 4 0z", "M0 0C0 2 4 2 4 0C4-2 8-2 8 0z"),
        ("M0 0Q2 4 4 0S6 4 8 0z", "M0 0Q2 4 4 0C4 0 6 4 8 0z"),
        ("M0 0C0 2 4 2 4 0T8 2L8 0z", "M0 0C0 2 4 2 4 0L8 2L8 0z"),
        ("M0 0a2 1 0 0110 10z", "M0 0A2 1 0 0 1 10 10z"),
        ("M0 0A0 5 0 0 1 4 0L4 4z", "M0 0L4 0L4 4z"),
        ("M.5.5L1e1,.5 1E+1 3.e0z", "M0.5 0.5L10 0.5L10 3z"),
    ],
)
def test_path_commands(data, same):
    np.testing.assert_allclose(corners(data), corners(same), atol=1e-13)


def test_circle_drawn_in_halves_and_quarters():
    whole = corners("M5 0A5 5 0 0 1 -5 0A5 5 0 0 1 5 0z")[:-1]
    quarters = corners("M5 0A5 5 0 0 1 0 5A5 5 0 0 1 -5 0A5 5 0 0 1 0 -5A5 5 0 0 1 5 0z")[:-1]
    np.testing.assert_allclose(whole, quarters, atol=1e-13)


def test_radii_too_small_grow():
    np.testing.assert_allclose(corners("M0 0A1 1 0 0 1 10 0z"), corners("M0 0A5 5 0 0 1 10 0z"), atol=1e-14)


def test_subpath_after_close_starts_where_the_last_one_did():
    first, second = parse_path("M1 1h4v4zl-1 0 0-1z")
    assert second.start == first.start == 1 + 1j


def test_there_and_back_reaches_the_turning_point():
    inner = flatten_cubics(np.array([[0, 10, 10, 0]], dtype=complex), 0.01)[0]
    assert inner.real.max() == pytest.approx(7.5, abs=0.01)
