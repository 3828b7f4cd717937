"""What `check --json` writes."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from wiggleroom.schema.fields import Command, Mm, Names, Notes, PartMotion, Remains, Seconds
from wiggleroom.verdict import Certainty, Separability


class EscapeEntry(Struct):
    """Parts that leave together."""

    parts: Names
    path: Annotated[
        list[dict[str, PartMotion]],
        Meta(description="waypoints from rest on, each with the parts that move on this path"),
    ]


class StateSearchEntry(Struct, kw_only=True):
    """How far the search for escape paths went."""

    states: Annotated[int, Meta(description="states to which slides, and turns of single parts, led")]
    turned: Annotated[int, Meta(description="of these states those in which every part was turned both ways")]
    whole: Annotated[bool, Meta(description="these are all such states of the parts that are left")]
    questions: Annotated[int, Meta(description="largest motions that were searched")]
    unanswered: Annotated[int, Meta(description="of these those that found no end whose path is certain")]


class SeparabilityEntry(Struct, kw_only=True):
    """Whether parts come apart at one gap."""

    verdict: Separability
    certainty: Certainty
    at_most: Annotated[
        float | None, Meta(description="a distance [mm] that no point of any part exceeds, proven; else null")
    ]
    escapes: Annotated[list[EscapeEntry], Meta(description="in the order in which they leave")]
    spins: Annotated[list[str], Meta(description="parts that turn in place without limit")]
    remains: Remains
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
