"""DXF drawings: geometry against closed forms, loose edges, blocks, units, layers, names, and damaged files."""

from __future__ import annotations

import math
import random
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.test_svg_reader import material, names
from wiggleroom.drawing import read_drawing
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError

ezdxf = pytest.importorskip("ezdxf")
SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


class Sheet:
    """A DXF in the making."""

    def __init__(self, tmp_path: Path, version: str = "R2010", unit: int = 4) -> None:
        self.path = tmp_path / "x.dxf"
        self.doc = ezdxf.new(version)
        if version != "R12":
            self.doc.header["$INSUNITS"] = unit
        self.space = self.doc.modelspace()

    def read(self, binary: bool = False, **options) -> Drawing:
        if binary:
            stream = BytesIO()
            self.doc.write(stream, fmt="bin")
            self.path.write_bytes(stream.getvalue())
        else:
            stream = StringIO()
            self.doc.write(stream)
            self.path.write_bytes(self.doc.encode(stream.getvalue()))
        return read_drawing(self.path, **options)

    def block(self, name: str, points=SQUARE, base=(0, 0)):
        block = self.doc.blocks.new(name, base_point=base)
        if points:
            block.add_polyline2d(points, close=True)
        return block


@pytest.fixture
def sheet(tmp_path):
    return Sheet(tmp_path)


def area(drawing: Drawing, i: int = 0) -> float:
    return material(drawing.parts[i]).area


def lines(space, points, layer="0", order=None, turned=()) -> None:
    """Sides of a polygon as single lines, in any order and sense."""
    n = len(points)
    for i in order or range(n):
        ends = points[i], points[(i + 1) % n]
        space.add_line(*(ends[::-1] if i in turned else ends), dxfattribs={"layer": layer})


# Curves --------------------------------------------------------------------------------------------------------------


def slot(space, version):
    """10 x 10 with a half disc at the bottom (out) and one at the top (in)."""
    points = [(0, 0, 1.0), (10, 0, 0), (10, 10, -1.0), (0, 10, 0)]
    if version == "R12":
        space.add_polyline2d(points, format="xyb", close=True)
    else:
        space.add_lwpolyline(points, format="xyb", close=True)
    return 100.0


def circle(space, _):
    space.add_circle((7, 3), 5)
    return math.pi * 25


def full_arc(space, _):
    space.add_arc((7, 3), 5, 20, 20)
    return math.pi * 25


def half_disc(space, _):
    space.add_arc((0, 0), 5, 90, 270)
    space.add_line((0, -5), (0, 5))
    return math.pi * 12.5


def lens(space, _):
    """Two arcs of 90 degrees over one chord."""
    r = math.sqrt(8)
    space.add_arc((0, -2), r, 45, 135)
    space.add_arc((0, 2), r, 225, 315)
    return 2 * (math.pi * r * r / 4 - r * r / 2)


@pytest.mark.parametrize(
    ("draw", "version"),
    [(slot, version) for version in ("R12", "R2000", "R2018")]
    + [(draw, "R2010") for draw in (circle, full_arc, half_disc, lens)],
)
def test_curves_of_all_versions(tmp_path, draw, version):
    sheet = Sheet(tmp_path, version)
    truth = draw(sheet.space, version)
    for binary in (False, True):
        drawing = sheet.read(binary, flatten=1e-5)
        assert len(drawing.parts) == 1
        assert area(drawing) == pytest.approx(truth, rel=2e-5)
        assert [("no unit" in note) for note in drawing.notes] == [True] * (version == "R12")


def nurbs_circle(space):
    from ezdxf.math import rational_bspline_from_arc

    space.add_spline().apply_construction_tool(rational_bspline_from_arc((3, 4), 5, 0, 360))
    return math.pi * 25


def parabola(space):
    """A clamped spline of degree 2 is a parabola over its chord: area 2/3 of the box."""
    space.add_open_spline([(0, 0), (3, 6), (6, 0)], degree=2)
    space.add_line((6, 0), (0, 0))
    return 2 / 3 * 6 * 3


def quartic(space):
    """y = 0 at the ends, Bézier of degree 4: its area is that under the Bernstein polynomials."""
    space.add_open_spline([(0, 0), (1, 5), (2, 5), (3, 5), (4, 0)], degree=4)
    space.add_line((4, 0), (0, 0))
    return 4 * 15 / 5


def ellipse(space):
    space.add_ellipse((5, 5), (6, 3), 0.4)
    return math.pi * 45 * 0.4


@pytest.mark.parametrize("draw", [nurbs_circle, parabola, quartic, ellipse])
def test_splines_and_ellipses(sheet, draw):
    truth = draw(sheet.space)
    drawing = sheet.read(flatten=1e-5)
    assert len(drawing.parts) == 1
    assert not drawing.notes
    assert area(drawing) == pytest.approx(truth, rel=2e-5)


