"""Letters, pictures, dimensions and waste in drawings of sheets: what is engraved or falls out is neither part nor hole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.textpath import TextPath

from wiggleroom.drawing.outlines.joining import join_ends
from wiggleroom.drawing.read import reading
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError

BLACK, RED, BLUE = 'fill="none" stroke="#000000"', 'fill="none" stroke="#ff0000"', 'fill="none" stroke="#0000ff"'
INK = "http://www.inkscape.org/namespaces/inkscape"
HOLES = [(20, 15), (20, 85), (180, 15), (180, 85)]


def path(points, style: str = BLACK, *, closed: bool = True, more: str = "") -> str:
    data = "M" + "L".join(f"{x:.4f},{y:.4f}" for x, y in points) + ("Z" if closed else "")
    return f'<path d="{data}" {style} {more}/>'


def rect(x, y, w, h, style: str = BLACK, more: str = "") -> str:
    return path([(x, y), (x + w, y), (x + w, y + h), (x, y + h)], style, more=more)


def disc(x, y, r, style: str = BLACK, more: str = "") -> str:
    return f'<circle cx="{x}" cy="{y}" r="{r}" {style} {more}/>'


def word(text: str, x: float, y: float, size: float, style: str = BLACK, *, whole: bool = False) -> str:
    """The outlines of a text in a font of matplotlib, each a path, or all in one."""
    rings = [
        np.array([[x + a, y - b] for a, b in ring[:-1]]) for ring in TextPath((0, 0), text, size=size).to_polygons()
    ]
    if not whole:
        return "".join(path(ring, style) for ring in rings)
    data = "".join("M" + "L".join(f"{a:.4f},{b:.4f}" for a, b in ring) + "Z" for ring in rings)
    return f'<path d="{data}" {style}/>'


def read(tmp_path: Path, *body: str, **options):
    file = tmp_path / "sheet.svg"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="{INK}" width="400mm" height="300mm" viewBox="0 0 400 300">'
    file.write_text(head + "".join(body) + "</svg>")
    found = reading(file, options=ReadOptions(**options))
    assert not found.findings
    return found.drawing


def counted(drawing) -> tuple[int, int]:
    regions = [region for part in drawing.parts for region in part.regions]
    return len(drawing.parts), sum(len(region.holes) for region in regions)


def area(drawing) -> list[float]:
    return sorted(sum(shapely.Polygon(r.outer, r.holes).area for r in part.regions) for part in drawing.parts)


def said(drawing, text: str) -> bool:
    return any(text in note for note in drawing.notes)


PANEL = [rect(0, 0, 200, 100), *(disc(x, y, 2) for x, y in HOLES)]
LETTERS = "drawn as outlines or lines are taken as engraved"


@pytest.mark.parametrize("text", ["Plate A3", "Box 8 & 9", "side up", "WeMaker v1.0"])
@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize(("x", "y"), [(40, 60), (220, 60)])
def test_letters_in_and_beside_a_panel(tmp_path, text, whole, x, y):
    drawing = read(tmp_path, *PANEL, word(text, x, y, 10, whole=whole))
    assert counted(drawing) == (1, 4)
    assert said(drawing, LETTERS)
    assert counted(read(tmp_path, *PANEL, word(text, x, y, 10, whole=whole), solid=("all",)))[0] > 1


def test_single_letters_are_known_by_the_words(tmp_path):
    """A 2 alone could be a hole; in the font of a word with islands it is none."""
    alone = read(tmp_path, *PANEL, word("2", 100, 50, 10))
    beside = read(tmp_path, *PANEL, word("2", 100, 50, 10), word("board", 40, 20, 10))
    assert (counted(alone), counted(beside)) == ((1, 5), (1, 4))


def test_stencil_letters_are_cut(tmp_path):
    """Letters without islands leave nothing that falls out, so they may be meant to be cut; it is said."""
    drawing = read(tmp_path, *PANEL, word("LUNCH", 40, 60, 10))
    assert counted(drawing) == (1, 9)
    assert said(drawing, "none holds an island")


def test_a_name_that_is_the_part(tmp_path):
    drawing = read(tmp_path, word("tapster makes robots", 10, 60, 10))
    assert len(drawing.parts) == len("tapstermakesrobots")


TEE = [(0, 0), (3, 0), (3, 6), (6, 6), (6, 9), (3, 9), (3, 16), (0, 16), (0, 9), (-3, 9), (-3, 6), (0, 6)]


@pytest.mark.parametrize("pitch", [11, 13, 16])
def test_rows_of_holes_are_no_words(tmp_path, pitch):
    """Slots for nuts, switches and rings: thin, bent, in rows, but alike."""
    tees = [path([(40 + pitch * k + x, 20 + y) for x, y in TEE]) for k in range(8)]
    rings = [part for k in range(6) for part in (disc(230 + 12 * k, 20, 5), disc(230 + 12 * k, 20, 3 + 0.2 * k))]
    assert counted(read(tmp_path, *PANEL, *tees, *rings)) == (7, 18)


STROKES = {
    "A": [[(0, 0), (3, 9), (6, 0)], [(1, 3), (5, 3)]],
    "E": [[(6, 0), (0, 0), (0, 9), (6, 9)], [(0, 4.5), (4, 4.5)]],
    "R": [[(0, 0), (0, 9), (5, 9), (5, 5), (0, 5)], [(2, 5), (6, 0)]],
    "O": [[(1, 0), (5, 0), (6, 4), (5, 9), (1, 9), (0, 4), (1, 0)]],
    "V": [[(0, 9), (3, 0), (6, 9)]],
}


def strokes(text: str, x: float, y: float, style: str = BLACK) -> str:
    """A text of single lines."""
    lines = [
        path([(x + 8 * k + a, y - b) for a, b in line], style, closed=False)
        for k, letter in enumerate(text)
        for line in STROKES[letter]
    ]
    return "".join(lines)


@pytest.mark.parametrize(("x", "y"), [(60, 60), (220, 60)])
def test_letters_of_single_lines(tmp_path, x, y):
    """The loops of A, R and O are faces of these lines, and no parts."""
    drawing = read(tmp_path, *PANEL, strokes("OVERAREA", x, y))
    assert counted(drawing) == (1, 4)
    assert said(drawing, LETTERS)


def test_dimensions_in_a_colour_of_their_own(tmp_path):
    """Lines from edge to edge in the colour of letters divide nothing; in the colour of the part they do."""
    arrow = [[(50, 0), (50, 100)], [(48, 5), (50, 0), (52, 5)], [(48, 95), (50, 100), (52, 95)]]
    red = [path(line, RED, closed=False) for line in arrow]
    black = [path(line, closed=False) for line in arrow]
    drawing = read(tmp_path, *PANEL, *red, strokes("OVERA", 54, 60, RED))
    assert counted(drawing) == (1, 4)
    assert said(drawing, "taken as dimensions or notes")
    assert counted(read(tmp_path, *PANEL, *black))[0] == 2


def test_a_picture_in_a_colour_of_its_own(tmp_path):
    """What lies in another one of its colour would fall out; holes in a colour of their own would not."""
    picture = [disc(100, 50, 20, RED), disc(100, 50, 15, RED), rect(95, 40, 10, 20, RED), disc(150, 50, 5, RED)]
    drawing = read(tmp_path, *PANEL, *picture)
    assert counted(drawing) == (1, 4)
    assert said(drawing, "taken as an engraved picture")
    assert counted(read(tmp_path, *PANEL, picture[0], picture[3])) == (1, 6)


def test_a_part_in_the_hole_of_another_is_no_picture(tmp_path):
    """Red inside black: a wheel with a hole of its own, in a window."""
    drawing = read(tmp_path, *PANEL, disc(100, 50, 30), disc(100, 50, 25, RED), disc(100, 50, 5, RED))
    assert counted(drawing) == (2, 6)


def test_a_line_drawn_with_its_thickness(tmp_path):
    drawing = read(tmp_path, *PANEL, rect(0, -10, 200, 0.2), rect(220, 0, 5, 100))
    assert area(drawing) == pytest.approx([500, 20000 - 4 * np.pi * 4], rel=1e-3)
    assert said(drawing, "as thin as a line")


@pytest.mark.parametrize(("shift", "holes"), [(0.01, 5), (5, 6)])
def test_a_slot_drawn_twice_a_hair_apart(tmp_path, shift, holes):
    """Outlines that cross each other, as none with a clearance do, are one; shapely says what two far apart leave."""
    one, two = shapely.box(60, 40, 80, 43), shapely.box(60 + shift, 40, 80 + shift, 43)
    drawing = read(tmp_path, *PANEL, rect(60, 40, 20, 3), rect(60 + shift, 40, 20, 3))
    left = 20000 - 4 * np.pi * 4 - (one if holes == 5 else one | two).area
    assert area(drawing) == pytest.approx([left], abs=0.05)
    assert said(drawing, "drawn twice") == (holes == 5)


@pytest.mark.parametrize("short", [0.0, 0.04, 0.08])
def test_panels_that_share_an_edge(tmp_path, short):
    """The lower panel ends on the edge of the upper one, a hair short of it; what both close in between them is waste."""
    upper = [(0, 0), (200, 0), (200, 50), (120, 50), (120, 44), (100, 44), (100, 50), (0, 50)]
    end = 50 + short
    lower = path([(0, end), (0, 110), (200, 110), (200, end)], closed=False)
    bridge = path([(100, 50), (120, 50)], closed=False)
    drawing = read(tmp_path, path(upper), lower, bridge)
    assert area(drawing) == pytest.approx([200 * 50 - 120, 200 * 60], rel=1e-3)
    assert said(drawing, "taken as cut out")


def test_an_end_too_far_away_stays_open(tmp_path):
    upper = rect(0, 0, 200, 50)
    lower = path([(0, 50.2), (0, 110), (200, 110), (200, 50.2)], closed=False)
    assert counted(read(tmp_path, upper, lower)) == (1, 0)


@pytest.mark.parametrize(
    ("length", "gap", "third", "joined"),
    [(10, 0.08, False, True), (10, 0.08, True, False), (3, 0.08, False, False), (10, 0.12, False, False)],
)
def test_ends_with_no_other_one_near_are_joined(length, gap, third, joined):
    """Over a beam's width and a fiftieth of the shorter line, unless a third end makes it a guess."""
    lines = [np.array([[0.0, 0], [length, 0]]), np.array([[length + gap, 0], [length + gap, 9]])]
    lines += [np.array([[length, -0.2], [length, -9]])] if third else []
    node = join_ends(lines, 0.01, 20.0, further=True).node
    assert (node[0, 1] == node[1, 0]) == joined


