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


def size_of(drawing: Drawing) -> tuple[float, float]:
    """Width and height of the box round all parts as drawn [mm].

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    >>> size_of(Drawing((Part("a", (square,)), Part("b", (square,), at=(5.0, 0.0, 0.0)))))
    (7.0, 1.0)
    """
    if not drawing.parts:
        return 0.0, 0.0
    corners = np.vstack([place(region.outer, part.at) for part in drawing.parts for region in part.regions])
    width, height = np.ptp(corners, axis=0).tolist()
    return width, height


def size_lines(drawing: Drawing) -> tuple[str, ...]:
    """One line with the size of a drawing and how many parts it has; none for an assembly file, which says its own unit.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    >>> size_lines(Drawing((Part("a", (square,)),), source="a.svg"))
    ('a.svg: drawing 2 x 1 mm, 1 part',)
    """
    if drawing.source.lower().endswith(".json"):
        return ()
    (width, height), count = size_of(drawing), len(drawing.parts)
    return (f"{drawing.source}: drawing {width:.4g} x {height:.4g} mm, {count} {'part' if count == 1 else 'parts'}",)