def test_splines_of_all_kinds_against_ezdxf(tmp_path):
    """Clamped, unclamped, with corners, rational: the corners lie on the curve that ezdxf evaluates."""
    random = np.random.default_rng(5)
    for degree in (2, 3, 4, 5):
        for kind in ("clamped", "unclamped", "corners", "rational"):
            sheet = Sheet(tmp_path)
            n, turn = 11, np.linspace(0, np.pi, 11)
            control = np.column_stack([np.cos(turn), np.sin(turn)]) * random.uniform(5, 9, (n, 1))
            inner = np.sort(random.uniform(0.1, 0.9, n - degree - 1))
            if kind == "corners":
                inner[:degree] = inner[0] = 0.05
            knots = np.r_[np.zeros(degree + 1), inner, np.ones(degree + 1)]
            if kind == "unclamped":
                knots = np.arange(n + degree + 1.0)
            weights = random.uniform(0.5, 2, n).tolist() if kind == "rational" else None
            spline = sheet.space.add_spline(degree=degree)
            spline.control_points = np.column_stack([control, np.zeros(n)]).tolist()
            spline.knots = knots.tolist()
            if weights:
                spline.weights = weights
            tool = spline.construction_tool()
            low, high = knots[degree], knots[n]
            ends = [tool.point(low), tool.point(high - 1e-12)]
            sheet.space.add_line(ends[0], ends[1])
            drawing = sheet.read(flatten=1e-3)
            ring = material(drawing.parts[0]).exterior
            truth = np.array([(p.x, p.y) for p in tool.points(np.linspace(low, high - 1e-12, 300))])
            assert shapely.distance(shapely.points(truth), ring).max() < 1.05e-3, (degree, kind)


def test_a_curve_and_its_reverse_give_the_same_points(sheet):
    """Neighbours that share a line of bulges share every corner of it."""
    wavy = [(0, 0, 0.7), (4, 1, -0.45), (9, 0, 0.8), (14, 0.5, 0.0)]
    back = [(x, y, -wavy[i - 1][2] if i else 0.0) for i, (x, y, _) in reversed(list(enumerate(wavy)))]
    sheet.space.add_lwpolyline([*wavy, (14, 20, 0), (0, 20, 0)], format="xyb", close=True)
    sheet.space.add_lwpolyline([*back, (0, -20, 0), (14, -20, 0)], format="xyb", close=True)
    a, b = (material(part) for part in sheet.read(flatten=1e-3).parts)
    assert shapely.get_num_coordinates(a) == shapely.get_num_coordinates(b)
    assert a.intersection(b).area == pytest.approx(0, abs=1e-12)
    assert a.union(b).area == pytest.approx(14 * 40, abs=1e-9)


# Blocks --------------------------------------------------------------------------------------------------------------


def test_blocks_scaled_mirrored_turned_and_nested(sheet):
    tip = sheet.block("tip", [(0, 0), (2, 0), (0, 1)], base=(1, 0))
    tip.add_circle((5, 0), 1)
    outer = sheet.block("outer", None, base=(3, 3))
    outer.add_blockref("tip", (3, 3), dxfattribs={"xscale": -2, "rotation": 90})
    sheet.space.add_blockref("outer", (100, 50), dxfattribs={"yscale": -1})
    sheet.space.add_blockref("outer", (0, 0), dxfattribs={"xscale": 3, "yscale": 3, "zscale": 3})
    drawing = sheet.read(flatten=1e-6)
    assert [round(area(drawing, i), 4) for i in range(4)] == pytest.approx([2, 2 * math.pi, 18, 18 * math.pi], abs=1e-3)
    # (x, y) of the tip -> -2 (x - 1), y -> turned by 90 degrees -> mirrored and moved to (100, 50)
    expected = [(100 - y, 50 + 2 * (x - 1)) for x, y in ((0, 0), (2, 0), (0, 1))]
    assert material(drawing.parts[0]).normalize().equals_exact(shapely.Polygon(expected).normalize(), 1e-9)
    assert drawing.parts[1].at[:2] == pytest.approx((100, 58), abs=1e-9)


def test_arrays_of_blocks(sheet):
    sheet.block("tile")
    sheet.space.add_blockref(
        "tile",
        (10, 20),
        dxfattribs={"row_count": 2, "column_count": 3, "row_spacing": 10, "column_spacing": 5, "rotation": 90},
    )
    drawing = sheet.read()
    middles = sorted(tuple(round(v, 9) for v in part.at[:2]) for part in drawing.parts)
    assert middles == sorted((8.0 - 10 * row, 22.0 + 5 * column) for row in range(2) for column in range(3))
    assert names(drawing)[:2] == ["tile", "tile-2"]


