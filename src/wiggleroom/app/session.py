"""One page: which of its requests is answered next, which are dropped, and what happens when a process dies.

The newest request of a kind counts. `open`, `drag`, `flex` and `shape` are for the hand that moves and go first;
everything else gives way to them and begins again when the hand rests. Studies that take long give way to short questions too, and a
`bound`, which nobody waits for, to all.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import count

from wiggleroom.app.messages import decode, encode, failed, head, kind_of, read_again
from wiggleroom.app.process import LostError, Pool, Process
from wiggleroom.app.resource_limits import DESIGN_MB, UPLOAD_MB
from wiggleroom.app.worker_protocol import Done, Outgoing, Ready, StartOrder
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import WorkerState
from wiggleroom.schema.reply_base import Reply
from wiggleroom.schema.requests import AnyRequest, CancelRequest, FlexRequest, OpenRequest

Send = Callable[[list[bytes], bytes], Awaitable[None]]
"""Sends binary frames and then one text frame."""

PRIORITY = {"open": 0, "drag": 1, "flex": 2, "shape": 3}
"""Kinds that are served first, in this order; all others are interrupted for them."""
SHORT = frozenset({"settle", "pose", "reach", "wiggle", "rank", "save", "lay"})
"""Kinds that studies, which may take much longer, are interrupted for."""
LAST = "bound"
"""The kind that is served last and interrupted for all others."""
GRACE_SECONDS = 0.6
"""A drag or flex that a newer one replaces may still end within this time [s]: else a hand that never rests would see nothing."""
IDLE_SECONDS = 0.25
"""So long after the last drag or flex [s] long work is taken up again."""
RESTING_SECONDS = 2.0
"""So long after the last drag [s] a `bound` is: a hand that drags one part after the other need not wait until it has stopped."""
READ_SECONDS = 60.0
"""A drawing must be read within this time [s]."""
STOP_SECONDS = 8.0
"""A process that does not stop within this time [s] is ended."""
MAX_TRIES = 2
"""A request is given up after its process died this many times."""


@dataclass(eq=False)
class Job:
    """A request that waits or is worked on.

    Parameters
    ----------
    kind : str
        That of the request; "settle" for the full answer of a `flex`.
    born : int
        Place in the order of arrival.
    own : bool
        Of an `open`: of the file that the command was given.
    """

    kind: str
    number: int
    text: bytes
    born: int
    tries: int = 0
    ticket: int = 0
    began: float = 0.0
    replied: bool = False
    stopped: bool = False
    again: bool = False
    late: bool = False
    own: bool = False

    @property
    def of(self) -> str:
        """Kind of the request that the page knows."""
        return "flex" if self.kind == "settle" else self.kind

    @property
    def rank(self) -> tuple[int, int]:
        """Who is served first."""
        return PRIORITY.get(self.kind, len(PRIORITY) + self.tier), self.born

    @property
    def tier(self) -> int:
        """What is interrupted for what: for the hand, for short questions, for studies, for nothing."""
        return 0 if self.kind in PRIORITY else 1 if self.kind in SHORT else 3 if self.kind == LAST else 2


class Session:
    """Requests of one page, worked off by a process of its own.

    Parameters
    ----------
    pool : Pool
    send : callable
        Sends frames to the page.
    first : bytes, optional
        An `open` that is done before anything is asked.
    """

    def __init__(self, pool: Pool, send: Send, first: bytes | None = None) -> None:
        self._pool, self._send = pool, send
        self._pending: dict[str, Job] = {}
        self._running: Job | None = None
        self._process: Process | None = None
        self._drawing: bytes | None = None
        self._first = first
        self._loaded = self._own = False
        self._last_move = self._last_drag = 0.0
        self._news = asyncio.Event()
        self._tickets, self._births = count(1), count()
        if first is not None:
            self._enqueue(Job("open", 0, first, next(self._births), own=True))

    def changed(self, first: bytes) -> None:
        """Open the file of the command as it now is, unless the page has opened another one."""
        self._first = first
        if self._own or self._drawing is None:
            self._enqueue(Job("open", 0, first, next(self._births), own=True))

    async def submit(self, text: bytes) -> None:
        """Take a text frame of the page."""
        try:
            request = _allowed(text)
        except InputError as problem:
            await self._tell(failed(*head(text), problem.findings))
            return
        if isinstance(request, CancelRequest):
            self._forget(request.of)
            return
        if isinstance(request, OpenRequest) and (request.again or request.served):
            before = self._first if request.served else self._drawing
            if before is None:
                await self._tell(failed(request.id, "open", ["nothing is open: open a drawing first"]))
                return
            text = read_again(before, request)
        kind = "settle" if isinstance(request, FlexRequest) and request.thorough else kind_of(request)
        own = isinstance(request, OpenRequest) and (request.served or (self._own and request.again))
        self._enqueue(Job(kind, request.id, text, next(self._births), own=own))

    async def refuse(self, line: str) -> None:
        """Say that a frame is no request."""
        await self._tell(failed(0, "", [line]))

    async def refuse_open(self, findings: tuple[str, ...]) -> None:
        """Say why the file of the command can no longer be read, where it is the one that is open."""
        if self._own:
            await self._tell(failed(0, "open", findings))

    def _enqueue(self, job: Job) -> None:
        running = self._running
        if job.kind == "open":  # what was asked is about another drawing
            self._pending.clear()
            self._drop(running)
        elif job.of == "flex":
            for kind in ("settle", LAST):  # these were about the design before
                self._pending.pop(kind, None)
                if running is not None and running.kind == kind:
                    self._drop(running)
        self._pending[job.kind] = job
        if running is not None and not running.stopped:
            if running.kind == job.kind:
                self._supersede(running)
            elif job.tier < running.tier:
                running.again = True
                self._halt(running)
        self._news.set()

    def _forget(self, kind: str) -> None:
        for one in (kind, "settle") if kind == "flex" else (kind,):
            self._pending.pop(one, None)
            if self._running is not None and self._running.kind == one:
                self._drop(self._running)

    def _supersede(self, job: Job) -> None:
        """Stop what a newer request of its kind replaces; a moving hand sees its answer if that comes soon."""
        loop = asyncio.get_running_loop()
        left = job.began + GRACE_SECONDS - loop.time()
        if job.kind in ("drag", "flex") and not job.replied and left > 0:
            ticket = job.ticket
            loop.call_later(left, lambda: self._halt(job) if self._still(job, ticket) else None)
        else:
            self._halt(job)

    def _drop(self, job: Job | None) -> None:
        """Stop it for good."""
        if job is not None:
            job.again = False
            self._halt(job)

    def _halt(self, job: Job | None) -> None:
        if job is None or job.stopped or self._process is None:
            return
        job.stopped = True
        process, ticket = self._process, job.ticket
        process.stop(ticket)
        loop = asyncio.get_running_loop()
        loop.call_later(STOP_SECONDS, lambda: process.kill() if job.stopped and self._still(job, ticket) else None)

    def _still(self, job: Job, ticket: int) -> bool:
        """True while a job runs as it did under a ticket: one that was stopped and begun again has another."""
        return self._running is job and job.ticket == ticket

    async def run(self) -> None:
        """Work off requests until the page is gone."""
        self._process = await self._pool.take()
        try:
            while True:
                job = await self._next()
                if job is not None:
                    with self._pool.warming.held():
                        await self._serve(job)
        finally:
            await self._pool.drop(self._process)

    async def _next(self) -> Job | None:
        """The job to do now; None where something may have changed."""
        job = min(self._pending.values(), key=lambda j: j.rank, default=None)
        self._news.clear()
        rest = None
        if job is not None and job.kind not in PRIORITY:
            until = self._last_move + IDLE_SECONDS
            if job.kind == LAST:
                until = max(until, self._last_drag + RESTING_SECONDS)
            rest = until - asyncio.get_running_loop().time()
        if job is not None and (rest is None or rest <= 0):
            return self._pending.pop(job.kind)
        with suppress(TimeoutError):
            await asyncio.wait_for(self._news.wait(), rest)
        return None

    async def _serve(self, job: Job) -> None:
        """Work on one job until it is done, stopped, or its process is gone."""
        assert self._process is not None
        job.tries, job.stopped, job.again, job.replied = job.tries + 1, False, False, False
        self._running = job
        try:
            if job.kind != "open":
                await self._load()
            if job.stopped:
                self._after(job, Done(0, good=False))
            else:
                await self._work(job)
        except LostError:
            await self._lost(job)
        finally:
            self._running = None
            if job.kind in ("drag", "flex"):
                self._last_move = asyncio.get_running_loop().time()
            if job.kind == "drag":
                self._last_drag = self._last_move

    async def _load(self) -> None:
        """Give a new process the drawing that is open."""
        if self._loaded or self._drawing is None:
            return
        await self._order(StartOrder(ticket := next(self._tickets), self._drawing, quiet=True))
        while not (isinstance(said := await self._receive(), Done) and said.ticket == ticket):
            pass
        self._loaded = True

    async def _work(self, job: Job) -> None:
        loop = asyncio.get_running_loop()
        job.ticket, job.began = next(self._tickets), loop.time()
        await self._order(StartOrder(job.ticket, job.text, settle=job.kind == "settle"))
        limit = loop.call_later(READ_SECONDS, self._too_late, job) if job.kind == "open" else None
        try:
            while True:
                said = await self._receive()
                if isinstance(said, Ready) or said.ticket != job.ticket:
                    continue
                if isinstance(said, Done):
                    return self._after(job, said)
                if not job.stopped or job.again:  # it may have been about to say its last word
                    job.replied = True
                    if job.kind == "open" and head(said.text)[1] == "opened":  # the page may ask about it at once
                        self._drawing, self._loaded, self._own = job.text, True, job.own
                    await self._send(said.frames, said.text)
                    if job.kind in ("drag", "flex") and job.kind in self._pending:
                        self._halt(job)  # the hand is elsewhere already
        finally:
            if limit is not None:
                limit.cancel()

    def _after(self, job: Job, done: Done) -> None:
        """What follows when the process is done with a job."""
        if job.kind == "open" and job.stopped and not (done.good and job.replied):
            self._loaded = False  # it may have got far enough to have taken the place of the drawing
        if job.stopped and job.again:
            if not done.good:
                job.tries = 0
                self._pending.setdefault(job.kind, job)
        elif done.more and not job.stopped and "flex" not in self._pending:
            self._pending["settle"] = Job("settle", job.number, job.text, job.born)

    def _too_late(self, job: Job) -> None:
        job.late = True
        if self._process is not None:
            self._process.kill()

    async def _lost(self, job: Job) -> None:
        """Get a new process; the job is tried once more."""
        assert self._process is not None
        await self._tell(WorkerState(state="lost"))
        await self._pool.drop(self._process)
        self._process, self._loaded = await self._pool.take(), False
        await self._tell(WorkerState(state="restarted"))
        if job.late:
            line = (
                f"the drawing was not read within {READ_SECONDS:g} seconds; simplify it, or cut it into several files"
            )
            await self._tell(failed(job.number, job.of, [line]))
        elif job.stopped and not job.again:
            return
        elif job.tries < MAX_TRIES or job.again:
            self._pending.setdefault(job.kind, job)
        else:
            line = f"the solver ended {MAX_TRIES} times without a word while it worked on this; it is left out"
            await self._tell(failed(job.number, job.of, [line]))

    async def _order(self, order: StartOrder) -> None:
        assert self._process is not None
        await self._process.send(order)

    async def _receive(self) -> Outgoing | Done | Ready:
        """What the process says next."""
        assert self._process is not None
        said = await self._process.receive()
        if isinstance(said, Ready):
            await self._tell(WorkerState(state="ready"))
        return said

    async def _tell(self, reply: Reply) -> None:
        await self._send([], encode(reply))


def _allowed(text: bytes) -> AnyRequest:
    """Request in a text frame; raises InputError where it is none, or larger than its kind may be."""
    if len(text) > DESIGN_MB * 1_000_000 and head(text)[1] != "open":
        message = f"message: {len(text) / 1e6:.1f} MB; a message that is no drawing may have {DESIGN_MB} MB"
        raise InputError(message)
    request = decode(text)
    if isinstance(request, OpenRequest) and request.beside:
        message = "open: files beside a drawing are opened from the command line only; start wiggleroom serve with it"
        raise InputError(message)
    if isinstance(request, OpenRequest) and len(request.data) > UPLOAD_MB * 1_000_000:
        message = f"{len(request.data) / 1e6:.1f} MB: a drawing may have {UPLOAD_MB} MB here; use the command line"
        raise InputError(message)
    return request
