"""What is known of the clearances of near parts, in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, corners_at
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.displayable import Drawable

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR_SHARE = 0.02
"""By default pairs nearer than this share of the median part's size are near ones."""


@dataclass(frozen=True, eq=False)
class Clearances(Drawable):
    """The least gap of every near pair of parts, with its place and direction, the tightest first.

    Glued and ignored pairs are left out.

    Parameters
    ----------
    assembly : Assembly
    pairs : (k, 2) int64
        Indices of the parts.
    gap : (k,) float64 [mm]
        Least distance of the two; negative if they overlap, by the depth at the deepest place.
    direction : (k, 2) or (k, 3) float64
        Unit vector from the first part to the second at that place.
    at : (k, 2) or (k, 3) float64 [mm]
        Middle of the gap or of the overlap there.
    within : float [mm]
        Pairs further apart than this are left out.
    offset : float, optional [mm]
        The largest offset of all outlines, positive outward, at which no two parts overlap as drawn; None if there is none, see `why`.
    binding : (m, 2) int64
        Pairs that overlap at any larger offset.
    why : str
        Reason if there is no offset.
    least_xy, least_z : float, optional [mm]
        Requested least distances along the plane of the layers and across it, in space.
    xy, z : (k,) float64 [mm]
        Least distance of two points of the parts at the same height, and of two above each other; infinite beyond the requested
        distances.
    stopped : bool
        True if stopped before all pairs were measured.
    """

    assembly: Assembly
    pairs: Ints
    gap: Floats
    direction: Floats
    at: Floats
    within: float
    offset: float | None
    binding: Ints
    why: str = ""
    least_xy: float | None = None
    least_z: float | None = None
    xy: Floats | None = None
    z: Floats | None = None
    stopped: bool = False

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Pairs (k,) that touch or overlap, but for rounding."""
        return np.asarray(self.gap <= CONTACT_TOLERANCE * self.assembly.size)

    @property
    def too_near(self) -> NDArray[np.bool_]:
        """Pairs (k,) nearer than was asked for along the layers or across them, or that touch."""
        near = self.touching
        for least, gap in ((self.least_xy, self.xy), (self.least_z, self.z)):
            if least is not None and gap is not None:
                near = near | (gap < least - CONTACT_TOLERANCE * self.assembly.size)
        return near

    @cached_property
    def fused(self) -> tuple[tuple[str, ...], ...]:
        """Names of parts that touch or overlap, directly or through others: groups that become one body where they are printed in place."""
        group = {k: frozenset((k,)) for k in range(len(self.assembly.names))}
        for a, b in self.pairs[self.touching].tolist():
            joined = group[a] | group[b]
            group |= dict.fromkeys(joined, joined)
        several = sorted({tuple(sorted(one)) for one in group.values() if len(one) > 1})
        return tuple(tuple(self.assembly.names[k] for k in one) for one in several)

    @property
    def kerf(self) -> float | None:
        """Width of the cut along the drawn lines that makes all parts fit [mm]; None where they fit without one or never do."""
        return -2 * self.offset if self.offset is not None and self.offset < 0 else None


def near_distance(assembly: Assembly) -> float:
    """Distance [mm] up to which pairs are near ones: twice the widest gap, and no less than a share of the median part."""
    sizes = [float(np.ptp(corners_at(part), axis=0).max()) for part in assembly.parts]
    return max(2 * assembly.widest_gap, NEAR_SHARE * float(np.median(sizes)))