def test_mirrored_by_extrusion(sheet):
    """Extrusion (0, 0, -1) looks from below: x changes its sign."""
    sheet.space.add_lwpolyline([(1, 0), (5, 0), (5, 3)], close=True, dxfattribs={"extrusion": (0, 0, -1)})
    sheet.space.add_arc((10, 0), 2, 0, 180, dxfattribs={"extrusion": (0, 0, -1)})
    sheet.space.add_line((-12, 0), (-8, 0))
    drawing = sheet.read(flatten=1e-6)
    assert shapely.bounds(material(drawing.parts[0])).tolist() == pytest.approx([-5, 0, -1, 3])
    assert drawing.parts[1].at[0] == pytest.approx(-10)
    assert area(drawing, 1) == pytest.approx(2 * math.pi, rel=1e-5)


# Units ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "mm", "noted"),
    [
        (1, 25.4, 0),
        (2, 304.8, 0),
        (4, 1, 0),
        (5, 10, 0),
        (6, 1000, 0),
        (13, 1, 1),
        (14, 100, 0),
        (0, 1, 1),
        (3, 1, 1),
    ],
)
def test_units(tmp_path, code, mm, noted):
    sheet = Sheet(tmp_path, unit=code)
    sheet.space.add_lwpolyline([(x / 2, y / 2) for x, y in SQUARE], close=True)
    drawing = sheet.read()
    assert area(drawing) == pytest.approx(4 * mm * mm)
    assert len(drawing.notes) == noted
    again = sheet.read(unit="in")
    assert area(again) == pytest.approx(4 * 25.4**2)
    assert not again.notes


@pytest.mark.parametrize(
    ("code", "width", "mm"),
    [(1, 96, 96 * 25.4), (1, 331, 331), (6, 2, 2000), (6, 151, 151), (9, 11, 11 * 25.4), (9, 900, 900 * 0.0254), (13, 9e4, 90)],
)  # fmt: skip
def test_a_unit_that_no_machine_could_cut(tmp_path, code, width, mm):
    """Many programs write a unit of their own into files that are drawn in another one."""
    sheet = Sheet(tmp_path, unit=code)
    sheet.space.add_lwpolyline([(0, 0), (width, 0), (width, width / 3), (0, width / 3)], close=True)
    drawing = sheet.read()
    assert np.ptp(drawing.parts[0].regions[0].outer[:, 0]) == pytest.approx(mm)
    said = (code in (1, 6) and width < 100) or width >= 900
    assert any("is taken as none" in note for note in drawing.notes) != said


def test_countersinks_and_holes_in_holes(tmp_path):
    """A countersink is wider than the hole that is cut, and a hole in a window cuts nothing."""
    sheet = Sheet(tmp_path)
    sheet.space.add_lwpolyline([(0, 0), (90, 0), (90, 60), (0, 60)], close=True, dxfattribs={"layer": "boundary"})
    window = [(30, 10), (80, 10), (80, 50), (30, 50)]
    sheet.space.add_lwpolyline(window, close=True, dxfattribs={"layer": "led_cutout"})
    for center, radius, layer in (
        ((10, 10), 2, "mount_holes"),
        ((10, 10), 4, "mount_counter_sink"),
        ((50, 30), 2, "fixturing_holes"),
        ((60, 30), 2, "Countersunk 3"),
    ):
        sheet.space.add_circle(center, radius, dxfattribs={"layer": layer})
    drawing = sheet.read()
    assert len(drawing.parts) == 1
    holes = sorted(shapely.Polygon(hole).area for hole in drawing.parts[0].regions[0].holes)
    assert holes == pytest.approx([4 * np.pi, 2000], rel=1e-2)
    assert any("mount_counter_sink" in note for note in drawing.notes)


@pytest.mark.parametrize(("name", "parts"), [("ISO_A3_SHEET", 1), ("bracket", 1)])
def test_the_border_of_a_drawing_sheet(tmp_path, name, parts):
    """The frame of a sheet with a title block, as CAD programs print it, is not the part."""
    sheet = Sheet(tmp_path)
    block = sheet.doc.blocks.new(name)
    block.add_lwpolyline([(0, 0), (390, 0), (390, 287), (0, 287)], close=True, dxfattribs={"layer": "Border"})
    sheet.space.add_blockref(name, (15, 15))
    sheet.space.add_lwpolyline(
        [(100, 100), (190, 100), (190, 130), (100, 130)], close=True, dxfattribs={"layer": "Visible"}
    )
    drawing = sheet.read()
    assert len(drawing.parts) == parts
    width = np.ptp(drawing.parts[0].regions[0].outer[:, 0])
    assert width == pytest.approx(90 if "SHEET" in name else 390)


