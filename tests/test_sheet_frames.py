"""The sheet round parts: left out where it is one, the edge of the board where cuts end on it, a part where it is a frame."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely

from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.readers.svg import read_svg
from wiggleroom.drawing.strokes.read_options import ReadOptions

WIDTH, HEIGHT = 300.0, 200.0


def page(body: str, width: float = WIDTH, height: float = HEIGHT) -> str:
    """An SVG of this size [mm]."""
    names = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    return f'<svg {names} width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">{body}</svg>'


def rect(x: float, y: float, width: float, height: float, colour: str = "black", more: str = "") -> str:
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="none" stroke="{colour}" {more}/>'


def circle(x: float, y: float, radius: float, colour: str = "black", more: str = "") -> str:
    return f'<circle cx="{x}" cy="{y}" r="{radius}" fill="none" stroke="{colour}" {more}/>'


def layer(name: str, body: str) -> str:
    return f'<g inkscape:groupmode="layer" inkscape:label="{name}">{body}</g>'


def count(drawing: Drawing) -> tuple[int, int]:
    """Number of parts and of their holes."""
    return len(drawing.parts), sum(len(region.holes) for part in drawing.parts for region in part.regions)


PANELS = "".join(rect(x, y, 120, 80) for x in (10, 140) for y in (10, 100)) + circle(40, 40, 5) + circle(200, 50, 10)
SHEETS = "stock;Sheet 600x400;Material;DO NOT CUT;DONOTCUT;Werkstück;nicht schneiden;feuille;ne pas couper;no cortar;Foglio;folha;vel"
SHEETS += ";niet snijden;arkusz;nie ciąć;板材;不切;用紙;切らない;лист;work area;frame;Rahmen;cadre;marco;cornice;moldura;kader;ramka;枠;bed"


@pytest.mark.parametrize("name", SHEETS.split(";")[::3])
def test_a_layer_of_the_sheet_is_left_out(name: str) -> None:
    drawing = read_svg(page(layer(name, rect(2, 3, 290, 190)) + PANELS))
    assert count(drawing) == (4, 2)
    assert any("left out" in note and name in note for note in drawing.notes)


FRAMES = {
    "grey, as large as the page": rect(0, 0, 300, 200, "#999") + PANELS,
    "as large as the page": rect(0, 0, 300, 200) + PANELS,
    "of its own colour": rect(3, 3, 290, 190, "#00ff00") + PANELS,
    "white": '<rect width="300" height="200" fill="white"/>' + PANELS,
    "two lines": layer("border", rect(0, 0, 300, 200) + rect(5, 5, 290, 190)) + PANELS,
    "round a layer cut outside": rect(3, 3, 290, 190) + layer("outside", PANELS),
}


@pytest.mark.parametrize("frame", FRAMES)
def test_a_frame_is_left_out_and_may_be_kept(frame: str) -> None:
    """A note says so, and the option in it makes a part of the frame."""
    left_out = read_svg(page(FRAMES[frame]))
    assert count(left_out) == (4, 2)
    note = next(note for note in left_out.notes if "sheet" in note)
    asked = note.partition("--solid ")[2].split()[0]
    kept = read_svg(page(FRAMES[frame]), options=ReadOptions(solid=(asked,)))
    assert max(np.ptp(part.regions[0].outer[:, 0]) for part in kept.parts) >= 290


def test_a_rectangle_round_several_parts_with_holes_is_left_out() -> None:
    assert count(read_svg(page(rect(3, 3, 290, 190) + PANELS + circle(40, 140, 5)))) == (4, 3)


def test_two_sheets_beside_each_other_are_left_out() -> None:
    one = rect(0, 0, 300, 200) + PANELS
    assert count(read_svg(page(f'{one}<g transform="translate(310,0)">{one}</g>', 610))) == (8, 4)


PARTS = {  # rectangles round everything that are parts
    "a panel with holes": (rect(0, 0, 300, 200) + circle(20, 20, 3) + circle(280, 180, 3), 1, 2),
    "holes of another colour": (rect(0, 0, 300, 200, "red") + circle(20, 20, 3, "blue") + rect(100, 50, 60, 60, "blue"), 1, 2),
    "layers outline and inner": (layer("outline", rect(0, 0, 300, 200)) + layer("inner", circle(9, 9, 3) + rect(99, 9, 9, 9)), 1, 2),
    "two windows": (rect(0, 0, 300, 200) + rect(20, 20, 120, 160) + rect(160, 20, 120, 160), 1, 2),
    "a picture frame": (rect(0, 0, 300, 200, more='id="frame"') + rect(20, 20, 260, 160), 1, 1),
    "a frame and what lies in it": (
        rect(0, 0, 300, 200, more='id="frame"') + rect(20, 20, 260, 160)
        + "".join(rect(x, 20, 130, 160, "blue", f'inkscape:label="at {x}"') for x in (20, 150)), 3, 1,
    ),
    "a tray": (
        rect(0, 0, 300, 200, more='id="tray"')
        + "".join(rect(x, 20, 100, 100, "black", f'inkscape:label="at {x}"') for x in (20, 150)), 3, 2,
    ),
    "a jigsaw in its tray": (rect(0, 0, 300, 200, "red") + rect(10, 10, 140, 180) + rect(150, 10, 140, 180), 3, 1),
    "a part called bed": (rect(20, 20, 200, 60, more='inkscape:label="bed"') + rect(40, 30, 20, 5) + rect(100, 30, 20, 5), 1, 2),
}  # fmt: skip


@pytest.mark.parametrize("kind", PARTS)
def test_a_frame_that_is_a_part_stays(kind: str) -> None:
    body, parts, holes = PARTS[kind]
    assert count(read_svg(page(body))) == (parts, holes)


def test_what_may_be_the_sheet_is_said_and_skipped_by_a_point() -> None:
    text = page(PARTS["two windows"][0])
    note = next(note for note in read_svg(text).notes if "if it is the sheet" in note)
    asked = note.partition("--skip ")[2].split()[0]
    assert count(read_svg(text, options=ReadOptions(skip=(asked,)))) == (2, 0)


def tab(a: complex, b: complex, side: int) -> str:
    """Edge of two jigsaw pieces."""
    along = [
        (0.40, 0), (0.45, 0.02), (0.42, 0.08), (0.36, 0.18), (0.64, 0.18), (0.58, 0.08), (0.55, 0.02), (0.60, 0),
        (1, 0),
    ]  # fmt: skip
    points = [a + (b - a) * (x + 1j * side * y) for x, y in along]
    p = [f"{z.real:.4f},{z.imag:.4f}" for z in points]
    return f"L {p[0]} C {p[1]} {p[1]} {p[2]} C {p[3]} {p[4]} {p[5]} C {p[6]} {p[6]} {p[7]} L {p[8]} "


def jigsaw(columns: int, rows: int, width: float, height: float, border: str, over: float) -> str:
    """Cuts from edge to edge of the page, or beyond it."""
    random = np.random.default_rng(0)
    xs, ys = np.linspace(0, width, columns + 1), np.linspace(0, height, rows + 1)
    cuts = []
    for x in xs[1:-1]:
        edges = "".join(tab(complex(x, a), complex(x, b), random.choice([-1, 1])) for a, b in itertools.pairwise(ys))
        cuts.append(f"M {x},{-over} L {x},0 {edges} L {x},{height + over}")
    for y in ys[1:-1]:
        edges = "".join(tab(complex(a, y), complex(b, y), random.choice([-1, 1])) for a, b in itertools.pairwise(xs))
        cuts.append(f"M {-over},{y} L 0,{y} {edges} L {width + over},{y}")
    return page(border + "".join(f'<path d="{cut}" fill="none" stroke="blue"/>' for cut in cuts), width, height)


BORDERS = {
    "none": "",
    "rectangle": rect(0, 0, 200, 150),
    "white": '<rect width="200" height="150" fill="white"/>',
    "rounded": rect(0, 0, 200, 150, more='rx="12"'),
    "called sheet": rect(0, 0, 200, 150, "gray", 'id="sheet"'),
    "three sides": '<path d="M 0,0 V 150 H 200 V 0" fill="none" stroke="black"/>',
    "open": '<path d="M 0,0 H 200 V 150 H 0 V 0" fill="none" stroke="black"/>',
}


@pytest.mark.parametrize("border", BORDERS)
def test_pieces_of_a_jigsaw_fill_its_page(border: str) -> None:
    """Corner and edge pieces are closed by the edge of the board, drawn or not."""
    drawing = read_svg(jigsaw(5, 4, 200.0, 150.0, BORDERS[border], 2.0 if border == "open" else 0.0))
    area = sum(shapely.Polygon(region.outer, region.holes).area for part in drawing.parts for region in part.regions)
    rounded = (4 - np.pi) * 12**2 if border == "rounded" else 0.0
    assert len(drawing.parts) == 20
    assert area == pytest.approx(200 * 150 - rounded, rel=1e-4)
    if border == "none":
        assert any("page's edge" in note for note in drawing.notes)


def test_264_pieces() -> None:
    drawing = read_svg(jigsaw(22, 12, 660.0, 360.0, "", 0.0))
    assert len(drawing.parts) == 264
    with_page = ReadOptions(skip=("page",))
    assert len(read_svg(jigsaw(22, 12, 660.0, 360.0, "", 0.0), options=with_page).parts) == 20 * 10


def test_an_outline_that_misses_its_end_at_the_page_does_not_cut_it() -> None:
    drawing = read_svg(
        page(rect(50, 50, 20, 20) + '<path d="M 0,10 H 40 V 40 H 0 V 10.6" fill="none" stroke="black"/>')
    )
    assert len(drawing.parts) == 2
    assert not any("page" in note for note in drawing.notes)


def test_the_box_of_one_part_is_left_out() -> None:
    """A rectangle that its only outline touches on all sides would fall into its corners; one that has room stays."""
    part = '<path d="M150,20L250,100L150,180L50,100Z" fill="none" stroke="black"/>'
    boxed = read_svg(page(rect(50, 20, 200, 160) + part + circle(150, 100, 5)))
    assert count(boxed) == (1, 1)
    assert any("the box of what is in it" in note for note in boxed.notes)
    assert count(read_svg(page(rect(40, 10, 220, 180) + part))) == (1, 1)


def test_the_border_of_a_drawing_with_its_title_block() -> None:
    border = rect(1, 1, 298, 198) + rect(10, 10, 280, 180) + rect(200, 160, 90, 30)
    words = "".join(f'<text x="{x}" y="170">{text}</text>' for x, text in ((205, "SIZE"), (230, "SCALE"), (260, "REV")))
    drawing = read_svg(page(layer("a", border + words) + layer("b", rect(50, 50, 100, 60) + circle(80, 80, 5))))
    assert count(drawing) == (1, 1)
    assert any("title block" in note for note in drawing.notes)
