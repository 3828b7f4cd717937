"""What `parts` and `assemble` write with `--json`."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import Command, Findings, Mm, Names, Notes, Pair, Point


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
    size: Annotated[tuple[float, float], Meta(description="width and height of the box round all parts [mm]")]
    notes: Notes
    findings: Findings
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


class MisfitEntry(Struct, kw_only=True):
    """A panel that is too thick for slots of another one, or whose tabs are too wide for them, as cut."""

    kind: Annotated[Literal["thickness", "width"], Meta(description="of the panel, or of its tab along the slot")]
    panel: str
    slots_of: Annotated[str, Meta(description="the panel with the slots")]
    size: Annotated[float, Meta(description="of the panel or its tab [mm]")]
    room: Annotated[float, Meta(description="of the slot, as cut [mm]")]
    excess: Annotated[float, Meta(description="by how much it is too large [mm]")]
    places: Annotated[int, Meta(description="how many slots")]


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
    loose: Annotated[Names, Meta(description="those of them of which no edge fits one that is still open")]
    burn: Annotated[float, Meta(description="taken off every outline [mm]: as the cut does")]
    relief: Annotated[
        float,
        Meta(description="taken off besides [mm]: for a cut of unknown width, for rounding, and what --relieve allows"),
    ]
    misfits: Annotated[list[MisfitEntry], Meta(description="what fits only since --relieve allows it")]
    notes: Notes
    command: Command
