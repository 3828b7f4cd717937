"""Cut-ready files: what is written reads back as the assembly as made, and names stay out of the cut."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.test_svg_reader import assert_same_geometry, material
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.questions import read

ezdxf = pytest.importorskip("ezdxf")
EXAMPLES = Path(__file__).parents[1] / "examples"


def as_made(path: Path, gap: float | None) -> Drawing:
    assembly = read(path, gap=gap)
    return replace(assembly.drawing, parts=assembly.parts, gap=0.0, gaps=())


@pytest.mark.parametrize(
    ("file", "gap"),
    [
        ("drawings/jointpanel_2x2.svg", 0.2),
        ("drawings/pyjigsaw_4x5.svg", 1.0),
        ("09_tray/tray.svg", None),
        ("11_glue_and_gaps/row.json", None),
    ],
)
def test_what_is_made_comes_back(tmp_path, file, gap):
    made = as_made(EXAMPLES / file, gap)
    write_drawing(made, tmp_path / "x.dxf")
    again = read_drawing(tmp_path / "x.dxf")
    assert not again.notes
    assert_same_geometry(made, again, within=1e-9)
    assert [part.name for part in again.parts] == [part.name for part in made.parts]
    assert again.glue == made.glue


@settings(max_examples=12, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.floats(3, 9), st.floats(0, 360), st.booleans(), st.sampled_from(["plain", "hole", "island", "two"])
        ),
        min_size=1,
        max_size=5,
    ),
    st.text(st.characters(categories=["L", "N", "P", "S"], max_codepoint=0x1FFFF), max_size=40),
)
def test_any_part_comes_back(tmp_path_factory, rows, word):
    """Turned, far off, below zero, holes, islands in holes, several pieces, any name."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    parts = []
    for i, (size, turn, fixed, kind) in enumerate(rows):
        regions = {
            "plain": (Region(size * square),),
            "hole": (Region(size * square, (size / 2 * square[::-1],)),),
            "island": (Region(size * square, (size / 2 * square[::-1],)), Region(size / 3 * square)),
            "two": (Region(size / 3 * square), Region(size / 3 * square + np.array([size, 0]))),
        }[kind]
        parts.append(Part(f"{word}{i}", regions, (40.0 * i - 60, -1000.0, np.radians(turn)), fixed))
    path = tmp_path_factory.mktemp("any") / "x.dxf"
    write_drawing(Drawing(tuple(parts)), path)
    again = read_drawing(path)
    assert [part.name for part in again.parts] == [part.name for part in parts]
    for part, other in zip(parts, again.parts, strict=True):
        assert part.fixed == other.fixed
        assert len(part.regions) == len(other.regions)
        assert material(part).symmetric_difference(material(other)).area < 1e-6


@pytest.mark.parametrize("name", ["score", "engraved lid"])
@pytest.mark.parametrize("ending", ["dxf", "svg"])
def test_a_part_may_be_called_like_an_engraving(tmp_path, ending, name):
    """Elements of such names are left out of drawings by others; of one that we wrote they are parts, with their holes."""
    square = np.array([[0.0, 0], [6, 0], [6, 6], [0, 6]])
    lid = Part(name, (Region(square, (square[::-1] / 2 + 1,)),))
    write_drawing(Drawing((lid, Part("box", (Region(square),), (20.0, 0.0, 0.0)))), tmp_path / f"x.{ending}")
    again = read_drawing(tmp_path / f"x.{ending}")
    assert [(part.name, len(part.regions[0].holes)) for part in again.parts] == [(name, 1), ("box", 0)]
    assert not again.notes


def test_layers_for_the_cutter(tmp_path):
    made = as_made(EXAMPLES / "drawings/jointpanel_2x2.svg", 0.2)
    ring = Region(np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]]), (np.array([[3.0, 3], [3, 6], [6, 6], [6, 3]]),))
    parts = (replace(made.parts[0], fixed=True), *made.parts[1:], Part("ring", (ring,), (-50, -50, 0)))
    write_drawing(Drawing(parts), tmp_path / "x.dxf")
    document = ezdxf.readfile(tmp_path / "x.dxf")
    layers = [line.dxf.layer for line in document.modelspace()]
    assert (layers.count("cut"), layers.count("fixed"), layers.count("holes")) == (4, 1, 1)
    assert document.units == ezdxf.units.MM
    assert not document.audit().errors
    assert {line.dxf.layer for line in document.modelspace() if not line.closed} == {"labels"}
    plates = shapely.union_all([material(part) for part in parts])
    for line in document.modelspace().query('*[layer=="labels"]'):
        assert plates.contains(shapely.LineString([point[:2] for point in line.get_points("xy")]))


def test_the_same_drawing_gives_the_same_file(tmp_path):
    made = as_made(EXAMPLES / "09_tray/tray.svg", None)
    for name in ("a.dxf", "b.dxf"):
        write_drawing(made, tmp_path / name)
    assert (tmp_path / "a.dxf").read_bytes() == (tmp_path / "b.dxf").read_bytes()
    assert (tmp_path / "a.dxf").read_bytes().isascii()


def test_labels_of_an_svg_are_no_parts(tmp_path):
    made = as_made(EXAMPLES / "drawings/jointpanel_2x2.svg", 0.2)
    write_drawing(made, tmp_path / "x.svg")
    text = (tmp_path / "x.svg").read_text()
    assert text.count("<path") == 2 * len(made.parts)
    again = read_drawing(tmp_path / "x.svg")
    assert not again.notes
    assert len(again.parts) == len(made.parts)
    write_drawing(made, tmp_path / "y.svg", labels=())
    assert (tmp_path / "y.svg").read_text().count("<path") == len(made.parts)


def test_without_ezdxf(tmp_path):
    """One line that names the extra, exit code 2."""
    code = "import sys; sys.modules['ezdxf'] = None; from wiggleroom.cli import main; sys.exit(main())"
    file = str(EXAMPLES / "09_tray/tray.svg")
    done = subprocess.run(
        [sys.executable, "-c", code, "convert", file, "x.dxf"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].endswith("pip install '.[dxf]'")
    assert not (tmp_path / "x.dxf").exists()
