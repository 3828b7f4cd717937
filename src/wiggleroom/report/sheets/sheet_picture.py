"""Picture of a cutting sheet put together: its joints coloured and named on the sheet, and the result from aside."""

from __future__ import annotations

import colorsys

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part, Plate, Region, Surface
from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.mating.panel_outline import inset
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.sheets.sheet_record import on_sheet, sheet_headline
from wiggleroom.report.solids.hidden_surfaces import camera, drawn_facets, seen_facets
from wiggleroom.report.solids.solid_colours import Colour
from wiggleroom.spatial.solids.made_solids import drawn_surface

Floats = NDArray[np.float64]

PICTURE_WIDTH = 1120.0
"""[px]"""
COLUMN_WIDTH = (PICTURE_WIDTH - 3 * palette.MARGIN) / 2
"""Of the sheet, and of the bodies beside it [px]."""
PICTURE_HEIGHT = 760.0
"""[px]"""
OPEN = "#d00000"
WIDE = 1.6
"""A sheet that is so much wider than high lies above the bodies."""


def sheet_picture(found: AssembledSheet, *, command: str = "") -> str:
    """SVG text: the sheet, and the bodies beside or below it; red crosses are flanks that meet nothing, hatched panels are not placed."""
    title = sheet_headline(found)
    said = [*found.reasons] or ["every flank meets another, and no other way to put the panels together does as well"]
    head, y = frame.header(title, said, PICTURE_WIDTH - 2 * palette.MARGIN)
    corners = np.vstack([plate.centre + ring for plate in found.plates for ring in rings_of(plate.polygon)])
    wide, high = np.ptp(corners, axis=0)
    below = wide > WIDE * high
    width = PICTURE_WIDTH - 2 * palette.MARGIN if below else COLUMN_WIDTH
    drawn, far = _sheet(found, palette.MARGIN, y + 20, width)
    if below:
        bodies, further = _bodies(found, palette.MARGIN, y + 20 + far + 40, width)
        foot = y + 20 + far + 40 + further
    else:
        bodies, further = _bodies(found, 2 * palette.MARGIN + COLUMN_WIDTH, y + 20, width)
        foot = y + 20 + max(far, further)
    return frame.document(PICTURE_WIDTH, foot + palette.MARGIN, title, said, command, [*head, drawn, bodies])


GOLDEN = 0.618034
"""Share of the circle of hues between one row and the next: so colours stay apart however many there are."""


def colour_of(k: int) -> str:
    """Colour of joint `k`."""
    return _colour((0.07 + GOLDEN * k) % 1.0, 0.40, 0.65)


def fitted(points: Floats, x: float, y: float, width: float = COLUMN_WIDTH) -> tuple[float, Floats]:
    """Scale, and the shift of points with y up that fits them into so much of the picture, by default one half."""
    low, high = points.min(axis=0), points.max(axis=0)
    scale = min(width / max(high[0] - low[0], 1e-9), PICTURE_HEIGHT / max(high[1] - low[1], 1e-9))
    return scale, np.array([x - scale * low[0], y + scale * high[1]])


def path_data(rings: list[Floats], scale: float, shift: Floats) -> str:
    """Closed rings (n, 2) [mm] as the data of an SVG path."""
    moved = [ring * (scale, -scale) + shift for ring in rings]
    return "".join("M" + "L".join(f"{px:.2f},{py:.2f}" for px, py in ring) + "Z" for ring in moved)


def rings_of(polygon: shapely.Polygon) -> list[Floats]:
    """Outer ring and holes (n, 2) [mm], the first corner not repeated."""
    return [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]


