"""What commands write with `--json`: one structure for each format."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import (
    AtMost,
    Command,
    ContactEntry,
    Degrees,
    Mm,
    Names,
    Notes,
    Objective,
    Pair,
    PartMotion,
    Percent,
    Point,
    Ring,
)
from wiggleroom.verdict import Certainty, Separability, Verdict

PathState = Annotated[
    Literal["checked", "not checked"], Meta(description="whether no two parts overlap anywhere on the path from rest")
]
Seconds = Annotated[float, Meta(description="[s]")]


class BoundEntry(Struct):
    """How `at_most` came about."""

    kind: Annotated[
        Literal["proven", "quick"], Meta(description="asked for and tightened, or found at little cost; both hold")
    ]
    within: Annotated[float | None, Meta(description="how far it lies above the motion found, as a share of it")]
    seconds: Seconds


class SearchEntry(Struct):
    """What the search beyond the nearest hill came to."""

    starts: Annotated[int, Meta(description="climbs that were made, the one from rest among them")]
    at_value: Annotated[int, Meta(description="how many of them ended at the objective, to 0.1 %")]
    next_best: Annotated[float | None, Meta(description="best value at which others ended; null where there is none")]


class PeriodEntry(Struct):
    """One period of a motion that repeats for ever: every part ends turned by a symmetry of its outline, so all lies as it began."""

    objective: Annotated[float, Meta(description="what the objective gains in it [rad]")]
    turns_deg: Annotated[
        dict[str, float], Meta(description="how far each part turns in it [deg]; those that do not are left out")
    ]
    first: Annotated[int, Meta(description="index of the way-point in `path` at which it begins; it ends at the last")]
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(description="checked way-points from rest on, each with the parts that move on this path"),
    ]


class FlexResult(Struct, tag_field="format", tag="wiggleroom.flex/1", kw_only=True):
    """The largest motion that was found: `wiggleroom flex --json`."""

    verdict: Annotated[Verdict, Meta(description="how the search ended")]
    objective: Objective
    at_most: AtMost
    bound: BoundEntry | UnsetType = UNSET
    search: SearchEntry | UnsetType = UNSET
    leaves: Annotated[
        list[str] | UnsetType, Meta(description="parts that move away without limit; of unbounded answers")
    ] = UNSET
    turns: Annotated[list[str] | UnsetType, Meta(description="parts that turn without limit; of unbounded answers")] = (
        UNSET
    )
    period: PeriodEntry | UnsetType = UNSET
    parts: Annotated[dict[str, PartMotion], Meta(description="motion of every part by its name")]
    collision_free: Annotated[bool, Meta(description="no two parts overlap at the end, by exact geometry")]
    deepest_overlap: Mm
    path: PathState
    contacts: list[ContactEntry]
    model: Annotated[str, Meta(description="what stands for the free space of a pair: walls, hull or halfplane")]
    solver: str
    rounds: Annotated[int, Meta(description="programs that were solved")]
    seconds: Annotated[dict[str, float], Meta(description="time by stage, and in total [s]")]
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class EscapeEntry(Struct):
    """Parts that leave together."""

    parts: Names
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(description="way-points from rest on, each with the parts that move on this path"),
    ]


class StateSearchEntry(Struct, kw_only=True):
    """How far the search for ways out went."""

    states: Annotated[int, Meta(description="states to which slides, and turns of single parts, led")]
    turned: Annotated[int, Meta(description="of these states those in which every part was turned both ways")]
    whole: Annotated[bool, Meta(description="these are all such states of the parts that are left")]
    questions: Annotated[int, Meta(description="largest motions that were searched")]
    unanswered: Annotated[int, Meta(description="of these those that found no end whose way is certain")]


class SeparabilityEntry(Struct, kw_only=True):
    """Whether parts come apart at one gap."""

    verdict: Separability
    certainty: Certainty
    at_most: Annotated[
        float | None, Meta(description="a distance [mm] that no point of any part exceeds, proven; else null")
    ]
    escapes: Annotated[list[EscapeEntry], Meta(description="in the order in which they leave")]
    spins: Annotated[list[str], Meta(description="parts that turn in place without limit")]
    remains: Annotated[list[str], Meta(description="parts of which nothing more was found to leave")]
    search: StateSearchEntry


class LargestGapEntry(Struct, kw_only=True):
    """The gap at which the assembly comes apart, from both sides."""

    interlocked_at: Annotated[float | None, Meta(description="largest gap [mm] at which it holds")]
    comes_apart_at: Annotated[float | None, Meta(description="smallest gap [mm] at which it comes apart")]
    interlocked: SeparabilityEntry | None
    comes_apart: SeparabilityEntry | None


class CheckResult(SeparabilityEntry, tag_field="format", tag="wiggleroom.check/1", kw_only=True):
    """Whether it comes apart: `wiggleroom check --json`."""

    gap: Mm
    largest_gap: LargestGapEntry | UnsetType = UNSET
    seconds: Seconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


class PlanStepEntry(Struct, kw_only=True):
    """One step: some parts move, all others stay."""

    parts: Annotated[list[str], Meta(description="names of the parts that move")]
    as_one: Annotated[bool, Meta(description="they move as one rigid piece")]
    leaves: Annotated[list[str], Meta(description="those that have left at its end")]
    moves: Annotated[int, Meta(description="of how many moves it consists")]
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(
            description="way-points, each with the motions since rest of all parts that are still there and not at rest"
        ),
    ]
    clearance: Annotated[float, Meta(description="least distance between what moves and all else [mm]")]
    room: Annotated[
        float, Meta(description="the largest ball of errors of position under which the step still goes [mm]")
    ]
    turn_room_deg: Annotated[float, Meta(description="an error of angle under which it certainly still goes [deg]")]
    axis: Annotated[Point, Meta(description="unit vector along which the parts go in when they are put together")]
    held: Annotated[list[str], Meta(description="loose parts that must be held")]
    falling: Annotated[list[str], Meta(description="of these those that would fall; with gravity")]


class PlanAssemblyEntry(Struct, kw_only=True):
    """One step backwards: parts are put in."""

    step: Annotated[int, Meta(description="number of the step that it reverses, from 1")]
    parts: Names
    path: Annotated[list[dict[str, PartMotion]], Meta(description="that of the step, backwards")]
    axis: Annotated[Point, Meta(description="unit vector of the first straight piece backwards")]
    held: Names
    falling: Names


class PlanSampleEntry(Struct, kw_only=True):
    """What becomes of the plan when the gap round every part varies at random; its ways stay as they are."""

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
    """The smallest gap at which the plan works, its ways fitted anew, from both sides."""

    works_at: Annotated[float, Meta(description="smallest gap at which every step was found to be free [mm]")]
    fails_at: Annotated[
        float | None, Meta(description="largest gap at which a step was not; null where all that were tried work")
    ]
    step: Annotated[int | None, Meta(description="that step, from 1; null where parts touch at rest or none fails")]
    parts: Annotated[list[str], Meta(description="the two parts that are in each other's way there")]
    paths: Annotated[
        list[list[dict[str, PartMotion]]], Meta(description="way-points of every step at the smallest gap that works")
    ]


class PlanResult(Struct, tag_field="format", tag="wiggleroom.plan/1", kw_only=True):
    """In which order and along which ways parts are taken apart and put together: `wiggleroom plan --json`."""

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
    gravity: Annotated[Point | None, Meta(description="unit vector in which loose parts fall; null: not looked at")]
    search: StateSearchEntry
    sample: PlanSampleEntry | UnsetType = UNSET
    rank: list[PlanRankEntry] | UnsetType = UNSET
    smallest_gap: PlanGapEntry | UnsetType = UNSET
    gap: Mm
    seconds: Seconds
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


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

    objective: Objective
    tightened: Annotated[float | None, Meta(description="objective with the chosen parts tight")]
    verdict: Verdict
    lowered_percent: float | None
    parts: Annotated[list[str], Meta(description="in the order in which they were chosen")]
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
    path: PathState
    at_most: Annotated[
        float | UnsetType | None,
        Meta(description="a value that no motion exceeds at this gap; where it was asked to be proven"),
    ] = UNSET


class SweepResult(Struct, tag_field="format", tag="wiggleroom.sweep/1", kw_only=True):
    """Motion against gap: `wiggleroom sweep --json`."""

    gaps: list[SweepEntry]
    lost_between: Annotated[
        tuple[float, float] | None, Meta(description="gaps [mm] between which the motion loses its end")
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

    objective: float
    extra_gap: Annotated[dict[str, float], Meta(description="extra gap round every part [mm]")]


class YieldEntry(Struct):
    """Share of draws that keep the limit, with a 95 % interval."""

    share: float | None
    low: float
    high: float


class CheckedDraws(Struct):
    """Draws that were solved again from nothing."""

    draws: int
    largest_difference: float | None


class SampleResult(Struct, tag_field="format", tag="wiggleroom.sample/1", kw_only=True, rename={"yields": "yield"}):
    """Motion with random gaps: `wiggleroom sample --json`."""

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
    contributions_percent: dict[str, float]
    checked: CheckedDraws
    notes: Notes = msgspec.field(default_factory=list)
    command: Command


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
    command: Command


class GapTrial(Struct, kw_only=True):
    """What was found at one gap."""

    gap: Mm
    objective: Annotated[
        float | UnsetType | None,
        Meta(description="largest motion [mm], turns in [rad]; null where it has no end or parts do not fit"),
    ] = UNSET
    overlap: Annotated[float | UnsetType | None, Meta(description="deepest overlap at rest [mm]; of fits")] = UNSET
    at_most: AtMost
    verdict: Annotated[str, Meta(description="that of the motion or the check; fits or overlaps")]
    path: PathState


class GapResult(Struct, tag_field="format", tag="wiggleroom.gap/1", kw_only=True):
    """The gap that answers a maker's question: `wiggleroom gap --json`."""

    question: Literal["at most", "holds", "fits"]
    limit: Annotated[float | None, Meta(description="largest motion [mm, rad], or how much larger outlines are [mm]")]
    gap: Annotated[float | None, Meta(description="the answer [mm]; null where there is none")]
    certainty: Annotated[Certainty | None, Meta(description="what the answer rests on; null where there is none")]
    beyond: Annotated[float | None, Meta(description="nearest gap that was seen to fail [mm]")]
    searched_gap: Annotated[float | None, Meta(description="largest gap at which nothing against it was found [mm]")]
    proven_gap: Annotated[float | None, Meta(description="largest gap that was proven [mm]")]
    stopped: Annotated[bool, Meta(description="the time was over before both sides lay near each other")]
    note: str
    kerf: Annotated[float | UnsetType, Meta(description="width of the cut [mm]; where it was named")] = UNSET
    offset: Annotated[
        float | UnsetType | None,
        Meta(description="how far outward the cut lies from the drawn line, so that this gap comes out [mm]"),
    ] = UNSET
    trials: list[GapTrial]
    command: Command