def test_slots_by_open_lines_over_an_edge_fall_out(tmp_path):
    """Three sides of each slot are drawn, two of a corner: they fall out, unless asked for; what is wider than a quarter is a part."""
    slots = [path([(x, 100), (x, 90), (x + 3, 90), (x + 3, 100)], closed=False) for x in (60, 120)]
    corner, large = (path([(0, y), (x, y), (x, 0)], closed=False) for x, y in ((50, 40), (140, 80)))
    panel = rect(0, 0, 200, 100)
    drawing = read(tmp_path, panel, *slots, corner)
    assert area(drawing) == pytest.approx([20000 - 60 - 2000])
    assert said(drawing, "taken as cut out")
    assert area(read(tmp_path, panel, *slots, solid=("@61,205",))) == pytest.approx([30, 19940])
    assert area(read(tmp_path, panel, *slots, solid=("all",))) == pytest.approx([30, 30, 19940])
    assert area(read(tmp_path, panel, large)) == pytest.approx([20000 - 11200, 11200])


def test_slots_in_a_hole_stay_holes(tmp_path):
    """A line across the corner of a hole cuts nothing off that: what it bounds is cut out of the panel, too."""
    corner = path([(60, 40), (60, 50), (50, 50)], closed=False)
    assert area(read(tmp_path, rect(0, 0, 200, 100), rect(50, 40, 60, 40), corner)) == pytest.approx([20000 - 2400])


