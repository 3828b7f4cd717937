"""The page of an answer in one file: complete, escaped, without requests; in a real browser where there is one."""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wiggleroom as wr
from tests.answers import answer, block, grid, row
from tests.page_waits import plays, settled, until
from tests.standalone import frames, told
from wiggleroom.assembly.assembly import place, rings_at
from wiggleroom.drawing.model import Part, Pull
from wiggleroom.report.page.pages import page_of_answer
from wiggleroom.report.write_picture import write_picture
from wiggleroom.search.answer import Bound

NASTY = "<img src=x onerror=alert(1)></script><b>&\"'"
QUIET = {
    "Play", "Pause", "Zoom out", "Zoom in", "Fit the drawing", "Keys and help", "Copy the command", "Close",
    "Measure: press two edges or corners", "what does optimal mean?",
}  # fmt: skip
"""Buttons that need no server."""


def nasty() -> wr.Answer:
    parts = [Part("fixed" + NASTY, (block(),), fixed=True), Part(NASTY, (block(),), (1.2, 0.0, 0.0))]
    touch = wr.Contact((parts[0].name, NASTY), (0.5, 0.0), (1.0, 0.0), 0.7)
    goal = (Pull(NASTY, (0, 1)),)
    return answer(parts, [(0, 0, 0), (0, 0.3, 0.1)], goal, 0.3, (touch,), command=f"wiggleroom flex '{NASTY}'")


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))


def tags(html: str) -> list[tuple[str, dict[str, str | None]]]:
    parser = Tags()
    parser.feed(html)
    return parser.seen


@pytest.mark.parametrize("case", [row(), nasty(), grid(8)], ids=["row", "nasty", "grid"])
def test_nothing_is_asked_of_any_network_and_nothing_slips_in(case: wr.Answer) -> None:
    html = page_of_answer(case)
    seen = tags(html)
    assert not {"img", "b", "iframe", "object", "base", "form"} & {tag for tag, _ in seen}
    assert sum(tag == "script" for tag, _ in seen) == 2  # what is told, and the code
    for tag, given in seen:
        assert not [k for k in given if k.startswith("on")]
        assert "src" not in given
        assert (given.get("href") or "#").startswith(("#", "data:,")), tag


def test_only_its_own_code_may_run() -> None:
    html = page_of_answer(nasty())
    (code,) = re.findall(r'<script type="module">(.*?)</script>', html, re.DOTALL)
    own = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
    policy = next(given["content"] for tag, given in tags(html) if given.get("http-equiv"))
    assert policy is not None
    assert f"script-src 'sha256-{own}'" in policy
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy


def test_it_carries_the_answer_as_it_is() -> None:
    case = wr.flex(wr.patterns.chain(3, joint="swallowtail", gap=0.02), search=0)
    page = told(page_of_answer(replace(case, command="wiggleroom flex it.json")))
    (one,) = page["answers"]
    flex = one["flex"]
    assert flex["objective"] == case.objective
    assert flex["command"] == "wiggleroom flex it.json"
    assert len(flex["contacts"]) == sum(c.force > 0 for c in case.contacts)
    path = frames(one["path"])
    np.testing.assert_allclose(path[0], case.waypoints[0], atol=1e-12)
    np.testing.assert_allclose(path[-1], case.motion, rtol=1e-6, atol=1e-9)
    assert page["opened"]["design"]["goals"][0]["part"] == "b3"
    again = wr.rank(case.assembly, by="differences", workers=1)  # whose gap matters is said by the answer's own forces
    for name, value in zip(case.assembly.names, again.looser, strict=True):
        assert page["rank"]["parts"][name]["mm_per_mm"] == pytest.approx(value, rel=2e-2, abs=1e-4)


