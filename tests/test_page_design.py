"""What a designer meets on the page in the first hour: what is proposed, what numbers say, what stays; in a real browser."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import wiggleroom as wr
from tests.app_client import TOKEN, Served
from tests.browser_page import PEG, answered, at_rest, pixels_per_mm, serving, still, visiting, without
from tests.page_waits import settled, until
from wiggleroom.drawing.writers.assembly_writer import write_assembly

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"
JIGSAW = EXAMPLES / "drawings" / "pyjigsaw_4x5.svg"


def loose(**more: Any) -> str:
    """The peg and its frame, of which nothing is fixed."""
    parts = [{key: value for key, value in one.items() if key != "fixed"} for one in PEG["parts"]]  # type: ignore[attr-defined]
    return json.dumps(PEG | {"parts": parts} | more)


def dropped(page: Any, name: str, text: str) -> None:
    page.set_input_files("#file", {"name": name, "mimeType": "application/json", "buffer": text.encode()})


def gap_box(page: Any) -> Any:
    return page.get_by_label("gap, mm", exact=True)


def design(page: Any) -> dict[str, Any]:
    """What is set now, as a link carries it."""
    found: dict[str, Any] = json.loads(page.evaluate("sessionStorage.getItem('wiggleroom.design')"))["design"]
    return found


def test_the_part_that_is_pulled_is_not_the_one_to_fix(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "pulled.json"
    path.write_text(loose(pull=[{"part": "frame", "direction": [1, 0]}]))
    with serving(path) as served, visiting(browser, served) as page:
        page.locator(".findings").get_by_role("button", name=re.compile("^Fix ")).click()
        page.locator("#answer[data-settled=true]", has_text="frame").wait_for()
        assert design(page)["fixed"] == ["peg"]


def test_a_part_that_is_fixed_although_it_is_pulled_says_that_the_pull_is_gone(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".stage canvas").focus()
        for _ in range(2):
            page.keyboard.press(".")
        page.keyboard.press("f")
        page.locator(".notices", has_text="peg is fixed now, and no longer pulled").wait_for()
        page.keyboard.press("Control+z")
        answered(page, "peg moves 1 mm")
        assert page.locator(".notices").inner_text() == ""  # it was about the design before


def test_a_box_says_the_number_that_counts(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        gap_box(page).fill("0.2")  # typed, not taken
        dropped(page, "other.json", json.dumps(PEG | {"gap": 2}))
        answered(page, "peg moves 2 mm")
        assert gap_box(page).input_value() == "2"
        gap_box(page).blur()
        page.wait_for_timeout(100)
        assert gap_box(page).input_value() == "2"
        assert design(page)["gap"] == 2


def test_undo_in_a_box_takes_back_what_is_typed_and_then_the_design(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        gap_box(page).fill("2")
        gap_box(page).press("Enter")
        answered(page, "peg moves 2 mm")
        gap_box(page).press_sequentially("5")
        gap_box(page).press("Control+z")
        assert gap_box(page).input_value() == "2"
        gap_box(page).press("Control+z")
        answered(page, "peg moves 1 mm")
        assert gap_box(page).input_value() == "1"
        gap_box(page).press("Control+y")
        answered(page, "peg moves 2 mm")


def test_a_gap_of_nothing_grows_by_a_step_that_is_seen(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.locator("#file").set_input_files(JIGSAW)
        page.locator(".findings li").nth(1).wait_for()
        page.locator(".stage canvas").focus()
        page.keyboard.press("]")
        until(page, lambda: design(page)["gap"] > 0.01, "no step")
        gap = design(page)["gap"]
        assert gap < 0.02 * 100  # a hundredth of the drawing's pieces, about
        until(page, lambda: float(gap_box(page).input_value()) == pytest.approx(gap), "the box shows another gap")


def test_a_part_that_is_pressed_leaves_what_is_to_be_set_and_each_thing_has_one_button(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.locator("#file").set_input_files(JIGSAW)
        page.locator(".findings li").nth(1).wait_for()
        before = page.locator(".findings").inner_text()
        assert "things to set first" in before
        named = page.locator(".button.main.worded").all_inner_texts()
        assert sorted(words.split()[0] for words in named) == ["Fix", "Use"]
        box = page.locator(".stage canvas").bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2 + 20)
        page.locator(".selection .name").wait_for()
        page.keyboard.press("r")
        page.wait_for_timeout(600)
        settled(page, lambda: page.locator(".findings").inner_text())
        assert page.locator(".findings").inner_text() == before


def test_a_file_with_nothing_fixed_leaves_the_tab_that_is_open(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        gaps = page.get_by_role("tab", name="Gaps")
        gaps.click()
        dropped(page, "loose.json", loose())
        page.locator(".findings.missing", has_text="One thing to set first").wait_for()
        assert gaps.get_attribute("aria-selected") == "true"
        page.locator(".findings").get_by_role("button", name=re.compile("^Fix ")).click()
        answered(page, "peg moves 1 mm")
        assert gaps.get_attribute("aria-selected") == "true"


def test_an_answer_is_called_optimal_only_when_the_search_has_ended(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        without(page, "bound")
        page.goto(f"http://127.0.0.1:{peg.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm")
        assert page.locator(".headline .facts").inner_text().startswith("found so far")
        page.get_by_role("tab", name="How sure").click()
        assert "a search from other starts has not ended" in page.locator(".sure, .tabpanel").first.inner_text()
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".headline .facts", has_text="optimal").wait_for()


def test_where_too_many_parts_move_for_a_search_the_answer_says_that_it_is_from_rest(
    browser: Any, tmp_path: Path
) -> None:
    drawing = wr.patterns.chain(60, joint="tee", gap=0.02).drawing
    (tmp_path / "long.json").write_text(write_assembly(drawing))
    with serving(tmp_path / "long.json") as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        assert page.locator(".headline .facts").inner_text().startswith("found from rest")
        page.get_by_role("tab", name="How sure").click()
        assert "too many parts move for a search" in page.locator(".tabpanel").inner_text()


def test_a_small_motion_is_drawn_as_it_is_until_somebody_enlarges_it(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        gap_box(page).fill("0.05")
        gap_box(page).press("Enter")
        answered(page, "peg moves 0.05 mm")
        rest, moved = at_rest(page), still(page)
        assert moved[0] - rest[0] == pytest.approx(0.05 * scale, abs=0.05)
        assert "hardly seen at its true size" in page.locator(".headline .facts").inner_text()
        page.get_by_role("button", name=re.compile("^Enlarge")).click()
        assert "in the picture parts pass through each other" in page.locator(".headline .facts").inner_text()
        assert still(page)[0] - rest[0] > 5 * (moved[0] - rest[0])


NO_UNIT = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 80 40">
<g fill="none" stroke="black"><path id="frame" d="M0 0h40v40h-40z M10 10v20h20v-20z"/><path id="peg" d="M12 12h16v16h-16z"/>
<rect id="tag" stroke="red" x="50" y="10" width="20" height="20"/></g></svg>"""


