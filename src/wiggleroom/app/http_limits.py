"""HTTP protocol that no peer can block: a time limit for each request, and a limit on connections that drops the oldest."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

REQUEST_SECONDS = 20.0
"""A request must be there, and its reply read, within this time [s]."""
MAX_CONNECTIONS = 64
"""Of more connections that are no socket of a page, the one that is longest at its request makes place."""
GRACE_SECONDS = 1.0
"""No connection makes place before [s]: a newcomer must have time to ask."""
HARD_LIMIT = 512
"""Of more connections, the oldest makes place at any age."""


class LimitedHttp(H11Protocol):
    """Ends connections whose request does not end or whose reply is not read; others always find a place."""

    _limit: asyncio.TimerHandle | None = None
    _since: float = 0.0

    def connection_made(self, transport: Any) -> None:
        """Make place where there is none, and start the clock."""
        super().connection_made(transport)
        self._start()
        waiting = [c for c in self.connections if isinstance(c, LimitedHttp) and not c.transport.is_closing()]
        if len(waiting) > MAX_CONNECTIONS:
            oldest = min(waiting, key=lambda c: c._since)
            if len(waiting) > HARD_LIMIT or self._since - oldest._since > GRACE_SECONDS:
                oldest.transport.abort()

    def on_response_complete(self) -> None:
        """Give the next request its own time."""
        super().on_response_complete()
        self._start()

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Leave time to the socket, which has limits of its own."""
        self._rest()
        super().handle_websocket_upgrade(event)

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the clock."""
        self._rest()
        super().connection_lost(exc)

    def _start(self) -> None:
        self._rest()
        self._since = self.loop.time()
        self._limit = self.loop.call_later(REQUEST_SECONDS, self.transport.abort)

    def _rest(self) -> None:
        if self._limit is not None:
            self._limit.cancel()
            self._limit = None
