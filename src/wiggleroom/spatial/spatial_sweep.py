"""Motion against gap, in space: the steps of `wiggleroom.sensitivity.sweep`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from wiggleroom.errors import InputError, Stop, TouchingError
from wiggleroom.sensitivity.sweep import Sweep, SweepStep, sweep_over
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_assembly import assemble_spatial, goal_findings
from wiggleroom.spatial.spatial_flex import flex_spatial, lacking
from wiggleroom.spatial.spatial_model import SpatialAssembly, SpatialGoal
from wiggleroom.spatial.spatial_prepare import prepare_spatial
from wiggleroom.verdict import Verdict


def sweep_spatial(
    assembly: SpatialAssembly,
    gaps: Sequence[float] | None = None,
    goals: Sequence[SpatialGoal] | None = None,
    *,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, Any], None] | None = None,
) -> Sweep:
    """Largest motion for several gaps; see `wiggleroom.sweep`."""
    asked = assembly.goals if goals is None else tuple(goals)
    wrong = goal_findings(assembly.drawing, asked) + lacking(assembly, asked)
    return sweep_over(_SpatialGapSteps(assembly, asked), gaps, wrong, stop=stop, progress=progress, each=each)


@dataclass(frozen=True, eq=False)
class _SpatialSweepState:
    """The answer at a gap whose motion ends."""

    gap: float
    answer: SpatialAnswer


@dataclass(frozen=True, eq=False)
class _SpatialGapSteps:
    """Gaps of an assembly in space."""

    assembly: SpatialAssembly
    goals: tuple[SpatialGoal, ...]

    def step(
        self, gap: float, last: _SpatialSweepState | None, stop: Stop | None
    ) -> tuple[SweepStep, _SpatialSweepState | None]:
        """One gap from rest; the motion of a smaller gap counts where it is larger, for smaller parts take the same path."""
        try:
            made = assemble_spatial(self.assembly.drawing, gap=gap)
        except InputError:
            return SweepStep(gap, None, Verdict.NOT_MAKEABLE, False), last
        try:
            answer = flex_spatial(prepare_spatial(made), self.goals, stop=stop)
        except TouchingError:
            return SweepStep(gap, None, Verdict.TOUCHING, False), None
        if last is not None and answer.objective is not None and answer.objective < (last.answer.objective or 0.0):
            answer = replace(last.answer, assembly=made)
        checked = answer.path == "checked" and answer.collision_free
        step = SweepStep(gap, answer.objective, answer.verdict, checked, answer)
        good = answer.verdict.ends and checked
        return step, _SpatialSweepState(gap, answer) if good else last

    def looser(self, step: SweepStep, gap: float) -> SweepStep:
        """The step of a gap at which parts leave by the path of a smaller gap."""
        return replace(step, gap=gap, answer=None)
