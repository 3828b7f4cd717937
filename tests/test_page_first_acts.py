"""From a drawing that nobody has prepared to a true answer: the acts of a new user, counted, for the exports of five programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.browser_page import serving, visiting
from tests.cut_drawings import rect, written
from tests.page_waits import until
from tests.test_drawing_units import ILLUSTRATOR, INKSCAPE

pytestmark = pytest.mark.slow

MOST = 6
"""Acts that a new user may need."""
BOXES = ((0.0, 0.0, 60.0), (20.0, 20.0, 20.0), (21.0, 21.0, 18.0))
"""A plate, the window in it, and a block of 18 mm in that window of 20 mm: it moves by 1 mm each way [mm: x, y, side]."""


def svg(root: str, unit: float, before: str = "", group: str = "<g>") -> str:
    """The boxes in units of so many a mm."""
    drawn = [
        f'<rect x="{x * unit:.4f}" y="{y * unit:.4f}" width="{a * unit:.4f}" height="{a * unit:.4f}"/>'
        for x, y, a in BOXES
    ]
    head = f'<?xml version="1.0"?>{before}<svg xmlns="http://www.w3.org/2000/svg" {root} fill="none" stroke="#000">'
    return f"{head}{group}{''.join(drawn)}</g></svg>"


def drawn_by(program: str, folder: Path) -> Path:
    if program in ("LibreCAD", "LightBurn"):
        path = folder / ("plate.dxf" if program == "LibreCAD" else "plate.lbrn2")
        return written([rect(x, y, a, a) for x, y, a in BOXES], path)
    layer = '<g inkscape:groupmode="layer" inkscape:label="Layer 1">'
    text = {
        "Inkscape": svg(f'{INKSCAPE.format("0.48.5 r10040")} width="400" height="300"', 90 / 25.4, group=layer),
        "Illustrator": svg('width="800px" height="600px" viewBox="0 0 800 600"', 72 / 25.4, ILLUSTRATOR),
        "CorelDRAW": svg('width="100%" height="100%" viewBox="0 0 40000 30000"', 100, "<!-- Creator: CorelDRAW X7 -->"),
    }[program]
    path = folder / "plate.svg"
    path.write_text(text)
    return path


@pytest.mark.parametrize("program", ["Inkscape", "Illustrator", "CorelDRAW", "LibreCAD", "LightBurn"])
def test_an_unknown_drawing_leads_to_a_true_answer(browser: Any, tmp_path: Path, program: str) -> None:
    path, acts = drawn_by(program, tmp_path), ["open"]
    with serving(None) as served, visiting(browser, served) as page:
        page.set_input_files("#file", str(path))
        page.locator(".filename", has_text=path.name).wait_for()
        answer, proposed = page.locator("#answer[data-settled=true]"), page.locator(".findings .button.main")
        while True:
            until(page, lambda: answer.count() > 0 or proposed.count() > 0, f"nothing to go on after {acts}")
            if answer.count():
                break
            words = proposed.first.inner_text()
            proposed.first.click()
            acts.append(words)
            until(page, lambda: words not in proposed.all_inner_texts(), f"{words} does nothing")  # noqa: B023
        assert "moves 1 mm in" in answer.inner_text()
        assert len(acts) <= MOST, acts