def test_whose_gap_matters_is_said_only_where_it_is_known() -> None:
    assert "rank" not in told(page_of_answer(row()))  # made by hand: nothing is known about its walls
    free = wr.flex(wr.patterns.chain(2, joint="swallowtail", gap=0.1), search=0)
    assert free.objective is None
    assert "rank" not in told(page_of_answer(free))
    assert "rank" not in told(page_of_answer(wr.flex(wr.patterns.chain(2, gap=0.02), model="hull")))


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_outlines_stand_where_the_parts_are(turn: float) -> None:
    parts = [Part("plate", (block(6.0, hole=2.0),), (300.0, -20.0, turn), fixed=True), Part("peg", (block(1.8),))]
    page = told(page_of_answer(answer(parts, [(0, 0, 0), (0, 0.1, 0)], (Pull("peg", (0, 1)),), 0.1)))
    outlines = page["opened"]["outlines"]
    for part, own, which in zip(parts, page["opened"]["parts"], outlines["of"], strict=True):
        x, y, degrees = own["at"]
        for ring, truth in zip(outlines["shapes"][which], rings_at(part), strict=True):
            np.testing.assert_allclose(place(np.array(ring), (x, y, np.radians(degrees))), truth, atol=1e-4)


@pytest.mark.parametrize(
    ("bound", "most", "said"),
    [
        (None, None, "not worked out"),
        (Bound(0.303, 0.01, 2.04), 0.303, "between 0.3000 and 0.3030 mm, proven, within 1 % of the answer, in 2.0 s"),
        (Bound(None, None, 1.0, "b2 can go without end"), None, "no bound: b2 can go without end"),
    ],
)
def test_what_was_proven_is_said(bound: Bound | None, most: float | None, said: str) -> None:
    page = told(page_of_answer(replace(row(), bound=bound, at_most=most)))
    flex = page["answers"][0]["flex"]
    assert dict(flex["sure"])["at most"] == said
    assert ("proven" in " ".join(flex["facts"])) == (most is not None)


def parts_at(page: Any) -> list[list[str]]:
    """Cells of the table of all parts."""
    table = page.locator(".section", has=page.get_by_role("heading", name="How far each part goes")).locator("tbody tr")
    return [cells.locator("td").all_inner_texts() for cells in table.all()]


def foot(page: Any) -> tuple[float, float]:
    """Where the arrow of the pull stands on the canvas [px]."""
    base = page.locator(".pull .base").first
    return settled(page, lambda: (float(base.get_attribute("cx")), float(base.get_attribute("cy"))))


@pytest.mark.slow
def test_a_reader_sees_all_of_the_answer(opened: Any) -> None:
    at = opened(page_of_answer(replace(row(), bound=Bound(0.303, 0.01, 2.0), at_most=0.303)))
    assert at.locator("#answer").inner_text() == "b5 moves 0.3 mm in +y"
    for said in ("optimal", "gap 0.1 mm", "5 parts", "proven", "path from rest checked"):
        assert said in at.locator(".headline .facts").inner_text()
    assert at.locator("tbody tr", has_text="b1 | b2").inner_text().split() == ["b1", "|", "b2", "0.5000", "0", "0.7000"]
    assert parts_at(at)[0] == ["b5", "0", "0.3000", "2.292", "0.3000"]
    assert at.locator(".command").inner_text() == "wiggleroom flex it.json"
    at.get_by_role("tab", name="How sure").click()
    assert "between 0.3000 and 0.3030 mm, proven" in at.locator(".sure").inner_text()
    said = {b.get_attribute("aria-label") or b.inner_text() for b in at.locator("button:not([role=tab]):visible").all()}
    assert {s for s in said if not s.startswith("Colours")} <= QUIET  # no button that needs the server
    assert at.locator("input:visible").count() == 1  # the place on the path


@pytest.mark.slow
def test_the_slider_moves_the_parts_by_what_was_found(opened: Any) -> None:
    case = row(3, lift=0.5)
    at = opened(page_of_answer(case), reduced_motion="reduce")
    moved = foot(at)
    at.get_by_label("place on the path from rest").fill("0")
    rest = foot(at)
    at.get_by_label("place on the path from rest").fill("500")
    half = foot(at)
    assert rest[0] == pytest.approx(moved[0], abs=0.1)
    assert rest[1] - half[1] == pytest.approx((rest[1] - moved[1]) / 2, rel=1e-3)
    assert rest[1] - moved[1] > 30


