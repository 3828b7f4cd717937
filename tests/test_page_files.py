"""What the page takes from files and what it saves: reports, outlines to cut, files that change; in a real browser."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wiggleroom as wr
from tests.app_client import TOKEN, Served
from tests.browser_page import PEG, accessible, answered, following, serving, visiting, without
from tests.page_waits import until

pytestmark = pytest.mark.slow


def saved(page: Any, words: str) -> Path:
    """What is saved under an entry of the menu."""
    page.get_by_role("button", name="Save", exact=True).click()
    with page.expect_download() as coming:
        page.get_by_role("menuitem", name=words).click()
    return Path(coming.value.path())


def test_what_is_saved_before_the_search_has_ended_says_that_it_may_find_more(
    browser: Any, peg: Served, opened: Any
) -> None:
    with visiting(browser, peg) as page:
        without(page, "bound")  # the search in idle time
        page.goto(f"http://127.0.0.1:{peg.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm")
        report, picture = (saved(page, words).read_text() for words in ("Report html", "Picture svg"))
    assert "found so far" in picture
    assert "optimal" not in picture
    opened(report).locator(".headline .facts", has_text="found so far").wait_for()
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".headline .facts", has_text="optimal").wait_for()
        report = saved(page, "Report html").read_text()
    facts = opened(report).locator(".headline .facts")
    facts.filter(has_text="gap 1 mm").wait_for()
    assert facts.inner_text().split()[0] in ("optimal", "proven")


SHEET = """<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="40mm" viewBox="0 0 160 80">
<g id="cut" fill="none" stroke="red"><rect id="frame" x="10" y="10" width="60" height="60"/>
<rect id="window" x="20" y="20" width="40" height="40"/></g>
<g id="engrave" stroke="blue"><path fill="none" d="M100 10c5 5 10 5 20 0"/><text x="100" y="40">Gr\u00fc\u00dfe</text></g>
</svg>
"""


def test_outlines_to_cut_go_into_the_file_that_was_opened(browser: Any, tmp_path: Path) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.set_input_files("#file", {"name": "sheet.svg", "mimeType": "image/svg+xml", "buffer": SHEET.encode()})
        page.locator(".filename", has_text="sheet.svg").wait_for()
        page.get_by_label("gap, mm", exact=True).fill("0.4")
        page.get_by_label("gap, mm", exact=True).press("Enter")
        page.get_by_role("button", name="Save", exact=True).click()
        page.get_by_label("kerf of the cut, mm").fill("0.1")
        page.get_by_label("kerf of the cut, mm").press("Enter")
        accessible(page)
        with page.expect_download() as coming:
            page.get_by_role("menuitem", name="Outlines to cut, in your file svg").click()
        coming.value.save_as(tmp_path / "cut.svg")
        page.get_by_role("button", name="Save", exact=True).click()
        page.get_by_role("menuitem", name="Outlines to cut, alone dxf").wait_for()
    text = (tmp_path / "cut.svg").read_text(encoding="utf-8")
    moved = r'<(?:rect|path) id="(frame|window)"[^>]*>'
    assert re.sub(moved, r"\1", text).startswith(re.sub(moved, r"\1", SHEET).rstrip())
    outer, hole = (np.ptp(ring, axis=0) for ring in rings(tmp_path / "cut.svg"))
    assert outer == pytest.approx([29.7, 29.7])  # 30 mm, less the gap, and the kerf given back
    assert hole == pytest.approx([20.3, 20.3])


def rings(path: Path) -> Any:
    """Outer outline and hole of the only part of a drawing [mm]."""
    region = wr.read(str(path)).parts[0].regions[0]
    return region.outer, *region.holes


def test_a_file_that_changes_on_disk_is_read_again_and_the_question_stays(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "peg.json"
    path.write_text(json.dumps(PEG))
    with following(path) as served, visiting(browser, served) as page:
        answered(page, "peg moves 1 mm")
        gap = page.get_by_label("gap, mm", exact=True)
        gap.fill("2")
        gap.press("Enter")
        answered(page, "peg moves 2 mm")
        wider = json.loads(json.dumps(PEG).replace("[20, ", "[23, "))  # the hole is 3 mm wider to the right
        path.write_text(json.dumps(wider | {"pull": [{"part": "peg", "direction": [-1, 0]}]}))
        answered(page, "peg moves 2 mm in -x")  # the gap was set here, the pull stands in the file
        page.locator(".notices", has_text="has changed on disk and was read again").wait_for()
        page.get_by_label("direction of the pull on peg, °").fill("0")
        page.get_by_label("direction of the pull on peg, °").press("Enter")
        answered(page, "peg moves 5 mm in +x")
        for _ in range(2):
            page.keyboard.press("Control+z")
        answered(page, "peg moves 4 mm in +x")
        path.write_text("{")
        page.get_by_label("what could not be opened").filter(has_text="peg.json").wait_for()
        assert page.locator("#answer").inner_text().startswith("peg moves 4 mm")
        other = json.dumps(PEG | {"gap": 3}).replace('"peg"', '"pin"')
        path.write_text(other)
        answered(page, "pin moves")
        until(page, lambda: page.get_by_label("what could not be opened").count() == 0, "it says still that it fails")
        page.set_input_files("#file", {"name": "sheet.svg", "mimeType": "image/svg+xml", "buffer": SHEET.encode()})
        page.locator(".filename", has_text="sheet.svg").wait_for()
        path.write_text(json.dumps(PEG))
        page.wait_for_timeout(1500)  # twice as long as between two looks
        assert page.locator(".filename").inner_text() == "sheet.svg"  # another file is open now
