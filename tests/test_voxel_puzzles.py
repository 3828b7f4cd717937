"""Voxel puzzles from files: where their pieces lie, what is left out, and one plain line for what is wrong."""

from __future__ import annotations

import gzip
import itertools
from pathlib import Path

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.app.open_requests import first_open_in_space, opened
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.readers.voxel_puzzle import orientation, read_puzzle
from wiggleroom.schema.requests import OpenRequest

BOX = "2 2 2\n1 1\n2 1\n\n2 1\n2 2\n"
L_SHAPES = """<?xml version="1.0"?>
<puzzle version="2"><gridType type="0"/><colors><color red="1"/></colors>
<shapes><voxel x="2" y="2" z="1" type="0" name="L">#1_##</voxel><voxel x="1" y="1" z="1" hx="1" type="0">#</voxel></shapes>
<problems><problem><shapes><shape id="0" count="1"/></shapes></problem>
<problem name="pair" state="2"><shapes><shape id="0" min="0" max="3" group="1"/><shape id="1" count="1"/></shapes>
<solutions><solution><assembly>0 0 0 0 x 1 1 0 10 3 0 0 0</assembly></solution>
<solution><assembly>x x x 0 0 0 0</assembly></solution></solutions></problem></problems></puzzle>"""


def cells(drawing: Drawing) -> dict[str, set]:
    return {
        part.name: {
            v
            for low, high in (part.solid.boxes / 10).round().astype(int).tolist()
            for v in itertools.product(*map(range, low, high))
        }
        for part in drawing.parts
    }


def test_numbers_of_pieces_go_along_x_first(tmp_path: Path) -> None:
    file = tmp_path / "a.puz"
    file.write_text("# 1.0\n2 1 3\n0.5 0.5 0.5\n1 2\n\n1 0\n\n1 1\n")
    found = cells(read_puzzle(file))
    assert found == {"p1": {(0, 0, 0), (0, 0, 1), (0, 0, 2), (1, 0, 2)}, "p2": {(1, 0, 0)}}
    file.write_text(BOX)
    answer = wr.check(wr.read(file))
    assert answer.verdict == "comes apart"
    assert wr.read(file, gap=0.5).gap == 0.5


def test_a_project_of_burrtools_places_its_pieces(tmp_path: Path) -> None:
    file = tmp_path / "a.xmpuzzle"
    file.write_bytes(gzip.compress(L_SHAPES.encode()))
    drawing = read_puzzle(file)
    # the second L is turned by half a turn about z; the cube's own origin lies one cell beside it
    assert cells(drawing) == {
        "L": {(0, 0, 0), (0, 1, 0), (1, 1, 0)},
        "L_2": {(1, 1, 0), (1, 0, 0), (0, 0, 0)},
        "S2": {(2, 0, 0)},
    }
    said = " ".join(drawing.notes)
    for what in ("problem 2 (pair), solution 1; 1 other problem and 1 other solution", "1 pieces", "colours", "groups"):
        assert what in said
    assert list(cells(read_puzzle(file, solution=1))) == ["S2"]


def test_the_page_opens_a_puzzle_as_boxes(tmp_path: Path) -> None:
    file = tmp_path / "a.puz"
    file.write_text(BOX)
    opened_file = opened(msgspec.json.decode(first_open_in_space(file, read_puzzle(file)), type=OpenRequest))
    assert cells(opened_file.drawing) == cells(read_puzzle(file))
    assert opened_file.drawing.gap == read_puzzle(file).gap


def test_orientations_are_all_turns_of_a_cube_and_their_mirrors() -> None:
    turns = [orientation(k) for k in range(48)]
    assert len({turn.tobytes() for turn in turns}) == 48
    assert [round(np.linalg.det(turn)) for turn in turns] == 24 * [1] + 24 * [-1]
    assert (turns[1] == Rotation.from_euler("x", 90, degrees=True).as_matrix().round()).all()
    assert (turns[4] == Rotation.from_euler("y", -90, degrees=True).as_matrix().round()).all()
    assert (turns[16] == Rotation.from_euler("z", 90, degrees=True).as_matrix().round()).all()


def test_a_piece_of_two_lumps_is_said(tmp_path: Path) -> None:
    file = tmp_path / "a.puz"
    file.write_text("3 1 1\n1 2 1\n")
    assert 'piece "p1" has 2 lumps whose cells share no face; they move as one' in " ".join(read_puzzle(file).notes)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "a.puz",
            "2 2 2\n1 1 1\n",
            "has 3 numbers for 2 x 2 x 2 cells; after three sizes there must be one for every cell",
        ),
        ("a.puz", "2 two 2\n1 1 1\n", "is no voxel puzzle; it must be three sizes"),
        ("a.puz", "1 1 1\n0\n", "has no pieces; some cells must be filled"),
        ("a.puz", "4294967296 4294967296 1\n", "has 0 numbers for 4294967296 x 4294967296 x 1 cells"),
        ("a.puz", "274177 67280421310721 1\n1\n", "has 1 numbers for 274177 x 67280421310721 x 1 cells"),
        ("a.puz", "28 28 28\n" + "1 0 " * 10976, "pieces have more than 10000 rows of cells"),
        ("a.xmpuzzle", L_SHAPES.replace('id="0" min', 'id="--0" min'), 'shape has id="--0"; it must be a whole number'),
        ("a.xmpuzzle", L_SHAPES.replace("assembly", "nothing"), "no problem has a stored solution that says where"),
        ("a.xmpuzzle", L_SHAPES.replace('gridType type="0"', 'gridType type="3"'), "only cubes, type 0, are read"),
        ("a.xmpuzzle", L_SHAPES.replace("#1_##", "#1_#"), "shape 0 of 2 x 2 x 1 cells has 3 of them"),
        ("a.xmpuzzle", L_SHAPES.replace("0 0 0 0 x", "0 0 0 90 x"), 'a solution has "0 0 0 90" for a piece'),
        ("a.xmpuzzle", L_SHAPES.replace("puzzle", "riddle"), "is no project of BurrTools"),
        ("a.xmpuzzle", L_SHAPES.replace('id="0" min', 'id="7" min'), "a problem uses shape 7, but there are 2 shapes"),
    ],
)
def test_what_is_wrong_with_a_puzzle_is_said_in_one_line(tmp_path: Path, name: str, text: str, said: str) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(wr.InputError) as raised:
        wr.read(file)
    assert len(raised.value.findings) == 1
    assert said in str(raised.value)
