"""Least gaps of near parts against closed forms and exhaustive search, in the plane and in space."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Boxes, Drawing, Part, Plate, Region, Surface
from wiggleroom.errors import InputError
from wiggleroom.spatial.solids.solid_boolean import surface_of
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

TOP = Path(__file__).parents[1]
SHEET = TOP / "tests" / "sheets" / "egg_crate_even.svg"
WALL = [(0, 0), (48, 0), (48, 40), (51.5, 40), (51.5, 0), (100, 0), (100, 60), (0, 60)]


def region(outer, *holes):
    return Region(np.array(outer, float), tuple(np.array(hole, float) for hole in holes))


def box(x, y, wide, high):
    return [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)]


def polygon(radius, corners=96, turn=0.0):
    angle = turn + 2 * np.pi * np.arange(corners) / corners
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def planar(*parts, gap=0.0, **stated):
    drawn = tuple(Part(name, (r,), at) for name, r, *at in ((n, r, *(a or (0.0, 0.0, 0.0))) for n, r, a in parts))
    return assemble(Drawing(drawn, gap=gap, **stated), overlapping=True)


def cuboids(*boxes):
    return assemble_spatial(
        Drawing(tuple(Part(n, (), solid=Boxes(np.array(b, float).reshape(1, 2, 3))) for n, b in boxes))
    )


def by_name(found):
    names = found.assembly.names
    return {tuple(names[k] for k in pair): n for n, pair in enumerate(found.pairs.tolist())}


def test_boxes_apart_touching_and_in_each_other():
    found = wr.clearances(
        planar(
            ("a", region(box(0, 0, 10, 10)), ()),
            ("right", region(box(10.3, 2, 5, 5)), ()),
            ("above", region(box(3, 10, 4, 5)), ()),
            ("in", region(box(-4, 3, 4.2, 4)), ()),
            ("far", region(box(11, -20, 5, 5)), ()),
        ),
        within=1.0,
    )
    at = by_name(found)
    assert set(at) == {("a", "right"), ("a", "above"), ("a", "in")}
    assert found.gap[at["a", "in"]] == pytest.approx(-0.2)
    assert found.gap[at["a", "above"]] == 0
    assert found.gap[at["a", "right"]] == pytest.approx(0.3)
    assert found.direction[at["a", "in"]] == pytest.approx([-1, 0])
    assert found.direction[at["a", "above"]] == pytest.approx([0, 1])
    assert found.direction[at["a", "right"]] == pytest.approx([1, 0])
    assert found.at[at["a", "in"]] == pytest.approx([0.1, 5])
    assert found.at[at["a", "above"]] == pytest.approx([5, 10])
    assert found.at[at["a", "right"]][0] == pytest.approx(10.15)
    assert found.gap.tolist() == sorted(found.gap.tolist())


@pytest.mark.parametrize("seed", range(2))
def test_random_polygons_against_all_pairs_of_edges(seed):
    rng = np.random.default_rng(seed)
    stars = [polygon(1, 9) * rng.uniform(0.4, 1.0, (9, 1)) for _ in range(30)]
    places = rng.uniform(0, 12, (30, 2))
    parts = [(f"p{k}", region(star), (x, y, 0.3)) for k, (star, (x, y)) in enumerate(zip(stars, places, strict=True))]
    assembly = planar(*parts)
    found = wr.clearances(assembly, within=0.5)
    turn = np.array([[math.cos(0.3), math.sin(0.3)], [-math.sin(0.3), math.cos(0.3)]])
    rings = [star @ turn + place for star, place in zip(stars, places, strict=True)]
    least = {
        (f"p{a}", f"p{b}"): _least(rings[a], rings[b])
        for a in range(30)
        for b in range(a)
        if shapely.Polygon(rings[a]).intersection(shapely.Polygon(rings[b])).area == 0
    }
    apart = {pair: k for pair, k in by_name(found).items() if found.gap[k] >= 0}
    assert len(apart) > 5
    assert {tuple(sorted(pair)) for pair in apart} == {tuple(sorted(p)) for p, d in least.items() if d <= 0.5}
    for (a, b), k in apart.items():
        assert found.gap[k] == pytest.approx(least.get((a, b), least.get((b, a))), abs=1e-12)
        ends = [found.at[k] + sign * found.gap[k] / 2 * found.direction[k] for sign in (-1, 1)]
        for name, end in zip((a, b), ends, strict=True):
            assert _to_edges(end[None], rings[int(name[1:])]) < 1e-9


def _least(P, Q):
    """Least distance of two rings that do not cross: a corner of one and an edge of the other."""
    return min(_to_edges(P, Q), _to_edges(Q, P))


def _to_edges(points, ring):
    start, along = ring, np.roll(ring, -1, axis=0) - ring
    t = np.clip(((points[:, None] - start) * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
    return float(np.linalg.norm(points[:, None] - start - t[..., None] * along, axis=2).min())


@pytest.mark.parametrize(("wide", "offset"), [(3.8, -0.075), (3.5, 0.0), (3.1, 0.1)])
def test_a_divider_in_a_slot(wide, offset):
    divider = region(box(49.75 - wide / 2, -20, wide, 59.8))
    found = wr.clearances(planar(("wall", region(WALL), ()), ("divider", divider, ())))
    assert found.offset == pytest.approx(offset, abs=1e-9)
    assert found.gap[0] == pytest.approx(2 * offset, abs=1e-9)
    assert found.kerf == (pytest.approx(0.15, abs=1e-9) if offset < 0 else None)
    assert found.binding.tolist() == [[0, 1]]


def test_a_peg_off_the_middle_of_its_hole_and_one_larger_than_it():
    plate = region(box(-20, -20, 40, 40), box(-5, -5, 10, 10)[::-1])
    off = wr.clearances(planar(("plate", plate, ()), ("peg", region(box(-4.9, -4.9, 9.8, 9.8)), (0.06, 0.0, 0.0))))
    assert off.gap[0] == pytest.approx(0.04)
    assert off.offset == pytest.approx(0.02)
    large = wr.clearances(planar(("plate", plate, ()), ("peg", region(box(-5.15, -5.15, 10.3, 10.3)), ())))
    assert large.gap[0] == pytest.approx(-0.15, abs=1e-6)
    assert large.offset == pytest.approx(-0.075, abs=1e-9)


def test_corners_are_mitred_as_those_of_a_gap_are():
    """A corner that points at a side moves further than the side does, by the square root of two."""
    square = region(box(-2, -2, 4, 4))
    found = wr.clearances(
        planar(
            ("side", region(box(-10, -3, 20, 3)), ()), ("corner", square, (0.0, 0.3 + 2 * math.sqrt(2), math.pi / 4))
        ),
        within=1.0,
    )
    assert found.gap[0] == pytest.approx(0.3)
    assert found.offset == pytest.approx(0.3 / (1 + math.sqrt(2)))


@pytest.mark.parametrize("seed", range(2))
def test_the_offset_is_the_border_between_fitting_and_not(seed):
    """At the gap that the offset stands for, parts as made do not overlap; at one a little smaller they do."""
    rng = np.random.default_rng(seed)
    outlines = [polygon(1.02, 7, rng.uniform(0, 1)) * rng.uniform(0.85, 1.0, (7, 1)) for _ in range(16)]
    parts = [(f"p{k}", region(r), (1.8 * (k % 4), 1.8 * (k // 4), 0.0)) for k, r in enumerate(outlines)]
    assembly = planar(*parts)
    found = wr.clearances(assembly)
    assert found.offset is not None
    assert found.offset < 0
    assert wr.clearances(assemble(assembly.drawing, gap=-2 * found.offset + 2e-7)).gap.min() >= 0
    with pytest.raises(InputError, match="overlap"):
        assemble(assembly.drawing, gap=-2 * found.offset - 2e-6)


def test_glued_and_ignored_pairs_are_left_out_and_what_overlaps_at_every_offset_is_said():
    parts = [(name, region(box(x, 0, 4, 4)), ()) for name, x in (("a", 0), ("b", 3.9), ("c", 7.8))]
    found = wr.clearances(planar(*parts, glue=(("a", "b"),), ignore=(("b", "c"),)), within=0.1)
    assert len(found.gap) == 0
    inside = wr.clearances(planar(("a", region(box(0, 0, 4, 4)), ()), ("b", region(box(1, 1, 2, 2)), ())))
    assert inside.offset is None
    assert 'parts "a" and "b" overlap at every offset' in inside.why
    assert wr.clearances(planar(("a", region(box(0, 0, 4, 4)), ()))).why == "no two parts can meet"


def test_boxes_in_space():
    found = wr.clearances(
        cuboids(
            ("a", [0, 0, 0, 10, 10, 10]),
            ("right", [10.3, 2, 3, 15, 8, 9]),
            ("above", [2, 2, 10.2, 8, 8, 12]),
            ("beside", [0, -5, 0, 10, 0, 10]),
            ("in", [3, 9.8, 2, 7, 14, 8]),
            ("corner", [-5, -9, -5, -0.3, -0.4 - 5, -1.2]),
        ),
        within=1.5,
        xy=0.35,
        z=0.15,
    )
    at = by_name(found)
    expected = {
        ("a", "right"): (0.3, [1, 0, 0], [10.15, None, None], 0.3, math.inf, True),
        ("a", "above"): (0.2, [0, 0, 1], [None, None, 10.1], math.inf, math.inf, False),
        ("a", "beside"): (0.0, [0, -1, 0], [None, 0, None], 0.0, 0.0, True),
        ("a", "in"): (-0.2, [0, 1, 0], [5, 9.9, 5], -0.2, -0.2, True),
        ("beside", "corner"): (1.3, np.array([-0.3, -0.4, -1.2]) / 1.3, [-0.15, -5.2, -0.6], math.inf, math.inf, False),
    }
    assert set(at) == set(expected)
    for pair, (gap, direction, place, xy, z, near) in expected.items():
        k = at[pair]
        assert found.gap[k] == pytest.approx(gap, abs=1e-9)
        assert found.direction[k] == pytest.approx(direction, abs=1e-9)
        assert [x for x, y in zip(found.at[k], place, strict=True) if y is not None] == pytest.approx(
            [y for y in place if y is not None]
        )
        assert (found.xy[k], found.z[k]) == (pytest.approx(xy, abs=1e-9), pytest.approx(z, abs=1e-9))
        assert found.too_near[k] == near
    assert found.fused == (("a", "beside", "in"),)


def test_a_slope_is_measured_along_the_layers_and_across_them():
    """Two faces at 30 degrees to the layers, 0.3 mm apart: 0.3 / sin 30 at one height, 0.3 / cos 30 above each other."""
    tilt = math.radians(30)
    turn = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    lower = Boxes(np.array([[[-20.0, -5, -4], [20, 5, 0]]]))
    upper = Boxes(np.array([[[-20.0, -5, 0.3], [20, 5, 4]]]))
    parts = tuple(
        Part(name, (), solid=solid, R=turn, at=np.zeros(3)) for name, solid in (("lower", lower), ("upper", upper))
    )
    found = wr.clearances(assemble_spatial(Drawing(parts)), xy=1.0, z=1.0)
    assert found.gap[0] == pytest.approx(0.3)
    assert found.direction[0] == pytest.approx(turn[:, 2])
    assert found.xy[0] == pytest.approx(0.3 / math.sin(tilt), rel=1e-6)
    assert found.z[0] == pytest.approx(0.3 / math.cos(tilt), rel=1e-6)


def test_balls_and_a_ring_round_a_peg():
    from manifold3d import Manifold

    def mesh(name, solid):
        found = surface_of(solid)
        return Part(name, (), solid=Surface(found.vertices, found.faces), at=np.zeros(3), R=np.eye(3))

    def round_peg(radius):
        ring = Manifold.cylinder(10, 15, 15, 48, True) - Manifold.cylinder(12, 10, 10, 48, True)
        peg = Manifold.cylinder(20, radius, radius, 48, True)
        return wr.clearances(assemble_spatial(Drawing((mesh("ring", ring), mesh("peg", peg)))), within=1.0)

    facet = math.cos(math.pi / 48)
    assert round_peg(9.7).gap[0] == pytest.approx(0.3 * facet, abs=1e-6)
    tight = round_peg(10.15)
    assert tight.gap[0] == pytest.approx(-0.15 * facet, rel=1e-3)
    assert tight.direction[0] @ tight.at[0] < -9.9  # the peg leaves the wall inward
    ball = Manifold.sphere(10, 64)
    found = wr.clearances(
        assemble_spatial(Drawing((mesh("ball", ball), mesh("other", ball.translate((20.3, 0, 0)))))), within=1.0
    )
    assert found.gap[0] == pytest.approx(0.3, abs=1e-6)
    assert found.at[0] == pytest.approx([10.15, 0, 0], abs=1e-6)


def test_a_cutting_sheet_that_is_too_thick_says_by_how_much(command_output):
    code, out, _ = command_output("clearances", str(SHEET), "--thickness", "4.1", "--burn", "0", "--json", "-")
    found = json.loads(out)
    assert code == 0
    assert found["dimension"] == 3
    assert found["offset"] == pytest.approx(-0.05, abs=1e-5)
    assert found["kerf"] == pytest.approx(0.1, abs=2e-5)
    assert {round(pair["gap"], 4) for pair in found["pairs"]} == {-0.05}


def test_the_command(command_output, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    parts = [{"name": "wall", "outline": WALL}, {"name": "divider", "outline": box(47.85, -20, 3.8, 59.9)}]
    Path("slot.json").write_text(json.dumps({"format": "wiggleroom/1", "unit": "mm", "gap": 0, "parts": parts}))
    code, out, err = command_output(
        "clearances", "slot.json", "--json", "-", "--csv", "slot.csv", "--picture", "slot.svg"
    )
    found = json.loads(out)
    assert (code, found["format"]) == (0, "wiggleroom.clearances/1")
    assert found["pairs"][0]["parts"] == ["wall", "divider"]
    assert found["pairs"][0]["gap"] == pytest.approx(-0.15)
    assert found["offset"] == pytest.approx(-0.075)
    assert Path("slot.csv").read_text().splitlines()[0] == "part,other,gap_mm,direction_x,direction_y,x_mm,y_mm"
    assert "wall | divider" in Path("slot.svg").read_text()
    code, out, err = command_output("clearances", "slot.json", "--html", "slot.html")
    assert code == 0
    assert "a cut 0.15 mm wide along the lines does that, and so does --gap 0.15" in out
    assert "Near pairs" in Path("slot.html").read_text()
    assert command_output("clearances", "slot.json", "--xy", "0.3")[0] == 2
    code, _, err = command_output("clearances", "slot.json", "--within", "-1")
    assert (code, err) == (2, ["--within -1: it must be a length in mm, 0 or more"])


def test_a_grid_of_all_alike_parts_binds_everywhere():
    found = wr.clearances(wr.patterns.grid(12, 12, joint="tee", gap=0.02))
    sides = 2 * 12 * 11
    assert (np.abs(found.gap - 0.02) < 1e-9).sum() >= sides
    assert found.offset == pytest.approx(0.01)
    assert len(found.binding) >= sides


def test_a_strip_with_a_notch_in_its_end_is_as_deep_as_it_is_wide():
    strip = region([(0, 0), (10, 0), (10, 1), (0, 1), (4, 0.5)])
    found = wr.clearances(planar(("strip", strip, ()), ("plate", region(box(-5, -5, 20, 20)), ())))
    assert found.gap == pytest.approx([-1])


def test_bars_that_cross_edge_on_edge_are_as_deep_as_their_edges_are():
    """Bars of 10 mm lie on their edges, one across the other, 1 mm in each other: no face is across that."""
    bar = np.array([[-20.0, -5, -5], [20, 5, 5]])[None]
    low = Part("low", solid=Boxes(bar), R=Rotation.from_euler("x", 45, degrees=True).as_matrix())
    across = Rotation.from_euler("z", 90, degrees=True) * Rotation.from_euler("x", 45, degrees=True)
    high = Part("high", solid=Boxes(bar), R=across.as_matrix(), at=(0, 0, 10 * math.sqrt(2) - 1))
    found = wr.clearances(assemble_spatial(Drawing((low, high)), overlapping=True))
    assert found.gap == pytest.approx([-1])
    assert found.direction[0] == pytest.approx([0, 0, 1])


@pytest.mark.parametrize(("thick", "offset"), [(3.2, -0.1), (2.8, 0.1)])
def test_plates_of_another_thickness_in_their_slots(thick, offset):
    one = region([(0, 0), (40, 0), (40, 20), (21.6, 20), (21.6, 10), (18.4, 10), (18.4, 20), (0, 20)])
    other = region([(0, 0), (18.5, 0), (18.5, 10.5), (21.5, 10.5), (21.5, 0), (40, 0), (40, 20), (0, 20)])
    across = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    parts = (
        Part("one", (), solid=Plate((one,), thick), at=np.zeros(3), R=np.eye(3)),
        Part("other", (), solid=Plate((other,), 3.0), at=np.array([18.5, 0.0, 20 + thick / 2]), R=across),
    )
    found = wr.clearances(assemble_spatial(Drawing(parts)), within=0.3)
    assert found.offset == pytest.approx(offset, abs=1e-6)


def test_rings_round_each_other_and_a_corner_before_a_side():
    found = wr.clearances(
        planar(
            ("ring", region(polygon(15), polygon(10)), ()),
            ("disc", region(polygon(9.7)), ()),
            ("square", region(box(-2, -2, 4, 4)), (15.4 + 2 * math.sqrt(2), 0.0, math.pi / 4)),
        ),
        within=1.0,
    )
    at = by_name(found)
    facet = math.cos(math.pi / 96)
    assert found.gap[at["ring", "disc"]] == pytest.approx(0.3 * facet)
    assert found.gap[at["ring", "square"]] == pytest.approx(0.4)
    assert found.direction[at["ring", "square"]] == pytest.approx([1, 0])
    assert found.at[at["ring", "square"]] == pytest.approx([15.2, 0])
