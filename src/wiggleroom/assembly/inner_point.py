"""A point well inside a part, for arrows and numbers."""

from __future__ import annotations

import numpy as np
import shapely

from wiggleroom.assembly.assembly import Assembly, place


def inner_point(assembly: Assembly, name: str) -> tuple[float, float]:
    """A point inside a part at rest [mm], as far from its outline as any: its reference point may lie anywhere."""
    part = assembly.parts[assembly.names.index(name)]
    largest = max(part.regions, key=lambda region: np.ptp(region.outer, axis=0).sum())
    outer, *holes = (place(ring, part.at) for ring in (largest.outer, *largest.holes))
    shape = shapely.Polygon(outer, holes)
    middle = shapely.maximum_inscribed_circle(shape, tolerance=0.02 * float(np.ptp(outer, axis=0).max()))
    at = shapely.get_coordinates(middle)[0]
    return float(at[0]), float(at[1])
