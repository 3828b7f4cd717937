"""Nothing on the page is taken for what it is not about: another gap, another question, another pair, another file; in a real browser."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.app_client import TOKEN, Served
from tests.browser_page import PEG, Late, answered, at_rest, canvas, following, foot, pixels_per_mm, serving, visiting
from tests.page_waits import LATER, settled, until

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"

AT_ONCE = """([x, y, times]) => {
    const canvas = document.querySelector('.stage canvas');
    for (let i = 0; i < times; i++) canvas.dispatchEvent(new PointerEvent('pointermove',
        {pointerId: 1, clientX: x + 5 + i % 40, clientY: y + i % 7, pointerType: 'mouse', bubbles: true})); }"""


def address(served: Served, link: str = "") -> str:
    return f"http://127.0.0.1:{served.port}/?token={TOKEN}{link}"


def set_gap(page: Any, gap: str) -> None:
    box = page.get_by_label("gap, mm", exact=True)
    box.fill(gap)
    box.press("Enter")
    box.blur()


def kept_design(page: Any) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(page.evaluate("sessionStorage.getItem('wiggleroom.design')"))
    return found


def picture(page: Any) -> bytes:
    page.evaluate(LATER)
    found: bytes = page.locator(".stage canvas").screenshot()
    return found


def test_a_study_that_ends_after_a_long_drag_is_of_the_gap_that_it_was_asked_for(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        late = Late(page, {"rank"})
        page.goto(address(peg))
        answered(page, "peg moves 1 mm")
        page.get_by_role("tab", name="Gaps").click()
        page.get_by_role("button", name="Rank", exact=True).click()
        until(page, lambda: len(late.held) > 0, "no ranking")
        set_gap(page, "2")
        answered(page, "peg moves 2 mm")
        box = canvas(page)
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 30, y)
        page.evaluate(AT_ONCE, [x, y, 700])
        page.mouse.up()
        page.locator("#answer", has_text="peg moved").wait_for()
        late.go()
        page.get_by_text("ranked for an earlier design").first.wait_for()


def test_outlines_that_come_late_are_not_put_under_a_newer_answer(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        late = Late(page, {"shape"})
        page.goto(address(peg))
        answered(page, "peg moves 1 mm")
        before = settled(page, lambda: picture(page))
        page.get_by_role("button", name="Do not ask for peg").click()
        set_gap(page, "5")
        until(page, lambda: len(late.held) > 0, "no outlines")
        for _ in range(2):
            page.keyboard.press("Control+z")
        answered(page, "peg moves 1 mm")
        assert settled(page, lambda: picture(page)) == before
        late.go()
        assert settled(page, lambda: picture(page)) == before
        late.kinds, late.held = {"flex"}, []
        set_gap(page, "3")
        until(page, lambda: len(late.held) > 0, "no answer")
        page.get_by_role("button", name="Do not ask for peg").click()
        set_gap(page, "5")
        page.locator("#answer", has_text="nothing asked").wait_for()
        before = settled(page, lambda: picture(page))
        late.go()
        assert settled(page, lambda: picture(page)) == before


def test_while_it_solves_nothing_is_said_of_another_gap(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        late = Late(page, set())
        page.goto(address(peg))
        for gap in ("2", "3", "1"):
            set_gap(page, gap)
            answered(page, f"peg moves {gap} mm")
        scale = pixels_per_mm(page)
        rest, box = at_rest(page), canvas(page)
        settled(page, lambda: page.locator("#answer").inner_text())
        page.get_by_role("tab", name="How sure").click()
        assert page.get_by_text("These are of").count() == 0
        late.kinds = {"flex"}
        set_gap(page, "2.5")
        page.get_by_text("These are of the answer before.").wait_for()
        page.keyboard.press("m")
        for x in (-14, 14):  # both sides of the frame
            page.mouse.click(box["x"] + rest[0] + x * scale, box["y"] + rest[1])
        page.locator(".measure .segment").wait_for(state="attached")
        assert page.locator(".measure text").text_content() == ""
        page.keyboard.press("Escape")
        page.locator(".savebutton").click()
        page.get_by_role("menuitem", name="Copy a link").wait_for()
        assert page.get_by_role("menuitem", name="Copy the command").count() == 0
        page.keyboard.press("Escape")
        late.kinds = set()
        late.go()
        answered(page, "peg moves 2.5 mm")
        assert page.get_by_text("These are of").count() == 0


def measured_across(page: Any) -> str:
    """Clearance between the outer sides of the frame, left and right of the peg."""
    x, y = foot(page)
    box = canvas(page)
    page.keyboard.press("m")
    for side in (-1, 1):
        for step in range(60, 0, -1):
            page.mouse.click(box["x"] + x + side * 8 * step, box["y"] + y)
            if page.locator(".measure .edge").count() == (1 if side < 0 else 2):
                break
    found = page.locator(".measure text").text_content()
    page.keyboard.press("Escape")
    return str(found)


def test_a_clearance_of_parts_that_no_gap_is_taken_off_yet_says_so(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "loose.json"
    path.write_text(
        json.dumps(PEG | {"parts": [{k: v for k, v in one.items() if k != "fixed"} for one in PEG["parts"]]})
    )
    with serving(path) as served, visiting(browser, served) as page:
        page.locator(".findings").wait_for()
        settled(page, lambda: foot(page))
        assert measured_across(page) == "30 mm as drawn"
        page.locator(".mends").get_by_role("button", name="Fix frame").click()
        answered(page, "peg moves 1 mm")
        settled(page, lambda: foot(page))
        assert measured_across(page) == "29 mm"  # half of the gap is taken off each side


def test_a_film_of_an_earlier_design_is_saved_as_the_film_that_is_seen(browser: Any, tmp_path: Path) -> None:
    with serving(EXAMPLES / "17_does_it_come_apart" / "sequential.json") as served, visiting(browser, served) as page:
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_role("button", name="Check", exact=True).click()
        page.locator(".verdict", has_text="comes apart").wait_for()
        gap = float(page.get_by_label("gap, mm", exact=True).input_value())
        set_gap(page, str(2 * gap))
        page.locator(".result.old").wait_for()
        page.locator("#answer[data-settled=true]").wait_for()
        settled(page, lambda: page.locator("#answer").inner_text())  # an answer that comes ends a film
        page.get_by_role("button", name="Play the path out of").first.click()
        page.locator(".facts", has_text="of an earlier design").wait_for()
        page.get_by_role("button", name="Save").click()
        with page.expect_download() as coming:
            page.get_by_role("menuitem", name="Answer in numbers").click()
        coming.value.save_as(tmp_path / "film.json")
        assert json.loads((tmp_path / "film.json").read_text())["gap"] == pytest.approx(gap)


def test_what_a_question_about_a_design_before_complained_of_is_gone(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        late = Late(page, set())
        page.goto(address(peg))
        answered(page, "peg moves 1 mm")
        page.get_by_role("button", name="Do not ask for peg").click()
        page.locator("#answer", has_text="nothing asked").wait_for()
        page.get_by_role("tab", name="Gaps").click()
        page.get_by_role("button", name="frame", exact=True).click()
        for key in ("w", "r"):  # a fixed part has no freedom, and nothing is wrong with that
            page.locator(".stage canvas").press(key)
            page.locator(".notices", has_text="frame is fixed").wait_for()
            page.locator(".notices").get_by_role("button", name="Close").click()
        assert page.locator(".findings").count() == 0
        page.get_by_role("tab", name="Answer").click()
        page.get_by_role("button", name="let frame go").click()
        page.locator(".stage canvas").press("w")
        page.locator(".findings").wait_for()
        page.keyboard.press("Control+z")
        page.locator(".findings").wait_for(state="hidden")
        page.keyboard.press("Control+Shift+z")
        late.kinds = {"failed"}
        page.locator(".stage canvas").press("w")
        until(page, lambda: len(late.held) > 0, "no complaint")
        page.keyboard.press("Control+z")
        late.go()
        page.locator(".notices", has_text="of an earlier design").wait_for()
        assert page.locator(".findings").count() == 0


def test_a_free_space_says_of_which_pair_it_is(browser: Any) -> None:
    with serving(EXAMPLES / "02_chain_of_tees" / "chain.json") as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        page.get_by_role("tab", name="Free space").click()
        boxes = page.locator(".pairname")
        for box, name in zip(boxes.all(), ("b1", "b2"), strict=True):
            box.fill(name)
        page.get_by_role("button", name="Show", exact=True).click()
        page.locator(".pair", has_text="b2 against b1").wait_for()
        for _ in range(5):
            page.locator(".stage canvas").press(".")
        until(page, lambda: boxes.nth(1).input_value() != "b2", "another part is chosen")
        assert page.locator(".pair").inner_text() == "b2 against b1"


def test_names_that_every_object_has_are_names_like_others(browser: Any, tmp_path: Path) -> None:
    names = ["constructor", "__proto__", "toString"]
    blocks = [[0, 0], [10, 0], [10, 10], [0, 10]]
    parts = [{"name": name, "outline": blocks, "at": [10 * k, 0, 0]} for k, name in enumerate(names)]
    parts[0]["fixed"] = True
    path = tmp_path / "names.json"
    path.write_text(
        json.dumps(
            {"format": "wiggleroom/1", "gap": 0.2, "parts": parts, "pull": [{"part": "toString", "direction": [-1, 0]}]}
        )
    )
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "toString")
        page.get_by_role("tab", name="Gaps").click()
        boxes = [page.locator("table.parts").get_by_label(f"extra gap around {name}, mm") for name in names]
        until(page, lambda: [box.input_value() for box in boxes] == ["0", "0", "0"], "every box shows its gap")
        boxes[1].fill("0.1")
        boxes[1].press("Enter")
        boxes[0].press("Tab")
        answered(page, "toString")
        until(page, lambda: [box.input_value() for box in boxes] == ["0", "0.1", "0"], "one has another")
        assert kept_design(page)["design"]["extra"] == {"__proto__": 0.1}


def test_enter_in_a_box_changes_no_digits_that_it_does_not_show(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        set_gap(page, "0.123456")
        answered(page, "peg moves 0.1235 mm")
        page.reload()
        box = page.get_by_label("gap, mm", exact=True)
        until(page, lambda: box.input_value() == "0.12346", "it shows five digits")
        box.press("Enter")
        page.evaluate(LATER)
        assert kept_design(page)["design"]["gap"] == 0.123456


def linked(page: Any, change: Callable[[dict[str, Any]], None]) -> str:
    """A link with something changed in it."""
    kept = kept_design(page)
    told = {"name": "peg.json", "mark": kept["mark"], "design": kept["design"] | {"gap": 2}}
    change(told)
    return "#state=" + base64.urlsafe_b64encode(json.dumps(told).encode()).decode().rstrip("=")


@pytest.mark.parametrize(
    ("change", "gap", "words"),
    [
        ({}, "2", ""),
        ({"mark": "other"}, "1", "another version of peg.json"),
        ({"name": "other.json", "mark": "other"}, "1", "a design for other.json: open that file"),
        ({"design": "2"}, "1", "not whole"),
        ({"design": {"gap": "<b>", "extra": {}, "fixed": [], "glue": [], "goals": []}}, "1", "not whole"),
        ({"design": {"gap": 2, "extra": {}, "fixed": 5, "glue": [], "goals": []}}, "1", "not whole"),
        (
            {"design": {"gap": 2, "extra": {}, "fixed": [], "glue": [], "goals": [{"direction": [1, 0]}]}},
            "1",
            "not whole",
        ),
    ],
)
def test_a_link_whose_design_is_not_shown_says_so(
    browser: Any, peg: Served, change: dict[str, Any], gap: str, words: str
) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        link = linked(page, lambda told: told.update(change))
        page.evaluate("sessionStorage.removeItem('wiggleroom.design')")
        page.goto("about:blank")
        page.goto(address(peg, link))
        if words:
            page.locator(".notices", has_text=re.compile(re.escape(words))).wait_for()
        answered(page, f"peg moves {gap} mm")


def test_a_file_that_has_changed_is_read_again_by_a_reload(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "peg.json"
    path.write_text(json.dumps(PEG))
    with following(path) as served, visiting(browser, served) as page:
        answered(page, "peg moves 1 mm in +x")
        path.write_text(json.dumps(PEG | {"gap": 2}))
        page.reload()
        answered(page, "peg moves 2 mm in +x")
        path.write_text("{")
        page.reload()
        page.get_by_text(re.compile("peg.json: line 1.*is not JSON")).first.wait_for(timeout=30_000)
