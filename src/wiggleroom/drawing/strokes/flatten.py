"""Subpaths on the page as corners at a chord error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from wiggleroom.drawing.model import Points
from wiggleroom.drawing.strokes.curves import Arcs, Complex, flatten_arcs, flatten_cubics
from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Subpath


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
            pieces: list[Complex] = []
            run = [start]  # points between curves
            for kind, row, end in loop:
                if kind != "line":
                    pieces += [np.array(run), inner[kind][row]]
                    run = []
                run.append(end)
            last = np.array(run)
            rings.append((np.concatenate([*pieces, last]) if pieces else last).view(np.float64).reshape(-1, 2))
        return rings

    def _arc_corners(self, tolerance: float) -> list[Complex]:
        if not self.arcs:
            return []
        centre, u, v = (np.array([row[i] for row in self.arcs], dtype=complex) for i in range(3))
        start, sweep = (np.array([row[i] for row in self.arcs], dtype=float) for i in (3, 4))
        return flatten_arcs(Arcs(centre, u, v, start, sweep), tolerance, np.array(self.flipped))
