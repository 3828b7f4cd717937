"""Lengths of drawings as the programs that wrote them meant them."""

from __future__ import annotations

import io
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.assembly.build import doubts
from wiggleroom.drawing import read_drawing
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.drawing.readers.svg import read_svg
from wiggleroom.errors import InputError

INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:version="{}"'
ILLUSTRATOR = "<!-- Generator: Adobe Illustrator 16.0.0, SVG Export Plug-In . SVG Version: 6.00 Build 0)  -->"


def svg(root: str, size: float, before: str = "", inside: str = "") -> str:
    """A square of `size` user units."""
    square = f'<rect id="a" x="1" y="1" width="{size}" height="{size}" fill="none" stroke="black"/>'
    return f'<?xml version="1.0"?>{before}<svg xmlns="http://www.w3.org/2000/svg" {root}>{inside}{square}</svg>'


def width(drawing: object) -> float:
    """Of the first part [mm]."""
    return float(np.ptp(drawing.parts[0].regions[0].outer[:, 0]))


FIFTY = {  # a square of 50 mm as each program writes it
    "old Inkscape": svg(f'{INKSCAPE.format("0.48.5 r10040")} width="744.09448819" height="1052.3622047"', 50 * 90 / 25.4),
    "old Inkscape, page in mm": svg(f'{INKSCAPE.format("0.91 r13725")} width="210mm" height="297mm"', 50 * 90 / 25.4),
    "Inkscape with viewBox": svg(
        f'{INKSCAPE.format("0.48")} width="210mm" height="297mm" viewBox="0 0 744.09448 1052.3622"', 50 * 90 / 25.4
    ),
    "new Inkscape in mm": svg(f'{INKSCAPE.format("1.2.1")} width="210mm" height="297mm" viewBox="0 0 210 297"', 50.0),
    "Illustrator": svg('width="800px" height="600px" viewBox="0 0 800 600"', 50 * 72 / 25.4, ILLUSTRATOR),
    "Illustrator for screens": svg('id="Layer_1" data-name="Layer 1" viewBox="0 0 800 600"', 50 * 72 / 25.4),
    "CorelDRAW": svg('width="100%" height="100%" viewBox="0 0 40000 30000"', 5000.0, "<!-- Creator: CorelDRAW X7 -->"),
    "CorelDRAW in inches": svg('width="8.5in" height="11in" viewBox="0 0 8500 11000"', 50 / 0.0254, "<!-- Creator: CorelDRAW -->"),
    "OpenSCAD": svg('width="100" height="100" viewBox="0 0 100 100"', 50.0, inside="<title>OpenSCAD Model</title>"),
    "a page of A4 in points": svg('viewBox="0 0 595.28 841.89"', 50 * 72 / 25.4),
    "a page of Letter in pixels": svg('width="1056" height="816"', 50 * 96 / 25.4),
    "nothing known": svg('width="100" height="100"', 50.0),
}  # fmt: skip


@pytest.mark.parametrize("program", FIFTY)
def test_a_square_of_50_mm_is_as_large_in_every_program(program: str) -> None:
    """Physical size with a viewBox goes before the program, the program before one unit = 1 mm."""
    drawing = read_svg(FIFTY[program])
    assert width(drawing) == pytest.approx(50.0, rel=1e-4)
    says_itself = program in ("Inkscape with viewBox", "new Inkscape in mm", "CorelDRAW in inches")
    assert any("--dpi" in note for note in drawing.notes) != says_itself


@pytest.mark.parametrize(
    ("said", "expected"), [({"unit": "pt"}, 25.4), ({"dpi": 90.0}, 72 * 25.4 / 90), ({"dpi": 72}, 25.4)]
)
def test_what_is_said_goes_before_the_file(tmp_path: Path, said: dict, expected: float) -> None:
    path = tmp_path / "a.svg"
    path.write_text(svg(f'{INKSCAPE.format("0.48")} width="300mm" height="300mm" viewBox="0 0 300 300"', 72.0))
    assembly = wr.read(path, **said)
    assert width(assembly.drawing) == pytest.approx(expected)
    assert not any("--dpi" in note for note in assembly.drawing.notes)


@pytest.mark.parametrize(
    ("said", "words"), [({"dpi": 0.0}, "dpi is 0"), ({"dpi": 90.0, "unit": "pt"}, "leave one of them out")]
)
def test_a_resolution_that_makes_no_sense_is_refused(tmp_path: Path, said: dict, words: str) -> None:
    path = tmp_path / "a.svg"
    path.write_text(svg('viewBox="0 0 100 100"', 50.0))
    with pytest.raises(InputError, match=words):
        wr.read(path, **said)


@pytest.mark.parametrize(
    ("measurement", "sizes", "mm"),
    [(0, (10.0, 1.5, 0.5), 254.0), (0, (30.0, 1.0, 0.25), 762.0), (0, (300.0, 40.0, 3.0), 300.0), (1, (10.0, 1.5, 0.5), 10.0)],
)  # fmt: skip
def test_a_dxf_without_unit(tmp_path: Path, measurement: int, sizes: tuple[float, ...], mm: float) -> None:
    """Imperial and small numbers are inches, the rest millimetres; a note says so."""
    document = ezdxf.new("R2000")
    document.header["$MEASUREMENT"] = measurement
    document.header["$INSUNITS"] = 0
    for k, size in enumerate(sizes):
        x = 400.0 * k if k else 0.0
        x = min(x, sizes[0] / 4 * k)
        document.modelspace().add_lwpolyline([(x, 0), (x + size, 0), (x + size, size), (x, size)], close=True)
    stream = io.StringIO()
    document.write(stream)
    path = tmp_path / "a.dxf"
    path.write_text(stream.getvalue())
    drawing = read_drawing(path)
    assert max(
        width_of for part in drawing.parts for width_of in np.ptp(part.regions[0].outer, axis=0)
    ) == pytest.approx(mm)
    assert any("says no unit" in note and "--unit" in note for note in drawing.notes)


@pytest.mark.parametrize(("width", "doubted"), [(4.3, True), (43.0, False), (6000.0, True)])
def test_a_size_that_is_hardly_meant(width: float, doubted: bool) -> None:
    square = Region(np.array([[0.0, 0.0], [width, 0.0], [width, width], [0.0, width]]))
    said = doubts(Drawing((Part("a", (square,)),)))
    assert any("is its unit right" in line for line in said) == doubted
