"""Picture of a cutting sheet put together: its joints coloured and named on the sheet, and the result from aside."""

from __future__ import annotations

import colorsys

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.mating.panel_outline import inset
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.sheets.sheet_record import on_sheet, sheet_headline

Floats = NDArray[np.float64]

PICTURE_WIDTH = 1120.0
"""[px]"""
COLUMN_WIDTH = (PICTURE_WIDTH - 3 * palette.MARGIN) / 2
"""Of the sheet, and of the bodies beside it [px]."""
PICTURE_HEIGHT = 760.0
"""[px]"""
OPEN = "#d00000"
_VIEW = np.array([[0.82, 0.57, 0.0], [-0.27, 0.39, 0.88], [0.5, -0.72, 0.48]])
"""Rows: where the picture's right, its up and the eye lie in space."""


def sheet_picture(found: AssembledSheet, *, command: str = "") -> str:
    """SVG text: left the sheet, right the bodies; red crosses are flanks that meet nothing, hatched panels are not placed."""
    title = sheet_headline(found)
    said = [*found.reasons] or ["every flank meets another, and no other way to put the panels together does as well"]
    head, y = frame.header(title, said, PICTURE_WIDTH - 2 * palette.MARGIN)
    body = [*head, _sheet(found, palette.MARGIN, y + 20), _bodies(found, 2 * palette.MARGIN + COLUMN_WIDTH, y + 20)]
    return frame.document(PICTURE_WIDTH, y + PICTURE_HEIGHT + 2 * palette.MARGIN, title, said, command, body)


GOLDEN = 0.618034
"""Share of the circle of hues between one row and the next: so colours stay apart however many there are."""


def colour_of(k: int) -> str:
    """Colour of joint `k`."""
    return _colour((0.07 + GOLDEN * k) % 1.0, 0.40, 0.65)


def fitted(points: Floats, x: float, y: float) -> tuple[float, Floats]:
    """Scale, and the shift of points with y up that fits them into one half of the picture."""
    low, high = points.min(axis=0), points.max(axis=0)
    scale = min(COLUMN_WIDTH / max(high[0] - low[0], 1e-9), PICTURE_HEIGHT / max(high[1] - low[1], 1e-9))
    return scale, np.array([x - scale * low[0], y + scale * high[1]])


def path_data(rings: list[Floats], scale: float, shift: Floats) -> str:
    """Closed rings (n, 2) [mm] as the data of an SVG path."""
    moved = [ring * (scale, -scale) + shift for ring in rings]
    return "".join("M" + "L".join(f"{px:.2f},{py:.2f}" for px, py in ring) + "Z" for ring in moved)


def rings_of(polygon: shapely.Polygon) -> list[Floats]:
    """Outer ring and holes (n, 2) [mm], the first corner not repeated."""
    return [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]


def _sheet(found: AssembledSheet, x: float, y: float) -> str:
    rings = [[ring + plate.centre for ring in rings_of(plate.polygon)] for plate in found.plates]
    scale, shift = fitted(np.vstack([ring for panel in rings for ring in panel]), x, y)
    lines = ["<g>"]
    for row, (plate, panel) in enumerate(zip(found.plates, rings, strict=True)):
        fill, dash = (palette.PAPER, ' stroke-dasharray="4 3"') if row in found.unplaced else (palette.NEUTRAL[0], "")
        lines.append(
            f'<path d="{path_data(panel, scale, shift)}" fill="{fill}" fill-rule="evenodd" stroke="{palette.NEUTRAL[1]}"{dash}/>'
        )
        px, py = plate.centre * (scale, -scale) + shift
        lines.append(halo_text(px, py, plate.name, palette.INK, 10.0))
    for k, joint in enumerate(found.joints):
        colour = colour_of(k)
        for side, row in enumerate(joint.panels):
            points = on_sheet(found, row, joint.flanks[:, side]) * (scale, -scale) + shift
            lines += [f'<circle cx="{px:.2f}" cy="{py:.2f}" r="2" fill="{colour}"/>' for px, py in points]
            inner = points.mean(axis=0)
            centre = found.plates[row].centre * (scale, -scale) + shift
            away = centre - inner
            inner = inner + away / max(float(np.hypot(*away)), 1e-9) * 9.0
            lines.append(halo_text(inner[0], inner[1], f"J{k + 1}", colour, 8.0))
    for row, flanks in found.open.items():
        for px, py in on_sheet(found, row, flanks) * (scale, -scale) + shift:
            cross = f"M{px - 3:.2f},{py - 3:.2f}l6,6m0,-6l-6,6"
            lines.append(f'<path d="{cross}" stroke="{OPEN}" stroke-width="1.5" fill="none"/>')
    return "\n".join([*lines, "</g>"])


