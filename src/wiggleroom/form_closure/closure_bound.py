"""Bodies that touch and are locked by their contacts alone: how far they get at most, proven for motions of any size.

Contacts that are valid for finite motions say n . (motion of the point as the edge sees it) >= -room. To first order in the motions y
of the bodies (shifts, and turns about one point, lengths in units of their spread) these are rows B y >= -e, and what is left out
is of second order. For each unknown y_k positive forces f with B^T f = e_k or -e_k, which linear programs find, bound it:
|y_k| <= sum(f) e. With M the largest such sum, and e(r) = room + r room + bend r^2 where |y| = r,

    |y| = r and M e(r) < r

contradict each other. So a motion, which is continuous and begins at 0, never gets as far as r. Locked to first order alone would not
do: without the rooms and the curvature one could not tell a lock from a hook shorter than the play of its neighbours.

Source: Rimon and Burdick 1998 for the immobility of bodies by contacts of first and second order; the bound here is elementary.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE, OVERLAP_TOLERANCE
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.form_closure.point_contacts import OutlineEdges, ignored_parts, placed_outlines, rigid_bodies

if TYPE_CHECKING:
    from scipy import sparse


Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_AT_ONCE = 40
"""Groups of bodies whose contacts are looked at together, at most: every one needs six linear programs."""
MAX_SUM = 1e7
"""Forces that must add up to more prove nothing that rounding leaves."""

INSETS = 1 / 64, 1 / 8
"""Two edges that lie along each other touch at points this share of their common stretch inside both its ends."""
MIN_MITRE = 1e-3
"""Corners sharper than this leaves them are not followed to their inside."""
MIN_VALID_SHARE = 1e-7
"""Contacts that hold for motions of less than this share of the drawing's size only are left out."""
ROUNDING = 64 * float(np.finfo(np.float64).eps)
"""Coordinates are as exact as this share of the largest of them."""


@dataclass(frozen=True, eq=False)
class ClosureBound:
    """Which bodies their contacts lock.

    Parameters
    ----------
    group : (n,) int64
        Bodies of the same number certainly stay together.
    far : (n,) float64 [mm]
        How far no point of a body ever gets from where it would be, did it move as one with the first body of its group: with what
        stands where that is in it.
    body_of : (parts,) int64
        Body of each part.
    """

    group: Ints
    far: Floats
    body_of: Ints

    @property
    def all_locked(self) -> bool:
        """True where all bodies are locked together."""
        return bool((self.group == self.group[0]).all())


def closure_bound(assembly: Assembly, context: Context = UNLIMITED) -> ClosureBound:
    """Find the bodies that contacts lock: pairs first, then what these have become, in the end all at once.

    Parameters
    ----------
    assembly : Assembly
        As made; contacts with a gap of next to nothing count with it.
    context : Context, optional

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = closure_bound(wr.patterns.chain(3, "swallowtail", gap=0.0))
    >>> found.all_locked, bool(found.far.max() < 1e-4)
    (True, True)
    >>> closure_bound(wr.patterns.chain(3, "finger", gap=0.0)).group.tolist()
    [0, 1, 2]
    """
    contacts = finite_contacts(assembly)
    group, far = np.arange(contacts.count), np.zeros(contacts.count)
    known: dict[bytes, Floats | None] = {}
    again = True
    while again and not context.stopped:
        again = False
        for a, b in _touching_groups(contacts, group):
            if context.stopped:
                break
            pair = np.unique(group[[a, b]])
            if len(pair) == 2 and (moved := _locked(contacts, group, far, pair, known, context)) is not None:
                group, far = _joined(group, moved, pair, contacts.ground)
                again = True
    every = np.unique(group)
    if 2 < len(every) <= MAX_AT_ONCE and not context.stopped:
        moved = _locked(contacts, group, far, every, {}, context)
        if moved is not None:
            group, far = _joined(group, moved, every, contacts.ground)
    return ClosureBound(group, far, contacts.body_of)


def _touching_groups(contacts: FiniteContacts, group: Ints) -> Iterable[tuple[int, int]]:
    """One body of either of two groups that touch, each pair of groups once."""
    pairs = np.sort(group[np.column_stack([contacts.a, contacts.b])], axis=1)
    return [(int(a), int(b)) for a, b in np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)]


