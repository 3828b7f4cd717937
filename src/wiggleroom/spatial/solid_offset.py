"""The largest offset at which no two parts overlap as they stand, in space: of the outlines of all plates, or of all faces.

As in the plane, the smallest offset of all pairs is sought, that of the deepest overlap first. An offset of outlines leaves the faces of
plates, and other parts, where they are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.assembly.fitting_offset import FittingOffset, largest_free
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.drawing.model import Plate, Surface
from wiggleroom.errors import InputError, Stop, go_on
from wiggleroom.spatial.overlaps.common_solid import common_piece, least_width
from wiggleroom.spatial.overlaps.meeting_pairs import meeting_pairs
from wiggleroom.spatial.solids.made_solids import drawn_surface, made_solid
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

EXACT = 1e-8
"""The offset of a pair is enclosed to this share of the size of the assembly."""
BINDING = 1e-6
"""Pairs that overlap where outlines lie further out by this share of the size bind."""
LARGEST = 0.05
"""Parts that do not meet with outlines further out by this share of the size have no offset."""
NO_PAIRS = np.zeros((0, 2), dtype=np.int64)
Overlaps = dict[tuple[int, int], float]
"""Depth [mm] by pair."""
Make = Callable[[int, float], Surface | None]
"""The surface of a part at an offset [mm], in its own frame; None where it cannot be made."""


def solid_offset(assembly: Assembly, stop: Stop | None = None) -> FittingOffset:
    """The largest offset of the outlines of all plates at which no two parts overlap that are neither glued nor ignored.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    if not any(isinstance(part.solid, Plate) for part in assembly.drawing.parts):
        return FittingOffset(None, NO_PAIRS)
    if assembly.drawing.gaps:
        return FittingOffset(None, NO_PAIRS, "with gaps of single joints in space it is not worked out")

    def outlines(k: int, offset: float) -> Surface | None:
        part = assembly.drawing.parts[k]
        if not isinstance(part.solid, Plate) or not offset:
            return assembly.solids[k].surface
        made, wrong = made_solid(replace(part, offset=part.offset + offset), assembly.gap, 0.0, stop)
        return None if made is None or wrong else made.surface

    solids, size = _MovedSolids(assembly, outlines, stop), assembly.size
    offset = 0.0
    overlaps = solids.overlaps(offset)
    if not overlaps:
        step = EXACT * size
        while overlaps is not None and not overlaps and step < LARGEST * size:
            offset, step = step, 4 * step
            overlaps = solids.overlaps(offset)
        if not overlaps:
            return FittingOffset(None, NO_PAIRS, "no two parts meet, however large they are")
    return solids.lowered(offset, overlaps, "at every offset of their outlines")


