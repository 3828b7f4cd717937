"""Meshes: faces moved inward by half the gap, and exact convex pieces by cuts along faces at reflex edges."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece, MadeSolid, Surface
from wiggleroom.errors import Stop, go_on
from wiggleroom.spatial.solids.convex import convex_piece
from wiggleroom.spatial.solids.convex_hulls import hull_surface, hull_volume
from wiggleroom.spatial.solids.face_planes import FLAT, face_planes, shared_edges
from wiggleroom.spatial.solids.face_triangulation import triangulated_anew
from wiggleroom.spatial.solids.fins import convex_without_fins
from wiggleroom.spatial.solids.mesh_offset import mesh_offset
from wiggleroom.spatial.solids.solid_angle import winding_numbers
from wiggleroom.spatial.solids.solid_boolean import centroid_of, is_sound, is_whole, solid_of, surface_of

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
MOST_OVERSHOOT = 1 / 8
"""On most of its surface a solid may be larger than made by this share of the gap, so that two that face each other take up a quarter."""
MOST_FACES = 40_000
"""Meshes of more faces that cannot all follow are refused."""
MOST_PLACES = 500
"""A place where a mesh is thin is looked for behind so many of its triangles."""
CANDIDATES = 10
"""Number of cuts that are compared each time; more where none of them is of use."""
CROWDED = 64
"""Parts with more planes of faces at reflex edges are halved across an axis, so that curved ones fall apart before they are cut face by
face."""
MANY_NOTCHES = 400
"""Solids of more planes of faces at reflex edges are taken as shells: to cut them takes long."""
MOST_CUTS = 2500
"""So many cuts are tried for all solids of an assembly together, a few seconds of work; solids that need more are taken as shells."""
SIDES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
"""Corners of a tetrahedron at the ends of each edge."""
UNCUT = "cannot be cut into convex pieces exactly: a mesh of fewer, flat faces would do"


def mesh_made(drawn: Surface, gap: float, stop: Stop | None = None) -> tuple[MadeSolid | None, list[str]]:
    """A mesh with every face moved inward by gap / 2 [mm], and what is wrong with it; in convex pieces only where these cover it."""
    volume, centroid = centroid_of(drawn)
    if gap > 0 and not _corners_follow(drawn):
        return _covered(drawn, gap, stop)
    surface, wrong = (drawn, "") if gap == 0 else _moved_inward(drawn, gap / 2)
    if surface is None:
        return None, [f"{wrong} at gap {gap:g}: draw the gap into the mesh and ask with gap 0"]
    if not is_whole(solid_of(surface), surface):
        return None, [UNCUT]
    return MadeSolid((), surface, volume, centroid), []


class CutsLeft:
    """How many cuts may still be tried."""

    def __init__(self, count: float = MOST_CUTS) -> None:
        self._count = count

    def take(self) -> bool:
        """Count one cut; False where it is one too many."""
        self._count -= 1
        return self._count >= 0


def notches(made: MadeSolid) -> int:
    """Number of planes of faces at reflex edges."""
    return 0 if _is_convex(made.surface) else len(_cuts(made.surface))


def in_pieces(
    made: MadeSolid, thick: Callable[[], float], stop: Stop | None = None, left: CutsLeft | None = None
) -> MadeSolid:
    """A solid as made in convex pieces.

    One that is larger than made, of more than `MANY_NOTCHES` concave faces, or that cannot be cut with the cuts that are left, becomes a
    shell as thick [mm] as asked.
    """
    if not made.overshoot and notches(made) <= MANY_NOTCHES:
        pieces = convex_pieces(solid_of(made.surface), stop, left or CutsLeft())
        if pieces is not None:
            return replace(made, pieces=tuple(pieces))
    most = thick()
    return replace(
        made, pieces=tuple(_shell(made.surface, most)), overshoot=made.overshoot + most, mostly=made.mostly + most
    )


def _shell(surface: Surface, thick: float) -> list[ConvexPiece]:
    """Flat tetrahedra, so high [mm], beneath the faces of a closed surface.

    Two solids that do not overlap at rest meet first where their surfaces do, so that shells say all of how they move.
    """
    corners = surface.vertices[surface.faces]
    inward = -np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wide = np.linalg.norm(inward, axis=1) > 0  # others lie on edges of their neighbours
    corners, inward = corners[wide], inward[wide]
    tip = corners.mean(axis=1) + thick * inward / np.linalg.norm(inward, axis=1)[:, None]
    V = np.concatenate([corners, tip[:, None]], axis=1)
    E = np.stack([V[:, j] - V[:, i] for i, j in SIDES], axis=1)
    N = np.stack([np.cross(E[:, i], E[:, j]) for i, j in ((0, 1), (0, 2), (1, 2), (3, 4))], axis=1)
    for axes in (E, N):
        axes /= np.maximum(np.linalg.norm(axes, axis=2), 1e-300)[:, :, None]
    return [ConvexPiece(*one) for one in zip(V, N, E, strict=True)]


def _covered(drawn: Surface, gap: float, stop: Stop | None) -> tuple[MadeSolid | None, list[str]]:
    """A mesh whose faces cannot all follow, a little larger than it is made."""
    uneven = "has corners whose faces cannot all move inward and still meet, and"
    instead = "draw the gap into the mesh and ask with gap 0"
    if len(drawn.faces) > MOST_FACES:
        return None, [f"{uneven} more than {MOST_FACES} triangles: {instead}"]
    found = mesh_offset(drawn, gap / 2, stop)
    if found is None or found[2] > MOST_OVERSHOOT * gap:
        larger = (
            "" if found is None else f" it would be {found[2]:.3g} mm larger than made on a twentieth of its surface;"
        )
        return None, [
            f"{uneven} is too thin or uneven for gap {gap:g}:{larger} at most {MOST_OVERSHOOT * gap:.3g} will do: {instead}"
        ]
    surface, overshoot, mostly = found
    volume, centroid = centroid_of(drawn)
    return MadeSolid((), surface, volume, centroid, overshoot=overshoot, mostly=mostly), []


def _is_convex(drawn: Surface) -> bool:
    whole = hull_volume(drawn.vertices)
    return bool(whole - centroid_of(drawn)[0] <= CONVEX * whole)


def _shifts(drawn: Surface, normal: Floats, label: Ints) -> tuple[Floats, Ints]:
    """How corners move (v, 3) as their faces move inward by 1, nan where these do not meet again; and how many faces (v,) there are."""
    touch = [set() for _ in drawn.vertices]  # type: list[set[int]]
    for face, plane in zip(drawn.faces.tolist(), label.tolist(), strict=True):
        for v in face:
            touch[v].add(plane)
    shifts = np.zeros_like(drawn.vertices)
    for v, planes in enumerate(touch):
        N = normal[sorted(planes)]
        shifts[v] = np.linalg.lstsq(N, np.full(len(N), -1.0), rcond=1e-9)[0]
        if np.abs(N @ shifts[v] + 1.0).max() > OFF_PLANE:
            shifts[v] = np.nan
    return shifts, np.array([len(planes) for planes in touch])


def _corners_follow(drawn: Surface) -> bool:
    """True where all faces of a surface may move inward alike and still meet in its corners; this is so at every gap or at none."""
    if _is_convex(drawn):
        return True
    normal, _, label = face_planes(drawn)
    return bool(np.isfinite(_shifts(drawn, normal, label)[0]).all())


def _moved_inward(drawn: Surface, inward: float) -> tuple[Surface | None, str]:
    """The surface with every plane moved inward (outward where negative); None and the reason where corners cannot follow."""
    normal, level, label = face_planes(drawn)
    if _is_convex(drawn):
        return _convex_inward(normal, level, inward)
    shifts, count = _shifts(drawn, normal, label)
    stuck = np.flatnonzero(np.isnan(shifts[:, 0]))
    if len(stuck):
        x, y, z = drawn.vertices[stuck[0]]
        return None, (
            f"the {count[stuck[0]]} faces at ({x:g}, {y:g}, {z:g}) cannot all move outward and still meet in one corner"
        )
    vertices = drawn.vertices + inward * shifts
    moved = triangulated_anew(Surface(vertices, drawn.faces), normal, label)
    if moved is None:
        return None, _used_up(drawn, inward)
    solid, before = solid_of(moved), solid_of(drawn)
    more, less = (solid, before) if inward > 0 else (before, solid)
    outside = (more - less).volume() if is_sound(solid) else np.inf
    if outside > 1e-9 * before.volume():
        return None, _used_up(drawn, inward)
    return surface_of(solid), ""


def _used_up(drawn: Surface, inward: float) -> str:
    """What happens where moved faces cross each other: where the solid is thinner than both move, if a place is found."""
    triangles = drawn.vertices[drawn.faces]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1)
    seen = np.argsort(-area, kind="stable")[:MOST_PLACES]
    at = triangles[seen].mean(axis=1)
    beyond = winding_numbers(triangles, at - 2 * inward * normal[seen] / area[seen, None]) < 0.5
    if not beyond.any():
        return "faces are used up and the moved ones cross each other"
    x, y, z = at[beyond][0]
    return f"is thinner than the gap behind the face at ({x:.4g}, {y:.4g}, {z:.4g}), so that its faces are used up"


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


def convex_pieces(solid: Any, stop: Stop | None = None, left: CutsLeft | None = None) -> list[ConvexPiece] | None:
    """Convex pieces of a solid of the library, by cuts along planes of faces at reflex edges; None where that takes too many or fails.

    Without `left` only the number of pieces is limited.

    No plane cuts a part more than `PEELS` times: corners off their planes would come off film after film without end. Films of rounding
    are left out, and fins on what else is convex: they are no material, and may lie across holes. Pieces lie on different sides of a cut,
    so they make up the solid where none has more volume than its part and no part is lost.

    Source: the notch cutting of Chazelle 1984, the most useful of a few cuts first; parts with many notches are halved before.
    """
    todo = [(lump, np.zeros((0, 4))) for lump in _lumps(solid)]
    whole = solid.volume()
    found: list[Floats] = []
    missing, excess = whole, 0.0
    left = CutsLeft(math.inf) if left is None else left
    low, high = np.split(np.array(solid.bounding_box()), 2)
    near, thin = FLAT * np.abs([low, high]).max(), FILM * float(np.linalg.norm(high - low))
    while todo:
        go_on(stop)
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
            compared, candidates = 0, CANDIDATES
            cuts = _cuts(surface_of(part))
            if len(cuts) > CROWDED:
                halving = _halving(corners)
                cuts, candidates = np.vstack([halving, cuts]), len(halving)
            for cut in cuts:
                if compared >= candidates and halves:
                    break
                if (np.abs(done - cut) < [FLAT, FLAT, FLAT, near]).all(axis=1).sum() >= PEELS:
                    continue
                if not left.take():
                    return None
                go_on(stop)
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
            missing -= part.volume()
        if not halves and not film:
            found.append(corners)
            excess += abs(hull - part.volume())
        if len(found) + len(todo) > MAX_PIECES:
            return None
    if excess + abs(missing) > INEXACT * whole:
        return None
    return [convex_piece(corners) for corners in found]


def _halving(corners: Floats) -> Floats:
    """Planes (3, 4) across the axes with as many of the corners (k, 3) on either side."""
    return np.column_stack([np.eye(3), np.median(corners, axis=0)])


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
    side, pair = shared_edges(surface)
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
