"""What `flex --json` writes."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import (
    AtMost,
    CollisionFree,
    Command,
    ContactEntry,
    LeavingParts,
    Mm,
    Notes,
    Objective,
    PartMotion,
    PathChecked,
    Rounds,
    Seconds,
    StageSeconds,
    TurningParts,
)
from wiggleroom.verdict import Verdict


class BoundEntry(Struct):
    """How `at_most` came about."""

    kind: Annotated[
        Literal["proven", "quick"], Meta(description="asked for and tightened, or found at little cost; both hold")
    ]
    within: Annotated[float | None, Meta(description="how far it lies above the motion found, as a share of it")]
    seconds: Seconds


class SearchEntry(Struct):
    """What the search beyond the nearest local optimum came to."""

    starts: Annotated[int, Meta(description="climbs that were made, the one from rest among them")]
    at_value: Annotated[int, Meta(description="how many of them ended at the objective, to 0.1 %")]
    next_best: Annotated[float | None, Meta(description="best value at which others ended; null where there is none")]


class PeriodEntry(Struct):
    """One period of a motion that repeats for ever: every part ends turned by a symmetry of its outline, so all lies as it began."""

    objective: Annotated[float, Meta(description="what the objective gains in it [rad]")]
    turns_deg: Annotated[
        dict[str, float], Meta(description="how far each part turns in it [deg]; those that do not are left out")
    ]
    first: Annotated[int, Meta(description="index of the waypoint in `path` at which it begins; it ends at the last")]
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(description="checked waypoints from rest on, each with the parts that move on this path"),
    ]


class FlexResult(Struct, tag_field="format", tag="wiggleroom.flex/1", kw_only=True):
    """The largest motion that was found: `wiggleroom flex --json`."""

    verdict: Annotated[Verdict, Meta(description="how the search ended")]
    objective: Objective
    at_most: AtMost
    bound: BoundEntry | UnsetType = UNSET
    search: SearchEntry | UnsetType = UNSET
    leaves: LeavingParts | UnsetType = UNSET
    turns: TurningParts | UnsetType = UNSET
    period: PeriodEntry | UnsetType = UNSET
    parts: Annotated[dict[str, PartMotion], Meta(description="motion of every part by its name")]
    collision_free: CollisionFree
    deepest_overlap: Mm
    path: PathChecked
    contacts: list[ContactEntry]
    model: Annotated[str, Meta(description="what stands for the free space of a pair: walls, hull or halfplane")]
    solver: str
    rounds: Rounds
    seconds: StageSeconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command