@pytest.mark.parametrize(
    ("closed", "key", "areas"),
    [(True, False, [6880, 6940]), (False, True, [120, 6940, 6940]), (False, False, [6940, 7060])],
)
def test_gaps_of_finger_joints_between_panels(tmp_path, closed, key, areas):
    """Two panels laid edge to edge, all lines drawn once: fingers leave gaps; a key that reaches into both is a part."""
    teeth = [(100, 0), (100, 10), (94, 10), (94, 20), (100, 20), (100, 30), (106, 30), (106, 40), (100, 40), (100, 50)]
    teeth += [(94, 50), (94, 60), (100, 60), (100, 70)]
    closers = [path([(100, a), (100, a + 10)], closed=False) for a in (10, 30, 50) if closed]
    keys = [path([(100, 10), (106, 10), (106, 20), (100, 20)], closed=False)] if key else []
    drawing = read(tmp_path, rect(0, 0, 200, 70), path(teeth, closed=False), *closers, *keys)
    assert area(drawing) == pytest.approx(areas)


def test_labels_of_one_kind_are_no_names(tmp_path):
    """One label on several outlines in a part says what they are for; different ones say which part is which."""
    screws = [disc(x, 50, 2, more='inkscape:label="M4"') for x in (60, 100, 140)]
    named = [disc(x, 50, 8, more=f'inkscape:label="wheel {x}"') for x in (60, 100, 140)]
    assert counted(read(tmp_path, rect(0, 0, 200, 100), *screws)) == (1, 3)
    assert len(read(tmp_path, rect(0, 0, 200, 100), *named).parts) == 4
    copied = disc(100, 50, 8, more='inkscape:label="path54-1"')  # the id of what was copied
    assert counted(read(tmp_path, rect(0, 0, 200, 100), copied)) == (1, 1)


