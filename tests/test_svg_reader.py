"""Drawings: geometry against exact truth, names and roles by the contract, and the way back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from wiggleroom.assembly.assembly import place
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.drawing.readers.svg import read_svg
from wiggleroom.drawing.writers.svg_writer import write_svg
from wiggleroom.errors import InputError

DRAWINGS = Path(__file__).parents[1] / "examples" / "drawings"
PAGE = 'width="100mm" height="100mm" viewBox="0 0 100 100"'


def read(body: str, head: str = PAGE, **options) -> Drawing:
    return read_svg(f"<svg {head}>{body}</svg>", **options)


def material(part: Part) -> shapely.Geometry:
    return shapely.union_all(
        [Polygon(place(r.outer, part.at), [place(hole, part.at) for hole in r.holes]) for r in part.regions]
    )


def names(drawing: Drawing) -> list[str]:
    return [part.name for part in drawing.parts]


# Real drawings -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "gap", "count", "area"),
    [("jointpanel_4x4", 0.2, 16, 160**2), ("jointpanel_10x10", 0.2, 100, 500**2), ("pyjigsaw_4x5", 1.0, 20, 500 * 400)],
)
def test_real_drawings_fit_together(file, gap, count, area):
    drawing = read_drawing(DRAWINGS / f"{file}.svg", gap=gap)
    assert len(set(names(drawing))) == count
    shapes = np.array([material(part) for part in drawing.parts])
    assert shapely.is_valid(shapes).all()
    assert shapely.area(shapes).sum() == pytest.approx(area, abs=1e-6)
    first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    pairs = first < second
    assert shapely.area(shapely.intersection(shapes[first[pairs]], shapes[second[pairs]])).max() < 1e-6
    assert shapely.union_all(shapes).area == pytest.approx(area, abs=1e-6)
    assert len(drawing.notes) == file.startswith("pyjigsaw")


# Geometry ------------------------------------------------------------------------------------------------------------

SLOT = "M20 20H60A10 15 0 0 1 60 50A5 5 30 0 0 50 55H30A6 9 0 1 1 20 50A15 15 0 0 0 20 20Z"


@pytest.mark.parametrize(
    ("transform", "matrix"),
    [
        ("skewX(30)", np.array([[1, np.tan(np.pi / 6)], [0, 1]])),
        ("matrix(1 .3 -.8 2 0 0)", np.array([[1, -0.8], [0.3, 2]])),
        ("scale(2,.5) rotate(90)", np.array([[0, -2], [0.5, 0]])),
    ],
)
def test_slot_with_four_arcs_under_any_transform(transform, matrix):
    """Transformed corners of a very fine flattening are the truth."""
    truth = material(read(f'<path d="{SLOT}"/>', flatten=1e-6).parts[0])
    upright = shapely.transform(truth, lambda p: np.column_stack([p[:, 0], 100 - p[:, 1]]))
    moved = shapely.transform(upright, lambda p: p @ matrix.T)
    moved = shapely.transform(moved, lambda p: np.column_stack([p[:, 0], 100 - p[:, 1]]))
    found = material(read(f'<g transform="{transform}"><path d="{SLOT}"/></g>', flatten=1e-3).parts[0])
    fine = shapely.points(shapely.get_coordinates(moved.exterior))
    assert shapely.distance(fine, found.exterior).max() <= 1.01e-3
    corners = shapely.points(shapely.get_coordinates(found.exterior))
    stretch = np.linalg.norm(matrix, 2)  # of the truth, which is itself flattened
    assert shapely.distance(corners, moved.exterior).max() <= 1.05e-5 * max(stretch, 1)


@pytest.mark.parametrize(
    ("body", "area", "centre"),
    [
        ('<rect x="10" y="20" width="30" height="10"/>', 300, (25, 75)),
        ('<rect x="10" y="20" width="30" height="10" rx="2"/>', 300 - (4 - np.pi) * 4, (25, 75)),
        ('<rect x="10" y="20" width="30" height="10" rx="99" ry="3"/>', 300 - (4 - np.pi) * 45, (25, 75)),
        ('<circle cx="40" cy="40" r="10"/>', np.pi * 100, (40, 60)),
        ('<polygon points="0,0 30,0 30,-30"/>', 450, (20, 110)),
        ('<rect x="10%" y="20%" width="1cm" height="50%"/>', 96 / 2.54 * 50, (10 + 96 / 5.08, 55)),
        ('<path d="M10 10C10 10 20 10 20 10L20 20L10 20z"/>', 100, (15, 85)),
        ('<path d="M10 10Q20 30 30 10z"/>', 2 / 3 * 20 * 10, (20, 90 - 4)),
    ],
)
def test_basic_shapes(body, area, centre):
    part = read(body, flatten=1e-6).parts[0]
    assert material(part).area == pytest.approx(area, rel=1e-5)
    assert part.at[:2] == pytest.approx(centre, abs=1e-4)
    assert Polygon(part.regions[0].outer).exterior.is_ccw
    centroid = Polygon(part.regions[0].outer).centroid
    assert (centroid.x, centroid.y) == pytest.approx((0, 0), abs=1e-9)


def test_comments_are_not_read_whatever_is_in_them():
    square = '<path id="a" d="M0 0H10V10H0z"/>'
    style = "<style><![CDATA[/* <!-- */]]></style>"  # no comment begins there
    drawing = read(f"<!-- --laser -->{style}{square}<!-- <path d='M20 0H30V10H20z'/> --><!--\n--- -->")
    assert names(drawing) == ["a"]
    with pytest.raises(InputError, match=r"line 3, column 6: is not well-formed XML"):
        read(f"<!-- --\nx-y -->{square}\n<a> & </a>")
    with pytest.raises(InputError, match="is not well-formed XML"):
        read(f"{square}<!-- without an end")


def test_cubics_against_an_independent_library():
    svgelements = pytest.importorskip("svgelements")
    data = "M10 10C30 0 40 30 60 10S70 50 60 60Q50 40 40 60T10 60z"
    ring = material(read(f'<path d="{data}"/>', flatten=1e-3).parts[0]).exterior
    curve = svgelements.Path(data)
    points = [
        (p.x, 100 - p.y) for p in (segment.point(t) for segment in curve for t in np.linspace(0, 1, 50) if len(curve))
    ]
    assert shapely.distance(shapely.points(points), ring).max() <= 1.01e-3


def test_transforms_nest_and_use_copies():
    drawing = read(
        """<defs><g id="pair"><rect width="2" height="2"/><circle cx="5" cy="1" r="1"/></g></defs>
        <symbol id="tile" viewBox="0 0 10 10"><rect width="10" height="10"/></symbol>
        <g transform="translate(10 20)"><g transform="rotate(90) scale(2)">
        <rect id="r" x="1" y="-3" width="4" height="2"/></g></g>
        <use id="copy" href="#r" x="5" transform="translate(0 50)"/>
        <use href="#pair" x="60" y="60"/>
        <use xlink:href="#tile" id="t" x="80" y="80" width="20" height="10"/>
        <svg x="50" y="0" width="20" height="20" viewBox="0 0 5 5"><rect id="n" width="1" height="1"/></svg>"""
    )
    assert names(drawing) == ["r", "copy", "p3", "p4", "t", "n"]
    boxes = {part.name: np.round(shapely.bounds(material(part)), 9).tolist() for part in drawing.parts}
    assert boxes["r"] == [12, 70, 16, 78]
    assert boxes["copy"] == [6, 51, 10, 53]
    assert boxes["p3"] == [60, 38, 62, 40]
    assert boxes["p4"] == [64, 38, 66, 40]
    assert boxes["t"] == [85, 10, 95, 20]
    assert boxes["n"] == [50, 96, 54, 100]


# Units and viewBox ---------------------------------------------------------------------------------------------------

RECT = '<rect id="a" x="10" y="20" width="4" height="2"/>'


@pytest.mark.parametrize(
    ("head", "scale", "left", "bottom", "noted"),
    [
        ('width="100mm" height="100mm" viewBox="0 0 100 100"', 1, 0, 100, False),
        ('width="2in" height="2in" viewBox="-5 7 100 100"', 0.508, -5, 107, False),
        ('width="72pt" viewBox="0 0 254 100"', 0.1, 0, 100, False),
        ('height="50mm" viewBox="0 0 254 100"', 0.5, 0, 100, False),
        ('width="100mm" height="50mm" viewBox="0 0 100 100"', 0.5, 0, 100, False),
        ('width="100mm" height="50mm" viewBox="0 0 100 100" preserveAspectRatio="xMidYMid slice"', 1, 0, 100, False),
        ('width="96mm" height="96mm"', 25.4 / 96, 0, 96 * 96 / 25.4, False),
        ('viewBox="0 0 50 40"', 1, 0, 40, True),
        ('width="500px" height="400px" viewBox="0 0 50 40"', 1, 0, 40, True),
        ('width="100%" height="100%" viewBox="1 1 50 40"', 1, 1, 41, True),
    ],
)
def test_page(head, scale, left, bottom, noted):
    drawing = read(RECT, head)
    assert drawing.parts[0].at == pytest.approx(((12 - left) * scale, (bottom - 21) * scale, 0), abs=1e-9)
    assert material(drawing.parts[0]).area == pytest.approx(8 * scale**2)
    assert [("1 user unit" in note) for note in drawing.notes] == [True] * noted


@pytest.mark.parametrize(("unit", "mm"), [("mm", 1), ("in", 25.4), ("px", 25.4 / 96)])
def test_unit_overrides(unit, mm):
    for head in (PAGE, 'viewBox="0 0 100 100"', 'width="7in" viewBox="0 0 100 100"'):
        drawing = read(RECT, head, unit=unit)
        assert drawing.parts[0].at == pytest.approx((12 * mm, 79 * mm, 0))
        assert not drawing.notes


# Holes and nesting ---------------------------------------------------------------------------------------------------


def squares(*sides: tuple[float, bool]) -> str:
    """Concentric squares as one path; the flag turns one round."""
    data = ""
    for half, reverse in sides:
        a, b = 50 - half, 50 + half
        data += f"M{a} {a}H{b}V{b}H{a}z" if not reverse else f"M{a} {a}V{b}H{b}V{a}z"
    return data


@pytest.mark.parametrize(
    ("sides", "rule", "area", "regions", "holes"),
    [
        ([(10, False), (5, True)], "nonzero", 300, 1, 1),
        ([(10, False), (5, False)], "nonzero", 400, 1, 0),
        ([(10, False), (5, False)], "evenodd", 300, 1, 1),
        ([(10, False), (5, False), (2, True)], "evenodd", 316, 2, 1),
        ([(10, False), (5, True), (2, False)], "nonzero", 316, 2, 1),
        ([(10, False), (5, False), (2, True)], "nonzero", 400, 1, 0),
    ],
)
def test_fill_rules(sides, rule, area, regions, holes):
    for spelled in (f'fill-rule="{rule}"', f'style="fill-rule: {rule}"'):
        parts = read(f'<path {spelled} d="{squares(*sides)}"/>').parts
        assert sum(material(part).area for part in parts) == pytest.approx(area)
        found = [region for part in parts for region in part.regions]
        assert len(found) == len(parts) == regions
        assert sum(len(region.holes) for region in found) == holes
        for region in found:
            assert Polygon(region.outer).exterior.is_ccw
            assert not any(Polygon(hole).exterior.is_ccw for hole in region.holes)
        assert all(part.at == pytest.approx((50, 50, 0)) for part in parts)


def test_nested_parts_alternate():
    drawing = read(
        "".join(
            f'<rect id="r{s}" x="{50 - s}" y="{50 - s}" width="{2 * s}" height="{2 * s}"/>' for s in (40, 30, 20, 10)
        )
    )
    areas = [material(part).area for part in drawing.parts]
    assert areas == pytest.approx([80**2 - 60**2, 60**2 - 40**2, 40**2 - 20**2, 20**2])
    assert drawing.parts[0].at == pytest.approx((50, 50, 0))
    hole = drawing.parts[0].regions[0].holes[0]
    assert Polygon(hole).equals(Polygon(drawing.parts[1].regions[0].outer))


@pytest.mark.parametrize("half", [4.0, 5.0, 5.5])
def test_a_peg_in_a_ring_cuts_nothing(half):
    """Loose, touching, or too big: the ring has its hole already."""
    peg = f'<rect id="peg" x="{50 - half}" y="{50 - half}" width="{2 * half}" height="{2 * half}"/>'
    ring = f'<path id="ring" fill-rule="evenodd" d="{squares((10, False), (5, False))}"/>'
    drawing = read(ring + peg)
    assert [material(part).area for part in drawing.parts] == pytest.approx([300, 4 * half**2])


def test_a_jigsaw_in_a_plain_tray():
    """Holes that touch are one hole."""
    drawing = read(
        '<rect id="tray" width="60" height="60"/>'
        + "".join(f'<rect x="{10 + 20 * i}" y="{10 + 20 * j}" width="20" height="20"/>' for i in (0, 1) for j in (0, 1))
    )
    tray = drawing.parts[0]
    assert material(tray).area == pytest.approx(3600 - 1600)
    assert len(tray.regions[0].holes) == 1
    assert len(tray.regions[0].holes[0]) == 4


def test_an_inlay_flush_with_the_edge_is_a_notch():
    drawing = read('<rect id="plate" width="30" height="30"/><rect id="inlay" x="10" width="5" height="5"/>')
    assert [material(part).area for part in drawing.parts] == pytest.approx([875, 25])
    assert not drawing.parts[0].regions[0].holes


# Names and roles -----------------------------------------------------------------------------------------------------


def rect(i: int, more: str = "") -> str:
    return f'<rect {more} x="{10 * i}" width="5" height="5"/>'


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (rect(0) + rect(1, 'id="x"') + rect(2), ["p1", "x", "p3"]),
        (rect(0, 'inkscape:label="left side"') + rect(1, 'id="i" inkscape:label="l"'), ["left side", "l"]),
        (f'<g id="g">{rect(0)}</g><g id="h">{rect(1)}{rect(2)}</g>', ["g", "p2", "p3"]),
        (f'<g id="g">{rect(0)}<path d="M0 0L1 1"/></g>', ["g"]),
        (f'<g id="outer"><g>{rect(0)}</g></g>', ["outer"]),
        (f'<g id="outer"><g id="inner">{rect(0)}</g>{rect(1)}</g>', ["inner", "p2"]),
        (f'<g inkscape:label="layer">{rect(0)}</g>', ["layer"]),
        (rect(0, 'id="p2"') + rect(1), ["p2", "p2-2"]),
        (rect(0, 'inkscape:label="x"') + rect(1, 'inkscape:label="x"'), ["x", "x-2"]),
        ("<defs>" + rect(0, 'id="d"') + '</defs><use href="#d"/><use href="#d" y="20" id="u"/>', ["p1", "u"]),
    ],
)
def test_names(body, expected):
    assert names(read(body)) == expected


@pytest.mark.parametrize(
    "body",
    [
        rect(1, 'fill="red"'),
        rect(1, 'fill="#ff0000"'),
        rect(1, 'fill="rgb( 255, 0 , 0 )"'),
        f'<g fill="red">{rect(1)}</g>',
        '<g style="fill:#f00"><g>' + rect(1, 'stroke="blue"') + "</g></g>",
        "<style>.stand { fill: red }</style>" + rect(1, 'class="x stand" fill="blue"'),
        "<style><![CDATA[ #q, .z {fill:rgb(255 0 0)} rect {fill:blue} ]]></style>" + rect(1, 'id="q"'),
        '<g color="red">' + rect(1, 'fill="currentColor"') + "</g>",
        '<g id="fixed">' + rect(1) + rect(2) + "</g>",
        rect(1, 'id="fixed"'),
    ],
)
def test_fixed(body):
    drawing = read(body + rect(8, 'id="free"'))
    assert [part.fixed for part in drawing.parts] == [True] * (len(drawing.parts) - 1) + [False]


@pytest.mark.parametrize(
    "body",
    [
        rect(1, 'fill="#e00"'),
        rect(1, 'stroke="red"'),
        '<g fill="red">' + rect(1, 'fill="none"') + "</g>",
        "<style>.a{fill:red}</style>" + rect(1, 'style="fill:blue" class="a"'),
        "<style>g .a{fill:red}</style>" + rect(1, 'class="a"'),
    ],
)
def test_not_fixed(body):
    assert not read(body).parts[0].fixed


def test_glue():
    drawing = read(
        '<g id="glue-top">' + rect(0, 'id="a"') + f"<g>{rect(1)}</g></g>{rect(2)}"
        f'<g id="glue2">{rect(3)}</g><g inkscape:label="glue"><g id="glue3">{rect(4)}{rect(5)}</g>{rect(6)}</g>'
    )
    assert drawing.glue == (("a", "p2"), ("p5", "p6", "p7"))


def test_invisible_elements_are_no_parts():
    drawing = read(
        rect(0, 'id="a"')
        + rect(1, 'display="none"')
        + rect(2, 'style="display:none"')
        + rect(3, 'visibility="hidden"')
        + f'<g style="display:none">{rect(4)}</g><defs>{rect(5)}</defs><symbol>{rect(6)}</symbol>'
        + f"<clipPath>{rect(7)}</clipPath>"
        + f"<marker>{rect(8)}</marker><mask>{rect(9)}</mask><pattern>{rect(1)}</pattern><metadata>{rect(2)}</metadata>"
        + "<inkscape:rect/><style>.no{display:none}</style>"
        + rect(3, 'class="no"')
        + '<g visibility="hidden">'
        + rect(4, 'id="b" visibility="visible"')
        + "</g>"
    )
    assert names(drawing) == ["a", "b"]
    assert drawing.notes == (
        "drawing: 4 hidden rect elements are left out; only outlines are parts",
        "drawing: 1 hidden g elements are left out; only outlines are parts",
    )


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        ('<rect style="x:20px;width:10px;height:5px"/>', (20, 95, 30, 100)),
        ("<style>.c{r:4px;cx:10px}</style>" + '<circle class="c" cy="50"/>', (6, 46, 14, 54)),
        ("<path style=\"d:path('M0 0H10V5H0z')\"/>", (0, 95, 10, 100)),
        (
            '<defs><svg id="s" width="20" height="20" viewBox="0 0 10 10"><rect width="10" height="5"/></svg></defs>'
            '<use href="#s" x="50" width="40" height="40"/>',
            (50, 80, 90, 100),
        ),
        ("<style>rect{x:20px !important}</style>" + '<rect style="x:1px" width="5" height="5"/>', (20, 95, 25, 100)),
    ],
)
def test_places_and_sizes_that_styles_and_uses_set(body, bounds):
    (part,) = read(body).parts
    assert material(part).bounds == pytest.approx(bounds, abs=0.05)


@pytest.mark.parametrize(
    ("style", "named"),
    [
        ("translate:20px 10px", "translate"),
        ("scale:2", "scale"),
        ("transform-box:fill-box;transform:rotate(90deg)", "transform-box"),
    ],
)
def test_moving_by_other_means_than_transform_is_refused(style, named):
    with pytest.raises(InputError, match=f'rect in line 1: style property "{named}" is not followed'):
        read(f'<rect style="{style}" width="5" height="5"/>')


def test_style_rules_that_are_not_followed_are_named():
    drawing = read("<style>g > rect, .b:hover { display: none } .a { stroke: red }</style>" + rect(0))
    assert any(note.endswith("not: g > rect") for note in drawing.notes)


def test_what_is_left_out_is_said():
    drawing = read(
        rect(0) + '<path id="score" d="M0 0L9 9"/><line x2="9"/><text>hi</text><text>ho</text><image href="x.png"/>'
    )
    assert len(drawing.parts) == 1
    said = " ".join(drawing.notes)
    for words in ('"score", by its name', "1 end of lines", "2 text elements", "1 image elements"):
        assert words in said


@pytest.mark.parametrize("prefix", ["svg", "s"])
def test_prefixed_elements(prefix):
    rectangle = f'<{prefix}:rect id="a" width="4" height="4"/>'
    text = f'<{prefix}:svg xmlns:{prefix}="http://www.w3.org/2000/svg" {PAGE}>{rectangle}</{prefix}:svg>'
    assert names(read_svg(text)) == ["a"]


def test_plain_doctype_and_declared_encoding(tmp_path):
    path = tmp_path / "x.svg"
    text = '<?xml version="1.0" encoding="ISO-8859-1"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "x.dtd">'
    path.write_bytes((text + '<svg viewBox="0 0 9 9"><rect id="ä" width="4" height="4"/></svg>').encode("latin-1"))
    assert names(read_drawing(path)) == ["ä"]


# The way back --------------------------------------------------------------------------------------------------------


def assert_same_geometry(a: Drawing, b: Drawing, within: float = 1e-6) -> None:
    assert sorted(names(a)) == sorted(names(b))
    others = {part.name: part for part in b.parts}
    for part in a.parts:
        other = others[part.name]
        assert part.fixed == other.fixed
        assert len(part.regions) == len(other.regions)
        for r, s in zip(part.regions, other.regions, strict=True):
            for p, q in zip((r.outer, *r.holes), (s.outer, *s.holes), strict=True):
                p, q = place(p, part.at), place(q, other.at)
                start = int(np.hypot(*(q - p[0]).T).argmin())
                np.testing.assert_allclose(p, np.roll(q, -start, axis=0), atol=within)


@pytest.mark.parametrize("file", ["jointpanel_2x2", "pyjigsaw_4x5"])
def test_real_drawings_come_back(file, tmp_path):
    drawing = read_drawing(DRAWINGS / f"{file}.svg", gap=0.5)
    for extension in ("svg", "json"):
        write_drawing(drawing, tmp_path / f"x.{extension}")
        assert_same_geometry(drawing, read_drawing(tmp_path / f"x.{extension}"))


@settings(max_examples=15, deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(3, 9), st.floats(3, 9), st.floats(0, 360), st.booleans(), st.booleans()),
        min_size=1,
        max_size=6,
    ),
    st.sets(st.integers(0, 5), max_size=4),
)
def test_written_drawings_come_back(rows, glued):
    parts = []
    for i, (width, height, turn, fixed, holed) in enumerate(rows):
        outer = np.array([[-width, -height], [width, -height], [width, height], [-width, height]])
        region = Region(outer, (outer[::-1] / 2,) if holed else ())
        parts.append(Part(f'part "{i}" <&>', (region,), (20 + 30.0 * i, 20.0, np.radians(turn)), fixed))
    glue = tuple(parts[i].name for i in sorted(glued) if i < len(parts))
    assume(len(glue) != 1)
    drawing = Drawing(tuple(parts), glue=(glue,) if glue else ())
    text = write_svg(drawing)
    again = read_svg(text)
    assert_same_geometry(drawing, again)
    assert again.glue == drawing.glue
    assert not again.notes


def test_a_drawing_below_zero_is_moved_onto_the_page():
    square = Region(np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]]))
    text = write_svg([Part("a", (square,), (-10, -5, 0)), Part("b", (square,), (0, 0, 0))])
    assert 'viewBox="0 0 14 9"' in text
    again = read_svg(text)
    assert material(again.parts[0]).equals(box(0, 0, 4, 4))
    assert material(again.parts[1]).equals(box(10, 5, 14, 9))


def test_flatten_finer_than_numbers_allow_is_refused():
    with pytest.raises(InputError, match="at least 8e-08 mm"):
        read('<circle cx="50" cy="50" r="40"/>', flatten=1e-12)


# What a renderer does besides drawing --------------------------------------------------------------------------------

BAR = '<rect x="10" y="10" width="20" height="10"/>'


@pytest.mark.parametrize(
    ("body", "clipped"),
    [
        ('<clipPath id="c"><rect width="20" height="80"/></clipPath><g clip-path="url(#c)">{}</g>', 1),
        ('<clipPath id="c"><rect width="99" height="80"/></clipPath><g clip-path="url(#c)">{}</g>', 0),
        ('<clipPath id="c"><circle cx="20" cy="15" r="10.5"/></clipPath><g clip-path="url(#c)">{}</g>', 1),
        ('<style>.k {{ clip-path: inset(5px) }}</style><g class="k">{}</g>', 1),
        ('<g clip-path="url(#none)">{}</g>', 0),
        ('<mask id="m"><rect width="20" height="80" fill="white"/></mask><g mask="url(#m)">{}</g>', 1),
    ],
)
def test_what_is_clipped_is_said(body: str, clipped: int) -> None:
    drawing = read(body.format(BAR))
    assert material(drawing.parts[0]).area == pytest.approx(200)
    assert [note for note in drawing.notes if "clipped" in note] == [
        "drawing: 1 elements are clipped (clip-path or mask); they are read whole"
    ] * clipped


def test_transforms_are_about_their_origin() -> None:
    by_attribute = read('<rect x="40" y="30" width="20" height="10" transform="rotate(90)" transform-origin="50 35"/>')
    by_style = read(
        '<rect x="40" y="30" width="20" height="10" style="transform: scale(2); transform-origin: 50% left"/>'
    )
    assert material(by_attribute.parts[0]).bounds == pytest.approx((45, 55, 55, 75))
    assert material(by_style.parts[0]).bounds == pytest.approx((80, 70, 120, 90))
    with pytest.raises(InputError, match=r"line 1: .* is not a length"):
        read('<rect width="20" height="10" transform="scale(2)" transform-origin="a b"/>')


def test_of_a_switch_one_child_is_drawn() -> None:
    other = '<rect x="50" y="10" width="9" height="9"/>'
    adobe = '<foreignObject requiredExtensions="http://ns.adobe.com/AdobeIllustrator/10.0/"/>'
    assert len(read(f"<switch>{adobe}<g>{BAR}{other}</g></switch>").parts) == 2
    drawing = read(f'<switch><g systemLanguage="de">{other}</g>{BAR}{other}</switch>')
    assert [material(part).area for part in drawing.parts] == pytest.approx([200])


def test_namespaces_as_entities():
    """Adobe Illustrator declares its namespaces as entities, which are short plain texts."""
    drawing = read_svg(
        "<!DOCTYPE svg [<!ENTITY ns_svg \"http://www.w3.org/2000/svg\"> <!ENTITY ns_ai 'http://ns.adobe.com/AdobeIllustrator/10.0/'>]>"
        '<svg xmlns="&ns_svg;" xmlns:i="&ns_ai;" width="9mm" height="9mm" viewBox="0 0 9 9"><rect id="a" width="4" height="2"/></svg>'
    )
    assert [part.name for part in drawing.parts] == ["a"]


def test_a_view_box_without_a_size_is_ignored(tmp_path):
    file = tmp_path / "a.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96" viewBox="0 0 0 523"><rect width="9" height="8"/></svg>'
    )
    drawing = read_drawing(file)
    assert len(drawing.parts) == 1
    assert any('the viewBox "0 0 0 523" has no size' in note for note in drawing.notes)


def test_stretched_page():
    drawing = read(RECT, 'width="100mm" height="50mm" viewBox="0 0 100 100" preserveAspectRatio="none"')
    assert drawing.parts[0].at == pytest.approx((12, 39.5, 0))
    assert material(drawing.parts[0]).area == pytest.approx(4)


def test_reference_point_counts_no_holes():
    part = read('<path fill-rule="evenodd" d="M0 0H40V20H0z M30 5H38V15H30z"/>').parts[0]
    assert part.at == pytest.approx((20, 90, 0))


def test_a_round_peg_touching_a_ring_drawn_otherwise():
    ring = '<path fill-rule="evenodd" d="M30 30H70V70H30z M60 50A10 10 0 0 0 40 50A10 10 0 0 0 60 50z"/>'
    drawing = read(ring + '<circle cx="50" cy="50" r="10"/>', gap=1.0)
    assert len(drawing.parts[0].regions[0].holes) == 1
    assert material(drawing.parts[0]).intersection(material(drawing.parts[1])).area == pytest.approx(0, abs=1e-9)


def test_neighbours_that_only_interlock_cut_nothing():
    drawing = read('<path d="M0 0H30V30H20V10H0z"/><rect x="5" y="10" width="15" height="15"/>')
    assert [material(part).area for part in drawing.parts] == pytest.approx([500, 225])


def test_negative_gap_is_refused():
    with pytest.raises(InputError, match="gap is -1"):
        read(rect(0), gap=-1.0)
