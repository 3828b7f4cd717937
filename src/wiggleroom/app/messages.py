"""What the page and the server say to each other: the page's requests, checked to the letter, and replies as JSON."""

from __future__ import annotations

import struct
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from wiggleroom.drawing.assembly_schema import PullEntry, plain_finding
from wiggleroom.drawing.plain import json_bytes
from wiggleroom.errors import InputError

Number = Annotated[int, Meta(ge=0, le=2**32 - 1)]
Length = Annotated[float, Meta(ge=-1e9, le=1e9)]
Point = tuple[Length, Length]
Json = dict[str, Any]

WHAT = Literal["svg", "png", "gif", "mp4", "html", "json", "assembly", "cut-svg", "cut-dxf"]


class Design(Struct, forbid_unknown_fields=True):
    """What the user has set; every request but `open` carries all of it.

    Parameters
    ----------
    gap : float, optional [mm]
        In place of the drawing's.
    extra : dict
        Extra gap [mm] round single parts: the outline of that part alone moves inward by half of it.
    fixed, glue, goals
        In place of the drawing's; goals are as in an assembly file's `pull`, or "translation" or "closer".
    """

    gap: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    extra: dict[str, Length] = {}
    fixed: list[str] = []
    glue: list[list[str]] = []
    goals: list[PullEntry] | Literal["translation", "closer"] = []

    def __post_init__(self) -> None:
        """Leave out what says nothing: no extra gap, and glue of a part alone."""
        self.extra = {name: value for name, value in self.extra.items() if value}
        self.glue = [group for group in self.glue if len(group) > 1]


class Request(Struct, tag_field="kind", tag=str.lower, forbid_unknown_fields=True, kw_only=True):
    """Base of all requests; numbers grow."""

    id: Number


class Open(Request, kw_only=True):
    """Read a drawing; with a design, that one stands in place of what the drawing asks. `path` is what commands call it."""

    name: Annotated[str, Meta(max_length=255)]
    path: Annotated[str, Meta(max_length=4096)] = ""
    data: bytes
    unit: Literal["mm", "cm", "m", "in", "px"] | None = None
    flatten: Annotated[float, Meta(gt=0, le=1e9)] | None = None
    gap: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    only: tuple[str, ...] = ()
    skip: tuple[str, ...] = ()
    join: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    solid: tuple[str, ...] = ()
    design: Design | None = None


class Asking(Request, kw_only=True):
    """Base of requests about the drawing that is open."""

    design: Design


class Shape(Asking, kw_only=True):
    """Outlines with the gap applied."""


class Flex(Asking, kw_only=True):
    """How far it moves: a quick answer first, then the full one; thorough: the full one alone."""

    thorough: bool = False


class Drag(Asking, kw_only=True, rename={"from_": "from"}):
    """A part drawn towards a place; `grip` is where it was taken, in world coordinates at rest [mm]."""

    part: str
    grip: Point
    target: Point
    from_: Literal["rest", "here"] = "here"


class Release(Asking, kw_only=True):
    """The end of a drag."""


class Wiggle(Asking, kw_only=True):
    """The freedoms that are left, of all parts or of one."""

    part: str | None = None


class Rank(Asking, kw_only=True):
    """Whose gap matters most."""


class Check(Asking, kw_only=True):
    """Whether it comes apart."""


class Sweep(Asking, kw_only=True):
    """Motion against gap."""

    gaps: Annotated[list[Annotated[float, Meta(ge=0, le=1e9)]], Meta(max_length=200)] | None = None


class Space(Asking, kw_only=True):
    """The free space of one pair."""

    a: str
    b: str


class Prove(Asking, kw_only=True):
    """A value that no motion exceeds."""

    share: Annotated[float, Meta(gt=0, lt=10)] = 0.01
    seconds: Annotated[float, Meta(gt=0, le=3600)] = 60.0


class Save(Asking, kw_only=True):
    """What is on screen, as a file."""

    what: WHAT
    of: Literal["flex", "check"] = "flex"


class Cancel(Request, kw_only=True):
    """Forget a request of this kind, waiting or running."""

    of: str


AnyRequest = Open | Shape | Flex | Drag | Release | Wiggle | Rank | Check | Sweep | Space | Prove | Save | Cancel


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


def kind_of(request: AnyRequest) -> str:
    """Kind of a request, as in its message."""
    return str(request.__struct_config__.tag)


def head(text: bytes | str) -> tuple[int, str]:
    """Number and kind of a message that may be wrong; 0 and "" where it does not say them."""
    try:
        found = _head.decode(text)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        return 0, ""
    number = found.id if isinstance(found.id, int) and 0 <= found.id < 2**32 else 0
    return number, found.kind if isinstance(found.kind, str) else ""


def encode(reply: Json) -> bytes:
    """Reply as the bytes of a text frame; numbers that JSON cannot say become null."""
    return json_bytes(reply)


def failed(number: int, of: str, findings: tuple[str, ...] | list[str]) -> Json:
    """Reply that says what is wrong, one line each."""
    return {"kind": "failed", "id": number, "of": of, "findings": [" ".join(line.split()) for line in findings]}


def frame(number: int, motions: NDArray[np.float64]) -> bytes:
    """Binary frame of motions (k, n, 3) [mm, mm, rad] that goes before the reply of this number.

    Examples
    --------
    >>> import numpy as np
    >>> frame(7, np.zeros((1, 2, 3)))[:16].hex(" ", 4)
    '07000000 01000000 02000000 00000000'
    """
    k, n, _ = motions.shape
    return struct.pack("<4I", number, k, n, 0) + np.ascontiguousarray(motions, dtype="<f4").tobytes()
