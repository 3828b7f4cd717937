"""From a maker's file to an answer: options that say how it is read, what is said, and draw that always draws."""

from __future__ import annotations

import json
import random
import shlex
import sys
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
import shapely.affinity
from shapely.ops import split

import wiggleroom as wr
from tests.makers.by_hand import FINDINGS, LINE, STYLES, box, svg
from wiggleroom.cli import main
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.outlines.joining import join_ends
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError


@pytest.fixture
def run(monkeypatch, capsys):
    def call(command: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["wiggleroom", *shlex.split(command)])
        code = main()
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def file_of(tmp_path, body: str, name: str = "x.svg"):
    path = tmp_path / name
    path.write_bytes(svg(body))
    return path


TRAY = box(0, 0, 60, 60, f'id="tray" {LINE}') + f'<circle id="disc" cx="30" cy="30" r="10" {LINE}/>'


@pytest.mark.parametrize("seed", range(3))
def test_faces_of_random_lines_tile_what_shapely_finds(tmp_path, seed):
    """Straight cuts across a square: areas against shapely's own split, whatever order the lines come in."""
    lot = random.Random(seed)
    cuts = []
    for _ in range(6):
        a, b = lot.uniform(0, 60), lot.uniform(0, 60)
        cuts.append(((0.0, a), (60.0, b)) if lot.random() < 0.5 else ((a, 0.0), (b, 60.0)))
    lines = [f'<path d="M{a[0]} {a[1]}L{b[0]} {b[1]}" {LINE}/>' for a, b in cuts]
    pieces = [shapely.box(0, 0, 60, 60)]
    for a, b in cuts:
        across = shapely.affinity.scale(shapely.LineString([a, b]), 1.1, 1.1)
        pieces = [p for piece in pieces for p in split(piece, across).geoms]
    drawing = read_drawing(file_of(tmp_path, "".join([*lines, box(0, 0, 60, 60)])))
    found = sorted(shapely.Polygon(part.regions[0].outer).area for part in drawing.parts)
    wide = [piece.area for piece in pieces if 2 * piece.area > 0.05 * piece.length]  # thinner ones are no parts
    assert found == pytest.approx(sorted(wide), abs=1e-4)


def test_a_net_of_many_lines(tmp_path):
    n = 30
    lines = [f'<path d="M{10 * i} {10 * j}h10" {LINE}/>' for i in range(n) for j in range(n + 1)]
    lines += [f'<path d="M{10 * j} {10 * i}v10" {LINE}/>' for i in range(n) for j in range(n + 1)]
    random.Random(0).shuffle(lines)
    path = file_of(tmp_path, "".join(lines))
    assert len(read_drawing(path).parts) == n * n


def test_clearance_between_outlines_of_single_lines_is_never_closed(tmp_path):
    """Two squares of loose lines 0.02 mm apart, far below the distance at which open ends are joined."""
    sides = [[(x, 0), (x + 20, 0), (x + 20, 20), (x, 20), (x, 0)] for x in (0.0, 20.02)]
    lines = [(a, b) for corners in sides for a, b in pairwise(corners)]
    random.Random(3).shuffle(lines)
    body = "".join(f'<line x1="{a[0]}" y1="{a[1]}" x2="{b[0]}" y2="{b[1]}" {LINE}/>' for a, b in lines)
    drawing = read_drawing(file_of(tmp_path, body))
    left, right = (shapely.Polygon(p.regions[0].outer + p.at[:2]) for p in drawing.parts)
    assert shapely.distance(left, right) == pytest.approx(0.02, abs=1e-9)


def test_a_peg_loose_in_a_hole_is_no_copy_of_it(tmp_path):
    body = TRAY + f'<circle id="peg" cx="30" cy="30" r="9.995" {LINE}/>'
    drawing = read_drawing(file_of(tmp_path, body))
    assert [part.name for part in drawing.parts] == ["tray", "peg"]
    assert len(drawing.parts[0].regions[0].holes) == 1


def test_what_is_fixed_or_pulled_is_a_part(tmp_path, run):
    path = file_of(tmp_path, TRAY)
    code, out, _ = run(f"parts {path} --fix disc --json -")
    assert code == 0
    assert {part["name"]: part["fixed"] for part in json.loads(out)["parts"]} == {"tray": False, "disc": True}
    code, out, _ = run(f"flex {path} --gap 0.2 --fix tray --pull disc:+x --json -")
    answer = json.loads(out)
    assert answer["objective"] == pytest.approx(0.2, abs=5e-3)
    assert any("1 outline inside another is a part" in note for note in answer["notes"])


def test_parts_are_chosen_by_a_point(tmp_path, run):
    path = file_of(tmp_path, box(0, 0, 30, 30) + box(30, 0, 30, 30))
    _, out, _ = run(f"parts {path} --fix @40,60 --json -")
    assert [part["fixed"] for part in json.loads(out)["parts"]] == [False, True]
    code, _, err = run(f"flex {path} --fix @90,5 --pull p1:-x")
    assert code == 2
    assert "there is no part at this point" in err
    assert wr.read(path, fix=["@40,60"]).parts[1].fixed


