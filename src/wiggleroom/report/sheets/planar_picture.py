"""Picture of a sheet put together in the plane: its joints coloured and named on the sheet, and the result beside it."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.planar_assembly import PlanarAssembly
from wiggleroom.mating.planar_search import moved
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.sheets.planar_record import planar_headline
from wiggleroom.report.sheets.sheet_picture import (
    COLUMN_WIDTH,
    OPEN,
    PICTURE_HEIGHT,
    PICTURE_WIDTH,
    colour_of,
    fitted,
    halo_text,
    path_data,
    rings_of,
)

Floats = NDArray[np.float64]


def planar_picture(found: PlanarAssembly, *, command: str = "") -> str:
    """SVG text: left the sheet, right the bodies; red is a bent outline that meets nothing, dashed parts are not placed."""
    title = planar_headline(found)
    said = [*found.doubts] or ["nowhere did another place come near the one that was taken"]
    head, y = frame.header(title, said, PICTURE_WIDTH - 2 * palette.MARGIN)
    sheet, tall = _sheet(found, palette.MARGIN, y + 20)
    bodies, taller = _bodies(found, 2 * palette.MARGIN + COLUMN_WIDTH, y + 20)
    height = y + max(tall, taller) + 2 * palette.MARGIN
    return frame.document(PICTURE_WIDTH, height, title, said, command, [*head, sheet, bodies])


def _shape(polygon: shapely.Polygon, scale: float, shift: Floats, fill: str, dash: str = "") -> str:
    return (
        f'<path d="{path_data(rings_of(polygon), scale, shift)}" fill="{fill}" fill-rule="evenodd" '
        f'stroke="{palette.NEUTRAL[1]}" stroke-width="0.8"{dash}/>'
    )


def _sheet(found: PlanarAssembly, x: float, y: float) -> tuple[str, float]:
    """The sheet as drawn, and its height [px]."""
    drawn = [
        shapely.transform(polygon, lambda points, centre=centre: points + centre)
        for polygon, centre in zip(found.outlines, found.centres, strict=True)
    ]
    low, high = np.array(shapely.total_bounds(drawn)).reshape(2, 2)
    scale, shift = fitted(np.array([low, high]), x, y)
    lines = ["<g>"]
    for row, polygon in enumerate(drawn):
        loose = row in found.unplaced
        fill = palette.PAPER if loose else palette.NEUTRAL[0]
        lines.append(_shape(polygon, scale, shift, fill, ' stroke-dasharray="4 3"' if loose else ""))
        px, py = np.array(shapely.get_coordinates(polygon.representative_point())[0]) * (scale, -scale) + shift
        lines.append(halo_text(px, py, found.names[row], palette.INK, 10.0))
    for points in found.open.values():
        for px, py in points[::3] * (scale, -scale) + shift:
            lines.append(f'<circle cx="{px:.2f}" cy="{py:.2f}" r="1.2" fill="{OPEN}"/>')
    for k, joint in enumerate(found.joints):
        for point in joint.on_sheet:
            px, py = point * (scale, -scale) + shift
            lines.append(f'<circle cx="{px:.2f}" cy="{py:.2f}" r="2.5" fill="{colour_of(k)}"/>')
            lines.append(halo_text(px, py - 8, f"J{k + 1}", colour_of(k), 8.0))
    return "\n".join([*lines, "</g>"]), float(min(PICTURE_HEIGHT, scale * (high[1] - low[1])))


def _bodies(found: PlanarAssembly, x: float, y: float) -> tuple[str, float]:
    """The parts where they belong, and the height of that [px]."""
    placed = {row: moved(found.outlines[row], pose) for body in found.bodies for row, pose in body.items()}
    if not placed:
        return "", 0.0
    low, high = np.array(shapely.total_bounds(list(placed.values()))).reshape(2, 2)
    scale, shift = fitted(np.array([low, high]), x, y)
    lines = ["<g>"]
    for row, polygon in placed.items():
        lines.append(_shape(polygon, scale, shift, palette.NEUTRAL[0]))
        px, py = np.array(shapely.get_coordinates(polygon.representative_point())[0]) * (scale, -scale) + shift
        lines.append(halo_text(px, py, found.names[row], palette.INK, 10.0))
    return "\n".join([*lines, "</g>"]), float(min(PICTURE_HEIGHT, scale * (high[1] - low[1])))
