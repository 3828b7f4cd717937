"""From the pointer to the picture: how soon a dragged part follows the hand, and how soon the true answer is painted.

``python -m benchmarks.page_drag`` drags random parts in headless Chromium, against the server as users start it, and
prints the load of the machine and a row an assembly: parts, the time from opening to the first settled answer and the
processor time of the server and of what solves until then, for 50 and 95 of 100 moves of the
pointer the time to the frame in which the part follows (predicted), to the first true motion for that place or a newer
one (corrected), the processor time of what solves for each reply, for 50, 95 and 100 of 100 replies the time to the
frame that shows them, and how many frames a second
were painted while the hand moved. ``--sides 10x10,27x25`` measures some.
It needs the extra ``page``, playwright and a Chromium.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import wiggleroom as wr
from benchmarks.page_first import busy as processor
from benchmarks.page_memory import serving, solvers
from wiggleroom.drawing.writers.assembly_writer import write_assembly

SIDES = ("4x5", "10x10", "27x25", "64x64")
DRAGS, STEPS = 12, 14
"""So many drags, each of so many moves of the pointer."""
FAR = 60.0
"""Furthest move of the pointer in one drag [px]."""

WATCH = """
(() => {
  const CLICK = 4; // nearer [px] to where the pointer was pressed, moves are a click's for the page, and of no drag
  const seen = (window.seen = { moves: [], painted: [], answers: [], replies: [], shown: [] });
  let [pressed, dragged] = [null, false];
  addEventListener("pointerdown", (event) => ([pressed, dragged] = [event, false]), true);
  addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    dragged ||= Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) >= CLICK;
    if (dragged) seen.moves.push(event.timeStamp);
  }, true);
  const frame = window.requestAnimationFrame.bind(window);
  let touched = false;
  window.requestAnimationFrame = (call) => frame((now) => {
    touched = false;
    call(now);
    if (touched) frame((next) => seen.painted.push(next)); // painting goes on after the call: the next frame tells
  });
  const image = CanvasRenderingContext2D.prototype.drawImage;
  const clear = CanvasRenderingContext2D.prototype.fillRect;
  const watched = (call) => function (...of) {
    touched ||= this.canvas.isConnected;
    return call.apply(this, of);
  };
  CanvasRenderingContext2D.prototype.drawImage = watched(image);
  CanvasRenderingContext2D.prototype.fillRect = watched(clear);
  const send = WebSocket.prototype.send;
  const asked = new Map();
  const heard = new WeakSet();
  const hear = ({ data }) => {
    const said = typeof data === "string" ? JSON.parse(data) : {};
    if (said.kind === "drag") seen.replies.push([said.id, performance.now()]);
  };
  WebSocket.prototype.send = function (text) {
    if (!heard.has(this)) this.addEventListener("message", hear);
    heard.add(this);
    const said = JSON.parse(text);
    if (said.kind === "drag") asked.set(said.id, seen.moves.at(-1));
    return send.call(this, text);
  };
  new MutationObserver((changes) => { // the canvas tells which answer all of its parts show
    const id = Number(changes.at(-1).target.dataset.shown);
    const about = asked.get(id);
    if (about !== undefined) frame((next) => (seen.answers.push([about, next]), seen.shown.push([id, next])));
  }).observe(document, { subtree: true, attributeFilter: ["data-shown"] });
})();
"""


def first_after(times: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """Waiting time from each moment to the first of some ascending times; what never came is infinite."""
    at = np.searchsorted(times, moments)
    return np.where(at < len(times), np.append(times, np.inf)[np.minimum(at, len(times))], np.inf) - moments


def until_shown(replies: list[list[float]], shown: list[list[float]]) -> np.ndarray:
    """Time [ms] from the first reply to each place of the hand to the frame that shows it or a newer one."""
    first = dict(reversed(replies))
    frames = np.array(shown).reshape(-1, 2)
    waits = [frames[(frames[:, 0] >= number) & (frames[:, 1] >= came), 1] - came for number, came in first.items()]
    return np.array([wait[0] if wait.size else np.inf for wait in waits])


def drag(page: Any, box: dict[str, float], random: np.random.Generator) -> None:
    """One drag from a random place of the picture's middle, in steps as a hand makes them."""
    x, y = box["x"] + box["width"] * random.uniform(0.35, 0.65), box["y"] + box["height"] * random.uniform(0.35, 0.6)
    page.mouse.move(x, y)
    page.mouse.down()
    angle, far = random.uniform(0, 2 * np.pi), random.uniform(0.3, 1) * FAR
    for step in range(1, STEPS + 1):
        page.mouse.move(x + far * np.cos(angle) * step / STEPS, y + far * np.sin(angle) * step / STEPS)
        page.wait_for_timeout(16)
    page.wait_for_timeout(int(random.uniform(200, 500)))
    page.mouse.up()
    page.wait_for_timeout(150)


