"""Whether a file tells of parts in the plane or in space."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

SPATIAL_FORMAT = "wiggleroom/2"


def is_spatial_file(path: str | PathLike[str]) -> bool:
    """True for a file of format wiggleroom/2; a file that is not there is none.

    >>> is_spatial_file("drawing.svg")
    False
    """
    path = Path(path)
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    from wiggleroom.drawing.assembly_schema import decode_json  # slow to load, and of no use to drawings
    from wiggleroom.drawing.source import load

    source = load(path, opening="{[", name="assembly")
    if f'"{SPATIAL_FORMAT}"' not in source.text:
        return False
    raw = decode_json(source)
    return isinstance(raw, dict) and raw.get("format") == SPATIAL_FORMAT
