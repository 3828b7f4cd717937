"""Parts as they are made, written into the file that they were drawn in: all that is no outline of a part stays as it is."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.assembly.assembly import rings_at
from wiggleroom.drawing import read_drawing
from wiggleroom.drawing.model import Part

Command = Callable[..., tuple[int, str, list[str]]]

SHEET = """<?xml version="1.0" encoding="UTF-8"?>
<!-- drawn by – hand -- for a laser -->
<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="100mm" height="60mm" viewBox="0 0 200 120">
<style>rect{fill:none;stroke:#ff0000;stroke-width:0.4}</style>
<g inkscape:groupmode="layer" inkscape:label="cut" transform="translate(30,10) rotate(90) scale(1,-1)">
  <rect id="frame" width="80" height="80"/>
  <path id="peg" d="M20 20h40v40h-40z" style="fill:none;stroke:#00f"/>
  <path class="two" d="M100 20h30v30h-30z M140 60q5 5 8 0" fill="none" stroke="#0f0"/>
</g>
<g inkscape:groupmode="layer" inkscape:label="engrave">
  <text x="120" y="60">Grüße</text><path d="M120 40 c5 5 10 5 20 0" fill="none" stroke="blue"/>
</g>
</svg>
"""


def area(part: Part) -> Any:
    """What a part covers."""
    outer, *holes = rings_at(part)
    return shapely.Polygon(outer, holes)


def areas(path: Path, **how: Any) -> list[Any]:
    """What the parts of a drawing cover, in an order that a gap does not change."""
    return sorted(
        (area(p) for p in read_drawing(path, **how).parts),
        key=lambda one: (round(one.centroid.x), round(one.centroid.y), one.area),
    )


@pytest.fixture
def sheet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sheet.svg").write_text(SHEET, encoding="utf-8")
    return tmp_path / "sheet.svg"


def test_only_outlines_move_in_an_svg_and_by_half_the_gap_less_half_the_kerf(
    sheet: Path, command_output: Command
) -> None:
    assert command_output("convert", sheet, "cut.svg", "--gap", "0.4", "--kerf", "0.1", "--solid", "peg")[0] == 0
    text = Path("cut.svg").read_text(encoding="utf-8")
    before, after = (re.sub(r"<(rect|path)[^>]*/>\s*", "", t) for t in (SHEET, text))
    assert after.startswith(before.rstrip().removesuffix("</svg>"))  # page, comment, rules, layers, text
    assert '<path d="M120 40 c5 5 10 5 20 0" fill="none" stroke="blue"/>' in text
    for was, now in zip(areas(sheet, options=SOLID), areas(Path("cut.svg"), options=SOLID), strict=True):
        assert now.symmetric_difference(was.buffer(-0.15, join_style="mitre")).area < 1e-6 * was.area
    kept = [re.sub(r'\sd="[^"]*"', "", found) for found in re.findall(r"<path[^>]*/>", text)]
    assert kept[:2] == [
        '<path id="frame" style="fill:none; stroke:#ff0000; stroke-width:0.4"/>',
        '<path id="peg" style="fill:none;stroke:#00f"/>',
    ]
    assert kept[2] == '<path style="fill:none;stroke:#00f"/>'  # of two parts that share an outline one keeps its name
    assert kept[3:5] == 2 * ['<path class="two" fill="none" stroke="#0f0"/>']  # the open line of the same element stays


SOLID = wr.drawing.strokes.read_options.ReadOptions(solid=("peg",))


def test_lines_that_two_parts_share_become_the_outlines_of_both(tmp_path: Path, command_output: Command) -> None:
    lines = "M0 0H40 M0 20H40 M0 0V20 M40 0V20 M20 0V20"
    engraved = '<path class="deco" stroke="blue" d="M5 5 10 10"/>'
    (tmp_path / "grid.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20">'
        f'<g fill="none" stroke="black">{"".join(f"<path d={q}M{d}{q}/>" for q in [chr(34)] for d in lines.split("M")[1:])}'
        f"{engraved}</g></svg>"
    )
    assert command_output("convert", tmp_path / "grid.svg", tmp_path / "cut.svg", "--gap", "1")[0] == 0
    text = (tmp_path / "cut.svg").read_text()
    assert engraved in text
    found = sorted(area(p).bounds for p in read_drawing(tmp_path / "cut.svg").parts)
    assert np.array(found) == pytest.approx(np.array([[0.5, 0.5, 19.5, 19.5], [20.5, 0.5, 39.5, 19.5]]))
    assert text.count(" d=") == 3  # no line is cut twice


def test_a_kerf_that_the_gap_does_not_leave_room_for_is_refused(sheet: Path, command_output: Command) -> None:
    code, _, said = command_output("convert", sheet, "cut.svg", "--gap", "0.1", "--kerf", "0.2", "--solid", "peg")
    assert code != 0
    assert said[-1].endswith(
        "kerf 0.2 mm: parts that lie beside each other would overlap at gap 0.1 mm; give a larger gap, lay them apart, or let the "
        "cutter compensate"
    )
    for wrong in (("cut.svg", "--kerf", "-1"), ("cut.json", "--kerf", "0.1")):
        assert command_output("convert", sheet, *wrong)[0] != 0
    assert not Path("cut.svg").exists()


COPIES = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="200mm" height="90mm"
viewBox="0 0 400 180"><style>.cut{stroke:#f00;fill:none}</style>
<defs><g id="pair"><path id="tile" class="cut" d="M2 2h40v40h-40z"/><text x="4" y="20">t</text></g>
<symbol id="sign" viewBox="0 0 10 10"><circle id="disc" class="cut" cx="5" cy="5" r="4"/></symbol>
<g id="two"><use href="#pair"/><use xlink:href="#pair" x="50" id="right"/></g></defs>
<use id="first" href="#two" x="5" y="5"/>
<use href="#two" transform="translate(150 20) rotate(10)" y="3"/>
<use xlink:href="#sign" x="20" y="100" width="60" height="60"/>
<rect id="original" class="cut" x="120" y="100" width="30" height="20"/><use href="#original" x="60"/>
</svg>"""


def test_outlines_that_are_copies_become_shapes_of_their_own(tmp_path: Path, command_output: Command) -> None:
    """Copies of copies, of symbols and of what stands there itself: all outlines move by half the gap, and all texts stay."""
    (tmp_path / "copies.svg").write_text(COPIES)
    assert command_output("convert", tmp_path / "copies.svg", tmp_path / "cut.svg", "--gap", "0.4")[0] == 0
    before, after = areas(tmp_path / "copies.svg"), areas(tmp_path / "cut.svg")
    assert len(before) == len(after) == 7
    for was, now in zip(before, after, strict=True):
        assert now.symmetric_difference(was.buffer(-0.2, join_style="mitre")).area < 1e-3 * was.area
    text = (tmp_path / "cut.svg").read_text()
    assert text.count(">t</text>") == 5  # in the original, and in each copy
    assert text.count('id="first"') == text.count('id="tile"') == text.count('id="original"') == 1


def test_only_outlines_move_in_a_dxf_also_those_in_blocks(tmp_path: Path, command_output: Command) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010")
    document.units = ezdxf.units.CM
    document.layers.add("Schnitt", color=1)
    document.layers.add("Gravur", color=5)
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (3, 0), (3, 2), (0, 2)], close=True, dxfattribs={"layer": "Schnitt", "color": 3})
    space.add_text("front", dxfattribs={"layer": "Gravur", "height": 0.3}).set_placement((1, 1))
    space.add_line((0.2, 0.2), (0.8, 0.2), dxfattribs={"layer": "Gravur"})
    block = document.blocks.new("disc")
    block.add_circle((0, 0), 1, dxfattribs={"layer": "0"})
    for x in (5, 8):
        space.add_blockref("disc", (x, 1), dxfattribs={"layer": "Schnitt"})
    document.saveas(tmp_path / "sheet.dxf")
    assert (
        command_output("convert", tmp_path / "sheet.dxf", tmp_path / "cut.dxf", "--gap", "0.4", "--kerf", "0.1")[0] == 0
    )
    made = ezdxf.readfile(tmp_path / "cut.dxf")
    assert made.units == ezdxf.units.CM
    assert made.dxfversion == document.dxfversion
    assert sorted(e.dxftype() for e in made.modelspace().query('*[layer=="Gravur"]')) == ["LINE", "TEXT"]
    cut = list(made.modelspace().query('*[layer=="Schnitt"]'))
    assert [e.dxftype() for e in cut] == 3 * ["LWPOLYLINE"]
    assert sorted(e.dxf.get("color", 256) for e in cut) == [3, 256, 256]
    for was, now in zip(areas(tmp_path / "sheet.dxf"), areas(tmp_path / "cut.dxf"), strict=True):
        assert now.symmetric_difference(was.buffer(-0.15, join_style="mitre")).area < 5e-3 * was.area


