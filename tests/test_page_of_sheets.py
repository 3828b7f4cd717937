"""A cutting sheet in the live page: put together, helped by clicks and keys, and asked in space; in a real browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import shapely
from benchmarks.sheet_drawings import box, egg_crate
from benchmarks.sheet_judge import judge

from tests.browser_page import AXE, accessible, serving, visiting
from wiggleroom.mating.assembled_sheet import assemble_sheet
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.hints import read_hints

pytest.importorskip("manifold3d")
pytestmark = pytest.mark.slow

LONG = 120_000
"""Milliseconds that a busy machine may need."""


@pytest.fixture
def covered_tray(tmp_path: Path) -> Path:
    """An open box of 90 x 60 x 45 with a plain cover that lies on its walls."""
    design = box("tray", 90, 60, 45, 3, 9, lid=False)
    design.panels["cover"] = shapely.box(0, 0, 90, 60)
    path = tmp_path / "tray.svg"
    path.write_text(design.svg())
    return path


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    with serving(None) as served, visiting(browser, served) as one:
        one.locator(".sample").first.wait_for(timeout=LONG)
        yield one


def assembled(page: Any, path: Path, thickness: str = "3") -> str:
    """What is said of a sheet that is put together in the page."""
    page.locator("#file").set_input_files(str(path))
    page.get_by_role("tab", name="Sheet").click(timeout=LONG)
    box = page.get_by_label("thickness of the material, mm")
    box.fill(thickness)
    box.press("Enter")
    page.get_by_role("button", name="Assemble").click()
    page.locator("#assembled").wait_for(timeout=LONG)
    return str(page.locator("#assembled").inner_text())


def said(page: Any, words: str) -> None:
    page.locator("#assembled", has_text=words).wait_for(timeout=LONG)


def press(page: Any, panel: str, across: float, up: float) -> None:
    """Press a panel on the sheet at a share of its box."""
    box = page.get_by_role("button", name=f"panel {panel},").bounding_box()
    page.mouse.click(box["x"] + across * box["width"], box["y"] + (1 - up) * box["height"])


def downloaded(page: Any, words: str, folder: Path) -> Path:
    with page.expect_download(timeout=LONG) as download:
        page.get_by_role("button", name=words).click()
    path = folder / str(download.value.suggested_filename)
    download.value.save_as(path)
    return path


def test_a_loose_cover_is_laid_by_two_presses_and_the_box_is_asked_in_space(
    page: Any, covered_tray: Path, tmp_path: Path
) -> None:
    assert assembled(page, covered_tray) == "5 of 6 panels placed, not sure"
    assert "cover" in page.get_by_role("list", name="not placed").inner_text()
    assert page.locator(".sheet .edge").count() == 16
    page.get_by_role("button", name="Lay", exact=True).click()
    press(page, "cover", 0.5, 0.03)
    press(page, "front", 0.5, 0.98)
    said(page, "6 of 6 panels placed")
    hints, file = downloaded(page, "Save hints", tmp_path), downloaded(page, "Save assembly", tmp_path)
    judged = judge(file)
    assert judged.overlap < 1e-5
    assert judged.size == pytest.approx((48, 60, 90), abs=0.02)
    assert {frozenset({"cover", wall}) for wall in ("front", "back", "left", "right")} <= judged.touching
    again = assemble_sheet(read_sheet(covered_tray), 3.0, hints=read_hints(hints))
    assert not again.unplaced
    page.get_by_role("button", name="Go on in space").click()
    page.get_by_role("tab", name="Sheet").wait_for(state="detached", timeout=LONG)
    page.locator(".stage.solid canvas").wait_for(timeout=LONG)
    names = {part["name"] for part in json.loads(file.read_text())["parts"]}
    assert names == {"bottom", "front", "back", "left", "right", "cover"}
    page.get_by_role("tab", name="Come apart").click()
    page.get_by_role("button", name="Check").first.wait_for(timeout=LONG)


def test_two_edges_are_joined_by_keys_alone_and_taken_back(page: Any, tmp_path: Path) -> None:
    path = tmp_path / "crate.svg"
    path.write_text(egg_crate("crate", [30, 75, 110], [25, 60], 40, 3, 150, 90).svg())
    assert "not sure" in assembled(page, path)
    edges = [page.get_by_role("button", name=f"edge of {panel} at").first for panel in ("x0", "y1")]
    for edge in edges:
        edge.focus()
        page.keyboard.press("Enter")
    hints = page.get_by_role("list", name="hints")
    hints.get_by_text("holds").wait_for(timeout=LONG)
    page.wait_for_function("() => !document.querySelector('.work')", timeout=LONG)
    text = downloaded(page, "Save hints", tmp_path).read_text()
    assert text.startswith("thickness = 3")
    assert '["x0@' in text
    page.get_by_role("button", name="Take the last hint back").click()
    page.wait_for_function("() => !document.querySelector('[aria-label=hints] li')", timeout=LONG)


def test_what_does_not_fit_is_one_line_and_the_sheet_stays(page: Any, covered_tray: Path) -> None:
    assembled(page, covered_tray)
    page.get_by_text("By name").click()
    page.get_by_label("first panel").select_option("bottom")
    page.get_by_label("first side").select_option("left")
    page.get_by_label("second panel").select_option("cover")
    page.get_by_role("button", name="Join these").click()
    finding = page.locator(".findings li")
    finding.wait_for(timeout=LONG)
    assert "cover:top has no fingers" in finding.inner_text()
    assert page.locator("#assembled").inner_text() == "5 of 6 panels placed, not sure"


@pytest.mark.skipif(not AXE.exists(), reason="needs `npm ci` in web")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_sheet_that_is_put_together_is_accessible(browser: Any, covered_tray: Path, scheme: str) -> None:
    with serving(None) as served, visiting(browser, served, color_scheme=scheme) as page:
        page.locator(".sample").first.wait_for(timeout=LONG)
        assembled(page, covered_tray)
        page.get_by_text("By name").click()
        accessible(page)
        page.get_by_role("button", name="edge of bottom at").first.focus()
        page.keyboard.press("Enter")
        accessible(page)
