"""Contacts between bodies at rest that still say something after a small but finite motion: how far, and with how much room."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE, OVERLAP_TOLERANCE
from wiggleroom.form_closure.point_contacts import OutlineEdges, ignored_parts, placed_outlines, rigid_bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

INSETS = 1 / 64, 1 / 8
"""Two edges that lie along each other touch at points this share of their common stretch inside both its ends."""
MIN_MITRE = 1e-3
"""Corners sharper than this leaves them are not followed to their inside."""
MIN_VALID_SHARE = 1e-7
"""Contacts that hold for motions of less than this share of the drawing's size only are left out."""
ROUNDING = 64 * float(np.finfo(np.float64).eps)
"""Coordinates are as exact as this share of the largest of them."""


@dataclass(frozen=True, eq=False)
class FiniteContacts:
    """Points inside bodies beside edges of others, with thick material behind the edge.

    Point k of body `b` lies within `room` of the line of an edge of body `a`, whose material fills the half disc of radius `valid`
    round the point behind that line. So whatever moves the point by less than `valid` as `a` sees it leaves it in front of the line. The
    points lie a little inside, so that hairs and lids that rounding draws hold nothing.

    Parameters
    ----------
    a, b : (k,) int64
        Bodies.
    point : (k, 2) float64 [mm]
        Where they lie at rest.
    normal : (k, 2) float64
        Unit normals, from a into b.
    room : (k,) float64 [mm]
        Distance between point and line at rest, and what rounding may hide.
    valid : (k,) float64 [mm]
    corner : (n, 2) float64 [mm]
        All corners of all parts.
    body : (n,) int64
        Whose they are.
    count, ground : int
        Number of bodies, and the one that stands.
    body_of : (parts,) int64
        Body of each part.
    """

    a: Ints
    b: Ints
    point: Floats
    normal: Floats
    room: Floats
    valid: Floats
    corner: Floats
    body: Ints
    count: int
    ground: int
    body_of: Ints


def finite_contacts(assembly: Assembly) -> FiniteContacts:
    """Contacts of the parts as made, nearer than what counts as touching.

    Every corner near an edge is one, and each pair of edges along each other four. Two outward corners that meet are none: neither has
    material all along behind its edges there.

    Examples
    --------
    >>> from wiggleroom.assembly.patterns import chain
    >>> found = finite_contacts(chain(2, "swallowtail", gap=0.0))
    >>> bool(len(found.valid) and found.valid.min() > 0.001), bool((found.room < 1e-5).all())
    (True, True)
    """
    body_of, ground = rigid_bodies(assembly, assembly.parts)
    loops, owner = placed_outlines(assembly.parts)
    them = OutlineEdges(loops, body_of[owner], ignored_parts(assembly), owner)
    size = float(np.ptp(loops.points, axis=0).max())
    tolerance, inside = CONTACT_TOLERANCE * size, OVERLAP_TOLERANCE * size + rounding(loops.points)
    rows = [_corners_by_edges(them, tolerance, inside)]
    rows += [_along_edges(them, tolerance, inside, share) for share in INSETS]
    edge, of, point = (np.concatenate([r[i] for r in rows]) for i in range(3))
    along = them.along[edge]
    normal = np.column_stack([along[:, 1], -along[:, 0]])
    room = np.abs(((point - them.start[edge]) * normal).sum(1)) + inside
    keep = (room <= 2 * tolerance) & _deep_inside(assembly, them.part[of], point, inside)
    edge, of, point, normal, room = (x[keep] for x in (edge, of, point, normal, room))
    valid = _filled_behind(assembly, them, edge, point, normal, inside)
    keep = valid > MIN_VALID_SHARE * size
    edge, of, point, normal, room, valid = (x[keep] for x in (edge, of, point, normal, room, valid))
    return FiniteContacts(
        them.body[edge], them.body[of], point, normal, room, valid, loops.points, them.body, int(body_of.max()) + 1, ground, body_of
    )  # fmt: skip


def _near_pairs(them: OutlineEdges, one: Ints, other: Ints) -> tuple[Ints, Ints]:
    keep = them.met(one, other)
    return one[keep], other[keep]


def _corners_by_edges(them: OutlineEdges, tolerance: float, inside: float) -> tuple[Ints, Ints, Floats]:
    """Edges, and corners of other bodies near them: edge, edge that the corner begins, place a little inside."""
    lines = shapely.linestrings(np.stack([them.start, them.end], axis=1))
    k, j = shapely.STRtree(lines).query(shapely.points(them.start), predicate="dwithin", distance=tolerance)
    k, j = _near_pairs(them, k, j)
    t = them.along
    outward = np.column_stack([t[:, 1], -t[:, 0]])
    one, other = outward[k], outward[them.loops.before[k]]
    mitre = (one + other) / np.maximum(1 + (one * other).sum(1), MIN_MITRE)[:, None]
    return j, k, them.start[k] - inside * mitre


