"""Mechanisms worked by hand from locked to open, drag by drag, every state free of overlap by shapely alone; in a real browser."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

import wiggleroom as wr
from tests.browser_page import serving, visiting
from tests.page_waits import settled, until
from tests.test_live_pose import overlap
from tests.test_page_pose import drag, moved, place, ready
from wiggleroom.assembly.assembly import Assembly

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"
RIM, GATE, AXLE = 18.0, 6.0, 5.0
"""Radius of a wheel, width of the gate in it, and radius of the axle it turns on [mm]."""
WHEELS = {20.0: 30.0, 70.0: 210.0, 120.0: -20.0}
"""Where a wheel of the lock is [mm], and where its gate points [degrees]; the bar falls once all point up."""
ARC = 15.0
"""So far a hand turns a wheel at once [degrees]."""


def entry(name: str, shape: shapely.Polygon, x: float = 0.0, y: float = 0.0, fixed: bool = False) -> dict[str, Any]:
    """A part about a reference point of its own."""
    rings = [np.round(np.array(ring.coords[:-1]), 4).tolist() for ring in (shape.exterior, *shape.interiors)]
    return {"name": name, "outline": rings[0], "holes": rings[1:], "at": [x, y, 0], "fixed": fixed}


def combination_lock() -> dict[str, Any]:
    """Wheels with gates, and a bar with high ends in guides, whose teeth fall into the gates."""
    teeth = [shapely.box(x - 72, -17.5, x - 68, -4) for x in WHEELS]
    ends = [shapely.box(-70, -4, -60, 44), shapely.box(60, -4, 70, 44)]
    bar = shapely.union_all([shapely.box(-70, -4, 70, 4), *teeth, *ends])
    parts = [
        entry("left", shapely.box(-10, 5, 0, 90), fixed=True),
        entry("right", shapely.box(140, 5, 150, 90), fixed=True),
    ]
    for k, (x, angle) in enumerate(WHEELS.items(), 1):
        gate = affinity.rotate(shapely.box(9, -GATE / 2, 2 * RIM, GATE / 2), angle, (0, 0))
        axle = shapely.Point(0, 0).buffer(AXLE, quad_segs=8)
        wheel = shapely.Point(0, 0).buffer(RIM, quad_segs=12).difference(gate).difference(axle)
        parts += [entry(f"axle{k}", axle, x, fixed=True), entry(f"wheel{k}", wheel, x)]
    return {"format": "wiggleroom/1", "gap": 0.2, "parts": [*parts, entry("bar", bar, 70, 36)]}


def led(page: Any, *points: tuple[float, float]) -> None:
    """Take a part at the first of some points [mm] and lead it by the others to the last; a hand pushes until it is there."""
    settled(page, lambda: page.locator(".stage canvas").get_attribute("data-view"))
    places = [place(page, *point) for point in points]
    page.mouse.move(*places[0])
    page.mouse.down()
    for x, y in places[1:]:
        page.mouse.move(x, y, steps=4)
        settled(page, lambda: page.locator(".stage canvas").get_attribute("data-shown"))

    def there() -> bool:
        if "at the pointer" in page.locator(".headline .facts").inner_text():
            return True
        page.mouse.move(x + 0.5, y)
        page.mouse.move(x, y)
        settled(page, lambda: page.locator(".stage canvas").get_attribute("data-shown"))
        return False

    until(page, there, "the part does not follow the hand")
    page.mouse.up()
    settled(page, lambda: json.dumps(moved(page)))


def turn(page: Any, centre: tuple[float, float], radius: float, begin: float, by: float) -> None:
    """Take a wheel at a place of its rim and lead it round [degrees]."""
    angles = np.radians(begin + by * np.linspace(0, 1, int(np.ceil(abs(by) / ARC)) + 1))
    led(page, *((centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)) for t in angles))


def free(page: Any, assembly: Assembly) -> None:
    """No two parts overlap where they were left."""
    pose = moved(page)
    motion = np.array([pose.get(name, [0.0, 0.0, 0.0]) for name in assembly.names])
    assert overlap(assembly, motion) < 1e-3


def test_a_drawer_opens_once_its_latch_is_down(browser: Any) -> None:
    path = EXAMPLES / "17_does_it_come_apart" / "sequential.json"
    assembly = wr.read(str(path))
    with serving(path) as served, visiting(browser, served) as page:
        ready(page)
        drag(page, (20, 25), (40, 0))
        assert moved(page)["drawer"][0] < 1.1  # the latch holds it
        free(page, assembly)
        page.keyboard.press("Home")
        until(page, lambda: moved(page) == {}, "not back at rest")
        drag(page, (65, 0), (0, -30))
        # it stands on the floor of its well: nothing but the gap was left below it
        assert abs(moved(page).get("latch", [0, 0, 0])[1]) < 1.1
        led(page, (65, 0), (65, 55))
        assert moved(page)["latch"][1] > 50  # it may have tilted, too
        free(page, assembly)
        led(page, (20, 25), (100, 25))
        assert moved(page)["drawer"][0] > 70
        free(page, assembly)


def test_a_combination_lock_opens_when_all_of_its_gates_point_up(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "lock.json"
    path.write_text(json.dumps(combination_lock()))
    assembly = wr.read(str(path))
    with serving(path) as served, visiting(browser, served) as page:
        ready(page)
        left: dict[str, list[float]] = {}
        for k, (x, angle) in enumerate(WHEELS.items(), 1):
            drag(page, (45, 36), (0, -8))
            assert moved(page)["bar"][1] > -2, "a wheel whose gate is elsewhere holds the bar"
            free(page, assembly)
            page.keyboard.press("Control+z")
            until(page, lambda: "bar" not in moved(page) or moved(page) == left, "the bar does not go back")  # noqa: B023
            by = (90 - angle + 180) % 360 - 180
            turn(page, (x, 0), 0.75 * RIM, angle + 90, by)
            assert np.degrees(moved(page)[f"wheel{k}"][2]) == pytest.approx(by, abs=3)
            free(page, assembly)
            left = moved(page)
        led(page, (45, 36), (45, 28))
        assert moved(page)["bar"][1] == pytest.approx(-8, abs=0.3)
        free(page, assembly)


def test_a_geneva_drive_goes_on_by_a_slot_for_each_turn(browser: Any) -> None:
    path = EXAMPLES / "23_mechanisms" / "geneva.svg"
    assembly = wr.read(str(path), gap=0.3, fix=["axle1", "axle2"])
    driver = assembly.rest[assembly.names.index("axle1"), :2]
    with serving(path) as served, visiting(browser, served) as page:
        page.get_by_label("gap, mm", exact=True).fill("0.3")
        page.get_by_label("gap, mm", exact=True).press("Enter")
        ready(page)
        seen = []
        for begin in (180.0, 270.0, 0.0, 90.0):
            turn(page, (float(driver[0]), float(driver[1])), 14.0, begin, 90.0)
            free(page, assembly)
            seen.append(np.degrees([moved(page).get(name, [0, 0, 0])[2] for name in ("driver", "wheel")]))
        turns = np.array(seen)
        assert turns[:, 0] == pytest.approx([90, 180, 270, 360], abs=6)
        assert abs(turns[0, 1]) < 3  # the disc holds the wheel
        assert abs(turns[3, 1]) == pytest.approx(60, abs=4)
