"""A free space as a solid: its slices stacked by angle and seen from above, a little from the side."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compare.monte_carlo import about_pivot
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.axes import text
from wiggleroom.report.results.answer_words import number

Floats = NDArray[np.float64]

AZIMUTH, ELEVATION = math.radians(-32.0), math.radians(24.0)
SIZE = 300.0
"""Longer side of the slices, and the height of the stack is 1.15 of it [px]."""
HEIGHT_RATIO = 1.15
"""Height of the stack, as a multiple of that."""
LIGHT = np.array([math.cos(math.radians(200.0)), math.sin(math.radians(200.0))])
SHADED, LIT = "#1d4f80", "#b4d6f2"
"""In the shade and in full light."""
SIMPLIFY_TOLERANCE = 0.3
"""Corners that change an outline by less than this [px] are not drawn."""
INK_INTERVAL = 8
"""One in this many slices has its outline inked."""


def stack(space: FreeSpace, left: float, top: float) -> tuple[str, float, float]:
    """Drawing of the solid with its axes, and the width and height it takes [px].

    Parameters
    ----------
    left, top : float [px]
        Where its upper left corner goes.

    Notes
    -----
    Prisms are painted from the lowest up, and the walls of each from the farthest to the nearest: seen from above,
    what is painted later is in front.

    Source: the views of Mind the Gap, Figs 2 and 7.
    """
    regions = about_pivot(space)
    low, high = slices_box(regions)
    scale = SIZE / float((high - low).max())
    middle, (first, last) = (low + high) / 2, space.angles
    levels = (edges(space) - first) / (last - first) * HEIGHT_RATIO * SIZE
    box = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
    corners = np.vstack([_seen((box - middle) * scale, z) for z in (0.0, levels[-1])])
    shift = np.array([left + 70, top + 24]) - corners.min(axis=0)
    wide, tall = corners.max(axis=0) - corners.min(axis=0)
    found = [_floor(low, high, middle, scale, shift)]
    rest = int(np.abs([s.angle for s in space.slices]).argmin())
    for k, region in enumerate(regions):
        ink = 0.9 if k == rest else 0.35 if k % INK_INTERVAL == 0 or k == len(regions) - 1 else 0.0
        found.append(_prism(region, middle, scale, levels[k], levels[k + 1], shift, ink))
    found += _labels(low, high, middle, scale, levels, space.angles, shift)
    return "".join(found), float(wide) + 140, float(tall) + 50


def slices_box(regions: Sequence[shapely.Geometry]) -> tuple[Floats, Floats]:
    """Lower left and upper right corner of all slices [mm]."""
    bounds = np.array([r.bounds for r in regions])
    return bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)


def edges(space: FreeSpace) -> Floats:
    """Angles at which the slices begin, and where the last one ends [rad]."""
    angles, (first, last) = np.array([s.angle for s in space.slices]), space.angles
    return np.concatenate([[first], (angles[1:] + angles[:-1]) / 2, [last]])


def rings(region: shapely.Geometry) -> list[Floats]:
    """Rings (k, 2) [mm] of one slice, with the free space on the left; the first point is not said again."""
    found = []
    for piece in shapely.get_parts(region):
        for hole, ring in enumerate((piece.exterior, *piece.interiors)):
            points = shapely.get_coordinates(ring)[:-1]
            found.append(points[::-1] if shapely.is_ccw(ring) == (hole > 0) else points)
    return found


def _outlines(region: shapely.Geometry, middle: Floats, scale: float) -> list[Floats]:
    """Closed rings (k, 2) [px] of one slice about the middle of all."""
    flat = [shapely.linearrings((ring - middle) * scale) for ring in rings(region)]
    return [shapely.get_coordinates(shapely.simplify(ring, SIMPLIFY_TOLERANCE)) for ring in flat]


def _seen(points: Floats, level: float) -> Floats:
    """Points (k, 2) [px] at a height [px], as they are seen: x to the right, y down."""
    c, s = math.cos(AZIMUTH), math.sin(AZIMUTH)
    across, away = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    return np.column_stack([across, -math.sin(ELEVATION) * away - math.cos(ELEVATION) * level])


def _prism(
    region: shapely.Geometry, middle: Floats, scale: float, low: float, high: float, shift: Floats, ink: float
) -> str:
    """Walls and roof of one slice; its rim is drawn `ink` strong."""
    walls: list[tuple[float, str]] = []
    roof = ""
    for points in _outlines(region, middle, scale):
        floor, roofs = _seen(points, low) + shift, _seen(points, high) + shift
        roof += ("M" + "%.1f,%.1f " * (len(roofs) - 1)) % tuple(roofs[:-1].ravel().tolist()) + "z"
        depth = math.sin(AZIMUTH) * points[:, 0] + math.cos(AZIMUTH) * points[:, 1]
        for i in range(len(points) - 1):
            edge = points[i + 1] - points[i]
            outward = np.array([edge[1], -edge[0]]) / max(float(np.hypot(*edge)), 1e-12)
            if math.sin(AZIMUTH) * outward[0] + math.cos(AZIMUTH) * outward[1] >= 0:
                continue  # seen from behind: hidden by the roof and by nearer walls
            quad = np.concatenate([floor[i], floor[i + 1], roofs[i + 1], roofs[i]])
            colour = _shade(0.62 + 0.3 * float(outward @ LIGHT))
            path = "M{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}z".format(*quad.tolist())
            walls.append((float(depth[i] + depth[i + 1]), f'<path d="{path}" fill="{colour}" stroke="{colour}"/>'))
    walls.sort(key=lambda w: -w[0])
    rim = f' stroke="{palette.MOTION}" stroke-opacity="{ink}" stroke-width="{1.6 if ink > 0.5 else 0.8}"' if ink else ""
    return (
        f'<g stroke-width="0.6">{"".join(w for _, w in walls)}</g>'
        f'<path d="{roof}" fill="{_shade(1.0)}" fill-rule="evenodd"{rim}/>'
    )


def _shade(light: float) -> str:
    """Blue of pulled parts, darker where less light falls on it."""
    deep, clear = (np.array(list(bytes.fromhex(c[1:])), dtype=float) for c in (SHADED, LIT))
    mixed = deep + min(max(light, 0.0), 1.0) * (clear - deep)
    return "#" + bytes(round(c) for c in mixed.tolist()).hex()


def _floor(low: Floats, high: Floats, middle: Floats, scale: float, shift: Floats) -> str:
    """Rectangle under the solid, and the lines of x = 0 and y = 0 in it."""
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    rim = _path((corners - middle) * scale, shift, closed=True)
    lines = [[(low[0], 0.0), (high[0], 0.0)]] * bool(low[1] < 0 < high[1])
    lines += [[(0.0, low[1]), (0.0, high[1])]] * bool(low[0] < 0 < high[0])
    cross = "".join(_path((np.array(line) - middle) * scale, shift, closed=False) for line in lines)
    return (
        f'<path d="{rim}" fill="{palette.GRID}" fill-opacity="0.6" stroke="{palette.REST}"/>'
        f'<path d="{cross}" fill="none" stroke="{palette.REST}" stroke-dasharray="3 3"/>'
    )


def _path(points: Floats, shift: Floats, *, closed: bool) -> str:
    seen = _seen(points, 0.0) + shift
    return ("M" + "%.1f,%.1f " * len(seen)) % tuple(seen.ravel().tolist()) + ("z" if closed else "")


def _labels(
    low: Floats,
    high: Floats,
    middle: Floats,
    scale: float,
    levels: Floats,
    angles: tuple[float, float],
    shift: Floats,
) -> list[str]:
    """Ranges of x and y along the floor, and angles up the left side."""
    at = [((low[0] + high[0]) / 2, low[1]), (high[0], (low[1] + high[1]) / 2), (low[0], low[1])]
    (x0, y0), (x1, y1), (x2, y2) = (
        (_seen(np.array([p - middle]) * scale, 0.0)[0] + shift).tolist() for p in np.array(at)
    )
    size, found = palette.TEXT_SIZE, []
    found.append(text(x0 - 6, y0 + 24, size, palette.SUBDUED, f"x {_range(low[0], high[0])} mm", "end"))
    found.append(text(x1 + 8, y1 + 20, size, palette.SUBDUED, f"y {_range(low[1], high[1])} mm"))
    up = math.cos(ELEVATION) * float(levels[-1])
    found.append(f'<path d="M{x2 - 12:.1f},{y2:.1f}v{-up:.1f}" stroke="{palette.REST}" fill="none"/>')
    for angle in (angles[0], 0.0, angles[1]):
        y = y2 - up * (angle - angles[0]) / (angles[1] - angles[0])
        found.append(f'<path d="M{x2 - 16:.1f},{y:.1f}h8" stroke="{palette.REST}" fill="none"/>')
        found.append(text(x2 - 20, y + 5, size, palette.SUBDUED, f"{number(math.degrees(angle), 3)}°", "end"))
    return found


def _range(low: float, high: float) -> str:
    return f"{number(float(low), 2)} to {number(float(high), 2)}"