def _first(some: Ints, group: Ints, ground: int) -> int:
    """The group that counts as standing: that of what stands, else the one of the lowest number."""
    return int(group[ground]) if group[ground] in some else int(some[0])


def _joined(group: Ints, far: Floats, some: Ints, ground: int) -> tuple[Ints, Floats]:
    return np.where(np.isin(group, some), _first(some, group, ground), group), far


def _locked(
    contacts: FiniteContacts, group: Ints, far: Floats, some: Ints, known: dict[bytes, Floats | None], context: Context
) -> Floats | None:
    """How far bodies get (n,) [mm] once some groups count as one, where contacts lock these; else None."""
    a, b = group[contacts.a], group[contacts.b]
    rows = np.flatnonzero((a != b) & np.isin(a, some) & np.isin(b, some))
    unknowns = 3 * (len(some) - 1)
    if len(rows) <= unknowns:
        return None
    root = _first(some, group, contacts.ground)
    others = some[some != root]
    point = contacts.point[rows]
    middle = point.mean(0)
    unit = float(np.abs(point - middle).max())
    if not unit > 0:
        return None
    B = _rows((point - middle) / unit, contacts.normal[rows], np.searchsorted(others, a[rows]), np.searchsorted(others, b[rows]),
              a[rows] != root, b[rows] != root, unknowns)  # fmt: skip
    key = np.round(B.toarray(), 6).tobytes() if unknowns == 3 else b""
    force = known[key] if key in known else _bounding_forces(B, context)
    known[key] = force  # of congruent pairs it is looked for once, and judged for each
    if force is None:
        return None
    balance = np.concatenate([np.eye(unknowns), -np.eye(unknowns)])
    loose = np.abs(force @ B - balance).sum(1).max()
    worth = force.sum(1).max()
    if not (worth < MAX_SUM and loose + 1e-15 * len(rows) * worth < 0.5):
        return None
    wobble = far[contacts.a[rows]] + far[contacts.b[rows]]
    room = float((contacts.room[rows] + 3 * wobble).max()) / unit
    spread = float(np.hypot(*((point - middle) / unit).T).max())
    speed = 2 * (np.sqrt(2) + spread)  # of a point as an edge sees it, per unit of |y|
    r = 2 * worth * room / (1 - loose)
    error = room + r * room + (speed + spread) * r * r
    shift = float(speed * r * unit + (contacts.room[rows] + wobble).max())
    if not (worth * error < r * (1 - loose) and shift < contacts.valid[rows].min() and r < 0.1):
        return None
    corner_group = group[contacts.body]
    moved = far.copy()
    for g in others.tolist():
        reach = float(np.hypot(*(contacts.corner[corner_group == g] - middle).T).max())
        moved[group == g] += r * (np.sqrt(2) * unit + reach)
    return moved


def _rows(
    arm: Floats, normal: Floats, a: Ints, b: Ints, a_moves: NDArray[np.bool_], b_moves: NDArray[np.bool_], unknowns: int
) -> sparse.csr_array:
    """Rows (k, unknowns): how fast points come away from edges, per shift along x and y and turn of every group that moves."""
    from scipy import sparse  # slow to load

    wrench = np.column_stack([normal, arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]])
    blocks = sparse.csr_array((len(arm), unknowns))
    for which, moves, sign in ((b, b_moves, 1.0), (a, a_moves, -1.0)):
        row = np.flatnonzero(moves)
        column = (3 * which[row])[:, None] + np.arange(3)
        blocks = blocks + sparse.csr_array(
            (sign * wrench[row].ravel(), (np.repeat(row, 3), column.ravel())), shape=(len(arm), unknowns)
        )
    return blocks


def _bounding_forces(B: sparse.csr_array, context: Context) -> Floats | None:
    """Forces (2 d, k) >= 0 of least sum with B^T f the unit vectors, and then their negatives; None where there are none."""
    from scipy.optimize import linprog  # slow to load

    k, d = B.shape
    if len(np.unique(B.indices)) < d:
        return None
    force = []
    for sign in (1.0, -1.0):
        for unknown in range(d):
            aim = np.zeros(d)
            aim[unknown] = sign
            if context.stopped:
                return None
            done = linprog(np.ones(k), A_eq=B.T, b_eq=aim, bounds=(0, None), method="highs")
            if done.status != 0:
                return None
            force.append(np.maximum(done.x, 0.0))
    return np.array(force)


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
