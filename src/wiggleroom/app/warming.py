"""What is made ready while nobody waits for an answer: a process for the next page, kernels of questions that nobody has asked yet."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from importlib import resources

from wiggleroom.parallel.parallel_run import child_environment

COMMAND = (sys.executable, "-m", "wiggleroom.cli.compile")
"""Compiles what is not kept yet and keeps it, function by function: what is ended in between loses the last one alone."""
IDLE_SECONDS = 3.0
"""So long after the last answer [s] it begins."""


class Warming:
    """Work after the first answer, which has all cores until then: ended whenever something is asked, begun again when all is answered.

    Parameters
    ----------
    prepare : callable
        Has a process ready for the next page.
    command : sequence of str
        Compiles.
    """

    def __init__(self, prepare: Callable[[], Awaitable[None]], command: tuple[str, ...] = COMMAND) -> None:
        self._prepare, self._command = prepare, command
        self._closed = False
        self._asked = 0
        self._task: asyncio.Task[None] | None = None
        self.done = (resources.files("wiggleroom.compiled") / "kernels").is_dir()  # a wheel carries them

    @contextmanager
    def held(self) -> Iterator[None]:
        """While something that was asked is worked on."""
        self._asked += 1
        self._stop()
        try:
            yield
        finally:
            self._asked -= 1
            if not self._asked and not self._closed:
                self._task = asyncio.get_running_loop().create_task(self._run())

    def _stop(self) -> None:
        if self._task is not None:
            self._task.cancel()

    async def _run(self) -> None:
        await asyncio.sleep(IDLE_SECONDS)
        await self._prepare()
        if self.done:
            return
        child = await asyncio.create_subprocess_exec(
            *self._command,
            stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.DEVNULL,
            env=child_environment(),
            start_new_session=True,  # Ctrl-C is for the server
        )  # fmt: skip
        try:
            await child.wait()
            self.done = True  # or it cannot be done here: what is asked compiles what it needs
        finally:
            if child.returncode is None:
                child.kill()
                await child.wait()

    async def close(self) -> None:
        """End it, for good."""
        self._closed = True
        self._stop()
        if self._task is not None:
            await asyncio.gather(self._task, return_exceptions=True)
