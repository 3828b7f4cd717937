"""What a laser leaves: slots, notches and reliefs cut the parts whose edges they cross, judged by shapely on the true shapes."""

from __future__ import annotations

import math
from functools import reduce

import pytest
from shapely import Polygon

from tests.cut_drawings import CutCase, Line, assert_left, disc, polygons, rect, written
from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.read import reading
from wiggleroom.drawing.strokes.read_options import ReadOptions

PANEL = rect(10, 10, 80, 40)
FLATTEN = 1e-3


def minus(whole: Line, *cuts: Line) -> Polygon:
    return reduce(lambda rest, cut: rest.difference(cut.shape), cuts, whole.shape)


def case(name: str, whole: Line, *cuts: Line, more: tuple[Line, ...] = (), noted: str = "", **given) -> CutCase:
    """One panel and its cuts; other parts lie apart."""
    left = [minus(whole, *cuts), *(line.shape for line in more)]
    return CutCase(name, [whole, *cuts, *more], left, noted, **given)


SLOT = rect(48, 30, 3, 23)
NOTCH = rect(70, 40, 5, 10)
BOARDS = [rect(10, 10, 80, 40), rect(90, 10, 80, 40)]
KEY = rect(85, 25, 10, 8)
COMB = [rect(15 + 10 * k, 40, 3, 15) for k in range(30)]
ACROSS = "1 outline across the edge of a part cuts it"

CUTS = [
    case("a slot over the edge", PANEL, SLOT, noted=ACROSS),
    case("a row of windows beside one of their size", PANEL, *(rect(20 + 8 * k, 20, 8, 8) for k in range(4)), rect(70, 30, 8, 8),
         noted="5 outlines inside others are holes"),
    case("a hole drawn twice, a little aside", PANEL, disc(40, 30, 3), disc(40.05, 30.02, 3), noted="2 of them touch each other"),
    CutCase("a slot over the edge, drawn first", [SLOT, PANEL], [minus(PANEL, SLOT)], ACROSS),
    case("a slot over two edges at a corner", PANEL, rect(85, 45, 10, 10), noted=ACROSS),
    case("a notch flush with the edge", PANEL, rect(70, 40, 5, 10), noted="1 outline inside another is a hole"),
    CutCase("a notch a nanometre inside the edge", [PANEL, rect(70, 40, 5, 10 - 1e-6)], [minus(PANEL, NOTCH)]),
    CutCase("a notch a hair over the edge", [PANEL, rect(70, 40, 5, 10 + 1e-6)], [minus(PANEL, NOTCH)]),
    case("a notch in every edge", PANEL, rect(30, 45, 5, 5), rect(30, 10, 5, 5), rect(10, 20, 5, 5), rect(85, 20, 5, 5)),
    case("two slots that touch", PANEL, rect(40, 25, 20, 5), rect(45, 30, 10, 5), noted="2 of them touch"),
    case("a slot in the form of a cross", PANEL, rect(40, 28, 20, 4), rect(48, 20, 4, 20), noted="2 outlines inside others"),
    case("a keyhole", PANEL, disc(50, 30, 4), rect(48.5, 20, 3, 8)),
    case("dog bones in a slot over the edge", PANEL, rect(48, 30, 6, 25), disc(48, 30, 1), disc(54, 30, 1)),
    case("a relief on a corner of the panel", PANEL, disc(90, 50, 2), noted=ACROSS),
    case("windows that overlap", PANEL, rect(20, 15, 25, 20), rect(40, 20, 30, 20)),
    case("two holes that touch in a point", PANEL, disc(40, 30, 5), disc(50, 30, 5), rings=False),
    case("half laps along an edge", rect(10, 10, 320, 40), *COMB, noted="30 outlines across the edges of parts cut them"),
    case("a slot drawn twice", PANEL, SLOT, SLOT, noted="drawn twice"),
    case("a slot over the edge of a hole", PANEL, disc(50, 30, 10), rect(38, 28, 6, 4)),
    case("a slot that shares a stretch of the edge", PANEL, Line(((30, 50), (50, 50), (50, 40), (40, 40), (40, 45), (30, 45)))),
    case("a slot with a hole of its own beyond the edge", PANEL, SLOT, disc(48, 53, 1)),
    case("by name, in another colour", PANEL, rect(48, 30, 3, 23, "slot 1", colour="#ff0000"), formats="svg lbrn2"),
    case("by name, large", PANEL, rect(20, 30, 60, 30, "notch_hole"), formats="svg lbrn2"),
    case("by layer, over the edge", PANEL, rect(48, 30, 3, 23, layer="holes", colour="#ff0000")),
    case("by layer, touching each other and the edge", PANEL,
         *(rect(x, y, w, h, layer="Löcher") for x, y, w, h in ((40, 25, 20, 5), (45, 30, 10, 5), (70, 40, 5, 10)))),
    case("by layer of inner cuts, in another colour", PANEL, rect(48, 30, 3, 23, layer="Inner cuts", colour="#0000ff")),
    case("by option", PANEL, rect(30, 30, 40, 30, "thing", colour="#ff0000"), hole=("thing",), formats="svg lbrn2"),
    case("by a point", PANEL, rect(30, 30, 40, 30, colour="#ff0000"), hole=("@40,55",)),
    CutCase("a part in a hole, with a slot over its edge", [PANEL, rect(20, 15, 60, 30), rect(30, 20, 20, 20), rect(38, 35, 3, 8)],
            [minus(PANEL, rect(20, 15, 60, 30)), minus(rect(30, 20, 20, 20), rect(38, 35, 3, 8))]),
    CutCase("a part in a notch", [PANEL, rect(40, 30, 20, 25, "notch"), rect(42, 32, 16, 15)],
            [minus(PANEL, rect(40, 30, 20, 25)), rect(42, 32, 16, 15).shape], formats="svg lbrn2"),
    CutCase("slots of a layer cut a part in two", [PANEL, *(rect(45, y, 6, 15, layer="holes") for y in (8, 20, 30, 42))],
            [rect(10, 10, 35, 40).shape, rect(51, 10, 39, 40).shape], "each piece is a part"),
    CutCase("a slot by option cuts a part in two", [PANEL, rect(45, 0, 6, 70)],
            [rect(10, 10, 35, 40).shape, rect(51, 10, 39, 40).shape], "each piece is a part", hole=("@48,60",)),
]  # fmt: skip

