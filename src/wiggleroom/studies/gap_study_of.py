"""What studies of gaps ask of an assembly of either dimension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from wiggleroom.search.answer import Answer

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.sensitivity.gap_study import GapStudy


def gap_study_of(about: Any, goals: Goal | Sequence[Goal] | None) -> GapStudy[Any]:
    """The study of an assembly, of a prepared one, or of an answer as it is.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    """
    assembly = getattr(about, "assembly", about)
    if assembly.dimension == 2:
        from wiggleroom.sensitivity.planar_study import study_of

        return study_of(about, goals)
    from wiggleroom.assembly.findings import asked_goals
    from wiggleroom.spatial.spatial_study import SpatialStudy

    if isinstance(about, Answer):
        return SpatialStudy(about.assembly, about.goals, about)
    return SpatialStudy(about, asked_goals(about.drawing, goals))


def unchecked_study_of(assembly: Assembly, goals: Goal | Sequence[Goal] | None) -> GapStudy[Any]:
    """The study of an assembly whose question may be wrong, and of which least motions will do."""
    from wiggleroom.assembly.statements import given_goals

    asked = given_goals(goals, assembly.goals)
    if assembly.dimension == 2:
        from wiggleroom.sensitivity.planar_study import PlanarStudy

        return PlanarStudy(assembly, asked)
    from wiggleroom.spatial.spatial_study import SpatialStudy

    return SpatialStudy(assembly, asked, least=True)
