"""The Inkscape extension, run as Inkscape runs it: options and a drawing in, the drawing with an answer out."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

pytest.importorskip("inkex")

FOLDER = Path(__file__).parents[1] / "extras" / "inkscape"
SVG, INK = "{http://www.w3.org/2000/svg}", "{http://www.inkscape.org/namespaces/inkscape}"
# a peg of 10 x 10 mm in a slot that ends 5 mm to its right; user units of 0.5 mm, the page away from the origin
DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="50mm" height="30mm" viewBox="10 20 100 60">
<path id="frame" style="fill:red;fill-rule:evenodd" d="M20 30H100V70H20z M39.6 39.6V60.4H70.4V39.6z"/>
<path id="path17" inkscape:label="peg" style="fill:blue" d="M40 40H60V60H40z"/></svg>"""


def run(tmp_path: Path, *options: str, drawing: str = DRAWING) -> tuple[ET.Element | None, str]:
    """The document that comes back, and what is said."""
    path = tmp_path / "in.svg"
    path.write_text(drawing)
    program = f"{sys.executable} -c 'import sys; from wiggleroom.cli import main; sys.exit(main())'"
    done = subprocess.run(
        [sys.executable, str(FOLDER / "wiggleroom_ask.py"), f"--program={program}", *options, str(path)],
        capture_output=True, text=True, env=os.environ, timeout=120, check=False,
    )  # fmt: skip
    return (ET.fromstring(done.stdout) if done.stdout.strip() else None), done.stderr


def layers(root: ET.Element) -> list[ET.Element]:
    return [g for g in root.iter(f"{SVG}g") if g.get(f"{INK}label") == "wiggleroom"]


def test_the_moved_part_is_drawn_where_it_ends(tmp_path: Path) -> None:
    root, said = run(tmp_path, "--ask=flex", "--gap=0", "--towards=+x", "--id=path17")
    assert root is not None, said
    assert "it moves 5.2 mm" in said
    (layer,) = layers(root)
    boxes = []
    for path in layer.iter(f"{SVG}path"):
        xs = [float(x) for x in re.findall(r"(-?[\d.]+),-?[\d.]+", path.get("d", ""))]
        boxes.append((min(xs), max(xs)))
    assert boxes[0] == pytest.approx((20, 100), abs=1e-5)  # the frame stays
    assert boxes[1] == pytest.approx((50.4, 70.4), abs=1e-4)  # the peg against the end of its slot


def test_the_next_answer_replaces_the_layer_and_is_not_misled_by_it(tmp_path: Path) -> None:
    root, _ = run(tmp_path, "--ask=flex", "--gap=0", "--id=path17")
    assert root is not None
    with_answer = ET.tostring(root, encoding="unicode")
    again, said = run(tmp_path, "--ask=flex", "--gap=0", "--id=path17", "--towards=-x", drawing=with_answer)
    assert again is not None, said
    assert "it moves 0.2 mm" in said
    assert len(layers(again)) == 1


def test_other_questions(tmp_path: Path) -> None:
    _, said = run(tmp_path, "--ask=check", "--gap=0")
    assert "interlocked (proven)" in said
    _, said = run(tmp_path, "--ask=fits", "--number=0.3")
    assert "smallest gap 0.4 mm (proven)" in said  # 0.2 mm all round, 0.3 mm of both outlines


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--ask=flex"], "Select the part"),
        (["--ask=flex", "--id=path17", "--gap=100"], "vanishes"),
        (["--ask=check", "--program=no-such-program"], "Install it with pip"),
    ],
)
def test_what_goes_wrong_is_said(tmp_path: Path, options: list[str], words: str) -> None:
    _, said = run(tmp_path, *options)
    assert words in said
    assert "Traceback" not in said


def test_the_dialog_and_the_script_know_the_same_options() -> None:
    dialog = ET.parse(FOLDER / "wiggleroom_ask.inx").getroot()
    space = "{http://www.inkscape.org/namespace/inkscape/extension}"
    names = {p.get("name") for p in dialog.iter(f"{space}param")}
    script = set(re.findall(r'add_argument\("--(\w+)"', (FOLDER / "wiggleroom_ask.py").read_text()))
    assert names == script
