"""What is said about a drawing with curves at a gap does not depend on which question, or which other gap, came first."""

from __future__ import annotations

import math
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble

SIDE = 40.0


def knob(folder: Path, radius: float, neck: float, curve: str = "arc") -> Path:
    """Two blocks, one with a round knob in the other; `neck` is half the width of the opening [mm]."""
    rise = math.sqrt(radius**2 - neck**2)
    left, right, top, low = 20 - neck, 20 + neck, 20.0, 20 + rise + radius
    if curve == "arc":
        socket, back = f"A{radius} {radius} 0 1 0 {right} {top}", f"A{radius} {radius} 0 1 1 {left} {top}"
    else:  # one cubic on either side, as wide and as deep
        wide = 4 * radius / 3 + neck / 3
        a, b = (20 - wide, top + 0.7 * radius), (20 - wide, low)
        c, d = (20 + wide, low), (20 + wide, top + 0.7 * radius)
        socket = f"C{a[0]} {a[1]} {b[0]} {b[1]} 20 {low}C{c[0]} {c[1]} {d[0]} {d[1]} {right} {top}"
        back = f"C{d[0]} {d[1]} {c[0]} {c[1]} 20 {low}C{b[0]} {b[1]} {a[0]} {a[1]} {left} {top}"
    below = f"M0 20H{left}{socket}H{SIDE}V40H0Z"
    above = f"M0 0H{SIDE}V20H{right}{back}H0Z"
    file = folder / f"knob_{curve}.svg"
    file.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">'
        f'<path id="below" d="{below}"/><path id="above" d="{above}"/></svg>'
    )
    return file


def disc_in_a_claw(folder: Path, radius: float, mouth: float) -> Path:
    """A disc drawn as a circle in a claw drawn as an arc: their corners do not meet; `mouth` is half its width [mm]."""
    rise = math.sqrt(radius**2 - mouth**2)
    path = f"M0 {20 - rise}H{20 - mouth}A{radius} {radius} 0 1 0 {20 + mouth} {20 - rise}H40V40H0Z"
    file = folder / "claw.svg"
    file.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">'
        f'<path id="claw" d="{path}" fill="red"/><circle id="disc" cx="20" cy="20" r="{radius}"/></svg>'
    )
    return file


def bulges(folder: Path) -> Path:
    """A slot and what lies in it, as polylines with arcs and a circle, in DXF."""
    document = ezdxf.new()
    document.units = ezdxf.units.MM
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True)
    space.add_lwpolyline([(15, 10, 0), (45, 10, 1), (45, 30, 0), (15, 30, 1)], format="xyb", close=True)
    space.add_circle((30, 20), 7)
    file = folder / "slot.dxf"
    document.saveas(file)
    return file


def outlines(assembly: Assembly) -> list[np.ndarray]:
    return [ring for part in assembly.parts for region in part.regions for ring in (region.outer, *region.holes)]


@pytest.mark.parametrize("first", [0.0, 1.2])
@pytest.mark.parametrize("make", [lambda f: knob(f, 6, 4), lambda f: knob(f, 6, 4, "cubic"), bulges])
def test_a_gap_has_the_same_outlines_whichever_came_first(make, first: float, tmp_path: Path) -> None:
    file = make(tmp_path)
    begun = wr.read(file, gap=first, fix=[wr.read(file).names[0]])
    for gap in (0.0, 0.17, 0.8):
        made, read = assemble(begun.drawing, gap=gap), wr.read(file, gap=gap)
        assert made.names == read.names
        assert made.parts[0].fixed
        assert np.array_equal(made.rest, read.rest)
        assert all(np.array_equal(a, b) for a, b in zip(outlines(made), outlines(read), strict=True))


def test_no_curve_strays_further_than_a_fiftieth_of_the_gap(tmp_path: Path) -> None:
    file = disc_in_a_claw(tmp_path, 8, 6)
    for gap in (0.01, 0.1, 0.3, 1.0, 4.0):
        disc = wr.read(file, gap=gap).drawing.parts[1].regions[0].outer
        nearest = shapely.distance(shapely.LinearRing(disc), shapely.Point(0, 0))
        assert 8 - gap / 50 - 1e-9 <= nearest <= 8


def test_edges_that_were_asked_for_stay(tmp_path: Path) -> None:
    begun = wr.read(knob(tmp_path, 6, 4), gap=0.1, flatten=0.05)
    fine, coarse = assemble(begun.drawing, gap=0.01), assemble(begun.drawing, gap=1.0)
    assert len(outlines(fine)[0]) == len(outlines(coarse)[0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drawing", "curve", "begin"),
    [
        ((6, 4.5), "arc", 0.1),
    ],
)
def test_check_says_what_the_largest_gap_says(
    drawing: tuple[float, float], curve: str, begin: float, tmp_path: Path
) -> None:
    file = knob(tmp_path, *drawing, curve)
    border = wr.largest_gap(wr.read(file, gap=begin))
    assert border.holds is not None
    assert border.parts_at is not None
    assert border.holds < border.parts_at < 1.05 * border.holds
    for gap in (border.holds, 0.97 * border.holds):
        assert str(wr.check(wr.read(file, gap=gap)).verdict) == "interlocked"
    for gap in (border.parts_at, 1.03 * border.parts_at):
        assert str(wr.check(wr.read(file, gap=gap)).verdict) == "comes apart"
    if curve == "arc":  # the knob comes out where its circle is as wide as the opening between the mitred corners
        radius, neck = drawing
        rise = math.sqrt(radius**2 - neck**2)
        truth = 2 * (rise + 2 * radius - math.sqrt((rise + 2 * radius) ** 2 - rise**2))
        assert border.holds == pytest.approx(truth, rel=0.05)


def test_a_sweep_gives_every_gap_the_value_that_flex_gives_it(tmp_path: Path) -> None:
    file = knob(tmp_path, 6, 4.5)
    pull = wr.Turn("above")
    swept = wr.sweep(wr.read(file, gap=0.1, fix=["below"]), [0.05, 0.11, 0.3, 0.8], pull)
    for step in swept.steps:
        alone = wr.flex(wr.read(file, gap=step.gap, fix=["below"]), pull, search=0)
        assert step.objective == pytest.approx(alone.objective, rel=1e-5)
