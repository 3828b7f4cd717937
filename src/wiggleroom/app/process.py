"""Solver processes as the server sees them: begun beforehand, one for each page, ended for certain."""

from __future__ import annotations

import asyncio
import shutil
import sys
import tempfile
from dataclasses import dataclass, field

import msgspec

from wiggleroom.app.warming import Warming
from wiggleroom.app.worker_protocol import (
    Done,
    Outgoing,
    Ready,
    StartOrder,
    StopOrder,
    framed_message,
    message_length,
    result,
)
from wiggleroom.parallel.parallel_run import child_environment

MAX_PAGES = 4
"""Each page has a process of its own, and that much memory."""


class LostError(Exception):
    """The process is gone."""


@dataclass(eq=False)
class Process:
    """One solver process, and its folder for temporary files, which is gone with it: drawings are read from there."""

    child: asyncio.subprocess.Process
    folder: str

    @classmethod
    async def begin(cls) -> Process:
        """Start a process; it loads what it needs by itself."""
        folder = tempfile.mkdtemp(prefix="wiggleroom-")
        child = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "wiggleroom.app.solver_worker", folder,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL,
            env=child_environment() | {"TMPDIR": folder},
            start_new_session=True,  # Ctrl-C is for the server
        )  # fmt: skip
        return cls(child, folder)

    async def send(self, order: StartOrder | StopOrder) -> None:
        """Give an order; raises LostError where nobody takes it."""
        assert self.child.stdin is not None
        try:
            self.child.stdin.write(framed_message(order))
            await self.child.stdin.drain()
        except (OSError, RuntimeError) as problem:
            raise LostError from problem

    def stop(self, ticket: int) -> None:
        """Ask it to stop working on a ticket."""
        if self.child.stdin is not None and not self.child.stdin.is_closing():
            self.child.stdin.write(framed_message(StopOrder(ticket)))

    async def receive(self) -> Outgoing | Done | Ready:
        """What it says next; raises LostError where it is gone."""
        assert self.child.stdout is not None
        try:
            head = await self.child.stdout.readexactly(4)
            return result(await self.child.stdout.readexactly(message_length(head)))
        except (asyncio.IncompleteReadError, OSError, msgspec.DecodeError) as problem:
            raise LostError from problem

    def kill(self) -> None:
        """End it at once."""
        if self.child.returncode is None:
            self.child.kill()

    async def end(self) -> None:
        """End it and wait until it is gone, with all that it left."""
        self.kill()
        await self.child.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass(eq=False)
class Pool:
    """All solver processes: those that pages have, one that waits for the next page, and one that compiles while nobody asks."""

    spare: Process | None = None
    taken: set[Process] = field(default_factory=set)
    closed: bool = False
    warming: Warming = field(init=False)
    _lock: asyncio.Lock = field(default_factory=asyncio.Lock)

    def __post_init__(self) -> None:
        self.warming = Warming(self.prepare)

    async def prepare(self) -> None:
        """Have one that waits."""
        async with self._lock:
            if self.spare is not None and self.spare.child.returncode is not None:
                gone, self.spare = self.spare, None
                await gone.end()
            if self.spare is None and not self.closed:
                self.spare = await Process.begin()

    async def take(self) -> Process:
        """The one that waits, or a new one."""
        await self.prepare()
        async with self._lock:
            found, self.spare = self.spare, None
        if found is None:  # another page was quicker
            found = await Process.begin()
        self.taken.add(found)
        return found

    async def drop(self, process: Process) -> None:
        """End one that a page had."""
        self.taken.discard(process)
        await process.end()

    async def close(self) -> None:
        """End all, for good."""
        self.closed = True
        async with self._lock:  # one that is just begun has a folder already
            gone = [*self.taken, *([self.spare] if self.spare else [])]
            self.taken, self.spare = set(), None
        await asyncio.gather(self.warming.close(), *(process.end() for process in gone))