def test_one_label_on_an_outline_and_what_is_in_it(tmp_path):
    """A label that a group of outlines shares does not make a part of the hole."""
    label = 'inkscape:label="lid"'
    assert counted(read(tmp_path, rect(0, 0, 200, 100, more=label), disc(100, 50, 20, more=label))) == (1, 1)


def test_a_template_says_what_is_cut(tmp_path):
    """On a sheet of Ponoko blue is cut, red is engraved, and orange is their own."""
    orange = 'fill="none" stroke="#f6921e"'
    sheet = [rect(0, 0, 384, 284, orange), rect(390, 0, 6, 6, orange)]
    body = [rect(10, 10, 200, 100, BLUE), disc(50, 50, 5, BLUE), rect(100, 40, 30, 30, RED)]
    drawing = read(tmp_path, *sheet, *body)
    assert counted(drawing) == (1, 1)
    assert said(drawing, "template of Ponoko")
    with pytest.raises(InputError, match="no layer, colour or name"):
        read(tmp_path, *body, skip=("orange",))


NAVY, GREEN, INKED = 'fill="#000080"', 'fill="#008000"', 'fill="#000000"'


def test_holes_in_a_colour_of_their_own(tmp_path):
    """In a filled panel small shapes of a colour that stands nowhere else are holes; large ones, and parts, are pieces."""
    panel, holes = rect(20, 20, 200, 100, NAVY), disc(40, 40, 4, GREEN) + rect(60, 60, 60, 20, GREEN)
    drawing = read(tmp_path, panel, holes)
    assert counted(drawing) == (1, 2)
    assert any("2 outlines inside others are holes" in note for note in drawing.notes)
    assert counted(read(tmp_path, panel, holes, disc(300, 40, 4, GREEN)))[0] == 4
    assert counted(read(tmp_path, panel, rect(30, 30, 120, 80, GREEN)))[0] == 2
    assert counted(read(tmp_path, panel, disc(40, 40, 4, GREEN, 'id="peg"')))[0] == 2


def test_a_picture_in_a_panel_of_several_lines(tmp_path):
    """What is filled among lines is engraved, whether or not one line alone runs round it."""
    panel = path([(20, 20), (20, 120), (220, 120)], BLUE, closed=False)
    panel += path([(220, 120), (220, 20), (20, 20)], BLUE, closed=False)
    drawing = read(tmp_path, panel, disc(120, 70, 45, INKED), rect(30, 30, 10, 80, INKED))
    assert counted(drawing) == (1, 0)
    assert any("engraving" in note for note in drawing.notes)
    assert counted(read(tmp_path, panel, disc(300, 70, 45, INKED))) == (2, 0)


def test_a_red_picture_beside_red_lettering(tmp_path):
    """Red is the colour of fixed parts, unless lettering has it."""
    red = 'fill="#ff0000"'
    panel, picture = rect(20, 20, 200, 100), disc(120, 70, 20, red)
    letters = '<g id="text12">' + disc(40, 40, 3, red) + "</g>"
    assert counted(read(tmp_path, panel, picture)) == (2, 1)
    assert counted(read(tmp_path, panel, picture, letters)) == (1, 0)


def test_a_scrap_is_said(tmp_path):
    """A tiny outline beside the others is a part, but hardly one that is wanted."""
    drawing = read(tmp_path, rect(20, 20, 200, 100), rect(250, 20, 1, 2))
    assert counted(drawing) == (2, 0)
    assert any("1 part is tiny" in note for note in drawing.notes)


def test_splinters_fall_out(tmp_path):
    """What a line cuts off a panel and is a thousandth of it is no part; a corner of a few hundredths is."""
    panel = rect(20, 20, 200, 100)
    assert counted(read(tmp_path, panel, path([(20, 22), (22, 20)], closed=False)))[0] == 1
    assert counted(read(tmp_path, panel, path([(20, 60), (60, 20)], closed=False)))[0] == 2


