"""How far curves of a drawing may lie from their edges, at which gap."""

from __future__ import annotations

import math
from dataclasses import replace

from wiggleroom.drawing.model import Drawing, Part

GAP_SHARE = 1 / 50
"""No curve is further from its chords than this share of the gap."""
NO_GAP_SHARE = 1e-4
"""Nor, where there is no gap, than this share of the median part size: clearance may be drawn, and nobody knows how little."""


def chord_error(gap: float, at_no_gap: float, finest: float) -> float:
    """Chord error of curves [mm] at a gap [mm]: a fiftieth of it, and no less than the finest one.

    Examples
    --------
    >>> [chord_error(gap, 0.01, 1e-9) for gap in (1.0, 0.2, 0.0)]
    [0.02, 0.004, 0.01]
    """
    return max(GAP_SHARE * gap if gap > 0 else at_no_gap, finest)


def flattened_for(drawing: Drawing, gap: float) -> Drawing:
    """The drawing with its curves cut into edges as its file is read with this gap [mm].

    So whoever asks about a gap, in whatever order, asks about the same outlines. Drawings without curves, and outlines that are no
    longer as they were read, stay as they are.
    """
    how = drawing.flattening
    if how is None or (error := chord_error(gap, how.at_no_gap, how.finest)) == how.error:
        return drawing
    before = {part.name: part for part in how.parts}
    if any(part.regions is not before[part.name].regions for part in drawing.parts):
        return drawing
    parts = how.again(error)
    after = {part.name: part for part in parts}
    if after.keys() != before.keys():
        return drawing
    shown = tuple(_put(part, before[part.name], after[part.name]) for part in drawing.parts)
    return replace(drawing, parts=shown, flattening=replace(how, error=error, parts=parts))


def _put(part: Part, before: Part, after: Part) -> Part:
    """A part with the edges of `after` in place of those of `before`; its reference point is that of `after`."""
    (x, y, angle), (x0, y0, _), (x1, y1, _) = part.at, before.at, after.at
    shift = complex(x1 - x0, y1 - y0) * complex(math.cos(angle), math.sin(angle))
    return replace(part, regions=after.regions, at=(x + shift.real, y + shift.imag, angle))
