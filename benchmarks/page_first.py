"""The first answer of a page, and first questions of every kind: how long each takes while nothing is compiled yet, and afterwards.

``python -m benchmarks.page_first`` starts the server with an empty cache of compiled kernels (``--compiled``: with that of this
checkout; ``--python`` with what is installed for another Python, a wheel with its kernels perhaps). It prints first, from the start
of the server's process, when its address stands there, when a browser that runs already shows the drawing, and when it shows the
full answer [s]. Then it opens an assembly and asks each question twice: a row a question, the time to the settled reply [s] and the
processor time of the process that solves, the first time and again. It needs the extra ``page``, websockets, playwright and a Chromium.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

from benchmarks.page_memory import serving, solvers

EXAMPLES = Path(__file__).parents[1] / "examples"
JIGSAW = (str(EXAMPLES / "drawings" / "pyjigsaw_4x5.svg"), "--gap", "1", "--fix", "p1", "--pull", "p20:+x")
QUESTIONS: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "flex in the plane": (JIGSAW, {"kind": "flex", "thorough": True}),
    "check in the plane": (JIGSAW, {"kind": "check"}),
    "free space of p1|p6": (JIGSAW, {"kind": "space", "a": "p1", "b": "p6"}),
    "flex in space": ((str(EXAMPLES / "40_box_with_a_lid" / "box.json"),), {"kind": "flex", "thorough": True}),
    "check in space": ((str(EXAMPLES / "40_box_with_a_lid" / "box.json"),), {"kind": "check"}),
}
PATIENCE = 600.0
"""Nothing takes longer [s]."""


class Asker:
    """A page without a browser.

    Parameters
    ----------
    socket : ClientConnection
    """

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._number = 0
        told = self.until("opened", 0)
        self.design = told["design"]
        if not self.design["goals"]:  # as the page does
            self.design["goals"] = [told["pulled"]]

    def until(self, kind: str, number: int) -> dict[str, Any]:
        """The last reply to a request."""
        while True:
            said = self._socket.recv(timeout=PATIENCE)
            if isinstance(said, bytes):
                continue
            told = json.loads(said)
            if told["kind"] == "failed":
                raise SystemExit(f"{kind}: {told['findings']}")
            if told.get("id") == number and told["kind"] == kind and told.get("settled", True):
                return told

    def ask(self, request: dict[str, Any]) -> float:
        """Time from the question to its settled reply [s]."""
        self._number += 1
        began = time.monotonic()
        self._socket.send(json.dumps(request | {"id": self._number, "design": self.design}))
        self.until(request["kind"], self._number)
        return time.monotonic() - began


@contextmanager
def asking(address: str) -> Iterator[Asker]:
    """A page at the address that a server prints."""
    where = address.removeprefix("http").replace("/?", "/socket?")
    origin: Any = address.split("/?")[0]
    with connect(f"ws{where}", origin=origin, max_size=None, compression=None) as socket:
        yield Asker(socket)


def busy(pid: int) -> float:
    """Processor time of a process [s]."""
    spent = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(spent[11]) + int(spent[12])) / os.sysconf("SC_CLK_TCK")


def measure_start(python: str) -> str:
    """From the start of the server to its address, the drawing and the full answer on the screen, and processor time until then [s]."""
    from playwright.sync_api import sync_playwright

    chromium = next(w for w in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if w)
    with sync_playwright() as p:
        browser = p.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto("about:blank")
        began, told = time.monotonic(), []
        with serving(*JIGSAW, python=python) as (server, address):
            told.append(time.monotonic() - began)
            page.goto(address, wait_until="commit")
            for shown in ('.stage canvas[aria-label^="20 parts"]', "#answer[data-settled=true]"):
                page.locator(shown).wait_for(timeout=1000 * PATIENCE)
                told.append(time.monotonic() - began)
            spent = [busy(server.pid), sum(map(busy, solvers(server.pid)))]
        browser.close()
    address, drawing, answer = told
    return (
        f"from the start: address {address:.2f} s, drawing {drawing:.2f} s, full answer {answer:.2f} s; "
        f"processor time of the server {spent[0]:.2f} s, of what solves {spent[1]:.2f} s"
    )


def measure(name: str, python: str) -> str:
    """One row of the table."""
    asked, request = QUESTIONS[name]
    with serving(*asked, python=python) as (server, address), asking(address) as page:
        told = []
        for _ in range(2):
            spent = sum(map(busy, solvers(server.pid)))
            told += [page.ask(request), sum(map(busy, solvers(server.pid))) - spent]
    numbers = " ".join(f"{v:8.2f}" for v in told)
    return f"{name:22s} {numbers}"


@contextmanager
def cached(compiled: bool) -> Iterator[None]:
    """The cache of compiled kernels of this checkout, or an empty one."""
    with tempfile.TemporaryDirectory() as empty:
        if not compiled:
            os.environ["NUMBA_CACHE_DIR"] = empty
        yield


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiled", action="store_true", help="use what this checkout has compiled")
    parser.add_argument("--python", default=sys.executable, help="of the environment whose installation is measured")
    parser.add_argument(
        "--only", default="", help='questions whose names hold this; "start" is from the start of the server'
    )
    options = parser.parse_args()
    if options.only in "start":
        with cached(options.compiled):
            print(measure_start(options.python), flush=True)
    print("question               first [s], processor [s]; again [s], processor [s]")
    for name in [name for name in QUESTIONS if options.only in name]:
        with cached(options.compiled):
            print(measure(name, options.python), flush=True)


if __name__ == "__main__":
    main()
