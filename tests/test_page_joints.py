"""The gap of one joint on the page: chosen by a row, by a mark in the picture or by its two parts; in a real browser."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import wiggleroom as wr
from tests.app_client import Served
from tests.browser_page import accessible, answered, canvas, pixels_per_mm, serving, still, visiting
from tests.page_waits import until

pytestmark = pytest.mark.slow

BOLT = {
    "format": "wiggleroom/1",
    "gap": 1,
    "parts": [
        {
            "name": "left",
            "outline": [[0, 0], [20, 0], [20, 5], [10, 5], [10, 15], [20, 15], [20, 20], [0, 20]],
            "fixed": True,
        },
        {"name": "bolt", "outline": [[-5, -5], [5, -5], [5, 5], [-5, 5]], "at": [15, 10, 0]},
        {"name": "right", "outline": [[20, 0], [30, 0], [30, 20], [20, 20]], "fixed": True},
        {"name": "far", "outline": [[50, 50], [60, 50], [60, 60]], "fixed": True},
    ],
    "pull": [{"part": "bolt", "direction": [1, 0]}],
}
"""A bolt in a pocket, and the wall that stops it: it has the gap of that joint."""


def kept(page: Any) -> dict[str, Any]:
    """What is set now."""
    found: dict[str, Any] = json.loads(page.evaluate("sessionStorage.getItem('wiggleroom.design')"))["design"]
    return found


def test_a_joint_that_is_pressed_in_the_list_has_a_gap_of_its_own(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "bolt.json").write_text(json.dumps(BOLT))
    with serving(tmp_path / "bolt.json") as served, visiting(browser, served) as page:
        answered(page, "bolt moves 1 mm")
        page.locator("table").get_by_role("button", name=re.compile("bolt . right|right . bolt")).first.click()
        box = page.get_by_label(re.compile("^gap between .*, mm$"))
        until(page, lambda: box.input_value() == "1", "the gap of all joints is not shown")
        box.fill("3")
        box.press("Enter")
        answered(page, "bolt moves 3 mm")
        assert [[*sorted(pair), gap] for *pair, gap in kept(page)["gaps"]] == [["bolt", "right", 3]]
        accessible(page)
        said = page.locator("code.command, .command").first.inner_text()
        assert re.search(r"--gap-of (bolt,right|right,bolt):3\b", said)
        page.get_by_label("gap, mm", exact=True).fill("0.5")  # the gap of all others
        page.get_by_label("gap, mm", exact=True).press("Enter")
        answered(page, "bolt moves 3 mm")
        page.keyboard.press("Control+z")
        page.keyboard.press("Control+z")
        answered(page, "bolt moves 1 mm")
        assert not kept(page)["gaps"]
        page.keyboard.press("Control+y")
        answered(page, "bolt moves 3 mm")
        page.get_by_role("tab", name="Answer").click()
        page.get_by_label("gaps of single joints").get_by_role("button").click()
        answered(page, "bolt moves 1 mm")


def test_a_contact_that_is_pressed_in_the_picture_chooses_its_joint(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        x, y = still(page)  # the reference point of the peg, moved to (16, 15)
        row = page.locator("table.sorts tbody tr").first.locator("td").all_inner_texts()
        box = canvas(page)
        at = box["x"] + x + (float(row[1]) - 16) * scale, box["y"] + y - (float(row[2]) - 15) * scale
        page.mouse.click(*at)
        slider = page.get_by_role("slider", name=re.compile("^gap between"))
        slider.focus()
        page.keyboard.press("ArrowRight")
        until(page, lambda: len(kept(page).get("gaps", [])) == 1, "no gap of its own")
        gap = kept(page)["gaps"][0][2]
        assert gap > 1
        answered(page, f"peg moves {gap:g} mm")
        page.get_by_role("button", name=re.compile("the gap of all others")).first.click()
        answered(page, "peg moves 1 mm")
        page.get_by_role("tab", name="Gaps").click()
        page.get_by_role("button", name="Rank", exact=True).click()
        worth = page.get_by_title("what this joint's gap is worth to the answer").inner_text()
        assert worth.endswith(" mm per mm of gap")
        assert float(worth.split()[0]) == pytest.approx(1, abs=1e-3)


def test_the_gap_of_a_joint_is_saved_with_the_assembly_and_said_where_parts_do_not_meet(
    browser: Any, tmp_path: Path
) -> None:
    own = BOLT | {"gaps": [{"parts": ["bolt", "right"], "gap": 2}]}
    (tmp_path / "bolt.json").write_text(json.dumps(own))
    with serving(tmp_path / "bolt.json") as served, visiting(browser, served) as page:
        answered(page, "bolt moves 2 mm")
        page.get_by_role("tab", name="Gaps").click()
        for name in ("far", "right"):
            page.get_by_label(f"choose {name} too").check()
        box = page.get_by_label(re.compile("^gap between (far and right|right and far), mm"))
        box.fill("2")
        box.press("Enter")
        page.locator(".findings", has_text="face each other nowhere").wait_for()
        page.keyboard.press("Control+z")
        answered(page, "bolt moves 2 mm")
        page.locator(".savebutton").click()
        with page.expect_download() as coming:
            page.get_by_role("menuitem", name="Assembly file json").click()
        coming.value.save_as(tmp_path / "saved.json")
    assert wr.flex(wr.read(str(tmp_path / "saved.json"))).objective == pytest.approx(2)
