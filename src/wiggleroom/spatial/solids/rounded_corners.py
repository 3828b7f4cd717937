"""Corners that a file has rounded, as STL keeps seven digits: put back into the planes of their faces, so that these are flat again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.spatial.solids.spatial_model import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 5e-7
"""Share of the largest coordinate that numbers of four bytes explain: four of their steps."""
EXACT = 1e-12
"""Corners that lie in their planes to this share of it stay as they are."""
ALIKE = 1e-4
"""Planes of faces whose normals and offsets, as shares of the largest coordinate, differ by less may be one plane."""
INDEPENDENT = 0.02
"""Directions in which the planes at a corner hold it by less than this share of the firmest one do not move it."""


def with_flat_faces(surface: Surface) -> tuple[Surface, float]:
    """The same surface with rounded corners moved into the planes of their faces, and the longest such displacement [mm].

    Triangles belong to one face where all their corners lie within what rounding explains of the plane of the largest of them; faces
    that lie so near one plane share it, so that cuts along them are one cut.
    Nothing is moved where a corner would go further than that.

    Parameters
    ----------
    surface : Surface
        Closed.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1], [1, 0, 1e-8]], float)
    >>> faces = np.array([[0, 3, 5], [3, 2, 5], [2, 1, 5], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 5, 4], [5, 1, 4]])
    >>> flat, moved = with_flat_faces(Surface(corners, faces))
    >>> moved < 1e-7, bool(abs(flat.vertices[5, 2]) < 1e-8)
    (True, True)

    Source: region growing, Besl and Jain 1988.
    """
    largest = float(np.abs(surface.vertices).max())
    near = ROUNDING * largest
    corners = _corners(
        surface.faces, _grown(surface.vertices, surface.faces, _neighbours(surface.faces), _by_area(surface), near)
    )
    touching: list[list[int]] = [[] for _ in surface.vertices]
    planes: list[Floats] = []
    for own in _in_one_plane(surface.vertices, corners, near):
        for corner in own.tolist():
            touching[corner].append(len(planes))
        planes.append(_plane(surface.vertices[own]))
    plane = np.array(planes)
    vertices = surface.vertices.copy()
    for v, here in enumerate(touching):
        off = plane[here, 3] - plane[here, :3] @ vertices[v]
        if np.abs(off).max(initial=0.0) > EXACT * largest:
            vertices[v] += np.linalg.lstsq(plane[here, :3], off, rcond=INDEPENDENT)[0]
    furthest = float(np.linalg.norm(vertices - surface.vertices, axis=1).max())
    return (surface, 0.0) if furthest > near else (Surface(vertices, surface.faces), furthest)


def _corners(faces: Ints, face: Ints) -> list[Ints]:
    """Corners of every face, of which `face` names the triangles."""
    order = np.argsort(face, kind="stable")
    return [np.unique(faces[own]) for own in np.split(order, np.cumsum(np.bincount(face))[:-1])]


def _plane(points: Floats) -> Floats:
    """Unit normal and offset (4,) of the plane that fits points (k, 3) best."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][-1]
    return np.append(normal, normal @ middle)


def _in_one_plane(vertices: Floats, corners: list[Ints], near: float) -> list[Ints]:
    """Corners of the faces, together where all of several lie within `near` [mm] of one plane: that of a narrow one alone may lean."""
    plane = np.array([_plane(vertices[own]) for own in corners])
    scaled = plane / np.array([1.0, 1, 1, np.abs(vertices).max()])
    from scipy.spatial import KDTree  # slow to import, and only files of triangles need it

    tree = KDTree(scaled)
    found = []
    taken = np.zeros(len(corners), dtype=bool)
    for k, own in enumerate(corners):
        if taken[k]:
            continue
        whole = own
        likely = {i for side in (1, -1) for i in tree.query_ball_point(side * scaled[k], ALIKE)}
        for other in sorted(i for i in likely if i > k and not taken[i]):
            both = np.union1d(whole, corners[other])
            together = _plane(vertices[both])
            if np.abs(vertices[both] @ together[:3] - together[3]).max() <= near:
                taken[other] = True
                whole = both
        found.append(whole)
    return found


def _by_area(surface: Surface) -> Ints:
    """Triangles, the largest first."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    return np.argsort(-np.linalg.norm(np.cross(b - a, c - a), axis=1), kind="stable")


def _neighbours(faces: Ints) -> Ints:
    """The triangle beyond each side (f, 3) of a closed surface."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort(sides.T)
    other = np.empty(len(sides), dtype=np.int64)
    other[order[::2]], other[order[1::2]] = order[1::2], order[::2]
    return (other % len(faces)).reshape(3, -1).T.copy()


@njit(**OPTIONS)
def _grown(vertices, faces, beyond, order, near):
    """The face that each triangle belongs to, grown from the largest triangles over neighbours within `near` [mm] of their plane."""
    label = np.full(len(faces), -1)
    todo = np.empty(len(faces), dtype=np.int64)
    count = 0
    for seed in order:
        if label[seed] >= 0:
            continue
        a, b, c = vertices[faces[seed, 0]], vertices[faces[seed, 1]], vertices[faces[seed, 2]]
        n = np.cross(b - a, c - a)
        n /= max(np.sqrt((n * n).sum()), 1e-300)
        label[seed] = count
        todo[0], size = seed, 1
        while size:
            size -= 1
            here = todo[size]
            for side in range(3):
                other = beyond[here, side]
                if label[other] >= 0:
                    continue
                p, q, r = vertices[faces[other, 0]], vertices[faces[other, 1]], vertices[faces[other, 2]]
                if max(abs((n * (p - a)).sum()), abs((n * (q - a)).sum()), abs((n * (r - a)).sum())) > near:
                    continue
                label[other] = count
                todo[size] = other
                size += 1
        count += 1
    return label
