"""Parts a little larger than those of an assembly, and more symmetric: what these can do, the parts can do as well.

The teeth of a gear repeat, its bore drawn with another number of corners does not; and coordinates in a file have few digits. In the
cover, bores are regular polygons inside the drawn ones, other holes are filled, and outlines lie further out by more than what they
differ from their images by.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Part, Region
from wiggleroom.geometry.rotational_symmetry import symmetry_order

Floats = NDArray[np.float64]

MAX_ASYMMETRY = 0.01
"""Images of an outline that differ from it by less than this share of the clearance are covered."""
MAX_BORE_LOSS = 0.05
"""Share of the clearance that a bore may lose besides."""
MAX_BORE_CORNERS = 400
"""Corners that a bore made round may have, but for what its symmetry needs."""
MIN_ROUNDNESS = 0.8
"""A hole is a bore where the largest circle in it about the middle has this share of its radius."""


def symmetric_cover(assembly: Assembly, clearance: float, exact: float) -> tuple[Assembly, tuple[int, ...]] | None:
    """The assembly with free parts covered by more symmetric ones, and the order of the symmetry of every part.

    Parameters
    ----------
    assembly : Assembly
    clearance : float [mm]
        Typical clearance between neighbours.
    exact : float [mm]
        Differences that count as none.

    Returns
    -------
    Assembly and orders, or None
        None where no free part is symmetric but for its holes and some digits. Between each part and its cover lies an outline of
        exactly this symmetry about the cover's centroid: the union of the part's images, with the cover's holes.
    """
    glued = {name for names in assembly.drawing.glue for name in names}
    covers = [
        (part, 1) if part.fixed or part.name in glued or len(part.regions) > 1 else _cover(part, clearance, exact)
        for part in assembly.parts
    ]
    if all(order == 1 for _, order in covers):
        return None
    parts = tuple(cover for cover, _ in covers)
    return replace(assembly, parts=parts), tuple(order for _, order in covers)


def _cover(part: Part, clearance: float, exact: float) -> tuple[Part, int]:
    """A part's cover and its order; the part itself and 1 where it has none that is more symmetric."""
    region, allowed = part.regions[0], MAX_ASYMMETRY * clearance
    outer = region.outer
    order = _order(outer, allowed)
    if order == 1:
        return part, 1
    if _order(outer, exact) != order:
        outer = _grown(outer, 2 * allowed)
        if _order(region.outer, 2 * allowed, _middle(outer)) % order:
            return part, 1
    middle = _middle(outer)
    bores = (_bore(hole, middle, order, clearance) for hole in region.holes)
    return replace(part, regions=(Region(outer, tuple(bore for bore in bores if bore is not None)),)), order


def _middle(ring: Floats) -> Floats:
    return np.array(shapely.Polygon(ring).centroid.coords[0])


def _order(ring: Floats, tolerance: float, middle: Floats | None = None) -> int:
    """Order of the symmetry of a ring about a point, by default its centroid."""
    after = np.roll(np.arange(len(ring)), -1)
    return symmetry_order(ring - (_middle(ring) if middle is None else middle), after, tolerance)


def _bore(hole: Floats, middle: Floats, order: int, clearance: float) -> Floats | None:
    """A regular polygon in a hole (m, 2), clockwise; None where the hole is not round about the middle: it is filled."""
    ring = shapely.Polygon(hole)
    radius = shapely.distance(ring.exterior, shapely.Point(middle))
    if not shapely.contains_xy(ring, *middle) or radius < MIN_ROUNDNESS * np.hypot(*(hole - middle).T).max():
        return None
    least = np.pi / np.sqrt(2 * MAX_BORE_LOSS * clearance / radius)
    count = order * int(np.ceil(max(least, 12) / order))
    if count > max(MAX_BORE_CORNERS, order):
        return None
    angle = -2 * np.pi * np.arange(count) / count
    return np.asarray(middle + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def _grown(ring: Floats, outward: float) -> Floats:
    """An outline further out, with mitred corners."""
    wider = shapely.buffer(shapely.Polygon(ring), outward, join_style="mitre", mitre_limit=100.0)
    return np.asarray(shapely.orient_polygons(wider).exterior.coords)[:-1]
