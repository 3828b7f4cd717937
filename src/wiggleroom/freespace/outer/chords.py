"""Chords: straight segments inside a part, a little behind its edges.

Where a chord of A crosses a chord of B, A and B overlap. Chords run on beyond the ends of their edge until they meet the boundary, so that
at a corner there is always one that crosses.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.outer.outer_slices import corners_of

Floats = NDArray[np.float64]

END_MARGIN = 0.02
"""Distance of a chord's ends from the boundary, as a share of its depth behind its edge."""


def chords(material: shapely.Geometry, inset: float, beyond: float) -> Floats:
    """Chords (k, 2, 2) [mm], `inset` behind each edge and at most `beyond` longer at either end; none for edges of what is thinner."""
    start, end, _, go = corners_of(material)
    inward = np.column_stack([-go[:, 1], go[:, 0]])
    middle = (start + end) / 2 + inset * inward
    lines = np.stack([start + inset * inward - beyond * go, end + inset * inward + beyond * go], 1)
    pieces, which = shapely.get_parts(shapely.intersection(shapely.linestrings(lines), material), return_index=True)
    mine = shapely.dwithin(pieces, shapely.points(middle)[which], 1e-3 * inset)
    mine &= shapely.get_type_id(pieces) == shapely.GeometryType.LINESTRING
    pieces, which = pieces[mine], which[mine]
    _, first = np.unique(which, return_index=True)
    pieces = pieces[first]
    ends = np.stack([shapely.get_coordinates(shapely.get_point(pieces, k)) for k in (0, -1)], 1)
    edge = ends[:, 1] - ends[:, 0]
    long = np.hypot(*edge.T)
    ends, edge, long = ends[long > inset], edge[long > inset], long[long > inset]
    back = END_MARGIN * inset * edge / long[:, None]
    return np.stack([ends[:, 0] + back, ends[:, 1] - back], 1)
