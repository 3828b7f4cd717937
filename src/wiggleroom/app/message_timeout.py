"""WebSocket protocol with a time limit for each message: one that does not end in time closes the connection."""

from __future__ import annotations

import asyncio

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

MESSAGE_SECONDS = 60.0
"""A message must be there whole within this time of its beginning [s]."""


class MessageTimeout(WebSocketsSansIOProtocol):
    """Ends connections whose message does not end."""

    _limit: asyncio.TimerHandle | None = None

    def data_received(self, data: bytes) -> None:
        """Take what came, and look at the clock while a message is not whole."""
        super().data_received(data)
        if (self.frames or self.conn.reader.buffer) and self._limit is None:
            self._limit = self.loop.call_later(MESSAGE_SECONDS, self.transport.abort)

    def send_receive_event_to_app(self) -> None:
        """Pass a whole message on; the next one has its own time."""
        self._rest()
        super().send_receive_event_to_app()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the clock."""
        self._rest()
        super().connection_lost(exc)

    def _rest(self) -> None:
        if self._limit is not None:
            self._limit.cancel()
            self._limit = None
