"""Types of fields, with what they mean where a name alone does not say it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from wiggleroom.verdict import PathState

Point = tuple[float, float]
Place = Annotated[tuple[float, ...], Meta(min_length=2, max_length=3)]
"""A point or a direction, of two numbers in the plane and of three in space."""
Ring = list[Point]
Json = dict[str, Any]

Mm = Annotated[float, Meta(description="[mm]")]
Degrees = Annotated[float, Meta(description="[deg]")]
Percent = Annotated[float, Meta(description="[%]")]
Names = Annotated[list[str], Meta(description="names of parts")]
Pair = Annotated[tuple[str, str], Meta(description="names of two parts")]
Objective = Annotated[
    float | None, Meta(description="sum of the goals [mm], turns in [rad]; null where nothing stops the motion")
]
AtMost = Annotated[
    float | None, Meta(description="a value that no motion exceeds, proven; null where none was worked out")
]
Command = Annotated[str, Meta(description="the command that answers the same")]
Notes = Annotated[list[str], Meta(description="what was assumed or left out when the file was read, one line each")]
PathChecked = Annotated[PathState, Meta(description="whether no two parts overlap anywhere on the path from rest")]
Seconds = Annotated[float, Meta(description="[s]")]
StageSeconds = Annotated[dict[str, float], Meta(description="time by stage, and in total [s]")]
LeavingParts = Annotated[list[str], Meta(description="parts that move away without limit; of unbounded answers")]
TurningParts = Annotated[list[str], Meta(description="parts that turn without limit; of unbounded answers")]
CollisionFree = Annotated[bool, Meta(description="no two parts overlap at the end, by exact geometry")]
Rounds = Annotated[int, Meta(description="programs that were solved")]
Remains = Annotated[list[str], Meta(description="parts of which nothing more was found to leave")]
Findings = Annotated[list[str], Meta(description="what is wrong with the file, one line each")]
InSpace = Annotated[Literal[3], Meta(description="of an assembly in space; in the plane this key is left out")]


class PartMotion(Struct):
    """Motion of a part: pose minus rest pose, about its reference point."""

    dx: Mm
    dy: Mm
    turn_deg: Degrees


class ContactEntry(Struct):
    """A place where two parts hold each other at the end of the motion."""

    parts: Annotated[tuple[str, str], Meta(description="the normal points from the first into the second")]
    point: Annotated[Place, Meta(description="where they touch, parts moved [mm]")]
    normal: Annotated[Place, Meta(description="unit vector")]
    force: Annotated[float, Meta(description="multiplier: objective gained per mm that this contact gives way")]