def _along_edges(them: OutlineEdges, tolerance: float, inside: float, share: float) -> tuple[Ints, Ints, Floats]:
    """Edges, and points a little behind edges of other bodies that run along them: edge, the other edge, place."""
    lines = shapely.linestrings(np.stack([them.start, them.end], axis=1))
    i, j = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=tolerance)
    along = them.along
    i, j = _near_pairs(them, i, j)
    facing = (along[i] * along[j]).sum(1) < 0
    i, j = i[facing], j[facing]
    t, length = along[i], np.hypot(*(them.end[i] - them.start[i]).T)
    far, near = (((x - them.start[i]) * t).sum(1) for x in (them.start[j], them.end[j]))
    low, high = np.maximum(near, 0.0), np.minimum(far, length)
    good = high - low > tolerance
    i, j, low, high, far, near = (x[good] for x in (i, j, low, high, far, near))
    place = np.concatenate([low + share * (high - low), high - share * (high - low)])
    fraction = (place - np.tile(near, 2)) / np.tile(far - near, 2)
    i, j = np.tile(i, 2), np.tile(j, 2)
    behind = np.column_stack([-along[j][:, 1], along[j][:, 0]])
    return i, j, them.end[j] + fraction[:, None] * (them.start[j] - them.end[j]) + inside * behind


def _deep_inside(assembly: Assembly, part: Ints, point: Floats, inside: float) -> NDArray[np.bool_]:
    """Whether points (k, 2) lie in their parts, nearly as deep as `inside` [mm] or deeper."""
    deep = np.zeros(len(part), dtype=np.bool_)
    for p in np.unique(part).tolist():
        rows = np.flatnonzero(part == p)
        for shape in placed_regions([assembly.parts[p]])[0]:
            apart = shapely.distance(shapely.points(point[rows]), shapely.boundary(shape))
            deep[rows] |= shapely.contains_xy(shape, *point[rows].T) & (apart > inside / 2)
    return deep


def _filled_behind(
    assembly: Assembly, them: OutlineEdges, edge: Ints, point: Floats, normal: Floats, slack: float
) -> Floats:
    """Radius (k,) [mm] of the half disc round each point that lies behind the line of an edge by `slack` or more, and that its part fills.

    No other edge of the part comes in there, so all of it is material where one point is.
    """
    radius = np.zeros(len(edge))
    part = them.part[edge]
    for p in np.unique(part).tolist():
        rows, mine = np.flatnonzero(part == p), np.flatnonzero(them.part == p)
        for k in rows.tolist():
            others = mine[mine != edge[k]]
            ends = them.start[others], them.end[others]
            radius[k] = _nearest_behind(point[k], normal[k], them.start[edge[k]], *ends, slack)
        radius[rows[np.isinf(radius[rows])]] = 0.0
        inner = point[rows] - radius[rows, None] / 2 * normal[rows]
        filled = [shapely.contains_xy(shape, *inner.T) for shape in placed_regions([assembly.parts[p]])[0]]
        radius[rows] *= np.any(filled, axis=0)
    return radius


def _nearest_behind(point: Floats, normal: Floats, on: Floats, start: Floats, end: Floats, slack: float) -> float:
    """Least distance [mm] of a point (2,) from what edges (m, 2) have behind the line through `on` by more than `slack`."""
    one, other = (start - on) @ normal + slack, (end - on) @ normal + slack
    behind = np.minimum(one, other) < 0
    start, end, one, other = start[behind], end[behind], one[behind], other[behind]
    crosses = np.maximum(one, other) > 0
    cut = np.clip(one / np.where(crosses, one - other, 1.0), 0.0, 1.0)[:, None]
    place = start + cut * (end - start)
    start = np.where((crosses & (one > 0))[:, None], place, start)
    end = np.where((crosses & (other > 0))[:, None], place, end)
    d = end - start
    length = np.maximum((d * d).sum(1), np.finfo(np.float64).tiny)
    t = np.clip(((point - start) * d).sum(1) / length, 0.0, 1.0)[:, None]
    return float(np.hypot(*(start + t * d - point).T).min(initial=np.inf))


def rounding(coordinates: Floats) -> float:
    """How exact coordinates and what is worked out from them are [mm]."""
    return ROUNDING * float(np.abs(coordinates).max())
