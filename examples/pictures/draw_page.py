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
JIGSAW = [
    "serve",
    "examples/drawings/pyjigsaw_4x5.svg",
    "--gap",
    "1",
    "--fix",
    "p1",
    "--pull",
    "p20:+x",
    "--no-browser",
]
BOX = ["serve", "examples/40_box_with_a_lid/box.json", "--pull", "lid:+x", "--no-browser"]


def draw_dragged(
    words: list[str], grip: tuple[float, float], by: tuple[int, int], rest: int, name: str, *, sweep: bool = False
) -> None:
    """Serve a file, drag what lies at `grip` (shares of the stage) `by` pixels, and keep what is seen after a `rest` [ms]."""
    program = subprocess.Popen([sys.executable, "-c", SERVE, *words], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    try:
        address = program.stdout.readline().strip()
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
            page.goto(address)
            page.locator("#answer[data-settled=true]").wait_for(timeout=120_000)
            if sweep:
                page.click("text=Sweep")
                page.get_by_text("Sweeping…").wait_for()
                page.get_by_text("Sweep", exact=True).wait_for(timeout=300_000)
            box = page.locator(".stage canvas").bounding_box()
            assert box is not None
            x, y = box["x"] + grip[0] * box["width"], box["y"] + grip[1] * box["height"]
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + by[0], y + by[1], steps=12)
            page.locator("#answer", has_text="moved").wait_for()
            page.wait_for_timeout(rest)
            page.screenshot(path=ROOT / "docs" / "pictures" / name)
            browser.close()
    finally:
        program.terminate()
        program.wait(20)


def main() -> None:
    """Draw both pictures."""
    draw_dragged(BOX, (0.5, 0.42), (80, -30), 1000, "page_in_space.png")
    draw_dragged(JIGSAW, (0.49, 0.45), (110, -60), 7000, "page.png", sweep=True)  # by then notes have gone


if __name__ == "__main__":
    main()
