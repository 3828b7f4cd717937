"""Text and binary frames between the page and the server: read, checked, written."""

from __future__ import annotations

import struct
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from wiggleroom.drawing.readers.assembly_schema import plain_finding
from wiggleroom.drawing.writers.plain_json import json_bytes
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import Failed
from wiggleroom.schema.reply_base import Reply
from wiggleroom.schema.requests import AnyRequest, OpenRequest, StudyRequest


class Head(Struct):
    """What can be told of a message that is wrong."""

    id: Any = None
    kind: Any = None


_decoder, _head = msgspec.json.Decoder(AnyRequest), msgspec.json.Decoder(Head)


def decode(text: bytes | str) -> AnyRequest:
    """Request in a text frame.

    Raises
    ------
    InputError
        With one line, where it is none.

    Examples
    --------
    >>> decode('{"kind": "space", "id": 4, "design": {}, "a": "p1", "b": "p2"}').b
    'p2'
    """
    try:
        return _decoder.decode(text)
    except RecursionError:
        message = "message: lists are nested too deep"
    except msgspec.ValidationError as problem:
        message = f"message: {plain_finding(str(problem))}"
    except (msgspec.DecodeError, UnicodeError) as problem:
        message = f"message: is not JSON ({' '.join(str(problem).split())})"
    raise InputError(message)


def read_again(before: bytes, request: OpenRequest) -> bytes:
    """The request that opened a drawing, to be read as another request says."""
    old = decode(before)
    assert isinstance(old, OpenRequest)
    how = {name: getattr(request, name) for name in ("id", "unit", "only", "skip", "join", "solid", "hole")}
    return msgspec.json.encode(replace(old, **how, design=None))


def kind_of(request: AnyRequest) -> str:
    """Kind of a request: as in its message, of a study the question's name."""
    return request.of if isinstance(request, StudyRequest) else str(request.__struct_config__.tag)


def head(text: bytes | str) -> tuple[int, str]:
    """Number and kind of a message that may be wrong; 0 and "" where it does not say them."""
    try:
        found = _head.decode(text)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        return 0, ""
    number = found.id if isinstance(found.id, int) and 0 <= found.id < 2**32 else 0
    return number, found.kind if isinstance(found.kind, str) else ""


def encode(reply: Reply) -> bytes:
    """Reply as the bytes of a text frame; numbers that JSON cannot say become null."""
    return json_bytes(reply)


def failed(number: int, of: str, findings: tuple[str, ...] | list[str]) -> Failed:
    """Reply that says what is wrong, one line each."""
    return Failed(id=number, of=of, findings=[" ".join(line.split()) for line in findings])


def motion_frame(number: int, motions: NDArray[np.float64]) -> bytes:
    """Binary frame of motions that goes before the reply of this number: (k, n, 3) [mm, mm, rad], or in space (k, n, 7).

    Examples
    --------
    >>> import numpy as np
    >>> motion_frame(7, np.zeros((1, 2, 3)))[:16].hex(" ", 4)
    '07000000 01000000 02000000 00000000'
    """
    k, n, columns = motions.shape
    return (
        struct.pack("<4I", number, k, n, 0 if columns == 3 else columns)
        + np.ascontiguousarray(motions, dtype="<f4").tobytes()
    )