class FrameTimes:
    """Processor time of the page's frames, as the browser traces it."""

    def __init__(self, browser: Any) -> None:
        self._events: list[dict[str, Any]] = []
        self._ended = False
        self._line = browser.new_browser_cdp_session()
        self._line.on("Tracing.dataCollected", lambda told: self._events.extend(told["value"]))
        self._line.on("Tracing.tracingComplete", lambda _: setattr(self, "_ended", True))
        traced = {"includedCategories": ["cc", "devtools.timeline"]}
        self._line.send("Tracing.start", {"traceConfig": traced, "transferMode": "ReportEvents"})

    def end(self, page: Any) -> list[float]:
        """One time a frame [ms]."""
        self._line.send("Tracing.end")
        while not self._ended:
            page.wait_for_timeout(50)
        return [e["tdur"] / 1e3 for e in self._events if e["name"] == "ProxyMain::BeginMainFrame" and "tdur" in e]


def measure(columns: int, rows: int) -> str:
    """One row of the table."""
    from playwright.sync_api import sync_playwright

    chromium = next(w for w in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if w)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "grid.json"
        assembly = wr.patterns.grid(columns, rows, joint="tee", gap=0.01)
        path.write_text(write_assembly(assembly.drawing))
        asked = (str(path), "--pull", f"{assembly.names[-1]}:+x")
        with serving(*asked) as (server, address), sync_playwright() as p:
            browser = p.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            page.add_init_script(WATCH)
            began = time.monotonic()
            page.goto(address)
            page.locator("#answer[data-settled=true]").wait_for(timeout=300_000)
            opened = time.monotonic() - began
            spent = processor(server.pid) + sum(map(processor, solvers(server.pid)))
            box = page.locator(".stage canvas").bounding_box()
            random = np.random.default_rng(1)
            drag(page, box, random)  # compiled code is loaded
            page.evaluate("for (const list of Object.values(seen)) list.length = 0")
            traced = FrameTimes(browser)
            solving = -sum(map(processor, solvers(server.pid)))
            for _ in range(DRAGS):
                drag(page, box, random)
            busy = traced.end(page)
            solving += sum(map(processor, solvers(server.pid)))
            page.wait_for_timeout(3000)
            seen = page.evaluate("seen")
            browser.close()
    moves, painted = np.array(seen["moves"]), np.array(seen["painted"])
    answers = np.array(seen["answers"]).reshape(-1, 2)
    predicted = first_after(painted, moves)
    order = np.argsort(answers[:, 0], kind="stable")
    about, told = answers[order, 0], np.minimum.accumulate(answers[order[::-1], 1])[::-1]
    at = np.searchsorted(about, moves)
    corrected = np.append(told, np.inf)[at] - moves
    numbers = [*np.percentile(predicted, [50, 95]), *np.percentile(corrected, [50, 95])]
    reply = np.percentile(until_shown(seen["replies"], seen["shown"]), [50, 95, 100])
    ends = np.percentile(busy, [95, 99])
    each = 1e3 * solving / max(len(seen["replies"]), 1)
    frames = 1e3 / np.median(np.diff(painted))
    waits = " ".join(f"{v:9.0f}" for v in numbers)
    shown = " ".join(f"{v:6.0f}" for v in reply)
    first = f"{os.getloadavg()[0]:6.1f} {columns * rows:6d} {opened:10.1f} {spent:6.1f}"
    return f"{first}   {waits} {each:6.0f}   {shown} {frames:12.0f} {ends[0]:12.1f} {ends[1]:6.1f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", default=",".join(SIDES))
    options = parser.parse_args()
    print(
        "  load  parts  first, processor [s]   predicted 50, 95 %   corrected 50, 95 %, processor   reply to frame 50, 95, 100 % [ms]"
        "   frames a second   work 95, 99 % [ms]"
    )
    for sides in options.sides.split(","):
        columns, rows = map(int, sides.split("x"))
        print(measure(columns, rows), flush=True)


if __name__ == "__main__":
    main()
