"""Assembly files: units, angles, references, and a round trip to the last digit."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Drawing, JointGap, Part, Pull, Region, Turn, W
from wiggleroom.drawing.readers.assembly_file import read_assembly
from wiggleroom.drawing.writers.assembly_writer import degrees, write_assembly
from wiggleroom.errors import InputError

CONTRACT = """
{ "format": "wiggleroom/1", "unit": "mm", "gap": 0.2,
  "shapes": { "brick": { "outline": [[0,0],[10,0],[10,5],[0,5]], "holes": [] } },
  "parts": [ { "name": "a1", "shape": "brick", "at": [0, 0, 0], "fixed": true },
             { "name": "a2", "outline": [[0,0],[1,0],[1,1]], "at": [12, 0, 90], "offset": -0.05 },
             { "name": "a3", "outlines": [{"outline": [[0,0],[0,4],[4,4],[4,0]], "holes": [[[1,1],[2,1],[2,2]]]},
                                          {"outline": [[6,0],[7,0],[7,1]]}] },
             { "name": "a4", "shape": "brick" } ],
  "glue": [["a1", "a2"]], "ignore": [["a1", "a3"]],
  "gaps": [ { "parts": ["a1", "a4"], "gap": 0.5 } ],
  "pull": [ { "part": "a2", "direction": [0, 1], "point": [12, 1], "weight": 2 }, {"part": "a3", "turn": "ccw"},
            { "part": "a3", "w": [1, 0, 2] } ] }
