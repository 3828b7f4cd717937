"""`wiggleroom serve`."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions, asked_drawing, read_options
from wiggleroom.errors import InputError

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Callable

    from wiggleroom.app.process import Pool

_NONE_ASKED = QuestionOptions()


def serve(
    file: str | None = None,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    port: int = 0,
    browser: bool = True,
) -> int:
    """Open the live page: move the gap, drag a part, see where it stops and why.

    The page is for this machine alone, and opened files do not leave it. Without a file, drop one on the page. Ctrl-C
    ends it.

    Example: wiggleroom serve puzzle.svg --gap 0.2 --fix p1 --pull p20:+x

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), also one in space.
    port
        Port on this machine. Default: the usual one, so that the page knows its recent files, or else a free one.
    browser
        Open the page in the browser; --no-browser prints its address only.
    """
    import asyncio

    from wiggleroom.errors import require_extra

    if file is None and asked != _NONE_ASKED:
        raise InputError("serve: --gap, --fix and the like are about a FILE; name it, or leave them out")
    require_extra("page", "the page needs starlette, uvicorn and websockets", "starlette", "uvicorn", "websockets")
    from wiggleroom.app.process import Pool

    pool = Pool()
    with asyncio.Runner() as runner:
        runner.run(pool.prepare())  # it loads its libraries while this process reads the drawing
        try:
            first = None if file is None else FirstRequest(file, asked)
            _answer(runner, pool, first, port, browser)
        finally:
            runner.run(pool.close())
    return 0


def _answer(runner: asyncio.Runner, pool: Pool, first: Callable[[], bytes] | None, port: int, browser: bool) -> None:
    """Answer pages until Ctrl-C; raises InputError where the port cannot be had."""
    import secrets

    from wiggleroom.app.server import USUAL_PORT, Page, listen, listen_anywhere, serve

    try:
        listening = listen(port) if port else listen_anywhere(USUAL_PORT)
    except (OSError, OverflowError):
        finding = f"--port {port}: it is taken or cannot be had; leave it out, and a free one is found"
        raise InputError(finding) from None
    number, token = listening.getsockname()[1], secrets.token_urlsafe(32)
    address = f"http://127.0.0.1:{number}/?token={token}"

    def started() -> None:
        print(address, flush=True)  # noqa: T201
        if browser:
            import threading
            import webbrowser

            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()  # some run in the terminal

    with listening:
        serve(runner, Page(number, token, first, pool), listening, started)


class FirstRequest:
    """The request that opens a file as it now is: read again where it, or a file that it names, has changed.

    Parameters are those of `first_request`, which is asked at once.
    """

    def __init__(self, file: str, asked: QuestionOptions) -> None:
        self._file, self._asked = file, asked
        self._one_reads = threading.Lock()
        self._named: list[str] = []
        self._read()
        if self._problem is not None:
            raise self._problem

    def __call__(self) -> bytes:
        """The request, the same object while nothing has changed; raises InputError where the file can no longer be read."""
        with self._one_reads:
            if self._changes() != self._seen:
                self._read()
            if self._problem is not None:
                raise InputError(self._problem.findings)
            return self._request

    def _read(self) -> None:
        self._seen = self._changes()
        self._problem: InputError | None = None
        try:
            self._request = first_request(self._file, self._asked)
        except InputError as problem:
            self._problem = problem
            return
        self._named = list(json.loads(self._request)["beside"])
        self._seen = [self._seen[0], *self._changes()[1:]]

    def _changes(self) -> list[tuple[int, int] | None]:
        """When the file and those that it names were written, and how long they are; None for one that is not there."""
        place = Path(self._file)
        return [_change(place), *(_change(place.parent / name) for name in self._named)]


def _change(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def first_request(file: str, asked: QuestionOptions) -> bytes:
    """The request that opens a file; raises InputError where it cannot be read or the options do not fit it."""
    from wiggleroom.app.open_requests import first_open, first_open_in_space
    from wiggleroom.cli.in_space import read_in_space
    from wiggleroom.drawing.dimension import is_spatial_file

    if is_spatial_file(file):
        return first_open_in_space(Path(file), read_in_space(file, asked).drawing)
    drawing = asked_drawing(file, asked)
    return first_open(Path(file), drawing, asked.length_unit, asked.flatten, asked.gap, read_options(asked))