ASKED = [
    CutCase("a key over two boards", [*BOARDS, KEY], asked="--hole p3"),
    CutCase("a part with a name", [rect(10, 10, 80, 40, "board"), rect(48, 30, 3, 23, "peg")], asked="--hole peg", formats="svg lbrn2"),
    CutCase("a part pressed into another one", [PANEL, rect(40, 49.9, 8, 8)], asked="overlap by 0.1 mm"),
    CutCase("a strip across", [PANEL, rect(48, 5, 3, 50)], asked="in pieces; --hole @49.5,30"),
    CutCase("a hole in nothing", [PANEL, *(disc(120 + 10 * k, 30, 2, layer="holes") for k in range(9))], asked="(and 8 more)"),
    CutCase("an option that names nothing", [PANEL], hole=("slt",), asked="--hole slt: no outline is called so"),
    CutCase("many parts over one", [rect(10, 10, 320, 40), *(rect(15 + 10 * k, 40, 3, 15, colour="#ff0000") for k in range(30))],
            asked='overlaps 30 others ("p2", "p3", "p4", ...) by up to'),
]  # fmt: skip
"""Drawings that do not say whether an outline is a cut or a part."""


def read(case: CutCase, style: str, tmp_path):
    path = written(case.lines, tmp_path / f"x.{style}")
    return reading(path, flatten=FLATTEN, options=ReadOptions(hole=case.hole))


def every(cases):
    return [pytest.param(c, style, id=f"{c.name} ({style})") for c in cases for style in c.formats.split()]


TILES = [rect(30 + 10 * k, 20, 10, 10) for k in range(3)]
SOCKET = Line(((0, 0), (40, 0), (35, 15), (65, 15), (60, 0), (100, 0), (100, 60), (0, 60)))
KEYSTONE = Line(((40, 0), (35, 15), (65, 15), (60, 0)))
KEPT = [
    CutCase("tiles in a tray", [PANEL, *TILES], [minus(PANEL, *TILES), *(tile.shape for tile in TILES)],
            "3 outlines inside others are parts, as they touch each other or the edge"),
    CutCase("large pieces in a tray", [PANEL, rect(20, 15, 40, 20), rect(60, 15, 20, 20)],
            [minus(PANEL, rect(20, 15, 60, 20)), rect(20, 15, 40, 20).shape, rect(60, 15, 20, 20).shape], "are parts, as they touch"),
    CutCase("a dovetail beside its socket", [SOCKET, KEYSTONE], [minus(rect(0, 0, 100, 60), KEYSTONE), KEYSTONE.shape]),
    CutCase("a ring in a ring", [disc(60, 60, 40), disc(60, 60, 30), disc(60, 60, 29.9), disc(60, 60, 10)],
            [minus(disc(60, 60, 40), disc(60, 60, 30)), minus(disc(60, 60, 29.9), disc(60, 60, 10))]),
    CutCase("a disc pressed into a hole", [PANEL, disc(40, 30, 10), disc(40, 30, 10.03)],
            [minus(PANEL, disc(40, 30, 10.03)), disc(40, 30, 10).shape]),
]  # fmt: skip
"""Drawings of parts that fit together, none of which is a cut."""


