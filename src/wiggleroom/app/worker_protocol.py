"""What the server and a solver process say to each other: blocks of msgpack, each after its length."""

from __future__ import annotations

import struct
from typing import Any, BinaryIO

import msgspec
from msgspec import Struct

_LENGTH = struct.Struct("<I")


class StartOrder(Struct, tag=True):
    """Work on a request.

    Parameters
    ----------
    ticket : int
        Of this piece of work; a request that is tried again gets another one.
    request : bytes
        Text frame as the page sent it.
    settle : bool
        Of a `flex`: the full answer.
    quiet : bool
        Outgoing nothing: the page has had it.
    """

    ticket: int
    request: bytes
    settle: bool = False
    quiet: bool = False


class StopOrder(Struct, tag=True):
    """Stop working on a ticket, or do not begin."""

    ticket: int


class Outgoing(Struct, tag=True):
    """Text frame for the page, and the binary frames that go before it."""

    ticket: int
    text: bytes
    frames: list[bytes] = []


class Done(Struct, tag=True):
    """Nothing more comes; `more` where a `flex` waits for its full answer."""

    ticket: int
    good: bool = True
    more: bool = False


class Ready(Struct, tag=True):
    """The process has loaded what it needs."""


_encoder = msgspec.msgpack.Encoder()
_orders = msgspec.msgpack.Decoder(StartOrder | StopOrder)
_results = msgspec.msgpack.Decoder(Outgoing | Done | Ready)


def framed_message(message: Any) -> bytes:
    """Message as it goes through a pipe."""
    body = _encoder.encode(message)
    return _LENGTH.pack(len(body)) + body


def message_length(head: bytes) -> int:
    """Length of the block that follows these four bytes."""
    return int(_LENGTH.unpack(head)[0])


def result(body: bytes) -> Outgoing | Done | Ready:
    """What a solver process says."""
    return _results.decode(body)


def read_order(source: BinaryIO) -> StartOrder | StopOrder | None:
    """Next order; None where the pipe was closed."""
    head = source.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    body = source.read(message_length(head))
    return _orders.decode(body) if len(body) == message_length(head) else None
