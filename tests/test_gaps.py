"""The gap: exact mitres, gaps of single joints, and parts that do not survive it."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from wiggleroom.assembly import patterns
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.findings import findings
from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.assembly.loops import chained, placed_regions
from wiggleroom.assembly.mitre import resolved
from wiggleroom.drawing.model import Drawing, JointGap, Part, Region
from wiggleroom.errors import InputError


def box(x0, y0, x1, y1):
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float)


def part(name, outer, holes=(), **rest):
    clockwise = tuple(np.array(h, dtype=float)[::-1] for h in holes)
    return Part(name, (Region(np.array(outer, dtype=float), clockwise),), **rest)


def made(*parts, **statements):
    parts, lines = apply_gap(Drawing(parts, **statements))
    assert lines == ()
    return parts


def only(*parts, **statements):
    return made(*parts, **statements)[0].regions[0]


def ring(polygon):
    return np.array(polygon.exterior.coords)[:-1]


def test_triangle_keeps_corners_and_their_order():
    got = only(part("a", [[0, 0], [4, 0], [0, 3]]), gap=0.5).outer
    d = 0.25  # inradius 1, so the triangle shrinks about its incentre (1, 1) by 1 - d
    assert np.allclose(got, 1 + (np.array([[0, 0], [4, 0], [0, 3]]) - 1) * (1 - d), atol=1e-15)


def test_holes_grow():
    region = only(part("a", box(0, 0, 10, 10), [box(2, 2, 4, 5), [[6, 6], [9, 6], [6, 9]]]), gap=0.2)
    assert np.allclose(
        ring(shapely.Polygon(region.holes[0]).normalize()), ring(shapely.box(1.9, 1.9, 4.1, 5.1).normalize())
    )
    far = 6 + 3 + 0.1 * (1 + math.sqrt(2))  # the mitred tip of a 45 degree corner
    assert region.holes[1].max() == pytest.approx(far, abs=1e-14)
    assert shapely.LinearRing(region.outer).is_ccw
    assert not any(shapely.LinearRing(h).is_ccw for h in region.holes)


def test_offset_moves_out_and_is_used_up():
    (tight,) = made(part("a", box(0, 0, 2, 2), offset=-0.3), gap=0.2)
    assert np.allclose(tight.regions[0].outer, box(0.4, 0.4, 1.6, 1.6))
    assert tight.offset == 0.0
    grown = only(part("a", [[0, 0], [1, 0], [0, 1]], offset=0.1))
    assert grown.outer.max() == pytest.approx(1 + 0.1 * (1 + math.sqrt(2)))


def test_used_up_edges_vanish_exactly():
    rounded = [[0, 0], [4, 0], [4, 3.8], [3.95, 3.95], [3.8, 4], [0, 4]]
    got = only(part("a", rounded), gap=1.0).outer
    assert shapely.Polygon(got).symmetric_difference(shapely.box(0.5, 0.5, 3.5, 3.5)).area < 1e-14
    assert len(got) == 4
    filleted = [[0, 0], [4, 0], [4, 2], [2.1, 2], [2.03, 2.03], [2, 2.1], [2, 4], [0, 4]]
    grown = only(part("a", filleted, offset=0.5)).outer
    assert {tuple(p) for p in grown.round(9)} >= {(2.5, 2.5), (-0.5, -0.5), (4.5, 2.5)}
    assert len(grown) == 6


@st.composite
def stars(draw):
    n = draw(st.integers(3, 14))
    share = np.array(draw(st.lists(st.floats(0.25, 1.0), min_size=n, max_size=n)))
    angle = np.cumsum(share / share.sum() * 2 * np.pi)
    radius = np.array(draw(st.lists(st.floats(0.5, 3.0), min_size=n, max_size=n)))
    return np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None]


def by_definition(polygon, distance):
    """Polygon without the strips its edges sweep, and without the kites between the strips at corners that spread."""
    swept = []
    for line in (polygon.exterior, *polygon.interiors):
        points = ring(shapely.Polygon(line))
        ahead = np.roll(points, -1, axis=0)
        along = (ahead - points) / np.hypot(*(ahead - points).T)[:, None]
        normal = np.column_stack([-along[:, 1], along[:, 0]]) * distance
        for i, (a, b) in enumerate(zip(points, ahead, strict=True)):
            swept.append(shapely.Polygon([a, b, b + normal[i], a + normal[i]]))
            both = normal[i - 1] + normal[i]
            if (along[i - 1, 0] * along[i, 1] - along[i - 1, 1] * along[i, 0]) * distance < 0:
                tip = a + both * (2 * distance**2 / (both @ both))
                swept.append(shapely.Polygon([a, a + normal[i - 1], tip, a + normal[i]]))
    all_swept = shapely.union_all(shapely.make_valid(np.array(swept)))
    left = polygon.difference(all_swept) if distance > 0 else polygon.union(all_swept)
    pieces = [p for p in shapely.get_parts(left) if p.area > 1e-9]
    return [shapely.Polygon(p.exterior, [h for h in p.interiors if shapely.Polygon(h).area > 1e-9]) for p in pieces]


@settings(max_examples=80, deadline=None, derandomize=True)
@given(stars(), st.floats(-0.3, 0.6), st.booleans())
def test_random_stars_move_as_defined(star, distance, holed):
    hole = np.array([[-0.05, -0.05], [0.0, 0.06], [0.05, -0.04]])
    polygon = shapely.Polygon(star)
    assume(polygon.is_valid and abs(distance) > 1e-3)
    if holed and polygon.contains(shapely.Polygon(hole)):
        polygon = shapely.Polygon(star, [hole])
    polygon = shapely.orient_polygons(polygon)
    truth = by_definition(polygon, distance)
    holes = len(polygon.interiors)
    parts, lines = apply_gap(Drawing((Part("a", (Region(star, (hole,) * holes),), offset=-distance),)))
    if lines:
        assert len(truth) != 1 or len(truth[0].interiors) != holes
        return
    got = shapely.Polygon(parts[0].regions[0].outer, parts[0].regions[0].holes)
    assert got.is_valid
    assert len(truth) == 1
    assert got.symmetric_difference(truth[0]).area < 1e-9
    # GEOS flattens dents shallower than a hundredth of the distance before it moves anything
    buffered = polygon.buffer(-distance, join_style="mitre", mitre_limit=1e6)
    assert got.area == pytest.approx(buffered.area, abs=0.01 * abs(distance) * polygon.length + 1e-9)


@pytest.mark.parametrize(
    ("outer", "holes", "gap", "word"),
    [
        (box(0, 0, 4, 1), [], 1.2, "vanishes"),
        (
            [[0, 0], [2, 0], [2, 0.9], [4, 0.9], [4, 0], [6, 0], [6, 2], [4, 2], [4, 1.1], [2, 1.1], [2, 2], [0, 2]],
            [],
            0.3,
            "2 pieces",
        ),
        (box(0, 0, 4, 4), [box(0.2, 1, 2, 2)], 0.3, "loses a hole"),
        (box(0, 0, 9, 4), [box(1, 1, 4, 3), box(4.2, 1, 8, 3)], 0.3, "loses a hole"),
    ],
)
def test_a_part_that_does_not_survive_is_named(outer, holes, gap, word):
    with pytest.raises(InputError, match=word) as caught:
        assemble(Drawing((part("spring", outer, holes), part("other", box(20, 0, 30, 9))), source="f.svg"), gap=gap)
    (line,) = caught.value.findings
    assert line.startswith('f.svg: part "spring"')
    assert "smaller gap" in line


def test_growth_can_lose_and_make_holes():
    c_shape = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 2.1], [1, 2.1], [1, 3], [3, 3], [3, 1], [1, 1], [1, 1.9], [0, 1.9]]
    lines = findings(
        Drawing((part("ring", c_shape, offset=0.2), part("plate", box(9, 0, 12, 3), [box(10, 1, 10.3, 2)], offset=0.2)))
    )
    assert [line.split(" at ")[0] for line in lines] == [
        'part "ring" closes round a new hole',
        'part "plate" loses a hole',
    ]
    assert all("smaller offset" in line for line in lines)


def bricks(shift, **statements):
    a, b = part("a", box(0, 0, 4, 2)), part("b", box(0, 0, 4, 2), at=(4 + shift[0], shift[1], 0.0))
    return made(a, b, part("c", box(0, 2, 8, 3)), **statements)


def shapes(parts):
    polygons, owner = placed_regions(parts)
    return {parts[i].name: p for i, p in zip(owner, polygons, strict=True)}


def test_gap_of_one_joint_between_bricks():
    drawn = shapes(bricks((0, 0), gap=0.2, gaps=(JointGap(("a", "b"), 0.6),)))
    assert drawn["a"].symmetric_difference(shapely.box(0.1, 0.1, 3.7, 1.9)).area < 1e-14
    assert drawn["b"].symmetric_difference(shapely.box(4.3, 0.1, 7.9, 1.9)).area < 1e-14
    assert shapely.distance(drawn["a"], drawn["b"]) == pytest.approx(0.6, abs=1e-12)
    assert shapely.distance(drawn["a"], drawn["c"]) == pytest.approx(0.2, abs=1e-12)


def test_only_the_facing_stretch_moves():
    parts = bricks((0, 0.5), gap=0.2, gaps=(JointGap(("b", "a"), 0.6),))[:2]
    drawn = shapes(parts)
    step = [[0.1, 0.1], [3.9, 0.1], [3.9, 0.5], [3.7, 0.5], [3.7, 1.9], [0.1, 1.9]]
    assert np.allclose(parts[0].regions[0].outer, step)
    assert drawn["b"].bounds == pytest.approx((4.1, 0.6, 7.9, 2.4))
    assert drawn["b"].contains(shapely.Point(4.2, 2.2))
    assert not drawn["b"].contains(shapely.Point(4.2, 1.9))


def test_joint_drawn_with_clearance_and_turned_frames():
    a = part("a", box(-2, -1, 2, 1), at=(2, 1, 0.0))
    b = part("b", box(-1, -2, 1, 2), at=(6.25, 1, math.pi / 2))
    drawn = shapes(made(a, b, gaps=(JointGap(("a", "b"), 0.1),)))
    assert shapely.distance(drawn["a"], drawn["b"]) == pytest.approx(0.25 + 0.1)
    assert drawn["a"].bounds == pytest.approx((0, 0, 3.95, 2))


def test_offset_adds_to_the_gap_of_a_joint():
    a, b = part("a", box(0, 0, 4, 2), offset=-0.05), part("b", box(4, 0, 8, 2))
    drawn = shapes(made(a, b, gap=0.2, gaps=(JointGap(("a", "b"), 0.6),)))
    assert drawn["a"].bounds == pytest.approx((0.15, 0.15, 3.65, 1.85))


def test_gap_of_one_tee_joint():
    drawing = patterns.chain(4, gap=0.01).drawing
    parts = made(*drawing.parts, gap=0.01, gaps=(JointGap(("b2", "b3"), 0.04),))
    drawn = shapes(parts)
    clear = [shapely.distance(drawn[f"b{i}"], drawn[f"b{i + 1}"]) for i in (1, 2, 3)]
    assert clear == pytest.approx([0.01, 0.04, 0.01], abs=1e-12)
    assert [len(p.regions[0].outer) for p in parts] == [20] * 4
    tab = np.array(drawn["b3"].exterior.coords)
    assert np.ptp(tab[tab[:, 0] < 1.35][:, 1]) == pytest.approx(0.30 - 0.04)  # the whole head, all round
    assert tab[:, 1].min() == pytest.approx(-0.5 + 0.005)


def test_parts_that_do_not_face_each_other_have_no_joint():
    far = part("far", box(20, 20.5, 21, 22))
    lines = findings(Drawing((part("a", box(0, 0, 1, 1)), far), gap=0.1, gaps=(JointGap(("a", "far"), 0.2),)))
    assert lines == ('gaps: parts "a" and "far" face each other nowhere: name two neighbours',)


def test_an_offset_that_uses_a_part_up_is_to_blame():
    (line,) = findings(Drawing((part("a", box(0, 0, 5, 5), offset=-5.0),), gap=0.1))
    assert line.endswith("an offset nearer to 0 would leave it whole")
    (line,) = findings(Drawing((part("a", box(0, 0, 5, 5), offset=-0.1),), gap=6.0))
    assert line.endswith("a smaller gap would leave it whole")


def test_far_from_the_origin_nothing_is_lost():
    near = only(part("a", [[0, 0], [4, 0], [1, 3]]), gap=0.1).outer
    far = only(part("a", np.add([[0, 0], [4, 0], [1, 3]], [2500, -900])), gap=0.1).outer
    assert np.abs(far - [2500, -900] - near).max() < 2e-12


def test_gap_of_one_round_joint():
    drawing = patterns.chain(3, "revolute", gap=0.01).drawing
    drawn = shapes(made(*drawing.parts, gap=0.01, gaps=(JointGap(("b1", "b2"), 0.03),)))
    assert shapely.distance(drawn["b1"], drawn["b2"]) == pytest.approx(0.03, abs=1e-12)
    assert shapely.distance(drawn["b2"], drawn["b3"]) == pytest.approx(0.01, abs=1e-12)


def test_gap_of_a_joint_in_a_hole():
    plate = part("plate", box(0, 0, 9, 9), [box(3, 3, 6, 6)])
    peg = part("peg", box(-1.5, -1.5, 1.5, 1.5), at=(4.5, 4.5, math.pi / 2))
    parts = made(plate, peg, gap=0.1, gaps=(JointGap(("plate", "peg"), 0.4),))
    drawn = shapes(parts)
    assert drawn["plate"].symmetric_difference(
        shapely.Polygon(box(0.05, 0.05, 8.95, 8.95), [box(2.8, 2.8, 6.2, 6.2)])
    ).area == pytest.approx(0, abs=1e-12)
    assert drawn["peg"].bounds == pytest.approx((3.2, 3.2, 5.8, 5.8))


def test_l_shape():
    got = only(part("a", [[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]]), gap=0.2).outer
    assert np.allclose(got, [[0.1, 0.1], [3.9, 0.1], [3.9, 1.9], [1.9, 1.9], [1.9, 3.9], [0.1, 3.9]], atol=1e-15)


def test_needle_is_mitred_to_its_far_tip():
    angle = 0.01
    tip = only(part("a", [[0, 0], [1, 0], [math.cos(angle), math.sin(angle)]], offset=0.001)).outer[0]
    assert np.hypot(*tip) == pytest.approx(0.001 / math.sin(angle / 2), rel=1e-9)


def test_parts_with_a_gap_of_one_joint_only_get_smaller_as_the_gap_grows():
    step = part("b", [[4, 0], [8, 0], [8, 2], [4.05, 2], [4.05, 1], [4, 1]])
    before = None
    for gap in (0.1, 0.3, 0.6, 0.9):
        now = shapes(made(part("a", box(0, 0, 4, 2)), step, gap=gap, gaps=(JointGap(("a", "b"), 0.02),)))
        assert before is None or all(shapely.difference(now[name], before[name]).area < 1e-12 for name in now)
        before = now


@settings(max_examples=100, deadline=None, derandomize=True)
@given(stars(), st.floats(0.0, 0.2))
def test_both_ways_agree(star, distance):
    """Where no edge is used up, moving edges and counting windings give the same outline."""
    assume(shapely.Polygon(star).is_valid)
    parts, lines = apply_gap(Drawing((part("a", star),), gap=2 * distance))
    assume(not lines)
    pieces = resolved(chained([star]), np.full(len(star), distance))
    assert len(pieces) == 1
    assert pieces[0].symmetric_difference(shapely.Polygon(parts[0].regions[0].outer)).area < 1e-9
