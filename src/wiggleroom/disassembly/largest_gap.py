"""The gap at which an assembly comes apart, with a verified state on both sides."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.interlock import interlock
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError, StoppedError, TouchingError
from wiggleroom.verdict import Separability

RELATIVE_TOLERANCE = 1e-3
"""Both sides end no further apart than this share of the gap."""
UNDECIDED_TOLERANCE = 2.5e-4
"""Where gaps in between stay undecided, each side ends no further from these than this share of the gap."""
BOXES_PER_GAP, QUESTIONS_PER_GAP = 40_000, 40
"""Of `check`, at every gap that is tried."""
MIN_GAP_SHARE = 1e-4
"""The search for a gap that holds ends below this share of the drawing's size."""
FIRST_GAP_SHARE = 1e-2
"""Where the drawing gives no gap, the search begins at this share of its size."""
NOT_HELD = {"comes apart", "gone"}


@dataclass(frozen=True, eq=False)
class LargestGap(Drawable):
    """The gap at which interlock is lost, from both sides.

    Parameters
    ----------
    holds : float or None [mm]
        Largest gap known to interlock; None if no gap does.
    parts_at : float or None [mm]
        Smallest gap with a path apart; None if the parts fall to pieces before they come apart.
    interlocked, apart : Interlock or None
        The verified states on both sides.
    """

    holds: float | None
    parts_at: float | None
    interlocked: Any
    apart: Any


def largest_gap(assembly: Assembly, context: Context = UNLIMITED) -> LargestGap:
    """The gap of a whole drawing at which it comes apart, to 0.1 %; see `wiggleroom.largest_gap`.

    Parts only get smaller as the gap grows, so a path apart stays a path apart, and bisection finds the border. Where some gaps cannot be
    decided, both sides stay further apart.
    """
    effort = EscapeEffort(BOXES_PER_GAP, QUESTIONS_PER_GAP)
    proof_alone = replace(effort, questions=0)
    undecided: list[float] = []

    def look(made: Assembly) -> Interlock:
        # no path was found at a larger gap, where there is more room: only a proof can decide it here
        enough = proof_alone if any(made.gap < gap for gap in undecided) else effort
        found = interlock(made, enough, every=False, context=context)
        if found.verdict is Separability.UNKNOWN:
            undecided.append(made.gap)
        return found

    drawing = assembly.drawing
    return largest_gap_over(assembly, lambda gap: assemble(drawing, gap=gap), look, context)


def largest_gap_over(
    assembly: Any, make: Callable[[float], Any], look: Callable[[Any], Any], context: Context
) -> LargestGap:
    """The same of any assembly: `make` gives it with another gap, `look` whether that comes apart.

    Raises
    ------
    InputError
        If `look` refuses the assembly.
    """
    tried: dict[float, Any] = {}

    def at(gap: float) -> str:
        """The verdict at a gap; "gone" where no parts are left at it, "unknown" where they touch."""
        if gap not in tried:
            context.go_on()
            try:
                made = make(gap)
            except InputError:
                tried[gap] = None
                return "gone"
            try:
                verdict = look(made)
            except TouchingError:
                return "unknown"
            if verdict.verdict is Separability.UNKNOWN:
                context.go_on()  # a check that was cut short says nothing about its gap
            tried[gap] = verdict
        found = tried[gap]
        return "gone" if found is None else str(found.verdict)

    def known(verdict: str) -> list[float]:
        return [g for g in tried if at(g) == verdict]

    with suppress(StoppedError):
        _bracket(assembly, at, known)
    parts_at = min(known("comes apart"), default=None)
    holds = max((g for g in known("interlocked") if parts_at is None or g < parts_at), default=None)
    return LargestGap(
        holds, parts_at, None if holds is None else tried[holds], None if parts_at is None else tried[parts_at]
    )


def _bracket(assembly: Any, at: Callable[[float], str], known: Callable[[str], list[float]]) -> None:
    """Try gaps until one that interlocks and one that does not are near each other, or none interlocks."""
    begin = assembly.gap or FIRST_GAP_SHARE * assembly.size
    low: float | None = begin if assembly.gap or at(0.0) != "interlocked" else 0.0
    while low and at(low) != "interlocked":
        low = low / 2 if low > MIN_GAP_SHARE * assembly.size else None
    if low is not None:
        high = max(begin, 2 * low)
        while at(high) not in NOT_HELD:
            high *= 2
        _narrow(at, low, high, NOT_HELD, RELATIVE_TOLERANCE)
        _narrow_held(at, known, RELATIVE_TOLERANCE)
        for narrow in (_narrow_held, _narrow_not_held):  # the gap that holds is what is asked for
            if _least_not_held(known) - max(known("interlocked")) > RELATIVE_TOLERANCE * _least_not_held(known):
                narrow(at, known, UNDECIDED_TOLERANCE)


def _narrow_held(at: Callable[[float], str], known: Callable[[str], list[float]], tolerance: float) -> None:
    """Narrow the interval between the largest gap that interlocks and the next one that is not known to."""
    low = max(known("interlocked"))
    above = [g for bad in (*NOT_HELD, "unknown") for g in known(bad) if g > low]
    _narrow(at, low, min(above), {*NOT_HELD, "unknown"}, tolerance)


def _narrow_not_held(at: Callable[[float], str], known: Callable[[str], list[float]], tolerance: float) -> None:
    """Narrow the interval between the smallest gap that is known not to hold and the next one that is not known not to."""
    high = _least_not_held(known)
    below = [g for good in ("interlocked", "unknown") for g in known(good) if g < high]
    _narrow(at, max(below), high, NOT_HELD, tolerance)


def _least_not_held(known: Callable[[str], list[float]]) -> float:
    """Smallest gap that is known not to hold."""
    return min(g for bad in NOT_HELD for g in known(bad))


def _narrow(at: Callable[[float], str], low: float, high: float, bad: set[str], tolerance: float) -> None:
    """Halve the interval between a gap that is not `bad` and one that is, until it is narrow enough."""
    while high - low > tolerance * high:
        middle = (low + high) / 2
        if at(middle) in bad:
            high = middle
        else:
            low = middle
