"""Solids as they are made: every face moved inward by half the gap, then cut into convex pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.spatial.solids.box_union import covering_boxes, union_of_boxes
from wiggleroom.spatial.solids.convex import ConvexPiece, cuboid, prism
from wiggleroom.spatial.solids.convex_parts import convex_polygons
from wiggleroom.spatial.solids.mesh_pieces import mesh_made
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of, union_of
from wiggleroom.spatial.solids.spatial_model import Boxes, MadeSolid, Plate, Solid, SpatialPart, Surface

Floats = NDArray[np.float64]


def made_solid(part: SpatialPart, gap: float, inward: float = 0.0) -> tuple[MadeSolid | None, list[str]]:
    """A part's solid with every face moved inward by gap / 2 [mm], and what is wrong with it.

    `inward` [mm] moves its faces further in, or out where it is negative.

    Returns
    -------
    MadeSolid or None
        None where something is wrong.
    list of str
        One line per finding, about the part.
    """
    match part.solid:
        case Plate():
            return _plate(part, part.solid, gap, inward)
        case Boxes():
            return _boxes(part.solid, gap + 2 * inward)
        case Surface():
            return mesh_made(part.solid, gap + 2 * inward)


def drawn_surface(solid: Solid) -> Surface:
    """Boundary of a solid as drawn."""
    match solid:
        case Plate():
            return surface_of(union_of([_extruded(p, 0.0, solid.thickness) for p in _polygons(solid.regions)]))
        case Boxes():
            return surface_of(union_of([_cuboid_solid(low, high) for low, high in solid.boxes]))
        case Surface():
            return solid


def _plate(part: SpatialPart, plate: Plate, gap: float, inward: float) -> tuple[MadeSolid | None, list[str]]:
    if plate.thickness <= gap + 2 * inward:
        return None, [f"thickness {plate.thickness:g} is used up by gap {gap:g}: it must be more than the gap"]
    flat, wrong = examine(Drawing((Part(part.name, plate.regions, offset=part.offset - inward),), gap=gap))
    if wrong:
        return None, [line.removeprefix(f'part "{part.name}" ') for line in wrong]
    drawn = _polygons(plate.regions)
    area = sum(p.area for p in drawn)
    centre = sum((np.array(p.centroid.coords[0]) * p.area for p in drawn), np.zeros(2)) / area
    low, high = gap / 2 + inward, plate.thickness - gap / 2 - inward
    pieces, solids = [], []
    for polygon in _polygons(flat[0].regions):
        pieces += [prism(ring, low, high) for ring in convex_polygons(polygon)]
        solids.append(_extruded(polygon, low, high))
    surface = surface_of(union_of(solids)) if len(solids) > 1 else surface_of(solids[0])
    reference = np.array([*centre, plate.thickness / 2])
    return MadeSolid(tuple(pieces), surface, float(area * plate.thickness), reference), []


def _polygons(regions: tuple[Region, ...]) -> list[shapely.Polygon]:
    return [shapely.Polygon(r.outer, r.holes) for r in regions]


def _extruded(polygon: shapely.Polygon, low: float, high: float) -> Any:
    """Solid of the library from a polygon with holes between two heights."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners, inverse = np.unique(shapely.get_coordinates(triangles), axis=0, return_inverse=True)
    flat = inverse.ravel().reshape(-1, 4)[:, :3]
    a, b, c = (corners[flat[:, k]] for k in range(3))
    clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    flat[clockwise] = flat[clockwise][:, ::-1]
    n = len(corners)
    sides = np.vstack([flat[:, [0, 1]], flat[:, [1, 2]], flat[:, [2, 0]]])
    both = {(i, j) for i, j in sides.tolist()}
    rim = np.array([(i, j) for i, j in both if (j, i) not in both])
    walls = [np.column_stack([rim, rim[:, 1] + n]), np.column_stack([rim[:, 0], rim[:, 1] + n, rim[:, 0] + n])]
    vertices = np.vstack([np.column_stack([corners, np.full(n, z)]) for z in (low, high)])
    return solid_of(Surface(vertices, np.vstack([flat[:, ::-1], flat + n, *walls])))


def _boxes(solid: Boxes, gap: float) -> tuple[MadeSolid | None, list[str]]:
    drawn, grid = union_of_boxes(solid.boxes), union_of_boxes(solid.boxes, gap / 2)
    if not grid.solid.any():
        return None, [f"vanishes at gap {gap:g}: a smaller gap would leave it whole"]
    if grid.lumps > drawn.lumps:
        return None, [f"falls into {grid.lumps} pieces at gap {gap:g}: a smaller gap would leave it whole"]
    boxes = covering_boxes(grid)
    pieces: list[ConvexPiece] = [cuboid(low, high) for low, high in boxes]
    surface = surface_of(union_of([_cuboid_solid(low, high) for low, high in boxes]))
    return MadeSolid(tuple(pieces), surface, drawn.volume, drawn.centroid), []


def _cuboid_solid(low: Floats, high: Floats) -> Any:
    """Axis-aligned box as a solid of the library."""
    import manifold3d

    return manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low))
