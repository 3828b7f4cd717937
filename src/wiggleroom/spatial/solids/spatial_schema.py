"""What a file of format wiggleroom/2 may hold."""

# ruff: noqa: RUF012 (msgspec copies default values)

from __future__ import annotations

from typing import ClassVar

from wiggleroom.drawing.readers.assembly_schema import Entry, HeadEntry, Point

Triple = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


class SolidEntry(Entry):
    """One part: a plate, a mesh or boxes, and where it lies."""

    LISTS: ClassVar[dict[str, str]] = {"at": "[x, y, z]", "rotate": "[x, y, z] in degrees"}
    name: str
    outline: list[Point] | str | None = None
    holes: list[list[Point]] = []
    thickness: float | None = None
    mesh: str | None = None
    boxes: list[Six] | None = None
    at: Triple = (0.0, 0.0, 0.0)
    rotate: Triple = (0.0, 0.0, 0.0)
    fixed: bool = False
    lock: list[str] = []
    offset: float = 0.0
    density: float = 1.0


class SpatialPullEntry(Entry):
    """One term of what is asked: a direction or a turn."""

    part: str
    direction: Triple | None = None
    point: Triple | None = None
    turn: Triple | None = None
    weight: float = 1.0


class SpatialFileEntry(HeadEntry):
    """The whole file in space."""
