"""What the server, or a page that carries what was found, tells the page."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import (
    AtMost,
    Command,
    ContactEntry,
    Degrees,
    Mm,
    Names,
    Objective,
    Pair,
    Percent,
    Place,
    Point,
    Ring,
)
from wiggleroom.schema.listing_schema import SheetJointEntry, UnmatchedEntry
from wiggleroom.schema.requests import Design, GoalEntry, PlateHint
from wiggleroom.verdict import Certainty, Separability, Verdict

Terms = Annotated[list[tuple[str, str]], Meta(description="a word and a sentence each")]
Outline = Annotated[list[Ring], Meta(description="outer outlines and holes of one part, even-odd [mm]")]
Pose = tuple[float, float, float]
Cell = Annotated[
    str | list[str] | float | None, Meta(description="a word, names of parts, or a number; null where it is not known")
]


class Reply(Struct, tag_field="kind", tag=str.lower, kw_only=True):
    """Base of all replies; `id` is that of the request."""

    id: int = 0


class ExtraLimits(Struct):
    """What the server takes."""

    upload_mb: float


class SampleEntry(Struct):
    """A drawing to begin with."""

    name: str
    words: str
    count: Annotated[int, Meta(description="how many parts it has")]
    picture: Annotated[list[Outline], Meta(description="a small picture of its kind, 100 wide or high")]


class Hello(Reply, kw_only=True):
    """First words to a page."""

    version: str
    can: Annotated[list[str], Meta(description="extras that are installed")]
    limits: ExtraLimits
    samples: list[SampleEntry] = []


class PartShape(Struct):
    """A part as drawn, at rest in world coordinates."""

    name: str
    at: Annotated[Pose, Meta(description="reference point and angle [mm, mm, deg]")]
    rings: Outline


class SolidShape(Struct):
    """Surface of a solid about its reference point, at rest in the axes of the world."""

    vertices: Annotated[str, Meta(description="base64 of float32 x, y, z [mm]")]
    triangles: Annotated[str, Meta(description="base64 of uint32, three vertices each")]


class Solids(Struct):
    """Parts in space as they are made: each shape once, which one a part has, its reference point at rest, and where it is set aside."""

    shapes: list[SolidShape]
    of: list[int]
    reference: Annotated[list[tuple[float, float, float]], Meta(description="[mm]")]
    aside: Annotated[
        list[tuple[float, float, float]],
        Meta(description="by how much in an exploded view that doubles distances [mm]"),
    ]


class Opened(Reply, kw_only=True):
    """A drawing, and what it asks as a design."""

    name: str
    gap: Mm
    unit: str = "mm"
    notes: list[str]
    size: Annotated[tuple[float, float, float, float], Meta(description="box round everything: x0, y0, x1, y1 [mm]")]
    parts: list[PartShape]
    ignore: Annotated[list[tuple[str, str]], Meta(description="pairs of parts that never collide")] = []
    design: Design
    dimension: Literal[2, 3] = 2
    solids: Annotated[Solids | UnsetType, Meta(description="in space, where parts have no rings")] = UNSET
    pulled: Annotated[GoalEntry | UnsetType, Meta(description="a goal suggested where there is none")] = UNSET


class ShapeReply(Reply, tag="shape", kw_only=True):
    """Outlines, or solids, with the gap applied."""

    rings: list[Outline] = []
    solids: Solids | UnsetType = UNSET
    shown: Annotated[str | UnsetType, Meta(description="name of these outlines")] = UNSET


class FlexReply(Reply, tag="flex", kw_only=True):
    """An answer, after the frames of its path; quick ones first, then the full one."""

    objective: Objective
    verdict: Verdict
    headline: str
    facts: list[str]
    sure: Terms
    at_most: AtMost
    leaves: Names
    turns: Names
    contacts: Annotated[list[ContactEntry], Meta(description="the strongest first")]
    collision_free: bool
    path: str
    seconds: float
    command: Command
    settled: Annotated[bool, Meta(description="false where a fuller answer is to come")] = True
    rings: Annotated[list[Outline] | UnsetType, Meta(description="where the page shows others")] = UNSET
    solids: Annotated[Solids | UnsetType, Meta(description="in space, as the outlines")] = UNSET
    shown: Annotated[str | UnsetType, Meta(description="name of these outlines")] = UNSET


class DragReply(Reply, tag="drag", kw_only=True):
    """How near a part came to the pointer, after one frame."""

    part: str
    target: Place
    reached: Place
    distance: Mm
    held: list[ContactEntry]
    blocking: Names
    settled: bool
    rings: list[Outline] | UnsetType = UNSET
    solids: Solids | UnsetType = UNSET
    shown: Annotated[str | UnsetType, Meta(description="name of these outlines")] = UNSET


class ReachReply(Reply, tag="reach", kw_only=True):
    """Where a point can be brought."""

    part: str
    grip: Point
    rings: Outline
    exact: Annotated[bool, Meta(description="true: from the free space; false where its corners alone were reached")]
    open: Annotated[bool, Meta(description="true where the part leaves: the region is cut off")]
    words: str


class Released(Reply, tag="release", kw_only=True):
    """The end of a drag."""


class ModeEntry(Struct):
    """One freedom that is left."""

    size: Mm
    parts: Names
    ends: bool


class Modes(Reply, kw_only=True):
    """The freedoms that are left, after a path for each."""

    modes: list[ModeEntry]


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
    lost: Annotated[tuple[float, float] | None, Meta(description="gaps between which the motion loses its end [mm]")]
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


class Saved(Reply, kw_only=True):
    """A file."""

    name: str
    mime: str
    data: Annotated[str, Meta(description="base64")]


class ProgressReply(Reply, tag="progress", kw_only=True):
    """How far a request is, at most 20 times a second."""

    kind_of: str
    stage: str = ""
    round: int = 0
    iteration: int = 0
    objective: float | None = None
    share: float | None = None


class WorkerState(Reply, tag="worker", kw_only=True):
    """What became of the solver process."""

    state: Literal["ready", "lost", "restarted"]


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

    of: Literal["tighten", "sample"]
    said: Title
    study: StudyTab
    tints: Tints
    command: Command


class Mend(Struct):
    """A change of the design that may put something right: what stands in place of what it had."""

    words: str
    gap: Mm | UnsetType = UNSET
    fixed: Names | UnsetType = UNSET
    glue: list[Names] | UnsetType = UNSET
    goals: list[GoalEntry] | UnsetType = UNSET


class Finding(Struct):
    """Something that is wrong with a design, where it is, and what would help."""

    about: Literal["stands", "pulled", "gap", "parts"]
    words: str
    parts: Names = []
    point: Annotated[Point | None, Meta(description="where in the picture [mm]")] = None
    mends: list[Mend] = []


class SheetEdge(Struct):
    """A row of fingers, slots or holes of a panel, as it lies on the sheet."""

    reference: Annotated[str, Meta(description="how hints name it")]
    ends: tuple[Point, Point]
    joints: Annotated[list[str], Meta(description="names of the joints of which it is a side")]
    open: Annotated[int, Meta(description="how many of its flanks meet nothing that they should")]


class SheetPanel(Struct):
    """A panel of a cutting sheet."""

    name: str
    rings: Outline
    centre: Point
    state: Annotated[Literal["placed", "waiting", "loose"], Meta(description="loose: no edge of it fits another panel")]
    edges: list[SheetEdge]


class Assembled(Reply, kw_only=True):
    """A cutting sheet put together; what is drawn on the sheet has y up [mm]."""

    certainty: Literal["sure", "not sure"]
    headline: str
    doubts: list[str]
    notes: list[str]
    thickness: Mm
    burn: Mm
    panels: list[SheetPanel]
    joints: list[SheetJointEntry]
    unmatched: list[UnmatchedEntry]
    placed: Annotated[Names, Meta(description="in the order of the solids")]
    solids: Solids
    file: Annotated[str, Meta(description="text of the assembly file of what is placed; empty where nothing is")]
    toml: Annotated[str, Meta(description="text of a file of hints that says the same")]
    command: Command


class LayReply(Reply, tag="lay", kw_only=True):
    """Where a loose panel could lie, what seems best first."""

    panel: str
    ways: list[PlateHint]


class Failed(Reply, kw_only=True):
    """What is wrong, one plain line each; of a design with all that is, and what would help."""

    of: str
    findings: list[str]
    review: list[Finding] | UnsetType = UNSET


AnyReply = (
    Hello | Opened | ShapeReply | FlexReply | DragReply | ReachReply | Released | Modes | RankReply | CheckReply | LimitReply
    | PlanReply | StepReply | SweepReply | SpaceReply | StudyReply | ProveReply | BoundReply | Saved | ProgressReply | WorkerState
    | Assembled | LayReply | Failed
)  # fmt: skip
