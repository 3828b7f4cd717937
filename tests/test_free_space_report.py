"""The command `space`: what it says about a pair must be true of the pair."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.answers import block
from tests.audit import audit as other_audit
from tests.audit import polygon
from tests.page_waits import settled
from tests.standalone import rows, told
from wiggleroom.assembly.build import assemble
from wiggleroom.cli import main
from wiggleroom.compare.monte_carlo import about_pivot, sampled_accuracy
from wiggleroom.drawing.model import Drawing, Part
from wiggleroom.report.free_space.space_report import space_result
from wiggleroom.report.page.pages import page_of_space
from wiggleroom.report.results.json_results import to_json

FULL = math.degrees(0.118387)  # 0.9 (cos + sin) = 1: a square peg of side 1.8 in a square hole of side 2


def peg(at: tuple[float, float, float] = (0.0, 0.0, 0.0), off: float = 0.0) -> wr.Assembly:
    """A square peg in a square hole of a plate, the peg's reference point `off` its middle."""
    region = block(1.8)
    region = wr.Region(region.outer + np.array([off, 0.0]))
    x, y, angle = at
    turned = (x - off * math.cos(angle), y - off * math.sin(angle), angle)
    return assemble(
        Drawing((Part("plate", (block(6.0, hole=2.0),), at, fixed=True), Part("peg", (region,), turned))), gap=0.0
    )


@pytest.mark.parametrize("case", [peg(), peg(off=40.0), peg((300.0, -20.0, 0.7), 3.0)], ids=["plain", "far", "turned"])
def test_the_record_is_true_of_a_peg_in_a_square_hole(case: wr.Assembly) -> None:
    space = wr.free_space(case, "plate", "peg")
    record = json.loads(to_json(space_result(space, sampled_accuracy(space, case, 2000), "c")))
    assert record["closed"] is True
    np.testing.assert_allclose(record["angles_deg"], [-FULL, FULL], atol=1e-3)
    for one in record["slices"]:
        turn = math.radians(abs(one["angle_deg"]))
        side = 2 - 1.8 * (math.cos(turn) + math.sin(turn))
        assert one["area"] == pytest.approx(side**2, rel=1e-6)
        assert sum(shapely.Polygon(o).area for o in one["outlines"]) == pytest.approx(side**2, rel=1e-6)
    turn = np.linspace(-math.radians(FULL), math.radians(FULL), 20001)
    whole = np.trapezoid((2 - 1.8 * (np.cos(turn) + np.abs(np.sin(turn)))) ** 2, np.degrees(turn))
    assert record["volume"] == pytest.approx(whole, rel=2e-3)
    assert record["audit"]["unsafe"] == 0
    assert record["audit"]["lost"] <= 0.005 * record["audit"]["free"]
    assert all(low < high for low, high in (c["angles_deg"] for c in record["cells"]))


@pytest.mark.parametrize("joint", ["jigsaw"])
def test_the_audit_agrees_with_another_one(joint: str) -> None:
    chain = wr.patterns.chain(2, joint=joint, gap=0.02)
    space = wr.free_space(chain, "b1", "b2")
    ours = sampled_accuracy(space, chain, 4000, seed=3)
    a, b = chain.parts
    theirs = other_audit(space, polygon(a), polygon(b), chain.rest[1, :2] - chain.rest[0, :2], 4000, seed=3)
    assert (ours.unsafe, ours.samples) == (theirs.unsafe, theirs.samples) == (0, 4000)
    assert abs(ours.free - theirs.free) <= 0.01 * theirs.free + 1
    assert abs(ours.lost - theirs.lost) <= 0.005 * theirs.free + 1


def test_the_audit_finds_cells_that_lie(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = wr.patterns.chain(2, joint="tee", gap=0.02)
    space = wr.free_space(chain, "b1", "b2")
    monkeypatch.setattr(type(space), "contains", lambda self, relative: np.ones(len(relative), dtype=bool))
    assert sampled_accuracy(space, chain, 1000).unsafe > 500
    monkeypatch.setattr(type(space), "contains", lambda self, relative: np.zeros(len(relative), dtype=bool))
    found = sampled_accuracy(space, chain, 1000)
    assert found.lost == found.free > 50


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["wiggleroom", *words])
    return main()


def test_the_command_answers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    chain = "examples/02_chain_of_tees/chain.json"
    monkeypatch.chdir(Path(__file__).parents[1])
    picture = tmp_path / "space.html"
    assert run(monkeypatch, "space", chain, "b1", "b2", "--samples", "500", "--picture", str(picture)) == 0
    said = capsys.readouterr().out
    assert "closed" in said
    assert "0 accepted although the parts overlap" in said
    assert picture.read_text().startswith("<!DOCTYPE html>")
    assert run(monkeypatch, "space", chain, "b1", "b2", "--json", "-") == 0
    assert json.loads(capsys.readouterr().out)["audit"] is None
    assert run(monkeypatch, "space", chain, "b1", "b2", "--picture", str(tmp_path / "a.svg")) == 0
    ElementTree.parse(tmp_path / "a.svg")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("b1", "nobody"), "nobody"),
        (("b1", "b1"), "twice"),
        (("b1", "b2", "--samples", "-3"), "--samples"),
        (("b1", "b2", "--picture", "out.gif"), ".html"),
    ],
)
def test_bad_questions_are_refused(
    words: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(Path(__file__).parents[1])
    assert run(monkeypatch, "space", "examples/02_chain_of_tees/chain.json", *words) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("case", [wr.patterns.chain(2, joint="swallowtail", gap=0.02)])
def test_the_page_carries_all_slices(case: wr.Assembly) -> None:
    space = wr.free_space(case, *case.names)
    page = told(page_of_space(space))
    assert [area for _, area in rows(page, "Slices")] == pytest.approx([s.area for s in space.slices])
    regions = about_pivot(space)
    for one in page["space"]["slices"]:
        k = int(np.abs(np.degrees([s.angle for s in space.slices]) - one["angle_deg"]).argmin())
        assert sum(map(ring_area, one["rings"])) == pytest.approx(regions[k].area)


def ring_area(ring: list[list[float]]) -> float:
    x, y = np.array(ring).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


@pytest.mark.slow
def test_the_solid_turns_in_the_browser(browser: Any, tmp_path: Path) -> None:
    case, wrong = wr.patterns.chain(2, joint="tee", gap=0.02), []
    space = wr.free_space(case, "b1", "b2")
    (tmp_path / "space.html").write_text(page_of_space(space, sampled_accuracy(space, case, 200)))
    at = browser.new_page()
    at.on("pageerror", lambda error: wrong.append(str(error)))
    at.on("request", lambda asked: None if asked.url.startswith("file:") else wrong.append(asked.url))
    at.goto((tmp_path / "space.html").as_uri())
    canvas = at.locator(".space3d canvas")
    canvas.wait_for()
    first = settled(at, canvas.screenshot)
    canvas.focus()
    for _ in range(5):
        at.keyboard.press("ArrowRight")
    assert settled(at, canvas.screenshot) != first
    slider = at.locator(".slicer input")
    slider.fill("0")
    assert at.locator(".slicer").inner_text().startswith("slice at -")
    at.get_by_role("tab", name="Slices and cells").click()
    assert at.locator(".plot svg").is_visible()
    assert "unsafe" in at.locator(".sure").inner_text().lower()
    at.close()
    assert wrong == []
