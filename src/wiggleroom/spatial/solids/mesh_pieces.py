"""Meshes: faces moved inward by half the gap, and exact convex pieces by cuts along faces at reflex edges."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.solids.convex import ConvexPiece, convex_piece
from wiggleroom.spatial.solids.convex_hulls import hull_surface, hull_volume
from wiggleroom.spatial.solids.face_planes import FLAT, face_planes
from wiggleroom.spatial.solids.face_triangulation import triangulated_anew
from wiggleroom.spatial.solids.fins import convex_without_fins
from wiggleroom.spatial.solids.solid_boolean import centroid_of, is_sound, is_whole, solid_of, surface_of
from wiggleroom.spatial.solids.spatial_model import MadeSolid, Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CONVEX = 1e-9
"""A piece whose hull has no more than this share of additional volume is convex."""
INEXACT = 1e-7
"""Share of the volume by which all pieces together may miss a mesh: cuts of curved faces of many triangles leave films behind."""
SPLIT = 1e-9
"""Where the volumes of both sides of a cut miss that of the piece by more than this share of the whole, the cut went wrong."""
FILM = 1e-7
"""What is thinner than this share of the mesh's size is rounding."""
HOLLOW = 1e-9
"""A surface inside a solid that encloses more than this share of its volume is the wall of a hollow."""
OFF_PLANE = 1e-6
"""A moved corner may miss its planes by this share of the displacement."""
MAX_PIECES = 2000
"""A mesh that needs more pieces is refused."""
PEELS = 2
"""One plane cuts a part so often: more than once where corners that a file has rounded lie before it."""
CANDIDATES = 10
"""Number of cuts that are compared each time; more where none of them is of use."""


def mesh_made(drawn: Surface, gap: float) -> tuple[MadeSolid | None, list[str]]:
    """A mesh with every face moved inward by gap / 2 [mm], in convex pieces; and what is wrong with it."""
    volume, centroid = centroid_of(drawn)
    surface, wrong = (drawn, "") if gap == 0 else _moved_inward(drawn, gap / 2)
    if surface is None:
        return None, [f"{wrong} at gap {gap:g}: draw the gap into the mesh and ask with gap 0"]
    solid = solid_of(surface)
    pieces = convex_pieces(solid) if is_whole(solid, surface) else None
    if pieces is None:
        return None, ["cannot be cut into convex pieces exactly: a mesh of fewer, flat faces would do"]
    return MadeSolid(tuple(pieces), surface, volume, centroid), []


def _moved_inward(drawn: Surface, inward: float) -> tuple[Surface | None, str]:
    """The surface with every plane moved inward (outward where negative); None and the reason where corners cannot follow."""
    normal, level, label = face_planes(drawn)
    whole = hull_volume(drawn.vertices)
    if whole - centroid_of(drawn)[0] <= CONVEX * whole:
        return _convex_inward(normal, level, inward)
    vertices = drawn.vertices.copy()
    touch = [set() for _ in vertices]  # type: list[set[int]]
    for face, plane in zip(drawn.faces.tolist(), label.tolist(), strict=True):
        for v in face:
            touch[v].add(plane)
    for v, planes in enumerate(touch):
        N = normal[sorted(planes)]
        shift = np.linalg.lstsq(N, np.full(len(N), -inward), rcond=1e-9)[0]
        if np.abs(N @ shift + inward).max() > OFF_PLANE * abs(inward):
            x, y, z = drawn.vertices[v]
            return (
                None,
                f"the {len(N)} faces at ({x:g}, {y:g}, {z:g}) cannot all move inward and still meet in one corner",
            )
        vertices[v] += shift
    moved = triangulated_anew(Surface(vertices, drawn.faces), normal, label)
    if moved is None:
        return None, "faces are used up and the moved ones cross each other"
    solid, before = solid_of(moved), solid_of(drawn)
    more, less = (solid, before) if inward > 0 else (before, solid)
    outside = (more - less).volume() if is_sound(solid) else np.inf
    if outside > 1e-9 * before.volume():
        return None, "faces are used up and the moved ones cross each other"
    return surface_of(solid), ""


def _convex_inward(normal: Floats, level: Floats, inward: float) -> tuple[Surface | None, str]:
    """A convex solid: what is behind all planes once they have moved."""
    from scipy.optimize import linprog
    from scipy.spatial import HalfspaceIntersection

    rows = np.column_stack([normal, np.ones(len(normal))])
    deepest = linprog([0, 0, 0, -1], A_ub=rows, b_ub=level - inward, bounds=[(None, None)] * 3 + [(0, None)])
    if deepest.status != 0 or deepest.x[3] <= 0:
        return None, "vanishes"
    cut = HalfspaceIntersection(np.column_stack([normal, inward - level]), deepest.x[:3])
    return hull_surface(cut.intersections), ""


