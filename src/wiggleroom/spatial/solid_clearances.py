"""Least distances of parts in space, how deep they are in each other, and how near along the layers of a print and across them."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.assembly.clearances import Clearances, near_distance
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE, OVERLAP_TOLERANCE
from wiggleroom.drawing.model import Surface
from wiggleroom.errors import Stop, go_on
from wiggleroom.spatial.overlaps.common_solid import CommonPiece, common_piece, least_width
from wiggleroom.spatial.overlaps.meeting_pairs import meeting_pairs
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.solid_offset import solid_offset
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of
from wiggleroom.spatial.solids.triangle_distances import nearest_triangles

Floats = NDArray[np.float64]

STRETCH = 1e4
"""Distances along layers are those of solids stretched so much across them, and the other way round."""
OPPOSITE = 1e-6
"""Faces whose normals are opposite but for this lie flat against each other."""
Pair = tuple[float, Floats, Floats]
"""Gap [mm], direction (3,) and place (3,) [mm]."""


def solid_clearances(
    assembly: Assembly,
    within: float | None = None,
    least_xy: float | None = None,
    least_z: float | None = None,
    stop: Stop | None = None,
) -> Clearances:
    """Clearances of the near pairs of parts in space, as made; see `wiggleroom.clearances`."""
    reach = max(near_distance(assembly) if within is None else within, least_xy or 0.0, least_z or 0.0)
    surfaces = [placed_surface(part, made.surface) for part, made in zip(assembly.parts, assembly.solids, strict=True)]
    low = np.array([s.vertices.min(axis=0) for s in surfaces]) - reach / 2
    high = np.array([s.vertices.max(axis=0) for s in surfaces]) + reach / 2
    solids: dict[int, Any] = {}
    pairs, told = [], []
    xy, z = [], []
    for a, b in meeting_pairs(assembly, low, high):
        go_on(stop)
        one, other = (solids.setdefault(k, solid_of(surfaces[k])) for k in (a, b))
        pair = _clearance(one, other, surfaces[a], surfaces[b], reach, assembly.size)
        if pair is None:
            continue
        pairs.append((a, b))
        told.append(pair)
        flat, steep = (_stretched_gap(one, other, least, axes, pair[0], assembly.size)
                       for least, axes in ((least_xy, (1.0, 1.0, STRETCH)), (least_z, (STRETCH, STRETCH, 1.0))))  # fmt: skip
        xy.append(flat)
        z.append(steep)
    gap = np.array([one[0] for one in told])
    order = np.argsort(gap, kind="stable")
    fitting = solid_offset(assembly, stop)
    return Clearances(
        assembly,
        np.array(pairs, dtype=np.int64).reshape(-1, 2)[order],
        gap[order],
        np.array([one[1] for one in told]).reshape(-1, 3)[order],
        np.array([one[2] for one in told]).reshape(-1, 3)[order],
        reach,
        fitting.offset,
        fitting.binding,
        fitting.why,
        least_xy,
        least_z,
        None if least_xy is None else np.array(xy)[order],
        None if least_z is None else np.array(z)[order],
    )


def _clearance(one: Any, other: Any, first: Surface, second: Surface, reach: float, size: float) -> Pair | None:
    """Gap of two solids, its direction from the first to the second and its middle; None where they are further apart."""
    rounding = OVERLAP_TOLERANCE * size
    gap = float(one.min_gap(other, reach + rounding))
    if gap > reach:
        return None
    if gap <= rounding and (piece := _deepest(one ^ other, rounding)) is not None:
        return -piece.depth, _way_out(first, second, piece), piece.middle
    direction, at = _nearest_place(first, second, gap, CONTACT_TOLERANCE * size)
    return gap if gap > rounding else 0.0, direction, at


def _deepest(common: Any, rounding: float) -> CommonPiece | None:
    """The deepest piece of what two solids share; None where that is rounding."""
    if common.volume() <= 0:
        return None
    surfaces = [surface_of(piece) for piece in common.decompose()]
    pieces = [common_piece(surface) for surface in surfaces if least_width(surface)[0] > rounding]
    deepest = max(pieces, key=lambda piece: piece.depth, default=None)
    return deepest if deepest is not None and deepest.depth > rounding else None


def _way_out(first: Surface, second: Surface, piece: CommonPiece) -> Floats:
    """Unit vector (3,) along which the second solid leaves the first at a piece of overlap: across it, out of the first."""
    places = []
    for surface in (first, second):
        away = np.zeros((1, 3))
        far = surface_distances(surface.vertices[surface.faces], piece.middle[None], away)
        places.append(piece.middle - far[0] * away[0])
    across = places[0] - places[1]
    if piece.across is not None:
        return piece.across if across @ piece.across >= 0 else -piece.across
    length = float(np.linalg.norm(across))
    return across / length if length > 0 else np.array([0.0, 0.0, 1.0])


def _nearest_place(first: Surface, second: Surface, gap: float, slack: float) -> tuple[Floats, Floats]:
    """Unit vector (3,) across the gap of two surfaces, and its middle (3,): that of the largest two faces that are so near, or a point."""
    P, Q = first.vertices[first.faces], second.vertices[second.faces]
    i, j, p, q = nearest_triangles(P, Q, gap + slack)
    length = np.linalg.norm(q - p, axis=1)
    near = length <= gap + slack
    mine, theirs, middle, across = _normals(P[i]), _normals(Q[j]), (p + q) / 2, q - p
    if gap > slack:
        near &= length <= length.min() + slack / 100
        near_faces = near & ((mine * across).sum(axis=1) > (1 - OPPOSITE) * length)
    else:
        near_faces = near
    largest, best, place = 0.0, -1, middle[0]
    for k in np.flatnonzero(near_faces & ((mine * theirs).sum(axis=1) < OPPOSITE - 1)).tolist():
        frame = np.linalg.svd(mine[k][None])[2][1:]
        shadows = (shapely.convex_hull(shapely.multipoints(T @ frame.T)) for T in (P[i[k]], Q[j[k]]))
        common = shapely.intersection(*shadows)
        if common.area > largest:
            largest, best = common.area, k
            place = shapely.get_coordinates(common.centroid)[0] @ frame + (mine[k] @ middle[k]) * mine[k]
    if best >= 0:
        return mine[best], place
    if gap > slack:
        k = int(length.argmin())
        return across[k] / length[k], middle[k]
    normal = (mine - theirs)[near].mean(axis=0)
    far = float(np.linalg.norm(normal))
    return (normal / far if far > 0 else mine[near][0]), middle[near].mean(axis=0)


def _normals(T: Floats) -> Floats:
    """Unit normals (k, 3) of triangles (k, 3, 3)."""
    normal = np.cross(T[:, 1] - T[:, 0], T[:, 2] - T[:, 0])
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None])


def _stretched_gap(
    one: Any, other: Any, least: float | None, axes: tuple[float, float, float], gap: float, size: float
) -> float:
    """Least distance of points that are the same along the stretched axes [mm]; infinite where that is more than `least`."""
    if least is None or gap > least + CONTACT_TOLERANCE * size:
        return np.inf
    if gap <= CONTACT_TOLERANCE * size:
        return gap
    most = least + CONTACT_TOLERANCE * size
    found = float(one.scale(axes).min_gap(other.scale(axes), most))
    return found if found < most else np.inf
