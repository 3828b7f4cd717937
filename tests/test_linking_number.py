"""Linked bodies, against crossings counted in a projection, and against chains that can be opened."""

import itertools
import json

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.drawing.model import Pull
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.proof.linking_number import CurveGraph, closed_curves, linking_numbers, piece_graph
from wiggleroom.spatial.solids.convex import convex_piece, cuboid
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial
from wiggleroom.verdict import Certainty, Separability


def closed(points):
    points = np.asarray(points, dtype=float)
    return CurveGraph(
        np.stack([points, np.roll(points, -1, axis=0)], axis=1), np.ones((1, len(points)), dtype=np.int64)
    )


def crossings(one, other):
    """Half the signed crossings of two closed polygons seen along z."""
    total = 0
    for a, b in zip(one, np.roll(one, -1, axis=0), strict=True):
        for c, d in zip(other, np.roll(other, -1, axis=0), strict=True):
            A = np.column_stack([(b - a)[:2], -(d - c)[:2]])
            s, t = np.linalg.solve(A, (c - a)[:2])
            if 0 < s < 1 and 0 < t < 1:
                above = (a + s * (b - a))[2] - (c + t * (d - c))[2]
                total += int(np.sign(above) * np.sign(np.linalg.det(np.column_stack([(d - c)[:2], (b - a)[:2]]))))
    return total / 2


@pytest.mark.parametrize("seed", range(6))
def test_a_linking_number_counts_crossings(seed):
    draw = np.random.default_rng(seed)
    one, other = draw.normal(size=(2, 12, 3))
    found = linking_numbers(closed(one), closed(other))[0, 0]
    assert abs(found) == pytest.approx(abs(crossings(one, other)), abs=1e-9)


def torus(middle, axes, sides=12, radius=10.0, thick=2.0, open_by=0):
    """Convex pieces of a ring of square section; without some of them it is open."""
    pieces = []
    angles = 2 * np.pi * np.arange(sides + 1) / sides
    for t0, t1 in itertools.pairwise(angles[: sides + 1 - open_by]):
        corners = [
            np.array([r * np.cos(t), r * np.sin(t), z])
            for t in (t0, t1)
            for r in (radius - thick, radius + thick)
            for z in (-thick, thick)
        ]
        pieces.append(convex_piece(np.array(corners) @ np.asarray(axes, dtype=float) + middle))
    return pieces


def inner_curves(pieces):
    return closed_curves(pieces, piece_graph(pieces))


FLAT, UPRIGHT = np.eye(3), np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0]])


@pytest.mark.parametrize(
    ("shift", "open_by", "number"), [(10.0, 0, 1), (25.0, 0, 0), (10.0, 1, None)], ids=["linked", "beside", "open"]
)
def test_rings_of_convex_pieces(shift, open_by, number):
    one = inner_curves(torus(np.zeros(3), FLAT))
    other = inner_curves(torus(np.array([shift, 0, 0]), UPRIGHT, open_by=open_by))
    assert one.cycles.shape[0] == 1
    if number is None:
        assert not len(other.cycles)
    else:
        assert abs(linking_numbers(one, other)[0, 0]) == pytest.approx(number, abs=1e-9)


def link(name, centre, upright, opening=0.0, **more):
    bars = [(-12, -7.5, 12, -3.5), (-12, -3.5, -8, 3.5), (8, -3.5, 12, 3.5)]
    bars += [(-12, 3.5, 12, 7.5)] if not opening else [(-12, 3.5, -opening / 2, 7.5), (opening / 2, 3.5, 12, 7.5)]
    boxes = [[x0, -2, y0, x1, 2, y1] if upright else [x0, y0, -2, x1, y1, 2] for x0, y0, x1, y1 in bars]
    return {"name": name, "boxes": boxes, "at": [centre, 0, 0], **more}


def chain(opening=0.0, **more):
    parts = [link(f"link{k}", 14 * k, k % 2 == 1, opening if k == 2 else 0.0) for k in range(4)]
    parts[0]["fixed"] = True
    return assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "gap": 0.2, "parts": parts, **more})))


def test_a_chain_is_interlocked():
    found = check_spatial(chain())
    assert (found.verdict, found.certainty) == (Separability.INTERLOCKED, Certainty.PROVEN)
    assert found.questions == 0


def test_a_chain_holds_until_its_bars_are_gone():
    found = wr.largest_gap(chain())
    assert found.holds == pytest.approx(4.0, rel=1e-3)
    assert found.holds < 4
    assert found.parts_at is None


def test_what_may_pass_is_not_linked():
    assert wr.check(chain(ignore=[["link1", "link2"]]), seconds=20).verdict is not Separability.INTERLOCKED


def test_a_link_that_is_open_wide_enough_comes_off():
    found = wr.check(chain(opening=6.0), seconds=20)
    assert found.verdict is not Separability.INTERLOCKED


@pytest.mark.slow
def test_small_pieces_do_not_go_through_each_other_in_one_step():
    answer = flex_spatial(chain(), (Pull("link3", (1.0, 0.0, 0.0)),))
    assert answer.verdict == "optimal"
    straight, bar = (
        3 * 2.2,
        4.0,
    )  # links that tilt reach further than straight ones; a bar that went through would gain its width
    assert straight - 1e-6 <= answer.objective < straight + bar / 2


def test_curves_stay_inside_pieces_that_overlap():
    bars = [((0, 0, 0), (10, 2, 2)), ((0, 0, 0), (2, 8, 2)), ((8, 0, 0), (10, 8, 2)), ((0, 6, 0), (10, 8, 2))]
    graph = inner_curves([cuboid(*np.array(bar, dtype=float)) for bar in bars])
    assert len(graph.cycles) == 1
    for t in np.linspace(0, 1, 7):
        for x, y, z in graph.segments[:, 0] * (1 - t) + graph.segments[:, 1] * t:
            assert any(np.all((x, y, z) >= np.array(bar[0])) and np.all((x, y, z) <= np.array(bar[1])) for bar in bars)
