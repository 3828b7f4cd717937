"""The server of the page: a fixed list of files and one socket, on this machine alone, for those who know the token."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import hmac
import signal
import socket
from collections.abc import AsyncIterator, Callable, Iterator
from importlib import resources
from importlib.util import find_spec

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from wiggleroom.app.http_limits import LimitedHttp
from wiggleroom.app.made_drawing import joint_families
from wiggleroom.app.messages import encode, failed
from wiggleroom.app.process import MAX_PAGES, Pool
from wiggleroom.app.refusal import REFUSAL, REFUSAL_POLICY
from wiggleroom.app.resource_limits import UPLOAD_MB
from wiggleroom.app.samples import sample_entries
from wiggleroom.app.session import Session
from wiggleroom.app.websocket_limits import LimitedWebSocket
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import Hello, UploadLimits
from wiggleroom.studies.forms import study_forms

MAX_MESSAGE_BYTES = (UPLOAD_MB + 1) * 4 * 1024 * 1024 // 3
"""Bytes of one message: an upload in base64, and what goes with it."""
MESSAGES_PER_SECOND = 500
"""Messages that a page may send in a second on average; further ones wait. A moving hand sends up to 240."""
BURST_SECONDS = 1.0
"""A page that was silent may send at once what else it might in this time [s]."""
LOOP_SHARE = 0.2
"""Share of the server's time that reading the messages of one page may take, where that is more."""
WATCH_SECONDS = 0.7
"""So often it is looked whether the file of the command has changed [s]."""
MAX_HEADER_BYTES = 16 * 1024
"""Bytes of the headers of one request."""
USUAL_PORT = 8459
"""A browser keeps recent files by address: the same port from day to day finds them again."""
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' blob: data:; "
        "font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
MEDIA_TYPES = {
    "html": "text/html",
    "js": "text/javascript",
    "css": "text/css",
    "svg": "image/svg+xml",
    "png": "image/png",
}
EXTRAS = {"dxf": ("ezdxf",), "fast": ("rslab",), "film": ("PIL", "av"), "prove": ("highspy",)}
"""Extras the page asks about, and what they install."""


def files() -> dict[str, bytes]:
    """Files of the page by name, all that can be had."""
    folder = resources.files("wiggleroom.report") / "web"
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


