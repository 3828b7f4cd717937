"""While a long question runs: progress on a terminal, and Ctrl-C."""

from __future__ import annotations

import _thread
import math
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from wiggleroom.deadline import Deadline

AGAIN = 0.25
"""Time after which work that did not end is interrupted again [s]."""


@contextmanager
def interruptible(seconds: float | None = None) -> Iterator[Deadline]:
    """What stops long work: the first Ctrl-C, and the end of its time; a second Ctrl-C ends the program as usual."""
    stop = threading.Event()

    def first(*_: object) -> None:
        stop.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        print("stopping; Ctrl-C again ends at once", file=sys.stderr)  # noqa: T201

    before = signal.signal(signal.SIGINT, first)
    try:
        yield Deadline(seconds, stop)
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def at_once(stop: Deadline | None) -> Iterator[None]:
    """Within, Ctrl-C and the end of the time end the work where it is, as KeyboardInterrupt: there is nothing to keep yet.

    It is raised again until it is seen: libraries that are being imported catch it.
    """
    if stop is None:
        yield
        return
    pressed, done = threading.Event(), threading.Event()

    def interrupted(*_: object) -> None:
        pressed.set()
        if not done.is_set():
            raise KeyboardInterrupt

    def insist() -> None:
        while not done.wait(AGAIN if stop.over else min(AGAIN, stop.left)):
            if pressed.is_set() or stop.over:
                _thread.interrupt_main()

    before = signal.signal(signal.SIGINT, interrupted)
    insisting = threading.Thread(target=insist, daemon=True)
    insisting.start()
    try:
        yield
    except Exception:
        if pressed.is_set():  # libraries go on without what they could not import, and fail later
            raise KeyboardInterrupt from None
        raise
    finally:
        while not done.is_set():
            with suppress(KeyboardInterrupt):  # one that came in between
                done.set()
        insisting.join()  # else what it asks for last would be taken for a Ctrl-C after this
        signal.signal(signal.SIGINT, before)


@contextmanager
def progress() -> Iterator[Callable[[Any], None] | None]:
    """Give a callback that shows stage, round, iteration and value on stderr; None where that is no terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.status import Status

    with Status("reading", console=Console(stderr=True), spinner="dots") as status:

        def show(step: Any) -> None:
            value = "" if step.objective is None or math.isnan(step.objective) else f", {step.objective:.6g} so far"
            turn = f", iteration {step.iteration}" if step.iteration else ""
            number = f", round {step.round}" if step.round or step.iteration else ""
            status.update(f"{step.stage}{number}{turn}{value}")

        yield show


@contextmanager
def bar(what: str, before: str = "solving") -> Iterator[Callable[[int, int], None] | None]:
    """Give a callback that shows how many of many are done, on stderr; None where that is no terminal.

    Until it is first called, the line says what goes on `before`.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    pieces = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*pieces, console=Console(stderr=True), transient=True) as page:
        task = page.add_task(before, total=None)
        yield lambda done, total: page.update(task, description=what, completed=done, total=total)
