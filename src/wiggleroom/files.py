"""Write files whole or not at all."""

from __future__ import annotations

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
        If the folder cannot be written; nothing is left behind.
    """
    path = Path(path)
    content = data.encode("utf-8", errors="replace") if isinstance(data, str) else data
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    content = marked(content, path.suffix.lower())
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