def offset_of_faces(assembly: Assembly, larger: float, stop: Stop | None = None) -> FittingOffset:
    """The largest offset of all faces, up to `larger` [mm], at which no two parts overlap that are neither glued nor ignored.

    Offsets are counted from where faces are drawn: at a gap, faces that were made `larger` too far out lie at `larger` - gap / 2. Gaps of
    single joints stay as they are.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    drawing = assembly.drawing
    together: dict[float, Assembly | None] = {}

    def at_gap(gap: float) -> Assembly | None:
        if gap not in together:
            try:
                together[gap] = assemble_spatial(
                    drawing, gap=gap, inward=dict.fromkeys(assembly.names, -larger), stop=stop
                )
            except InputError:
                together[gap] = None
        return together[gap]

    def faces(k: int, offset: float) -> Surface | None:
        part = drawing.parts[k]
        if drawing.gaps:
            made = at_gap(2 * (larger - offset))
            return None if made is None else made.solids[k].surface
        if offset == 0 and not part.offset:
            return drawn_surface(part)
        found, wrong = made_solid(part, 2 * (larger - offset), -larger, stop)
        return None if found is None or wrong else found.surface

    solids = _MovedSolids(assembly, faces, stop)
    overlaps = solids.overlaps(larger)
    if overlaps is None:
        return FittingOffset(None, NO_PAIRS, "with no gap parts that are so much larger cannot be made")
    if not overlaps:
        return FittingOffset(larger, NO_PAIRS)
    return solids.lowered(larger, overlaps, "at every gap at which they can be made")


class _MovedSolids:
    """Parts in space whose faces are moved in and out.

    Parameters
    ----------
    assembly : Assembly
    make : Make
    stop : Stop, optional
    """

    def __init__(self, assembly: Assembly, make: Make, stop: Stop | None) -> None:
        self.assembly, self.make, self.stop = assembly, make, stop
        self.rounding = OVERLAP_TOLERANCE * assembly.size
        self.exact = EXACT * assembly.size

    def lowered(self, offset: float, overlaps: Overlaps, where: str) -> FittingOffset:
        """The largest offset below one at which some pairs overlap where none does; `where` these do if there is none."""
        known = list(overlaps)
        while overlaps:
            pair = max(overlaps, key=overlaps.__getitem__)
            lower = self.offset_of_pair(pair, offset)
            if lower is None:
                names = " and ".join(f'"{self.assembly.names[k]}"' for k in pair)
                return FittingOffset(None, np.array([pair]), f"parts {names} overlap {where}")
            offset = lower
            overlaps = self.overlaps(offset, list(overlaps)) or {}
        beyond = offset + BINDING * self.assembly.size
        bind = self.overlaps(beyond, known) or {}
        pairs = np.array(sorted(bind), dtype=np.int64).reshape(-1, 2)
        return FittingOffset(offset, pairs, beyond=(beyond, self._deepest(bind, beyond)) if bind else None)

    def _deepest(self, pairs: Overlaps, offset: float) -> float:
        """How deep some pairs are in each other [mm]."""
        depth = 0.0
        for a, b in pairs:
            one, other = self.solid(a, offset), self.solid(b, offset)
            assert one is not None  # they were made to see that they overlap
            common = one ^ other
            depth = max([depth, *(common_piece(surface_of(piece)).depth for piece in common.decompose())])
        return depth

    def solid(self, k: int, offset: float) -> Any | None:
        """A part where it stands, at an offset [mm]; None where it cannot be made."""
        made = self.make(k, offset)
        return None if made is None else solid_of(placed_surface(self.assembly.drawing.parts[k], made))

    def overlaps(self, offset: float, pairs: list[tuple[int, int]] | None = None) -> Overlaps | None:
        """Pairs that overlap at an offset, and how deep; None where a part cannot be made."""
        used = range(len(self.assembly.names)) if pairs is None else sorted({k for pair in pairs for k in pair})
        solids: dict[int, Any] = {}
        for k in used:
            go_on(self.stop)
            solids[k] = self.solid(k, offset)
            if solids[k] is None:
                return None
        found = {}
        if pairs is None:
            box = np.array([solids[k].bounding_box() for k in used])
            pairs = meeting_pairs(self.assembly, box[:, :3], box[:, 3:])
        for a, b in pairs:
            go_on(self.stop)
            depth = self._depth(solids[a], solids[b])
            if depth > 0:
                found[a, b] = depth
        return found

    def _depth(self, one: Any, other: Any) -> float:
        """About how deep two solids are in each other [mm]; 0 where that is rounding."""
        common = one ^ other
        if common.volume() <= 0:
            return 0.0
        deepest = max(least_width(surface_of(piece))[0] for piece in common.decompose())
        return deepest if deepest > self.rounding else 0.0

    def offset_of_pair(self, pair: tuple[int, int], high: float) -> float | None:
        """The largest offset below one at which two parts overlap where they do not; None where they cannot be made before."""
        step = max(self.exact, 1e-3 * abs(high), 1e-5 * self.assembly.size)
        return largest_free(lambda offset: self._free(pair, offset), high, step, self.exact)

    def _free(self, pair: tuple[int, int], offset: float) -> bool | None:
        found = self.overlaps(offset, [pair])
        return None if found is None else not found
