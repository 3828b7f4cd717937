"""What the page asks the server, checked to the letter."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

Number = Annotated[int, Meta(ge=0, le=2**32 - 1)]
Length = Annotated[float, Meta(ge=-1e9, le=1e9)]
Vector = Annotated[tuple[Length, ...], Meta(min_length=2, max_length=3)]
WHAT = Literal[
    "svg",
    "png",
    "gif",
    "mp4",
    "glb",
    "html",
    "json",
    "stills",
    "assembly",
    "cut-svg",
    "cut-dxf",
    "cut-lbrn2",
    "cut-lbrn",
]


class GoalEntry(Struct, forbid_unknown_fields=True, omit_defaults=True):
    """One term of what is asked, as in assembly files: two numbers in the plane, three in space.

    Parameters
    ----------
    turn
        A sense in the plane; in space the direction about which the part is twisted, right hand.
    """

    part: str
    direction: Vector | None = None
    point: Vector | None = None
    turn: Literal["ccw", "cw"] | Vector | None = None
    w: tuple[float, float, float] | None = None
    weight: float = 1.0


JointEntry = tuple[str, str, Annotated[float, Meta(ge=0, le=1e9)]]
Goals = list[GoalEntry] | Literal["translation", "closer", "weight"]


class Design(Struct, forbid_unknown_fields=True):
    """What the user has set; every request but `open` carries all of it.

    Parameters
    ----------
    gap : float, optional [mm]
        In place of the drawing's.
    extra : dict
        Extra gap [mm] round single parts: the outline of that part alone moves inward by half of it.
    gaps : list, optional
        Gaps [mm] of single joints, by their two parts, in place of the drawing's.
    fixed, glue, goals
        In place of the drawing's; goals are as in an assembly file's `pull`, or
        "translation" or "closer"; in space "weight": everything sinks in -z.
    """

    gap: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    extra: dict[str, Length] = {}
    gaps: list[JointEntry] | UnsetType = UNSET
    fixed: list[str] = []
    glue: list[list[str]] = []
    goals: Goals = []

    def __post_init__(self) -> None:
        """Leave out what says nothing: no extra gap, and glue of a part alone."""
        self.extra = {name: value for name, value in self.extra.items() if value}
        self.glue = [group for group in self.glue if len(group) > 1]


class Request(Struct, tag_field="kind", forbid_unknown_fields=True, kw_only=True):
    """Base of all requests; numbers grow."""

    id: Number


Unit = Literal["mm", "cm", "m", "in", "px", "pt", "90dpi"]
"""Of the numbers of a drawing; "90dpi" is the pixel of old programs."""


class HowRead(Struct, forbid_unknown_fields=True):
    """How a drawing is read, in place of what it says itself.

    Parameters
    ----------
    unit
        Of its numbers.
    only, skip
        Layers, colours or names that alone are read, or that are left out.
    join
        Open ends nearer than this are joined [mm].
    solid
        Names, or points as "@x,y", of outlines inside others that are parts, not holes; "all" for all of them.
    hole
        The same of outlines that are cut out of the parts around or under them.
    """

    unit: Unit | None = None
    only: Annotated[list[str], Meta(max_length=1000)] = []
    skip: Annotated[list[str], Meta(max_length=1000)] = []
    join: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    solid: Annotated[list[str], Meta(max_length=10_000)] = []
    hole: Annotated[list[str], Meta(max_length=10_000)] = []


Count = Annotated[int, Meta(ge=1, le=64)]


class Made(Struct, forbid_unknown_fields=True):
    """Blocks with joints, as `wiggleroom make` draws them: so many in a row, and rows; a chain has one.

    Parameters
    ----------
    pitch
        Side of a block [mm].
    sizes
        Of the joint, as fractions of the pitch; those left out are as commands have them.
    """

    pattern: Literal["chain", "frame", "grid", "jigsaw"]
    nx: Count
    ny: Count = 1
    joint: Annotated[str, Meta(max_length=32)] = "tee"
    pitch: Annotated[float, Meta(gt=0, le=1e6)] = 20.0
    sizes: Annotated[dict[str, float], Meta(max_length=16)] = {}


class OpenRequest(Request, tag="open", kw_only=True):
    """Read a drawing, or one of the samples, or make one.

    With a design, that one stands in place of what the drawing asks. `path` is what commands call it. `beside` holds files that the
    drawing names; only the command line gives them. `gaps` of joints and pairs to `ignore` stand in place of the drawing's. `again` reads
    the drawing that is open once more, in another way; `served` goes back to the one that the command was given.
    """

    name: Annotated[str, Meta(max_length=255)]
    path: Annotated[str, Meta(max_length=4096)] = ""
    data: bytes = b""
    beside: dict[str, bytes] = {}
    sample: bool = False
    make: Made | None = None
    unit: Unit | None = None
    again: bool = False
    served: bool = False
    flatten: Annotated[float, Meta(gt=0, le=1e9)] | None = None
    gap: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    only: tuple[str, ...] = ()
    skip: tuple[str, ...] = ()
    join: Annotated[float, Meta(ge=0, le=1e9)] | None = None
    solid: tuple[str, ...] = ()
    hole: tuple[str, ...] = ()
    gaps: list[JointEntry] | None = None
    ignore: list[tuple[str, str]] | None = None
    design: Design | None = None


class DesignRequest(Request, kw_only=True):
    """Base of requests about the drawing that is open."""

    design: Design


class ShapeRequest(DesignRequest, tag="shape", kw_only=True):
    """Outlines with the gap applied."""


class FlexRequest(DesignRequest, tag="flex", kw_only=True):
    """How far it moves: a quick answer first, then the full one; thorough: the full one alone.

    `shown` names the outlines that the page shows, as the reply with them did.
    """

    thorough: bool = False
    shown: str = ""


Motion = Annotated[tuple[float, ...], Meta(min_length=3, max_length=7)]
PartMotions = Annotated[
    dict[str, Motion],
    Meta(
        description="parts that do not rest: (dx mm, dy mm, turn rad), in space (dx, dy, dz mm, quaternion x, y, z, w)"
    ),
]


class PoseRequest(DesignRequest, tag="pose", kw_only=True):
    """Whether parts overlap where they were left, and that the next drag may begin there."""

    pose: PartMotions = {}


class DragRequest(DesignRequest, tag="drag", kw_only=True, rename={"from_": "from"}):
    """A part drawn towards a place, from rest, from a pose, from where the last drag ended or from the end of the answer.

    `grip` is where it was taken, in world coordinates at rest [mm]; `shown` names the outlines that the page shows. `pose` is where parts
    were left, at which the drag began; `pinned` are parts that stand while this one is dragged, although they are not fixed.
    """

    part: str
    grip: Vector
    target: Vector
    from_: Literal["rest", "here", "answer", "pose"] = "here"
    pose: PartMotions = {}
    pinned: list[str] = []
    shown: str = ""


class ReachRequest(DesignRequest, tag="reach", kw_only=True):
    """Where a point of a part, given in world coordinates at rest [mm], can be brought from rest."""

    part: str
    grip: tuple[Length, Length]


class WiggleRequest(DesignRequest, tag="wiggle", kw_only=True):
    """The freedoms that are left, of all parts or of one."""

    part: str | None = None


class RankRequest(DesignRequest, tag="rank", kw_only=True):
    """Whose gap matters most."""


class CheckRequest(DesignRequest, tag="check", kw_only=True):
    """Whether it comes apart."""


class LimitRequest(DesignRequest, tag="limit", kw_only=True):
    """The largest gap that holds everything together."""


class PlanRequest(DesignRequest, tag="plan", kw_only=True):
    """How it is taken apart: which parts are to leave, all by default, and the direction in which loose parts fall."""

    targets: Annotated[list[str], Meta(max_length=10_000)] = []
    gravity: Annotated[tuple[Length, ...], Meta(min_length=2, max_length=3)] | None = None


class SweepRequest(DesignRequest, tag="sweep", kw_only=True):
    """Motion against gap."""

    gaps: Annotated[list[Annotated[float, Meta(ge=0, le=1e9)]], Meta(max_length=200)] | None = None


class SpaceRequest(DesignRequest, tag="space", kw_only=True):
    """The free space of one pair."""

    a: str
    b: str


OptionValue = str | int | float | bool | None


class StudyRequest(DesignRequest, tag="study", kw_only=True):
    """A question that is declared once for commands and page: its name, and its options; those left out are as commands have them."""

    of: Annotated[str, Meta(max_length=32)]
    options: Annotated[dict[str, OptionValue], Meta(max_length=32)] = {}


class ProveRequest(DesignRequest, tag="prove", kw_only=True):
    """A value that no motion exceeds."""

    share: Annotated[float, Meta(gt=0, lt=10)] = 0.01
    seconds: Annotated[float, Meta(gt=0, le=3600)] = 60.0


class BoundRequest(DesignRequest, tag="bound", kw_only=True):
    """What a search finds beyond the full answer, and a quick bound of that, worked out while nothing else is asked."""


class SaveRequest(DesignRequest, tag="save", kw_only=True):
    """What is on screen, as a file."""

    what: WHAT
    of: Literal["flex", "check", "plan"] = "flex"
    kerf: Annotated[float, Meta(ge=0, le=1e6, description="width of the cut [mm]; of outlines to cut")] = 0.0


Triple = tuple[Length, Length, Length]
EdgeText = Annotated[
    str,
    Meta(max_length=300, description='an edge: "lid:top", or "lid@12.5,40" for what is next to a point of the sheet'),
]
PanelName = Annotated[str, Meta(max_length=255)]


class PlateHint(Struct, forbid_unknown_fields=True):
    """Where a panel stands in the frame of another, as in a file of hints."""

    panel: PanelName
    frame: PanelName
    centre: Triple
    right: Triple
    up: Triple


class SheetHints(Struct, forbid_unknown_fields=True):
    """What is known of a cutting sheet, as in a file of hints."""

    join: Annotated[list[tuple[EdgeText, EdgeText]], Meta(max_length=1000)] = []
    flush: Annotated[list[tuple[EdgeText, EdgeText]], Meta(max_length=1000)] = []
    groups: Annotated[list[list[PanelName]], Meta(max_length=1000)] = []
    plate: Annotated[list[PlateHint], Meta(max_length=1000)] = []
    skip: Annotated[list[PanelName], Meta(max_length=1000)] = []


class SheetRequest(Request, kw_only=True):
    """Base of requests about the cutting sheet that is open: thickness of the material and burn [mm]; without burn what the sheet says."""

    thickness: Annotated[float, Meta(gt=0, le=1e6)]
    burn: Annotated[float, Meta(ge=0, le=1e6)] | None = None
    hints: SheetHints = msgspec.field(default_factory=SheetHints)


class AssembleRequest(SheetRequest, tag="assemble", kw_only=True):
    """The panels of the sheet put together in space."""


class LayRequest(SheetRequest, tag="lay", kw_only=True):
    """Where a loose panel could lie that is to touch another one: both by a point of the sheet [mm]."""

    panel: PanelName
    at: tuple[Length, Length]
    onto: PanelName
    there: tuple[Length, Length]


class CancelRequest(Request, tag="cancel", kw_only=True):
    """Forget a request of this kind, waiting or running."""

    of: str


AnyRequest = (
    OpenRequest | ShapeRequest | FlexRequest | DragRequest | PoseRequest | ReachRequest | WiggleRequest | RankRequest
    | CheckRequest | LimitRequest | PlanRequest | SweepRequest | SpaceRequest | StudyRequest | ProveRequest | BoundRequest
    | SaveRequest | AssembleRequest | LayRequest | CancelRequest
)  # fmt: skip
