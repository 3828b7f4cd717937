"""WebSocket protocol that no peer can block: a time limit for each message, and little work in each turn of the event loop."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

MESSAGE_SECONDS = 60.0
"""A message must be there whole within this time of its beginning [s]."""
TURN_SECONDS = 0.002
"""So long is parsed in one turn of the event loop [s]: a flood of tiny frames lets other connections in between."""
SLICE_BYTES = (512, 8192)
"""Bytes parsed between two looks at the clock: few where they are slow to parse, more where they are the inside of a large frame."""


class LimitedWebSocket(WebSocketsSansIOProtocol):
    """Ends connections whose message does not end; parses in slices, and none while its peer or the application lags."""

    _limit: asyncio.TimerHandle | None = None
    _turn: asyncio.Handle | None = None
    _slice = SLICE_BYTES[0]

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._unparsed = bytearray()

    def data_received(self, data: bytes) -> None:
        """Take what came; what does not fit into this turn waits, and nothing more is read meanwhile."""
        self._unparsed += data
        self._parse()

    def _parse(self) -> None:
        """Parse as much as fits into one turn."""
        self._turn = None
        if self.transport.is_closing():
            self._unparsed.clear()
            return
        least, most = SLICE_BYTES
        begin = before = self.loop.time()
        while self._unparsed and before - begin < TURN_SECONDS and self._takes_more():
            piece = bytes(self._unparsed[: self._slice])
            del self._unparsed[: self._slice]
            super().data_received(piece)
            now = self.loop.time()
            self._slice = min(2 * self._slice, most) if now - before < TURN_SECONDS / 10 else least
            before = now
        if (self.frames or self.conn.reader.buffer) and self._limit is None:
            self._limit = self.loop.call_later(MESSAGE_SECONDS, self.transport.abort)
        self._go_on()

    def _go_on(self) -> None:
        """Read no more while something waits to be parsed; parse it in the next turn, if it can be taken then."""
        if self.transport.is_closing():
            self._unparsed.clear()
        elif self._unparsed:
            self.transport.pause_reading()
            if self._turn is None and not self.read_paused and self.writable.is_set():
                self._turn = self.loop.call_soon(self._parse)
        elif not self.read_paused:
            self.transport.resume_reading()

    def _takes_more(self) -> bool:
        """Whether peer and application are there and keep up."""
        return not (self.read_paused or self.transport.is_closing()) and self.writable.is_set()

    def handle_ping(self) -> None:
        """Answer while the peer is there: what it sent before it went may hold thousands of pings."""
        if not self.transport.is_closing():
            super().handle_ping()

    async def receive(self) -> Any:
        """Next message for the application."""
        message = await super().receive()
        self._go_on()
        return message

    def resume_writing(self) -> None:
        """Go on: the peer has read what was sent."""
        super().resume_writing()
        self._go_on()

    def send_receive_event_to_app(self) -> None:
        """Pass a whole message on; the next one has its own time."""
        self._rest()
        super().send_receive_event_to_app()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the clock, forget what was not parsed."""
        self._rest()
        self._unparsed.clear()
        super().connection_lost(exc)

    def _rest(self) -> None:
        if self._limit is not None:
            self._limit.cancel()
            self._limit = None