def test_ignore_glue_and_gap_of(tmp_path, run):
    path = file_of(tmp_path, box(0, 0, 30, 30, f'id="a" {LINE}') + box(20, 20, 30, 30, f'id="b" {LINE}'))
    code, _, err = run(f"check {path}")
    assert code == 2
    assert "--ignore a,b" in err
    assert "--glue a,b" in err
    for option in ("--ignore a,b", "--glue a,b", "--ignore @5,75,b"):
        code, _, err = run(f"convert {path} {tmp_path}/y.json {option}")
        assert code == 0, err
    assert json.loads((tmp_path / "y.json").read_text())["ignore"] == [["a", "b"]]
    pair = file_of(tmp_path, box(0, 0, 30, 30, f'id="a" {LINE}') + box(30, 0, 30, 30, f'id="b" {LINE}'))
    code, _, err = run(f"convert {pair} {tmp_path}/z.json --gap 0.1 --gap-of a,b:0.3")
    assert code == 0, err
    assert json.loads((tmp_path / "z.json").read_text())["gaps"] == [{"parts": ["a", "b"], "gap": 0.3}]
    for odd in ("--gap-of a,b", "--glue a", "--ignore a,b,c", "--only nothing", "--join -1"):
        code, _, err = run(f"convert {pair} {tmp_path}/z.json {odd}")
        assert code == 2, odd
        said = [line for line in err.splitlines() if ": drawing " not in line]  # an option is checked after reading
        assert len(said) == 1, err


def test_an_overlap_that_the_gap_opens_is_said(tmp_path):
    path = file_of(tmp_path, box(0, 0, 30.01, 30) + box(30, 0, 30, 30))
    with pytest.raises(InputError, match=r"overlap by 0\.01 mm"):
        wr.read(path)
    notes = wr.read(path, gap=0.1).drawing.notes
    assert any("overlap by 0.01 mm as drawn; the gap of 0.1 opens that" in note for note in notes)


def test_only_and_skip(tmp_path):
    body = box(0, 0, 30, 30, 'fill="none" stroke="red"') + box(40, 0, 30, 30, 'fill="none" stroke="#0000FF"')
    path = file_of(tmp_path, body)
    for options in (ReadOptions(only=("red",)), ReadOptions(skip=("#00f",))):
        drawing = read_drawing(path, options=options)
        assert drawing.parts[0].at[:2] == pytest.approx((15, 65))
        assert len(drawing.parts) == 1
    with pytest.raises(InputError, match="there is blue"):
        read_drawing(path, options=ReadOptions(skip=("bleu",)))


@pytest.mark.parametrize("case", [*FINDINGS, *STYLES][::3], ids=lambda case: case.name)
def test_draw_always_draws(case, tmp_path, run):
    path = tmp_path / case.name
    path.write_bytes(case.data)
    code, out, err = run(f"draw {path} {tmp_path}/out.svg")
    assert code == 0, err
    picture = ElementTree.parse(tmp_path / "out.svg").getroot()
    words = " ".join("".join(text.itertext()) for text in picture.iter("{http://www.w3.org/2000/svg}text"))
    if case.parts and not case.options:
        assert "width mm" in out
        assert "width mm" in words
    if case.refused:
        assert "1 fault" in words


def test_pieces_of_one_part_come_back(tmp_path):
    square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    part = wr.Part("two", (wr.Region(square), wr.Region(square + 20)))
    for name in ("x.svg", "x.dxf"):
        write_drawing(wr.Drawing((part,)), tmp_path / name)
        again = read_drawing(tmp_path / name)
        assert [(p.name, len(p.regions)) for p in again.parts] == [("two", 2)]


def test_an_id_is_another_name_of_a_part_that_has_a_label(run, tmp_path):
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:label'
    body = box(0, 0, 10, 10, f'id="path12" {label}="frame" {LINE}') + box(
        11, 0, 10, 10, f'id="path34" {label}="lid" {LINE}'
    )
    path = file_of(tmp_path, body)
    assert [(p.name, p.aliases) for p in read_drawing(path).parts] == [("frame", ("path12",)), ("lid", ("path34",))]
    code, _, said = run(f"flex {path} --gap 0.1 --fix path12 --pull path34:-x")
    assert code == 0, said
    code, _, said = run(f"flex {path} --gap 0.1 --fix path13 --pull path34:-x")
    assert code == 2
    assert 'there is no part "path13"' in said


def test_an_id_that_two_parts_share_names_neither(tmp_path):
    """One path of two pieces whose texts name them: the path's id is no name of either."""
    data = "M0 0H10V10H0Z M20 0H30V10H20Z"
    body = f'<path id="path9" d="{data}" {LINE}/><text x="5" y="5">a</text><text x="25" y="5">b</text>'
    parts = read_drawing(file_of(tmp_path, body)).parts
    assert [(part.name, part.aliases) for part in parts] == [("a", ()), ("b", ())]


def test_an_end_goes_to_the_nearest_only():
    lines = [np.array([[0.0, 0], [9, 0]]), np.array([[9.01, 0], [9, 9]]), np.array([[9.03, 0], [20, 0]])]
    ends = join_ends(lines, 0.05, 20.0)
    assert ends.node[0, 1] == ends.node[1, 0] == ends.node[2, 0]
    pairs = [
        np.array([[0.0, 0], [9, 0]]),
        np.array([[9.0, 0], [9, 9]]),
        np.array([[9.02, 0], [9.02, 9], [20, 0], [9.02, 0]]),
    ]
    ends = join_ends(pairs, 0.05, 20.0)
    assert ends.node[0, 1] != ends.node[2, 0]