class ContributionEntry(Struct, kw_only=True):
    """What one tolerance does to the motion, the others at their nominal."""

    parts: Annotated[list[str], Meta(description="a part, or the two of a joint")]
    outline: Annotated[int | None, Meta(description="number of the only outline that is meant")]
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
    path: PathState


class TolerancesResult(Struct, tag_field="format", tag="wiggleroom.tolerances/1", kw_only=True):
    """Worst case within tolerances: `wiggleroom tolerances --json`."""

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
    command: Command


class PartListing(Struct):
    """One part as drawn."""

    name: str
    layer: str
    x: Annotated[float, Meta(description="reference point [mm]")]
    y: Mm
    width: Annotated[float, Meta(description="of the box round it [mm]")]
    height: Mm
    area: Annotated[float, Meta(description="[mm2]")]
    pieces: int
    holes: int
    fixed: bool


class PartsResult(Struct, tag_field="format", tag="wiggleroom.parts/1", kw_only=True):
    """What a file holds: `wiggleroom parts --json`."""

    parts: list[PartListing]
    notes: Notes
    findings: Annotated[list[str], Meta(description="what is wrong with the file, one line each")]
    command: Command


class SheetJointEntry(Struct, kw_only=True):
    """Two panels that hold each other; in space their flanks meet, in the plane stretches of their outlines."""

    name: str
    panels: Pair
    flanks: Annotated[int | UnsetType, Meta(description="pairs of flanks that meet; in space")] = UNSET
    length: Annotated[float | UnsetType, Meta(description="of the contact [mm]; in the plane")] = UNSET
    on_sheet: Annotated[
        tuple[Point, Point], Meta(description="where the sheet shows it on the one and the other panel [mm], y up")
    ]