PROJECT = """<?xml version="1.0" encoding="UTF-8"?>
<LightBurnProject AppVersion="1.4.03" FormatVersion="1" MirrorX="False" MirrorY="False">
    <CutSetting type="Cut"><index Value="0"/><name Value="C00"/><speed Value="12"/></CutSetting>
    <CutSetting type="Scan"><index Value="1"/><name Value="C01"/></CutSetting>
    <Shape Type="Group"><XForm>0 1 -1 0 50 10</XForm><Children>
        <Shape Type="Rect" CutIndex="0" W="60" H="60" Cr="0" PowerScale="80"><XForm>1 0 0 1 30 30</XForm></Shape>
        <Shape Type="Rect" CutIndex="0" W="40" H="40" Cr="0"><XForm>1 0 0 1 30 30</XForm></Shape>
        <Shape Type="Ellipse" CutIndex="0" Name="pe&amp;g" Rx="15" Ry="15"><XForm>1 0 0 1 30 30</XForm></Shape>
    </Children></Shape>
    <Shape Type="Path" CutIndex="0"><XForm>1 0 0 1 0 0</XForm><VertList>V80 0V90 0V90 10V80 10V85 4c0x86c0y5V88 6c1x87c1y7</VertList>
        <PrimList>L0 1L1 2L2 3L3 0B4 5</PrimList></Shape>
    <Shape Type="Rect" CutIndex="1" W="5" H="5" Cr="0"><XForm>1 0 0 1 100 30</XForm></Shape>
    <Notes ShowOnLoad="0" Notes="gr\u00fc\u00dfe"/>
</LightBurnProject>
"""