def convex_pieces(solid: Any) -> list[ConvexPiece] | None:
    """Convex pieces of a solid of the library, by cuts along planes of faces at reflex edges; None where that takes too many or fails.

    No plane cuts a part more than `PEELS` times: corners off their planes would come off film after film without end. Films of rounding
    are left out, and fins on what else is convex: they are no material, and may lie across holes. Pieces lie on different sides of a cut,
    so they make up the solid where none has more volume than its part and no part is lost.

    Source: the notch cutting of Chazelle 1984, the most useful of a few cuts first.
    """
    todo = [(lump, np.zeros((0, 4))) for lump in _lumps(solid)]
    whole = solid.volume()
    found: list[Floats] = []
    left, excess = whole, 0.0
    low, high = np.split(np.array(solid.bounding_box()), 2)
    near, thin = FLAT * np.abs([low, high]).max(), FILM * float(np.linalg.norm(high - low))
    while todo:
        part, done = todo.pop()
        if part.volume() <= 1e-12 * whole:
            continue
        corners = surface_of(part).vertices
        film = _thickness(corners) <= thin
        hull = hull_volume(corners)
        halves: list[Any] = []
        if not film and hull - part.volume() > CONVEX * hull:
            best, enough = np.inf, hull * (1 - CONVEX)
            by: Floats = done[:0]
            compared = 0
            for cut in _cuts(surface_of(part)):
                if compared >= CANDIDATES and halves:
                    break
                if (np.abs(done - cut) < [FLAT, FLAT, FLAT, near]).all(axis=1).sum() >= PEELS:
                    continue
                compared += 1
                both = [h for half in part.split_by_plane(tuple(cut[:3].tolist()), cut[3]) for h in _lumps(half)]
                hollow = sum(hull_volume(surface_of(h).vertices) for h in both)
                useful = len(both) > 1 or hollow < enough  # also where only a film without a volume falls off
                sound = abs(sum(h.volume() for h in both) - part.volume()) <= SPLIT * whole
                if useful and sound and both and hollow < best:
                    best, halves, by = hollow, both, cut[None]
            todo += [(half, np.vstack([done, by])) for half in halves]
            if not halves and (bare := convex_without_fins(part, thin)) is not None:
                corners, hull = bare, hull_volume(bare)
        if not halves:
            left -= part.volume()
        if not halves and not film:
            found.append(corners)
            excess += abs(hull - part.volume())
        if len(found) + len(todo) > MAX_PIECES:
            return None
    if excess + abs(left) > INEXACT * whole:
        return None
    return [convex_piece(corners) for corners in found]


def _lumps(solid: Any) -> list[Any]:
    """Pieces of a solid that do not hang together; one with hollows inside stays whole."""
    shells = [(shell, shell.volume()) for shell in solid.decompose()]
    if min((volume for _, volume in shells), default=0.0) < -HOLLOW * solid.volume():
        return [solid]
    return [shell for shell, volume in shells if volume > 0]


def _thickness(corners: Floats) -> float:
    """Extent of corners (k, 3) along the direction in which they spread least [mm]."""
    return float(np.ptp(corners @ np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)[2][-1]))


def _cuts(surface: Surface) -> Floats:
    """Planes (k, 4), unit normal and offset, of faces at reflex edges and at folds, those with the longest such edges first."""
    normal, level, label = face_planes(surface)
    faces = surface.faces
    sides = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort(np.sort(sides, axis=1).T)
    pair, side = face[order].reshape(-1, 2), sides[order][::2]
    one, other = label[pair[:, 0]], label[pair[:, 1]]
    along = surface.vertices[side[:, 1]] - surface.vertices[side[:, 0]]
    bend = np.einsum("ij,ij->i", np.cross(normal[one], normal[other]), along)
    length = np.linalg.norm(along, axis=1)
    folded = (
        np.einsum("ij,ij->i", normal[one], normal[other]) < FLAT - 1
    )  # a cut beside it left a fin without thickness
    reflex = (bend < -FLAT * length) | folded
    gain = np.zeros(len(normal))
    for who in (one, other):
        np.add.at(gain, who[reflex], length[reflex])
    best = np.argsort(-gain, kind="stable")
    best = best[gain[best] > 0]
    return np.column_stack([normal[best], level[best]])
