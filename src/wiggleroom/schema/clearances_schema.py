"""What `clearances` writes with `--json`."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import Command, InSpace, Notes, Pair, Place


class ClearanceEntry(Struct, kw_only=True):
    """The least gap of two parts."""

    parts: Pair
    gap: Annotated[float, Meta(description="least distance [mm]; negative: how deep they are in each other")]
    direction: Annotated[Place, Meta(description="unit vector from the first part to the second there")]
    at: Annotated[Place, Meta(description="middle of the gap or of the overlap there [mm]")]
    xy: Annotated[
        float | UnsetType | None,
        Meta(description="least distance of points at one height [mm]; null where it is more than was asked for"),
    ] = UNSET
    z: Annotated[
        float | UnsetType | None,
        Meta(description="least distance of points above each other [mm]; null where it is more than was asked for"),
    ] = UNSET
    too_near: Annotated[
        bool | UnsetType, Meta(description="nearer than was asked for along or across the layers, or touching")
    ] = UNSET


class ClearancesResult(Struct, tag_field="format", tag="wiggleroom.clearances/1", kw_only=True):
    """The least gaps of near parts: `wiggleroom clearances --json`."""

    dimension: InSpace | UnsetType = UNSET
    gap: Annotated[float, Meta(description="that was applied to the parts before they were measured [mm]")]
    within: Annotated[float, Meta(description="pairs further apart are left out [mm]")]
    pairs: Annotated[list[ClearanceEntry], Meta(description="the tightest first")]
    offset: Annotated[
        float | None,
        Meta(
            description="how far all outlines may at most be moved outward, where negative inward, so that no two parts overlap as drawn "
            "[mm]; null where no offset is found"
        ),
    ]
    kerf: Annotated[
        float | None,
        Meta(
            description="width of a cut along the lines that makes all fit, -2 offset [mm]; null where none is needed"
        ),
    ]
    binding: Annotated[list[Pair], Meta(description="pairs that allow no larger offset")]
    note: Annotated[str, Meta(description="why there is no offset")]
    xy: Annotated[float | UnsetType, Meta(description="least distance along the layers that was asked for [mm]")] = (
        UNSET
    )
    z: Annotated[float | UnsetType, Meta(description="least distance across the layers that was asked for [mm]")] = (
        UNSET
    )
    fused: Annotated[
        list[list[str]] | UnsetType,
        Meta(description="in space: names of parts that touch or overlap, directly or through others"),
    ] = UNSET
    notes: Notes = msgspec.field(default_factory=list)
    command: Command
