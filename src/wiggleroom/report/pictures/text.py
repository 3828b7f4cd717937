"""Text in pictures: how wide it is, how to break or shorten it, and how to put it into XML."""

from __future__ import annotations

import re
from collections.abc import Sequence

# Widths of the characters from space to tilde, in hundredths of the font size and written as hexadecimal numbers, of
# DejaVu Sans: the widest common font.
_WIDTHS = bytes.fromhex(
    "20282e54405f4e1b272732542024202240404040404040404040222254545435"
    "644445464d3f3a4d4b1d1d4238564b4f3c4f453f3d494463453d452722275432"
    "323d3f373f3e233f3f1c1c3a1c613f3d3f3f2934273f3b523b3b3440224054"
)
# Characters that XML 1.0 does not allow, even escaped.
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def text_width(text: str, size: float) -> float:
    """Width of `text` at a font size, an upper estimate for the usual sans-serif fonts.

    >>> text_width("ab", 10)
    12.4
    """
    return sum(_WIDTHS[ord(c) - 32] if " " <= c <= "~" else 105 for c in text) * size / 100


def elide(text: str, size: float, room: float) -> str:
    """`text`, its middle left out where it is wider than `room`.

    >>> elide("a very long name", 10, 60)
    'a ve…ame'
    """
    if text_width(text, size) <= room:
        return text
    for kept in range(len(text) - 1, 1, -1):
        head, tail = text[: kept - kept // 2], text[len(text) - kept // 2 :]
        if text_width(f"{head}…{tail}", size) <= room:
            return f"{head}…{tail}"
    return "…"


def wrap(pieces: Sequence[str], between: str, size: float, room: float, lines: int) -> list[str]:
    """`pieces` joined by `between` in at most `lines` lines no wider than `room`; what is too long is shortened.

    >>> wrap(["one", "two", "three"], " ", 10, 45, 3)
    ['one two', 'three']
    """
    rows: list[str] = []
    for piece in pieces:
        longer = f"{rows[-1]}{between}{piece}" if rows else piece
        if rows and (text_width(longer, size) <= room or len(rows) == lines):
            rows[-1] = longer
        else:
            rows.append(piece)
    return [elide(row, size, room) for row in rows]


def escape(text: str) -> str:
    """`text` for XML content and attributes; characters that XML cannot hold become question marks.

    >>> escape("a<b")
    'a&lt;b'
    """
    text = _FORBIDDEN.sub("?", text)
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
