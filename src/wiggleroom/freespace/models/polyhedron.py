"""Free space of one pair as a model that approximates has it: one convex polyhedron in (x, y, turn)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Displayable
from wiggleroom.errors import InputError
from wiggleroom.freespace.slices import Slice
from wiggleroom.geometry.relative_pose import PairFrames

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Polyhedron(Displayable):
    """Relative motions of part b against part a that the model `hull` or `halfplane` accepts; some of them may overlap.

    Relative motions are those of `wiggleroom.FreeSpace`.

    Parameters
    ----------
    parts : (a, b)
        Names.
    model : str
    normal, offset : (m, 3) float64, (m,) float64 [mm]
        N g + D <= 0, g the motion of `pivot` in part a's frame and the turn of b.
    slices : tuple of Slice [mm]
        Slices whose hull it is, as motions of the pivot; none for half-planes.
    angles : (low, high) [rad]
        nc and pc of a hull; the range of turns of half-planes at the pivot's place at rest.
    closed : bool
        True if it is bounded without a cut.
    pivot : (2,) float64 [mm]
        Point of b, from b's reference point, in the axes of a's frame at rest.
    """

    parts: tuple[str, str]
    model: str
    normal: Floats
    offset: Floats
    slices: tuple[Slice, ...]
    angles: tuple[float, float]
    closed: bool
    pivot: Floats
    _relation: PairFrames

    @property
    def rows(self) -> int:
        """Number of faces."""
        return len(self.offset)

    def contains(self, relative: Floats) -> NDArray[np.bool_]:
        """Which relative motions (k, 3) [mm, mm, rad] of part b's reference point the model accepts."""
        motion = np.asarray(relative, dtype=float)
        if motion.ndim != 2 or motion.shape[1] != 3:
            finding = f"relative motions have shape {motion.shape}: they must be (k, 3), x, y [mm] and turn [rad]"
            raise InputError(finding)
        g = np.column_stack([self._relation.shift(motion), motion[:, 2]])
        inside = np.ones(len(g), dtype=bool)
        for n, d in zip(self.normal, self.offset, strict=True):
            inside &= g @ n + d <= 0
        return inside
