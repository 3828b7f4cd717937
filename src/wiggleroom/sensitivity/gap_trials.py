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
    """Answer of `allowable_gap`.

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
        The answer; None if there is none, see `why`.
    certainty : Certainty or None
        Proven, or searched: the search at this gap gave no larger motion, or no path apart. None without an answer.
    beyond : float or None [mm]
        Nearest gap with a checked state that fails; None if there is none.
    searched_gap, proven_gap : float or None [mm]
        Largest gap at which a search, and largest at which a proof, excludes a larger motion. For "fits" both are the answer.
    trials : tuple of Trial
        All trials, in order of the gap.
    sides : (Interlock or None) twice
        For "holds": the verified states at `gap` and at `beyond`.
    why : str
        Explanation to show beside the number; may be empty.
    stopped : bool
        True if stopped, or out of time, before both sides were near each other.
    kerf : float or None [mm]
        Width of the cut for `cut_offset`.
    fits_from : float or None [mm]
        For "at most" and "holds": the smallest gap at which parts as drawn, not shifted, do not overlap; None if there is none, or if
        stopped.
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
