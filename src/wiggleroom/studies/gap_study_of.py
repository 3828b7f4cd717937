"""What studies of gaps ask of an assembly of either dimension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from wiggleroom.search.answer import Answer

if TYPE_CHECKING:
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
    from wiggleroom.spatial.spatial_study import SpatialStudy, spatial_study_of

    if isinstance(about, Answer):
        return SpatialStudy(about.assembly, about.goals, about)
    return spatial_study_of(about, goals)