class Page:
    """The application: who may ask, and what is there.

    Parameters
    ----------
    port : int
    token : str
        Whoever shows it may ask.
    first : callable, optional
        Gives the `open` of a file that the command was given, as the file now is; every page begins with it. Raises InputError.
    pool : Pool, optional
        Solver processes; the first one may have been begun.
    """

    def __init__(
        self, port: int, token: str, first: Callable[[], bytes] | None = None, pool: Pool | None = None
    ) -> None:
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}
        self._token, self._first = token, first
        self._files = files()
        self._packed = {name: gzip.compress(data, mtime=0) for name, data in self._files.items()}
        self._pages = 0
        self.pool = pool or Pool()
        paths = ["/", *(f"/{name}" for name in self._files)]
        routes = [*(Route(path, self._file) for path in paths), WebSocketRoute("/socket", self._socket)]
        self.app = Starlette(routes=routes, lifespan=self._life)

    @contextlib.asynccontextmanager
    async def _life(self, _: Starlette) -> AsyncIterator[None]:
        await self.pool.prepare()
        greeting = asyncio.create_task(asyncio.to_thread(hello))  # loads what it lists while the browser starts
        yield
        await greeting
        await self.pool.close()

    def _known(self, asked: HTTPConnection) -> bool:
        """Whether a request comes to this address."""
        return asked.headers.get("host", "") in self._hosts

    def _trusted(self, asked: HTTPConnection) -> bool:
        given = asked.query_params.get("token", "").encode("utf-8", "replace")
        return hmac.compare_digest(given, self._token.encode())

    async def _file(self, request: Request) -> Response:
        """One file of the page; only the page itself needs the token, for the others hold nothing of the user's."""
        if not self._known(request):
            return PlainTextResponse("this server answers to its own address only", 421, HEADERS)
        name = request.url.path.lstrip("/") or "index.html"
        if request.url.path == "/" and not self._trusted(request):
            headers = HEADERS | {"Content-Security-Policy": REFUSAL_POLICY}
            return Response(REFUSAL, 403, headers, media_type="text/html")
        kind = MEDIA_TYPES.get(name.rpartition(".")[2], "application/octet-stream")
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(self._packed[name], media_type=kind, headers=HEADERS | {"Content-Encoding": "gzip"})
        return Response(self._files[name], media_type=kind, headers=HEADERS)

    async def _socket(self, socket: WebSocket) -> None:
        """One page, from its hello to its end."""
        origins = {f"http://{host}" for host in self._hosts}
        if not (self._known(socket) and socket.headers.get("origin") in origins and self._trusted(socket)):
            await socket.close(1008)  # before it is accepted: 403
            return
        await socket.accept()
        lock = asyncio.Lock()
        watch = Watch(self._first)

        async def send(frames: list[bytes], text: bytes) -> None:
            async with lock:
                for one in frames:
                    await socket.send_bytes(one)
                await socket.send_text(text.decode())

        for _ in range(20):  # a page that is reloaded may come before it has gone
            if self._pages < MAX_PAGES:
                break
            await asyncio.sleep(0.05)
        else:
            line = f"{MAX_PAGES} pages are open already; close one of them, then reload this one"
            await send([], encode(failed(0, "hello", [line])))
            await socket.close(1013)
            return
        self._pages += 1
        try:
            await send([], encode(hello()))
            first, findings = await watch.look()
            if findings:
                await send([], encode(failed(0, "open", findings)))
            await self._talk(socket, Session(self.pool, send, first), watch)
        finally:
            self._pages -= 1

    async def _talk(self, socket: WebSocket, session: Session, watch: Watch) -> None:
        """Frames in, answers out, until one side ends; then the next page's process is made ready."""
        loop = asyncio.get_running_loop()
        talk = (session.run(), _listen(socket, session), watch.run(session))
        sides = [asyncio.create_task(side) for side in talk]
        try:
            await asyncio.wait(sides, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for side in sides:
                side.cancel()
            await asyncio.gather(*sides, return_exceptions=True)
            with contextlib.suppress(RuntimeError):  # closed by the page
                await socket.close(1011)
            loop.call_soon(lambda: asyncio.ensure_future(self.pool.prepare()))


class Watch:
    """The file that the command was given, looked at again and again: what is open in a page follows it.

    Parameters
    ----------
    first : callable or None
        As for `Page`; the same object while nothing has changed.
    """

    def __init__(self, first: Callable[[], bytes] | None) -> None:
        self._first = first
        self._seen: tuple[bytes | None, tuple[str, ...]] = None, ()

    async def look(self) -> tuple[bytes | None, tuple[str, ...]]:
        """The request that opens the file as it now is, or why it cannot be read."""
        if self._first is not None:
            try:
                self._seen = await asyncio.to_thread(self._first), ()
            except InputError as problem:
                self._seen = None, tuple(problem.findings)
        return self._seen

    async def run(self, session: Session) -> None:
        """Tell a page what has changed; what cannot be read counts once it is so twice: a file may be half written."""
        opened, told, doubtful = self._seen[0], self._seen[1], False
        while self._first is not None:
            await asyncio.sleep(WATCH_SECONDS)
            request, findings = await self.look()
            if findings and findings != told and doubtful:
                told = findings
                await session.refuse_open(findings)
            doubtful = bool(findings)
            if request is not None and (request is not opened or told):
                opened, told = request, ()
                session.changed(request)
        await asyncio.Event().wait()


async def _listen(socket: WebSocket, session: Session) -> None:
    """Pass frames of a page on until it goes, no faster than it may send them: a token bucket, filled with seconds."""
    clock = asyncio.get_running_loop().time
    left, before = BURST_SECONDS, clock()
    with contextlib.suppress(WebSocketDisconnect):
        while (said := await socket.receive())["type"] != "websocket.disconnect":
            began = clock()
            if said.get("text") is None:
                await session.refuse("message: a text frame is expected, this was a binary one")
            else:
                await session.submit(said["text"].encode())
            now = clock()
            cost = max(1 / MESSAGES_PER_SECOND, (now - began) / LOOP_SHARE)
            left = min(left + now - before, BURST_SECONDS) - cost
            before = now
            await asyncio.sleep(max(0.0, -left))  # at least one turn for others


def hello() -> Hello:
    """First words to a page: what this installation can do."""
    from importlib.metadata import version

    can = [extra for extra, needs in EXTRAS.items() if all(find_spec(n) is not None for n in needs)]
    return Hello(
        version=version("wiggleroom"), can=can, limits=UploadLimits(UPLOAD_MB), samples=list(sample_entries()),
        studies=study_forms(), joints=joint_families(),
    )  # fmt: skip


def listen_anywhere(port: int) -> socket.socket:
    """Socket at a port, or where that is taken at one that is free."""
    try:
        return listen(port)
    except OSError:
        return listen(0)


def listen(port: int) -> socket.socket:
    """Socket on this machine's own address; raises OSError where the port is taken."""
    # asyncio sends small frames at once only where the protocol is named: else replies wait 40 ms for an acknowledgement
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", port))
    except OSError:
        listening.close()
        raise
    return listening


class Server(uvicorn.Server):
    """A server that leaves signals to others.

    Parameters
    ----------
    page : Page
    """

    def __init__(self, page: Page) -> None:
        config = uvicorn.Config(
            page.app,
            http=LimitedHttp,
            h11_max_incomplete_event_size=MAX_HEADER_BYTES,
            ws=LimitedWebSocket,
            ws_max_size=MAX_MESSAGE_BYTES,
            ws_per_message_deflate=False,  # nothing to win on one machine, and no bombs
            log_config=None,
            log_level="critical",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=2,
        )
        super().__init__(config)

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Capture none."""
        yield


def serve(runner: asyncio.Runner, page: Page, listening: socket.socket, started: Callable[[], None]) -> None:
    """Answer until Ctrl-C or SIGTERM; then all processes are gone.

    Parameters
    ----------
    runner : asyncio.Runner
        Whose loop began the processes of the page.
    page : Page
    listening : socket
        From `listen`.
    started : callable
        Called once when pages may come.
    """
    server = Server(page)

    async def run() -> None:
        loop = asyncio.get_running_loop()
        for one in (signal.SIGINT, signal.SIGTERM):
            signal.signal(one, lambda *_: loop.call_soon_threadsafe(setattr, server, "should_exit", True))
        listening.listen()  # who comes early waits
        loop.call_soon(started)
        await server.serve(sockets=[listening])

    runner.run(run())