# Loose edges ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(2))
def test_loose_edges_in_any_order_and_sense(tmp_path, seed):
    """Three shapes of lines and arcs, shuffled, ends off by less than the tolerance."""
    lot = random.Random(seed)
    rng = np.random.default_rng(seed)
    sheet = Sheet(tmp_path)
    edges = []
    for x in (0, 40, 80):
        corners = [(x, 0), (x + 30, 0), (x + 30, 20), (x, 20)]
        edges += [(corners[i], corners[(i + 1) % 4]) for i in (0, 1, 3)]
    lot.shuffle(edges)
    for a, b in edges:
        ends = [tuple(np.array(p) + rng.uniform(-1e-4, 1e-4, 2)) for p in (a, b)]
        sheet.space.add_line(*(ends if lot.random() < 0.5 else ends[::-1]))
    for x in (0, 40, 80):
        sheet.space.add_arc((x + 15, 20), 15, 0, 180)
    drawing = sheet.read(flatten=1e-5)
    assert [area(drawing, i) for i in range(3)] == pytest.approx([600 + math.pi * 225 / 2] * 3, rel=1e-4)
    assert all("open ends were joined" in note for note in drawing.notes)


@pytest.mark.parametrize(("seed", "twice"), [(0, False), (1, True)])
def test_neighbours_share_their_lines(tmp_path, seed, twice):
    """A 3 x 2 tiling of single lines, each shared line drawn once, or everything drawn twice: six parts."""
    sheet = Sheet(tmp_path)
    edges = [((x, y), (x + 10, y)) for x in (0, 10, 20) for y in (0, 10, 20)]
    edges += [((x, y), (x, y + 10)) for x in (0, 10, 20, 30) for y in (0, 10)]
    edges *= 1 + twice
    random.Random(seed).shuffle(edges)
    for a, b in edges:
        sheet.space.add_line(a, b)
    drawing = sheet.read()
    assert [area(drawing, i) for i in range(6)] == pytest.approx([100] * 6)
    assert shapely.union_all([material(part) for part in drawing.parts]).area == pytest.approx(600)
    assert any("drawn twice" in note for note in drawing.notes) == twice


def test_a_bridge_between_outlines_is_no_edge_of_any(sheet):
    """A line from an outer square to an inner one, and one from there to nowhere."""
    lines(sheet.space, [(0, 0), (30, 0), (30, 30), (0, 30)], order=[3, 1, 0, 2])
    sheet.space.add_line((0, 0), (10, 10))
    lines(sheet.space, [(10, 10), (20, 10), (20, 20), (10, 20)], order=[1, 3, 2, 0])
    sheet.space.add_line((20, 20), (22, 25))
    drawing = sheet.read()
    assert [area(drawing, i) for i in range(len(drawing.parts))] == pytest.approx(
        [800]
    )  # the inner one is a hole, as ever
    assert any("open paths are left out" in note for note in drawing.notes)
    drawing = sheet.read(options=ReadOptions(solid=("all",)))
    assert sorted(area(drawing, i) for i in range(len(drawing.parts))) == pytest.approx([100, 800])


def test_open_edges_are_left_out_and_said(sheet):
    lines(sheet.space, SQUARE)
    sheet.space.add_line((20, 0), (30, 0))
    sheet.space.add_line((30, 0), (30, 9))
    sheet.space.add_line((4, 4), (9, 9))
    drawing = sheet.read()
    assert len(drawing.parts) == 1
    said = next(note for note in drawing.notes if "open paths are left out" in note)
    for words in ('LINE in layer "0" (#', "near (20, 0) mm", "near (30, 0) mm", "near (4, 4) mm"):
        assert words in said


def test_layers_keep_edges_apart(sheet):
    lines(sheet.space, SQUARE, layer="a")
    sheet.space.add_line((0, 0), (4, 4), dxfattribs={"layer": "score"})
    drawing = sheet.read()
    assert names(drawing) == ["a"]
    assert area(drawing) == pytest.approx(16)


# Names, roles, layers, holes -----------------------------------------------------------------------------------------


def test_names(sheet):
    sheet.block("wheel")
    sheet.block("many").add_lwpolyline([(10, 0), (14, 0), (14, 4)], close=True)
    sheet.space.add_blockref("wheel", (0, 100))
    sheet.space.add_blockref("many", (0, 200))
    for i, layer in enumerate(("alone", "both", "both", "0")):
        points = [(x + 10 * i, y) for x, y in SQUARE]
        sheet.space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    sheet.space.add_lwpolyline([(50, 0), (58, 0), (58, 8), (50, 8)], close=True)
    sheet.space.add_text("left side", height=1).set_placement((52, 2))
    sheet.space.add_lwpolyline([(70, 0), (78, 0), (78, 8), (70, 8)], close=True)
    sheet.space.add_mtext("two\\Plines", dxfattribs={"insert": (71, 5)})
    sheet.space.add_text("nowhere", height=1).set_placement((52, -20))
    drawing = sheet.read()
    assert names(drawing) == ["wheel", "p2", "p3", "alone", "p5", "p6", "p7", "left side", "two lines"]
    assert drawing.notes == ("x.dxf: 1 text elements are left out; only outlines are parts",)


