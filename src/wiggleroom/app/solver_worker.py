"""The solver process of one page: orders on stdin, results on stdout; it ends when stdin does, whatever it is doing."""

from __future__ import annotations

import os
import queue
import shutil
import sys
import threading
from contextlib import suppress
from typing import BinaryIO

from wiggleroom.app.worker_protocol import Done, Ready, StartOrder, StopOrder, framed_message, read_order
from wiggleroom.errors import StoppedError

KEPT_TICKETS = 4
"""Number of the latest jobs that can still be told to stop, even when they are done: their reply may not have been read."""


class Orders:
    """Orders as they come, read by a thread of its own, so that a stop is heard in the midst of work."""

    def __init__(self, source: BinaryIO, folder: str) -> None:
        self._source, self._folder = source, folder
        self._waiting: queue.Queue[tuple[StartOrder, threading.Event]] = queue.Queue()
        self._stops: dict[int, threading.Event] = {}
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        while (order := read_order(self._source)) is not None:
            if isinstance(order, StopOrder):
                if (stop := self._stops.get(order.ticket)) is not None:
                    stop.set()
            else:
                stop = self._stops[order.ticket] = threading.Event()
                self._waiting.put((order, stop))
                for old in list(self._stops)[:-KEPT_TICKETS]:
                    del self._stops[old]
        shutil.rmtree(self._folder, ignore_errors=True)
        os._exit(0)  # the server is gone, and nobody waits for an answer

    def next(self) -> tuple[StartOrder, threading.Event]:
        """The next piece of work, and what is set when it is to stop."""
        return self._waiting.get()

    def is_set(self) -> bool:
        """True where work has come already: a request to stop what nobody asked for."""
        return not self._waiting.empty()


def main(source: BinaryIO, target: BinaryIO, folder: str) -> None:
    """Work off orders until there are no more; temporary files lie in a folder that ends with the process."""
    orders = Orders(source, folder)

    def say(message: object) -> None:
        target.write(framed_message(message))
        target.flush()

    from wiggleroom.app.dispatcher import Dispatcher
    from wiggleroom.app.preload import preload_steps
    from wiggleroom.app.resource_limits import bound_memory

    bound_memory()
    dispatcher, cold = Dispatcher(), preload_steps(orders)
    while True:
        if cold and not orders.is_set():  # work that has come goes first, and loads what it needs
            with suppress(StoppedError):
                cold.pop(0)()
            if not cold:
                say(Ready())
            continue
        order, stop = orders.next()
        good, more = dispatcher.work(order, stop, say)
        say(Done(order.ticket, good, more))


if __name__ == "__main__":
    with os.fdopen(os.dup(1), "wb") as results:
        os.dup2(2, 1)  # whatever a library prints must not end up among the results
        main(sys.stdin.buffer, results, sys.argv[1])
