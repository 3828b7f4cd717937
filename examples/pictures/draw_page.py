"""Pictures of the live page in docs/pictures: a piece of a jigsaw, and the lid of a box in space, are dragged.

Needs Chromium and the extras `browser` and `page`:  python examples/pictures/draw_page.py
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[2]
SERVE = "import sys; from wiggleroom.cli import main; sys.exit(main())"
ASKED = ["serve", "examples/drawings/pyjigsaw_4x5.svg", "--gap", "1", "--fix", "p1", "--pull", "p20:+x", "--no-browser"]


IN_SPACE = ["serve", "examples/40_box_with_a_lid/box.json", "--pull", "lid:+x", "--no-browser"]


def draw_in_space() -> None:
    """Serve the box, drag its lid, and keep what is seen."""
    program = subprocess.Popen([sys.executable, "-c", SERVE, *IN_SPACE], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    try:
        address = program.stdout.readline().strip()
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
            page.goto(address)
            page.locator("#answer[data-settled=true]").wait_for(timeout=120_000)
            box = page.locator(".stage canvas").bounding_box()
            assert box is not None
            x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.42 * box["height"]
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + 80, y - 30, steps=12)
            page.locator("#answer", has_text="moved").wait_for()
            page.wait_for_timeout(1000)
            page.screenshot(path=ROOT / "docs" / "pictures" / "page_in_space.png")
            browser.close()
    finally:
        program.terminate()
        program.wait(20)


def main() -> None:
    """Serve the jigsaw, drag one of its pieces, and keep what is seen."""
    draw_in_space()
    program = subprocess.Popen([sys.executable, "-c", SERVE, *ASKED], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    try:
        address = program.stdout.readline().strip()
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
            page.goto(address)
            page.locator("#answer[data-settled=true]").wait_for()
            for gap in ("0.5", "1.5", "1"):  # the curve grows
                page.fill(".gapbox input", gap)
                page.press(".gapbox input", "Enter")
                page.wait_for_timeout(2500)
            box = page.locator(".stage canvas").bounding_box()
            assert box is not None
            x, y = box["x"] + 0.49 * box["width"], box["y"] + 0.45 * box["height"]
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + 110, y - 60, steps=12)
            page.locator("#answer", has_text="moved").wait_for()
            page.wait_for_timeout(7000)  # notes have gone
            page.screenshot(path=ROOT / "docs" / "pictures" / "page.png")
            browser.close()
    finally:
        program.terminate()
        program.wait(20)


if __name__ == "__main__":
    main()
