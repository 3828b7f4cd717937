"""Pairs of parts in space whose boxes meet."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.writers.glue_groups import collidable


def meeting_pairs(assembly: Assembly, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Parts that are neither glued nor ignored and whose boxes, from `low` (n, 3) to `high` (n, 3) [mm], meet."""
    i, j = shapely.STRtree(flat := shapely.box(*low[:, :2].T, *high[:, :2].T)).query(flat)
    keep = (i < j) & (low[i, 2] <= high[j, 2]) & (low[j, 2] <= high[i, 2])
    names, may = assembly.names, collidable(assembly.drawing.glue, assembly.drawing.ignore)
    both = sorted(zip(i[keep].tolist(), j[keep].tolist(), strict=True))
    return [(a, b) for a, b in both if may(names[a], names[b])]
