"""What `gap` and `tolerances` write with `--json`."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import AtMost, Command, InSpace, Mm, Notes, Objective, PathChecked, Percent
from wiggleroom.verdict import Certainty, Verdict


class GapTrial(Struct, kw_only=True):
    """What was found at one gap."""

    gap: Mm
    objective: Annotated[
        float | UnsetType | None,
        Meta(description="largest motion [mm], turns in [rad]; null where it has no end or parts do not fit"),
    ] = UNSET
    overlap: Annotated[
        float | UnsetType | None, Meta(description="deepest overlap of parts as drawn, not shifted [mm]; of fits")
    ] = UNSET
    at_most: AtMost
    verdict: Annotated[
        str, Meta(description="that of the motion or the check; climbed: not searched; fits or overlaps, as drawn")
    ]
    path: PathChecked


class GapResult(Struct, tag_field="format", tag="wiggleroom.gap/1", kw_only=True):
    """The gap that answers a maker's question: `wiggleroom gap --json`."""

    dimension: InSpace | UnsetType = UNSET
    question: Literal["at most", "holds", "fits"]
    limit: Annotated[float | None, Meta(description="largest motion [mm, rad], or how much larger outlines are [mm]")]
    gap: Annotated[
        float | None,
        Meta(description="the answer [mm], of fits that of parts as drawn, not shifted; null where there is none"),
    ]
    certainty: Annotated[Certainty | None, Meta(description="what the answer rests on; null where there is none")]
    beyond: Annotated[float | None, Meta(description="nearest gap that was seen to fail [mm]")]
    searched_gap: Annotated[float | None, Meta(description="largest gap at which nothing against it was found [mm]")]
    proven_gap: Annotated[float | None, Meta(description="largest gap that was proven [mm]")]
    fits_from: Annotated[
        float | UnsetType | None,
        Meta(description="smallest gap at which parts as drawn, not shifted, do not overlap [mm]; not of fits"),
    ] = UNSET
    stopped: Annotated[bool, Meta(description="the time was over before both sides lay near each other")]
    note: str
    kerf: Annotated[float | UnsetType, Meta(description="width of the cut [mm]; where it was named")] = UNSET
    offset: Annotated[
        float | UnsetType | None,
        Meta(description="how far outward the cut lies from the drawn line, so that this gap comes out [mm]"),
    ] = UNSET
    trials: list[GapTrial]
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class ContributionEntry(Struct, kw_only=True):
    """What one tolerance does to the motion, the others at their nominal."""

    parts: Annotated[list[str], Meta(description="a part, or the two of a joint")]
    outline: Annotated[
        int | Literal["thickness"] | None,
        Meta(description="number of the only outline that is meant, or the thickness of a plate"),
    ]
    nominal: Annotated[float | None, Meta(description="[mm]; null: as the drawing has it")]
    plus: Mm
    minus: Mm
    mm_per_mm: Annotated[
        float, Meta(description="motion gained per mm that the outline lies further in, or the joint is wider")
    ]
    looser: Annotated[float, Meta(description="motion gained at the loose end, to first order [mm]")]
    tighter: Annotated[float, Meta(description="motion lost at the tight end, to first order [mm]")]
    percent: Percent


class CornerEntry(Struct, kw_only=True):
    """The largest motion at one corner of the tolerances."""

    objective: Objective
    at_most: AtMost
    verdict: Verdict
    path: PathChecked


class TolerancesResult(Struct, tag_field="format", tag="wiggleroom.tolerances/1", kw_only=True):
    """Worst case within tolerances: `wiggleroom tolerances --json`."""

    dimension: InSpace | UnsetType = UNSET
    objective: Annotated[float | None, Meta(description="with everything where it should be [mm], turns in [rad]")]
    worst: Annotated[CornerEntry, Meta(description="every outline as far in, every joint as wide, as allowed")]
    best: Annotated[
        CornerEntry | None, Meta(description="the other corner; null where parts then do not fit, see misfit")
    ]
    misfit: str
    first_order: Annotated[float, Meta(description="worst case as the sum of all contributions [mm]")]
    root_sum_square: Annotated[float, Meta(description="the same with independent contributions [mm]")]
    limit: float | None
    keeps_limit: bool | None
    certainty: Certainty
    stopped: bool
    contributions: Annotated[list[ContributionEntry], Meta(description="the largest first")]
    notes: Notes = msgspec.field(default_factory=list)
    command: Command
