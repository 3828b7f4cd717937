"""The page in a real browser, against the real server: what is seen is what the functions say."""

from __future__ import annotations

import base64
import io
import json
import os
import re
import signal
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import wiggleroom as wr
from tests.app_client import TOKEN, Served
from tests.browser_page import (
    AXE,
    PEG,
    Late,
    accessible,
    answered,
    at_rest,
    canvas,
    foot,
    pixels_per_mm,
    serving,
    still,
    visiting,
)
from tests.page_waits import LATER, PATIENCE, plays, settled, until
from tests.test_studies_search import corridor
from wiggleroom.cli import main
from wiggleroom.drawing.writers.assembly_writer import write_assembly

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"


def colour(page: Any, x: float, y: float) -> tuple[int, ...]:
    """Colour of the canvas at a point [px]."""
    script = "(c, [x, y]) => [...c.getContext('2d').getImageData(x * devicePixelRatio, y * devicePixelRatio, 1, 1).data].slice(0, 3)"
    return tuple(page.locator(".stage canvas").evaluate(script, [x, y]))


def test_the_page_is_ready_soon_and_says_the_answer(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm in +x")
        page.locator(".headline .facts", has_text="optimal").wait_for()
        assert page.title() == "peg.json · wiggleroom"
        assert "token" not in page.url
        page.get_by_role("tab", name="How sure").click()
        assert "every active wall is a real contact" in page.locator(".sure").inner_text()


def test_a_dragged_part_stops_where_it_must_and_what_holds_it_lights_up(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        rest, box = at_rest(page), canvas(page)
        frame = (rest[0] - 12 * scale, rest[1])
        quiet = colour(page, *frame)
        x, y = still(page)
        page.mouse.move(box["x"] + x - 40, box["y"] + y + 40)
        page.mouse.down()
        page.mouse.move(box["x"] + x - 200, box["y"] + y - 150, steps=12)
        page.locator("#answer", has_text="peg moved").wait_for()
        page.mouse.up()
        still(page)
        assert "held by frame" in page.locator(".headline .facts").inner_text()
        now = still(page)
        factor = (now[0] - rest[0]) / -scale
        assert factor > 0.99
        assert (now[1] - rest[1]) / scale == pytest.approx(-factor, abs=0.02 * factor)  # 1 mm to the left, 1 mm up
        assert colour(page, *frame) == quiet  # what stands stays red
        page.keyboard.press("Escape")
        answered(page, "peg moves 1 mm in +x")


def test_the_arrow_can_be_turned_and_taken_to_another_part(browser: Any) -> None:
    path = EXAMPLES / "02_chain_of_tees" / "chain.json"
    truth = wr.flex(wr.read(str(path)), wr.Pull("b10", (1, 0)), search=0).objective
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "b10 moves")
        x, y = still(page)
        box = canvas(page)
        page.mouse.move(box["x"] + x, box["y"] + y - 66)  # the head of a pull in +y
        page.mouse.down()
        page.mouse.move(box["x"] + x + 60, box["y"] + y - 40, steps=5)
        for _ in range(20):  # drawn to the axis, which is near: answers on the way move the foot of the arrow
            x, y = still(page)
            page.mouse.move(box["x"] + x + 70, box["y"] + y + 2, steps=2)
            page.wait_for_timeout(500)
            if "in +x" in page.locator("#answer").inner_text():
                break
        page.mouse.up()
        answered(page, f"b10 moves {truth:.4g} mm in +x")
        names = page.locator(".rows .name")
        assert names.all_inner_texts() == ["b10"]
        x, y = still(page)
        page.mouse.move(box["x"] + x, box["y"] + y)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + y, steps=8)
        page.mouse.up()
        page.locator("#answer", has_text=re.compile(r"b[4-7] at .* moves")).wait_for()
        page.keyboard.press("Control+z")
        answered(page, f"b10 moves {truth:.4g} mm in +x")


