"""The free space of a pair as the page reads it: its slices, and a solid of triangles stacked from them."""

from __future__ import annotations

import base64

import numpy as np
import shapely
from msgspec import UNSET
from numpy.typing import NDArray

from wiggleroom.compare.monte_carlo import about_pivot
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.report.answer_words import number
from wiggleroom.report.space_report import headline, said
from wiggleroom.report.stacked_slices import HEIGHT_RATIO, edges, extent, rings
from wiggleroom.schema.replies import SpaceReply, SpaceSlice

Floats = NDArray[np.float64]

MAX_SLICES = 33
"""Slices that the page is given."""


def space_message(found: FreeSpace, state: tuple[float, float, float], command: str) -> SpaceReply:
    """Free space of a pair, with the state (x [mm], y [mm], turn [deg]) that is shown in it.

    The solid stands over x [mm], y [mm] and angle [deg], in motions of the pivot.
    """
    regions, angles = about_pivot(found), np.degrees([s.angle for s in found.slices])
    low, high = extent(regions)
    levels = np.degrees(edges(found))
    first, last = float(levels[0]), float(levels[-1])
    vertices, triangles = _stacked(regions, levels)
    shown = np.unique(np.linspace(0, len(regions) - 1, min(len(regions), MAX_SLICES)).round().astype(int))
    a, b = found.parts
    return SpaceReply(
        a=a,
        b=b,
        vertices=base64.b64encode(vertices.astype("<f4").tobytes()).decode(),
        triangles=base64.b64encode(triangles.astype("<u4").tobytes()).decode(),
        slices=[SpaceSlice(float(angles[k]), [ring.tolist() for ring in rings(regions[k])]) for k in shown.tolist()],
        range_deg=(first, last),
        scale=HEIGHT_RATIO * float((high - low).max()) / (last - first) if last > first else 1.0,
        pivot=(float(found.pivot[0]), float(found.pivot[1])),
        state=state,
        headline=headline(found),
        facts=said(found, None),
        model="walls",
        command=command,
        open=UNSET if found.closed else True,
        words=UNSET if found.closed else f"it has no end: looked at as far as {number(found.reach, 3)} mm",
    )


def _stacked(regions: list[shapely.Geometry], levels: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (v, 3) and triangles (t, 3) of prisms over regions between levels, seen from outside counter-clockwise."""
    points: list[Floats] = []
    faces: list[NDArray[np.int64]] = []
    count = 0
    for region, below, above in zip(regions, levels[:-1], levels[1:], strict=True):
        for ring in rings(region):
            n = len(ring)
            points += [_at(ring, below), _at(ring, above)]
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