@pytest.mark.parametrize(("case", "style"), every([*CUTS, *KEPT]))
def test_what_the_laser_leaves(case, style, tmp_path):
    found = read(case, style, tmp_path)
    assert not found.findings
    assert_left(found.drawing, case.left, slack=3 * FLATTEN, rings=case.rings)
    assert not examine(found.drawing)[1]
    assert case.noted in " ".join(found.drawing.notes)


@pytest.mark.parametrize(("case", "style"), every(ASKED))
def test_what_may_be_a_part_is_asked(case, style, tmp_path):
    found = read(case, style, tmp_path)
    lines = [*found.findings, *examine(found.drawing)[1]]
    assert any(case.asked in line for line in lines), lines
    assert len(lines) == 1 or case.name == "a key over two boards"


HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="200mm" height="100mm" viewBox="0 0 200 100">'
)
LINE = 'fill="none" stroke="#000"'


def path_of(data: str) -> str:
    return f'<path d="{data}" {LINE}/>'


def box(x: float, y: float, w: float, h: float, more: str = LINE) -> str:
    return f'<rect x="{x}" y="{y}" width="{w}" height="{h}" {more}/>'


SPECKS = (
    f'<path d="M5 5" {LINE}/><path d="M5 5z" {LINE}/><path d="m 20,55 0,0" {LINE}/><path d="M20 60L20 60Z" {LINE}/>'
    f'<circle cx="5" cy="5" r="0" {LINE}/><circle cx="5" cy="5" r="0.001" {LINE}/><rect x="3" width="0" height="5" {LINE}/>'
    f'<path d="" {LINE}/><path d="M100 60 l0.000001 0 l 0 0.000001 z" {LINE}/><line x1="3" y1="3" x2="3" y2="3" {LINE}/>'
)
SHEET = box(10, 10, 80, 40)
TAB = box(48, 5, 3, 20)
"""45 mm2 of it lie over the sheet."""
SYMBOL = (
    f'<defs><symbol id="s" viewBox="0 0 10 10">{box(0, 0, 10, 10)}<circle cx="5" cy="5" r="2" {LINE}/></symbol></defs>'
)
TEXTS = (
    '<text x="95" y="95">hi</text><image href="x.png" width="9" height="9"/><flowRoot><flowPara>a</flowPara></flowRoot>'
)
CLIPPED = '<clipPath id="c"><rect width="5" height="5"/></clipPath>'
HIDDEN = box(0, 0, 5, 5, f'{LINE} display="none"') + f'<g visibility="hidden">{box(99, 0, 5, 5)}</g>'
TEMPLATES = f'<defs>{TAB}</defs><pattern id="p">{TAB}</pattern><marker id="m">{TAB}</marker><mask id="k">{TAB}</mask>'
LOOSE = "".join(path_of(d) for d in ("M48 5V25", "M51 25H48", "M51 25V5", "M51 5H48"))
WHITE = box(10, 10, 80, 40, 'fill="#ccc" stroke="#000"') + box(48, 5, 3, 20, 'fill="#fff" stroke="#000"')
LABELLED = SHEET.replace("<rect", '<rect inkscape:label="Lid"') + TAB.replace("<rect", '<rect inkscape:label="Slot 1"')
CIRCLE = f'<circle id="h" cx="20" cy="30" r="3" {LINE}/>'
OPEN = "open paths are left out"
ONE = "1 outline across"

