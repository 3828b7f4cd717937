"""Subpaths on the page as corners at a chord error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from wiggleroom.drawing.model import Drawing, Part, Points
from wiggleroom.drawing.strokes.curves import Arcs, Complex, flatten_arcs, flatten_cubics
from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Subpath

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


@dataclass
class Curved:
    """Subpaths on the page, their curves collected so that all are divided together.

    A loop is its start and, per segment, the kind of curve, its row among those of its kind, and its end.
    """

    loops: list[tuple[complex, list[tuple[str, int, complex]]]] = field(default_factory=list)
    cubics: list[tuple[complex, complex, complex, complex]] = field(default_factory=list)
    arcs: list[tuple[complex, complex, complex, float, float]] = field(default_factory=list)
    flipped: list[bool] = field(default_factory=list)

    def add(self, subpath: Subpath) -> None:
        """Take up a subpath on the page."""
        here = subpath.start
        loop: list[tuple[str, int, complex]] = []
        for segment in subpath.segments:
            if isinstance(segment, Cubic):
                loop.append(("cubic", len(self.cubics), segment.end))
                self.cubics.append((here, segment.first, segment.second, segment.end))
            elif isinstance(segment, Arc):
                loop.append(("arc", len(self.arcs), segment.end))
                self.arcs.append((segment.centre, segment.u, segment.v, segment.start, segment.sweep))
                self.flipped.append(segment.flipped)
            else:
                loop.append(("line", 0, segment.end))
            here = segment.end
        self.loops.append((subpath.start, loop))

    @property
    def bent(self) -> bool:
        """True where there is any curve."""
        return bool(self.cubics or self.arcs)

    def reach(self) -> tuple[float, float]:
        """Largest coordinate of any point that defines an outline, and the longer side of the box round them [mm]."""
        points = [start for start, _ in self.loops]
        points += [end for _, loop in self.loops for *_, end in loop]
        points += [point for row in self.cubics for point in row[1:3]]
        points += [centre + sign * axis for centre, u, v, *_ in self.arcs for axis in (u, v) for sign in (1, -1)]
        flat = np.array(points).view(np.float64).reshape(-1, 2)
        return float(np.abs(flat).max()), float(np.ptp(flat, axis=0).max()) if np.isfinite(flat).all() else np.inf

    def corners(self, tolerance: float) -> list[Points]:
        """Corners (n, 2) [mm] of every subpath, both ends included, in the sense in which it was drawn.

        Parameters
        ----------
        tolerance : float [mm]
            No curve is further from its chords than this.
        """
        inner: dict[str, Sequence[Complex]] = {
            "cubic": flatten_cubics(np.array(self.cubics, dtype=complex).reshape(-1, 4), tolerance),
            "arc": self._arc_corners(tolerance),
        }
        rings = []
        for start, loop in self.loops:
            pieces: list[Complex] = [np.array([start])]
            for kind, row, end in loop:
                if kind != "line":
                    pieces.append(inner[kind][row])
                pieces.append(np.array([end]))
            rings.append(np.concatenate(pieces).view(np.float64).reshape(-1, 2))
        return rings

    def _arc_corners(self, tolerance: float) -> list[Complex]:
        if not self.arcs:
            return []
        centre, u, v = (np.array([row[i] for row in self.arcs], dtype=complex) for i in range(3))
        start, sweep = (np.array([row[i] for row in self.arcs], dtype=float) for i in (3, 4))
        return flatten_arcs(Arcs(centre, u, v, start, sweep), tolerance, np.array(self.flipped))
