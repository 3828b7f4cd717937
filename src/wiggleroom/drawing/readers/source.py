"""From a path or a text to checked text, with a name for messages."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass
from pathlib import Path

from wiggleroom.errors import InputError
from wiggleroom.files import leads_back

_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_DECLARED = re.compile(rb"""^\s*<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")


@dataclass(frozen=True)
class Source:
    """Text of a file and the name that messages use for it."""

    name: str
    text: str


def load(source: str | Path, *, opening: str, name: str) -> Source:
    """Text of `source`, which is a path, or the text itself where it begins with one of `opening`.

    Parameters
    ----------
    source : str or Path
        Path of a file, or its text.
    opening : str
        Characters that a text of this format may begin with; a path never does.
    name : str
        Name in messages where a text was given.

    Raises
    ------
    InputError
        If the file is missing, a directory, unreadable, empty, binary or in an unknown encoding.

    Examples
    --------
    >>> load("{}", opening="{", name="assembly")
    Source(name='assembly', text='{}')
    """
    if isinstance(source, str):
        start = source.lstrip("\ufeff \t\r\n")
        if start[:1] in opening or "\n" in source:
            return _checked(Source(name, source.lstrip("\ufeff")))
    path = Path(source)
    return _checked(Source(path.name, _decode(read_bytes(path), path.name)))


def read_bytes(path: Path) -> bytes:
    """Bytes of a file.

    Raises
    ------
    InputError
        If the file is missing, a directory or unreadable.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        message = f"{path}: there is no such file; give the path of a drawing"
    except IsADirectoryError:
        message = f"{path}: is a directory; give the path of a drawing in it"
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "is not a path"
        message = f"{str(path)[:200]!r}: cannot be read ({reason.lower()}); give the path of a drawing"
        if leads_back(path):
            message = f"{path}: is a link that leads back to itself; give the path of a drawing"
    raise InputError(message)


def _decode(raw: bytes, name: str) -> str:
    encoding = next((codec for bom, codec in _BOMS if raw.startswith(bom)), None)
    if encoding is None:
        declared = _DECLARED.match(raw[:400])
        encoding = declared.group(1).decode("ascii").lower() if declared else "utf-8"
    try:
        return raw.decode(encoding)
    except UnicodeError as error:
        where = f" at byte {error.start}" if isinstance(error, UnicodeDecodeError) else ""
        message = f"{name}: is not {encoding.upper()} text{where}; save it as plain UTF-8"
    except LookupError:
        message = f'{name}: encoding "{encoding}" is not known; save it as plain UTF-8'
    raise InputError(message)


def _checked(source: Source) -> Source:
    if not source.text or source.text.isspace():
        message = f"{source.name}: is empty; a drawing with at least one part is needed"
        raise InputError(message)
    text = source.text  # what is ASCII holds no halves of surrogate pairs
    if "\x00" in text or (not text.isascii() and any("\ud800" <= character <= "\udfff" for character in set(text))):
        message = f"{source.name}: is binary, not text; save it as plain UTF-8"
        raise InputError(message)
    return source