def test_fixed_and_glued(sheet):
    sheet.block("fixed")
    sheet.block("glue-arm").add_lwpolyline([(4, 0), (8, 0), (8, 4)], close=True)
    sheet.space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "Fixed"})
    sheet.space.add_blockref("fixed", (10, 0))
    sheet.space.add_blockref("glue-arm", (20, 0))
    sheet.space.add_blockref("glue-arm", (40, 0))
    a, b = (
        sheet.space.add_lwpolyline([(x + d, y) for x, y in SQUARE], close=True, dxfattribs={"layer": "free"})
        for d in (60, 70)
    )
    with sheet.doc.groups.new("GLUE7").edit_data() as members:
        members.extend([a, b])
    drawing = sheet.read()
    assert [part.fixed for part in drawing.parts] == [True, True, False, False, False, False, False, False]
    assert drawing.glue == (("p3", "p4"), ("p5", "p6"), ("p7", "p8"))


def test_an_outline_inside_another_is_a_hole_unless_it_is_asked_for(sheet):
    sheet.space.add_lwpolyline([(0, 0), (9, 0), (9, 9), (0, 9)], close=True)
    sheet.space.add_circle((4, 4), 2)
    drawing = sheet.read(flatten=1e-5)
    assert [area(drawing, i) for i in range(len(drawing.parts))] == pytest.approx([81 - 4 * math.pi], rel=1e-4)
    assert "1 outline inside another is a hole (1 in p1)" in drawing.notes[0]
    for solid in ("all", "@4,4"):
        drawing = sheet.read(flatten=1e-5, options=ReadOptions(solid=(solid,)))
        assert [area(drawing, i) for i in range(2)] == pytest.approx([81 - 4 * math.pi, 4 * math.pi], rel=1e-4)


def test_what_is_hidden_or_no_outline(sheet):
    sheet.space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "cut"})
    for i, layer in enumerate(("off", "frozen", "labels", "defpoints"), 1):
        if layer != "defpoints":
            sheet.doc.layers.add(layer)
        points = [(x + 10 * i, y) for x, y in SQUARE]
        sheet.space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    sheet.doc.layers.get("off").off()
    sheet.doc.layers.get("frozen").freeze()
    sheet.space.add_lwpolyline([(90, 0), (94, 0), (94, 4)], close=True, dxfattribs={"invisible": 1})
    sheet.space.add_point((0, 0))
    sheet.space.add_hatch().paths.add_polyline_path(SQUARE)
    sheet.doc.paperspace().add_lwpolyline(SQUARE, close=True)
    sheet.space.add_line((1, 1), (1, 1))
    sheet.space.add_circle((0, 0), 3, dxfattribs={"extrusion": (1, 0, 0)})
    drawing = sheet.read()
    assert names(drawing) == ["cut"]
    said = " ".join(drawing.notes)
    for words in (
        "off or frozen are left out: frozen, off",
        "points and specks are left out",
        "1 HATCH",
        "1 tilted CIRCLE",
        "1 hidden LWPOLYLINE",
    ):
        assert words in said


def test_a_tilt_that_shortens_nothing(sheet):
    """A plane off by 0.1 degrees, as a model in space leaves it, shortens a circle by 2e-6 of its size."""
    sheet.space.add_lwpolyline(SQUARE, close=True)
    angle = math.radians(0.1)
    sheet.space.add_circle((2, 2), 1, dxfattribs={"extrusion": (math.sin(angle), 0, math.cos(angle))})
    (part,) = sheet.read().parts
    ((hole,),) = [region.holes for region in part.regions]
    assert np.ptp(hole, axis=0) == pytest.approx([2, 2], rel=1e-4)


def test_what_lies_in_another_file_is_said(sheet):
    sheet.space.add_lwpolyline(SQUARE, close=True)
    sheet.doc.add_xref_def("panel.dxf", "PANEL")
    sheet.space.add_blockref("PANEL", (20, 0))
    drawing = sheet.read()
    assert len(drawing.parts) == 1
    assert any('1 external reference "PANEL" elements are left out' in note for note in drawing.notes)


# Bad files -----------------------------------------------------------------------------------------------------------


def refused(path: Path, **options) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        read_drawing(path, **options)
    assert all("\n" not in line and line.startswith(path.name) for line in caught.value.findings)
    return caught.value.findings


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (b"", "is empty"),
        (b"0\nSECTION", "is cut short"),
        (b"0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n", "no closed outline"),
        (b"\x89PNG\r\n\x1a\n", "is not a DXF drawing"),
        (b"AC1027\0\0\0", "is a DWG drawing"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00\x00SECTION\x00", "is cut short"),
        (b"0\nSECTION\n2\nENTITIES\n0\nLINE\nten\n0\n0\nENDSEC\n0\nEOF\n", "x.dxf"),
    ],
)
def test_no_dxf(tmp_path, raw, said):
    (tmp_path / "x.dxf").write_bytes(raw)
    assert said in refused(tmp_path / "x.dxf")[0]


