"""The free space of a pair, for the page: its slices stacked to a solid of triangles."""

from __future__ import annotations

import base64
import math
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.analysis.audit import about_pivot
from wiggleroom.app.command import command
from wiggleroom.app.messages import Json, Space
from wiggleroom.app.out import Out
from wiggleroom.freespace.space import FreeSpace, free_space
from wiggleroom.report.space import headline, said
from wiggleroom.report.words import number

if TYPE_CHECKING:
    from wiggleroom.app.sheet import Sheet

Floats = NDArray[np.float64]

TALL = 1.15
"""Height of the solid over its longer side, as in pictures."""
MOST_TILES = 33
"""Slices that the page is given."""


def space(sheet: Sheet, request: Space, out: Out) -> None:
    """How one part can move against another."""
    assembly = sheet.assembly(request.design)
    found = free_space(assembly, request.a, request.b, stop=out.stop)
    out.check()
    content = solid(found)
    if not found.closed:
        words = f"it has no end: looked at as far as {number(found.reach, 3)} mm"
        content |= {"open": True, "words": words}
    content |= {
        "a": request.a,
        "b": request.b,
        "headline": headline(found),
        "facts": said(found, None),
        "pivot": found.pivot.tolist(),
        "state": sheet.moves.relative(found),
        "model": "walls",
        "command": command("space", sheet.file, request.design, (request.a, request.b), pulled=False),
    }
    out.reply(content)


def solid(found: FreeSpace) -> Json:
    """Solid over x [mm], y [mm] and angle [deg], in motions of the pivot; `scale` is how many mm a degree is tall."""
    regions, angles = about_pivot(found), np.degrees([s.angle for s in found.slices])
    bounds = np.array([r.bounds for r in regions])
    side = float((bounds[:, 2:].max(axis=0) - bounds[:, :2].min(axis=0)).max())
    low, high = (math.degrees(a) for a in found.angles)
    between = (angles[1:] + angles[:-1]) / 2
    levels = np.concatenate([[low], between, [high]])
    vertices, triangles = _stacked(regions, levels)
    shown = np.unique(np.linspace(0, len(regions) - 1, min(len(regions), MOST_TILES)).round().astype(int))
    return {
        "vertices": base64.b64encode(vertices.astype("<f4").tobytes()).decode(),
        "triangles": base64.b64encode(triangles.astype("<u4").tobytes()).decode(),
        "slices": [{"angle_deg": float(angles[k]), "rings": _rings(regions[k])} for k in shown.tolist()],
        "range_deg": [low, high],
        "scale": TALL * side / (high - low) if high > low else 1.0,
    }


def _rings(region: shapely.Geometry) -> list[list[list[float]]]:
    return [
        shapely.get_coordinates(ring)[:-1].tolist()
        for piece in shapely.get_parts(region)
        for ring in (piece.exterior, *piece.interiors)
    ]


def _stacked(regions: list[shapely.Geometry], levels: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (v, 3) and triangles (t, 3) of prisms over regions between levels, seen from outside counter-clockwise."""
    points: list[Floats] = []
    faces: list[NDArray[np.int64]] = []
    count = 0
    for region, below, above in zip(regions, levels[:-1], levels[1:], strict=True):
        for piece in shapely.get_parts(region):
            rings = [shapely.get_coordinates(r)[:-1] for r in (piece.exterior, *piece.interiors)]
            for ring, outer in zip(rings, [True] + [False] * (len(rings) - 1), strict=True):
                turned = ring if shapely.is_ccw(shapely.linearrings(ring)) == outer else ring[::-1]
                n = len(turned)
                points += [_at(turned, below), _at(turned, above)]
                i, j = np.arange(n), (np.arange(n) + 1) % n
                walls = np.concatenate([np.column_stack([i, j, j + n]), np.column_stack([i, j + n, i + n])])
                faces.append(walls + count)
                count += 2 * n
        cut = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
        if not len(cut):
            continue
        corners = np.array([shapely.get_coordinates(shapely.orient_polygons(t))[:3] for t in cut])
        flat, rows = corners.reshape(-1, 2), np.arange(3 * len(cut)).reshape(-1, 3)
        points += [_at(flat, below), _at(flat, above)]
        faces += [rows[:, ::-1] + count, rows + count + len(flat)]
        count += 2 * len(flat)
    return np.vstack(points), np.vstack(faces)


def _at(flat: Floats, level: float) -> Floats:
    return np.column_stack([flat, np.full(len(flat), level)])
