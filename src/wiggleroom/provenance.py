"""A mark in the files that the program makes, so that it can tell them from files that people made or changed.

The mark is a comment of the file's own format. It holds a checksum of all the rest: a file that was edited is not ours any more.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path

SAYS = b"Made with wiggleroom "
_SUM = rb"([0-9a-f]{8})"
_XML = re.compile(rb"<!-- " + SAYS + _SUM + rb" -->\n\Z")
_DXF = re.compile(rb"\A999\n" + SAYS + _SUM + rb"\n")
_COMMENT = re.compile(b"\x00\x00\x00\x25tEXtComment\x00" + SAYS + _SUM + b"....", re.DOTALL)  # a chunk of a PNG
_EXTENSION = re.compile(b"\x21\xfe\x1d" + SAYS + _SUM + b"\x00")  # a comment of a GIF
_BOX = re.compile(b"\x00\x00\x00\x25free" + SAYS + _SUM + rb"\Z")  # a box of an MP4 that players skip
_ARCHIVE = re.compile(b"\x1d\x00" + SAYS + _SUM + rb"\Z")  # the comment at the end of an archive, and its length
_MARKS = {
    ".svg": _XML,
    ".html": _XML,
    ".dxf": _DXF,
    ".png": _COMMENT,
    ".gif": _EXTENSION,
    ".mp4": _BOX,
    ".npz": _ARCHIVE,
}
_RECORD = re.compile(rb'\A\s*\{\s*"format"\s*:\s*"wiggleroom[./]')
TABLES = (
    "step,part,dx_mm,dy_mm,turn_deg",
    "escape,step,part,dx_mm,dy_mm,turn_deg",
    "kind,name,other,per_mm,tighter_per_mm,percent",
    "gap,objective,verdict",
    "gap,objective,at_most,verdict,path",
    "draw,objective",
    "order,part,moved_before_mm,moved_after_mm",
    "kind,name,other,outline,nominal_mm,plus_mm,minus_mm,",
)
"""How the tables that the program writes begin."""


def marked(content: bytes, kind: str) -> bytes:
    r"""File content with its mark; of formats that hold no comment, as it is.

    Parameters
    ----------
    kind : str
        Ending of the file's name, such as ".svg".

    Examples
    --------
    >>> marked(b"<svg/>", ".svg")
    b'<svg/><!-- Made with wiggleroom acb9fb49 -->\n'
    """
    mark = SAYS + _checksum(content)
    match kind:
        case ".svg" | ".html":
            return content + b"<!-- " + mark + b" -->\n"
        case ".dxf":
            return b"999\n" + mark + b"\n" + content
        case ".png":
            body = b"tEXtComment\x00" + mark
            chunk = (len(body) - 4).to_bytes(4, "big") + body + zlib.crc32(body).to_bytes(4, "big")
            return content[:-12] + chunk + content[-12:]  # before its last chunk, which is empty
        case ".gif":
            return content[:-1] + b"\x21\xfe" + bytes([len(mark)]) + mark + b"\x00" + content[-1:]
        case ".mp4":
            return content + (8 + len(mark)).to_bytes(4, "big") + b"free" + mark
        case ".npz":
            body = content[:-2]  # up to the length of the comment, which is nought
            mark = SAYS + _checksum(body)
            return body + len(mark).to_bytes(2, "little") + mark
    return content


def is_own(path: Path) -> bool:
    """True where the program made this file, and nobody changed it since as far as the file can tell.

    Records and assembly files (.json) are known by their format, tables (.csv) by their heads; everything else by the mark.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    content, kind = path.read_bytes(), path.suffix.lower()
    if kind == ".csv":
        return content.decode("utf-8", errors="replace").startswith(TABLES)
    mark = _MARKS.get(kind)
    if mark is None:
        return bool(_RECORD.match(content))
    found = mark.search(content)
    return found is not None and _checksum(content[: found.start()] + content[found.end() :]) == found[1]


def _checksum(content: bytes) -> bytes:
    return b"%08x" % zlib.crc32(content)