@pytest.mark.slow
def test_it_plays_and_pauses(opened: Any) -> None:
    at = opened(page_of_answer(row(3)))
    place = at.get_by_label("place on the path from rest")
    at.get_by_role("button", name="Play").click()
    plays(at)
    at.get_by_role("button", name="Pause").click()
    value = place.input_value()
    at.wait_for_timeout(200)
    assert place.input_value() == value


@pytest.mark.slow
def test_columns_sort_by_their_values(opened: Any) -> None:
    parts = [Part(f"b{k}", (block(0.9),), (1.2 * k, 0.0, 0.0), fixed=k == 1) for k in (1, 2, 10, 3)]
    motion = [(0.0, 0.0, 0.0), (-3.0, 4.0, 0.0), (9.0, 0.0, 0.1), (0.01, 0.0, 0.2)]
    at = opened(page_of_answer(answer(parts, motion, (Pull("b10", (1, 0)),), 9.0)))
    assert [cells[0] for cells in parts_at(at)] == ["b10", "b2", "b3", "b1"]  # the farthest first

    def by(head: str) -> list[str]:
        at.locator("th button", has_text=head).click()
        return [cells[0] for cells in parts_at(at)]

    assert by("dx mm") == ["b10", "b3", "b1", "b2"]
    assert by("dx mm") == ["b2", "b1", "b3", "b10"]
    assert by("part") == ["b1", "b2", "b3", "b10"]
    assert at.locator("th[aria-sort=ascending]").inner_text().startswith("part")
    assert parts_at(at)[1][1:3] == ["-3.000", "4"]


@pytest.mark.slow
def test_names_are_text_in_the_browser(opened: Any) -> None:
    at = opened(page_of_answer(nasty()))
    assert at.locator("img").count() == 0
    assert at.title() == at.locator("#answer").text_content()
    assert NASTY in at.locator(".command").text_content()
    assert at.locator(f'[title="{NASTY.replace(chr(34), chr(92) + chr(34))}"]').count() > 0


@pytest.mark.slow
def test_it_fits_a_phone_is_dark_in_the_dark_and_prints_light_and_whole(opened: Any) -> None:
    ground = "() => getComputedStyle(document.body).backgroundColor"
    corner = """() => { const g = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
        g.drawImage(document.querySelector('canvas'), -3, -3);
        return [...g.getImageData(0, 0, 1, 1).data].slice(0, 3); }"""
    at = opened(page_of_answer(row(3)), color_scheme="dark", viewport={"width": 400, "height": 800})
    until(at, lambda: at.evaluate(ground) == "rgb(18, 22, 27)", "the page is not dark")
    until(at, lambda: at.evaluate(corner) == [18, 22, 27], "the drawing is not dark")
    assert at.evaluate("() => document.documentElement.scrollWidth") <= 400
    assert not at.locator(".sure").is_visible()
    at.emulate_media(media="print", color_scheme="dark")
    until(at, lambda: at.evaluate(ground) == "rgb(255, 255, 255)", "the page is not light")
    until(at, lambda: at.evaluate(corner) == [255, 255, 255], "the drawing is not light")
    assert at.locator(".sure").is_visible()  # no tabs on paper
    assert at.locator(".command").is_visible()
    assert not at.get_by_label("place on the path from rest").is_visible()


@pytest.mark.slow
def test_a_moving_svg_moves_in_the_browser(browser: Any, tmp_path: Path) -> None:
    write_picture(row(3, lift=0.5), tmp_path / "way.film.svg")
    at = browser.new_page()
    at.goto((tmp_path / "way.film.svg").as_uri())
    where = """t => {
      const s = document.documentElement, names = [...s.querySelectorAll('use title')];
      s.pauseAnimations();
      s.setCurrentTime(t);
      return names.filter(x => x.textContent === 'b3')[0].parentNode.getBoundingClientRect().y;
    }"""
    rest, moved = at.evaluate(where, 0.1), at.evaluate(where, 3.2)
    at.close()
    assert moved < rest - 20