def test_a_dropped_file_is_opened(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.get_by_text("Drop a drawing here").wait_for()
        script = """text => { const carried = new DataTransfer();
            carried.items.add(new File([text], 'dropped.json', {type: 'application/json'}));
            window.dispatchEvent(new DragEvent('drop', {dataTransfer: carried, bubbles: true, cancelable: true})); }"""
        page.evaluate(script, json.dumps(PEG))
        answered(page, "peg moves 1 mm in +x")
        assert page.title() == "dropped.json · wiggleroom"


def test_the_gap_leads_to_new_poses_and_the_curve_grows(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        box = page.get_by_label("gap, mm", exact=True)
        for gap in ("2", "0.5"):
            box.fill(gap)
            box.press("Enter")
            answered(page, f"peg moves {gap} mm in +x")
        assert page.locator(".curve .dot").count() == 3
        slider = page.locator("#gap")
        slider.focus()
        for _ in range(5):
            slider.press("ArrowRight")
        gap = float(slider.input_value())
        assert gap > 0.5
        answered(page, f"peg moves {gap:g} mm in +x")
        page.keyboard.press("Control+z")
        answered(page, "peg moves 0.5 mm in +x")  # one pull of the slider is undone at once
        page.keyboard.press("Control+Shift+z")
        answered(page, f"peg moves {gap:g} mm in +x")
        extra = page.get_by_label("extra gap around peg, mm")
        page.get_by_role("tab", name="Gaps").click()
        extra.last.fill("0.4")
        extra.last.press("Enter")
        answered(page, f"peg moves {gap + 0.2:g} mm in +x")  # its outline alone moves inward by half of it


def test_the_chosen_part_has_a_gap_of_its_own_with_slider_and_box_in_step(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.get_by_role("tab", name="Gaps").click()
        page.locator(".parts").get_by_role("button", name="peg").click()
        toolbar = page.get_by_role("toolbar", name="part peg")
        slider, box = toolbar.get_by_role("slider", name="extra gap around peg"), toolbar.get_by_role("textbox")
        assert slider.get_attribute("aria-valuetext") == "0 mm"
        slider.focus()
        for _ in range(4):
            slider.press("ArrowRight")
        extra = float(slider.input_value())
        assert extra == pytest.approx(0.4)
        answered(page, "peg moves 1.2 mm in +x")  # its outline alone moves inward by half of it
        assert box.input_value() == "0.4"
        at = slider.bounding_box()
        page.mouse.move(at["x"] + 0.7 * at["width"], at["y"] + at["height"] / 2)
        page.mouse.down()
        page.mouse.move(at["x"] + 0.2 * at["width"], at["y"] + at["height"] / 2, steps=6)
        page.mouse.up()
        tighter = float(slider.input_value())
        assert tighter < -0.3
        answered(page, f"peg moves {1 + tighter / 2:.4g} mm in +x")
        assert float(box.input_value()) == tighter
        page.keyboard.press("Control+z")  # one pull of the slider is undone at once
        answered(page, "peg moves 1.2 mm in +x")
        assert (float(slider.input_value()), box.input_value()) == (pytest.approx(0.4), "0.4")
        page.keyboard.press("Control+z")
        answered(page, "peg moves 1 mm in +x")
        box.fill("2.5")  # more than the slider had room for
        box.press("Enter")
        answered(page, "peg moves 2.25 mm in +x")
        assert float(slider.input_value()) == 2.5


def test_the_ranking_colours_the_parts_and_sorts_the_table(browser: Any) -> None:
    path = EXAMPLES / "03_chain_of_swallowtails" / "chain.json"
    truth = wr.rank(wr.read(str(path)))
    names = truth.answer.assembly.names
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "b10 moves")
        page.get_by_role("tab", name="Gaps").click()
        x, y = still(page)
        before = colour(page, x - 16, y - 6)
        page.get_by_role("button", name="Rank the gaps of all parts").or_(
            page.get_by_role("button", name="Rank")
        ).first.click()
        page.locator(".blamebar").wait_for()
        until(page, lambda: colour(page, x - 16, y - 6) != before, "the parts have no colours")
        rows = page.locator(".parts tbody tr")
        shown = [
            (r.locator("button").inner_text().strip(), float(r.locator(".bar span").inner_text())) for r in rows.all()
        ]
        assert [v for _, v in shown] == sorted((v for _, v in shown), reverse=True)
        for name, value in shown:
            assert value == pytest.approx(float(truth.looser[names.index(name)]), rel=5e-3, abs=1e-6)
        gap = page.get_by_label("gap, mm", exact=True)
        gap.fill(str(0.9 * float(gap.input_value())))
        page.keyboard.press("Enter")
        page.get_by_text("ranked for an earlier design").first.wait_for()
        x, y = still(page)
        until(page, lambda: colour(page, x - 16, y - 6) == before, "colours of an earlier design stay")


def test_the_way_out_is_a_film(browser: Any) -> None:
    with serving(EXAMPLES / "17_does_it_come_apart" / "sequential.json") as served, visiting(browser, served) as page:
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_role("button", name="Check").click()
        page.locator(".verdict", has_text="comes apart").wait_for()
        assert page.locator(".result .row").count() == 2
        page.locator("#answer", has_text="latch leaves").wait_for()
        plays(page)


def test_a_plan_is_played_step_by_step(browser: Any, tmp_path: Path) -> None:
    with serving(EXAMPLES / "46_plans" / "lock.json") as served, visiting(browser, served) as page:
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_label("direction in which loose parts fall").select_option("in -y")
        page.get_by_role("button", name="Plan", exact=True).click()
        page.locator(".verdict", has_text="taken apart").wait_for()
        steps = page.locator("ol.rows .row")
        assert steps.count() > 3
        assert "1. slide1 moves in +x by 10 mm" in steps.nth(0).text_content()
        assert any("hold tumbler1" in text for text in steps.all_text_contents())
        steps.nth(3).get_by_role("button").click()
        page.locator("#answer", has_text="tumbler1 moves in +y").wait_for()
        plays(page)
        page.get_by_role("button", name="Save").click()
        with page.expect_download() as coming:
            page.get_by_role("menuitem", name="A picture of every step").click()
        coming.value.save_as(tmp_path / "steps.zip")
        with zipfile.ZipFile(tmp_path / "steps.zip") as packed:
            assert len(packed.namelist()) == steps.count()
            assert b"<svg" in packed.read("step_01.svg")


def test_what_is_saved_says_the_same(browser: Any, peg: Served, tmp_path: Path) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        box = page.get_by_label("gap, mm", exact=True)
        box.fill("2")
        box.press("Enter")
        answered(page, "peg moves 2 mm")
        kept = {}
        for words, ending in (("Assembly file json", "json"), ("Picture svg", "svg"), ("Report html", "html")):
            page.get_by_role("button", name="Save").click()
            with page.expect_download() as coming:
                page.get_by_role("menuitem", name=words).click()
            kept[ending] = tmp_path / f"saved.{ending}"
            coming.value.save_as(kept[ending])
        assert wr.flex(wr.read(str(kept["json"])), search=0).objective == pytest.approx(2)
        assert "peg moves 2 mm in +x" in kept["svg"].read_text()
        assert "peg moves 2 mm in +x" in kept["html"].read_text()


def test_a_killed_worker_is_told_and_the_session_goes_on(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        os.kill(peg.workers()[-1], signal.SIGKILL)
        box = page.get_by_label("gap, mm", exact=True)
        box.fill("1.2")
        box.press("Enter")
        answered(page, "peg moves 1.2 mm in +x")
        page.locator(".pill").wait_for(state="detached")
        box = canvas(page)
        x, y = (a + b for a, b in zip(foot(page), (box["x"], box["y"]), strict=True))
        page.mouse.move(x, y + 30)
        page.mouse.down()
        os.kill(peg.workers()[-1], signal.SIGKILL)
        page.mouse.move(x - 20, y + 40, steps=4)
        page.locator("#answer", has_text=re.compile(r"peg moved [\d.]+ mm")).wait_for()
        page.mouse.up()


def test_without_its_server_a_page_keeps_its_answer_and_says_what_to_do(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "peg.json"
    path.write_text(json.dumps(PEG))
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    context.set_default_timeout(1000 * PATIENCE)
    page = context.new_page()
    with serving(path) as served:
        page.goto(f"http://127.0.0.1:{served.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm")
    page.locator(".pill", has_text="no server").wait_for()
    x, y = foot(page)
    box = canvas(page)
    page.mouse.move(box["x"] + x, box["y"] + y + 30)
    page.mouse.down()
    page.mouse.move(box["x"] + x + 40, box["y"] + y + 60, steps=4)
    page.mouse.up()
    assert "start wiggleroom serve again" in page.locator(".findings").inner_text()
    assert page.locator("#answer").inner_text() == "peg moves 1 mm in +x"
    assert page.locator(".busy, .work").count() == 0
    page.get_by_role("tab", name="Come apart").click()
    page.locator(".findings button").click()
    page.get_by_role("button", name="Check").first.click()
    assert "start wiggleroom serve again" in page.locator(".findings").inner_text()
    context.close()


def test_hostile_files_are_refused_in_a_line(browser: Any, peg: Served) -> None:
    bomb = '<!DOCTYPE s [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]><svg xmlns="http://www.w3.org/2000/svg">&b;</svg>'
    files = [
        ("bomb.svg", bomb.encode()),
        ("<img src=x onerror=alert(1)>.json", b"{}"),
        ("nan.json", b'{"format": "wiggleroom/1", "parts": [{"name": "a", "outline": [[NaN, 0], [1, 0], [1, 1]]}]}'),
        ("huge.svg", b" " * 21_000_000),
    ]
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        for name, content in files:
            page.locator("#file").set_input_files({"name": name, "mimeType": "text/plain", "buffer": content})
            page.get_by_role("alert").wait_for()
            assert page.locator("[role=alert] li").count() >= 1
            assert page.locator("[role=alert] img").count() == 0
            page.get_by_role("alert").get_by_role("button", name="Close").click()
        assert "peg moves 1 mm" in page.locator("#answer").inner_text()


def test_everything_by_keyboard_alone(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        keys = page.keyboard
        for _ in range(20):
            if page.evaluate("document.activeElement.tagName") == "CANVAS":
                break
            keys.press("Tab")
        assert page.evaluate("document.activeElement.tagName") == "CANVAS"
        assert page.evaluate("getComputedStyle(document.querySelector('.stage'), '::after').borderTopWidth") == "2px"
        for _ in range(2):
            keys.press(".")
        page.get_by_role("toolbar", name="part peg").wait_for()
        keys.press("ArrowUp")
        answered(page, "peg moves 1 mm in +y")
        keys.press("p")
        page.locator("#answer", has_text="nothing asked").wait_for()
        for _ in range(40):
            keys.press("ArrowLeft")
        page.locator("#answer", has_text="peg moved 1 mm").wait_for()
        keys.press("p")
        answered(page, "peg moves 1 mm in +x")
        keys.press("f")
        page.locator(".chip.fixed", has_text="peg").wait_for()
        keys.press("f")
        keys.press("?")
        page.get_by_role("dialog").wait_for()
        keys.press("Escape")
        page.get_by_role("dialog").wait_for(state="hidden")
        page.wait_for_timeout(100)
        keys.press("4")
        assert page.get_by_role("tab", name="Come apart").get_attribute("aria-selected") == "true"


def test_everything_has_a_name(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.keyboard.press(".")
        nameless = """() => [...document.querySelectorAll('button, input, select, canvas, [role=img], meter, progress')].filter(e =>
            !(e.getAttribute('aria-label') || e.textContent.trim() || (e.labels && e.labels.length))).map(e => e.outerHTML)"""
        for tab in page.get_by_role("tab").all():
            tab.click()
            assert page.evaluate(nameless) == []
        assert page.locator("#answer").get_attribute("aria-live") == "polite"


def test_a_phone_needs_no_scrolling_sideways(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        page.set_viewport_size({"width": 390, "height": 844})
        answered(page, "peg moves 1 mm")
        page.keyboard.press(".")
        for tab in page.get_by_role("tab").all():
            tab.click()
            assert page.evaluate("document.scrollingElement.scrollWidth") <= 390
            assert page.locator(".tabpanel").evaluate("e => e.scrollWidth - e.clientWidth") <= 0
            assert canvas(page)["height"] > 150
        seen = page.locator(".topbar button:visible, .player button:visible, .selection button:visible").all()
        for button in seen:
            box = button.bounding_box()
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= 390


def test_5000_parts_are_painted_once_a_frame(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "plates.json"
    tab = [[10, 4], [11, 4], [11, 3], [12, 3], [12, 7], [11, 7], [11, 6], [10, 6]]
    ring = [[0, 0], [10, 0], *tab, [10, 10], [0, 10], [0, 6], [1, 6], [1, 4], [0, 4]]
    parts = [{"name": f"p{i}", "shape": "plate", "at": [13 * (i % 71), 11 * (i // 71), 0]} for i in range(5000)]
    parts[0]["fixed"] = True
    path.write_text(
        json.dumps({"format": "wiggleroom/1", "gap": 0.1, "shapes": {"plate": {"outline": ring}}, "parts": parts})
    )
    count = """() => { const most = { fill: 0, stroke: 0 }, now = { fill: 0, stroke: 0 };
        window.most = most;
        for (const kind of ["fill", "stroke"]) {
            const call = CanvasRenderingContext2D.prototype[kind];
            CanvasRenderingContext2D.prototype[kind] = function (...given) { now[kind]++; return call.apply(this, given); };
        }
        const step = () => {
            for (const kind in now) { most[kind] = Math.max(most[kind], now[kind]); now[kind] = 0; }
            requestAnimationFrame(step);
        };
        requestAnimationFrame(step); }"""
    with serving(path) as served, visiting(browser, served) as page:
        page.locator("#answer").wait_for()
        page.evaluate(LATER)
        before, box = pixels(page), canvas(page)
        page.evaluate(count)
        page.mouse.move(box["x"] + 20, box["y"] + 300)
        page.mouse.down()
        page.mouse.move(box["x"] + 120, box["y"] + 260, steps=30)
        page.mouse.up()
        until(page, lambda: pixels(page) != before, "it does not follow the hand")
        page.evaluate(LATER)
        most = page.evaluate("most")
    assert 0 < most["fill"] <= 2 * 5000 + 100, "each part once a frame, of both bitmaps that a still picture needs"
    assert most["stroke"] <= 2 * 5000 + 100


def test_a_standalone_page_needs_no_server(browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, made = tmp_path / "peg.json", tmp_path / "peg <1>.html"
    path.write_text(json.dumps(PEG))
    monkeypatch.setattr("sys.argv", ["wiggleroom", "sweep", str(path), "--gaps", "0.5,1,2", "--html", str(made)])
    assert main() == 0
    wrong: list[str] = []
    page = browser.new_page(viewport={"width": 1200, "height": 800})
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda said: wrong.append(said.text))
    page.on("request", lambda asked: None if asked.url.startswith("file:") else wrong.append(asked.url))
    page.goto(made.as_uri())
    answered(page, "peg moves 1 mm in +x")  # the gap of the file comes first
    assert page.locator(".curve .dot").count() == 3
    page.locator("#gap").fill("1.9")  # only stored gaps have answers
    answered(page, "peg moves 2 mm in +x")
    rest, moved = at_rest(page), still(page)
    assert moved[0] > rest[0]
    assert [tab.inner_text() for tab in page.get_by_role("tab").all()] == ["Answer", "Gaps", "How sure"]
    assert page.get_by_role("button", name="Save").count() == 0
    page.close()
    assert wrong == []


def test_the_hand_leads_and_nothing_is_claimed_before_it_is_known(browser: Any, peg: Served) -> None:
    """With the server silent, the part goes as far as the outlines leave it free, at once; the rest is a ghost."""
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        rest, box = at_rest(page), canvas(page)
        page.evaluate("WebSocket.prototype.send = () => {}")  # from now on nothing is answered
        x, y = box["x"] + rest[0] - 3 * scale, box["y"] + rest[1] + 3 * scale
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x - 0.5 * scale, y, steps=3)

        def goes_to(right: float, up: float, near: float) -> None:
            there = pytest.approx((right, up), abs=near)
            until(
                page,
                lambda: ((foot(page)[0] - rest[0]) / scale, (rest[1] - foot(page)[1]) / scale) == there,
                "elsewhere",
            )

        goes_to(0.5, 0, 0.05)  # from where the answer ended
        page.mouse.move(x - 6 * scale, y - 0.3 * scale, steps=3)
        goes_to(-1, 0.3, 0.03)  # the frame stops it, along the wall it goes on
        said = page.locator(".headline").inner_text()
        assert "follows the hand" in said
        assert not re.search(r"\d", said)
        page.locator(".busy").wait_for()
        page.mouse.up()


def test_what_was_repaired_piece_by_piece_looks_like_a_whole_repaint(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "grid.json"
    path.write_text(write_assembly(wr.patterns.grid(6, 5, joint="tee", gap=0.03).drawing))
    with serving(path) as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        settled(page, lambda: pixels(page))
        box = canvas(page)
        for k in range(3):
            x, y = box["x"] + (0.42 + 0.05 * k) * box["width"], box["y"] + (0.55 - 0.04 * k) * box["height"]
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + 40, y - 25, steps=6)
            page.locator("#answer", has_text="moved").wait_for()
            page.mouse.up()
            page.mouse.move(box["x"] + 3, box["y"] + 3)
        repaired = settled(page, lambda: pixels(page))
        for scheme in ("dark", "light"):  # other colours: all is painted anew
            before = pixels(page)
            page.emulate_media(color_scheme=scheme)
            until(page, lambda before=before: pixels(page) != before, "the colours stay")  # type: ignore[misc]
        whole, repaired = painted(settled(page, lambda: pixels(page))), painted(repaired)
        assert (np.abs(whole - 255).max(axis=2) > 60).mean() > 0.01, "there is something to see"
        assert np.abs(repaired - whole).max() < 64, "no more than the edge of a line"


def pixels(page: Any) -> str:
    """The canvas as the address of a picture."""
    return str(page.evaluate("document.querySelector('.stage canvas').toDataURL()"))


def painted(address: str) -> np.ndarray:
    """Colours of its pixels."""
    data = base64.b64decode(address.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)


def test_no_number_before_it_is_known(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.evaluate("""() => { window.said = [];
            const title = () => document.querySelector('#answer').innerText;
            let last = title();
            new MutationObserver(() => { if (title() !== last) said.push(last = title()); }).observe(
                document.querySelector('.headline'), {subtree: true, childList: true, characterData: true}); }""")
        box = page.locator(".gapbox").get_by_role("textbox")
        box.fill("1000000000")
        box.press("Enter")
        page.locator(".findings").wait_for()
        assert page.evaluate("said.filter((one) => /[0-9] mm/.test(one))") == []
        mend = page.locator(".findings .button.main").first
        assert "Use a gap of" in mend.inner_text()
        mend.click()
        page.locator("#answer[data-settled=true]").wait_for()
        assert page.locator(".findings").count() == 0
        for wrong in ("-1", "abc"):
            box.fill(wrong)
            box.press("Enter")
            page.locator(".notices", has_text=wrong).wait_for()


def test_all_that_is_wrong_is_one_list_and_each_line_can_be_mended(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.locator("#file").set_input_files(EXAMPLES / "drawings" / "pyjigsaw_4x5.svg")
        page.locator(".findings li").nth(1).wait_for()
        text = page.locator(".findings").inner_text()
        assert "Nothing stands" in text
        assert "touch at rest" in text
        page.locator(".findings").get_by_role("button", name="Show").last.click()
        page.locator(".overlay .spot").wait_for()
        for words in ("Fix ", "Use a gap of"):
            page.locator(".findings .button.main", has_text=words).click()
            assert page.locator(".findings .button.main", has_text=words).count() == 0  # whatever the answer will be
        page.locator("#answer[data-settled=true]").wait_for()
        assert page.locator(".findings").count() == 0
        assert page.locator(".step.done").count() == 3


def test_the_start_page_opens_samples_and_files_of_before(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "brick.json"
    path.write_text(json.dumps(PEG))
    with serving(None) as served, visiting(browser, served) as page:
        page.locator("#file").set_input_files(path)
        answered(page, "peg moves 1 mm")
        page.evaluate("sessionStorage.removeItem('wiggleroom.file')")
        page.reload()
        page.locator(".recent", has_text="brick.json").click()
        answered(page, "peg moves 1 mm")
        page.evaluate("sessionStorage.removeItem('wiggleroom.file')")
        page.reload()
        page.get_by_role("button", name=re.compile("chain", re.IGNORECASE)).click()
        answered(page, "b6 moves")
        assert "chain-design.json" in page.locator(".command").inner_text()


def test_the_samples_are_one_press_away_and_so_is_the_way_back(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        way = page.get_by_role("button", name="wiggleroom: samples and files opened before")
        way.click()
        page.locator(".sample").first.wait_for()
        assert page.locator(".panel, .middle, .gapstrip").evaluate_all("them => them.every(one => one.inert)")
        page.locator("body").press("f")  # means nothing here
        page.get_by_role("button", name="Back to peg.json").click()
        page.locator(".sample").first.wait_for(state="hidden")
        assert page.locator(".panel").evaluate("one => !one.inert")
        answered(page, "peg moves 1 mm")
        way.click()
        page.locator(".sample").first.wait_for()
        page.keyboard.press("Escape")
        page.locator(".sample").first.wait_for(state="hidden")
        way.click()
        page.locator(".sample", has_text="chain").click()
        answered(page, "b6 moves")
        assert page.locator(".start").count() == 0


def test_work_on_the_drawing_before_ends_with_it(browser: Any, peg: Served) -> None:
    """The server leaves it, so nobody would ever say that it is done."""
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.get_by_role("tab", name="Vary").click()
        page.get_by_label("tries").fill("100000")
        page.get_by_label("tries").press("Enter")
        page.locator(".panel").get_by_role("button", name="Try random gaps").click()
        page.locator(".work", has_text="trying gaps at random").wait_for()
        page.get_by_role("button", name="wiggleroom: samples and files opened before").click()
        page.locator(".sample", has_text="chain").click()
        answered(page, "b6 moves")
        assert page.locator(".work", has_text="drawing gaps").count() == 0
        assert page.locator(".panel").get_by_role("button", name="Try random gaps").is_enabled()


def test_a_word_that_needs_explaining_is_explained_where_it_stands(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        for place, words in ((".headline", "Optimal:"), (".tabpanel", "How hard this contact presses")):
            page.locator(f"{place} .explain button").first.click()
            page.locator(f"{place} .meaning", has_text=words).wait_for()
            page.keyboard.press("Escape")
            page.locator(f"{place} .meaning", has_text=words).wait_for(state="hidden")


def test_the_gap_plays_from_answer_to_answer(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.get_by_role("button", name="Play the gap").click()
        page.locator(".curve .dot").nth(4).wait_for()
        page.get_by_role("button", name="Stop the gap").click()
        page.locator("#answer[data-settled=true]").wait_for()
        gap = float(page.locator(".gapbox").get_by_role("textbox").input_value())
        assert gap > 1
        answered(page, f"peg moves {gap:g} mm")


@pytest.mark.skipif(not AXE.exists(), reason="needs `npm ci` in web")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(browser: Any, scheme: str) -> None:
    with serving(None) as served, visiting(browser, served, color_scheme=scheme) as page:
        page.locator(".sample").first.wait_for()
        accessible(page)
        page.locator("#file").set_input_files(EXAMPLES / "drawings" / "pyjigsaw_4x5.svg")
        page.locator(".findings").wait_for()
        accessible(page)
        for words in ("Fix ", "Use a gap of"):
            page.locator(".findings .button.main", has_text=words).click()
        page.locator("#answer[data-settled=true]").wait_for()
        page.locator(".stage canvas").focus()
        page.keyboard.press(".")
        page.locator(".headline .explain button").click()
        accessible(page)
        for tab in page.get_by_role("tab").all():
            tab.click()
            accessible(page)
        page.locator(".savebutton").click()
        accessible(page)
        page.keyboard.press("Escape")
        page.keyboard.press("?")
        accessible(page)


LONG = "оченьдлинноеимя_{}_非常に長い部品名_without_any_space_in_it_at_all"
OVERLAPPING = """() => {
    const shown = (e) => { const r = e.getBoundingClientRect(); return r.width > 1 && r.height > 1 && !e.closest('.unseen'); };
    const seen = (e) => {
        let { left, top, right, bottom } = e.getBoundingClientRect();
        for (let p = e.parentElement; p; p = p.parentElement) {
            if (getComputedStyle(p).overflowX === 'visible') continue;
            const q = p.getBoundingClientRect();
            [left, top] = [Math.max(left, q.left), Math.max(top, q.top)];
            [right, bottom] = [Math.min(right, q.right), Math.min(bottom, q.bottom)];
        }
        return [left, top, right, bottom];
    };
    const all = [...document.querySelectorAll('.stage, .topbar > *, .said > *, .work, .selection > *, .player .group > *, ' +
        '.notices > *, .gapbox > *, .gapcurve input, .tabs > *, .panel :is(button, input, select, h2, .name, .step)')].filter(shown);
    const found = [];
    all.forEach((a, i) => all.slice(i + 1).forEach((b) => {
        if (a.contains(b) || b.contains(a)) return;
        const [p, q] = [seen(a), seen(b)];
        const wide = Math.min(p[2], q[2]) - Math.max(p[0], q[0]);
        const high = Math.min(p[3], q[3]) - Math.max(p[1], q[1]);
        if (wide > 1.5 && high > 1.5) found.push([a.outerHTML.slice(0, 80), b.outerHTML.slice(0, 80)]);
    }));
    const out = (e) => e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('.selection, .tabs, .scroll');
    const cut = (e) => e.scrollWidth > e.clientWidth + 1;
    found.push(...[...document.querySelectorAll('.scroll, .sorts td')].filter(shown).filter(cut).map((e) => e.outerHTML.slice(0, 80)));
    found.push(...all.filter(out).map((e) => e.outerHTML.slice(0, 80)));
    return found;
}"""


def test_nothing_overlaps_whatever_the_names(browser: Any, tmp_path: Path) -> None:
    """640 x 360 is 1280 x 720 at 200 %."""
    text = (EXAMPLES / "02_chain_of_tees" / "chain.json").read_text()
    for part in json.loads(text)["parts"]:
        text = text.replace(json.dumps(part["name"]), json.dumps(LONG.format(part["name"])))
    path = tmp_path / f"{LONG.format('file')}.json"
    path.write_text(text, encoding="utf-8")
    with serving(path) as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        page.locator(".stage canvas").focus()
        for _ in range(3):
            page.keyboard.press(".")
        for wide, high in ((1280, 720), (1440, 900), (2560, 1440), (390, 844), (640, 360)):
            page.set_viewport_size({"width": wide, "height": high})
            for tab in page.get_by_role("tab").all():
                tab.click()
                page.wait_for_timeout(80)
                assert page.evaluate(OVERLAPPING) == []
                assert page.evaluate("document.scrollingElement.scrollWidth") <= wide
                assert canvas(page)["height"] >= 150


def test_on_a_magnified_screen_answer_gap_and_question_are_in_sight(browser: Any) -> None:
    """1280 x 720, 1440 x 900, 1600 x 900 and 1920 x 1080 at 200 %."""
    hidden = """(what) => [...document.querySelectorAll(what)].filter((e) => {
        const { top, bottom } = e.getBoundingClientRect();
        return top < 0 || bottom > innerHeight + 1;
    }).map((e) => e.outerHTML.slice(0, 80))"""
    with serving(EXAMPLES / "02_chain_of_tees" / "chain.json") as served, visiting(browser, served) as page:
        for wide, high in ((640, 360), (720, 450), (800, 450), (960, 540)):
            page.set_viewport_size({"width": wide, "height": high})
            page.reload()  # at the top, whatever was looked at before
            page.locator("#answer[data-settled=true]").wait_for()
            page.wait_for_timeout(300)
            assert page.evaluate(hidden, "#answer, .gapbox > *, #gap, [role=tab], .player") == []
            page.get_by_role("tab", name="Answer").click()
            page.wait_for_timeout(100)
            assert page.evaluate(hidden, ".panel") == []
            assert page.evaluate(OVERLAPPING) == []


def test_the_clearance_of_two_edges_is_measured(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        rest, box = at_rest(page), canvas(page)
        page.get_by_label("place on the path from rest").fill("0")
        still(page)
        page.locator(".stage canvas").focus()
        page.keyboard.press("m")
        for x in (-4.5, -5.5):  # the peg's left side, and the hole's
            page.mouse.click(box["x"] + rest[0] + x * scale, box["y"] + rest[1])
        page.locator(".measure text", has_text=re.compile(r"^1 mm$")).wait_for()
        page.get_by_label("place on the path from rest").fill("1000")
        page.locator(".measure text", has_text=re.compile(r"^(2|1[.]99[0-9]*) mm$")).wait_for()
        page.keyboard.press("Escape")
        page.locator(".measure").wait_for(state="hidden")


def test_many_parts_are_chosen_by_a_line_round_them(browser: Any) -> None:
    with serving(EXAMPLES / "02_chain_of_tees" / "chain.json") as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        box = canvas(page)
        page.locator(".stage canvas").focus()
        page.keyboard.press("l")
        corners = [(0.02, 0.02), (0.98, 0.02), (0.98, 0.98), (0.02, 0.98)]
        places = [(box["x"] + u * box["width"], box["y"] + v * box["height"]) for u, v in corners]
        page.mouse.move(*places[0])
        page.mouse.down()
        for x, y in places[1:]:
            page.mouse.move(x, y, steps=4)
        page.mouse.up()
        toolbar = page.get_by_role("toolbar", name="10 parts")
        toolbar.get_by_role("textbox").fill("0.002")
        toolbar.get_by_role("textbox").press("Enter")
        page.get_by_role("tab", name="Gaps").click()
        boxes = page.locator("table.parts").get_by_role("textbox")
        assert [one.input_value() for one in boxes.all()] == ["0.002"] * 10
        page.keyboard.press("Escape")
        page.keyboard.press("Escape")


def test_a_link_carries_the_design(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.evaluate(
            "Object.defineProperty(navigator, 'clipboard', {value: {writeText: async (t) => { window.copied = t; }}})"
        )
        page.get_by_role("button", name=re.compile("chain", re.IGNORECASE)).click()
        page.locator("#answer[data-settled=true]").wait_for()
        box = page.locator(".gapbox").get_by_role("textbox")
        box.fill("0.3")
        box.press("Enter")
        page.locator("#answer[data-settled=true]").wait_for()
        page.locator(".savebutton").click()
        page.get_by_role("menuitem", name="Copy a link").click()
        link = page.evaluate("copied")
        assert "token" not in link
        page.evaluate("sessionStorage.removeItem('wiggleroom.file'); sessionStorage.removeItem('wiggleroom.design')")
        page.goto("about:blank")
        other = page.context.new_page()  # of the same browser
        for tab, lead in ((page, lambda: page.goto(link)), (other, lambda: other.goto(link)), (other, other.reload)):
            lead()
            tab.locator("#answer[data-settled=true]").wait_for()
            assert tab.locator(".gapbox").get_by_role("textbox").input_value() == "0.3"


def test_the_reach_of_a_part_is_shaded_before_it_is_dragged(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        scale = pixels_per_mm(page)
        rest, box = at_rest(page), canvas(page)
        page.mouse.click(box["x"] + rest[0], box["y"] + rest[1] + 2 * scale)
        page.locator(".reach path").wait_for(state="attached")
        shaded = page.locator(".reach path").bounding_box()
        assert shaded["width"] / scale == pytest.approx(2, abs=0.1)  # 1 mm to either side
        assert "free at" in page.locator(".selection").inner_text()


def test_what_should_be_tighter_and_gaps_at_random(browser: Any) -> None:
    path = EXAMPLES / "02_chain_of_tees" / "chain.json"
    with serving(path) as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        page.get_by_role("tab", name="Vary").click()
        page.get_by_role("button", name="Find them").click()
        page.locator(".result", has_text="Make these tighter").wait_for()
        draws = page.get_by_role("textbox", name="tries")
        draws.fill("12")
        draws.press("Enter")
        page.get_by_role("button", name="Try random gaps", exact=True).click()
        page.locator(".result", has_text="12 draws").wait_for()
        assert page.locator(".plot svg").count() >= 1


def test_undo_goes_back_beyond_a_reload(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".gapbox").get_by_role("textbox").fill("2")
        page.keyboard.press("Enter")
        answered(page, "peg moves 2 mm")
        page.reload()
        answered(page, "peg moves 2 mm")
        page.get_by_role("button", name="Undo").click()
        answered(page, "peg moves 1 mm")
        page.get_by_role("button", name="Redo").click()
        answered(page, "peg moves 2 mm")


def test_a_search_goes_on_beyond_the_climb_and_studies_speak_of_what_is_shown(browser: Any, tmp_path: Path) -> None:
    pytest.importorskip("highspy")
    path = tmp_path / "corridor.json"
    path.write_text(write_assembly(corridor(gap=0.01).drawing))
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "slider moves 2.06 mm in +y")  # a climb from rest ends at 0.16
        page.get_by_role("tab", name="How sure").click()
        page.locator(".sure", has_text=re.compile("starts?,|1 start")).first.wait_for()
        page.get_by_role("tab", name="Vary").click()
        draws = page.get_by_role("textbox", name="tries")
        draws.fill("4")
        draws.press("Enter")
        page.get_by_role("button", name="Try random gaps", exact=True).click()
        row = page.locator(".result tr", has_text="without variation")
        row.wait_for()
        assert "2.06" in row.inner_text()
        answered(page, "slider moves 2.06 mm in +y")


def test_a_sheet_is_put_together_before_anything_is_asked_of_it(browser: Any) -> None:
    pytest.importorskip("manifold3d")
    with serving(None) as served, visiting(browser, served) as page:
        page.locator(".sample", has_text="sheet").click()
        page.locator("#answer", has_text="nothing asked").wait_for()
        assert page.locator(".findings").count() == 0
        page.get_by_role("button", name="Put them together").click()
        page.get_by_role("button", name="Assemble").click()
        page.locator("#assembled", has_text="5 of 5 panels placed, sure").wait_for()


def held_back(kinds: set[str]) -> Any:
    """A handler of web sockets that keeps the replies of some kinds from the page: what was asked goes on."""

    def between(line: Any) -> None:
        server, frames = line.connect_to_server(), []

        def pass_on(said: str | bytes) -> None:
            frames.append(said)
            if isinstance(said, str):  # frames come before the text that they belong to
                for one in [] if json.loads(said)["kind"] in kinds else frames:
                    line.send(one)
                frames.clear()

        server.on_message(pass_on)

    return between


def test_a_file_that_cannot_be_opened_leaves_what_is_open_with_its_mends(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "loose.json"
    path.write_text(json.dumps(PEG | {"parts": [part | {"fixed": False} for part in PEG["parts"]]}))  # type: ignore[attr-defined]
    with serving(path) as served, visiting(browser, served) as page:
        page.locator(".findings").get_by_role("button", name=re.compile("^Fix ")).wait_for()
        before = page.locator(".findings").inner_text()
        page.set_input_files("#file", {"name": "broken.svg", "mimeType": "image/svg+xml", "buffer": b"<svg>"})
        refused = page.get_by_role("alert", name="what could not be opened")
        refused.get_by_text("broken.svg").wait_for()
        assert page.locator(".findings").nth(1).inner_text() == before
        refused.get_by_role("button", name="Close").click()
        page.locator(".findings").get_by_role("button", name=re.compile("^Fix ")).click()
        answered(page, "peg moves 1 mm in +x")
        assert page.locator(".findings").count() == 0


def test_the_curve_has_no_points_of_another_question(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        late = Late(page, {"step", "sweep"})
        page.goto(f"http://127.0.0.1:{peg.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm in +x")
        page.get_by_role("button", name="Sweep", exact=True).click()
        until(page, lambda: len(late.held) > 3, "no sweep")
        page.get_by_label("direction of the pull on peg").fill("45")
        page.keyboard.press("Enter")
        answered(page, "peg moves 1.414 mm")
        late.go()
        assert settled(page, lambda: page.locator(".curve .dot").count()) == 1
        assert page.get_by_role("button", name="Sweep", exact=True).is_enabled()


def test_a_path_out_of_an_earlier_design_is_not_played_unasked(browser: Any) -> None:
    with serving(EXAMPLES / "17_does_it_come_apart" / "sequential.json") as served, visiting(browser, served) as page:
        late = Late(page, {"check"})
        page.goto(f"http://127.0.0.1:{served.port}/?token={TOKEN}")
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_role("button", name="Check", exact=True).click()
        until(page, lambda: len(late.held) > 0, "no answer")
        gap = page.get_by_label("gap, mm", exact=True)
        gap.fill(str(2 * float(gap.input_value())))
        page.keyboard.press("Enter")
        settled(page, lambda: page.locator("#answer").inner_text())
        before = page.locator("#answer").inner_text()
        late.go()
        page.locator(".result.old", has_text="said of an earlier design").wait_for()
        assert page.locator("#answer").inner_text() == before
        page.get_by_role("button", name="Play the path out of").first.click()
        page.locator(".facts", has_text="of an earlier design").wait_for()


SIZES = ((1280, 720), (1440, 900), (390, 844))


def test_much_work_at_once_leaves_the_picture_where_it_is(browser: Any, peg: Served) -> None:
    with visiting(browser, peg) as page:
        page.route_web_socket(re.compile("/socket"), held_back({"study", "rank", "check", "sweep", "step", "progress"}))
        page.goto(f"http://127.0.0.1:{peg.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm")
        settled(page, lambda: canvas(page))

        def looks() -> list[Any]:
            found = []
            for width, height in SIZES:
                page.set_viewport_size({"width": width, "height": height})
                page.evaluate(LATER)
                found.append((canvas(page), page.locator(".headline").bounding_box()))
            page.set_viewport_size({"width": 1440, "height": 900})
            return found

        for tab in ("Come apart", "Gaps", "Vary"):
            page.get_by_role("tab", name=tab).click()
        before = looks()
        page.get_by_role("button", name="Sweep", exact=True).click()
        page.get_by_role("button", name="Find them").click()
        page.get_by_role("button", name="Try random gaps", exact=True).click()
        page.get_by_role("tab", name="Gaps").click()
        page.get_by_role("button", name="Rank", exact=True).click()
        page.get_by_role("tab", name="Vary").click()
        page.locator(".work .waiting", has_text="3 more wait").wait_for()
        assert looks() == before
        title = page.locator(".work .waiting").get_attribute("title")
        assert title is not None
        assert len(title.split(", ")) == 3
        page.locator(".work").get_by_role("button", name="cancel").click()
        page.locator(".work .waiting", has_text="2 more wait").wait_for()


def test_what_does_not_move_is_not_enlarged(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "tight.json"
    path.write_text(json.dumps(PEG | {"gap": 1e-4}))
    with serving(path) as served, visiting(browser, served) as page:
        answered(page, "peg moves 0.0001 mm")
        assert page.locator(".player").get_by_role("button", name=re.compile("^Enlarge")).count() == 0
        assert "motion" not in page.locator(".headline").inner_text()


def test_on_a_phone_arrows_and_what_is_to_be_mended_are_seen_whole(browser: Any, tmp_path: Path) -> None:
    text = (EXAMPLES / "02_chain_of_tees" / "chain.json").read_text()
    for part in json.loads(text)["parts"]:
        text = text.replace(json.dumps(part["name"]), json.dumps(LONG.format(part["name"])))
    told = json.loads(text)
    last = told["parts"][-1]
    shape = told["shapes"][last["shape"]] if "shape" in last else last
    right = max(shape["outline"])
    path = tmp_path / "chain.json"
    for where, out in (((1, 0), right), ((-1, 0), min(shape["outline"]))):
        point = [a + b for a, b in zip(out, last["at"], strict=False)]
        path.write_text(json.dumps(told | {"pull": [{"part": last["name"], "direction": where, "point": point}]}))
        with serving(path) as served, visiting(browser, served) as page:
            page.set_viewport_size({"width": 390, "height": 844})
            page.locator("#answer[data-settled=true]").wait_for()
            box, head = canvas(page), page.locator(".pull polygon.head").bounding_box()
            assert box["x"] <= head["x"]
            assert head["x"] + head["width"] <= box["x"] + box["width"]
    for part in told["parts"]:
        part.pop("fixed", None)
    path.write_text(json.dumps({key: value for key, value in told.items() if key != "pull"} | {"gap": 0}))
    with serving(path) as served, visiting(browser, served) as page:
        page.set_viewport_size({"width": 390, "height": 844})
        page.locator(".findings .button.main").first.wait_for()
        for each in page.locator(".findings :is(p, .button), .likely .button").all():
            box = each.bounding_box()
            assert box["x"] + box["width"] <= 390
            assert each.evaluate("(e) => e.scrollWidth <= e.clientWidth + 1")
