"""What a laser leaves: slots, notches and reliefs cut the parts whose edges they cross, judged by shapely on the true shapes."""

from __future__ import annotations

from functools import reduce

import pytest
from shapely import Polygon

from tests.cut_drawings import CutCase, Line, assert_left, disc, rect, written
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
BONES = [disc(40, 25, 1), disc(60, 25, 1), disc(40, 30, 1), disc(60, 30, 1)]
ACROSS = "1 outline across the edge of a part cuts it"
WHEEL = disc(60, 60, 40)

CUTS = [
    case("a slot over the edge", PANEL, SLOT, noted=ACROSS),
    CutCase("a slot over the edge, drawn first", [SLOT, PANEL], [minus(PANEL, SLOT)], ACROSS),
    case("a slot over two edges at a corner", PANEL, rect(85, 45, 10, 10), noted=ACROSS),
    case("a notch flush with the edge", PANEL, rect(70, 40, 5, 10), noted="1 outline inside another is a hole"),
    CutCase("a notch a nanometre inside the edge", [PANEL, rect(70, 40, 5, 10 - 1e-6)], [minus(PANEL, NOTCH)]),
    CutCase("a notch a hundredth inside the edge", [PANEL, rect(70, 40, 5, 9.99)], [minus(PANEL, NOTCH)]),
    CutCase("a notch a hair over the edge", [PANEL, rect(70, 40, 5, 10 + 1e-6)], [minus(PANEL, NOTCH)]),
    case("a notch flush with two edges", PANEL, rect(85, 40, 5, 10)),
    case("a notch in every edge", PANEL, rect(30, 45, 5, 5), rect(30, 10, 5, 5), rect(10, 20, 5, 5), rect(85, 20, 5, 5)),
    case("two slots that touch", PANEL, rect(40, 25, 20, 5), rect(45, 30, 10, 5), noted="2 of them touch"),
    case("a slot in the form of a cross", PANEL, rect(40, 28, 20, 4), rect(48, 20, 4, 20), noted="2 outlines inside others"),
    case("a T from the edge", PANEL, rect(48, 35, 4, 15), rect(42, 31, 16, 4)),
    case("a keyhole", PANEL, disc(50, 30, 4), rect(48.5, 20, 3, 8)),
    case("dog bones in a slot", PANEL, rect(40, 25, 20, 5), *BONES, noted="5 outlines inside others are holes"),
    case("dog bones in a slot over the edge", PANEL, rect(48, 30, 6, 25), disc(48, 30, 1), disc(54, 30, 1)),
    case("a relief on a corner of the panel", PANEL, disc(90, 50, 2), noted=ACROSS),
    case("reliefs on all corners", PANEL, *(disc(x, y, 1) for x in (10, 90) for y in (10, 50)), noted="4 outlines across"),
    case("a relief on the edge beside a notch", PANEL, rect(40, 40, 10, 10), disc(40, 40, 1), disc(50, 40, 1)),
    case("windows that overlap", PANEL, rect(20, 15, 25, 20), rect(40, 20, 30, 20)),
    case("a hole that touches the edge in a point", PANEL, disc(50, 45, 5), rings=False),
    case("two holes that touch in a point", PANEL, disc(40, 30, 5), disc(50, 30, 5), rings=False),
    case("half laps along an edge", rect(10, 10, 320, 40), *COMB, noted="30 outlines across the edges of parts cut them"),
    case("half laps from both edges", rect(10, 10, 320, 40), *COMB, *(rect(20 + 10 * k, 5, 3, 15) for k in range(30))),
    case("slots round a wheel", WHEEL, *(rect(58.5, y, 3, 15) for y in (10, 95)), disc(60, 60, 4), noted="2 outlines across"),
    case("a slot drawn twice", PANEL, SLOT, SLOT, noted="drawn twice"),
    case("a slot over the edge and a hole", PANEL, SLOT, disc(25, 30, 4), noted="1 outline inside another is a hole"),
    case("a slot over the edge of a hole", PANEL, disc(50, 30, 10), rect(38, 28, 6, 4)),
    case("a slot that shares a stretch of the edge", PANEL, Line(((30, 50), (50, 50), (50, 40), (40, 40), (40, 45), (30, 45)))),
    case("a slot with a hole of its own beyond the edge", PANEL, SLOT, disc(48, 53, 1)),
    case("by name, in another colour", PANEL, rect(48, 30, 3, 23, "slot 1", colour="#ff0000"), formats="svg lbrn2"),
    case("by name, large", PANEL, rect(20, 30, 60, 30, "notch_hole"), formats="svg lbrn2"),
    case("by layer, over the edge", PANEL, rect(48, 30, 3, 23, layer="holes", colour="#ff0000")),
    case("by layer, over each other", PANEL, *(rect(x, y, w, h, layer="holes") for x, y, w, h in ((40, 25, 20, 5), (45, 28, 5, 9)))),
    case("by layer, touching each other and the edge", PANEL,
         *(rect(x, y, w, h, layer="Löcher") for x, y, w, h in ((40, 25, 20, 5), (45, 30, 10, 5), (70, 40, 5, 10)))),
    case("by layer, large", PANEL, rect(20, 15, 60, 60, layer="trous")),
    case("by layer of inner cuts, in another colour", PANEL, rect(48, 30, 3, 23, layer="Inner cuts", colour="#0000ff")),
    case("by layer of slots, that touch", PANEL, *(rect(x, 20, 30, 20, layer="slots") for x in (15, 45))),
    case("by option", PANEL, rect(30, 30, 40, 30, "thing", colour="#ff0000"), hole=("thing",), formats="svg lbrn2"),
    case("by a point", PANEL, rect(30, 30, 40, 30, colour="#ff0000"), hole=("@40,55",)),
    case("by all", PANEL, rect(30, 30, 40, 30, colour="#ff0000"), rect(10, 10, 20, 10), hole=("all",)),
    CutCase("a part in a hole, with a slot over its edge", [PANEL, rect(20, 15, 60, 30), rect(30, 20, 20, 20), rect(38, 35, 3, 8)],
            [minus(PANEL, rect(20, 15, 60, 30)), minus(rect(30, 20, 20, 20), rect(38, 35, 3, 8))]),
    CutCase("a part in a notch", [PANEL, rect(40, 30, 20, 25, "notch"), rect(42, 32, 16, 15)],
            [minus(PANEL, rect(40, 30, 20, 25)), rect(42, 32, 16, 15).shape], formats="svg lbrn2"),
    CutCase("slots of two parts", [PANEL, SLOT, rect(110, 10, 80, 40), rect(148, 5, 3, 23)],
            [minus(PANEL, SLOT), minus(rect(110, 10, 80, 40), rect(148, 5, 3, 23))], "2 outlines across"),
    CutCase("slots of a layer cut a part in two", [PANEL, *(rect(45, y, 6, 15, layer="holes") for y in (8, 20, 30, 42))],
            [rect(10, 10, 35, 40).shape, rect(51, 10, 39, 40).shape], "each piece is a part"),
    CutCase("a slot by option cuts a part in two", [PANEL, rect(45, 0, 6, 70)],
            [rect(10, 10, 35, 40).shape, rect(51, 10, 39, 40).shape], "each piece is a part", hole=("@48,60",)),
]  # fmt: skip

ASKED = [
    CutCase("a bar over a bar", [rect(10, 40, 100, 10), rect(50, 10, 10, 80)], asked="--hole p2"),
    CutCase("a slot in another colour", [PANEL, rect(48, 30, 3, 23, colour="#ff0000")], asked="--hole p2"),
    CutCase("a key over two boards", [*BOARDS, KEY], asked="--hole p3"),
    CutCase("a part with a name", [rect(10, 10, 80, 40, "board"), rect(48, 30, 3, 23, "peg")], asked="--hole peg", formats="svg lbrn2"),
    CutCase("a part pressed into another one", [PANEL, rect(40, 49.9, 8, 8)], asked="overlap by 0.1 mm"),
    CutCase("a strip across", [PANEL, rect(48, 5, 3, 50)], asked="in pieces; --hole @49.5,30"),
    CutCase("a chain of slots across", [PANEL, *(rect(45, y, 6, 15) for y in (8, 20, 30, 42))], asked="in pieces"),
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


@pytest.mark.parametrize(("case", "style"), every(CUTS))
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
