"""Solids as they are made: every face moved inward by half the gap, then cut into convex pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.model import Boxes, ConvexPiece, Drawing, MadeSolid, Part, Plate, Region, Solid, Surface
from wiggleroom.errors import InputError, Stop
from wiggleroom.spatial.solids.box_union import BoxGrid, covering_boxes, union_of_boxes
from wiggleroom.spatial.solids.convex import cuboid, prism
from wiggleroom.spatial.solids.convex_parts import convex_polygons
from wiggleroom.spatial.solids.mesh_pieces import mesh_made
from wiggleroom.spatial.solids.orthogonal import boxes_of_mesh
from wiggleroom.spatial.solids.solid_boolean import centroid_of, solid_of, surface_of, union_of

Floats = NDArray[np.float64]

DIGITS, ROUGH = 1e-6, 1e-4
"""Faces of a mesh lie along axes where they miss them by less than this share of its size: as numbers in files do, and at most."""
SAME_VOLUME = 1e-9
"""Volumes that differ by less than this share are the same."""


def made_solid(
    part: Part, gap: float, inward: float = 0.0, stop: Stop | None = None
) -> tuple[MadeSolid | None, list[str]]:
    """A part's solid with every face moved inward by gap / 2 [mm], and what is wrong with it.

    `inward` [mm] moves its faces further in, or out where it is negative; `stop` ends the work with a StoppedError.

    Returns
    -------
    MadeSolid or None
        None where something is wrong.
    list of str
        One line per finding, about the part.
    """
    match solid := drawn_solid(part):
        case Plate():
            return _plate(part, solid, gap, inward)
        case Boxes():
            return _boxes(solid, gap + 2 * (inward - part.offset))
        case Surface():
            return _mesh(solid, gap + 2 * (inward - part.offset), stop)


def drawn_solid(part: Part) -> Solid:
    """Material of a part to which a gap is applied; of one that was made already the surface.

    Raises
    ------
    InputError
        If the part has none.
    """
    if part.solid is None:
        message = f'part "{part.name}" is in the plane and others are in space: give it a solid'
        raise InputError(message)
    return part.solid.surface if isinstance(part.solid, MadeSolid) else part.solid


def drawn_surface(part: Part) -> Surface:
    """Boundary of a part as drawn, in its own frame."""
    match solid := drawn_solid(part):
        case Plate():
            return surface_of(union_of([_extruded(p, 0.0, solid.thickness) for p in _polygons(solid.regions)]))
        case Boxes():
            return surface_of(union_of([_cuboid_solid(low, high) for low, high in solid.boxes]))
        case Surface():
            return solid


def _plate(part: Part, plate: Plate, gap: float, inward: float) -> tuple[MadeSolid | None, list[str]]:
    if plate.thickness <= gap + 2 * inward:
        return None, [f"thickness {plate.thickness:g} is used up by gap {gap:g}: it must be more than the gap"]
    outlines = Part(part.name, plate.regions, offset=part.offset - inward, outline_offsets=part.outline_offsets)
    flat, wrong = examine(Drawing((outlines,), gap=gap))
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


def _mesh(drawn: Surface, gap: float, stop: Stop | None) -> tuple[MadeSolid | None, list[str]]:
    """A mesh: like boxes where its faces lie along three axes, as exactly as numbers in files do, else by convex pieces.

    Where there are none, boxes that contain it will do, where its faces lie along axes but for more rounding.
    """
    size = float(np.ptp(drawn.vertices, axis=0).max())
    boxes = boxes_of_mesh(drawn, ROUGH * size)
    if boxes is None or not _is_thick(boxes[1], gap):
        return mesh_made(drawn, gap, stop)
    frame, grid, moved = boxes
    if moved <= DIGITS * size:
        return _boxes_turned(drawn, gap, frame, grid, overshoot=0.0)
    made, wrong = mesh_made(drawn, gap, stop)
    return (
        (made, wrong) if made is not None else _boxes_turned(drawn, gap - 2 * moved, frame, grid, overshoot=2 * moved)
    )


def _is_thick(grid: BoxGrid, gap: float) -> bool:
    """True where no wall is used up by a gap [mm]: moved inward and outward again all faces are back."""
    left = union_of_boxes(covering_boxes(grid), gap / 2)
    if not left.solid.any():
        return False
    return union_of_boxes(covering_boxes(left), -gap / 2).volume > (1 - SAME_VOLUME) * grid.volume


def _boxes_turned(
    drawn: Surface, gap: float, frame: Floats, grid: BoxGrid, overshoot: float
) -> tuple[MadeSolid | None, list[str]]:
    """A mesh whose faces lie along the axes of a frame."""
    made, wrong = _boxes(Boxes(covering_boxes(grid)), gap)
    if made is None:
        return None, wrong
    pieces = tuple(piece.placed(frame, np.zeros(3)) for piece in made.pieces)
    surface = Surface(made.surface.vertices @ frame.T, made.surface.faces)
    return MadeSolid(pieces, surface, *centroid_of(drawn), overshoot=overshoot), []


def _cuboid_solid(low: Floats, high: Floats) -> Any:
    """Axis-aligned box as a solid of the library."""
    import manifold3d

    return manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low))
