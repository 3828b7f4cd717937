"""What `space --json` writes."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta, Struct

from wiggleroom.schema.fields import Command, Degrees, Notes, Pair, Point, Ring


class CellEntry(Struct):
    """One cell of a free space."""

    walls: int
    angles_deg: Annotated[tuple[float, float], Meta(description="interval of turns [deg]")]


class SliceEntry(Struct):
    """All free translations at one turn."""

    angle_deg: Degrees
    area: Annotated[float, Meta(description="[mm²]")]
    holes: list[Ring]
    outlines: list[Ring]


class AuditEntry(Struct):
    """Free space judged at random motions by polygon intersection."""

    samples: int
    free: int
    accepted: int
    unsafe: int
    lost: int


class SpaceResult(Struct, tag_field="format", tag="wiggleroom.space/1", kw_only=True):
    """The free space of a pair: `wiggleroom space --json`."""

    parts: Pair
    closed: bool
    reach: Annotated[float | None, Meta(description="how far an open one was looked at [mm]")]
    angles_deg: list[float]
    volume: Annotated[float, Meta(description="[mm² deg]")]
    coverage: Annotated[float, Meta(description="share that the cells cover")]
    pivot: Annotated[Point, Meta(description="the point whose motion is told [mm]")]
    cells: list[CellEntry]
    slices: list[SliceEntry]
    audit: AuditEntry | None
    notes: Notes = msgspec.field(default_factory=list)
    command: Command
