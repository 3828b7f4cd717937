"""Memory of the page, its server and its solver while parts are dragged at random for minutes.

``python -m benchmarks.page_memory --minutes 10`` opens 100 parts (``--large``: 675) in headless Chromium, drags random parts to
random places without a rest, and prints a row every half a minute: resident memory of the server and of the process that
solves, and what the page's scripts hold after their garbage was collected. It needs the extra ``page``, playwright and a
Chromium.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

import wiggleroom as wr
from wiggleroom.drawing.writers.assembly_writer import write_assembly

DRAWING = Path(__file__).parents[1] / "examples" / "drawings" / "jointpanel_10x10.svg"
ASKED = ("--gap", "0.2", "--fix", "p-1", "--pull", "p-99:+x")
GRID = (27, 25)
"""Columns and rows of the large assembly."""
STEPS = 6
"""Moves of the pointer in one drag."""
FAR = 60.0
"""Furthest move of the pointer in one drag [px]."""


@contextmanager
def serving(*asked: str, python: str = sys.executable) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The server as users start it with a file and options, and the address that it prints.

    Another Python runs what is installed for it, not this checkout.
    """
    command = [
        python,
        "-c",
        "from wiggleroom.cli import main; main()",
        "serve",
        *asked,
        "--no-browser",
    ]
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH" or python == sys.executable}
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert server.stdout is not None
        yield server, server.stdout.readline().strip()
    finally:
        server.terminate()
        server.wait(20)


def resident(pid: int) -> float:
    """Resident memory of a process [MB]."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS"))


def solvers(pid: int) -> list[int]:
    """Processes that a server has started: one for the page, and one that waits for the next page."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def drag(page: Any, box: dict[str, float], random: np.random.Generator) -> bool:
    """One drag of whatever lies at a random place of the picture's middle; True where the page says that a part was dragged."""
    x, y = box["x"] + box["width"] * random.uniform(0.35, 0.65), box["y"] + box["height"] * random.uniform(0.3, 0.6)
    page.mouse.move(x, y)
    page.mouse.down()
    x, y = x + random.uniform(-FAR, FAR), y + random.uniform(-FAR, FAR)
    page.mouse.move(x, y, steps=STEPS)
    page.wait_for_timeout(int(random.uniform(50, 400)))
    said = page.locator("#answer").inner_text()
    page.mouse.up()
    page.keyboard.press("0")  # where nothing lay the view was moved
    return "moved" in said or "follows" in said


def measure(asked: Sequence[str], minutes: float, every: float) -> None:
    """Print the table."""
    from playwright.sync_api import sync_playwright

    chromium = next(w for w in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if w)
    with serving(*asked) as (server, address), sync_playwright() as p:
        browser = p.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(address)
        page.locator("#answer[data-settled=true]").wait_for(timeout=120_000)
        box = page.locator(".stage canvas").bounding_box()
        heap = page.context.new_cdp_session(page)
        random, began, row, drags = np.random.default_rng(1), time.monotonic(), 0, 0
        print("minutes  drags  server [MB]  solver [MB]  page's heap [MB]  nodes", flush=True)
        while True:
            now = time.monotonic() - began
            if now >= row * every:
                row += 1
                heap.send("HeapProfiler.collectGarbage")
                used = heap.send("Runtime.getHeapUsage")["usedSize"] / 2**20
                nodes = heap.send("Memory.getDOMCounters")["nodes"]
                solver = max(map(resident, solvers(server.pid)))
                print(
                    f"{now / 60:7.1f} {drags:6d} {resident(server.pid):12.1f} {solver:12.1f} {used:17.2f} {nodes:6d}",
                    flush=True,
                )
            if now >= 60 * minutes:
                break
            drags += drag(page, box, random)
        browser.close()


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--every", type=float, default=30.0, help="seconds from row to row")
    parser.add_argument("--large", action="store_true", help="a grid of 675 parts")
    options = parser.parse_args()
    if not options.large:
        measure([str(DRAWING), *ASKED], options.minutes, options.every)
    else:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "grid.json"
            assembly = wr.patterns.grid(*GRID, joint="tee", gap=0.01)
            path.write_text(write_assembly(assembly.drawing))
            measure([str(path), "--pull", f"{assembly.names[-1]}:+x"], options.minutes, options.every)


if __name__ == "__main__":
    main()
