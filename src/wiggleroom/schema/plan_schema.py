"""What `plan --json` writes."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.disassembly_schema import StateSearchEntry
from wiggleroom.schema.fields import Command, InSpace, Mm, Names, Notes, PartMotion, Place, Seconds
from wiggleroom.schema.spatial_result_schema import SpatialMotion
from wiggleroom.verdict import Certainty, Separability


class PlanStepEntry(Struct, kw_only=True):
    """One step: some parts move, all others stay."""

    parts: Annotated[list[str], Meta(description="names of the parts that move")]
    as_one: Annotated[bool, Meta(description="they move as one rigid piece")]
    leaves: Annotated[list[str], Meta(description="those that have left at its end")]
    moves: Annotated[int, Meta(description="of how many moves it consists")]
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(
            description="waypoints, each with the motions since rest of all parts that are still there and not at rest"
        ),
    ]
    clearance: Annotated[float, Meta(description="least distance between what moves and all else [mm]")]
    room: Annotated[
        float, Meta(description="the largest ball of errors of position under which the step still goes [mm]")
    ]
    turn_room_deg: Annotated[float, Meta(description="an error of angle under which it certainly still goes [deg]")]
    axis: Annotated[Place, Meta(description="unit vector along which the parts go in when they are put together")]
    held: Annotated[list[str], Meta(description="loose parts that must be held")]
    falling: Annotated[list[str], Meta(description="of these those that would fall; with gravity")]


class PlanAssemblyEntry(Struct, kw_only=True):
    """One step backwards: parts are put in."""

    step: Annotated[int, Meta(description="number of the step that it reverses, from 1")]
    parts: Names
    path: Annotated[list[dict[str, PartMotion]], Meta(description="that of the step, backwards")]
    axis: Annotated[Place, Meta(description="unit vector of the first straight piece backwards")]
    held: Names
    falling: Names


class PlanSampleEntry(Struct, kw_only=True):
    """What becomes of the plan when the gap round every part varies at random; its paths stay as they are."""

    share: Annotated[float, Meta(description="share of the draws that go together")]
    interval: Annotated[tuple[float, float], Meta(description="95 % confidence interval of the share")]
    draws: int
    clearance: Annotated[
        dict[str, float], Meta(description="least clearance [mm] that 1, 5, 50 % of the draws fall below")
    ]
    failing: Annotated[
        list[int], Meta(description="draws in which each step does not go; the last: parts overlap at rest")
    ]


class PlanRankEntry(Struct):
    """What the gap of one part does to the room of the plan."""

    part: str
    mm_per_mm: Annotated[
        float, Meta(description="gain of the least clearance per mm of extra gap round this part alone")
    ]


class PlanGapEntry(Struct, kw_only=True):
    """The smallest gap at which the plan works, its paths fitted anew, from both sides."""

    works_at: Annotated[float, Meta(description="smallest gap at which every step was found to be free [mm]")]
    fails_at: Annotated[
        float | None, Meta(description="largest gap at which a step was not; null where all that were tried work")
    ]
    step: Annotated[int | None, Meta(description="that step, from 1; null where parts touch at rest or none fails")]
    parts: Annotated[list[str], Meta(description="the two parts that are in each other's way there")]
    paths: Annotated[
        list[list[dict[str, PartMotion]]], Meta(description="waypoints of every step at the smallest gap that works")
    ]


class PlanRecord(Struct, kw_only=True):
    """What a plan says in the plane and in space."""

    verdict: Annotated[
        Separability, Meta(description="comes apart: all targets leave or, without targets, anything does")
    ]
    certainty: Certainty
    targets: Names
    order: Annotated[list[list[str]], Meta(description="parts that leave together, in the order of leaving")]
    level: Annotated[list[int], Meta(description="moves up to the first removal, from there to the second, and so on")]
    moves: Annotated[int, Meta(description="moves of the whole plan")]
    steps: list[PlanStepEntry]
    assembly: Annotated[list[PlanAssemblyEntry], Meta(description="the steps backwards: how it is put together")]
    remains: Annotated[list[str], Meta(description="loose parts that were to leave and do not")]
    rest: Annotated[Separability, Meta(description="what became of the parts that are left")]
    rest_certainty: Annotated[Certainty, Meta(description="what shows that")]
    gravity: Annotated[Place | None, Meta(description="unit vector in which loose parts fall; null: not looked at")]
    search: StateSearchEntry
    sample: PlanSampleEntry | UnsetType = UNSET
    rank: list[PlanRankEntry] | UnsetType = UNSET
    smallest_gap: PlanGapEntry | UnsetType = UNSET
    gap: Mm
    seconds: Seconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class PlanResult(PlanRecord, tag_field="format", tag="wiggleroom.plan/1", kw_only=True):
    """In which order and along which paths parts are taken apart and put together: `wiggleroom plan --json`."""


class SpatialPlanStepEntry(PlanStepEntry, kw_only=True):
    """One step in space."""

    path: list[dict[str, SpatialMotion]]  # type: ignore[assignment]


class SpatialPlanAssemblyEntry(PlanAssemblyEntry, kw_only=True):
    """One step backwards in space."""

    path: list[dict[str, SpatialMotion]]  # type: ignore[assignment]


class SpatialPlanResult(PlanRecord, tag_field="format", tag="wiggleroom.plan/1", kw_only=True):
    """The same in space."""

    dimension: InSpace = 3
    steps: list[SpatialPlanStepEntry]  # type: ignore[assignment]
    assembly: list[SpatialPlanAssemblyEntry]  # type: ignore[assignment]
