"""What `rank`, `tighten`, `sweep` and `sample` write with `--json`."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import Command, InSpace, Mm, Notes, Objective, Pair, PathChecked, Percent
from wiggleroom.verdict import Verdict


class PartImportance(Struct):
    """What the gap of one part does to the motion."""

    mm_per_mm: Annotated[float, Meta(description="gain of the objective per mm of extra gap round this part alone")]
    percent: Annotated[float, Meta(description="share of the sum over all parts [%]")]
    tighter_mm_per_mm: Annotated[
        float, Meta(description="loss per mm of smaller gap; differs where parts share a load")
    ]
    duals_mm_per_mm: Annotated[float, Meta(description="the same from one set of multipliers")]
    unique: Annotated[bool, Meta(description="both sides agree")]
    importance: Annotated[float, Meta(description="middle of both sides: what order and percent go by")]


class JointImportance(Struct):
    """What the gap of one joint does to the motion."""

    parts: Pair
    mm_per_mm: float
    percent: Percent
    unique: bool
    tighter_mm_per_mm: Annotated[
        float, Meta(description="loss per mm of smaller gap; differs where joints share a load")
    ]
    importance: Annotated[float, Meta(description="middle of both sides: what order and percent go by")]


class RankResult(Struct, tag_field="format", tag="wiggleroom.rank/1", kw_only=True):
    """Whose gap matters: `wiggleroom rank --json`."""

    dimension: InSpace | UnsetType = UNSET
    objective: Objective
    verdict: Verdict
    by: Annotated[str, Meta(description="duals or differences")]
    parts: Annotated[dict[str, PartImportance], Meta(description="by name, the most important first")]
    joints: list[JointImportance]
    ranges: Annotated[str, Meta(description="whether ranges of multipliers are whole or at least so wide")]
    virtual_percent: Annotated[float, Meta(description="share of the force that is held where nothing touches [%]")]
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class RandomChoices(Struct):
    """How choices at random do beside the chosen ones."""

    draws: int
    mean: float | None
    lowered_percent: float | None
    misfits: Annotated[int, Meta(description="choices whose parts do not fit then; the mean is of the others")]


class TightenResult(Struct, tag_field="format", tag="wiggleroom.tighten/1", kw_only=True):
    """Which parts to make tighter: `wiggleroom tighten --json`."""

    dimension: InSpace | UnsetType = UNSET
    objective: Objective
    tightened: Annotated[float | None, Meta(description="objective with the chosen parts tight")]
    verdict: Verdict
    lowered_percent: float | None
    parts: Annotated[list[str], Meta(description="chosen by rank in that order, else in the order of the assembly")]
    chosen_by: Annotated[
        Literal["rank", "draws", "all"],
        Meta(description="by rank, as the best of choices at random, or as the best of all choices of as many parts"),
    ]
    gap: Annotated[float, Meta(description="their share of the gap then [mm]")]
    limit: float | None
    reached: bool
    random: RandomChoices
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class SweepEntry(Struct):
    """The motion at one gap."""

    gap: Mm
    objective: Objective
    verdict: Verdict
    path: PathChecked
    at_most: Annotated[
        float | UnsetType | None,
        Meta(description="a value that no motion exceeds at this gap; where it was asked to be proven"),
    ] = UNSET


class SweepResult(Struct, tag_field="format", tag="wiggleroom.sweep/1", kw_only=True):
    """Motion against gap: `wiggleroom sweep --json`."""

    dimension: InSpace | UnsetType = UNSET
    gaps: list[SweepEntry]
    lost_between: Annotated[
        tuple[float, float] | None,
        Meta(description="at the first gap [mm] a search found an end of the motion, at the second nothing stops it"),
    ]
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class SpreadEntry(Struct):
    """How gaps were drawn."""

    width: Mm
    kind: str
    sheet: Annotated[float, Meta(description="share that the parts of one sheet have in common")]
    bias: Mm


class WorstDraw(Struct):
    """The draw with the largest motion."""

    objective: Annotated[float | None, Meta(description="null where nothing stops it, or no draw fits")]
    extra_gap: Annotated[dict[str, float], Meta(description="extra gap round every part [mm]")]


class YieldEntry(Struct):
    """Share of draws that keep the limit, with a 95 % interval; undecided draws are not in the share, the interval allows for them."""

    share: float | None
    low: float
    high: float


class CheckedDraws(Struct):
    """Draws that were searched as `flex` does."""

    draws: int
    largest_difference: Annotated[float | None, Meta(description="largest share by which their climbs were off")]


class SampleResult(Struct, tag_field="format", tag="wiggleroom.sample/1", kw_only=True, rename={"yields": "yield"}):
    """Motion with random gaps: `wiggleroom sample --json`."""

    dimension: InSpace | UnsetType = UNSET
    objective: Objective
    spread: SpreadEntry
    draws: int
    asked: int
    seed: int
    mean: float | None
    standard_deviation: float | None
    foreseen_standard_deviation: Annotated[float | None, Meta(description="from the derivatives alone")]
    quantiles: dict[str, float | None]
    worst: WorstDraw
    unbounded: Annotated[int, Meta(description="draws in which nothing stops the motion")]
    misfits: Annotated[int, Meta(description="draws in which parts do not fit beside each other")]
    cut_short: Annotated[int, Meta(description="draws whose motion is safe but not an optimum")]
    limit: float | None
    yields: YieldEntry
    undecided: Annotated[
        int, Meta(description="draws that were only climbed, and may move further than found: beyond the limit, if any")
    ]
    tightest: Annotated[
        float | str | None,
        Meta(description='searched, with every part as tight as in any draw; or "unbounded" or "parts do not fit"'),
    ]
    loosest: Annotated[float | str | None, Meta(description="the same with every part as loose as in any draw")]
    contributions_percent: dict[str, float]
    checked: CheckedDraws
    notes: Notes = msgspec.field(default_factory=list)
    command: Command