LISTS = re.compile(r"<VertList>.*</PrimList>", re.DOTALL)
ELEMENTS = (
    '<V vx="80" vy="0"/><V vx="90" vy="0"/><V vx="90" vy="10"/><V vx="80" vy="10"/><V vx="85" vy="4" c0x="86" c0y="5"/>'
    '<V vx="88" vy="6" c1x="87" c1y="7"/><P T="L" p0="0" p1="1"/><P T="L" p0="1" p1="2"/><P T="L" p0="2" p1="3"/>'
    '<P T="L" p0="3" p1="0"/><P T="B" p0="4" p1="5"/>'
)
"""The vertices and edges of the path as older projects have them."""


@pytest.mark.parametrize("ending", ["lbrn2", "lbrn"])
def test_outlines_go_into_a_lightburn_project_and_its_layers_stay(
    tmp_path: Path, command_output: Command, ending: str
) -> None:
    path, cut = tmp_path / f"plate.{ending}", tmp_path / f"cut.{ending}"
    project = LISTS.sub(ELEMENTS, PROJECT) if ending == "lbrn" else PROJECT
    path.write_text(project, encoding="utf-8")
    said = command_output("convert", path, cut, "--gap", "0.4", "--kerf", "0.1")
    assert said[0] == 0, said
    text = cut.read_text(encoding="utf-8")
    for kept in (
        '<speed Value="12"/>',
        'Notes="gr\u00fc\u00dfe"',
        'CutIndex="1" W="5"',
        "<XForm>0 1 -1 0 50 10</XForm>",
    ):
        assert kept in text
    first, curve = {
        "lbrn2": ("<VertList>V", "V85 4c0x86c0y5V88 6c1x87c1y7"),
        "lbrn": ('<V vx="', ELEMENTS[ELEMENTS.index('<V vx="85"') : ELEMENTS.index("<P ")]),
    }[ending]
    assert f'<Shape Type="Path" CutIndex="0" PowerScale="80"><XForm>1 0 0 1 30 30</XForm>{first}' in text
    assert 'Name="pe&amp;g"' in text
    was_all, now_all = areas(path), areas(cut)
    assert len(was_all) == len(now_all) == 3
    assert curve in text  # a curve that is no outline, of the same shape
    for was, now in zip(was_all, now_all, strict=True):
        assert now.symmetric_difference(was.buffer(-0.15, join_style="mitre")).area < 1e-3 * was.area
    assert ("<VertList>" in text) == (ending == "lbrn2")
    command_output("convert", path, tmp_path / f"same.{ending}")
    assert (tmp_path / f"same.{ending}").read_text(encoding="utf-8") == project


def test_a_shape_that_shares_its_vertices_with_an_outline_is_refused(tmp_path: Path, command_output: Command) -> None:
    square = "<VertList>V0 0V9 0V9 9V0 9</VertList><PrimList>LineClosed</PrimList>"
    shapes = [
        f'<Shape Type="Path" CutIndex="0" VertID="0" PrimID="0"><XForm>1 0 0 1 0 0</XForm>{square}</Shape>',
        '<Shape Type="Path" CutIndex="1" VertID="0" PrimID="0"><XForm>1 0 0 1 20 0</XForm></Shape>',
    ]
    engraved = '<CutSetting type="Scan"><index Value="1"/><name Value="C01"/></CutSetting>'
    path = tmp_path / "twins.lbrn2"
    path.write_text(f"<LightBurnProject>{engraved}{''.join(shapes)}</LightBurnProject>")
    code, _, lines = command_output("convert", path, tmp_path / "cut.lbrn2", "--gap", "0.4")
    assert code == 2
    assert any("shares its vertices with an outline" in line for line in lines)
