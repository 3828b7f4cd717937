"""A real server in a thread, and a page without a browser: a websocket client that keeps the protocol."""

from __future__ import annotations

import asyncio
import json
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from websockets.sync.client import ClientConnection, connect

from wiggleroom.app.server import Page, Server, listen

Json = dict[str, Any]
TOKEN = "a-token-for-tests"


class Served:
    """A server on a port of its own."""

    def __init__(self, first: Callable[[], bytes] | None = None) -> None:
        self.listening = listen(0)
        self.port = self.listening.getsockname()[1]
        self.page = Page(self.port, TOKEN, first)
        self.page.pool.warming.done = True  # nothing is compiled beside tests
        self.server = Server(self.page)
        self.thread = threading.Thread(
            target=lambda: asyncio.run(self.server.serve(sockets=[self.listening])), daemon=True
        )
        self.thread.start()
        while not self.server.started:
            time.sleep(0.01)

    def close(self) -> None:
        self.server.should_exit = True
        self.thread.join(20)
        self.listening.close()
        assert not self.thread.is_alive()

    def workers(self) -> list[int]:
        """Process numbers of the solver processes that pages have."""
        return [p.child.pid for p in self.page.pool.taken]

    @contextmanager
    def visit(self, **headers: str) -> Iterator[Visit]:
        """A page; its hello has been read."""
        with self.socket(**headers) as socket:
            page = Visit(socket)
            assert page.next()["kind"] == "hello"
            yield page

    def socket(self, token: str = TOKEN, host: str | None = None, origin: str | None = None) -> ClientConnection:
        at = f"127.0.0.1:{self.port}"
        extra = {} if host is None else {"Host": host}
        return connect(
            f"ws://{at}/socket?token={token}",
            origin=origin or f"http://{at}",  # type: ignore[arg-type]
            additional_headers=extra,
            max_size=None,
            compression=None,
        )


class Visit:
    """One page: sends requests with growing numbers, and reads replies with the motions that go before them."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.number = 0
        self.kinds: dict[int, str] = {}
        self.design: Json = {}
        self.opened: Json = {}
        self.told: list[Json] = []
        self.rings: list[list[list[list[float]]]] = []

    def next(self, seconds: float = 180.0) -> Json:
        """The next reply; its motions, (k, n, 3) each, in space (k, n, 7), under "motions"."""
        motions = []
        while isinstance(said := self.socket.recv(timeout=seconds), bytes):
            number, k, n, columns = struct.unpack("<4I", said[:16])
            assert columns in (0, 7)
            motions.append((number, np.frombuffer(said[16:], "<f4").reshape(k, n, columns or 3)))
        reply: Json = json.loads(said)
        assert all(number == reply["id"] for number, _ in motions)
        reply["motions"] = [m for _, m in motions]
        self.told.append(reply)
        self.rings = reply.get("rings", self.rings)
        return reply

    def send(self, kind: str, **more: Any) -> int:
        """Ask; the number of the request."""
        self.number += 1
        self.kinds[self.number] = kind
        design = {} if kind in ("open", "cancel", "assemble") else {"design": self.design}
        self.socket.send(json.dumps({"kind": kind, "id": self.number} | design | more))
        return self.number

    def until(self, number: int, kind: str = "", seconds: float = 180.0) -> Json:
        """The reply of this number that is no progress: of a kind, or that ends the request."""
        while True:
            reply = self.next(seconds)
            if reply.get("id") != number or reply["kind"] in ("progress", "step"):
                continue
            if reply["kind"] == "flex" != kind and self.kinds.get(number, "flex") != "flex":
                continue  # what a search has found before a study speaks of it
            if reply["kind"] == "failed" or (kind in ("", reply["kind"]) and reply.get("settled", True)):
                return reply

    def ask(self, kind: str, **more: Any) -> Json:
        """Ask and wait for the whole answer."""
        return self.until(self.send(kind, **more))

    def open(self, name: str, data: bytes, **more: Any) -> Json:
        """Drop a file on the page."""
        import base64

        reply = self.ask("open", name=name, data=base64.b64encode(data).decode(), **more)
        if reply["kind"] == "opened":
            self.design, self.opened = reply["design"], reply
        return reply
