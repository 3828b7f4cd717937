"""Attacks on the server of the page, while a well-behaved page asks and newcomers come: `python -m benchmarks.attack_server SECONDS`.

Each attack runs so many seconds on a server of its own process. Printed are how long the page waited for replies and newcomers for
the page, median and worst, and how much memory the server took. The last column says "held" where nobody waited longer than
`PATIENCE` seconds and the memory stayed below `MEMORY_MB`; a server that complains on stderr, or lets a stranger in, ends the run.
"""

from __future__ import annotations

import base64
import contextlib
import http.client
import json
import os
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from websockets.sync.client import connect

PATIENCE = 5.0
"""Nobody waits longer [s]."""
MEMORY_MB = 400.0
"""The server has no more [MB]; 120 of it are the libraries."""
BOXES = {
    "format": "wiggleroom/1",
    "gap": 0.1,
    "parts": [
        {"name": "a", "outline": [[0, 0], [9, 0], [9, 9], [0, 9]], "fixed": True},
        {"name": "b", "outline": [[10, 0], [19, 0], [19, 9], [10, 9]]},
    ],
}


@dataclass(frozen=True)
class Target:
    """Where a server listens."""

    port: int
    token: str
    pid: int = 0

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    def socket(self) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), 5)

    def handshake(self, **other: str) -> bytes:
        """Request of a page's socket; `other` replaces host, origin or token."""
        said = {"host": self.host, "origin": f"http://{self.host}", "token": self.token} | other
        key = base64.b64encode(os.urandom(16)).decode()
        return (
            f"GET /socket?token={said['token']} HTTP/1.1\r\nHost: {said['host']}\r\nOrigin: {said['origin']}\r\n"
            f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
        ).encode()

    def page(self) -> socket.socket:
        """Socket of a hostile page that knows the token."""
        raw = self.socket()
        raw.sendall(self.handshake())
        head = b""
        while b"\r\n\r\n" not in head:
            got = raw.recv(4096)
            if not got:
                break
            head += got
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise ConnectionError(head.decode("latin-1"))
        return raw


def frame(data: bytes, code: int = 1, last: bool = True) -> bytes:
    """A masked frame of a client; the mask is zero."""
    head = bytes([code | (128 if last else 0)])
    if len(data) < 126:
        return head + bytes([128 | len(data)]) + bytes(4) + data
    if len(data) < 65536:
        return head + bytes([254]) + struct.pack(">H", len(data)) + bytes(4) + data
    return head + bytes([255]) + struct.pack(">Q", len(data)) + bytes(4) + data


Stop = threading.Event


def hold(target: Target, stop: Stop, first: bytes, drip: bytes, many: int) -> None:
    """Many connections that begin something and never end it; those that are closed come again."""
    held: list[socket.socket] = []
    try:
        while not stop.is_set():
            while len(held) < many and not stop.is_set():
                with contextlib.suppress(OSError):
                    held.append(raw := target.socket())
                    raw.sendall(first)
                    raw.setblocking(False)
            for raw in list(held):
                try:
                    if drip:
                        raw.send(drip)
                    elif raw.recv(1, socket.MSG_PEEK) == b"":
                        raise ConnectionResetError
                except BlockingIOError:
                    continue
                except OSError:
                    held.remove(raw)
                    raw.close()
            stop.wait(0.2)
    finally:
        for raw in held:
            raw.close()


def slow_headers(target: Target, stop: Stop) -> None:
    hold(target, stop, f"GET /?token=x HTTP/1.1\r\nHost: {target.host}\r\nX: ".encode(), b"a", 80)


def idle_sockets(target: Target, stop: Stop) -> None:
    hold(target, stop, b"", b"", 200)


def slow_bodies(target: Target, stop: Stop) -> None:
    hold(
        target, stop, f"POST / HTTP/1.1\r\nHost: {target.host}\r\nContent-Length: 1000000000\r\n\r\n".encode(), b"a", 80
    )


def replies_that_nobody_reads(target: Target, stop: Stop) -> None:
    hold(target, stop, f"GET /space-view.js HTTP/1.1\r\nHost: {target.host}\r\n\r\n".encode() * 20, b"", 80)


def push(stop: Stop, begin: Callable[[], socket.socket], data: bytes) -> None:
    """Send the same data on and on, on a new connection where the old one was closed."""
    while not stop.is_set():
        try:
            with begin() as raw:
                raw.settimeout(0.5)
                rest = memoryview(b"")
                while not stop.is_set():
                    rest = rest or memoryview(data)
                    with contextlib.suppress(TimeoutError):
                        rest = rest[raw.send(rest) :]
        except OSError:
            time.sleep(0.02)