"""


def assert_same(a: Drawing, b: Drawing) -> None:
    """Equal to the last digit."""
    assert (a.gap, a.glue, a.ignore, a.gaps, a.goals) == (b.gap, b.glue, b.ignore, b.gaps, b.goals)
    assert [p.name for p in a.parts] == [p.name for p in b.parts]
    for p, q in zip(a.parts, b.parts, strict=True):
        assert (p.fixed, p.offset, p.at) == (q.fixed, q.offset, q.at)
        assert len(p.regions) == len(q.regions)
        for r, s in zip(p.regions, q.regions, strict=True):
            assert r.outer.tolist() == s.outer.tolist()
            assert [hole.tolist() for hole in r.holes] == [hole.tolist() for hole in s.holes]


def test_contract():
    drawing = read_assembly(CONTRACT)
    a1, a2, a3, a4 = drawing.parts
    assert a1.fixed
    assert not a2.fixed
    assert a2.at == (12.0, 0.0, math.pi / 2)
    assert a2.offset == -0.05
    assert a4.at == (0.0, 0.0, 0.0)
    assert a1.regions[0].outer.tolist() == [[0, 0], [10, 0], [10, 5], [0, 5]]
    assert a3.regions[0].outer.tolist() == [[4, 0], [4, 4], [0, 4], [0, 0]]  # turned counter-clockwise
    assert a3.regions[0].holes[0].tolist() == [[2, 2], [2, 1], [1, 1]]  # turned clockwise
    assert len(a3.regions) == 2
    assert drawing.gap == 0.2
    assert drawing.glue == (("a1", "a2"),)
    assert drawing.ignore == (("a1", "a3"),)
    assert drawing.gaps == (JointGap(("a1", "a4"), 0.5),)
    assert drawing.goals == (Pull("a2", (0, 1), (12, 1), 2.0), Turn("a3", "ccw"), W("a3", (1, 0, 2)))


@pytest.mark.parametrize(("unit", "mm"), [("mm", 1), ("cm", 10), ("m", 1000), ("in", 25.4)])
def test_unit_scales_every_length(unit, mm):
    drawing = read_assembly(CONTRACT.replace('"unit": "mm"', f'"unit": "{unit}"'))
    plain = read_assembly(CONTRACT)
    assert drawing.gap == 0.2 * mm
    assert drawing.gaps[0].gap == 0.5 * mm
    assert drawing.parts[1].offset == -0.05 * mm
    assert drawing.parts[1].at == (12 * mm, 0, math.pi / 2)
    assert drawing.goals[0].point == (12 * mm, mm)
    assert drawing.goals[2] == plain.goals[2]
    for part, other in zip(drawing.parts, plain.parts, strict=True):
        np.testing.assert_array_equal(part.regions[0].outer, other.regions[0].outer * mm)


def test_round_trip_of_the_contract():
    drawing = read_assembly(CONTRACT)
    text = write_assembly(drawing)
    assert_same(drawing, read_assembly(text))
    assert write_assembly(read_assembly(text)) == text
    assert list(json.loads(text)["shapes"]) == ["s1"]
    assert [part["at"][2] for part in json.loads(text)["parts"]] == [0, 90, 0, 0]


numbers = st.floats(-1e4, 1e4, allow_subnormal=False)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(numbers, numbers, st.floats(-720, 720), st.booleans(), st.floats(-1, 1)), min_size=1, max_size=5
    ),
    st.lists(st.tuples(st.floats(0.5, 2.0), st.integers(1, 40)), min_size=3, max_size=12),
    st.floats(0, 3),
)
def test_round_trip_is_exact(poses, spokes, gap):
    angles = np.cumsum([step for _, step in spokes])
    angles = angles * (2 * np.pi / (angles[-1] + 1))
    radii = np.array([r for r, _ in spokes])
    outer = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    text = write_assembly(
        Drawing(
            tuple(
                Part(f"part {i}", (Region(outer),), (x, y, math.radians(turn)), fixed, offset)
                for i, (x, y, turn, fixed, offset) in enumerate(poses)
            ),
            gap=gap,
        )
    )
    try:
        drawing = read_assembly(text)
    except InputError:
        return  # three spokes on one line
    again = write_assembly(drawing)
    assert_same(drawing, read_assembly(again))
    for part, (*_, turn, _, _) in zip(json.loads(again)["parts"], poses, strict=True):
        assert math.radians(part["at"][2]) == math.radians(turn)


def test_gap_of_the_call_replaces_the_files(tmp_path):
    path = tmp_path / "a.json"
    path.write_text(CONTRACT)
    assert read_drawing(path).gap == 0.2
    assert read_drawing(path, gap=0.7).gap == 0.7
    assert read_drawing(path, gap=0.0).gap == 0.0
    assert "flatten does not matter" in read_drawing(path, flatten=0.1).notes[0]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_encodings(tmp_path, encoding):
    path = tmp_path / "a.json"
    path.write_bytes(CONTRACT.replace("a4", "\u00e4\u4e2d").encode(encoding))
    assert read_drawing(path).parts[3].name == "\u00e4\u4e2d"


def test_writes_whole_or_not_at_all(tmp_path):
    drawing = read_assembly(CONTRACT)
    path = tmp_path / "out.json"
    write_drawing(drawing, path)
    assert_same(drawing, read_drawing(path))
    with pytest.raises(InputError, match=r"out\.pdf.*must be one of"):
        write_drawing(drawing, tmp_path / "out.pdf")
    with pytest.raises(InputError, match="directory that exists"):
        write_drawing(drawing, tmp_path / "no" / "out.json")
    (tmp_path / "taken.json").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        write_drawing(drawing, tmp_path / "taken.json")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["out.json", "taken.json"]


def test_numbers_of_numpy_are_written(tmp_path):
    """A pull computed with numpy is as good as one typed in."""
    outer = np.array([[0.0, 0], [2, 0], [2, 1]])
    part = Part("a", (Region(outer),), at=tuple(np.array([1.0, 2.0, 0.5])), offset=np.float64(0.125))
    pull = Pull("a", np.array([0.0, 1.0]), tuple(outer[1]), weight=np.float64(2.0))
    write_drawing(Drawing((part,), gap=np.float64(0.25), goals=(pull,)), tmp_path / "x.json")
    again = read_drawing(tmp_path / "x.json")
    assert again.parts[0].at == (1.0, 2.0, 0.5)
    assert again.parts[0].offset == 0.125
    assert again.gap == 0.25
    assert again.goals == (Pull("a", (0.0, 1.0), (2.0, 0.0), 2.0),)


def test_outlines_are_cleaned():
    corners = [[0, 0], [0, 0], [2, 0], [4, 0], [4, 4], [0, 4], [0, 2], [0, 0]]
    text = json.dumps({"format": "wiggleroom/1", "parts": [{"name": "a", "outline": corners}]})
    assert read_assembly(text).parts[0].regions[0].outer.tolist() == [[0, 0], [4, 0], [4, 4], [0, 4]]


@pytest.mark.parametrize("turn", [0, 90, -90, 180, 45, 33.3, 1e-3, 359.999, 720, 0.1 + 0.2])
def test_degrees_come_back(turn):
    assert math.radians(degrees(math.radians(turn))) == math.radians(turn)
    assert len(repr(degrees(math.radians(turn)))) <= len(repr(float(turn)))
