"""What studies of gaps ask of an assembly, so that the same study answers in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.errors import InputError, Stop
from wiggleroom.sensitivity.dual_face import DualFace
from wiggleroom.sensitivity.parallel import Work

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GapDerivatives:
    """Derivatives of a largest motion by gaps, as linear functions of the forces that hold it.

    Parameters
    ----------
    part : (n, k) sparse
        Objective gained for each mm of extra gap round a part, by the force of each of k rows.
    joints : (m, 2) int64
        Pairs of parts.
    joint : (m, k) sparse
        The same for the gap of each joint.
    face : DualFace
        Forces (k,), and how far they are unique.
    virtual : float
        Share of the force that is held where nothing touches.
    part_elsewhere, joint_elsewhere : (n, e), (m, e) float64
        Derivatives at other motions that are as large; none where there are none, or none are looked for.
    """

    part: sp.csr_matrix
    joints: Ints
    joint: sp.csr_matrix
    face: DualFace
    virtual: float
    part_elsewhere: Floats
    joint_elsewhere: Floats


@dataclass(frozen=True, eq=False)
class DifferenceQuotients:
    """How derivatives are found by solving again.

    Parameters
    ----------
    work, shared
        `work(shared, (part, sign))` is the objective gained per mm of extra gap round one part; nan where it is not known.
    derivatives : GapDerivatives
        At the solution from which differences are taken.
    """

    work: Work
    shared: Any
    derivatives: GapDerivatives


@runtime_checkable
class StudyModel(Protocol):
    """An assembly with its goals, of which studies ask largest motions with other gaps."""

    @property
    def assembly(self) -> Any:
        """The assembly as it is."""

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""

    def answer(self, stop: Stop | None) -> Any:
        """Largest motion from rest, without a bound."""

    def can_be_ranked(self, answer: Any) -> bool:
        """True where the motion ends, with forces that say what each contact is worth."""

    def derivatives(self, answer: Any) -> GapDerivatives:
        """Derivatives by the gap of every part and joint."""

    def quotients(self, answer: Any) -> DifferenceQuotients:
        """How derivatives are found by solving again."""

    def moved(self, answer: Any, inward: Floats, stop: Stop | None) -> Any:
        """Largest motion when the boundary of each part moves inward by `inward` (n,) [mm]; negative moves it out."""

    def confirmed(self, answer: Any, after: Any, inward: Floats, stop: Stop | None) -> Any:
        """What a direct question finds where `moved` found `after`; the same where that does no more."""

    def draws(self, answer: Any, stop: Stop | None) -> tuple[Work, Any]:
        """What many such motions need: `work(shared, inward)` is a `PerturbedObjective`."""

    def draws_afresh(self, answer: Any) -> tuple[Work, Any] | None:
        """The same with nothing used again; None where `draws` uses nothing again either."""

    def room(self, whole: float, aim: float) -> Floats:
        """How far the boundary of each part (n,) may move out [mm] until `aim` of the gap `whole` is left."""


def check_end(model: StudyModel, answer: Any) -> None:
    """Check that a motion can be held against gaps.

    Raises
    ------
    InputError
        If the motion has no end, or the search was cut short.
    """
    if not model.can_be_ranked(answer):
        why = "nothing stops the motion" if answer.objective is None else "the search for its motion was cut short"
        finding = f"{answer.assembly.drawing.source or 'the assembly'}: {why}, so no gap can be held against it"
        raise InputError(finding)
