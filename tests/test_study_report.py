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
from tests.page_waits import plays, settled
from tests.standalone import frames, rows, told
from tests.test_answer_page import tags
from tests.test_plots import all_of, axis
from wiggleroom.report.page import pages
from wiggleroom.report.page.finding_page import page_of_finding
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.finding_picture import picture_of_finding
from wiggleroom.report.results.separability import Checked
from wiggleroom.report.results.tables import csv_of
from wiggleroom.studies.registry import finding_of

KINDS = (wr.Ranking, wr.Tightening, wr.Sweep, wr.Sample)
NASTY = "<img src=x onerror=alert(1)></script>"


def picture(found: Any, command: str = "") -> str:
    return picture_of_finding(finding_of(found, command), command=command)


def page_of(found: Any, command: str = "") -> str:
    return page_of_finding(finding_of(found, command), command=command)


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
        wr.rank(wr.flex(chain, search=0)),
        wr.tighten(chain, parts=1, draws=6, workers=1),
        wr.sweep(pair, [0.01, 0.03, 0.05, 0.07]),
        wr.sample(pair, 0.002, draws=60, limit=0.07, workers=1),
    )
    return {type(f): f for f in found}


def test_the_curve_goes_through_what_was_found_and_ends_where_it_is_lost(studies: dict[type, Any]) -> None:
    found = studies[wr.Sweep]
    svg = picture(found, command="wiggleroom sweep it")
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
    svg = picture(found)
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
    for text in (picture(odd), page_of(odd)):
        assert re.search(r"in 5 (draws )?nothing stops the motion", text)
        assert re.search(r"in 3 (draws )?parts do not fit", text)
        assert not re.search(r"\b(nan|inf)\b", text)
    none = replace(found, value=np.full(60, np.nan))
    assert "50 % below" not in picture(none)
    page_of(none)


def test_pages_hold_the_numbers(studies: dict[type, Any]) -> None:
    ranking = studies[wr.Ranking]
    page = told(page_of(ranking))
    names = ranking.answer.assembly.names
    assert list(page["rank"]["parts"]) == [names[k] for k in ranking.order]
    for k, one in zip(ranking.order, page["rank"]["parts"].values(), strict=True):
        assert one["mm_per_mm"] == pytest.approx(ranking.looser[k])
        assert one["percent"] == pytest.approx(100 * ranking.looser[k] / ranking.looser.sum())
    worth = [one["mm_per_mm"] for one in page["rank"]["joints"]]
    assert worth == sorted(ranking.joint_looser, reverse=True)
    sample = studies[wr.Sample]
    numbers = dict(rows(told(page_of(sample)), "In numbers"))
    assert numbers["95 % of the draws below"] == pytest.approx(sample.quantile(0.95), rel=1e-3)
    tight = told(page_of(studies[wr.Tightening]))
    chosen = [name for _, name, *_ in rows(tight, "Make these tighter, in this order")]
    assert chosen == list(studies[wr.Tightening].chosen) == list(tight["tints"]["values"])