def test_the_smallest_dxf(tmp_path):
    """Only entities, no header and no tables, as simple programs write it; a comment before it."""
    sides = "".join(
        f"0\r\nLINE\r\n8\r\ncut\r\n10\r\n{a[0]}\r\n20\r\n{a[1]}\r\n11\r\n{b[0]}\r\n21\r\n{b[1]}\r\n"
        for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True)
    )
    text = f"999\r\nmade by hand\r\n0\r\nSECTION\r\n2\r\nENTITIES\r\n{sides}0\r\nENDSEC\r\n0\r\nEOF\r\n"
    (tmp_path / "x.dxf").write_text(text, newline="")
    drawing = read_drawing(tmp_path / "x.dxf")
    assert names(drawing) == ["cut"]
    assert area(drawing) == pytest.approx(16)
    assert "no unit" in drawing.notes[0]


@pytest.mark.parametrize(
    ("draw", "said"),
    [
        (lambda s: None, "no closed outline"),
        (lambda s: s.add_line((0, 0), (4, 4)), "but 1 open"),
        (lambda s: s.add_circle((0, 0), 0), "no closed outline, only 1 element without size"),
        (lambda s: s.add_circle((0, 0), -3), "radius is -3"),
        (lambda s: s.add_circle((0, 0), 1e12), "beyond 1e+09 mm"),
        (lambda s: s.add_lwpolyline([(0, 0), (1e300, 0), (0, 1e300)], close=True), "beyond 1e+09 mm"),
        (lambda s: s.add_circle((0, 0), 1e-9), "at least 1e-06 mm"),
        (lambda s: s.add_circle((float("nan"), 0), 1), "LINE"),
        (lambda s: s.add_blockref("nothing", (0, 0)), "is not in the file"),
        (lambda s: s.add_ellipse((0, 0), (1e-8, 0), 0.1), "at least 1e-06 mm"),
    ],
)
def test_bad_drawings(sheet, draw, said):
    draw(sheet.space)
    with pytest.raises(InputError) as caught:
        sheet.read()
    assert len(caught.value.findings) == 1
    assert said in caught.value.findings[0] or said == "LINE"


def hatched(space, x: float) -> None:
    """A filled square, whose boundary is no entity of its own."""
    hatch = space.add_hatch(color=1, dxfattribs={"layer": "fill"})
    hatch.paths.add_polyline_path([(x, 0), (x + 4, 0), (x + 4, 4), (x, 4)], is_closed=True)


def test_filled_areas_alone_are_refused_in_one_line(sheet):
    """What there is, where, and what would be right."""
    for x in (0, 5):
        hatched(sheet.space, x)
    with pytest.raises(InputError) as caught:
        sheet.read()
    assert list(caught.value.findings) == [
        'x.dxf: has no closed outline, only 2 HATCH (filled, on layer "fill"); '
        "draw the boundary of every part as a closed line"
    ]


def test_blocks_without_end(sheet):
    """In themselves, in a ring, and copies of copies of copies."""
    one, two = sheet.block("one", None), sheet.block("two", None)
    one.add_blockref("two", (1, 0))
    two.add_blockref("one", (1, 0))
    sheet.space.add_blockref("one", (0, 0))
    with pytest.raises(InputError, match="holds itself"):
        sheet.read()


def test_copies_of_copies(sheet, monkeypatch):
    monkeypatch.setattr("wiggleroom.drawing.readers.dxf_walk.MAX_ELEMENTS", 1000)
    for i in range(12):
        block = sheet.block(f"b{i}", SQUARE if i == 0 else None)
        for k in range(10 if i else 0):
            block.add_blockref(f"b{i - 1}", (k * 10**i, 0))
    sheet.space.add_blockref("b11", (0, 0))
    with pytest.raises(InputError, match="more than 1000 elements"):
        sheet.read()


def everything(tmp_path, version="R2010") -> bytes:
    sheet = Sheet(tmp_path, version)
    slot(sheet.space, version)
    sheet.space.add_circle((50, 0), 4, dxfattribs={"layer": "fixed"})
    lines(sheet.space, [(100 + x, y) for x, y in SQUARE])
    sheet.block("b").add_arc((20, 0), 2, 0, 360)
    sheet.space.add_blockref("b", (0, 50), dxfattribs={"column_count": 2, "column_spacing": 60})
    if version != "R12":
        sheet.space.add_ellipse((150, 0), (5, 0), 0.5)
        sheet.space.add_open_spline([(200, 0), (210, 9), (220, 0)], degree=2)
        sheet.space.add_line((200, 0), (220, 0))
    sheet.read()
    return sheet.path.read_bytes()


