"""Everything wrong with a drawing is said at once, in plain lines."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from wiggleroom.assembly import patterns
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.findings import findings, role_findings
from wiggleroom.assembly.overlaps import overlap_width, overlaps_at_rest
from wiggleroom.drawing.model import Drawing, JointGap, Part, Pull, Region, Turn, W, Weight
from wiggleroom.errors import InputError

SQUARE = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))


def square(name, x=0.0, y=0.0, **rest):
    return Part(name, (SQUARE,), at=(x, y, 0.0), **rest)


def shape(name, *corners):
    return Part(name, (Region(np.array(corners, dtype=float).reshape(-1, 2)),))


def one(drawing):
    (line,) = findings(drawing)
    return line


def test_a_sound_drawing_has_no_findings():
    pulls = (Pull("b", (1, 0)), Turn("b"), W("b", (0, 0, 1)))
    assert findings(Drawing((square("a", fixed=True), square("b", 2)), gap=0.1, goals=pulls)) == ()


def test_overlap_has_its_depth_and_is_judged_after_the_gap():
    drawing = Drawing((square("a"), square("b", 1.7)), source="x.json")
    assert one(drawing).startswith('x.json: parts "a" and "b" overlap by 0.3 mm at gap 0')
    assert one(replace(drawing, gap=0.2)).startswith('x.json: parts "a" and "b" overlap by 0.1 mm at gap 0.2')
    assert findings(replace(drawing, gap=0.3)) == ()


def test_a_rounding_error_round_a_corner_is_no_overlap():
    nook = shape("a", (0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4))
    drawing = Drawing((nook, square("b", 1 - 1e-10, 1 - 1e-10)))
    assert findings(drawing) == ()
    assert "overlap" in one(replace(drawing, parts=(nook, square("b", 1 - 1e-6, 1 - 1e-6))))


@pytest.mark.parametrize("width", [0.2, 1e-3, 1e-7])
def test_rings_frames_and_bent_strips_are_as_wide_as_their_material(width):
    def disc(radius):
        return shapely.buffer(shapely.Point(0, 0), radius, quad_segs=64)

    frame = shapely.difference(shapely.box(0, 0, 3, 2), shapely.box(width, width, 3 - width, 2 - width))
    corner = shapely.union(shapely.box(0, 0, 5, width), shapely.box(0, 0, width, 5))
    ring = shapely.difference(disc(5), disc(5 - width))
    assert overlap_width(frame) == pytest.approx(width, rel=1e-4)
    assert overlap_width(corner) == pytest.approx(width, rel=1e-4)
    assert overlap_width(ring) == pytest.approx(width, rel=1e-3)


def test_a_part_inside_another_overlaps_and_one_in_a_hole_does_not():
    plate = Region(np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]))
    hole = np.array([[3.0, 3.0], [3.0, 6.0], [6.0, 6.0], [6.0, 3.0]])
    inlay = square("b", 3.5, 3.5)
    assert overlaps_at_rest([Part("a", (plate,)), inlay]) == [(0, 1, pytest.approx(2.0))]
    assert overlaps_at_rest([Part("a", (Region(plate.outer, (hole,)),)), inlay]) == []


def test_glued_and_ignored_parts_may_overlap():
    parts = (square("a"), square("b", 1), square("c", 0, 1), square("d", 9))
    assert len(findings(Drawing(parts))) == 3
    assert len(findings(Drawing(parts, glue=(("a", "b"), ("c", "d"))))) == 2
    assert findings(Drawing(parts, glue=(("a", "d"), ("d", "b")), ignore=(("c", "b"), ("a", "c")))) == ()


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (shape("p", (0, 0), (2, 2), (2, 0), (0, 2)), "crosses itself at (1, 1)"),
        (shape("p", (0, 0), (4, 0), (4, 3), (2, 0), (0, 3)), "touches itself at (2, 0)"),
        (shape("p", (0, 0), (1, 1)), "2 different corners"),
        (shape("p", (0, 0), (1, 1), (0, 0), (1, 1)), "2 different corners"),
        (shape("p"), "0 different corners"),
        (shape("p", (0, 0), (1, 1), (3, 3)), "without area"),
        (shape("p", (0, 0), (4, 0), (2, 1e-10)), "below a billionth of its size"),
        (Part("p", (SQUARE, Region(1e-10 * SQUARE.outer + 5.0))), "below a billionth of its size"),
        (Part("p", (Region(SQUARE.outer, (1e-10 * SQUARE.outer[::-1] + 0.5,)),)), "below a billionth of its size"),
        (shape("p", (0, 0), (np.nan, 1), (3, 3)), "not a number"),
        (shape("p", (0, 0), (np.inf, 1), (3, 3)), "not a number"),
        (shape("p", (0, 0), (1e200, 0), (0, 1e200)), "check the numbers and the unit"),
        (Part("p", ()), "has no outline"),
        (Part("p", (SQUARE,), at=(0, np.nan, 0)), "lies at (0, nan, 0)"),
        (Part("p", (SQUARE,), at=(0, 1e30, 0)), "lies at"),
        (Part("p", (SQUARE,), offset=np.inf), "offset inf"),
        (
            Part("p", (Region(SQUARE.outer, (SQUARE.outer[::-1] + 9.0,)),)),
            "a hole outside its outline at (9, 11): holes lie inside",
        ),
    ],
)
def test_outlines_that_cannot_be_used(part, words):
    line = one(Drawing((part,)))
    assert line.startswith('part "p" ')
    assert words in line


@pytest.mark.parametrize(
    ("statements", "words"),
    [
        ({"gap": -0.1}, "gap is -0.1: it must be 0 or more"),
        ({"gap": np.nan}, "gap is nan"),
        ({"gap": np.inf}, "gap is inf"),
        ({"gaps": (JointGap(("a", "b"), -1.0),)}, "gap of a and b is -1"),
        ({"gaps": (JointGap(("a", "a"), 1.0),)}, '"a" is named twice'),
        ({"gaps": (JointGap(("a", "x"), 1.0),)}, 'gaps: there is no part "x": the parts are a, b'),
        ({"glue": (("a", "x"),)}, 'glue: there is no part "x"'),
        ({"ignore": (("a", "x"),)}, 'ignore: there is no part "x"'),
        ({"goals": (Pull("x", (1, 0)),)}, 'pull: there is no part "x"'),
        ({"goals": (Pull("b", (0, 0)),)}, "direction is (0, 0)"),
        ({"goals": (Pull("b", (np.nan, 0)),)}, "direction is (nan, 0)"),
        ({"goals": (Pull("b", (1, 0), point=(np.inf, 0)),)}, "point is (inf, 0)"),
        ({"goals": (Pull("b", (1, 0), weight=np.nan),)}, "weight is nan"),
        ({"goals": (Turn("b", "left"),)}, 'sense is "left": it is ccw or cw'),
        ({"goals": (W("b", (0, 0, 0)),)}, "w is (0, 0, 0)"),
        (
            {"goals": (Pull("b", (0, 0, 1)),)},
            'pull of "b": direction is (0, 0, 1): in the plane it must be two numbers',
        ),
        ({"goals": (Turn("b", (0, 0, 1)),)}, 'turn of "b": sense is "(0, 0, 1)": it is ccw or cw'),
        ({"goals": (Weight((0, 0, -1)),)}, "weight is a question about assemblies in space"),
        ({"goals": (Pull("a", (1, 0)),)}, '"a" cannot be moved (pull), for it is fixed'),
        ({"goals": (Turn("b"),), "glue": (("a", "b"),)}, 'it is glued to "a", which is fixed'),
    ],
)
def test_statements_that_cannot_be(statements, words):
    assert words in one(Drawing((square("a", fixed=True), square("b", 2)), **statements))


def test_no_parts_and_double_names():
    assert "there are no parts" in one(Drawing(()))
    assert '2 parts have the name "a"' in one(Drawing((square("a"), square("a", 5))))


def test_everything_at_once():
    parts = (
        square("a", fixed=True),
        square("b", 1.0),
        square("b", 9.0),
        shape("bow", (30, 0), (32, 2), (32, 0), (30, 2)),
        shape("dot", (0, 0), (1, 1)),
        shape("thin", (40, 0), (44, 0), (44, 0.1), (40, 0.1)),
    )
    drawing = Drawing(parts, gap=0.2, glue=(("a", "z"),), goals=(Pull("a", (1, 0)), Pull("q", (1, 0))), source="f.json")
    with pytest.raises(InputError) as caught:
        assemble(drawing, fix=["bb"])
    lines = caught.value.findings
    wanted = ["did you mean", "the name", 'glue: there is no part "z"', 'pull: there is no part "q"', "cannot be moved"]
    wanted += ['"dot" has 2', '"bow" crosses', '"thin" vanishes', '"a" and "b" overlap by 0.8 mm']
    assert len(lines) == len(wanted)
    assert all(words in line for words, line in zip(wanted, lines, strict=True))
    assert "\n" not in "".join(lines)


def test_fix_names_near_matches():
    with pytest.raises(InputError, match='fix: there is no part "b21": did you mean "b2"'):
        assemble(patterns.chain(3).drawing, fix=["b21"])


def test_assemble_sets_gap_roles_and_goals():
    drawing = patterns.chain(3, gap=0.01).drawing
    got = assemble(drawing, gap=0.02, fix=["b3"], goals=[Turn("b2")], offset={"b2": -0.001})
    assert got.gap == 0.02
    assert [p.fixed for p in got.drawing.parts] == [p.fixed for p in got.parts] == [True, False, True]
    assert got.goals == (Turn("b2"),)
    height = [np.ptp(p.regions[0].outer[:, 1]) for p in got.parts]
    assert height == pytest.approx([0.98, 0.978, 0.98])
    assert drawing.gap == 0.01
    assert not drawing.parts[2].fixed


def test_roles():
    free = Drawing((square("a"),))
    assert len(role_findings(free)) == 2
    assert "--fix" in role_findings(free)[0]
    assert "--pull" in role_findings(free)[1]
    assert "everything is fixed" in role_findings(Drawing((square("a", fixed=True),), goals=(Turn("a"),)))[0]
    assert role_findings(patterns.chain(2).drawing) == ()


def test_touching_is_no_overlap_even_turned():
    turn = 0.7
    c, s = np.cos(turn), np.sin(turn)
    parts = tuple(
        Part(f"{i}{j}", (SQUARE,), at=(900 + 2 * (c * i - s * j), 2 * (s * i + c * j), turn))
        for i in range(9)
        for j in range(9)
    )
    assert findings(Drawing(parts)) == ()


def test_width_is_the_smallest():
    assert overlap_width(shapely.Polygon([(0, 0), (1, 0), (0.5, 0.1)])) == pytest.approx(0.1)
    turned = shapely.affinity.rotate(shapely.box(0, 0, 5, 0.25), 31)
    assert overlap_width(turned) == pytest.approx(0.25)


def test_the_place_of_a_crossing_is_in_the_drawing():
    bow = replace(shape("p", (0, 0), (2, 2), (2, 0), (0, 2)), at=(10.0, 20.0, np.pi / 2))
    assert "crosses itself at (9, 21)" in one(Drawing((bow,)))
