"""Pictures and pages of studies say what the studies found, and nothing else gets in."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import wiggleroom as wr
from tests.test_html import tags
from tests.test_plots import all_of, axis
from wiggleroom.report import palette, study_pages
from wiggleroom.report.apart_page import Checked, page_of_check
from wiggleroom.report.blame import picture_of_ranking, picture_of_tightening, shade
from wiggleroom.report.html import report
from wiggleroom.report.study_plots import picture_of_sample, picture_of_sweep

PAGES = {
    wr.Ranking: study_pages.page_of_ranking,
    wr.Tightening: study_pages.page_of_tightening,
    wr.Sweep: study_pages.page_of_sweep,
    wr.Sample: study_pages.page_of_sample,
}
NASTY = "<img src=x onerror=alert(1)></script>"


def named(assembly: wr.Assembly, part: str, name: str) -> wr.Assembly:
    """The same assembly, one part with another name."""
    drawing = assembly.drawing
    parts = tuple(replace(p, name=name) if p.name == part else p for p in drawing.parts)
    goals = tuple(replace(g, part=name) if g.part == part else g for g in drawing.goals)
    return wr.assemble(replace(drawing, parts=parts, goals=goals))


@pytest.fixture(scope="module")
def studies() -> dict[type, Any]:
    """One of each about two swallowtails, which come apart at a gap of about 0.0603."""
    pair = named(wr.patterns.chain(2, joint="swallowtail", gap=0.02), "b2", NASTY)
    chain = wr.patterns.chain(4, joint="tee", gap=0.02)
    found = (
        wr.rank(wr.flex(chain)),
        wr.tighten(chain, parts=1, draws=6, workers=1),
        wr.sweep(pair, [0.01, 0.03, 0.05, 0.07]),
        wr.sample(pair, 0.002, draws=60, limit=0.07, workers=1),
    )
    return {type(f): f for f in found}


def row_of(page: str, first: str) -> list[str]:
    """Cells of the row of a table that begins with `first`."""
    line = re.search(rf"<tr><td[^>]*>{re.escape(first)}</td>(.*?)</tr>", page)
    assert line, first
    return re.findall(r">([^<]*)</td>", line[1])


def test_the_curve_goes_through_what_was_found_and_ends_where_it_is_lost(studies: dict[type, Any]) -> None:
    found = studies[wr.Sweep]
    svg = picture_of_sweep(found, command="wiggleroom sweep it")
    dots = np.array([[float(c.get("cx", "0")), float(c.get("cy", "0"))] for c in all_of(svg, "circle")])
    (kx, x0), (ky, y0) = axis(svg, of_x=True), axis(svg, of_x=False)
    held = [s for s in found.steps if s.objective is not None]
    assert len(held) == 3
    np.testing.assert_allclose((dots[:, 0] - x0) / kx, [s.gap for s in held], atol=1e-4)
    np.testing.assert_allclose((dots[:, 1] - y0) / ky, [s.objective for s in held], atol=1e-3)
    (line,) = [p.get("d", "") for p in all_of(svg, "path") if p.get("stroke-dasharray")]
    assert 0.0600 <= (float(line[1:].split(",")[0]) - x0) / kx <= 0.0606  # known from the joint alone
    assert "wiggleroom sweep it" in svg


def test_the_histogram_has_every_draw_and_the_limit(studies: dict[type, Any]) -> None:
    found = studies[wr.Sample]
    svg = picture_of_sample(found)
    up, _ = axis(svg, of_x=False)
    boxes = [r for r in all_of(svg, "rect") if r.get("stroke")]
    red = sum(float(r.get("height", "0")) for r in boxes if r.get("fill") == palette.FIXED[0]) / -up
    assert red == pytest.approx((found.value > found.limit).sum(), abs=0.05)
    assert sum(float(r.get("height", "0")) for r in boxes) / -up == pytest.approx(60, abs=0.1)
    assert f"{100 * found.yields[0]:.1f} % keep 0.07 mm" in svg
    assert "limit 0.07" in svg


def test_draws_without_an_end_are_said_not_drawn(studies: dict[type, Any]) -> None:
    found = studies[wr.Sample]
    value = found.value.copy()
    value[:5], value[5:8] = np.inf, np.nan
    odd = replace(found, value=value)
    for text in (picture_of_sample(odd), study_pages.page_of_sample(odd)):
        assert re.search(r"in 5 (draws )?nothing stops the motion", text)
        assert re.search(r"in 3 (draws )?parts do not fit", text)
        assert not re.search(r"\b(nan|inf)\b", text)
    none = replace(found, value=np.full(60, np.nan))
    assert "50 % below" not in picture_of_sample(none)
    study_pages.page_of_sample(none)


def test_parts_are_coloured_by_their_numbers(studies: dict[type, Any]) -> None:
    ranking = studies[wr.Ranking]
    svg = picture_of_ranking(ranking)
    fill = {}
    for group in all_of(svg, "g"):
        for use in group.findall("{http://www.w3.org/2000/svg}use"):
            title = use.find("{http://www.w3.org/2000/svg}title")
            if title is not None:
                fill[title.text] = group.get("fill")
    share = ranking.looser / ranking.looser.max()
    assert fill == dict(zip(ranking.answer.assembly.names, map(shade, share), strict=True))
    tight = studies[wr.Tightening]
    assert picture_of_tightening(tight).count(f'fill="{palette.CHOSEN}" fill-opacity') == 1


def test_pages_hold_the_numbers(studies: dict[type, Any]) -> None:
    ranking = studies[wr.Ranking]
    page = PAGES[wr.Ranking](ranking)
    names = ranking.answer.assembly.names
    for k in ranking.order:
        cells = re.search(rf'<tr><td>{names[k]}</td><td class="n" data-v="([^"]*)"', page)
        assert cells
        assert float(cells[1]) == pytest.approx(ranking.looser[k])
    sweep = PAGES[wr.Sweep](studies[wr.Sweep])
    assert row_of(sweep, "0.07000")[:3] == ["–", "–", "unbounded"]
    sample = studies[wr.Sample]
    shown = row_of(PAGES[wr.Sample](sample), "95 % of the draws below")[0]
    assert float(shown) == pytest.approx(sample.quantile(0.95), rel=1e-3)
    tight = studies[wr.Tightening]
    assert row_of(PAGES[wr.Tightening](tight), "1")[0] == tight.chosen[0]


def test_the_report_of_an_answer_ranks_by_its_own_forces(studies: dict[type, Any]) -> None:
    ranking = studies[wr.Ranking]
    page, first = report(ranking.answer), ranking.order[0]
    assert "Whose gap matters most" in page
    again = wr.rank(ranking.answer.assembly, by="differences", workers=1)
    said = re.search(rf'Whose gap.*?<td>{ranking.answer.assembly.names[first]}</td><td[^>]*data-v="([^"]*)"', page)
    assert said
    assert float(said[1]) == pytest.approx(again.looser[first], rel=2e-2)
    free = wr.flex(wr.patterns.chain(2, joint="swallowtail", gap=0.1))
    assert free.objective is None
    assert "Whose gap" not in report(free)
    assert "Whose gap" not in report(wr.flex(ranking.answer.assembly, model="hull"))


@pytest.mark.parametrize("kind", PAGES)
def test_a_page_asks_nothing_of_any_network_and_names_are_text(studies: dict[type, Any], kind: type) -> None:
    seen = tags(PAGES[kind](studies[kind], command=f"wiggleroom {NASTY}"))
    assert not {"img", "b", "iframe", "object", "form"} & {tag for tag, _ in seen}
    ids = [given["id"] for _, given in seen if "id" in given]
    assert len(ids) == len(set(ids))
    for _, given in seen:
        assert not [k for k in given if k.startswith("on")]
        assert "src" not in given
        for link in ("href", "xlink:href"):
            assert (given.get(link) or "#").startswith(("#", "data:,"))


@pytest.mark.parametrize("kind", PAGES)
def test_every_study_draws_itself(studies: dict[type, Any], kind: type, tmp_path: Path) -> None:
    found = studies[kind]
    found.draw(tmp_path / "a.svg")
    ElementTree.fromstring((tmp_path / "a.svg").read_bytes())
    found.draw(tmp_path / "a.PNG")
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")
    found.draw(tmp_path / "a.html")
    for name in ("a.gif", "a.film.svg", "a.txt", "a"):
        with pytest.raises(wr.InputError, match=r"must end in \.svg, \.png or \.html"):
            found.draw(tmp_path / name)
    assert len(list(tmp_path.iterdir())) == 3


def test_what_check_found_is_shown_as_it_is(tmp_path: Path) -> None:
    apart = wr.check(wr.read("examples/17_does_it_come_apart/sequential.json"))
    page = page_of_check(Checked(apart), command="wiggleroom check it")
    assert row_of(page, "1")[:2] == ["latch", "straight in +y"]
    assert row_of(page, "2")[:2] == ["drawer", "straight in +x"]
    holds = wr.check(wr.patterns.chain(2, joint="swallowtail", gap=0.02))
    still = page_of_check(Checked(holds, wr.LargestGap(0.0602, 0.0603, None, None)))
    assert "interlocked at 0.0602 mm, comes apart at 0.0603 mm" in still
    for text in (page, still):
        assert "stationary" not in text
        assert "nothing asked" not in text
        assert not [tag for tag, given in tags(text) if "src" in given]
    assert 'class="film"' not in still
    for found, said in ((apart, "comes apart at gap 0.5 mm"), (holds, "interlocked at gap 0.02 mm")):
        for name in ("a.svg", "a.film.svg", "a.html"):
            found.draw(tmp_path / name)
            assert said in (tmp_path / name).read_text()


@pytest.mark.slow
@pytest.mark.parametrize("kind", PAGES)
def test_pages_open_in_a_browser(studies: dict[type, Any], opened: Any, kind: type) -> None:
    at = opened(PAGES[kind](studies[kind]), viewport={"width": 400, "height": 800})
    assert at.evaluate("() => document.documentElement.scrollWidth") <= 400
    assert at.locator("figure svg").first.is_visible()
    assert at.locator("img").count() == 0
    heads = at.locator("th button")
    for k in range(heads.count()):
        heads.nth(k).click()
