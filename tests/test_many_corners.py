"""Outlines of very many corners: taken at any gap, and what is found holds of the outlines that were drawn."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
import shapely
from benchmarks.attack import drawing

import wiggleroom as wr
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.geometry.outer_simplification import simplified_outward


def in_a_hole(inner: np.ndarray, room: shapely.Polygon, folder) -> wr.Assembly:
    """A part in a hole of a plate that stands."""
    plate = drawing.cut(drawing.box(-2, -2, 2, 2), room)
    parts = [drawing.part("plate", plate, fixed=True), drawing.part("disc", shapely.Polygon(inner))]
    (folder / "made.json").write_text(json.dumps(drawing.assembly(parts, [drawing.pull("disc", (1, 0))])))
    return wr.read(folder / "made.json")


def ring(count: int, radius: float = 1.0, petals: int = 0) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    r = radius * (1 + 0.15 * np.cos(petals * angle) * (petals > 0))
    return np.column_stack([r * np.cos(angle), r * np.sin(angle)])


@pytest.mark.parametrize(("count", "gap"), [(1000, 0.01)])
def test_a_disc_goes_as_far_as_its_clearance(count, gap, tmp_path):
    assembly = in_a_hole(ring(count), drawing.disc(1 + gap, count), tmp_path)
    answer = wr.flex(assembly, search=0)
    assert answer.objective == pytest.approx(gap, rel=2e-3)
    assert answer.objective <= gap + 1e-9  # corner meets corner of congruent outlines
    assert answer.path == "checked"
    assert audit_path(assembly, answer.waypoints).free
    assert answer.at_most is None
    assert "searched with fewer" in answer.bound.why


BENDS = ((0.0, 0.0), (-0.6, 0.0), (-0.6, 0.7), (0.8, 0.7))


@pytest.mark.parametrize(
    ("corners", "chords", "point"),
    [(40, 8, (-0.05, 0.1)), (240, 8, None)],
)
def test_a_disc_goes_round_bends_to_the_end_of_its_channel(corners, chords, point, tmp_path):
    room = shapely.buffer(shapely.LineString(BENDS), 0.22, quad_segs=chords)
    made = [
        drawing.part("plate", drawing.cut(drawing.box(-2, -2, 2, 2), room), fixed=True),
        drawing.part("disc", drawing.disc(0.2, corners)),
    ]
    (tmp_path / "bends.json").write_text(json.dumps(drawing.assembly(made, [drawing.pull("disc", (1, 0), point)])))
    assembly = wr.read(tmp_path / "bends.json")
    answer = wr.flex(assembly)
    arm = (0.0, 0.0) if point is None else point
    turned = np.hypot(*arm) - arm[0]  # the point is turned to lie ahead
    least = 0.8 + (0.22 * np.cos(np.pi / (4 * chords)) - 0.2) + turned  # the end of the channel is a chord or a corner
    most = 0.8 + (0.22 - 0.2 * np.cos(np.pi / corners)) + turned
    assert least * 0.999 <= answer.objective <= most
    assert answer.objective <= answer.at_most
    assert answer.at_most >= least
    assert answer.verdict == "proven"
    assert audit_path(assembly, answer.waypoints).free


def carved(seed: int) -> tuple[np.ndarray, shapely.Polygon]:
    """Corners of a piece, and the channel that it cuts on a random way, the clearance wider."""
    rng = np.random.default_rng([seed, 77])
    k = int(rng.integers(3, 9))
    radius = rng.uniform(0.4, 1.0, k)
    rng.uniform(0, 2 * np.pi, k)
    angle = 2 * np.pi * np.arange(k) / k + rng.uniform(-0.3, 0.3, k)
    piece = shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
    poses, heading = [np.zeros(3)], rng.uniform(0, 2 * np.pi)
    for _ in range(int(rng.integers(2, 7))):
        heading += rng.uniform(-1.5, 1.5)
        length, twist = rng.uniform(0.2, 1.2), rng.uniform(-0.8, 0.8)
        change = np.array([length * np.cos(heading), length * np.sin(heading), twist])
        poses += [poses[-1] + change * t for t in np.linspace(0, 1, int(rng.choice([3, 6, 12])) + 1)[1:]]
    gap = float(rng.choice([0.01, 0.03, 0.06]))
    fine = [p + (q - p) * t for p, q in pairwise(poses) for t in np.linspace(0, 1, 13)]
    swept = shapely.union_all([drawing.moved(piece, x, y, turn) for x, y, turn in fine])
    room = shapely.buffer(swept, gap, join_style="mitre", mitre_limit=2.0).simplify(gap / 4)
    return np.array(piece.exterior.coords)[:-1], room


def test_what_is_found_in_a_carved_channel_of_many_corners_is_the_largest_motion(tmp_path):
    """Climbs end at less than half of it."""
    piece, room = carved(9)
    plate = drawing.cut(shapely.box(*room.bounds).buffer(0.5, join_style="mitre"), room)
    parts = [drawing.part("plate", plate, fixed=True), drawing.part("b", shapely.Polygon(piece))]
    (tmp_path / "made.json").write_text(json.dumps(drawing.assembly(parts, [drawing.pull("b", (0.9179, 0.3969))])))
    assembly = wr.read(tmp_path / "made.json")
    answer = wr.flex(assembly)
    assert answer.verdict == "proven"
    assert answer.objective > 1.6
    assert answer.objective <= answer.at_most <= 1.001 * answer.objective
    assert audit_path(assembly, answer.waypoints).free


@pytest.mark.parametrize("tolerance", [1e-4, 1e-3])
def test_simplified_outlines_hold_all_the_material_and_hardly_more(tolerance, tmp_path):
    rng = np.random.default_rng(3)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 900))
    radius = 1 + sum(rng.uniform(0, 0.06) * np.cos(k * angle + rng.uniform(0, 6)) for k in range(2, 7))
    blob = shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
    room = shapely.Polygon(shapely.buffer(blob, 0.02, join_style="mitre").exterior)
    assembly = in_a_hole(np.array(blob.exterior.coords)[:-1], room, tmp_path)
    cover = simplified_outward(assembly, 0.02, tolerance, np.zeros((0, 3)), tolerance)
    for before, after in zip(assembly.parts, cover.parts, strict=True):
        old, new = (shapely.Polygon(p.regions[0].outer, p.regions[0].holes) for p in (before, after))
        assert shapely.difference(old, new).area < 1e-12
        assert shapely.hausdorff_distance(old.boundary, new.boundary) < 3 * tolerance
        assert shapely.get_num_coordinates(new) < 0.6 * shapely.get_num_coordinates(old)


@pytest.fixture
def disc_in_a_hole(tmp_path):
    return in_a_hole(ring(400), drawing.disc(1.02, 400), tmp_path)


@pytest.mark.slow
def test_studies_take_them(disc_in_a_hole):
    steps = wr.sweep(disc_in_a_hole, [0.0, 0.01]).steps
    assert [s.objective for s in steps] == pytest.approx([0.02, 0.03], rel=2e-3)
    assert wr.rank(disc_in_a_hole).by_duals == pytest.approx([0.5, 0.5], rel=1e-2)


def test_the_page_drags_them(disc_in_a_hole):
    live = wr.Live(disc_in_a_hole.drawing)
    live.design()
    for target in ((0.5, 0.0), (-0.3, 0.4)):
        found = live.drag("disc", (0, 0), target, seconds=5.0)
        assert np.hypot(*found.motion[1, :2]) == pytest.approx(0.02, rel=0.02)
        assert audit_path(disc_in_a_hole, np.stack([found.motion, found.motion])).free


@pytest.mark.parametrize(("neck", "verdict"), [(0.7, "interlocked"), (1.1, "comes apart")])
def test_check_judges_them_as_they_were_drawn(neck, verdict, tmp_path):
    room = drawing.union(drawing.disc(1.02, 700), drawing.box(-neck, 0, neck, 3))
    found = wr.check(in_a_hole(ring(700), room, tmp_path))
    assert (found.verdict, found.certainty) == (verdict, "proven")
    assert found.spins == (("disc",) if verdict == "interlocked" else ())


def test_a_flower_goes_as_far_as_its_clearance(tmp_path):
    gap = 0.01
    inner = shapely.Polygon(ring(1000, petals=5))
    assembly = in_a_hole(ring(1000, petals=5), shapely.buffer(inner, gap, join_style="mitre"), tmp_path)
    answer = wr.flex(assembly, search=0)
    assert gap * 0.99 < answer.objective < gap * 1.02  # it may turn a little
    assert audit_path(assembly, answer.waypoints).free