def test_scraps_in_holes(tmp_path):
    """A circle in the seat of a nut falls out with it; a larger disc in a hole, or one with a name, is a part."""
    panel = rect(20, 20, 200, 100)
    nut = "".join(rect(x, 60, 6, 6) + disc(x + 3, 63, 1.5) for x in (40, 80, 120))
    drawing = read(tmp_path, panel, nut)
    assert counted(drawing) == (1, 3)
    assert said(drawing, "3 scraps in holes left out")
    assert counted(read(tmp_path, panel, nut, solid=("all",)))[0] == 7
    assert counted(read(tmp_path, panel, disc(100, 60, 12), disc(100, 60, 11)))[0] == 2
    assert counted(read(tmp_path, panel, disc(100, 60, 2), disc(100, 60, 1.5, BLACK, 'id="pin"')))[0] == 2


def test_letters_with_white_lines(tmp_path):
    """White is no colour of cuts: what is filled and has a white line is engraved."""
    white = 'fill="#0000ff" stroke="#ffffff"'
    assert counted(read(tmp_path, rect(20, 20, 200, 100), rect(60, 40, 20, 30, white))) == (1, 0)


def test_a_colour_whose_outlines_hold_windows_is_engraved(tmp_path):
    """The bezel of a display, drawn round its window, would make the window fall out with it."""
    other = rect(250, 0, 100, 100)
    bezels = [rect(30, 20, 60, 40, RED), disc(140, 50, 12, RED)]
    windows = [rect(40, 28, 40, 26), disc(140, 50, 5)]
    drawing = read(tmp_path, rect(0, 0, 200, 100), other, *bezels, *windows)
    assert counted(drawing) == (2, 2)
    assert said(drawing, "2 outlines in red inside parts, one in another: taken as an engraved picture")
    lid = rect(30.2, 20.2, 59.6, 39.6)  # fits the hole, and is a part
    assert counted(read(tmp_path, rect(0, 0, 200, 100), other, rect(30, 20, 60, 40, RED), lid)) == (3, 1)


def test_straight_lines_of_another_colour_on_parts_are_scored(tmp_path):
    lines = [path([(x, 0), (x, 100)], BLUE, closed=False) for x in (50, 100, 150)]
    second = rect(0, 110, 200, 100)
    drawing = read(tmp_path, rect(0, 0, 200, 100), second, *lines)
    assert counted(drawing) == (2, 0)
    assert said(drawing, "3 lines in blue on parts, which bound none: taken as scored")
    assert len(read(tmp_path, rect(0, 0, 200, 100), second, *(line.replace(BLUE, RED) for line in lines)).parts) == 5
    assert len(read(tmp_path, rect(0, 0, 200, 100), *lines).parts) == 4  # it may be the board
    grid = [*lines, *(path([(0, y), (200, y)], BLUE, closed=False) for y in (30, 70)), rect(70, 20, 60, 60, BLUE)]
    assert counted(read(tmp_path, rect(0, 0, 200, 100), second, disc(100, 50, 5), *grid)) == (2, 1)


def test_an_outline_drawn_with_the_thickness_of_its_line_is_one(tmp_path):
    def thick(x, y, w, h):
        inner = f"M{x + 0.2},{y + 0.2}v{h - 0.4}h{w - 0.4}v{0.4 - h}z"
        return f'<path fill="#000000" fill-rule="evenodd" d="M{x},{y}h{w}v{h}h{-w}z{inner}"/>'

    drawing = read(tmp_path, thick(0, 0, 100, 80), thick(20, 20, 50, 40), disc(10, 10, 2, RED))
    assert counted(drawing) == (1, 2)
    assert np.isclose(area(drawing)[0], 8000 - 2000 - 4 * np.pi, rtol=1e-3)
    assert said(drawing, "2 outlines drawn with the thickness of their line")


def test_a_sheet_that_is_round_in_pixels_is_doubted(tmp_path):
    """A drawing of 300 x 150 mm that was exported as pixels of 1/96 inch is 3.78 times too small."""
    k = 25.4 / 96
    panels = [rect(x * k, 10 * k, 80 * k, 60 * k) + disc((x + 40) * k, 40 * k, 5 * k) for x in (10, 110, 210)]
    drawing = read(tmp_path, rect(0, 0, 300 * k, 150 * k, BLUE), *panels)
    assert counted(drawing) == (3, 3)
    assert said(drawing, "the sheet is 79.375 x 39.6875 mm, but 300 x 150 pixels of 1/96 inch")
    sheet = rect(0, 0, 300, 150, BLUE)
    panels = [rect(x, 10, 80, 60) + disc(x + 40, 40, 5) for x in (10, 110, 210)]
    assert not said(read(tmp_path, sheet, *panels), "pixels of")


