"""Parts that were dragged stay where they are left: a mechanism is worked by hand, part by part, in a real browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.app_client import Served
from tests.browser_page import canvas, serving, visiting
from tests.page_waits import settled, until

pytestmark = pytest.mark.slow

LATCH = {
    "format": "wiggleroom/1",
    "gap": 0.2,
    "parts": [
        {"name": "case", "outline": [[0, 0], [160, 0], [160, 10], [10, 10], [10, 20], [0, 20]], "fixed": True},
        {"name": "roof", "outline": [[0, 20], [40, 20], [40, 40], [0, 40]], "fixed": True},
        {"name": "post", "outline": [[50, 20], [160, 20], [160, 40], [50, 40]], "fixed": True},
        {"name": "slider", "outline": [[10, 10], [90, 10], [90, 20], [50, 20], [50, 15], [40, 15], [40, 20], [10, 20]]},
        {"name": "latch", "outline": [[40, 15], [50, 15], [50, 60], [40, 60]]},
    ],
}
"""A slider that a latch holds: lifted by more than 5 mm the latch lets it go."""


@pytest.fixture(scope="module")
def latch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    path = tmp_path_factory.mktemp("latch") / "latch.json"
    path.write_text(json.dumps(LATCH))
    with serving(path) as served:
        yield served


def ready(page: Any) -> None:
    """The latch without a question: what is dragged alone moves anything."""
    page.locator("#answer[data-settled=true], #answer:has-text('nothing asked')").first.wait_for()
    for button in page.get_by_role("button", name="Do not ask for").all():
        button.click()
    page.locator("#answer", has_text="nothing asked").wait_for()
    settled(page, lambda: place(page, 80, 30))


def place(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a point of the drawing [mm] is on the screen."""
    box = canvas(page)
    x0, y0, scale = json.loads(page.locator(".stage canvas").get_attribute("data-view"))
    return box["x"] + box["width"] / 2 + (x - x0) * scale, box["y"] + box["height"] / 2 - (y - y0) * scale


def moved(page: Any) -> dict[str, list[float]]:
    """Where parts were left, as it is kept."""
    kept = json.loads(page.evaluate("sessionStorage.getItem('wiggleroom.design')"))
    return kept["pose"] or {}


def drag(page: Any, grip: tuple[float, float], by: tuple[float, float]) -> None:
    """Take a part at a point [mm], once the picture stands still, and let it go elsewhere."""
    settled(page, lambda: (place(page, *grip), moved(page)))
    page.mouse.move(*place(page, *grip))
    page.mouse.down()
    page.mouse.move(*place(page, grip[0] + by[0], grip[1] + by[1]), steps=14)
    settled(page, lambda: page.locator(".stage canvas").get_attribute("data-shown"))
    page.mouse.up()
    settled(page, lambda: json.dumps(moved(page)))


def test_a_mechanism_is_worked_by_hand(browser: Any, latch: Served) -> None:
    with visiting(browser, latch) as page:
        ready(page)
        drag(page, (20, 15), (30, 0))
        assert moved(page)["slider"][0] < 0.6  # the latch holds it
        page.keyboard.press("Home")
        until(page, lambda: moved(page) == {}, "not back at rest")
        drag(page, (45, 50), (0, 12))
        lifted = moved(page)
        assert lifted["latch"][1] == pytest.approx(12, abs=0.5)
        drag(page, (20, 15), (30, 0))
        assert moved(page)["slider"][0] == pytest.approx(30, abs=0.5)
        until(page, lambda: abs(moved(page)["latch"][1] - lifted["latch"][1]) < 0.01, "nobody asked the latch to move")
        left = moved(page)
        page.mouse.click(*place(page, 60, 15))
        page.get_by_role("button", name="Pin", exact=True).click()
        drag(page, (45, 62), (0, -30))
        # it comes down to the slider, which is below it now
        until(page, lambda: abs(moved(page)["latch"][1] - 5) < 0.4, "the latch does not come down to the slider")
        assert moved(page)["slider"] == left["slider"]
        page.get_by_role("button", name="unpin slider").click()
        for expected in (left, lifted, {}):
            page.keyboard.press("Control+z")
            until(page, lambda: set(moved(page)) == set(expected), "undo leads elsewhere")  # noqa: B023
            for name, motion in expected.items():
                assert moved(page)[name] == pytest.approx(motion, abs=1e-6)
        for expected in (lifted, left):
            page.keyboard.press("Control+y")
            until(page, lambda: moved(page) == expected, "redo leads elsewhere")  # noqa: B023
        drag(page, (50, 15), (20, 0))  # the slider lies 30 mm further: taken where it is seen
        until(
            page, lambda: moved(page)["slider"][0] > 40, "it does not go on from there"
        )  # from rest it would end at 20


def test_a_pinned_part_stands_and_a_pose_outlives_a_reload(browser: Any, latch: Served) -> None:
    with visiting(browser, latch) as page:
        ready(page)
        page.mouse.click(*place(page, 45, 50))
        page.get_by_role("button", name="Pin", exact=True).click()
        drag(page, (20, 15), (30, 0))
        assert moved(page)["slider"][0] < 0.6
        assert "latch" not in moved(page)
        page.get_by_role("button", name="unpin latch").click()
        page.keyboard.press("Home")
        drag(page, (45, 50), (0, 12))
        lifted = moved(page)
        page.reload()
        page.locator("#answer", has_text="as left").wait_for()
        settled(page, lambda: place(page, 80, 30))
        assert moved(page) == lifted
        drag(page, (20, 15), (30, 0))
        assert moved(page)["slider"][0] == pytest.approx(30, abs=0.5)
        page.get_by_label("gap, mm", exact=True).fill("0.3")
        page.get_by_label("gap, mm", exact=True).press("Enter")
        until(page, lambda: moved(page) == {}, "another design shows its own answer")
        page.keyboard.press("Control+z")
        until(page, lambda: moved(page).get("slider", [0])[0] > 29, "undo leads to the pose of the design before")


def test_parts_that_would_overlap_are_not_left_there(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "latch.json"
    path.write_text(json.dumps(LATCH))
    with serving(path) as served, visiting(browser, served) as page:
        ready(page)
        drag(page, (45, 50), (0, 12))
        page.evaluate(
            """() => { const kept = JSON.parse(sessionStorage.getItem('wiggleroom.design'));
            kept.pose = {slider: [30, 0, 0]}; sessionStorage.setItem('wiggleroom.design', JSON.stringify(kept)); }"""
        )
        page.goto("about:blank")
        page.go_back()
        page.locator(".notices", has_text="parts overlap there").wait_for()
        until(page, lambda: moved(page) == {}, "they stay in each other")
