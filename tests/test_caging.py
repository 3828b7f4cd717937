"""Bodies in cages, against a flood over points that shares nothing with the proof."""

import itertools
import json

import numpy as np
import pytest
from scipy import ndimage

from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.proof.caging import ball_stays, in_closed_cavity
from wiggleroom.spatial.proof.inscribed_ball import inscribed_ball
from wiggleroom.spatial.solids.convex import convex_piece, cuboid
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.verdict import Certainty, Separability


def spatial(*parts, gap=0.1):
    return assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "gap": gap, "parts": list(parts)})))


def cage(window, side=10.0, wall=1.0):
    """Boxes of the twelve edges of a cube round the origin; every side is a square window."""
    s, w = side / 2 + wall, window / 2
    boxes = []
    for axis in range(3):
        for one, other in itertools.product((-1, 1), repeat=2):
            low, high = np.full(3, -s), np.full(3, s)
            for k, sign in zip([k for k in range(3) if k != axis], (one, other), strict=True):
                low[k], high[k] = (w, s) if sign > 0 else (-s, -w)
            boxes.append((low, high))
    return boxes


def escapes(boxes, radius, step=0.25):
    """True where a ball gets out of boxes by short steps from point to point, in all of which it stays apart from them."""
    reach = max(np.abs(b).max() for b in boxes) + 1.5 * radius
    axis = np.arange(-np.ceil(reach / step), np.ceil(reach / step) + 1) * step
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    free = np.ones(points.shape[:3], dtype=bool)
    for low, high in boxes:
        away = np.maximum(np.maximum(low - points, points - high), 0)
        free &= np.linalg.norm(away, axis=-1) > radius + step / 2
    regions, _ = ndimage.label(free)
    middle = len(axis) // 2
    return regions[middle, middle, middle] == regions[0, 0, 0] > 0


@pytest.mark.slow
@pytest.mark.parametrize(("window", "stays"), [(5.5, True), (6.5, False)])
def test_a_ball_stays_behind_windows_that_are_too_narrow(window, stays):
    boxes = cage(window)
    assert escapes(boxes, 3.0) is not stays
    assert ball_stays([cuboid(low, high) for low, high in boxes], np.zeros(3), 3.0) is stays


@pytest.mark.parametrize("seed", range(3))
def test_nothing_stays_that_gets_out(seed):
    draw = np.random.default_rng(seed)
    boxes = []
    for _ in range(60):
        towards = draw.normal(size=3)
        middle = 4.5 * towards / np.linalg.norm(towards)
        half = draw.uniform(0.4, 1.6, size=3)
        boxes.append((middle - half, middle + half))
    radius = float(draw.uniform(0.5, 1.5))
    if ball_stays([cuboid(low, high) for low, high in boxes], np.zeros(3), radius):
        assert not escapes(boxes, radius)


def test_the_largest_ball_of_a_tetrahedron_is_its_insphere():
    corners = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    middle, radius = inscribed_ball(convex_piece(corners))
    assert middle == pytest.approx(np.zeros(3), abs=1e-9)
    assert radius == pytest.approx(1 / np.sqrt(3), rel=1e-9)


def test_a_well_is_no_cavity():
    corners = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    apart = Surface(np.vstack([2 * corners, corners + np.array([5, 0, 0])]), np.vstack([faces, faces + 6]))
    assert not in_closed_cavity(apart, np.array([[5.0, 0.1, 0.1], [0.3, 0.2, 0.1]]))


def crate(window):
    """A cubic crate, 10 wide, with a square window in every wall."""
    boxes = []
    w = window / 2
    for axis, sign in itertools.product(range(3), (-1, 1)):
        for low, high in (([-5, -5], [5, -w]), ([-5, w], [5, 5]), ([-5, -w], [-w, w]), ([w, -w], [5, w])):
            one, other = np.insert(np.array([low, high], dtype=float), axis, np.sort([4.0 * sign, 5.0 * sign]), axis=1)
            boxes.append([*one, *other])
    return {"name": "crate", "boxes": boxes, "fixed": True}


BLOCK = {"name": "block", "boxes": [[-3, -3, -3, 3, 3, 3]]}


@pytest.mark.parametrize(("window", "verdict"), [(5.0, Separability.INTERLOCKED), (6.5, Separability.COMES_APART)])
def test_a_block_in_a_crate(window, verdict):
    found = check_spatial(spatial(crate(window), BLOCK))
    assert (found.verdict, found.certainty) == (verdict, Certainty.PROVEN)


def test_who_passes_the_walls_is_not_caged():
    drawn = {"format": "wiggleroom/2", "gap": 0.1, "parts": [crate(5.0), BLOCK], "ignore": [["crate", "block"]]}
    found = check_spatial(assemble_spatial(read_spatial(json.dumps(drawn))))
    assert found.verdict is Separability.COMES_APART


def test_pieces_that_are_apart_hold_no_ball():
    one, other = (cuboid(np.array([x, 0.0, 0.0]), np.array([x + 1, 1.0, 1.0])) for x in (0.0, 3.0))
    assert inscribed_ball(one, other)[1] == pytest.approx(-1.0)


def test_some_random_cages_are_closed():
    draw = np.random.default_rng(5)
    towards = draw.normal(size=(80, 3))
    boxes = [cuboid(m - 1.5, m + 1.5) for m in 4.5 * towards / np.linalg.norm(towards, axis=1)[:, None]]
    assert ball_stays(boxes, np.zeros(3), 1.2)
    assert not ball_stays(boxes[:10], np.zeros(3), 1.2)