def parts_or_findings(path: Path):
    try:
        return read_drawing(path).parts, ()
    except InputError as error:
        return (), error.findings


@pytest.mark.parametrize("version", ["R12", "R2010"])
def test_cut_short(tmp_path, version):
    raw = everything(tmp_path, version)
    path = tmp_path / "x.dxf"
    for share in np.linspace(0.01, 0.999, 10):
        path.write_bytes(raw[: int(share * len(raw))])
        assert len(refused(path)) == 1


@pytest.mark.parametrize("seed", range(3))
def test_damaged(tmp_path, seed):
    """Lines changed, dropped or doubled at random: read or refused, nothing else."""
    lot = random.Random(seed)
    good = everything(tmp_path, lot.choice(["R12", "R2010"])).split(b"\n")
    first = next(i for i, line in enumerate(good) if line.strip() == b"ENTITIES")
    path = tmp_path / "x.dxf"
    values = [b"1e308", b"-1", b"nan", b"inf", b"0", b"", b"LINE", b"999999999", b"x", b"\xff\xfe", b"-1e-300", b"70"]
    for _ in range(6):
        rows = list(good)
        for _ in range(lot.randint(1, 5)):
            at = lot.randrange(first if lot.random() < 0.8 else 0, len(rows) - 4)
            kind = lot.random()
            if kind < 0.7:
                rows[at] = lot.choice(values)
            elif kind < 0.85:
                del rows[at]
            else:
                rows.insert(at, rows[at])
        path.write_bytes(b"\n".join(rows))
        parts, findings = parts_or_findings(path)
        assert parts or findings
        assert all("\n" not in line for line in findings)
        assert all(np.isfinite(region.outer).all() for part in parts for region in part.regions)


def _with_centre_line(tmp_path, **line):
    document = ezdxf.new("R2000", units=4, setup=True)
    space = document.modelspace()
    document.layers.add("axes", linetype="CENTER")
    space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True)
    space.add_line((-5, 20), (65, 20), dxfattribs=line)
    path = tmp_path / "part.dxf"
    document.saveas(path)
    return path


@pytest.mark.parametrize("line", [{"linetype": "CENTER"}, {"linetype": "HIDDEN2"}, {"layer": "axes"}])
def test_centre_lines_and_hidden_edges_cut_nothing(tmp_path, line):
    drawing = read_drawing(_with_centre_line(tmp_path, **line))
    assert len(drawing.parts) == 1
    assert any("drawn with line type" in note for note in drawing.notes)


def test_a_drawing_of_centre_lines_alone_is_read(tmp_path):
    document = ezdxf.new("R2000", units=4, setup=True)
    square = [(0, 0), (60, 0), (60, 40), (0, 40)]
    document.modelspace().add_lwpolyline(square, close=True, dxfattribs={"linetype": "CENTER"})
    document.saveas(tmp_path / "part.dxf")
    assert len(read_drawing(tmp_path / "part.dxf").parts) == 1


def test_a_hole_in_nothing_is_an_error(sheet):
    sheet.space.add_lwpolyline(SQUARE, close=True)
    sheet.space.add_circle((40, 4), 2, dxfattribs={"layer": "holes"})
    with pytest.raises(InputError, match="lies in no part"):
        sheet.read()


@pytest.mark.parametrize("seed", range(3))
def test_a_jigsaw_of_shared_curves(tmp_path, seed):
    """Four pieces whose inner lines, of lines and arcs, are each drawn once."""
    lot = random.Random(seed)
    sheet = Sheet(tmp_path)
    rim = [(0, 0), (20, 0), (40, 0), (40, 20), (40, 40), (20, 40), (0, 40), (0, 20)]
    knobs = [((20, 0), (20, 20)), ((20, 20), (20, 40)), ((0, 20), (20, 20)), ((20, 20), (40, 20))]
    calls = [lambda a=rim[i], b=rim[(i + 1) % 8]: sheet.space.add_line(a, b) for i in range(8)]
    for a, b in knobs:
        along = (np.array(b) - a) / 20
        first, second = (tuple(a + along * d) for d in (7, 13))
        calls.append(lambda a=a, b=first: sheet.space.add_line(b, a))
        calls.append(lambda a=b, b=second: sheet.space.add_line(b, a))
        calls.append(lambda a=first, b=second: sheet.space.add_lwpolyline([(*a, 1.0), (*b, 0.0)], format="xyb"))
    lot.shuffle(calls)
    for call in calls:
        call()
    drawing = sheet.read(flatten=1e-5)
    knob = math.pi * 9 / 2
    # seen along its line every knob bulges to the right: from the left pieces, the lower ones take, and so on
    assert sorted(area(drawing, i) for i in range(4)) == pytest.approx(
        sorted([400 + knob - knob, 400 - knob - knob, 400 + knob + knob, 400 - knob + knob]), rel=1e-4
    )
    shapes = [material(part) for part in drawing.parts]
    assert shapely.union_all(shapes).area == pytest.approx(1600, abs=1e-9)
    assert drawing.notes == ("x.dxf: 4 faces of open lines taken as parts",)