def test_the_page_of_a_sweep_has_the_answer_at_every_gap(studies: dict[type, Any]) -> None:
    page = told(page_of(studies[wr.Sweep]))
    assert [one["gap"] for one in page["answers"]] == [0.01, 0.03, 0.05, 0.07]
    assert page["begin"] in (0.01, 0.03)  # next to the 0.02 of the drawing
    assert 0.0600 <= page["lost"][0] < page["lost"][1] <= 0.0606
    for one in page["answers"][:3]:
        truth = wr.flex(named(wr.patterns.chain(2, joint="swallowtail", gap=one["gap"]), "b2", NASTY), search=0)
        assert one["flex"]["objective"] == pytest.approx(truth.objective, rel=1e-4)
        assert frames(one["path"])[-1, 1, 1] == pytest.approx(truth.motion[1, 1], rel=1e-3)
    free = page["answers"][3]["flex"]
    assert free["leaves"] == [NASTY]
    assert rows(page, "Motion against gap")[3][1:4] == [None, None, "unbounded"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_asks_nothing_of_any_network_and_names_are_text(studies: dict[type, Any], kind: type) -> None:
    seen = tags(page_of(studies[kind], command=f"wiggleroom {NASTY}"))
    assert not {"img", "b", "iframe", "object", "form"} & {tag for tag, _ in seen}
    ids = [given["id"] for _, given in seen if "id" in given]
    assert len(ids) == len(set(ids))
    for _, given in seen:
        assert not [k for k in given if k.startswith("on")]
        assert "src" not in given
        for link in ("href", "xlink:href"):
            assert (given.get(link) or "#").startswith(("#", "data:,"))


@pytest.mark.parametrize("kind", KINDS)
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
    page = told(pages.page_of_check(Checked(apart), command="wiggleroom check it"))
    assert [one["words"] for one in page["check"]["reply"]["escapes"]] == [
        "latch leaves straight in +y",
        "drawer leaves straight in +x",
    ]
    for one, escape in zip(page["check"]["paths"], apart.escapes, strict=True):
        np.testing.assert_allclose(frames(one)[-1], escape.path[-1], rtol=1e-6)
    holds = wr.check(wr.patterns.chain(2, joint="swallowtail", gap=0.02))
    still = told(pages.page_of_check(Checked(holds, wr.LargestGap(0.0602, 0.0603, None, None))))
    assert "interlocked at 0.0602 mm, comes apart at 0.0603 mm" in still["check"]["reply"]["border"]
    assert still["check"]["paths"] == []
    assert "answers" not in still
    for found, said in ((apart, "comes apart at gap 0.5 mm"), (holds, "interlocked at gap 0.02 mm")):
        for name in ("a.svg", "a.film.svg", "a.html"):
            found.draw(tmp_path / name)
            assert said in (tmp_path / name).read_text()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_pages_open_in_a_browser(studies: dict[type, Any], opened: Any, kind: type) -> None:
    at = opened(page_of(studies[kind], command="wiggleroom it"), viewport={"width": 400, "height": 800})
    assert at.evaluate("() => document.documentElement.scrollWidth") <= 400
    assert at.locator("canvas").is_visible()
    for k in range(at.get_by_role("tab").count()):
        at.get_by_role("tab").nth(k).click()
        assert at.locator("img").count() == 0
        heads = at.locator("th button")
        for j in range(heads.count()):
            heads.nth(j).click()
        assert at.locator(".tabpanel").inner_text().strip()


@pytest.mark.slow
def test_a_ranking_is_read_as_colours_and_sorted_tables(studies: dict[type, Any], opened: Any) -> None:
    ranking = studies[wr.Ranking]
    at = opened(page_of(ranking))
    assert at.get_by_role("tab", selected=True).inner_text() == "Whose gap"
    parts, joints = (at.locator(".sorts").nth(k).locator("tbody tr") for k in (0, 1))
    first = ranking.order[0]
    name, value, share = parts.first.locator("td").all_inner_texts()
    assert name == ranking.answer.assembly.names[first]
    assert float(value) == pytest.approx(ranking.looser[first], rel=1e-3)
    assert float(share) == pytest.approx(ranking.percent[first], rel=1e-2)
    assert joints.count() == len(ranking.joints)
    coloured = settled(at, lambda: at.locator("canvas").evaluate("c => c.toDataURL()"))
    at.get_by_role("checkbox", name="colour the parts").uncheck()
    assert settled(at, lambda: at.locator("canvas").evaluate("c => c.toDataURL()")) != coloured


@pytest.mark.slow
def test_a_sweep_is_read_along_its_slider(studies: dict[type, Any], opened: Any) -> None:
    found = studies[wr.Sweep]
    at = opened(page_of(found))
    at.locator(".curve .dot").nth(2).wait_for(state="attached")  # the curve is drawn when its size is known
    assert at.locator(".curve .dot").count() == 3
    for step in found.steps[:3]:
        at.locator("#gap").fill(str(step.gap + 0.004))  # the nearest gap that was solved
        assert f"moves {step.objective:.4g} mm" in at.locator("#answer").inner_text()
    at.locator("#gap").fill("0.07")
    assert "nothing stops" in at.locator("#answer").inner_text()
    plays(at)  # it leaves, as a film
    at.get_by_role("tab", name="Gaps").click()
    assert at.locator(".sorts tbody tr").nth(3).inner_text().split()[-2:] == ["unbounded", "checked"]
    assert "nothing stops the motion from a gap of" in at.locator(".sure").inner_text()


@pytest.mark.slow
def test_ways_out_are_films(opened: Any) -> None:
    found = wr.check(wr.read("examples/17_does_it_come_apart/sequential.json"))
    at = opened(pages.page_of_check(Checked(found, wr.LargestGap(0.1, 0.2, None, None)), command="wiggleroom check it"))
    assert at.locator("#answer").inner_text() == "comes apart at gap 0.5 mm"
    facts = at.locator(".headline .facts")
    for said in (
        "step 1 of 2: latch leaves straight in +y",
        "step 2 of 2: drawer leaves straight in +x",
        "step 1 of 2",
    ):
        at.locator(".headline .facts", has_text=said).wait_for()  # one after the other, and again
    at.get_by_role("button", name="Play the path out of drawer").click()
    at.locator(".headline .facts", has_text="drawer leaves straight in +x").wait_for()
    plays(at)
    assert "interlocked at 0.1 mm, comes apart at 0.2 mm" in at.locator(".border").inner_text()
    assert at.locator(".command").inner_text() == "wiggleroom check it"
    at.get_by_role("button", name="Rest").click()
    assert "leaves: latch, drawer" in facts.inner_text()


@pytest.mark.slow
def test_a_ranking_keeps_its_order_where_parts_are_called_by_numbers(opened: Any) -> None:
    chain = wr.patterns.chain(4, joint="tee", gap=0.02)
    for part, name in zip(chain.names, ("4", "1", "3", "2"), strict=True):
        chain = named(chain, part, name)
    found = wr.rank(wr.flex(chain, search=0))
    at = opened(page_of(found))
    shown = at.locator("table.sorts").first.locator("tbody tr td:first-child").all_inner_texts()
    assert shown == [found.answer.assembly.names[k] for k in found.order]


def test_the_table_of_a_ranking_has_the_order_of_its_json() -> None:
    found = wr.rank(wr.patterns.chain(4, joint="tee", gap=0.01))
    tighter = 10 * np.argsort(np.argsort(-found.joint_looser)).astype(float)  # the more where it was the less
    found = replace(found, joint_tighter=tighter, joint_unique=np.zeros(len(tighter), dtype=bool))
    table = [line.split(",")[1:3] for line in csv_of(finding_of(found)).splitlines() if line.startswith("joint")]
    assert table == [list(joint.parts) for joint in finding_of(found).record().joints]
