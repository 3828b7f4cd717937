"""Answers in space as JSON: the formats of the plane with `"dimension": 3` and motions of six numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import UNSET

from wiggleroom.report.results.json_results import part_motion
from wiggleroom.schema.fields import ContactEntry
from wiggleroom.schema.flex_schema import SearchEntry
from wiggleroom.schema.spatial_result_schema import SpatialFlexResult
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.spatial.spatial_answer import SpatialAnswer


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
        parts={n: part_motion(m) for n, m in zip(answer.assembly.names, answer.motion, strict=True)},
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
