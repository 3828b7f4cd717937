"""Which gap a maker may leave: the largest that keeps a motion small or the parts together, the smallest that fits.

Parts only get smaller as the gap grows, so what can be moved at one gap can be moved at any larger one: the largest motion never
falls, a path apart stays one, and parts that fit beside each other still do. Each question therefore has one border, which is
enclosed between a gap that answers it and one that was seen not to.
"""

from __future__ import annotations

import math
from typing import Any

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import overlap_depth
from wiggleroom.context import Context
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.errors import InputError
from wiggleroom.sensitivity.gap_trials import AllowableGap, Trial
from wiggleroom.sensitivity.motion_border import SETTINGS
from wiggleroom.sensitivity.searched_gaps import RELATIVE_TOLERANCE
from wiggleroom.verdict import Certainty, Verdict

GEOMETRIC_TOLERANCE = 1e-6
"""Both sides of the smallest gap that fits end no further apart than this share of it: it is a question of geometry, which costs little."""


def check_question(at_most: float | None, holds: bool, fits: float | None) -> None:
    """Check that one question is asked.

    Raises
    ------
    InputError
        If not, or a number makes no sense.
    """
    if sum((at_most is not None, holds, fits is not None)) != 1:
        raise InputError("gap: ask one question: at most (--at-most 0.5), holds (--holds) or fits (--fits 0.1)")
    if at_most is not None and not (math.isfinite(at_most) and at_most > 0):
        wrong = f"gap: at most {at_most:g}: it must be more than 0"
        raise InputError(wrong)
    if fits is not None and not (math.isfinite(fits) and fits >= 0):
        wrong = f"gap: fits {fits:g}: it must be 0 or more"
        raise InputError(wrong)


def held_gap(assembly: Any, border: LargestGap, context: Context) -> AllowableGap:
    """Largest gap at which the parts interlock, from both sides of where they come apart."""
    certainty = None if border.interlocked is None else border.interlocked.certainty
    trials = tuple(
        Trial(gap, None, state.verdict, True)
        for gap, state in ((border.holds, border.interlocked), (border.parts_at, border.apart))
        if gap is not None and state is not None
    )
    near = border.holds is not None and border.parts_at is not None and (
        border.parts_at - border.holds <= 2 * RELATIVE_TOLERANCE * border.parts_at
    )  # fmt: skip
    if border.holds is None:
        why = "no gap was found that holds it together"
    elif border.parts_at is None:
        why = "parts fall to pieces before they come apart"
    else:
        why = "" if near else "between the two gaps it was not decided"
    return AllowableGap(
        "holds", None, assembly, (), border.holds, certainty, border.parts_at, border.holds,
        border.holds if certainty is Certainty.PROVEN else None, trials, (border.interlocked, border.apart), why,
        context.stopped and not near,
    )  # fmt: skip


def fitting(assembly: Assembly, larger: float) -> AllowableGap:
    """Smallest gap at which outlines that lie `larger` further out do not overlap as drawn, not shifted."""
    trials: dict[float, Trial] = {}
    outward = dict.fromkeys(assembly.names, larger)

    def at(gap: float) -> Trial:
        if gap not in trials:
            depth = overlap_depth(assembly.drawing, gap=gap, offset=outward)
            verdict = Verdict.NOT_MAKEABLE if depth is None else "overlaps" if depth > 0 else "fits"
            trials[gap] = Trial(gap, depth, verdict, depth is not None)
        return trials[gap]

    low, high, size = 0.0, 2 * larger or SETTINGS.min_gap_share * assembly.size, assembly.size
    if at(0.0).verdict == "fits":
        return _fits(assembly, larger, 0.0, None, trials, "")
    while at(high).verdict == "overlaps" and high < 4 * size:
        low, high = high, 2 * high
    if at(high).verdict == Verdict.NOT_MAKEABLE:
        while high - low > GEOMETRIC_TOLERANCE * high and at((low + high) / 2).verdict != "fits":
            middle = (low + high) / 2
            low, high = (middle, high) if at(middle).verdict == "overlaps" else (low, middle)
        high = (low + high) / 2
    if at(high).verdict != "fits":
        why = "no gap makes room: parts overlap at every gap at which they can be made"
        return _fits(assembly, larger, None, low, trials, why)
    while high - low > GEOMETRIC_TOLERANCE * high:
        middle = (low + high) / 2
        low, high = (low, middle) if at(middle).verdict == "fits" else (middle, high)
    if (
        overlap_depth(assembly.drawing, gap=high, offset={}) is None
    ):  # outlines so much larger may stand a gap that those drawn do not
        why = f"no gap makes room: at a gap of {high:g} mm parts as drawn fall to pieces"
        return _fits(assembly, larger, None, low, trials, why)
    return _fits(assembly, larger, high, low, trials, "")


def _fits(
    assembly: Assembly, larger: float, gap: float | None, beyond: float | None, trials: dict[float, Trial], why: str
) -> AllowableGap:
    found = tuple(sorted(trials.values(), key=lambda t: t.gap))
    sure = None if gap is None else Certainty.PROVEN
    return AllowableGap("fits", larger, assembly, (), gap, sure, beyond, gap, gap, found, why=why)
