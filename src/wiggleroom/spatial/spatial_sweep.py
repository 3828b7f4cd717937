"""Motion against gap, in space: the steps of `wiggleroom.sensitivity.sweep`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from wiggleroom.assembly.statements import given_goals
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import Stop
from wiggleroom.sensitivity.sweep import Sweep, SweepStep, sweep_over
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_flex import spatial_question_findings
from wiggleroom.spatial.spatial_study import SpatialStudy


def sweep_spatial(
    assembly: SpatialAssembly,
    gaps: Sequence[float] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, Any], None] | None = None,
) -> Sweep:
    """Largest motion for several gaps; see `wiggleroom.sweep`."""
    asked = given_goals(goals, assembly.goals)
    wrong = spatial_question_findings(assembly, asked)
    return sweep_over(SpatialStudy(assembly, asked), gaps, wrong, stop=stop, progress=progress, each=each)
