"""The one-file report: complete, escaped, without requests; in a real browser where there is one."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wiggleroom as wr
from tests.answers import answer, block, grid, row
from wiggleroom.drawing.model import Part, Pull
from wiggleroom.report.draw import draw
from wiggleroom.report.html import film_section, report
from wiggleroom.report.page import Section, figure, page, table
from wiggleroom.report.picture import picture

NASTY = "<img src=x onerror=alert(1)></script><b>&\"'"


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
    seen = tags(report(case))
    assert not {"img", "b", "iframe", "object", "base", "form"} & {tag for tag, _ in seen}
    assert sum(tag == "script" for tag, _ in seen) == 2  # the film's data, and the code
    for tag, given in seen:
        assert not [k for k in given if k.startswith("on")]
        assert "src" not in given
        for kind in ("href", "xlink:href"):
            assert (given.get(kind) or "#").startswith(("#", "data:,")), tag


def test_all_ids_are_used_once() -> None:
    case = row()
    films = [film_section(case.assembly, case.waypoints, "a way", key=key) for key in "fg"]
    seen = tags(page("t", [], [Section("Picture", figure(picture(case))), *films]))
    ids = [given["id"] for _, given in seen if "id" in given]
    assert sum("class" in given and given["class"] == "film" for _, given in seen) == 2
    assert len(ids) == len(set(ids))


def test_it_says_everything() -> None:
    html = report(row())
    for said in (
        "b5 moves 0.3 mm in +y",
        "optimal",
        "wiggleroom flex it.json",
        "b1 | b2",
        "not worked out",
    ):
        assert said in html
    assert "Whose gap" not in html  # this answer was made by hand: nothing is known about its walls


def test_numbers_keep_their_full_value_for_sorting() -> None:
    html = table(["part", "mm"], [["a", 1.23456789], ["b", 0.001], ["c", 1e-30]])
    assert 'data-v="1.23456789">1.235<' in html
    assert ">0.000<" in html
    odd = table(["mm"], [[float("nan")], [float("inf")], [1.0]])
    assert '"-Infinity">–<' in odd
    assert '"Infinity">∞<' in odd
    assert "none" in table(["part"], [])
    assert "and 3 more" in table(["n"], [[k] for k in range(5)], most=2)


@pytest.mark.slow
def test_the_slider_moves_the_parts(opened: Any) -> None:
    case = row(3, lift=0.5)
    at = opened(report(case), reduced_motion="reduce")
    place = "() => [...document.querySelectorAll('.film .moves')].map(g => g.getAttribute('transform'))"
    rest = at.evaluate(place)
    at.locator(".film input").fill("1000")
    end = at.evaluate(place)
    numbers = [
        np.array([[float(v) for v in re.findall(r"-?[\d.]+(?:e-?\d+)?", t)] for t in state]) for state in (rest, end)
    ]
    bar = re.search(r"v5h([\d.]+)v-5.*?>([\d.]+) mm<", report(case))
    assert bar
    scale = float(bar[1]) / float(bar[2])
    lift = (numbers[0] - numbers[1])[:2, 1] / scale
    np.testing.assert_allclose(lift, [0.25, 0.5], rtol=0.01)
    assert at.locator(".film output").text_content() == "100 %"


@pytest.mark.slow
def test_it_plays_and_pauses(opened: Any) -> None:
    at = opened(report(row(3)))
    at.wait_for_timeout(1500)
    assert int(at.locator(".film input").input_value()) > 100
    at.locator(".film button").click()
    value = at.locator(".film input").input_value()
    at.wait_for_timeout(200)
    assert at.locator(".film input").input_value() == value


@pytest.mark.slow
def test_columns_sort_by_their_values(opened: Any) -> None:
    rows = [["b10", 9.0], ["b2", 10.0], ["b1", -3.0], ["b3", float("nan")], ["b4", float("inf")]]
    at = opened(page("t", [], [Section("s", table(["part", "mm"], rows))]))
    first = "() => [...document.querySelectorAll('tbody tr')].map(r => r.cells[0].textContent)"
    at.locator("th button").nth(1).click()
    assert at.evaluate(first) == ["b4", "b2", "b10", "b1", "b3"]
    at.locator("th button").nth(1).click()
    assert at.evaluate(first) == ["b3", "b1", "b10", "b2", "b4"]
    at.locator("th button").nth(0).click()
    assert at.evaluate(first) == ["b1", "b2", "b3", "b4", "b10"]


@pytest.mark.slow
def test_names_are_text_in_the_browser(opened: Any) -> None:
    at = opened(report(nasty()))
    assert at.locator("img").count() == 0
    assert NASTY in at.locator("tbody td").first.text_content()
    assert at.title() == at.locator("h1").text_content()


@pytest.mark.slow
def test_it_is_dark_in_the_dark_and_prints_light(opened: Any) -> None:
    ground = "() => getComputedStyle(document.body).backgroundColor"
    paper = "() => getComputedStyle(document.querySelector('figure svg > rect')).fill"
    at = opened(report(row(3)), color_scheme="dark", viewport={"width": 400, "height": 800})
    assert at.evaluate(ground) == "rgb(13, 17, 23)"
    assert at.evaluate(paper) == "rgb(22, 27, 34)"
    assert at.evaluate("() => document.documentElement.scrollWidth") <= 400
    at.emulate_media(media="print", color_scheme="dark")
    assert at.evaluate(ground) == at.evaluate(paper) == "rgb(255, 255, 255)"
    assert not at.locator(".film").is_visible()


@pytest.mark.slow
def test_a_moving_svg_moves_in_the_browser(browser: Any, tmp_path: Path) -> None:
    draw(row(3, lift=0.5), tmp_path / "way.film.svg")
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


def test_a_picture_on_a_page_keeps_no_declaration() -> None:
    assert (
        figure('<?xml version="1.0"?>\n<svg></svg>', "a < b")
        == "<figure><svg></svg><figcaption>a &lt; b</figcaption></figure>"
    )