def giant_headers(target: Target, stop: Stop) -> None:
    push(stop, target.socket, b"GET / HTTP/1.1\r\nX: " + b"a" * 4_000_000)


def giant_bodies(target: Target, stop: Stop) -> None:
    head = f"POST / HTTP/1.1\r\nHost: {target.host}\r\nContent-Length: 100000000000\r\n\r\n".encode()
    push(stop, target.socket, head + b"a" * 4_000_000)


def requests_in_a_row(target: Target, stop: Stop) -> None:
    push(stop, target.socket, f"GET /page.css HTTP/1.1\r\nHost: {target.host}\r\n\r\n".encode() * 1000)


def giant_frames(target: Target, stop: Stop) -> None:
    push(stop, target.page, b"\x81\xff" + struct.pack(">Q", 1 << 40) + bytes(4) + b"a" * 4_000_000)


def full_frames(target: Target, stop: Stop) -> None:
    """Messages just below the largest that is taken, all of them nonsense."""
    push(stop, target.page, frame(b'{"kind": "open", "id": 1, "name": "' + b"a" * 27_000_000))


def pieces_of_nothing(target: Target, stop: Stop) -> None:
    push(stop, target.page, frame(b"a", last=False) + frame(b"", 0, last=False) * 100_000)


def pings(target: Target, stop: Stop) -> None:
    push(stop, target.page, frame(b"a" * 100, 9) * 10_000)


def nonsense(target: Target, stop: Stop) -> None:
    push(stop, target.page, frame(b"x") * 10_000)


def questions(target: Target, stop: Stop) -> None:
    """Valid requests as fast as they go, whose replies nobody reads."""
    opening = json.dumps(
        {"kind": "open", "id": 1, "name": "a.json", "data": base64.b64encode(json.dumps(BOXES).encode()).decode()}
    )
    asked = json.dumps({"kind": "shape", "id": 2, "design": {"gap": 0.1}})
    push(stop, target.page, frame(opening.encode()) + frame(asked.encode()) * 10_000)


def large_designs(target: Target, stop: Stop) -> None:
    """Designs just below the largest that is taken."""
    glue = [["a", "b"]] * 99_000
    asked = json.dumps({"kind": "flex", "id": 2, "design": {"glue": glue}}, separators=(",", ":"))
    push(stop, target.page, frame(asked.encode()))


def strangers(target: Target, stop: Stop) -> None:
    """Wrong hosts, origins and tokens; each must be refused."""
    others = (
        {"host": "evil.example"},
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"token": "x"},
        {"token": ""},
    )
    while not stop.is_set():
        for other in others:
            with contextlib.suppress(OSError), target.socket() as raw:
                raw.sendall(target.handshake(**other))
                said = raw.recv(4096).split(b"\r\n")[0]
                if said and b" 403 " not in said:
                    message = f"a stranger was let in: {other}: {said!r}"
                    raise AssertionError(message)


ATTACKS: tuple[Callable[[Target, Stop], None], ...] = (
    slow_headers, idle_sockets, slow_bodies, replies_that_nobody_reads, giant_headers, giant_bodies, requests_in_a_row,
    giant_frames, full_frames, pieces_of_nothing, pings, nonsense, questions, large_designs, strangers,
)  # fmt: skip


@dataclass
class Waits:
    """How long somebody waited [s]."""

    seconds: list[float] = field(default_factory=list)
    failed: str = ""

    @property
    def worst(self) -> float:
        return float("inf") if self.failed or not self.seconds else max(self.seconds)

    @property
    def median(self) -> float:
        return statistics.median(self.seconds) if self.seconds else float("inf")


