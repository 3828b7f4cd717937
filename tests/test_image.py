"""Pictures become blocks: which cells are dark, holes, islands, joints, roles; and the command."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.assembly import patterns
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.cli import main
from wiggleroom.drawing import read_bitmap

Image = pytest.importorskip("PIL.Image")


def grid(text):
    return np.array([[c == "#" for c in row] for row in text.split()])


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["wiggleroom", "make", "image", *map(str, words)])
    return main()


@pytest.mark.parametrize("joint", ["tee", "revolute"])
def test_blocks_join_their_neighbours_and_are_plain_elsewhere(joint):
    dark = grid("##.# #### #..# .###")
    made = patterns.image(dark, joint, gap=0.02)
    drawn, _ = placed_regions(made.drawing.parts)
    whole = shapely.union_all(drawn, grid_size=1e-9)
    cells = [shapely.box(i - 0.5, 2.5 - j, i + 0.5, 3.5 - j) for j, i in np.argwhere(dark)]
    assert whole.symmetric_difference(shapely.union_all(cells)).area < 1e-6  # plain outside, nothing missing inside
    shapes, _ = placed_regions(made.parts)
    at = made.rest[:, :2]
    for i in range(len(shapes)):
        for j in range(i):
            if np.abs(at[i] - at[j]).sum() < 1.1:
                assert shapely.distance(shapes[i], shapes[j]) == pytest.approx(0.02, abs=1e-12)
                pulled = shapely.affinity.translate(shapes[j], *(0.15 * (at[j] - at[i])))
                assert shapes[i].intersects(pulled)  # joined
            else:
                assert shapely.distance(shapes[i], shapes[j]) >= 0.02 - 1e-12


def test_names_roles_and_places():
    made = patterns.image(grid("..# .## .#."), pitch=10.0, gap=0.1)
    assert made.names == ("b2-1", "b2-2", "b3-2", "b3-3")
    assert made.rest[:, :2].tolist() == [[10, 0], [10, 10], [20, 10], [20, 20]]
    assert [p.fixed for p in made.parts] == [True, False, False, False]
    assert made.goals == (wr.Pull("b3-3", (0.0, 1.0)),)
    own = patterns.image(grid("###"), fix=["b2-1"], goals=[wr.Pull("b1-1", (-1, 0)), wr.Turn("b3-1")])
    assert [p.fixed for p in own.parts] == [False, True, False]
    assert len(own.goals) == 2


def test_islands():
    dark = grid("##..# ##..# ....# #...#")
    largest = patterns.image(dark)
    assert set(largest.names) in ({"b1-3", "b2-3", "b1-4", "b2-4"}, {"b5-1", "b5-2", "b5-3", "b5-4"})
    assert largest.drawing.notes == ("left out: 5 blocks in 2 islands not joined to the largest one",)
    everything = patterns.image(dark, islands="all")
    assert len(everything.parts) == 9
    assert [p.name for p in everything.parts if p.fixed] == ["b1-1", "b5-1", "b1-3"]
    assert everything.goals[0].part == "b5-4"
    assert wr.flex(everything, search=0).objective == pytest.approx(
        0.03, rel=0.05
    )  # three tee joints straight up: one gap each


def test_brightness_area_and_transparency(tmp_path):
    pixels = np.full((40, 60, 4), 255, dtype=np.uint8)
    pixels[0:10, 0:10] = (0, 0, 0, 255)  # dark
    pixels[0:10, 10:14] = (0, 0, 0, 255)  # four tenths of a cell
    pixels[0:10, 20:26] = (0, 0, 0, 255)  # six tenths
    pixels[0:10, 30:40] = (0, 0, 0, 0)  # black but transparent
    pixels[0:10, 40:50] = (0, 0, 255, 255)  # blue is dark
    pixels[0:10, 50:60] = (255, 255, 0, 255)  # yellow is light
    Image.fromarray(pixels).save(tmp_path / "p.png")
    assert read_bitmap(tmp_path / "p.png", 6)[0].tolist() == [True, False, True, False, True, False]
    assert read_bitmap(tmp_path / "p.png", 6, threshold=0.7)[0].tolist() == [True, True, True, False, True, False]
    assert read_bitmap(tmp_path / "p.png").shape == (40, 60)
    assert read_bitmap(tmp_path / "p.png", 6).shape == (4, 6)


@pytest.mark.parametrize("mode", ["1", "P", "CMYK", "I;16", "F"])
def test_all_kinds_of_pixels(tmp_path, mode):
    picture = Image.new("L", (4, 4), 255)
    picture.paste(0, (1, 1, 3, 4))
    if mode == "I;16":
        picture = Image.fromarray(np.asarray(picture).astype(np.uint16) * 257)
    elif mode == "F":
        picture = Image.fromarray(np.asarray(picture).astype(np.float32) / 255)
    else:
        picture = picture.convert(mode)
    name = tmp_path / ("p.tif" if mode in ("CMYK", "F") else "p.png")
    picture.save(name)
    assert (read_bitmap(name) == grid(".... .##. .##. .##.")).all()


def test_command(tmp_path, monkeypatch, capsys):
    picture, out = tmp_path / "ring.png", tmp_path / "ring.json"
    Image.fromarray(np.where(grid("###. #.#. ###. ...#"), 0, 255).astype(np.uint8)).save(picture)
    words = ["--joint", "swallowtail", "--size", "neck=0.15", "--fix", "b1-2,b3-2", "--pull", "b2-4:+y"]
    assert run(monkeypatch, picture, *words, "-o", out) == 0
    said = capsys.readouterr().err
    assert "left out: 1 block in 1 island" in said
    assert "8 parts" in said
    made = wr.read(out)
    assert [p.name for p in made.parts if p.fixed] == ["b1-2", "b3-2"]
    assert made.goals == (wr.Pull("b2-4", (0.0, 1.0)),)
    assert len({p.regions[0].outer.tobytes() for p in made.parts}) == 6  # corners 4, sides lying and standing


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nothing.png"], "nothing.png: there is no such file"),
        (["text.png"], "text.png: this is no picture"),
        (["white.png"], "hang together"),
        (["dark.png", "--blocks", "0"], "0 blocks across: it must be between 1"),
        (["dark.png", "--threshold", "1.5"], "between 0 (black) and 1 (white)"),
        (["dark.png", "--gap", "2"], "vanishes"),
        (["dark.png", "--joint", "swalowtail"], "choose swallowtail"),
        (["dark.png", "--pitch", "0"], "--pitch 0: it must be more than 0"),
        (["dark.png", "--fix", "b9-9"], 'there is no part "b9-9"'),
        (["dark.png", "--pull", "b1-1:up"], "--pull b1-1:up: write"),
        (["dark.png", "--size", "fix=3"], "fix is no size"),
    ],
)
def test_bad_input(tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    Image.new("L", (3, 3), 0).save("dark.png")
    Image.new("L", (3, 3), 255).save("white.png")
    Path("text.png").write_text("not a picture")
    assert run(monkeypatch, *words, "-o", "out.json") == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
    assert not Path("out.json").exists()
