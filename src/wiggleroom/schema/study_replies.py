"""Replies to the page with what a study found: importance of gaps, disassembly, sweeps, free spaces, bounds."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType, field

from wiggleroom.schema.fields import AtMost, Command, Degrees, Mm, Names, Objective, Pair, Percent, Point, Ring
from wiggleroom.schema.reply_base import Cell, Pose, Reply, Terms
from wiggleroom.verdict import Certainty, Separability, Verdict


class ImportanceEntry(Struct):
    """What the gap of one part does to the motion."""

    mm_per_mm: float
    tighter: Annotated[float, Meta(description="the same for a smaller gap")]
    percent: Percent


class JointEntry(Struct):
    """What the gap of one joint does to the motion."""

    parts: Pair
    mm_per_mm: float
    percent: Percent


class RankReply(Reply, tag="rank", kw_only=True):
    """Whose gap matters, the most important first."""

    parts: dict[str, ImportanceEntry]
    joints: list[JointEntry]
    per: Annotated[str, Meta(description="unit of the numbers")]
    unique: bool
    note: str
    command: Command


class LeavingEntry(Struct):
    """Parts that leave together, and how."""

    parts: Names
    words: str


class CheckReply(Reply, tag="check", kw_only=True):
    """Whether it comes apart, after a path for each escape."""

    verdict: Separability
    certainty: Certainty
    words: str
    sure: Terms
    escapes: list[LeavingEntry]
    spins: Names
    remains: Names
    border: Annotated[str | None, Meta(description="the largest gap, where it is known")]
    command: Command


class LimitReply(Reply, tag="limit", kw_only=True):
    """The largest gap that holds everything together."""

    words: str
    holds: Annotated[float | None, Meta(description="a gap at which nothing was found to leave [mm]")]
    parts_at: Annotated[float | None, Meta(description="a gap at which it comes apart [mm]")]
    command: Command


class PlanReply(Reply, tag="plan", kw_only=True):
    """How it is taken apart, after a path for each step."""

    verdict: Separability
    words: str
    facts: list[str]
    sure: Terms
    steps: list[LeavingEntry]
    remains: Names
    command: Command


class StepReply(Reply, tag="step", kw_only=True):
    """One gap of a sweep, after the frame of its end where it has one."""

    gap: Mm
    objective: Objective
    verdict: Verdict
    checked: bool
    at_most: Annotated[
        float | UnsetType | None, Meta(description="a value that no motion exceeds, where one was proven")
    ] = UNSET


class SweepReply(Reply, tag="sweep", kw_only=True):
    """The whole sweep."""

    steps: list[StepReply]
    lost: Annotated[
        tuple[float, float] | None,
        Meta(description="at the first gap [mm] a search found an end of the motion, at the second nothing stops it"),
    ]
    command: Command


class SpaceSlice(Struct):
    """All free translations at one turn."""

    angle_deg: Degrees
    rings: list[Ring]


class SpaceReply(Reply, tag="space", kw_only=True):
    """The free space of a pair."""

    a: str
    b: str
    vertices: Annotated[str, Meta(description="base64 of float32 x [mm], y [mm], angle [deg], in motions of the pivot")]
    triangles: Annotated[str, Meta(description="base64 of uint32, three vertices each")]
    slices: list[SpaceSlice]
    range_deg: tuple[float, float]
    scale: Annotated[float, Meta(description="how many mm a degree is tall in pictures")]
    pivot: Annotated[Point, Meta(description="from b's reference point in the axes of a at rest [mm]")]
    state: Annotated[Pose, Meta(description="where the pair is shown [mm, mm, deg]")]
    headline: str
    facts: list[str]
    model: str
    command: Command
    open: Annotated[bool | UnsetType, Meta(description="true where the region has no end")] = UNSET
    words: str | UnsetType = UNSET


class ProveReply(Reply, tag="prove", kw_only=True):
    """A value that no motion exceeds."""

    at_most: AtMost
    within: float | None
    words: str
    command: Command


class BoundReply(Reply, tag="bound", kw_only=True):
    """A quick bound of a full answer."""

    at_most: AtMost
    within: float | None
    words: Annotated[str, Meta(description='such as "at most 0.84 mm"; empty where there is none')]


class Piece(Struct):
    """A piece of a page under its heading: a sentence, a picture, a table that can be sorted, terms and what they mean."""

    title: str
    text: str
    columns: list[str]
    rows: list[list[Cell]]
    terms: Terms
    svg: str


class StudyTab(Struct):
    """A tab of pieces."""

    tab: str
    sections: list[Piece]


class Tints(Struct):
    """Colours of the parts while the tab of a study is open."""

    per: Annotated[str, Meta(description="unit of the values")]
    values: dict[str, float]


class Title(Struct):
    """What stands in place of the answer's headline."""

    title: str
    facts: list[str]


class StudyReply(Reply, tag="study", kw_only=True):
    """What a study found."""

    of: str
    said: Title
    study: StudyTab
    tints: Tints
    command: Command
    extra: Annotated[
        dict[str, float],
        Meta(description="extra gaps of parts [mm] with which it moves so; empty where nothing is to be set"),
    ] = field(default_factory=dict)
    gap: Annotated[
        float | None, Meta(description="gap of all joints [mm] that answers; null where none is proposed")
    ] = None


class StudyField(Struct, kw_only=True):
    """An option of a question, as a panel shows it."""

    name: str
    title: str
    kind: Literal["number", "count", "flag"]
    unit: str = ""
    least: float | None = None
    default: Annotated[float | bool | None, Meta(description="null: left out")] = None
    of_gap: Annotated[float | None, Meta(description="share of the gap that is suggested")] = None
    of_parts: Annotated[bool, Meta(description="counts parts that can move")] = False


class StudyForm(Struct, kw_only=True):
    """A question that the page can ask."""

    of: str
    title: str
    text: str
    button: str
    spatial: bool
    needs_end: Annotated[bool, Meta(description="true where a motion that ends must have been found")]
    fields: list[StudyField]
