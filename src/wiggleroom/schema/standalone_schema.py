"""What a page in one file carries: the drawing, and what was found about it."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import Ring
from wiggleroom.schema.replies import FlexReply
from wiggleroom.schema.reply_base import Pose
from wiggleroom.schema.requests import Design
from wiggleroom.schema.study_replies import CheckReply, RankReply, SpaceReply, StepReply, StudyTab, Tints, Title


class PackedFrames(Struct):
    """Motions of all parts along a path: k frames of n parts."""

    k: int
    n: int
    data: Annotated[str, Meta(description="base64 of float32 dx [mm], dy [mm], turn [rad]")]


class SharedOutlines(Struct):
    """Outlines about the parts' reference points, each shape once."""

    shapes: list[list[Ring]]
    of: Annotated[list[int], Meta(description="number of the shape of each part")]


class PlacedPart(Struct):
    """A part without its outline."""

    name: str
    at: Pose


class StandaloneDrawing(Struct, kw_only=True):
    """The drawing as it is shown at rest, and what is asked of it."""

    kind: Literal["opened"] = "opened"
    id: int = 0
    name: str
    gap: float
    unit: str
    notes: list[str]
    size: tuple[float, float, float, float]
    parts: list[PlacedPart]
    design: Design
    outlines: SharedOutlines


class StandaloneAnswer(Struct):
    """The answer at one gap."""

    gap: float
    flex: FlexReply
    path: PackedFrames
    outlines: Annotated[SharedOutlines | UnsetType, Meta(description="where they are not those of the drawing")] = UNSET


class StandaloneCheck(Struct):
    """Whether it comes apart, with a path for each escape."""

    reply: CheckReply
    paths: list[PackedFrames]


class StandalonePage(Struct, kw_only=True, omit_defaults=True):
    """Everything in the file; all but the drawing may be missing."""

    opened: StandaloneDrawing
    begin: Annotated[float | UnsetType, Meta(description="the gap that is shown first [mm]")] = UNSET
    tab: Literal["answer", "gaps", "apart", "space", "study", "sure"] | UnsetType = UNSET
    answers: Annotated[list[StandaloneAnswer] | UnsetType, Meta(description="one for each gap of the slider")] = UNSET
    steps: list[StepReply] | UnsetType = UNSET
    lost: tuple[float, float] | UnsetType | None = UNSET
    rank: RankReply | UnsetType = UNSET
    check: StandaloneCheck | UnsetType = UNSET
    space: SpaceReply | UnsetType = UNSET
    study: StudyTab | UnsetType = UNSET
    tints: Tints | UnsetType = UNSET
    said: Title | UnsetType = UNSET