class UnmatchedEntry(Struct, kw_only=True):
    """What a placed panel holds ready and nothing meets."""

    panel: str
    on_sheet: Annotated[list[Point], Meta(description="where the sheet shows it [mm], y up")]


class AssembleResult(Struct, tag_field="format", tag="wiggleroom.assemble/1", kw_only=True):
    """A cutting sheet put together: `wiggleroom assemble --json`."""

    certainty: Annotated[
        Literal["sure", "not sure"], Meta(description="sure: everything fits, and nothing else does as well")
    ]
    doubts: Annotated[list[str], Meta(description="why it is not sure, one line each")]
    panels: Annotated[int, Meta(description="how many the sheet has")]
    placed: int
    bodies: Annotated[list[Names], Meta(description="panels that hold together")]
    joints: list[SheetJointEntry]
    unmatched: list[UnmatchedEntry]
    unplaced: Names
    loose: Annotated[Names, Meta(description="those of them of which no edge fits another panel")]
    burn: Annotated[float, Meta(description="taken off every outline [mm]: as the cut does")]
    relief: Annotated[float, Meta(description="taken off besides, so that nothing presses at rest [mm]")]
    notes: Notes
    command: Command


RESULTS = (
    FlexResult, CheckResult, PlanResult, GapResult, RankResult, TightenResult, SweepResult, SampleResult, TolerancesResult, SpaceResult,
    PartsResult, AssembleResult,
)  # fmt: skip
"""All formats."""