def test_what_was_assumed_on_reading_stays_and_can_be_set(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.set_input_files("#file", {"name": "plain.svg", "mimeType": "image/svg+xml", "buffer": NO_UNIT.encode()})
        notes = page.get_by_label("notes on how the file was read").locator("li")
        notes.first.wait_for()
        said = " ".join(notes.all_inner_texts())
        assert "1 user unit is taken as 1 mm" in said
        assert "“leave out” takes one away" in said
        assert "--" not in said
        page.wait_for_timeout(9000)  # longer than a line over the picture stays
        assert " ".join(notes.all_inner_texts()) == said
        page.locator(".notices").wait_for(state="attached")
        assert page.locator(".notices").inner_text() == ""
        page.get_by_text("Read it in another way").click()
        page.get_by_label("unit of its numbers").select_option("in")
        until(page, lambda: "1 user unit" not in page.locator(".tabpanel").inner_text(), "it was not read again")
        page.get_by_label("leave out").fill("red")
        page.get_by_label("leave out").press("Tab")
        until(page, lambda: page.get_by_label(re.compile("^2 parts, gap")).count() == 1, "the red part is still there")
        page.reload()
        until(page, lambda: page.get_by_label(re.compile("^2 parts, gap")).count() == 1, "a reload reads it otherwise")
        until(page, lambda: page.get_by_label("unit of its numbers").input_value() == "in", "the unit is not kept")


def test_a_drawing_of_the_command_line_can_be_read_in_another_way_too(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "plain.svg"
    path.write_text(NO_UNIT)
    with serving(path) as served, visiting(browser, served) as page:
        page.get_by_text("Read it in another way").click()
        page.get_by_label("leave out").fill("red")
        page.get_by_label("leave out").press("Tab")
        until(page, lambda: page.get_by_label("leave out").input_value() == "red", "it was not read again")
        page.reload()
        until(page, lambda: page.get_by_label("leave out").input_value() == "red", "a reload reads it otherwise")


def test_every_file_keeps_its_design_with_undo(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        dropped(page, "one.json", json.dumps(PEG))
        page.locator(".filename", has_text="one.json").wait_for()
        for gap in ("2", "3"):
            gap_box(page).fill(gap)
            gap_box(page).press("Enter")
            answered(page, f"peg moves {gap} mm")
        dropped(page, "two.json", json.dumps(PEG | {"gap": 4}))
        answered(page, "peg moves 4 mm")
        dropped(page, "one.json", json.dumps(PEG))
        answered(page, "peg moves 3 mm")
        page.locator(".notices", has_text="is here again").wait_for()
        page.keyboard.press("Control+z")
        answered(page, "peg moves 2 mm")
        page.get_by_role("button", name="As the file says").click()
        answered(page, "peg moves 1 mm")
        page.keyboard.press("Control+z")
        answered(page, "peg moves 2 mm")
        page.get_by_role("button", name="wiggleroom: samples and files opened before").click()
        page.locator(".recent", has_text="two.json").click()
        answered(page, "peg moves 4 mm")


def test_a_design_whose_parts_are_gone_from_the_file_is_left_out(browser: Any, peg: Served) -> None:
    other = json.dumps(PEG).replace('"peg"', '"pin"')
    with visiting(browser, peg) as page:
        dropped(page, "one.json", json.dumps(PEG))
        page.locator(".filename", has_text="one.json").wait_for()
        gap_box(page).fill("2")
        gap_box(page).press("Enter")
        answered(page, "peg moves 2 mm")
        dropped(page, "one.json", other)
        answered(page, "pin moves 1 mm")


def test_parts_that_should_be_tighter_are_made_so_by_one_press(browser: Any) -> None:
    with serving(EXAMPLES / "02_chain_of_tees" / "chain.json") as served, visiting(browser, served) as page:
        answered(page, "b10 moves")
        page.locator(".headline .facts", has_text="optimal").wait_for()
        page.get_by_role("tab", name="Vary").click()
        page.get_by_role("button", name="Find them").click()
        said = page.locator(".result .strong").first
        said.wait_for()
        then = said.inner_text().removesuffix(" with these parts tighter")
        page.get_by_role("button", name="Make them tighter").click()
        answered(page, then)
        assert len(design(page)["extra"]) == 3
        assert page.get_by_role("button", name="Make them tighter").count() == 0  # it is of the design before


def test_the_gap_to_draw_is_found_and_set_by_one_press(browser: Any) -> None:
    with serving(EXAMPLES / "02_chain_of_tees" / "chain.json") as served, visiting(browser, served) as page:
        answered(page, "b10 moves 1.372 mm")
        page.get_by_role("tab", name="Vary").click()
        for name, value in (("moves at most", "0.5"), ("kerf", "0.1")):
            page.get_by_role("textbox", name=name).fill(value)
            page.keyboard.press("Enter")
        page.get_by_role("button", name="Find the gap").click()
        page.locator(".result", has_text="b10 in +y stays below 0.5 mm").wait_for()
        assert "offset the cut by" in page.locator(".result").inner_text()
        page.get_by_role("button", name="Set this gap").click()
        answered(page, "b10 moves 0.49")
        assert 0.0036 < design(page)["gap"] < 0.0038
        page.get_by_role("button", name="Set this gap").wait_for(state="hidden")


def test_parts_that_nothing_asks_about_do_not_fly(browser: Any, tmp_path: Path) -> None:
    square = [[-5, -5], [5, -5], [5, 5], [-5, 5]]
    base = {"name": "base", "outline": [[0, 0], [60, 0], [60, 5], [0, 5]], "fixed": True}
    places = {"a": [10, 10, 0], "b": [20, 10, 0], "c": [30, 10, 0], "d": [30, 20, 0]}
    blocks = [{"name": name, "outline": square, "at": at} for name, at in places.items()]
    pull = [{"part": "b", "direction": [0, 1]}]
    path = tmp_path / "blocks.json"
    path.write_text(json.dumps({"format": "wiggleroom/1", "gap": 0.2, "parts": [base, *blocks], "pull": pull}))
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "nothing stops b")
        page.get_by_role("heading", name="How far each part goes").wait_for()
        rows = page.locator("section", has_text="How far each part goes").locator("tbody tr").all_inner_texts()
        moved = {row.split()[0]: float(row.split()[-1]) for row in rows}
        assert moved.pop("b") > 60
        assert moved == dict.fromkeys(("a", "c", "d", "base"), 0.0)


def test_a_film_stays_in_the_picture(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "open.json"
    frame = {"name": "frame", "outline": [[0, 0], [30, 0], [30, 4], [0, 4]], "fixed": True}
    block = {"name": "block", "outline": [[0, 0], [10, 0], [10, 10], [0, 10]], "at": [10, 4.5, 0]}
    path.write_text(
        json.dumps(
            {"format": "wiggleroom/1", "parts": [frame, block], "pull": [{"part": "block", "direction": [0, 1]}]}
        )
    )
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "nothing stops block")
        page.get_by_role("button", name="Pause").click()
        page.get_by_label("place on the path from rest").fill("1000")
        box = page.locator(".stage canvas").bounding_box()
        x, y = still(page)
        assert 0 < x < box["width"]
        assert 0 < y < box["height"]
        for part in page.locator(".pull polygon.head").all():
            head = part.bounding_box()
            assert head["y"] >= box["y"]


def test_on_a_phone_the_picture_is_a_third_of_the_screen_and_the_page_alone_scrolls(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        page.set_viewport_size({"width": 390, "height": 844})
        answered(page, "peg moves 1 mm")
        for tab in page.get_by_role("tab").all():
            box = tab.bounding_box()
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= 390
            tab.click()
            assert page.locator(".stage canvas").bounding_box()["height"] > 844 / 3
            assert page.locator(".panel, .tabpanel").evaluate_all(
                "all => all.every((e) => e.scrollHeight <= e.clientHeight + 1)"
            )
