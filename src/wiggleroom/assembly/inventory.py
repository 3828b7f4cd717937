"""Parts of a drawing as a list: where they lie, how large they are, what holes they have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.assembly.assembly import place
from wiggleroom.drawing.model import Drawing


@dataclass(frozen=True)
class InventoryRow:
    """One part as drawn.

    Parameters
    ----------
    name, layer : str
    x, y : float [mm]
        Its reference point.
    width, height : float [mm]
        Of the box round it.
    area : float [mm2]
    pieces, holes : int
    fixed : bool
    """

    name: str
    layer: str
    x: float
    y: float
    width: float
    height: float
    area: float
    pieces: int
    holes: int
    fixed: bool


def inventory(drawing: Drawing, layers: Sequence[str] = ()) -> tuple[InventoryRow, ...]:
    """All parts in order.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    >>> row = inventory(Drawing((Part("a", (square,)),)))[0]
    >>> row.width, row.height, row.area, row.holes
    (2.0, 1.0, 2.0, 0)
    """
    rows = []
    for part, layer in zip(drawing.parts, layers or [""] * len(drawing.parts), strict=True):
        corners = np.vstack([place(region.outer, part.at) for region in part.regions])
        width, height = np.ptp(corners, axis=0).tolist()
        area = sum(shapely.Polygon(r.outer).area - sum(shapely.Polygon(h).area for h in r.holes) for r in part.regions)
        holes = sum(len(region.holes) for region in part.regions)
        x, y = part.at[:2]
        rows.append(
            InventoryRow(part.name, layer, x, y, width, height, float(area), len(part.regions), holes, part.fixed)
        )
    return tuple(rows)
