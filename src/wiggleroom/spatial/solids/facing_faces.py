"""Flat faces of a solid, and where those of two solids face each other: there the gap of a joint applies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.facing import OPPOSITE
from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.solids.face_planes import FLAT, face_planes

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FaceBorder:
    """An edge of a face, from `start` to `end` (2,) [mm] in its plane, where another face begins.

    `reflex` is True where the solid fills more than half of the space round it.
    """

    start: Floats
    end: Floats
    other: int
    reflex: bool


@dataclass(frozen=True, eq=False)
class FlatFace:
    """A flat face of a solid.

    Parameters
    ----------
    normal : (3,) float64
        Outward.
    level : float [mm]
        Along the normal.
    frame : (2, 3) float64
        Unit axes of the coordinates in its plane; their origin is nearest to that of the solid.
    polygon : shapely.Polygon or shapely.MultiPolygon [mm]
    borders : tuple of FaceBorder
    """

    normal: Floats
    level: float
    frame: Floats
    polygon: shapely.Geometry
    borders: tuple[FaceBorder, ...]


def flat_faces(surface: Surface) -> list[FlatFace]:
    """Faces of a closed surface; triangles in one plane that share an edge are one face.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.solid_boolean import surface_of
    >>> import manifold3d
    >>> sorted(f.polygon.area for f in flat_faces(surface_of(manifold3d.Manifold.cube((1, 2, 3)))))
    [2.0, 2.0, 3.0, 3.0, 6.0, 6.0]
    """
    normal, level, label = face_planes(surface)
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
    first /= np.linalg.norm(first, axis=1)[:, None]
    frames = np.stack([first, np.cross(normal, first)], axis=1)
    triangles: list[list[Floats]] = [[] for _ in normal]
    for corners, k in zip(surface.vertices[surface.faces], label.tolist(), strict=True):
        triangles[k].append(corners @ frames[k].T)
    borders: list[list[FaceBorder]] = [[] for _ in normal]
    faces = surface.faces
    sides = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort(np.sort(sides, axis=1).T)
    for (i, j), (p, q) in zip(sides[order][::2].tolist(), label[face[order].reshape(-1, 2)].tolist(), strict=True):
        if p == q:
            continue
        ends = surface.vertices[[i, j]]
        bend = float(np.cross(normal[p], normal[q]) @ (ends[1] - ends[0]))
        reflex = bend < -FLAT * float(np.linalg.norm(ends[1] - ends[0]))
        for one, other in ((p, q), (q, p)):
            start, end = ends @ frames[one].T
            borders[one].append(FaceBorder(start, end, other, reflex))
    return [
        FlatFace(n, float(at), frame, shapely.union_all([shapely.Polygon(t) for t in some]), tuple(edges))
        for n, at, frame, some, edges in zip(normal, level, frames, triangles, borders, strict=True)
    ]


def facing_regions(
    a: Sequence[FlatFace], b: Sequence[FlatFace], reach: float, slack: float
) -> dict[int, shapely.Geometry]:
    """Regions of faces of `a`, by their index, that face those of `b`, both in one frame.

    Parameters
    ----------
    reach : float [mm]
        Faces further apart do not face each other. What is narrower than this between a region and the border of its face belongs to it.
    slack : float [mm]
        How far `b` may lie behind a face of `a`.
    """
    if not a or not b:
        return {}
    opposite = np.array([f.normal for f in a]) @ np.array([f.normal for f in b]).T < OPPOSITE
    found = {}
    for k in np.flatnonzero(opposite.any(axis=1)).tolist():
        seen = [_before(a[k], b[m], reach, slack) for m in np.flatnonzero(opposite[k]).tolist()]
        region = shapely.intersection(shapely.union_all(seen), a[k].polygon)
        region = _polygons_of(region, 1e-3 * reach)
        if not region.is_empty:
            found[k] = _to_the_border(region, a[k].polygon, reach)
    return found


def _before(face: FlatFace, other: FlatFace, reach: float, slack: float) -> shapely.Geometry:
    """The other face as seen along the normal of a face, where it lies within reach before it."""
    place = other.normal * other.level
    flat = shapely.transform(other.polygon, lambda x: (x @ other.frame + place) @ face.frame.T)
    # height of the other plane above a point x of the plane: base + slope . x
    along = float(face.normal @ other.normal)
    base = (other.level - face.level * along) / along
    slope = -(face.frame @ other.normal) / along
    steep = float(np.linalg.norm(slope))
    size = 1.0 + float(np.abs(flat.bounds).max())
    if steep * size <= 1e-3 * reach:
        return flat if -slack <= base <= reach else shapely.Polygon()
    up = slope / steep
    low, high = ((height - base) / steep for height in (-slack, reach))
    across = 4 * size * np.array([-up[1], up[0]])
    band = shapely.Polygon([low * up - across, high * up - across, high * up + across, low * up + across])
    return shapely.intersection(flat, band)


def _to_the_border(region: shapely.Geometry, face: shapely.Geometry, reach: float) -> shapely.Geometry:
    """The region with what is narrower than `reach` between it and the border of its face, or between parts of it."""
    left = shapely.difference(face, region)
    wide = left.buffer(-reach / 2, join_style="mitre").buffer(0.5001 * reach, join_style="mitre")
    narrow = _polygons_of(shapely.difference(left, wide), 0.0)
    beside = [p for p in shapely.get_parts(narrow) if p.area > 0 and p.distance(region) <= 1e-3 * reach]
    if not beside:
        return region
    joined = shapely.union_all([region, *(p.buffer(1e-3 * reach, join_style="mitre") for p in beside)])
    return _polygons_of(shapely.intersection(joined, face), 1e-3 * reach)


def _polygons_of(shape: shapely.Geometry, least: float) -> shapely.Geometry:
    """The polygons of a shape, without lines, points, and what is narrower than `least` [mm]."""
    parts = [p for p in shapely.get_parts(shape) if p.geom_type == "Polygon" and not p.buffer(-least / 2).is_empty]
    return shapely.MultiPolygon(parts)
