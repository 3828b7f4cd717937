"""Coupons: the fit of every pocket is the gap that is engraved on it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.test_svg_reader import material
from wiggleroom.assembly import coupon
from wiggleroom.assembly.joints import JOINTS
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.errors import InputError

GAPS = (-0.2, -0.1, 0.0, 0.1, 0.25)


def shapes(sheet: coupon.Coupon) -> dict[str, shapely.Polygon]:
    return {part.name: material(part) for part in sheet.drawing.parts}


@pytest.mark.parametrize("joint", sorted(set(JOINTS) - {"t"}))
def test_the_key_has_the_clearance_of_each_pocket(joint):
    """Put into the pocket, the tab is as far from its walls, or as deep in them, as the label says."""
    pitch = 24.0
    sheet = coupon.comb(joint, GAPS, pitch=pitch)
    found = shapes(sheet)
    rim = found["comb"].bounds[3]
    for i, gap in enumerate(GAPS):
        # the tab hangs from y = 0, the rim lies below it by the widest gap
        lowest = found["key"].bounds[1]
        tab = JOINTS[joint]().profile()[:, 1].min() * pitch
        inserted = shapely.affinity.translate(found["key"], i * pitch, tab - lowest)
        below = shapely.intersection(inserted, shapely.box(-1e3, -1e3, 1e3, rim - 0.3))
        if gap >= 0:
            walls = shapely.intersection(
                found["comb"], shapely.box((i - 0.5) * pitch, -99, (i + 0.5) * pitch, rim - 0.3)
            )
            assert shapely.distance(below, walls) == pytest.approx(gap, abs=1e-9)
        else:
            shrunk = [shapely.buffer(below, gap * k, join_style="mitre", mitre_limit=9) for k in (1.0001, 0.95)]
            assert shrunk[0].intersection(found["comb"]).area == pytest.approx(0, abs=1e-9)
            assert shrunk[1].intersection(found["comb"]).area > 0


@pytest.mark.parametrize("extension", ["svg", "dxf", "json"])
def test_a_comb_comes_back_from_every_format(tmp_path, extension):
    if extension == "dxf":
        pytest.importorskip("ezdxf")
    sheet = coupon.comb("dovetail", GAPS)
    write_drawing(sheet.drawing, tmp_path / f"x.{extension}", labels=sheet.labels)
    again = read_drawing(tmp_path / f"x.{extension}")
    assert not again.notes
    assert [part.name for part in again.parts] == ["comb", "key"]
    for a, b in zip(sheet.drawing.parts, again.parts, strict=True):
        assert material(a).area == pytest.approx(material(b).area, abs=1e-6)


def own_joint() -> Drawing:
    """A long plate with a slot and a tongue in it, drawn touching."""
    slot = np.array([[0.0, 0], [200, 0], [200, 60], [110, 60], [110, 40], [90, 40], [90, 60], [0, 60]])
    tongue = np.array([[90.0, 40], [110, 40], [110, 140], [90, 140]])
    return Drawing(
        (Part("plate", (Region(slot),)), Part("tongue", (Region(tongue),)), Part("far", (Region(slot + 500),)))
    )


def test_a_joint_of_ones_own():
    sheet = coupon.row(own_joint(), "plate", "tongue", GAPS)
    found = shapes(sheet)
    assert list(found) == ["-0.20", "-0.10", "0.00", "0.10", "0.25", "tongue"]
    key = found["tongue"]
    assert key.bounds[2] - key.bounds[0] == pytest.approx(20)
    for name, gap in zip(list(found)[:-1], GAPS, strict=True):
        piece = found[name]
        left, _, right, top = piece.bounds
        level = shapely.intersection(piece, shapely.LineString([(left, top - 5), (right, top - 5)]))
        a, b = sorted(shapely.get_parts(level), key=lambda part: part.bounds[0])
        assert b.bounds[0] - a.bounds[2] == pytest.approx(20 + 2 * gap, abs=1e-9)
        assert right - left < 60  # cut down to the joint
    tree = shapely.STRtree(list(found.values()))
    assert tree.query(list(found.values()), predicate="intersects").shape[1] == len(found)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: coupon.gap_steps(0, 1, 0), "in steps of 0"),
        (lambda: coupon.gap_steps(1, 0, 0.1), "a start below the stop"),
        (lambda: coupon.gap_steps(0, float("nan"), 0.1), "nan"),
        (lambda: coupon.gap_steps(0, 1, 1e-6), "take at most"),
        (lambda: coupon.comb("glue", GAPS), 'no joint "glue"'),
        (lambda: coupon.comb("tee", GAPS, pitch=-1), "pitch is -1"),
        (lambda: coupon.comb("tee", [50.0]), "cut the comb to pieces"),
        (lambda: coupon.comb("tee", [-50.0]), "vanishes"),
        (lambda: coupon.comb("tee", [-2.0]), "nothing is left of a pocket"),
        (lambda: coupon.row(own_joint(), "plate", "nose", GAPS), 'no part "nose"'),
        (lambda: coupon.row(own_joint(), "plate", "plate", GAPS), "named twice"),
        (lambda: coupon.row(own_joint(), "plate", "tongue", [90.0]), "vanishes"),
    ],
)
def test_what_cannot_be_made(make, said):
    with pytest.raises(InputError) as caught:
        make()
    assert said in caught.value.findings[0]
    assert all("\n" not in line for line in caught.value.findings)


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--joint", "finger", "-o", "x.dxf"], 0, "13 gaps from -0.30 to 0.30 mm and a key: x.dxf"),
        (["DRAWER", "--start", "0", "--stop", "0.2", "--step", "0.1", "-o", "x.svg"], 0, "3 gaps from 0.0 to 0.2 mm"),
        (["DRAWER", "--joint", "tee", "-o", "x.svg"], 2, "not both"),
        (["DRAWER", "frame", "-o", "x.svg"], 2, "name the two parts"),
        (["--unit", "in", "-o", "x.svg"], 2, "go with a file"),
        (["-o", "x.png"], 2, "must end in .svg, .dxf or .json"),
        (["--step", "0", "-o", "x.svg"], 2, "in steps of 0"),
        (["nowhere.svg", "-o", "x.svg"], 2, "no such file"),
    ],
)
def test_command(tmp_path, arguments, code, said):
    drawer = str(Path(__file__).parents[1] / "examples/10_drawer/drawer.svg")
    words = [drawer if word == "DRAWER" else word for word in arguments]
    command = [sys.executable, "-c", "import sys; from wiggleroom.cli import main; sys.exit(main())", "coupon", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == code
    assert said in done.stderr.splitlines()[-1]
    assert not done.stdout
    assert (code == 0) == any(tmp_path.iterdir())
