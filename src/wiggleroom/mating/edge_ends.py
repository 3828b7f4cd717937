"""Ends of the edges that carry fingers: of joints that fit equally well the one is likelier whose edges end together.

Fingers of edges of different length may fit each other, where only the plain stretches at the ends differ. Edges that belong
together end at the same place, or one reaches further by just the thickness of the plate that it covers.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.flanks import FlankLine, SheetPlate
from wiggleroom.mating.panel_set import PanelSet, Placement

Floats = NDArray[np.float64]

SAME_END = 0.12
"""Ends are together that are nearer than this share of the thickness."""
INWARD = 0.9
"""The ends of an edge are seen this many thicknesses inside of the line of its flanks, below its fingers."""
DEEPER = 1.2
"""And again this many thicknesses inside: where they lie elsewhere there, the panel is slanted."""
SLANTED = 0.05
"""Elsewhere is further off than this share of the thickness."""


def edge_ends(plate: SheetPlate, line: FlankLine) -> tuple[float, float] | None:
    """Where the edge that carries a line of flanks begins and ends along it [mm]; None for rows of holes and slots within a panel.

    An end from which the panel runs on at a slant, as at the corners of a polygon, is nan: what stands there ends elsewhere.
    """
    if not line.outward or len(line.rows) < 2:
        return None
    ends, deeper = (_ends_inside(plate, line, depth * plate.thickness) for depth in (INWARD, DEEPER))
    if ends is None or deeper is None:
        return ends
    slanted = np.abs(np.array(ends) - deeper) > SLANTED * plate.thickness
    low, high = np.where(slanted, np.nan, ends).tolist()
    return low, high


def _ends_inside(plate: SheetPlate, line: FlankLine, depth: float) -> tuple[float, float] | None:
    """Where a parallel to a line of flanks, inside of the panel, enters and leaves it [mm]."""
    inside = (line.offset - line.outward * depth) * line.across
    reach = 2.0 * plate.radius
    cut = plate.polygon.intersection(shapely.LineString([inside - reach * line.along, inside + reach * line.along]))
    middle = float(line.at.mean())
    for piece in shapely.get_parts(cut):
        if piece.geom_type == "LineString":
            low, high = np.sort(shapely.get_coordinates(piece) @ line.along).tolist()[:2]
            if low <= middle <= high:
                return low, high
    return None


def ends_together(own: tuple[float, float] | None, other: tuple[float, float] | None, thickness: float) -> float:
    """How many of the ends of two edges, laid on each other, are together; those where an edge has none count as such."""
    if own is None or other is None:
        return 2.0
    return float(_together(np.array(own) - np.array(other), thickness).sum())


def _together(apart: Floats, thickness: float) -> NDArray[np.bool_]:
    apart = np.abs(apart)
    return ~(np.minimum(apart, np.abs(apart - thickness)) >= SAME_END * thickness)


def aligned_ends(panel_set: PanelSet, placed: Placement) -> float:
    """Sum of `ends_together` over all joints of a placement."""
    return sum(_joint_ends(panel_set, placed))


def _joint_ends(panel_set: PanelSet, placed: Placement) -> Iterator[float]:
    place = {row: k for k, row in enumerate(placed.rows)}
    for a, b, pairs in panel_set.met(placed)[0]:
        i, j = place[a], place[b]
        turn, move = placed.turns[i].T @ placed.turns[j], placed.turns[i].T @ (placed.moves[j] - placed.moves[i])
        for line in panel_set.plates[a].lines:
            met = pairs[np.isin(pairs[:, 0], line.rows)]
            other = next((each for each in panel_set.plates[b].lines if len(met) and met[0, 1] in each.rows), None)
            if other is None:
                continue
            own, its = edge_ends(panel_set.plates[a], line), edge_ends(panel_set.plates[b], other)
            if its is not None:
                points = np.outer(its, other.along) + other.offset * other.across
                first, last = ((points @ turn[:2, :2].T + move[:2]) @ line.along).tolist()
                its = (first, last) if other.along @ turn[:2, :2].T @ line.along > 0 else (last, first)
            yield ends_together(own, its, panel_set.plates[a].thickness)
