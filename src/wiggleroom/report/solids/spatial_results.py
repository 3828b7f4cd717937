"""Answers in space as JSON: the formats of the plane with `"dimension": 3` and motions of six numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import UNSET, structs
from numpy.typing import NDArray

from wiggleroom.report.results.answer_words import MIN_MOTION
from wiggleroom.schema.fields import ContactEntry
from wiggleroom.schema.flex_schema import SearchEntry
from wiggleroom.schema.spatial_result_schema import (
    SpatialCheckResult,
    SpatialEscapeEntry,
    SpatialFlexResult,
    SpatialLargestGapEntry,
    SpatialMotion,
    SpatialSeparabilityEntry,
)
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.spatial.spatial_answer import SpatialAnswer
    from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly, SpatialEscape


def spatial_flex_result(answer: SpatialAnswer) -> SpatialFlexResult:
    """Everything `flex --json` says; lengths in mm, angles in degrees."""
    free = answer.verdict is Verdict.UNBOUNDED
    return SpatialFlexResult(
        verdict=answer.verdict,
        objective=None if free or answer.objective is None else float(answer.objective),
        at_most=answer.at_most,
        search=UNSET if answer.search is None else SearchEntry(**vars(answer.search)),
        leaves=list(answer.leaves) if free else UNSET,
        turns=list(answer.turns) if free else UNSET,
        parts={n: _motion(m) for n, m in zip(answer.assembly.names, answer.motion, strict=True)},
        collision_free=bool(answer.collision_free),
        deepest_overlap=float(answer.deepest_overlap),
        path=answer.path,
        contacts=[ContactEntry(c.parts, c.point, c.normal, c.force) for c in answer.contacts],
        model=answer.model,
        solver=answer.solver,
        rounds=answer.rounds,
        seconds={stage: round(float(spent), 4) for stage, spent in answer.seconds.items()},
        notes=list(answer.assembly.drawing.notes),
        command=answer.command,
    )


def spatial_check_result(
    found: SpatialDisassembly, border: LargestGap | None = None, command: str = ""
) -> SpatialCheckResult:
    """Everything `check --json` says; lengths in mm, angles in degrees."""
    said = _separability(found)
    return SpatialCheckResult(
        **structs.asdict(said),
        gap=found.assembly.gap,
        largest_gap=UNSET if border is None else _largest_gap(border),
        seconds=round(found.seconds, 4),
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def _largest_gap(border: LargestGap) -> SpatialLargestGapEntry:
    return SpatialLargestGapEntry(
        interlocked_at=border.holds,
        comes_apart_at=border.parts_at,
        interlocked=None if border.interlocked is None else _separability(border.interlocked),
        comes_apart=None if border.apart is None else _separability(border.apart),
    )


def _separability(found: SpatialDisassembly) -> SpatialSeparabilityEntry:
    names = found.assembly.names
    return SpatialSeparabilityEntry(
        verdict=found.verdict,
        certainty=found.certainty,
        escapes=[SpatialEscapeEntry(list(e.parts), _waypoints(names, e)) for e in found.escapes],
        spins=[],
        remains=list(found.remains),
    )


def _waypoints(names: tuple[str, ...], escape: SpatialEscape) -> list[dict[str, SpatialMotion]]:
    """Waypoints; each says only the parts that are not at rest anywhere on the path."""
    moved = np.flatnonzero((np.abs(escape.path) > MIN_MOTION).any(axis=(0, 2)))
    return [{names[k]: _motion(m[k]) for k in moved} for m in escape.path]


def _motion(motion: NDArray[np.float64]) -> SpatialMotion:
    """Motion (6,) [mm, rad] of a part: displacement of its reference point, and rotation vector."""
    (x, y, z), (u, v, w) = motion[:3].tolist(), np.degrees(motion[3:]).tolist()
    return SpatialMotion((x, y, z), (u, v, w))
