"""What was tried while a gap was sought, and the gap that answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from wiggleroom.displayable import Drawable
from wiggleroom.verdict import Certainty

Question = Literal["at most", "holds", "fits"]

CLIMBED = "climbed"
"""Verdict of a gap that was not searched as `flex` does: the motion is that of a single climb from rest, and may be low."""


@dataclass(frozen=True, eq=False)
class Trial:
    """What was found at one gap.

    Parameters
    ----------
    gap : float [mm]
    value : float or None
        Largest motion found [mm] (turns in [rad]), infinite where nothing stops it; for `fits` the deepest overlap as drawn [mm].
        None where the parts cannot be made or touch.
    verdict : str
        That of the answer; "climbed", "touching", "cannot be made", "fits" or "overlaps".
    checked : bool
        True where the value is that of a state that was checked by exact geometry, its path from rest too.
    at_most : float or None
        A value that no motion at this gap can exceed, where one was worked out.
    answer : Answer or None
        The motion; where a smaller gap has shown more, that one, which is free here too.
    ended : bool
        True where a search or a climb at this gap came to its end.
    """

    gap: float
    value: float | None
    verdict: str
    checked: bool
    at_most: float | None = None
    answer: Any = field(default=None, repr=False)
    ended: bool = False


@dataclass(frozen=True, eq=False)
class AllowableGap(Drawable):
    """Gap that answers a maker's question.

    Parameters
    ----------
    question : str
        "at most": the largest gap at which the motion stays below the limit; "holds": the largest at which the parts interlock; "fits":
        the smallest at which they do not overlap as drawn, not shifted, when every outline is larger by the limit.
    limit : float or None
        [mm] (turns in [rad]).
    assembly : Assembly
        As it was asked about.
    goals : tuple of Goal
        For "at most".
    gap : float or None [mm]
        The answer; None where there is none, see `why`.
    certainty : Certainty or None
        Proven, or searched: no larger motion, or no path apart, was found at this gap. None where there is no answer.
    beyond : float or None [mm]
        Nearest gap that was seen to fail, by a state that was checked; None where none was.
    searched_gap, proven_gap : float or None [mm]
        Largest gap at which no larger motion was found, and largest at which none is possible. For "fits" both are the answer.
    trials : tuple of Trial
        Everything that was tried, in order of the gap.
    sides : (Interlock or None) twice
        For "holds": the states that were verified at `gap` and at `beyond`.
    why : str
        What a reader must know beside the number; empty where there is nothing.
    stopped : bool
        True where the time was over, or it was stopped, before both sides lay near each other.
    kerf : float or None [mm]
        Width of the cut for which an offset is wanted.
    fits_from : float or None [mm]
        Of the largest gaps: the smallest at which parts as drawn, not shifted, do not overlap; None where there is none, or it was stopped.
    """

    question: Question
    limit: float | None
    assembly: Any
    goals: tuple[Any, ...]
    gap: float | None
    certainty: Certainty | None
    beyond: float | None
    searched_gap: float | None
    proven_gap: float | None
    trials: tuple[Trial, ...]
    sides: tuple[Any, Any] = (None, None)
    why: str = ""
    stopped: bool = False
    kerf: float | None = None
    fits_from: float | None = None

    def cut_offset(self, kerf: float) -> float | None:
        """How far outward the cutter's path must lie from the drawn line [mm], so that this gap comes out.

        A cut along the line takes half a kerf from every outline, and the gap wants half a gap: the difference is the offset.
        """
        return None if self.gap is None else (kerf - self.gap) / 2