def well_behaved(target: Target, stop: Stop, ready: Stop, waits: Waits) -> None:
    """A page that asks, waits, and asks again."""
    try:
        with connect(
            f"ws://{target.host}/socket?token={target.token}",
            origin=f"http://{target.host}",
            max_size=None,  # type: ignore[arg-type]
        ) as page:
            design, loaded = None, False
            data = base64.b64encode(json.dumps(BOXES).encode()).decode()
            page.send(json.dumps({"kind": "open", "id": 1, "name": "boxes.json", "data": data}))
            number = 1
            while not stop.is_set():
                began = time.perf_counter()
                if design is not None:
                    number += 1
                    page.send(json.dumps({"kind": "shape", "id": number, "design": design}))
                while True:
                    said = page.recv(
                        timeout=2 * PATIENCE if ready.is_set() else 600
                    )  # its process may have kernels to compile
                    reply = json.loads(said) if isinstance(said, str) else {}
                    loaded = loaded or (reply.get("kind"), reply.get("state")) == ("worker", "ready")
                    if reply.get("id") == number and reply["kind"] in ("opened", "shape", "failed"):
                        break
                if reply["kind"] == "failed":
                    waits.failed = reply["findings"][0]
                    return
                if design is None:
                    design = reply["design"]
                elif loaded and not ready.is_set():
                    ready.set()
                elif loaded:
                    waits.seconds.append(time.perf_counter() - began)
                stop.wait(0.05)
    except Exception as problem:
        waits.failed = f"{type(problem).__name__}: {problem}"
    finally:
        ready.set()


def newcomers(target: Target, stop: Stop, waits: Waits) -> None:
    """Visitors who want the page, one after the other."""
    while not stop.is_set():
        began = time.perf_counter()
        try:
            with contextlib.closing(
                http.client.HTTPConnection("127.0.0.1", target.port, timeout=2 * PATIENCE)
            ) as asked:
                asked.request("GET", f"/?token={target.token}", headers={"Host": target.host})
                reply = asked.getresponse()
                reply.read()
                if reply.status != 200:
                    waits.failed = f"status {reply.status}"
            waits.seconds.append(time.perf_counter() - began)
        except OSError as problem:
            waits.failed = f"{type(problem).__name__}: {problem}"
        stop.wait(0.1)


@dataclass(frozen=True)
class Outcome:
    """What an attack did to others."""

    attack: str
    page: Waits
    newcomers: Waits
    memory: float

    @property
    def held(self) -> bool:
        return max(self.page.worst, self.newcomers.worst) < PATIENCE and self.memory < MEMORY_MB


def resident(pid: int) -> float:
    """Memory of a process [MB]; 0 where it cannot be told."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, ValueError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def under(attack: Callable[[Target, Stop], None] | None, target: Target, seconds: float) -> Outcome:
    """Attack for so long, with a page that asks and newcomers that come."""
    stop, ready, at_once = Stop(), Stop(), Stop()
    page, visits, memory = Waits(), Waits(), 0.0
    wrong: list[BaseException] = []

    def attacking() -> None:
        try:
            if attack is not None:
                attack(target, at_once)
        except BaseException as problem:
            wrong.append(problem)

    asking = threading.Thread(target=well_behaved, args=(target, stop, ready, page))
    asking.start()
    ready.wait(600)
    others = [threading.Thread(target=attacking), threading.Thread(target=newcomers, args=(target, stop, visits))]
    for one in others:
        one.start()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        memory = max(memory, resident(target.pid))
        time.sleep(0.1)
    at_once.set()
    stop.set()
    for one in (asking, *others):
        one.join(60)
    if wrong:
        raise wrong[0]
    return Outcome("nothing" if attack is None else attack.__name__.replace("_", " "), page, visits, memory)


@contextlib.contextmanager
def serving() -> Iterator[Target]:
    """A server in a process of its own."""
    code = "from wiggleroom.cli import main; raise SystemExit(main())"
    with tempfile.TemporaryFile("w+") as said:
        command = [sys.executable, "-c", code, "serve", "--no-browser"]
        child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said, text=True)
        try:
            assert child.stdout is not None
            address = child.stdout.readline().strip()
            yield Target(int(address.split(":")[2].split("/")[0]), address.split("token=")[1], child.pid)
        finally:
            child.terminate()
            child.wait(20)
            if child.stdout is not None:
                child.stdout.close()
        said.seek(0)
        if noise := said.read():
            message = f"the server complained: {noise[:400]}"
            raise AssertionError(message)


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    print("| attack | page waits s | worst | newcomer waits s | worst | memory MB | |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for attack in (None, *ATTACKS):
        with serving() as target:
            found = under(attack, target, seconds)
        numbers = (found.page.median, found.page.worst, found.newcomers.median, found.newcomers.worst)
        said = "held" if found.held else f"NOT HELD {found.page.failed} {found.newcomers.failed}"
        print(
            f"| {found.attack} | {' | '.join(f'{n:.3f}' for n in numbers)} | {found.memory:.0f} | {said} |", flush=True
        )


if __name__ == "__main__":
    main()