SVGS = [
    ("specks", SHEET + SPECKS, [3200], "10 points and specks are left out"),
    ("specks in a path", path_of("M10 10h80v40h-80z M20 20z M30 30l0 0z M50 20h10v10h-10z M70 20l1e-4 0z"), [3100],
        "2 points"),
    ("a closed line cuts", SHEET + path_of("M50 0V60Z"), [1600, 1600], "1 outline cut"),
    ("texts and images", SHEET + TEXTS, [3200], "1 image elements are left out"),
    ("a symbol used twice",
        SYMBOL + '<use href="#s" width="20" height="20"/><use href="#s" x="40" width="40" height="20"/>',
        [400 - 16 * math.pi, 400 - 16 * math.pi], "2 outlines inside others are holes"),
    ("a mirrored copy", f'<g id="a">{SHEET}{TAB}</g><use xlink:href="#a" transform="translate(200) scale(-1,1)"/>',
        [3155, 3155], "2 outlines across"),
    ("clipped away", f'{CLIPPED}<g clip-path="url(#c)">{SHEET}</g>{box(100, 0, 20, 20)}', [400], "1 clipped rect"),
    ("clipped in part", f'<svg x="10" y="10" width="10" height="10">{box(0, 0, 20, 20)}</svg>', [400], "read whole"),
    ("hidden", SHEET + HIDDEN, [3200], "2 hidden rect"),
    ("templates", SHEET + TEMPLATES, [3200], ""),
    ("a switch",
        f'<switch><foreignObject requiredExtensions="http://x"/><g>{SHEET}{TAB}</g><g>{SHEET}</g></switch>', [3155],
        ONE),
    ("a slot of loose lines", SHEET + LOOSE, [3155], ONE),
    ("an open slot by name", f'{SHEET}<g id="slots">{path_of("M48 5V25H51V5")}</g>', [3155], ONE),
    ("a white slot", WHITE, [3155], ONE),
    ("a cut line beside slots", SHEET + box(20, 5, 3, 20) + box(70, 5, 3, 20) + path_of("M50 10V50"), [1555, 1555],
        "2 outlines across"),
    ("a piece within cut lines", SHEET + path_of("M10 30H35M65 30H90") + box(35, 20, 30, 20), [1300, 1300, 600],
        "2 faces"),
    ("a hole with a centre mark", SHEET + CIRCLE + path_of("M15 30H25M20 25V35"), [3200 - 9 * math.pi],
        "4 outlines inside others are holes"),
    ("overcuts", SHEET + TAB + path_of("M48 25l-1 1"), [3155], OPEN),
    ("labels", LABELLED, [3155], "(1 in Lid)"),
    ("overlaps by rounding", SHEET + box(89.9999995, 10, 30, 40), [3200, 1200], "are taken to touch"),
]  # fmt: skip


@pytest.mark.parametrize(("body", "areas", "noted"), [row[1:] for row in SVGS], ids=[row[0] for row in SVGS])
def test_svgs_of_drawing_programs(body, areas, noted, tmp_path):
    path = tmp_path / "x.svg"
    path.write_text(f"{HEAD}{body}</svg>")
    found = reading(path, flatten=1e-4)
    assert not found.findings
    assert not examine(found.drawing)[1]
    assert sorted(shape.area for shape in polygons(found.drawing)) == pytest.approx(sorted(areas), abs=0.01)
    assert noted in " ".join(found.drawing.notes)


def test_specks_do_not_change_the_chord_error(tmp_path):
    alone, among = tmp_path / "a.svg", tmp_path / "b.svg"
    disc_ = f'<circle cx="40" cy="40" r="30" {LINE}/>'
    alone.write_text(f"{HEAD}{disc_}</svg>")
    among.write_text(f"{HEAD}{disc_}{SPECKS}</svg>")
    first, second = (reading(path).drawing for path in (alone, among))
    assert len(first.parts[0].regions[0].outer) == len(second.parts[0].regions[0].outer)


def test_mirrored_and_stretched_blocks(tmp_path):
    """A panel with a slot over its edge and a hole, 756 mm2 and more by the scale."""
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    block, space = document.blocks.new("side"), document.modelspace()
    for line in (rect(0, 0, 40, 20), rect(10, 15, 3, 8)):
        block.add_lwpolyline(line.corners, close=True)
    block.add_circle((30, 10), 3)
    scales = [(1, 1, 0), (-1, 1, 0), (2, 0.5, 0), (-1, 2, 30)]
    for k, (x, y, turn) in enumerate(scales):
        space.add_blockref("side", (200 * k, 0), dxfattribs={"xscale": x, "yscale": y, "rotation": turn})
    space.add_point((0, 0))
    space.add_text("a note", dxfattribs={"insert": (0, 90)})
    document.saveas(tmp_path / "x.dxf")
    found = reading(tmp_path / "x.dxf", flatten=1e-4)
    true = 800 - 15 - 9 * math.pi
    assert sorted(shape.area for shape in polygons(found.drawing)) == pytest.approx(
        [true, true, true, 2 * true], rel=1e-4
    )
    notes = " ".join(found.drawing.notes)
    assert "4 outlines across the edges of parts cut them" in notes
    assert "1 point or speck is left out" in notes
    assert "1 text elements are left out" in notes
