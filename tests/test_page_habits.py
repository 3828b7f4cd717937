"""What designers expect of a canvas and of a page: keys, buttons of the mouse, nothing lost; in a real browser."""

from __future__ import annotations

import gzip
import json
import re
import urllib.request
from typing import Any

import pytest

from tests.app_client import TOKEN, Served
from tests.browser_page import PEG, accessible, answered, at_rest, canvas, serving, still, visiting
from tests.page_waits import settled, until

pytestmark = pytest.mark.slow


def seen(page: Any) -> Any:
    """Where the picture is: x, y and scale."""
    return settled(page, lambda: page.locator(".stage canvas").get_attribute("data-view"))


def test_the_space_bar_held_moves_the_picture_and_pressed_alone_plays(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        before, box = json.loads(seen(page)), canvas(page)
        x, y = still(page)
        page.locator(".stage canvas").focus()
        page.keyboard.down(" ")
        page.mouse.move(box["x"] + x - 20, box["y"] + y)  # on the peg
        page.mouse.down()
        page.mouse.move(box["x"] + x + 40, box["y"] + y + 30, steps=3)
        page.mouse.up()
        page.keyboard.up(" ")
        after = json.loads(seen(page))
        assert after[2] == before[2]
        assert after[:2] != before[:2]
        assert page.get_by_role("button", name="Pause").count() == 0  # it does not play
        assert page.locator("#answer").inner_text() == "peg moves 1 mm in +x"  # nothing was dragged
        page.keyboard.press(" ")
        page.get_by_role("button", name="Pause").wait_for()


def test_the_second_button_of_the_mouse_opens_what_can_be_done_with_a_part(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        rest, box = at_rest(page), canvas(page)
        x, y = box["x"] + rest[0] - 20, box["y"] + rest[1]
        page.mouse.click(x, y, button="right")
        menu = page.get_by_role("menu", name="peg")
        menu.get_by_role("menuitem", name="Fix").wait_for()
        accessible(page)
        page.keyboard.press("ArrowDown")
        page.keyboard.press("Escape")
        assert menu.count() == 0
        page.mouse.click(x, y, button="right")
        menu.get_by_role("menuitem", name="Fix").click()
        page.locator(".notices", has_text="peg is fixed now").wait_for()
        page.keyboard.press("Control+z")
        answered(page, "peg moves 1 mm")
        page.mouse.click(box["x"] + 5, box["y"] + 5, button="right")
        page.get_by_role("menuitem", name="Choose all parts").click()
        page.get_by_role("toolbar", name="2 parts").wait_for()


def test_keys_of_other_programs_do_what_they_do_there(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".stage canvas").focus()
        page.keyboard.press("Control+s")
        page.get_by_role("menuitem", name="Picture svg").wait_for()
        page.keyboard.press("Escape")
        page.get_by_role("menuitem", name="Picture svg").wait_for(state="hidden")
        with page.expect_file_chooser():
            page.keyboard.press("Control+o")
        page.keyboard.press("]")
        answered(page, "peg moves 1.1 mm")
        page.keyboard.press("Control+z")
        answered(page, "peg moves 1 mm")
        page.keyboard.press("Control+y")
        answered(page, "peg moves 1.1 mm")


def test_a_row_of_contacts_is_one_stop_of_the_tab_key(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        rows = page.locator("section", has_text="What holds it").locator("tbody tr")
        assert rows.count() > 0
        assert [row.locator("button, a, input").count() for row in rows.all()] == [1] * rows.count()


def test_the_picture_stays_where_it_is_while_the_reach_is_worked_out(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".stage canvas").focus()
        for _ in range(2):
            page.keyboard.press(".")
        page.get_by_role("toolbar", name="part peg").wait_for()
        before = canvas(page)
        page.keyboard.press("r")
        page.locator(".selection .note", has_text=re.compile("free at|sampled")).wait_for()
        assert canvas(page) == before


def test_a_link_that_is_not_whole_says_so(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.goto(f"http://127.0.0.1:{served.port}/?token={TOKEN}#state=eyJuYW1l")
        page.get_by_text("The link is not whole").wait_for()


def test_files_of_the_page_are_compressed_for_those_who_take_that(peg: Served) -> None:
    address = f"http://127.0.0.1:{peg.port}/page.js"
    with urllib.request.urlopen(address) as plain:
        whole = plain.read()
    with urllib.request.urlopen(urllib.request.Request(address, headers={"Accept-Encoding": "gzip"})) as said:
        packed = said.read()
        assert said.headers["Content-Encoding"] == "gzip"
    assert gzip.decompress(packed) == whole
    assert len(packed) < len(whole) / 2


def test_twenty_files_keep_their_designs_with_undo(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        names = [f"file{k}.json" for k in range(20)]

        def drop(name: str) -> None:
            page.set_input_files(
                "#file", {"name": name, "mimeType": "application/json", "buffer": json.dumps(PEG).encode()}
            )
            page.locator(".filename", has_text=re.compile(f"^{name}$")).wait_for()

        for k, name in enumerate(names):
            drop(name)
            answered(page, "peg moves 1 mm")
            box = page.get_by_label("gap, mm", exact=True)
            box.fill(str(2 + k / 10))
            box.press("Enter")
            until(page, lambda k=k: page.evaluate(KEPT, names[k])["design"].get("gap") == 2 + k / 10, "it is not kept")  # type: ignore[misc]
        for k, name in enumerate(names):
            drop(name)
            answered(page, f"peg moves {2 + k / 10:g} mm")
            assert float(page.get_by_label("gap, mm", exact=True).input_value()) == 2 + k / 10
            kept = page.evaluate(KEPT, name)
            assert [step["design"]["gap"] for step in kept["history"]["past"]] == [1]


KEPT = """(name) => {
    const key = Object.keys(localStorage).find((one) => one.startsWith(`wiggleroom.design|${name}|`));
    return key ? JSON.parse(localStorage.getItem(key)) : {design: {}};
}"""
