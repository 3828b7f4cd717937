"""What sizes and options can be worked with."""

from __future__ import annotations

import math

from wiggleroom.errors import InputError

LARGEST = 1e9
"""Coordinates beyond this [mm] are refused."""
SMALLEST = 1e-6
"""Drawings smaller than this [mm] are refused."""
MOST_DEGREES = 1e6
"""Angles beyond this [deg] are refused: their last digits are no longer small."""
FINEST = 1e-9
"""Chord errors below this share of the drawing's size are refused."""


def check_options(*, flatten: float | None, gap: float | None) -> None:
    """Raise InputError unless the chord error is positive and the gap not negative [mm].

    Examples
    --------
    >>> check_options(flatten=None, gap=0.2)
    """
    findings = []
    if flatten is not None and not (math.isfinite(flatten) and flatten > 0):
        findings.append(f"flatten is {flatten:g}; the chord error must be larger than 0 mm")
    if gap is not None and not (math.isfinite(gap) and gap >= 0):
        findings.append(f"gap is {gap:g}; it must be 0 mm or more")
    if findings:
        raise InputError(findings)
