"""The first questions of a page, and the same again: how long each takes while nothing is compiled yet, and afterwards.

``python -m benchmarks.page_first`` starts the server with an empty cache of compiled kernels (``--compiled``: with that of this
checkout), opens an assembly and asks each question twice. It prints a row a question: the time to the settled reply [s] and the
processor time of the process that solves, the first time and again. It needs the extra ``page`` and websockets.
"""

from __future__ import annotations

import argparse
import json
import os
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


def measure(name: str) -> str:
    """One row of the table."""
    asked, request = QUESTIONS[name]
    with serving(*asked) as (server, address), asking(address) as page:
        told = []
        for _ in range(2):
            spent = sum(map(busy, solvers(server.pid)))
            told += [page.ask(request), sum(map(busy, solvers(server.pid))) - spent]
    numbers = " ".join(f"{v:8.2f}" for v in told)
    return f"{name:22s} {numbers}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiled", action="store_true", help="use what this checkout has compiled")
    parser.add_argument("--only", default="", help="questions whose names hold this")
    options = parser.parse_args()
    print("question               first [s], processor [s]; again [s], processor [s]")
    for name in [name for name in QUESTIONS if options.only in name]:
        with tempfile.TemporaryDirectory() as empty:
            if not options.compiled:
                os.environ["NUMBA_CACHE_DIR"] = empty
            print(measure(name), flush=True)


if __name__ == "__main__":
    main()
