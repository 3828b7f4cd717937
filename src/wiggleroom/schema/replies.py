"""What the server, or a page that carries what was found, tells the page."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType, field

from wiggleroom.schema.fields import (
    AtMost,
    Command,
    ContactEntry,
    Mm,
    Names,
    Objective,
    Place,
    Point,
)
from wiggleroom.schema.listing_schema import SheetJointEntry, UnmatchedEntry
from wiggleroom.schema.reply_base import Outline, Pose, Reply, Terms
from wiggleroom.schema.requests import Design, GoalEntry, HowRead, Made, PlateHint
from wiggleroom.schema.study_replies import (
    BoundReply,
    CheckReply,
    LimitReply,
    PlanReply,
    ProveReply,
    RankReply,
    SpaceReply,
    StepReply,
    StudyForm,
    StudyReply,
    SweepReply,
)
from wiggleroom.verdict import PathState, SearchState, Verdict


class UploadLimits(Struct):
    """What the server takes."""

    upload_mb: float


class SampleEntry(Struct):
    """A drawing to begin with."""

    name: str
    words: str
    count: Annotated[int, Meta(description="how many parts it has")]
    picture: Annotated[list[Outline], Meta(description="a small picture of its kind, 100 wide or high")]
    pulled: Annotated[bool, Meta(description="whether its first part stands and its last one is pulled")]


class JointSize(Struct):
    """One size of a joint family, as a fraction of the side of a block; or a count."""

    name: str
    default: float
    whole: bool


class Hello(Reply, kw_only=True):
    """First words to a page."""

    version: str
    can: Annotated[list[str], Meta(description="extras that are installed")]
    limits: UploadLimits
    samples: list[SampleEntry] = field(default_factory=list)
    studies: Annotated[list[StudyForm], Meta(description="questions that have a panel")] = field(default_factory=list)
    joints: Annotated[dict[str, list[JointSize]], Meta(description="families of joints that can be made")] = field(
        default_factory=dict
    )


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
    ignore: Annotated[list[tuple[str, str]], Meta(description="pairs of parts that never collide")] = field(
        default_factory=list
    )
    design: Design
    dimension: Literal[2, 3] = 2
    solids: Annotated[Solids | UnsetType, Meta(description="in space, where parts have no rings")] = UNSET
    pulled: Annotated[GoalEntry | UnsetType, Meta(description="a goal suggested where there is none")] = UNSET
    reading: Annotated[HowRead | UnsetType, Meta(description="of a drawing that can be read in other ways")] = UNSET
    made: Annotated[Made | UnsetType, Meta(description="how it was made, where it was made here")] = UNSET
    apart: Annotated[bool, Meta(description="true where no part is near another one, as on a cutting sheet")] = False


class ShapeReply(Reply, tag="shape", kw_only=True):
    """Outlines, or solids, with the gap applied."""

    rings: list[Outline] = field(default_factory=list)
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
    path: PathState
    seconds: float
    command: Command
    settled: Annotated[bool, Meta(description="false where a fuller answer is to come")] = True
    search: Annotated[
        SearchState,
        Meta(description="whether a search from other starts has ended; from rest: too many parts move for one"),
    ] = SearchState.DONE
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


class PoseReply(Reply, tag="pose", kw_only=True):
    """Whether parts may be left where they are."""

    free: Annotated[bool, Meta(description="true where no two parts overlap there")]
    words: str


class ReachReply(Reply, tag="reach", kw_only=True):
    """Where a point can be brought."""

    part: str
    grip: Point
    rings: Outline
    exact: Annotated[bool, Meta(description="true: from the free space; false where its corners alone were reached")]
    open: Annotated[bool, Meta(description="true where the part leaves: the region is cut off")]
    words: str


class ModeEntry(Struct):
    """One freedom that is left."""

    size: Mm
    parts: Names
    ends: bool


class Modes(Reply, kw_only=True):
    """The freedoms that are left, after a path for each."""

    modes: list[ModeEntry]


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


class Mend(Struct):
    """A change of the design that may put something right: what stands in place of what it had."""

    words: str
    gap: Mm | UnsetType = UNSET
    fixed: Names | UnsetType = UNSET
    glue: list[Names] | UnsetType = UNSET
    goals: list[GoalEntry] | UnsetType = UNSET


class Fault(Struct):
    """Something that is wrong with a design, where it is, and what would help."""

    about: Literal["stands", "pulled", "gap", "parts"]
    words: str
    parts: Names = []
    point: Annotated[Point | None, Meta(description="where in the picture [mm]")] = None
    mends: list[Mend] = []
    missing: Annotated[bool, Meta(description="true where nothing is wrong, but something is not set yet")] = False


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
    state: Annotated[
        Literal["placed", "waiting", "loose"], Meta(description="loose: no edge of it fits one that is still open")
    ]
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
    poses: list[PlateHint]


class Failed(Reply, kw_only=True):
    """What is wrong, one plain line each; of a design with all that is, and what would help."""

    of: str
    findings: list[str]
    review: list[Fault] | UnsetType = UNSET


AnyReply = (
    Hello | Opened | ShapeReply | FlexReply | DragReply | PoseReply | ReachReply | Modes | RankReply | CheckReply | LimitReply
    | PlanReply | StepReply | SweepReply | SpaceReply | StudyReply | ProveReply | BoundReply | Saved | ProgressReply | WorkerState
    | Assembled | LayReply | Failed
)  # fmt: skip
