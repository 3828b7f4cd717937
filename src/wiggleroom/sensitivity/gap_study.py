"""An assembly whose gaps vary: what studies ask of it, so that the same study answers in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.drawing.model import Drawing
from wiggleroom.errors import Stop
from wiggleroom.parallel.parallel_run import Work
from wiggleroom.sensitivity.dual_face import DualFace
from wiggleroom.sensitivity.found_motion import Found, MadeAssembly, endless

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DIFFERENCE_STEP = 1e-3
"""Extra gap of difference quotients, as a share of the typical clearance."""


@dataclass(frozen=True, eq=False)
class PlaceDerivatives:
    """Derivatives by gaps at one motion, as linear functions of the forces that hold it.

    Parameters
    ----------
    part : (n, k) sparse
        Objective gained for each mm of extra gap round a part, by the force of each of k rows.
    joint : (m, k) sparse
        The same for the gap of each joint.
    face : DualFace
        Forces (k,), and how far they are unique.
    """

    part: sp.csr_matrix
    joint: sp.csr_matrix
    face: DualFace


@dataclass(frozen=True, eq=False)
class GapDerivatives:
    """Derivatives of a largest motion by gaps.

    Parameters
    ----------
    here : PlaceDerivatives
        At the motion that was found.
    joints : (m, 2) int64
        Pairs of parts.
    virtual : float
        Share of the force that is held where nothing touches.
    elsewhere : tuple of PlaceDerivatives
        At other motions that are as large; none where there are none, or none are looked for.
    """

    here: PlaceDerivatives
    joints: Ints
    virtual: float
    elsewhere: tuple[PlaceDerivatives, ...] = ()


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


class GapStudy(Protocol[Found]):
    """An assembly with its goals, of which studies ask largest motions with other gaps."""

    @property
    def assembly(self) -> MadeAssembly:
        """The assembly as it is."""

    @property
    def goals(self) -> tuple[Any, ...]:
        """What is asked."""

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""

    def at_gap(self, gap: float, stop: Stop | None = None) -> Self:
        """The same question with another gap [mm]; InputError where parts cannot be made, OverlapError where they overlap.

        StoppedError where it was asked to stop before they were made.
        """

    def made_of(self, drawing: Drawing, stop: Stop | None = None) -> Self:
        """The same question of another drawing of the same parts; errors as for `at_gap`."""

    def with_inward(self, inward: Floats, stop: Stop | None = None) -> Self:
        """The same question with the boundary of each part moved inward by `inward` (n,) [mm]; errors as for `at_gap`."""

    def answer(self, context: Context) -> Found:
        """Largest motion as a direct question finds it, without a bound."""

    def flexed(self, search: int | None, context: Context) -> Found:
        """Answer of `wiggleroom.flex`, its quick bound included, from rest and `search` more starts (None: as many as usual)."""

    def with_bound(self, answer: Found, within: float, context: Context) -> Found:
        """The answer with a value that no motion exceeds, `within` a share of it where that can be; itself where there is none."""

    def with_assembly(self, answer: Found) -> Found:
        """The motion of an answer at a smaller gap, as an answer for this one."""

    def in_place_of(self, lower: Found, smaller: Found) -> Found:
        """The motion of a smaller gap in place of a lower answer of this one; what was proven of larger parts is not of these."""

    def with_room(self, answer: Found, limit: float, context: Context) -> Found:
        """The answer with its path, up to where it is worth more than `limit`, as far from other parts as it can be moved."""

    def followed(self, looser: Found, limit: float) -> Found | None:
        """The path of smaller parts, up to where it is worth more than `limit`, as an answer for these; None where parts meet."""

    def can_be_ranked(self, answer: Found) -> bool:
        """True where the motion ends, with forces that say what each contact is worth."""

    def derivatives(self, answer: Found) -> GapDerivatives:
        """Derivatives by the gap of every part and joint."""

    def quotients(self, answer: Found, context: Context) -> DifferenceQuotients:
        """How derivatives are found by solving again."""

    def moved(self, answer: Found, inward: Floats, context: Context) -> Found:
        """Largest motion when the boundary of each part moves inward by `inward` (n,) [mm]; negative moves it out."""

    def draws(self, answer: Found, context: Context) -> tuple[Work, Any]:
        """What many such motions need: `work(shared, inward)` is a `PerturbedObjective`."""

    def room(self, whole: float, aim: float) -> Floats:
        """How far the boundary of each part (n,) may move out [mm] until `aim` of the gap `whole` is left."""


def check_end(study: GapStudy[Found], answer: Found) -> None:
    """Check that a motion can be held against gaps.

    Raises
    ------
    InputError
        If the motion has no end, or the search was cut short.
    """
    if not study.can_be_ranked(answer):
        raise endless(answer)
