"""Booleans of solids by the library manifold3d."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface
from wiggleroom.errors import require_extra
from wiggleroom.spatial.solids.solid_angle import winding_numbers

Floats = NDArray[np.float64]

FLIPPED = 1e-8
"""Where the library's solid misses the volume of its surface by more than this share, edges were flipped."""
SAME_SOLID = 1e-6
"""A solid is that of a surface where volume and area differ by less than this share: films of rounding are less."""
THIN = 1e-6
"""Share of the size by which places beside a face are apart from it, to see on which side of it a solid lies."""
PLACES = np.array([(i, j, 15 - i - j) for i in range(1, 14, 3) for j in range(1, 15 - i, 3)]) / 15
"""Places on a triangle, as shares of its corners."""
LOST = 1e-4
"""Faces that a solid lacks outside itself are none where they are less than this share of its area."""
MAX_LOST = 500
"""Of more faces that a solid lacks it is not looked for where they lie."""
FEWER_DIGITS = 1e-10
"""Share of the largest coordinate that corners are rounded to then."""


def require_solid_library() -> None:
    """Check that the libraries for solids are installed.

    Raises
    ------
    MissingExtraError
        If they are not.
    """
    require_extra("solid", "assemblies in space need trimesh and manifold3d", "trimesh", "manifold3d")


def solid_of(surface: Surface) -> Any:
    """Solid of the library from a closed surface; `status()` tells whether it is one.

    Where corners lie in line but for the last digits, the library takes triangles beside them for needles and flips edges that are no
    diagonals of flat faces. That shows in the volume; corners rounded to fewer digits are then taken.
    """
    solid = _built(surface.vertices, surface.faces)
    volume = volume_of(surface) if is_sound(solid) else 0.0
    if abs(solid.volume() - volume) <= FLIPPED * abs(volume):
        return solid
    step = FEWER_DIGITS * float(np.abs(surface.vertices).max())
    again = _built(np.round(surface.vertices / step) * step, surface.faces)
    return again if abs(again.volume() - volume) < abs(solid.volume() - volume) else solid


def is_solid_of(solid: Any, surface: Surface) -> bool:
    """True where a solid of the library has the volume and the area of a closed surface.

    The library takes corners together where walls have no thickness, and what it then holds is another solid.
    """
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
    volume = volume_of(surface)
    return bool(
        abs(solid.volume() - volume) <= SAME_SOLID * abs(volume)
        and abs(solid.surface_area() - area) <= SAME_SOLID * area
    )


