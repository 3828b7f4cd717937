"""What `flex`, `check` and `parts` write with `--json` of assemblies in space: the formats of the plane with motions of six numbers."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import (
    AtMost,
    CollisionFree,
    Command,
    ContactEntry,
    Findings,
    InSpace,
    LeavingParts,
    Mm,
    Names,
    Notes,
    Objective,
    PathChecked,
    Remains,
    Rounds,
    Seconds,
    StageSeconds,
    TurningParts,
)
from wiggleroom.schema.flex_schema import BoundEntry, SearchEntry
from wiggleroom.verdict import Certainty, Separability, Verdict

Vector = tuple[float, float, float]


class SpatialMotion(Struct):
    """Motion of a part in space: pose minus rest pose, about its reference point."""

    move: Annotated[Vector, Meta(description="displacement of the reference point [mm]")]
    turn_deg: Annotated[Vector, Meta(description="rotation vector [deg]")]


class SpatialFlexResult(Struct, tag_field="format", tag="wiggleroom.flex/1", kw_only=True):
    """The largest motion that was found in space: `wiggleroom flex --json`."""

    dimension: InSpace = 3
    verdict: Annotated[Verdict, Meta(description="how the search ended")]
    objective: Objective
    at_most: AtMost
    bound: BoundEntry | UnsetType = UNSET
    search: SearchEntry | UnsetType = UNSET
    leaves: LeavingParts | UnsetType = UNSET
    turns: TurningParts | UnsetType = UNSET
    parts: Annotated[dict[str, SpatialMotion], Meta(description="motion of every part by its name")]
    collision_free: CollisionFree
    deepest_overlap: Mm
    path: PathChecked
    contacts: list[ContactEntry]
    model: Annotated[str, Meta(description="what keeps two parts apart: planes between their pieces")]
    solver: str
    rounds: Rounds
    seconds: StageSeconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class SpatialEscapeEntry(Struct):
    """Parts that leave together in space."""

    parts: Names
    path: Annotated[
        list[dict[str, SpatialMotion]],
        Meta(description="waypoints from rest on, each with the parts that move on this path"),
    ]


SpatialEscapes = Annotated[list[SpatialEscapeEntry], Meta(description="in the order in which they leave")]
NoDistance = Annotated[None, Meta(description="null: no distance is proven in space")]
Spins = Annotated[list[str], Meta(description="parts that turn in place without limit")]


class SpatialSeparabilityEntry(Struct, kw_only=True):
    """Whether parts in space come apart at one gap."""

    verdict: Separability
    certainty: Certainty
    at_most: NoDistance = None
    escapes: SpatialEscapes
    spins: Spins
    remains: Remains


class SpatialLargestGapEntry(Struct, kw_only=True):
    """The gap at which an assembly in space comes apart, from both sides."""

    interlocked_at: Annotated[float | None, Meta(description="largest gap [mm] at which it holds")]
    comes_apart_at: Annotated[float | None, Meta(description="smallest gap [mm] at which it comes apart")]
    interlocked: SpatialSeparabilityEntry | None
    comes_apart: SpatialSeparabilityEntry | None


class SpatialCheckResult(Struct, tag_field="format", tag="wiggleroom.check/1", kw_only=True):
    """Whether it comes apart in space: `wiggleroom check --json`."""

    dimension: InSpace = 3
    verdict: Separability
    certainty: Certainty
    at_most: NoDistance = None
    escapes: SpatialEscapes
    spins: Spins
    remains: Remains
    gap: Mm
    largest_gap: SpatialLargestGapEntry | UnsetType = UNSET
    seconds: Seconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class SpatialPartListing(Struct):
    """One part in space as drawn."""

    name: str
    solid: Literal["plate", "boxes", "mesh"]
    at: Annotated[Vector, Meta(description="reference point [mm]")]
    size: Annotated[Vector, Meta(description="of the box round it at rest [mm]")]
    volume: Annotated[float, Meta(description="[mm3]")]
    pieces: Annotated[
        int | None, Meta(description="convex pieces that it consists of; null of meshes, which are not cut for this")
    ]
    fixed: bool
    lock: Annotated[list[str], Meta(description="freedoms that are taken away: x, y, z, rx, ry, rz")]


class SpatialPartsResult(Struct, tag_field="format", tag="wiggleroom.parts/1", kw_only=True):
    """What a file of an assembly in space holds: `wiggleroom parts --json`."""

    dimension: InSpace = 3
    parts: list[SpatialPartListing]
    notes: Notes
    findings: Findings
    command: Command