def test_dimensions_on_panels_of_open_lines(tmp_path):
    """Four strips between lines drawn once, and what measures them in red."""
    black = [path([(10, y), (200, y)], closed=False) for y in range(10, 91, 20)]
    black += [path([(x, y), (x, y + 20)], closed=False) for x in (10, 200) for y in range(10, 90, 20)]
    red = [path([(20, 10), (20, 90)], RED, closed=False), strokes("OVERA", 24, 25, RED)]
    drawing = read(tmp_path, *black, *red)
    assert counted(drawing) == (4, 0)
    assert said(drawing, "taken as dimensions or notes")


@pytest.mark.parametrize(("waist", "notch", "parts"), [(10, 0, 2), (10, 6, 2), (4, 0, 5)])
def test_holes_across_the_seam_of_two_panels(tmp_path, waist, notch, parts):
    """Rectangles across a seam are cut out, also with a notch; butterflies hold the panels together, and are parts."""
    faces = [
        [(92, y), (92, y + 10), (100, y + 5 + waist / 2), (108, y + 10)]
        + [(108 - deep, y + side) for deep, side in ((0, 7), (notch, 7), (notch, 3), (0, 3)) if notch]
        + [(108, y), (100, y + 5 - waist / 2)]
        for y in (10, 30, 50)
    ]
    ends = [0, *(y + 5 + side * waist / 2 for y in (10, 30, 50) for side in (-1, 1)), 70]
    seams = [path([(100, a), (100, b)], closed=False) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    drawing = read(tmp_path, rect(0, 0, 200, 70), *seams, *map(path, faces))
    assert len(drawing.parts) == parts
    assert said(drawing, "taken as cut out") == (parts == 2)


def test_labels_in_an_outline(tmp_path):
    """What lies in an outline of that name is cut out of it, whatever it is for."""
    inner = [disc(x, 50, 8, more=f'inkscape:label="LED {x}"') for x in (60, 100, 140)]
    assert counted(read(tmp_path, rect(0, 0, 200, 100, more='inkscape:label="Outline"'), *inner)) == (1, 3)


def test_white_shapes_on_a_part_without_fill(tmp_path):
    white = 'fill="#ffffff" stroke="#000000"'
    assert counted(read(tmp_path, rect(0, 0, 200, 100), disc(50, 50, 8, white), rect(100, 20, 40, 40, white))) == (1, 2)


def test_a_hole_a_hair_inside_the_edge_of_its_path(tmp_path):
    """The notch of a path that all but meets its hole opens it."""
    outer = "M0,0H200V40H190.0005V60H200V100H0Z"
    drawing = read(tmp_path, f'<path d="{outer}M10,10H190V90H10Z" fill="red" fill-rule="evenodd"/>')
    assert counted(drawing) == (1, 0)
    assert area(drawing) == pytest.approx([200 * 100 - 180 * 80 - 10 * 20], abs=0.1)


def test_gears_are_no_letters(tmp_path):
    """A row of toothed rings, not all alike, in a panel."""

    def gear(x: float, teeth: int) -> str:
        turns = np.linspace(0, 2 * np.pi, 4 * teeth, endpoint=False)
        radius = 5 + 2 * (np.arange(4 * teeth) % 4 < 2)
        ring = np.column_stack([x + radius * np.cos(turns), 50 + radius * np.sin(turns)])
        return path(ring) + disc(x, 50, 4)

    gears = [gear(40 + 20 * k, 9 + k % 2) for k in range(4)]
    assert not said(read(tmp_path, rect(0, 0, 200, 100), *gears), LETTERS)


def test_a_picture_on_several_layers(tmp_path):
    """What one colour draws on the layer of each part is engraved on all of them."""
    links = [rect(0, 120 * k, 200, 100) + disc(20, 120 * k + 50, 5) for k in range(2)]
    marks = [disc(100, 50, 20, RED) + disc(100, 50, 15, RED), disc(100, 170, 20, RED)]
    layers = [f'<g inkscape:groupmode="layer" inkscape:label="link {k}">{links[k]}{marks[k]}</g>' for k in range(2)]
    assert counted(read(tmp_path, *layers)) == (2, 2)