def _sheet(found: AssembledSheet, x: float, y: float, width: float) -> tuple[str, float]:
    """The sheet, and how high it is [px]: names of panels keep away from those of their joints."""
    rings = [[ring + plate.centre for ring in rings_of(plate.polygon)] for plate in found.plates]
    corners = np.vstack([ring for panel in rings for ring in panel])
    scale, shift = fitted(corners, x, y, width)
    lines = ["<g>"]
    for row, panel in enumerate(rings):
        fill, dash = (palette.PAPER, ' stroke-dasharray="4 3"') if row in found.unplaced else (palette.NEUTRAL[0], "")
        lines.append(
            f'<path d="{path_data(panel, scale, shift)}" fill="{fill}" fill-rule="evenodd" stroke="{palette.NEUTRAL[1]}"{dash}/>'
        )
    taken: list[list[shapely.Geometry]] = [[] for _ in found.plates]
    words = []
    for k, joint in enumerate(found.joints):
        colour = colour_of(k)
        for side, row in enumerate(joint.panels):
            points = on_sheet(found, row, joint.flanks[:, side]) * (scale, -scale) + shift
            lines += [f'<circle cx="{px:.2f}" cy="{py:.2f}" r="2" fill="{colour}"/>' for px, py in points]
            panel = shapely.Polygon(
                rings[row][0] * (scale, -scale) + shift, [r * (scale, -scale) + shift for r in rings[row][1:]]
            )
            taken[row] += [shapely.Point(*p).buffer(3.0) for p in points]
            px, py = _free_place(panel, taken[row], points.mean(axis=0), (12.0, 9.0))
            taken[row].append(shapely.box(px - 7.0, py - 5.0, px + 7.0, py + 5.0))
            words.append(halo_text(px, py, f"J{k + 1}", colour, 8.0))
    for row, plate in enumerate(found.plates):
        panel = shapely.Polygon(
            rings[row][0] * (scale, -scale) + shift, [r * (scale, -scale) + shift for r in rings[row][1:]]
        )
        long = 6.0 * len(plate.name) + 10.0
        px, py = _free_place(panel, taken[row], plate.centre * (scale, -scale) + shift, (long, 22.0))
        words.append(halo_text(px, py, plate.name, palette.INK, 10.0))
    for row, flanks in found.open.items():
        for px, py in on_sheet(found, row, flanks) * (scale, -scale) + shift:
            cross = f"M{px - 3:.2f},{py - 3:.2f}l6,6m0,-6l-6,6"
            lines.append(f'<path d="{cross}" stroke="{OPEN}" stroke-width="1.5" fill="none"/>')
    return "\n".join([*lines, *words, "</g>"]), float(scale * np.ptp(corners[:, 1]))


def _free_place(
    panel: shapely.Polygon, taken: list[shapely.Geometry], near: Floats, size: tuple[float, float]
) -> tuple[float, float]:
    """Where a word of a size [px] lies in a panel, as near as possible to a point and on nothing else; where it is least in the way."""
    low_x, low_y, high_x, high_y = panel.bounds
    step = max(4.0, (high_x - low_x + high_y - low_y) / 80)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(low_x, high_x, step), np.arange(low_y, high_y, step)))
    x, y = np.append(x, near[0]), np.append(y, near[1])
    boxes = shapely.box(x - size[0] / 2, y - size[1] / 2, x + size[0] / 2, y + size[1] / 2)
    outside = shapely.area(shapely.difference(boxes, panel)) / shapely.area(boxes)
    covered = (
        shapely.area(shapely.intersection(boxes, shapely.union_all(taken))) / shapely.area(boxes) if taken else 0.0
    )
    away = np.hypot(x - near[0], y - near[1]) / max(np.hypot(high_x - low_x, high_y - low_y), 1e-9)
    best = int(np.argmin(away + 4 * covered + 2 * outside))
    return float(x[best]), float(y[best])


def halo_text(x: float, y: float, text: str, colour: str, size: float) -> str:
    """Text with a halo, centred."""
    return (
        f'<text x="{x:.2f}" y="{y + size / 3:.2f}" font-size="{size:g}" text-anchor="middle" fill="{colour}" '
        f'stroke="{palette.PAPER}" stroke-width="2" paint-order="stroke">{escape(text)}</text>'
    )


def _bodies(found: AssembledSheet, x: float, y: float, width: float) -> tuple[str, float]:
    """The bodies as they are seen, and how high they are [px]."""
    surfaces, colours = [], []
    for body in found.bodies:
        for row, turn, move in zip(body.rows, body.turns, body.moves, strict=True):
            surfaces.append(_plate_at(found, row, turn, move))
            colours.append(_rgb((0.1 + GOLDEN * row) % 1.0, 0.78, 0.45))
    if not surfaces:
        return "", 0.0
    _, across, up = camera()
    right_up = np.column_stack([across, up])
    flat = np.vstack([surface.vertices @ right_up for surface in surfaces])
    scale, shift = fitted(flat, x + (width - COLUMN_WIDTH) / 2, y)
    drawn = drawn_facets(seen_facets(surfaces, colours), lambda points: points @ right_up * (scale, -scale) + shift)
    return "\n".join(["<g>", *drawn, "</g>"]), float(scale * np.ptp(flat[:, 1]))


def _plate_at(found: AssembledSheet, row: int, turn: Floats, move: Floats) -> Surface:
    """A plate where it has been put, its edges shaved as those of what is written."""
    plate = Plate((_region(inset(found.plates[row].polygon, found.relief)),), found.thickness[row])
    flat = drawn_surface(Part(found.plates[row].name, solid=plate))
    return Surface((flat.vertices - (0.0, 0.0, found.thickness[row] / 2)) @ turn.T + move, flat.faces)


def _region(polygon: shapely.Polygon) -> Region:
    outer, *holes = rings_of(polygon)
    return Region(outer, tuple(holes))


def _colour(hue: float, lightness: float, saturation: float) -> str:
    return "#" + "".join(f"{c:02x}" for c in _rgb(hue, lightness, saturation))


def _rgb(hue: float, lightness: float, saturation: float) -> Colour:
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, saturation)
    return int(255 * red), int(255 * green), int(255 * blue)
