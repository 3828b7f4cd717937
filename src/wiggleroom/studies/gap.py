"""Which gap to draw: the question."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.studies.question import Option, Question
from wiggleroom.verdict import Certainty

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.search.progress import Progress
    from wiggleroom.sensitivity.gap_trials import AllowableGap


def allowable_gap(
    assembly: Assembly,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    at_most: float | None = None,
    holds: bool = False,
    fits: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> AllowableGap:
    """Largest gap for a motion limit or for interlocking parts, or smallest gap at which parts cut too large still fit.

    Parameters
    ----------
    assembly : Assembly
        The search begins at its own gap. Gaps of single joints and offsets of parts stay as they are.
    goals : Pull, Turn and others, or several that add up
        For `at_most`; by default the question of the assembly's file.
    at_most : float, optional [mm]
        Find the largest gap at which the largest motion is no more than this (turns in [rad]).
    holds : bool
        Find the largest gap at which the parts interlock.
    fits : float, optional [mm]
        Find the smallest gap at which the parts, as drawn and not shifted, do not overlap when every outline, in space
        every face, lies this much further out. The assembly may be read with `overlapping`.
    seconds : float, optional [s]
        Time limit; then the best result so far is returned.
    stop, progress : optional
        As for `flex`.

    Returns
    -------
    AllowableGap

    Raises
    ------
    InputError
        If not exactly one question is asked, a number makes no sense, or nothing is fixed or pulled.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.allowable_gap(wr.patterns.chain(2, joint="tee", gap=0.02), at_most=0.1)
    >>> found.gap < found.beyond < 1.011 * found.gap
    True
    """
    from wiggleroom.sensitivity.allowable_gap import check_question

    check_question(at_most, holds, fits)
    context = Context(stop=Deadline(seconds, stop), progress=progress)
    if fits is not None:
        return _fitting(assembly, fits, context)
    found = _largest(assembly, goals, at_most, context)
    if found.gap is None or found.stopped:
        return found
    try:
        return replace(found, fits_from=_fitting(assembly, 0.0, context).gap)
    except StoppedError:
        return found


def _fitting(assembly: Assembly, larger: float, context: Context) -> AllowableGap:
    """Smallest gap at which parts whose boundaries lie `larger` further out do not overlap as drawn, not shifted."""
    if assembly.dimension == 3:
        from wiggleroom.spatial.spatial_study import fitting as solids_fitting

        return solids_fitting(assembly, larger, context.stop)
    from wiggleroom.sensitivity.allowable_gap import fitting

    return fitting(assembly, larger)


def _largest(
    assembly: Assembly, goals: Goal | Sequence[Goal] | None, at_most: float | None, context: Context
) -> AllowableGap:
    """Largest gap at which a motion stays below a limit or, where none is given, the parts interlock."""
    from wiggleroom.questions import largest_gap
    from wiggleroom.sensitivity.allowable_gap import held_gap
    from wiggleroom.sensitivity.motion_border import MotionBorder
    from wiggleroom.studies.gap_study_of import gap_study_of

    if at_most is None:
        border = largest_gap(assembly, stop=context.stop, progress=context.progress)
        found = held_gap(assembly, border, context)
    else:
        found = MotionBorder(gap_study_of(assembly, goals), at_most, context).enclose()
    if assembly.dimension == 2 or not assembly.drawing.gaps or found.certainty is not Certainty.PROVEN:
        return found
    doubt = "not proven: solids with a gap of a single joint may grow by a sliver as the gap grows"
    why = f"{found.why}; {doubt}" if found.why else doubt
    return replace(found, certainty=Certainty.SEARCHED, proven_gap=None, why=why)


@dataclass(frozen=True, kw_only=True)
class GapQuestion(Question):
    """Find the gap to draw: the largest that limits a motion or holds the parts together, or the smallest that fits.

    Answers one of --at-most, --holds and --fits, with a checked state on either side: the answer and the nearest gap
    that fails lie no more than one per cent apart. An answer with a bound is proven, otherwise it is searched. Exit
    code: 0 answered; 3 no such gap, or the time ended first.

    Example: wiggleroom gap box.svg --fix box --pull lid:+x --at-most 0.5

    Example: wiggleroom gap puzzle.svg --holds --picture border.svg

    Example: wiggleroom gap puzzle.svg --fits 0.1 --kerf 0.15

    --fits treats the parts as drawn, not shifted; they may overlap there. The others also report the gap from which
    parts fit.

    Parameters
    ----------
    at_most
        The largest gap at which the motion is no more than this [mm, turns in rad].
    holds
        The largest gap at which the parts interlock.
    fits
        The smallest gap at which the parts, as drawn and not shifted, do not overlap when every outline, in space every
        face, lies this much further out [mm]; 0: as drawn.
    kerf
        Width of the cut [mm]; adds the offset to set at the cutter to the answer.
    """

    name: ClassVar[str] = "gap"
    heading: ClassVar[str] = "Which gap should be drawn?"
    button: ClassVar[str] = "Find the gap"
    needs_end: ClassVar[bool] = False

    at_most: Annotated[float | None, Option(title="moves at most", unit="mm")] = None
    holds: Annotated[bool, Option(title="or holds together")] = False
    fits: Annotated[float | None, Option(title="or fits, larger by", unit="mm", least=0)] = None
    kerf: Annotated[float | None, Option(title="kerf", unit="mm", least=0)] = None

    @property
    def asks_motion(self) -> bool:
        """True of the motion at most."""
        return self.at_most is not None

    @property
    def may_overlap(self) -> bool:
        """True of what fits."""
        return self.fits is not None

    def check(self, dimension: int) -> None:  # noqa: ARG002
        """Check the kerf."""
        if self.kerf is not None and not (math.isfinite(self.kerf) and self.kerf >= 0):
            wrong = f"--kerf {self.kerf:g}: it must be 0 or more"
            raise InputError(wrong)

    def ask(self, about: Any, context: Context) -> AllowableGap:
        """Enclose the gap."""
        assembly, goals = getattr(about, "assembly", about), about.goals or None
        found = allowable_gap(
            assembly, goals, at_most=self.at_most, holds=self.holds, fits=self.fits, stop=context.stop,
            progress=context.progress,
        )  # fmt: skip
        return replace(found, kerf=self.kerf)
