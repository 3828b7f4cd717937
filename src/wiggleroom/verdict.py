"""How a question ended, and how sure that is. The values are the words in files; nothing else says these things."""

from __future__ import annotations

from enum import StrEnum

SAME_END = 1e-6
"""Values of motions that differ by less than this share are the same end."""


class Verdict(StrEnum):
    """How the search for the largest motion ended."""

    PROVEN = "proven"
    OPTIMAL = "optimal"
    STATIONARY = "stationary"
    UNBOUNDED = "unbounded"
    STOPPED = "stopped"
    TOUCHING = "touching"
    NOT_MAKEABLE = "cannot be made"

    @property
    def ends(self) -> bool:
        """True where a motion that ends was found, and its end satisfies the optimality conditions."""
        return self in (Verdict.PROVEN, Verdict.OPTIMAL, Verdict.STATIONARY)

    @property
    def sentence(self) -> str:
        """One sentence for people."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.PROVEN: "no motion is worth more than 0.1 % more",
    Verdict.OPTIMAL: "every active wall is a real contact and the optimality conditions hold",
    Verdict.STATIONARY: "the optimality conditions hold, but a branch at a corner contact is left open",
    Verdict.UNBOUNDED: "nothing stops the motion",
    Verdict.STOPPED: "stopped before the end; this is the best safe motion so far",
    Verdict.TOUCHING: "parts touch at rest",
    Verdict.NOT_MAKEABLE: "the outlines cannot be made at this gap",
}


class SearchState(StrEnum):
    """Whether a search from other starts than rest has ended: before that a verdict is about the climb from rest alone."""

    DONE = "done"
    TO_COME = "to come"
    FROM_REST = "from rest"
    """None follows: too many parts move."""

    @property
    def found(self) -> str:
        """How an answer is called in place of its verdict; empty where that one counts.

        >>> SearchState.TO_COME.found
        'found so far'
        """
        return {"done": "", "to come": "found so far", "from rest": "found from rest"}[self]

    @property
    def sentence(self) -> str:
        """What may remain unfound."""
        return {
            "done": "",
            "to come": "a search from other starts has not ended and may find more",
            "from rest": "too many parts move for a search from other starts, and a larger motion may remain unfound",
        }[self]


class PathState(StrEnum):
    """Whether no two parts overlap anywhere on the path from rest."""

    CHECKED = "checked"
    NOT_CHECKED = "not checked"

    @classmethod
    def of(cls, free: bool) -> PathState:
        """`CHECKED` where the whole path was judged and is free.

        >>> PathState.of(False)
        <PathState.NOT_CHECKED: 'not checked'>
        """
        return cls.CHECKED if free else cls.NOT_CHECKED


class Separability(StrEnum):
    """Whether parts can be moved without limit away from the others."""

    INTERLOCKED = "interlocked"
    COMES_APART = "comes apart"
    UNKNOWN = "unknown"


class Certainty(StrEnum):
    """What a statement rests on: a proof, or a search that found nothing else."""

    PROVEN = "proven"
    SEARCHED = "searched"


class Tightness(StrEnum):
    """Whether parts drawn without gaps are locked to first order."""

    LOCKED = "locked"
    MOVES = "moves"


class SolverStatus(StrEnum):
    """How one solve of the nonlinear program ended."""

    CONVERGED = "converged"
    """The optimality conditions hold to the tolerance."""
    ENOUGH = "enough"
    """The objective passed what was asked for."""
    STOPPED = "stopped"
    """Somebody asked to stop, or the time was up."""
    ESCAPING = "escaping"
    """A body moved past the horizon: nothing stops it."""
    FAILED = "failed"
    """Too many iterations, or no step was possible."""
