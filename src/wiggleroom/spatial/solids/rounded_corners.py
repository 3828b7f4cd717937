"""Corners that a file has rounded: put back into the planes of their faces, so that these are flat again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.drawing.model import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STEPS = 4.0
"""Corners of a flat face lie within so many steps of the plane of its largest triangle: each of that one's corners is off by up to
sqrt(3)/2 of a step, and the plane carries up to three times that to the far side of the face."""
FURTHEST = 8.0
"""No corner is moved by more steps."""
EXACT = 1e-12
"""Corners that lie in their planes to this share of the largest coordinate stay as they are."""
ALIKE = 1e-4
"""Planes of faces whose normals and offsets, as shares of the largest coordinate, differ by less may be one plane."""
MOST_CORNERS = 100_000
"""Corners of faces are not moved where there are more of them, counted for each face: that would take seconds, and a block that is
convex to its digits is taken for its hull."""
ITERATIONS = 8
"""Newton steps; each squares what is left."""
DEPENDENT = 1e-13
"""Added to the diagonal of the equations of a step, which follow from each other where more planes meet than corners can lie in."""


def with_flat_faces(surface: Surface, step: float) -> tuple[Surface, float]:
    """The same surface with rounded corners moved into the planes of their faces, and the longest such displacement [mm].

    Triangles belong to one face where all their corners lie within what rounding explains of the plane of the largest of them; faces
    that lie so near one plane share it, so that cuts along them are one cut. Corners and planes move as little as puts every corner
    into all its planes; nothing is moved where a corner would go further than rounding explains.

    Parameters
    ----------
    surface : Surface
        Closed.
    step : float [mm]
        Between neighbouring coordinates that the file can tell apart.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1], [1, 0, 1e-8]], float)
    >>> faces = np.array([[0, 3, 5], [3, 2, 5], [2, 1, 5], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 5, 4], [5, 1, 4]])
    >>> flat, moved = with_flat_faces(Surface(corners, faces), 1e-7)
    >>> 0 < moved < 1e-7, bool(abs(np.linalg.det(flat.vertices[[0, 1, 2]] - flat.vertices[5])) < 1e-15)
    (True, True)

    Source: region growing, Besl and Jain 1988.
    """
    if step <= 0:
        return surface, 0.0
    middle = surface.vertices.mean(axis=0)
    vertices = surface.vertices - middle
    corner, face = _corners_of_faces(vertices, surface.faces, STEPS * step)
    moved = _into_planes(vertices, corner, face, EXACT * float(np.abs(surface.vertices).max()), FURTHEST * step)
    if moved is None:
        return surface, 0.0
    return Surface(moved + middle, surface.faces), float(np.linalg.norm(moved - vertices, axis=1).max())


def _corners_of_faces(vertices: Floats, faces: Ints, near: float) -> tuple[Ints, Ints]:
    """Corners that lie in faces of more than three of them, and the number of the face of each."""
    label = _grown(vertices, faces, _neighbours(faces), _by_area(vertices, faces), near)
    pairs = np.unique(np.column_stack([np.repeat(label, 3), faces.ravel()]), axis=0)
    face, corner = _in_one_plane(vertices, pairs[:, 0], pairs[:, 1], near)
    many = np.bincount(face)[face] > 3
    _, face = np.unique(face[many], return_inverse=True)
    return corner[many], face


def _planes(vertices: Floats, corner: Ints, face: Ints) -> tuple[Floats, Floats]:
    """Unit normals (f, 3) and offsets (f,) of the planes that fit the corners of faces best."""
    count = np.bincount(face)[:, None]
    middle = _sums(face, vertices[corner]) / count
    off = vertices[corner] - middle[face]
    spread = _sums(face, (off[:, :, None] * off[:, None, :]).reshape(-1, 9)).reshape(-1, 3, 3)
    normal = np.linalg.eigh(spread)[1][:, :, 0]
    return normal, np.einsum("ij,ij->i", normal, middle)


def _sums(face: Ints, rows: Floats) -> Floats:
    """Sums over the rows of each face."""
    return np.column_stack([np.bincount(face, column) for column in rows.T])


def _in_one_plane(vertices: Floats, face: Ints, corner: Ints, near: float) -> tuple[Ints, Ints]:
    """Faces and their corners, those as one whose corners lie within `near` [mm] of one plane: that of a narrow one alone may lean."""
    from scipy.spatial import KDTree  # slow to import, and only files of triangles need it

    count = np.bincount(face)
    first = np.concatenate([[0], np.cumsum(count)])
    normal, level = _planes(vertices, corner, face)
    scaled = np.column_stack([normal, level / np.abs(vertices).max()])
    tree = KDTree(np.vstack([scaled, -scaled]))
    crowded = np.flatnonzero(tree.query_ball_point(scaled, ALIKE, return_length=True) > 1)
    joined = np.arange(len(count))
    taken = np.zeros(len(count), dtype=bool)
    for k in crowded.tolist():
        if taken[k]:
            continue
        whole = corner[first[k] : first[k + 1]]
        for other in sorted({i % len(count) for i in tree.query_ball_point(scaled[k], ALIKE)}):
            if other <= k or taken[other]:
                continue
            both = np.union1d(whole, corner[first[other] : first[other + 1]])
            n, at = _planes(vertices, both, np.zeros(len(both), dtype=np.int64))
            if np.abs(vertices[both] @ n[0] - at[0]).max() <= near:
                taken[other], joined[other], whole = True, k, both
    pairs = np.unique(np.column_stack([joined[face], corner]), axis=0)
    return pairs[:, 0], pairs[:, 1]


def _into_planes(drawn: Floats, corner: Ints, face: Ints, exact: float, furthest: float) -> Floats | None:
    """Corners (v, 3) in all their planes, none further than `furthest` [mm] from where it is drawn; None where they are, or cannot be.

    Newton's method for n_f . v = l_f at every corner v of every face f, each step the shortest one.
    """
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    if not 0 < len(corner) <= MOST_CORNERS:
        return None
    normal, level = _planes(drawn, corner, face)
    vertices = drawn.copy()
    rows = np.arange(len(corner))
    size = float(np.abs(vertices).max())
    first, before = True, np.inf
    for _ in range(ITERATIONS):
        off = np.einsum("ij,ij->i", normal[face], vertices[corner]) - level[face]
        worst = float(np.abs(off).max())
        if worst <= exact:
            return None if first else vertices
        if worst > before or np.linalg.norm(vertices - drawn, axis=1).max() > furthest:
            return None
        first, before = False, worst / 2
        side = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
        side /= np.linalg.norm(side, axis=1)[:, None]
        frame = np.stack([side, np.cross(normal, side)], axis=1)
        along = np.einsum("ikj,ij->ik", frame[face], vertices[corner]) / size
        n = 3 * len(vertices)
        columns = [3 * corner + k for k in range(3)] + [n + 3 * face + k for k in range(3)]
        values = [*normal[face].T, along[:, 0], along[:, 1], np.full(len(corner), -1.0)]
        jacobian = sp.csr_matrix(
            (np.concatenate(values), (np.tile(rows, 6), np.concatenate(columns))), (len(corner), n + 3 * len(level))
        )
        rest = jacobian @ jacobian.T + DEPENDENT * sp.eye_array(len(corner))
        shift = jacobian.T @ splu(sp.csc_matrix(rest), "MMD_AT_PLUS_A", 0.0, options={"SymmetricMode": True}).solve(
            -off
        )
        vertices += shift[:n].reshape(-1, 3)
        plane = shift[n:].reshape(-1, 3)
        normal = normal + np.einsum("ik,ikj->ij", plane[:, :2] / size, frame)
        level = level + plane[:, 2]
        length = np.linalg.norm(normal, axis=1)
        normal, level = normal / length[:, None], level / length
    return None


def _by_area(vertices: Floats, faces: Ints) -> Ints:
    """Triangles, the largest first."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
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
