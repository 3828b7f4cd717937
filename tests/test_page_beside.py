"""Two answers side by side: of one design before and after, or of two files; in a real browser."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.app_client import Served
from tests.browser_page import PEG, accessible, answered, serving, visiting
from tests.page_waits import settled, until

pytestmark = pytest.mark.slow


def dropped(page: Any, name: str, text: str) -> None:
    page.set_input_files("#file", {"name": name, "mimeType": "application/json", "buffer": text.encode()})
    page.locator(".filename", has_text=name).wait_for()


def kept_view(page: Any) -> list[float]:
    """Middle and scale of the kept picture."""
    return json.loads(page.locator(".beside canvas").get_attribute("data-view"))


def view(page: Any) -> list[float]:
    return json.loads(page.locator(".stage canvas").get_attribute("data-view"))


def differing(page: Any) -> dict[str, list[str]]:
    """What is said to differ beside the kept answer: there and here."""
    rows = page.locator(".beside .difference tbody tr").all()
    return {row.get_by_role("rowheader").inner_text(): row.get_by_role("cell").all_inner_texts() for row in rows}


def test_two_designs_stand_side_by_side(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.get_by_role("button", name="Keep this answer beside, to compare").click()
        page.locator(".gapbox").get_by_role("textbox").fill("2")
        page.keyboard.press("Enter")
        answered(page, "peg moves 2 mm")
        beside = page.locator(".beside")
        assert "kept: peg moves 1 mm" in beside.inner_text()
        assert differing(page) == {"gap": ["1 mm", "2 mm"], "motion": ["1", "2 (× 2)"]}
        left, right = beside.locator(".pane").bounding_box(), page.locator(".stage").bounding_box()
        label = beside.locator(".label").bounding_box()
        assert left
        assert right
        assert label["y"] + label["height"] <= left["y"] + 1
        assert left["x"] + left["width"] <= right["x"] + 1
        assert left["height"] == right["height"]
        beside.get_by_role("button", name="Swap").click()
        answered(page, "peg moves 1 mm")
        assert "kept: peg moves 2 mm" in beside.inner_text()
        beside.get_by_role("button", name="Keep nothing beside").click()
        beside.wait_for(state="detached")


def test_two_files_stand_side_by_side(browser: Any, peg: Served) -> None:
    wide = json.loads(json.dumps(PEG))
    wide["parts"][0]["outline"] = [[0, 0], [90, 0], [90, 30], [0, 30]]
    wide["parts"][0]["holes"] = [[[10, 10], [30, 10], [30, 20], [10, 20]]]
    wide["gap"] = 0.5
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.keyboard.press("b")
        page.locator(".notices", has_text="Kept beside").wait_for()
        dropped(page, "wide.json", json.dumps(wide))
        answered(page, "peg moves 10.5 mm")
        beside = page.locator(".beside")
        assert "kept: peg moves 1 mm" in beside.inner_text()
        until(page, lambda: differing(page).get("gap") == ["1 mm", "0.5 mm"], "what differs is not said")
        assert differing(page)["file"] == ["peg.json", "wide.json"]
        assert differing(page)["motion"] == ["1", "10.5 (× 10.5)"]
        accessible(page)
        # each fills its own picture, until both are moved together
        until(page, lambda: kept_view(page)[2] > 1.5 * view(page)[2], "the kept file is not fitted")
        pane = page.locator(".beside canvas").bounding_box()
        before, other = kept_view(page), view(page)
        page.mouse.move(pane["x"] + 50, pane["y"] + 50)
        page.mouse.wheel(0, -300)
        until(page, lambda: kept_view(page)[2] > 1.2 * before[2], "the kept picture does not zoom")
        assert view(page) == other
        beside.get_by_role("button", name="Linked").click()
        until(page, lambda: kept_view(page)[2] == view(page)[2], "the pictures have two scales")
        page.mouse.move(pane["x"] + 50, pane["y"] + 50)
        page.mouse.wheel(0, -300)
        until(page, lambda: view(page)[2] > 1.2 * other[2], "the live picture is not moved with it")
        until(page, lambda: kept_view(page)[2] == view(page)[2], "the pictures have two scales")
        beside.get_by_role("button", name="Ask the same").click()
        answered(page, "peg moves 11 mm")
        until(page, lambda: set(differing(page)) == {"file", "motion"}, "the same is not asked")
        page.keyboard.press("Control+z")
        answered(page, "peg moves 10.5 mm")


def test_a_swap_goes_to_the_other_file_and_its_design(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".gapbox").get_by_role("textbox").fill("2")
        page.keyboard.press("Enter")
        answered(page, "peg moves 2 mm")
        page.get_by_role("button", name="Keep this answer beside, to compare").click()
        dropped(page, "two.json", json.dumps(PEG | {"gap": 4}))
        answered(page, "peg moves 4 mm")
        for name, moves, other in (("peg.json", 2, 4), ("two.json", 4, 2), ("peg.json", 2, 4)):
            page.locator(".beside").get_by_role("button", name="Swap").click()
            page.locator(".filename", has_text=name).wait_for()
            answered(page, f"peg moves {moves} mm")
            page.locator(".beside", has_text=f"kept: peg moves {other} mm").wait_for()
        page.get_by_role("button", name="Undo").click()
        answered(page, "peg moves 1 mm")


def test_the_file_of_the_command_is_one_press_away(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        dropped(page, "two.json", json.dumps(PEG | {"gap": 4}))
        answered(page, "peg moves 4 mm")
        page.reload()
        answered(page, "peg moves 4 mm")
        page.get_by_role("button", name="wiggleroom: samples and files opened before").click()
        page.get_by_role("button", name="peg.json, the file of the command").click()
        answered(page, "peg moves 1 mm")
        page.reload()
        answered(page, "peg moves 1 mm")


def together(page: Any) -> None:
    """Both pictures are turned by either, until each is moved alone."""

    def eyes() -> list[list[float]]:
        canvases = [page.locator(one) for one in (live, ".beside canvas")]
        found: list[list[float]] = settled(
            page, lambda: [np.round(json.loads(e.get_attribute("data-eye")), 3).tolist() for e in canvases]
        )
        return found

    live = ".stage:not(.pane) canvas"
    page.locator(live).focus()
    page.keyboard.press("ArrowRight")
    first, second = eyes()
    assert first == second
    box = page.locator(".beside canvas").bounding_box()
    page.mouse.move(box["x"] + 30, box["y"] + box["height"] - 30)
    page.mouse.down()
    page.mouse.move(box["x"] + 90, box["y"] + box["height"] - 50, steps=4)
    page.mouse.up()
    turned, second = eyes()
    assert turned == second != first
    page.locator(".beside").get_by_role("button", name="Linked").click()
    page.locator(live).focus()
    page.keyboard.press("ArrowLeft")
    alone, second = eyes()
    assert alone != second == turned


def test_an_answer_in_space_is_kept_beside_another_file(browser: Any, tmp_path: Path) -> None:
    stop = {
        "format": "wiggleroom/2",
        "parts": [
            {"name": "floor", "boxes": [[0, 0, 0, 40, 9, 1]], "fixed": True},
            {"name": "wall", "boxes": [[0, 0, 0, 2, 9, 9]], "at": [30, 0, 1], "fixed": True},
            {"name": "block", "boxes": [[0, 0, 0, 4, 4, 4]], "at": [4, 2, 1.5]},
        ],
        "pull": [{"part": "block", "direction": [1, 0, 0]}],
    }
    path = tmp_path / "stop.json"
    path.write_text(json.dumps(stop))
    with serving(path) as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        page.keyboard.press("b")
        page.locator(".beside .stage.solid canvas").wait_for()
        together(page)
        stop["parts"][1]["at"] = [20, 0, 1]
        dropped(page, "nearer.json", json.dumps(stop))
        page.locator("#answer[data-settled=true]").wait_for()
        until(page, lambda: differing(page).get("file") == ["stop.json", "nearer.json"], "what differs is not said")
        dropped(page, "flat.json", json.dumps(PEG))
        answered(page, "peg moves 1 mm")
        page.locator(".beside .stage.solid canvas").wait_for()
        page.locator(".beside").get_by_role("button", name="Ask the same").is_disabled()
        page.locator(".beside").get_by_role("button", name="Swap").click()
        page.locator(".filename", has_text="stop.json").wait_for()
        page.locator(".beside .pane canvas[role=img]").wait_for()