def lacks_slits_only(solid: Any, surface: Surface) -> bool:
    """True where all that a closed surface has more than a solid of the same volume lies inside the solid: there nothing is lost.

    Places on the faces that the solid lacks are looked at on both sides: at a slit the solid is there on both, at a wall outside it on
    neither.
    """
    rest = surface_of(solid)
    mine, others = (surface.vertices[surface.faces], rest.vertices[rest.faces])
    known = {np.sort(triangle, axis=0).tobytes() for triangle in others}
    more = np.array([t for t in mine if np.sort(t, axis=0).tobytes() not in known]).reshape(-1, 3, 3)
    volume = volume_of(surface)
    if len(more) > MAX_LOST or abs(solid.volume() - volume) > SAME_SOLID * abs(volume):
        return False
    thick = THIN * float(np.ptp(surface.vertices, axis=0).max())
    normal = np.cross(more[:, 1] - more[:, 0], more[:, 2] - more[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    wide = area > thick**2
    normal = normal[wide] / (2 * area[wide, None])
    outside = 0.0
    for places in (PLACES @ more[wide]).transpose(1, 0, 2):  # one place of each face
        sides = [winding_numbers(others, places + shift) > 0.5 for shift in (thick * normal, -thick * normal)]
        nowhere = ~np.logical_or(*sides)
        outside += float(area[wide][nowhere].sum()) / len(PLACES)
    return outside <= LOST * float(solid.surface_area())


def is_whole(solid: Any, surface: Surface) -> bool:
    """True where a solid of the library is that of a closed surface, or lacks slits of it only: no material is lost, and none gained."""
    return is_solid_of(solid, surface) or lacks_slits_only(solid, surface)


def _built(vertices: Floats, faces: NDArray[np.int64]) -> Any:
    import manifold3d

    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(vertices), tri_verts=np.ascontiguousarray(faces, dtype=np.uint64)
    )
    return manifold3d.Manifold(mesh)


def surface_of(solid: Any) -> Surface:
    """Surface of a solid of the library."""
    mesh = solid.to_mesh64()
    vertices = np.array(mesh.vert_properties, dtype=float)[:, :3]
    return Surface(np.ascontiguousarray(vertices), np.array(mesh.tri_verts, dtype=np.int64))


def turned_over(solid: Any) -> Any:
    """The same surface looking the other way: a hollow as a solid."""
    surface = surface_of(solid)
    return solid_of(Surface(surface.vertices, surface.faces[:, ::-1]))


def union_of(solids: Sequence[Any]) -> Any:
    """Union of solids."""
    import manifold3d

    return manifold3d.Manifold.batch_boolean(list(solids), manifold3d.OpType.Add)


def connected_solids(solid: Any) -> list[Any]:
    """Solids of the library that hang together, each with the hollows inside it.

    Examples
    --------
    >>> import manifold3d
    >>> cube = manifold3d.Manifold.cube((1, 1, 1), center=True)
    >>> hollow = cube.scale((3, 3, 3)) - cube.scale((2, 2, 2))
    >>> [round(one.volume(), 6) for one in connected_solids(hollow + cube)]
    [1.0, 19.0]
    """
    shells = sorted(solid.decompose(), key=lambda shell: float(shell.volume()))
    whole = [shell for shell in shells if shell.volume() > 0]
    hollows = [surface_of(shell) for shell in shells if shell.volume() < 0]
    if not hollows:
        return whole
    outer = [surface_of(shell) for shell in whole]
    inside: list[list[Surface]] = [[surface] for surface in outer]
    for hollow in hollows:
        around = next((k for k, one in enumerate(outer) if _encloses(one, hollow.vertices[0])), None)
        if around is not None:  # the smallest, for those inside it have hollows of their own
            inside[around].append(hollow)
    return [solid_of(_together(surfaces)) for surfaces in inside]


def _encloses(surface: Surface, point: Floats) -> bool:
    """True where a point (3,) lies inside a closed surface that looks outward, by its solid angle.

    Source: Van Oosterom and Strackee, The Solid Angle of a Plane Triangle (1983).
    """
    a, b, c = (surface.vertices[surface.faces[:, k]] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", one, other) for one, other in ((b, c), (c, a), (a, b))]
    angle = 2 * np.arctan2(volume, la * lb * lc + dots[0] * la + dots[1] * lb + dots[2] * lc)
    return bool(abs(angle.sum()) > 2 * np.pi)


def _together(surfaces: Sequence[Surface]) -> Surface:
    """Closed surfaces that do not meet as one."""
    first = np.cumsum([0, *(len(one.vertices) for one in surfaces)])
    faces = [one.faces + start for one, start in zip(surfaces, first, strict=False)]
    return Surface(np.concatenate([one.vertices for one in surfaces]), np.concatenate(faces))


def behind_planes(normals: Floats, levels: Floats, far: float) -> Any | None:
    """Solid of the library behind planes (k, 3), (k,) [mm], at most `far` [mm] from the origin along the axes; None where there is none."""
    import manifold3d

    solid = manifold3d.Manifold.cube((2 * far, 2 * far, 2 * far), center=True)
    for normal, level in zip(normals, levels.tolist(), strict=True):
        solid = solid.trim_by_plane(tuple((-normal).tolist()), -level)
    return solid if solid.volume() > 0 else None


def is_sound(solid: Any) -> bool:
    """True for a closed, oriented solid with a volume."""
    import manifold3d

    return solid.status() == manifold3d.Error.NoError and not solid.is_empty()


def centroid_of(surface: Surface) -> tuple[float, Floats]:
    """Volume [mm3] and centroid (3,) [mm] inside a closed surface, by tetrahedra from its middle."""
    middle, corners, six = _tetrahedra(surface)
    volume = float(six.sum()) / 6
    return volume, middle + (six[:, None] * corners.sum(axis=0)).sum(axis=0) / (24 * volume)


def volume_of(surface: Surface) -> float:
    """Volume [mm3] inside a closed surface; negative where its faces look inward."""
    return float(_tetrahedra(surface)[2].sum()) / 6


def _tetrahedra(surface: Surface) -> tuple[Floats, Floats, Floats]:
    """Middle (3,) of a surface, corners (3, f, 3) of its faces from there, and six times the volume (f,) of the tetrahedra between."""
    middle = surface.vertices.mean(axis=0)
    corners = np.array([surface.vertices[surface.faces[:, k]] - middle for k in range(3)])
    return middle, corners, np.einsum("ij,ij->i", corners[0], np.cross(corners[1], corners[2]))