def halo_text(x: float, y: float, text: str, colour: str, size: float) -> str:
    """Text with a halo, centred."""
    return (
        f'<text x="{x:.2f}" y="{y + size / 3:.2f}" font-size="{size:g}" text-anchor="middle" fill="{colour}" '
        f'stroke="{palette.PAPER}" stroke-width="2" paint-order="stroke">{escape(text)}</text>'
    )


def _bodies(found: AssembledSheet, x: float, y: float) -> str:
    """Faces drawn back to front (painter's algorithm)."""
    faces: list[tuple[float, list[Floats], str]] = []
    for body in found.bodies:
        for row, turn, move in zip(body.rows, body.turns, body.moves, strict=True):
            faces += _faces(found, row, turn, move)
    if not faces:
        return ""
    scale, shift = fitted(np.vstack([ring for _, rings, _ in faces for ring in rings]), x, y)
    faces.sort(key=lambda face: face[0])
    drawn = [
        f'<path d="{path_data(rings, scale, shift)}" fill="{fill}" fill-rule="evenodd" stroke="{palette.INK}" '
        'stroke-width="0.5" stroke-linejoin="round"/>'
        for _, rings, fill in faces
    ]
    return "\n".join(["<g>", *drawn, "</g>"])


def _faces(found: AssembledSheet, row: int, turn: Floats, move: Floats) -> list[tuple[float, list[Floats], str]]:
    """Depth, rings in the picture and colour of the sides of a plate that face the eye."""
    plate, half = found.plates[row], found.thickness[row] / 2
    right_up, eye = _VIEW[:2], _VIEW[2]
    hue = (0.1 + GOLDEN * row) % 1.0
    faces = []
    rings = rings_of(inset(plate.polygon, found.relief))
    normal = turn[:, 2]
    side = 1.0 if normal @ eye > 0 else -1.0
    spatial = [np.column_stack([ring, np.full(len(ring), side * half)]) @ turn.T + move for ring in rings]
    depth = float(np.mean(spatial[0] @ eye))
    faces.append((depth, [ring @ right_up.T for ring in spatial], _shade(hue, abs(float(normal @ eye)))))
    for ring in rings:
        here, there = ring, np.roll(ring, -1, axis=0)
        outward = np.column_stack([there[:, 1] - here[:, 1], here[:, 0] - there[:, 0], np.zeros(len(here))]) @ turn.T
        for k in np.flatnonzero(outward @ eye > 0).tolist():
            corners = np.array([[*here[k], -half], [*there[k], -half], [*there[k], half], [*here[k], half]])
            quad = corners @ turn.T + move
            light = float(outward[k] @ eye) / max(float(np.linalg.norm(outward[k])), 1e-9)
            faces.append((float(np.mean(quad @ eye)), [quad @ right_up.T], _shade(hue, 0.8 * light)))
    return faces


def _shade(hue: float, light: float) -> str:
    return _colour(hue, 0.62 + 0.28 * min(1.0, light), 0.45)


def _colour(hue: float, lightness: float, saturation: float) -> str:
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, saturation)
    return f"#{int(255 * red):02x}{int(255 * green):02x}{int(255 * blue):02x}"
