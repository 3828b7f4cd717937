"""Write files whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from wiggleroom.provenance import marked


def write_whole(path: str | Path, data: str | bytes) -> None:
    """Write `data` (text as UTF-8) to `path` so that nobody ever sees half a file.

    A temporary file in the same folder takes the data and then the name. Devices and pipes are written directly. Files get the mark of
    `wiggleroom.provenance`, by the ending of their names.

    Raises
    ------
    OSError
        If it cannot be written, with its name; nothing is left behind.
    """
    path = Path(path)
    content = data.encode("utf-8", errors="replace") if isinstance(data, str) else data
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            _replace(path, marked(content, path.suffix.lower()))
    except OSError as problem:  # of a full disk or of the temporary file: whoever asked knows another name
        raise OSError(problem.errno, problem.strerror or str(problem), str(path)) from problem


def leads_back(path: str | Path) -> bool:
    """Whether a path is a symbolic link that leads back to itself, or passes one."""
    try:
        Path(path).stat()
    except OSError as problem:
        return problem.errno == errno.ELOOP
    except ValueError:  # no path at all
        return False
    return False


def _replace(path: Path, content: bytes) -> None:
    if leads_back(path):
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    target = path.resolve()  # a link stays a link: the file it points to is replaced
    part = target.with_name(f".{target.name[:80]}.{os.getpid()}.tmp")
    try:
        with part.open("xb") as file:
            file.write(content)
        if target.exists():
            part.chmod(target.stat().st_mode & 0o777)
        part.replace(target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
