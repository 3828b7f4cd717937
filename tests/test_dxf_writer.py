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
from wiggleroom.assembly.assembly import place
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.drawing.writers.lettering import Label, labels_of, lettered
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
        ("12_shaft/shaft.svg", None),
        ("09_tray/tray.svg", None),
        ("11_glue_and_gaps/row.json", None),
        ("06_frame/frame.json", None),
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


@settings(max_examples=25, deadline=None)
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


@pytest.mark.parametrize("name", ["score", "Raster 2", "engraved lid"])
@pytest.mark.parametrize("ending", ["dxf", "svg"])
def test_a_part_may_be_called_like_an_engraving(tmp_path, ending, name):
    """Elements of such names are left out of drawings by others; of one that we wrote they are parts, with their holes."""
    square = np.array([[0.0, 0], [6, 0], [6, 6], [0, 6]])
    lid = Part(name, (Region(square, (square[::-1] / 2 + 1,)),))
    write_drawing(Drawing((lid, Part("box", (Region(square),), (20.0, 0.0, 0.0)))), tmp_path / f"x.{ending}")
    again = read_drawing(tmp_path / f"x.{ending}")
    assert [(part.name, len(part.regions[0].holes)) for part in again.parts] == [(name, 1), ("box", 0)]
    assert not again.notes


def test_a_part_copied_in_another_program_is_another_part(tmp_path):
    """Pieces of one part are told by name and number; copies of them are not more pieces of it."""
    square = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
    write_drawing(Drawing((Part("a", (Region(square), Region(square + np.array([6, 0])))),)), tmp_path / "x.dxf")
    document = ezdxf.readfile(tmp_path / "x.dxf")
    space = document.modelspace()
    for line in list(space.query('*[layer=="cut"]')):
        space.add_entity(line.copy().translate(0, 50, 0))
    document.saveas(tmp_path / "y.dxf")
    again = read_drawing(tmp_path / "y.dxf")
    assert [(part.name, len(part.regions)) for part in again.parts] == [("a", 2), ("a-2", 2)]


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


@pytest.mark.parametrize("name", ["a", "left wing", "-0.05", "ÄÖ", "日本", "W" * 60])
def test_names_fit_their_parts(name):
    outer = np.array([[0.0, 0], [30, 0], [30, 8], [12, 8], [12, 20], [0, 20]])
    part = Part(name, (Region(outer),), at=(100.0, 20.0, 0.7))
    (label,) = labels_of([part])
    strokes = lettered(label)
    assert strokes
    assert shapely.Polygon(place(outer, part.at)).contains(
        shapely.multilinestrings([shapely.linestrings(stroke) for stroke in strokes])
    )
    assert all(np.ptp(stroke, axis=0).max() > 0 for stroke in strokes)


def test_letters_are_all_different():
    """Every printable ASCII letter has strokes of its own."""
    drawn = {}
    for code in range(33, 127):
        strokes = lettered(Label(chr(code), (0.0, 0.0), 6.0))
        drawn.setdefault(repr([stroke.tolist() for stroke in strokes]), []).append(chr(code))
    same = [letters for letters in drawn.values() if len(letters) > 1]
    assert len(same) <= 1  # what it has no strokes for is a box
    assert {letter for letters in same for letter in letters} <= set("$@^`{}~")


@pytest.mark.parametrize("out", ["x.dxf", "x.svg", "x.json"])
def test_convert(tmp_path, out):
    file = EXAMPLES / "drawings/jointpanel_2x2.svg"
    command = [
        sys.executable,
        "-c",
        "from wiggleroom.cli import main; main()",
        "convert",
        str(file),
        out,
        "--gap",
        "0.2",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "4 parts" in done.stderr
    again = read(tmp_path / out)
    truth = read(file, gap=0.2)
    for a, b in zip(truth.parts, again.parts, strict=True):
        assert material(a).symmetric_difference(material(b)).area < 1e-6


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
