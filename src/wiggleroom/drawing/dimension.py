"""Whether a file tells of parts in the plane or in space."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

SPATIAL_FORMAT = "wiggleroom/2"
MESHES = (".stl", ".obj", ".ply", ".glb", ".3mf", ".step", ".stp")
"""Endings of files that hold solids alone."""
PUZZLES = (".puz", ".xmpuzzle")
"""Endings of files of voxel puzzles."""


def is_mesh_file(path: str | PathLike[str]) -> bool:
    """True for the name of a file that holds solids alone.

    >>> is_mesh_file("pin.STL"), is_mesh_file("pin.json")
    (True, False)
    """
    return Path(path).suffix.lower() in MESHES


def is_spatial_file(path: str | PathLike[str]) -> bool:
    """True for a voxel puzzle by its name, and for a file of format wiggleroom/2; one that is not there is none.

    >>> is_spatial_file("drawing.svg")
    False
    """
    path = Path(path)
    if path.suffix.lower() in PUZZLES:
        return True
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    from wiggleroom.drawing.readers.assembly_schema import decode_json  # slow to load, and of no use to drawings
    from wiggleroom.drawing.readers.source import load, read_bytes

    # most files are told apart by their bytes alone; in UTF-16 and UTF-32 there are zeros in between
    if f'"{SPATIAL_FORMAT}"'.encode() not in read_bytes(path).replace(b"\0", b""):
        return False
    raw = decode_json(load(path, opening="{[", name="assembly"))
    return isinstance(raw, dict) and raw.get("format") == SPATIAL_FORMAT