def test_edges_may_lie_on_one_another_in_part_in_any_order(sheet):
    lines(sheet.space, [(0, 0), (20, 0), (20, 10), (0, 10)], order=[2, 0, 3, 1])
    lines(sheet.space, [(0, 0), (10, 0), (10, -10), (0, -10)], order=[1, 3, 0, 2])
    drawing = sheet.read()
    assert [area(drawing, i) for i in range(2)] == pytest.approx([200, 100])


def test_filled_areas_beside_outlines_are_left_out_and_said(sheet):
    hatched(sheet.space, 0)
    sheet.space.add_lwpolyline(SQUARE, close=True)
    drawing = sheet.read()
    assert len(drawing.parts) == 1
    assert 'x.dxf: 1 HATCH (filled, on layer "fill") elements are left out; only outlines are parts' in drawing.notes


def test_holes_pegs_and_trays(sheet):
    def box(half, layer="cut"):
        points = [(-half, -half), (half, -half), (half, half), (-half, half)]
        sheet.space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})

    box(50)
    box(20, "holes")
    box(19)
    box(5, "Hole_small")
    drawing = sheet.read()
    assert [area(drawing, i) for i in range(2)] == pytest.approx([100**2 - 40**2, 38**2 - 10**2])
    assert not drawing.notes
    box(2)
    drawing = sheet.read()
    assert area(drawing, 2) == pytest.approx(16)
    assert not drawing.notes


@pytest.mark.parametrize("name", ["base_origin", "Design_Template"])
def test_layers_beside_the_parts(sheet, name):
    lines(sheet.space, SQUARE, layer="base")
    lines(sheet.space, [(1, 1), (3, 1), (3, 3), (1, 3)], layer=name)
    assert len(sheet.read().parts[0].regions[0].holes) == 0


def test_lines_without_gaps_cut(tmp_path):
    assert len(read_drawing(_with_centre_line(tmp_path)).parts) == 2


def test_parts_drawn_one_after_the_other_may_lie_on_one_another_in_part(sheet):
    """A brick bond: edges of neighbours overlap along part of their length."""
    for x, y in ((0, 0), (20, 0), (10, 10)):
        lines(sheet.space, [(x, y), (x + 20, y), (x + 20, y + 10), (x, y + 10)])
    drawing = sheet.read()
    assert [area(drawing, i) for i in range(3)] == pytest.approx([200] * 3)


def test_polylines_without_classes(tmp_path):
    """OpenJSCAD writes newer polylines without the classes that these name."""
    corners = "".join(f"10\n{x}\n20\n{y}\n" for x, y in SQUARE)
    body = "0\nSECTION\n2\nHEADER\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
    body += f"  0\nLWPOLYLINE\n  8\nOpenJsCad\n  90\n4\n  70\n1\n{corners}  0\nENDSEC\n  0\nEOF\n"
    (tmp_path / "x.dxf").write_text(body)
    drawing = read_drawing(tmp_path / "x.dxf")
    assert area(drawing) == pytest.approx(16)
    assert names(drawing) == ["OpenJsCad"]


def test_tangent_curves_are_told_apart(sheet):
    """Two lenses whose arcs leave a point along one tangent, drawn in a mixed order."""
    sheet.space.add_arc((0, 5), 5, 270, 90)
    sheet.space.add_arc((0, 8), 8, 270, 90)
    sheet.space.add_line((0, 10), (0, 16))
    sheet.space.add_line((0, 0), (0, 10))
    drawing = sheet.read(flatten=1e-4)
    assert sorted(area(drawing, i) for i in range(2)) == pytest.approx(
        [math.pi * 12.5, math.pi * (64 - 25) / 2], rel=1e-3
    )


def test_the_same_outline_twice(sheet):
    for _ in range(2):
        sheet.space.add_lwpolyline(SQUARE, close=True)
        sheet.space.add_circle((20, 0), 3)
    drawing = sheet.read()
    assert len(drawing.parts) == 2
    assert "2 lines or outlines are drawn twice" in drawing.notes[0]


def test_unevenly_scaled_circle_and_bulge(sheet):
    block = sheet.block("b", None)
    block.add_lwpolyline([(0, 0, 1), (4, 0, 0)], format="xyb", close=True)
    sheet.space.add_blockref("b", (0, 0), dxfattribs={"xscale": 3, "yscale": 0.5, "rotation": 33})
    assert area(sheet.read(flatten=1e-6)) == pytest.approx(2 * math.pi * 1.5, rel=1e-6)
