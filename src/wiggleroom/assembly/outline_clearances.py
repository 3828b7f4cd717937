"""Least distances of parts in the plane, and how deep they are in each other, with place and direction."""

from __future__ import annotations

from collections.abc import Container

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.clearances import Clearances, near_distance
from wiggleroom.assembly.fitting_offset import fitting_offset
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE, OVERLAP_TOLERANCE, OverlapPiece, deepest_piece
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.errors import Stop, go_on

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shapes = NDArray[np.object_]


def outline_clearances(assembly: Assembly, within: float | None = None, stop: Stop | None = None) -> Clearances:
    """Clearances of the near pairs of parts in the plane, as made, and the offset at which all fit; see `wiggleroom.clearances`."""
    reach = near_distance(assembly) if within is None else within
    shapes, owner = placed_regions(assembly.parts)
    shapely.prepare(shapes)
    i, j = near_regions(assembly, shapes, owner, reach)
    go_on(stop)
    overlaps = overlaps_of(shapes[i], shapes[j], assembly.size)
    go_on(stop)
    gap, direction, at = _distances(shapes[i], shapes[j], assembly.size, overlaps)
    for k, piece in overlaps.items():
        gap[k], at[k] = -piece.depth, piece.middle
        direction[k] = _way_out(shapes[i[k]], shapes[j[k]], piece, assembly.size)
        go_on(stop)
    pairs = np.column_stack([owner[i], owner[j]])
    order = np.lexsort((pairs[:, 1], pairs[:, 0], gap))
    _, first = np.unique(pairs[order], axis=0, return_index=True)
    kept = order[np.sort(first)]  # of several regions of a pair the nearest
    fitting = fitting_offset(assembly, stop)
    return Clearances(
        assembly, pairs[kept], gap[kept], direction[kept], at[kept], reach, fitting.offset, fitting.binding, fitting.why
    )


def near_regions(assembly: Assembly, shapes: Shapes, owner: Ints, reach: float) -> tuple[Ints, Ints]:
    """Regions of different parts, neither glued nor ignored, that are no further apart than this [mm]."""
    i, j = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=reach)
    keep = owner[i] < owner[j]
    i, j = i[keep], j[keep]
    drawing = assembly.drawing
    if drawing.glue or drawing.ignore:
        names, may = assembly.names, collidable(drawing.glue, drawing.ignore)
        keep = np.array(
            [may(names[a], names[b]) for a, b in zip(owner[i].tolist(), owner[j].tolist(), strict=True)], dtype=bool
        )
        i, j = i[keep], j[keep]
    return i, j


def overlaps_of(one: Shapes, other: Shapes, size: float) -> dict[int, OverlapPiece]:
    """The deepest piece of overlap of pairs of regions (k,), by pair; what is rounding of a drawing of this size [mm] is left out."""
    meet = np.flatnonzero(shapely.intersects(one, other))
    meet = meet[~shapely.touches(one[meet], other[meet])]
    found = {}
    for k, common in zip(meet.tolist(), shapely.intersection(one[meet], other[meet]), strict=True):
        piece = deepest_piece(common, OVERLAP_TOLERANCE * size)
        if piece is not None:
            found[k] = piece
    return found


def _distances(one: Shapes, other: Shapes, size: float, but: Container[int]) -> tuple[Floats, Floats, Floats]:
    """Distances (k,) of regions, unit vectors (k, 2) from the one to the other, and the middle (k, 2) of the line between.

    Of pairs that overlap, `but`, the directions are left open.
    """
    ends = shapely.get_coordinates(shapely.shortest_line(one, other)).reshape(-1, 2, 2)
    across = ends[:, 1] - ends[:, 0]
    gap, at = np.hypot(*across.T), ends.mean(axis=1)
    direction = np.zeros_like(across)
    apart = gap > OVERLAP_TOLERANCE * size
    direction[apart] = across[apart] / gap[apart, None]
    gap[~apart] = 0.0
    touch = np.array([k for k in np.flatnonzero(~apart).tolist() if k not in but], dtype=np.int64)
    edges = shapely.intersection(shapely.boundary(one[touch]), shapely.boundary(other[touch]))
    for k, common in zip(touch.tolist(), edges, strict=True):
        at[k] = _middle_of_contact(common, at[k])
        direction[k] = contact_normal(one[k], other[k], at[k], CONTACT_TOLERANCE * size)
    return gap, direction, at


def _middle_of_contact(common: shapely.Geometry, otherwise: Floats) -> Floats:
    """Middle (2,) of the longest straight stretch that two boundaries share, else a point that they do."""
    lines = [line for line in shapely.get_parts(shapely.get_parts(common)) if line.length > 0]
    if not lines:
        return otherwise
    ends = np.concatenate([np.stack([c[:-1], c[1:]], axis=1) for c in map(shapely.get_coordinates, lines)])
    longest = np.hypot(*(ends[:, 1] - ends[:, 0]).T).argmax()
    return np.asarray(ends[longest].mean(axis=0))


def contact_normal(one: shapely.Polygon, other: shapely.Polygon, at: Floats, near: float) -> Floats:
    """Unit normal (2,) from one region to another where they touch at a point: that of an edge, or between those of two corners."""
    mine, theirs = (_outward_normals(shape, at, near) for shape in (one, other))
    normal = mine.sum(axis=0) - theirs.sum(axis=0)
    if 1 in (len(mine), len(theirs)):
        normal = mine[0] if len(mine) == 1 else -theirs[0]
    length = float(np.hypot(*normal))
    return np.asarray(normal / length) if length > 0 else np.array([1.0, 0.0])


def _outward_normals(shape: shapely.Polygon, at: Floats, near: float) -> Floats:
    """Outward unit normals (k, 2) of the edges of a region that pass a point."""
    found = []
    for hole, ring in enumerate(shapely.get_rings(shape)):
        corners = shapely.get_coordinates(ring)
        start, along = corners[:-1], np.diff(corners, axis=0)
        length = np.maximum(np.hypot(*along.T), 1e-300)
        unit = along / length[:, None]
        share = np.clip(((at - start) * unit).sum(axis=1), 0.0, length)
        passes = np.hypot(*(start + share[:, None] * unit - at).T) <= near
        outward = np.column_stack([unit[:, 1], -unit[:, 0]])[passes]
        found.append(outward if shapely.is_ccw(ring) == (hole == 0) else -outward)
    return np.concatenate(found)


def _way_out(one: shapely.Polygon, other: shapely.Polygon, piece: OverlapPiece, size: float) -> Floats:
    """Unit vector (2,) along which the other region leaves the first at a piece of overlap: across it, out of the first."""
    middle = shapely.Point(piece.middle)
    out, back = (
        shapely.get_coordinates(shapely.shortest_line(middle, shapely.boundary(shape)))[1] for shape in (one, other)
    )
    across = out - back
    if piece.across is not None:
        return piece.across if across @ piece.across >= 0 else -piece.across
    length = float(np.hypot(*across))
    if length > OVERLAP_TOLERANCE * size:
        return np.asarray(across / length)
    return contact_normal(one, other, out, CONTACT_TOLERANCE * size)
