"""Proofs that bodies stay together: no motion of two of them, whatever the others do, takes them apart.

The poses of one body against another that may be reached from rest are covered by cells, so coarse that what is nearly free counts
as free. Where the cover is closed all round by blocked cells, the two never part. Bodies that such pairs hold together, and to what
stands, are interlocked. Of a body that is round about an axis, or of all that stands where one of its bodies is, the cylinders inside
are looked at, for which turns about the axis do not count: then cells have five axes in place of six.

Source: Zhang, Kim and Manocha, "Efficient cell labelling and path non-existence computation using C-obstacle query" (2008).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import placed_surface
from wiggleroom.context import Context
from wiggleroom.drawing.model import ConvexPiece, Surface
from wiggleroom.spatial.overlaps.pose_cells import CLOSED, FACES, PAUSED, cover
from wiggleroom.spatial.proof.caging import ball_stays, in_closed_cavity
from wiggleroom.spatial.proof.inscribed_ball import inscribed_ball
from wiggleroom.spatial.proof.linking_number import RingBody, held_by_opening, linked
from wiggleroom.spatial.proof.narrow_windows import behind_narrow_windows
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.search.turning_in_place import common_edges, round_centres
from wiggleroom.spatial.solids.convex import prism

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MARGIN = 1e-6
"""Cells are blocked where pieces overlap by more than this share of the bodies' reach: edges that are parallel but for rounding are left
out of the axes, which hides up to a hundredth of it."""
COORDINATE_ROUNDING = 64 * float(np.finfo(np.float64).eps)
"""Corners at rest are as exact as this share of the largest coordinate."""
MIN_WIDTH = 1e-7
"""No cell may be narrower than this share of the reach: neighbours are looked for a thousandth of that beyond its faces."""
PERPENDICULAR = 1e-6
"""Unit vectors are perpendicular up to this product."""
MAX_WINDOWS = 100
"""Windows are looked at for at most so many pairs of bodies."""
VISITS = 200
"""So many cells are looked at before the request to stop is."""

SIDES = 16
"""A cylinder is a prism of so many sides inside it."""
SAME_LEVEL = 1e-6
"""Corners at levels that differ by a smaller share of the height are at one, but for rounding."""
THIN = 1e-3
"""Cylinders of a smaller share of the largest radius are left out."""


@dataclass(frozen=True)
class CoverEffort:
    """How fine a cover is.

    Parameters
    ----------
    free_width, blocked_width : float
        Shares of the size of where two bodies meet, down to which cells are split whose middle seems free, or is blocked.
    cells : int
        At most.
    """

    free_width: float
    blocked_width: float
    cells: int


EFFORTS = (
    CoverEffort(1 / 18, 1 / 54, 4000),
    CoverEffort(1 / 18, 1 / 54, 30_000),
    CoverEffort(1 / 54, 1 / 160, 100_000),
)
"""One after the other: most pairs that are held are shown to be by the first or the second."""


@dataclass(eq=False)
class PairwiseConfinement:
    """Which bodies are shown to stay together.

    Parameters
    ----------
    ready : SpatialPrepared
    context : Context
    """

    ready: SpatialPrepared
    context: Context
    _group: list[int] = field(init=False)
    _rings: dict[int, RingBody] = field(init=False, default_factory=dict)
    _windows: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        moves = self.ready.grouping.bodies.moves
        stands = int(np.flatnonzero(~moves)[0]) if not moves.all() else -1
        self._group = [k if moves[k] else stands for k in range(len(moves))]

    @property
    def complete(self) -> bool:
        """True once all bodies are held together, and so to what stands."""
        return len(set(self._group)) == 1

    def prove_by_shape(self) -> bool:
        """Look for bodies that are linked, and for those that lie in a cage of others, whatever the cells say; True once all are held."""
        units = self._units
        for one, two in itertools.combinations(units, 2):
            if self._apart(one, two) and (self._linked(one, two) or self._caged(one, two) or self._caged(two, one)):
                self._join(one, two)
        return self.complete

    def prove(self, effort: CoverEffort) -> bool:
        """Look at pairs of bodies that are not held together yet, until all are, or one is held by none; True once all are."""
        units = self._units
        for unit in units:
            for other in units:
                one, two = (other, unit) if len(other) > 1 else (unit, other)
                if self._apart(one, two) and self._closed_in(one, two, effort):
                    self._join(one, two)
            if self._group.count(self._group[unit[0]]) == len(unit) and len(units) > 1:
                break
        return self.complete

    @cached_property
    def _units(self) -> list[list[int]]:
        """All bodies that stand, and each of the others."""
        moves = self.ready.grouping.bodies.moves
        still = np.flatnonzero(~moves).tolist()
        return [*([still] if still else []), *([k] for k in np.flatnonzero(moves).tolist())]

    def _apart(self, one: list[int], two: list[int]) -> bool:
        """True where two neighbours are not known to be held together, and nobody asked to stop."""
        return not self._stopped() and self._group[one[0]] != self._group[two[0]] and self._near(one, two)

    def _join(self, one: list[int], two: list[int]) -> None:
        a, b = self._group[one[0]], self._group[two[0]]
        self._group = [a if g == b else g for g in self._group]

    def _linked(self, one: list[int], two: list[int]) -> bool:
        """True where closed curves in two bodies go through each other, and no two of their parts ignore each other."""
        first, second = (self._parts(unit) for unit in (one, two))
        if any((min(p, q), max(p, q)) in self.ready.grouping.bodies.ignored for p in first for q in second):
            return False
        mine, theirs = self._ring(one), self._ring(two)
        return linked(mine.closed, theirs.closed) or held_by_opening(mine, theirs) or held_by_opening(theirs, mine)

    def _ring(self, unit: list[int]) -> RingBody:
        """Pieces, surfaces and closed curves of some bodies at rest; worked out once."""
        if unit[0] not in self._rings:
            assembly = self.ready.assembly
            surfaces = [placed_surface(assembly.parts[k], assembly.solids[k].surface) for k in self._parts(unit)]
            self._rings[unit[0]] = RingBody(self._framed(unit, np.eye(3), np.zeros(3))[0], surfaces)
        return self._rings[unit[0]]

    def _parts(self, unit: list[int]) -> list[int]:
        return np.flatnonzero(np.isin(self.ready.grouping.body_of, unit)).tolist()

    def _caged(self, one: list[int], two: list[int]) -> bool:
        """True where something of the second lies in a closed cavity of the first, or holds a ball, or a piece, that cannot leave it."""
        if self._stopped() or len(two) > 1:
            return False
        assembly, ignored = self.ready.assembly, self.ready.grouping.bodies.ignored
        cage, owner = self._framed(one, np.eye(3), np.zeros(3))
        inner, whose = self._framed(two, np.eye(3), np.zeros(3))
        ball: tuple[float, Floats, int, ConvexPiece] | None = None
        low, high = self._box(one)
        for piece, part in zip(inner, whose, strict=True):
            if not ((piece.corners.mean(axis=0) > low) & (piece.corners.mean(axis=0) < high)).all():
                continue
            around = [k for k in self._parts(one) if (min(k, part), max(k, part)) not in ignored]
            for k in around:
                world = placed_surface(assembly.parts[k], assembly.solids[k].surface)
                if in_closed_cavity(world, piece.corners[:1]):
                    return True
            middle, radius = inscribed_ball(piece)
            if ball is None or radius > ball[0]:
                ball = radius, middle, part, piece
        if ball is None:
            return False
        radius, middle, part, piece = ball
        facing = [p for p, k in zip(cage, owner, strict=True) if (min(k, part), max(k, part)) not in ignored]
        if radius <= 0 or not facing:
            return False
        if ball_stays(facing, middle, radius, self.context):
            return True
        self._windows += 1
        return self._windows <= MAX_WINDOWS and behind_narrow_windows(facing, piece, self.context)

    def _near(self, one: Sequence[int], other: Sequence[int]) -> bool:
        """True where boxes round bodies at rest meet."""
        (low1, high1), (low2, high2) = self._box(one), self._box(other)
        return bool((np.minimum(high1, high2) > np.maximum(low1, low2)).all())

    def _box(self, unit: Sequence[int]) -> tuple[Floats, Floats]:
        bodies = self.ready.grouping.bodies
        corners = np.vstack([p.corners + bodies.at[k] for k in unit for p in bodies.pieces[k]])
        return corners.min(axis=0), corners.max(axis=0)

    def _closed_in(self, one: list[int], other: list[int], effort: CoverEffort) -> bool:
        """True where two bodies, one of which may be all that stand, are shown never to part."""
        asked = [(one, other, True), (other, one, True), (one, other, False)]
        return any(self._closed(a, b, as_round, effort) for a, b, as_round in asked if not self._stopped())

    def _closed(self, one: list[int], two: list[int], as_round: bool, effort: CoverEffort) -> bool:
        """True where the cover of the poses of some bodies against others is closed; as round ones if asked."""
        ready = self.ready
        bodies = ready.grouping.bodies
        (low1, high1), (low2, high2) = self._box(one), self._box(two)
        low, high = np.maximum(low1, low2), np.minimum(high1, high2)
        origin, size = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
        body = next((k for k in two if self._round_centre(k)), -1) if as_round else two[0]
        if body < 0:
            return False
        edges = common_edges(ready, body)
        z = edges[0]
        if as_round:
            through = self._round_centre(body)[0] + bodies.at[body]
            origin = through + ((origin - through) @ z) * z
        x = next((e for e in edges[1:] if abs(e @ z) < PERPENDICULAR), np.linalg.svd(z[None])[2][1])
        x = x - (x @ z) * z
        x /= np.linalg.norm(x)
        frame = np.array([x, np.cross(z, x), z])
        mine, owner = self._framed(two, frame, origin)
        theirs, whose = self._framed(one, frame, origin)
        if as_round:
            mine, owner = self._cylinders(two, frame, origin)
            if len(mine) < 2:
                return False
        ignored = bodies.ignored
        allowed = np.array([[(min(p, q), max(p, q)) not in ignored for q in owner] for p in whose])
        A, B = packed_pieces(theirs), packed_pieces(mine)
        half_box = float(np.linalg.norm(A[0], axis=1).max() + np.linalg.norm(B[0], axis=1).max())
        if min(effort.free_width, effort.blocked_width) * size < MIN_WIDTH * half_box:
            return False
        margin = MARGIN * half_box + COORDINATE_ROUNDING * float(np.abs([*self._box(one), *self._box(two)]).max())
        most = effort.cells
        tree = (
            np.empty((most, 6)), np.empty((most, 6)), np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64),
        )  # fmt: skip
        heap = np.empty(FACES * most), np.empty(FACES * most, np.int64)
        counts = np.zeros(4, np.int64)
        ended = PAUSED
        while ended == PAUSED and not self._stopped():
            ended = cover(
                A, B, allowed, as_round, half_box, effort.free_width * size, effort.blocked_width * size, margin,
                tree, heap, counts, VISITS,
            )  # fmt: skip
        return bool(ended == CLOSED)

    def _framed(self, unit: Sequence[int], frame: Floats, origin: Floats) -> tuple[list[ConvexPiece], list[int]]:
        """Pieces of bodies in a frame at rest, and the part of each."""
        bodies = self.ready.grouping.bodies
        pieces = [p.placed(frame, frame @ (bodies.at[k] - origin)) for k in unit for p in bodies.pieces[k]]
        return pieces, [part for k in unit for part in bodies.owner[k].tolist()]

    def _round_centre(self, body: int) -> list[Floats]:
        """A point of the axis about which a body is round, in its frame, or none."""
        return round_centres(self.ready, body, common_edges(self.ready, body)[0])

    def _cylinders(self, unit: list[int], frame: Floats, origin: Floats) -> tuple[list[ConvexPiece], list[int]]:
        """Cylinders inside the parts of bodies round the z axis of a frame, and the part of each."""
        assembly = self.ready.assembly
        pieces: list[ConvexPiece] = []
        owner: list[int] = []
        for k in self._parts(unit):
            part, surface = assembly.parts[k], assembly.solids[k].surface
            world = surface.vertices @ part.R.T + part.at
            found = inscribed_cylinders(Surface((world - origin) @ frame.T, surface.faces))
            pieces += found
            owner += [k] * len(found)
        return pieces, owner

    def _stopped(self) -> bool:
        return self.context.stopped


def packed_pieces(pieces: Sequence[ConvexPiece]) -> tuple[Any, ...]:
    """Corners, normals and edges of all pieces, where those of each begin, and the middle, radius and largest coordinates of each."""
    rows = [[getattr(p, kind) for p in pieces] for kind in ("corners", "normals", "edges")]
    begins = [np.cumsum([0, *(len(r) for r in some)]) for some in rows]
    middle = np.array([(p.corners.min(axis=0) + p.corners.max(axis=0)) / 2 for p in pieces])
    radius = np.array([np.linalg.norm(p.corners - m, axis=1).max() for p, m in zip(pieces, middle, strict=True)])
    reach = np.array([np.abs(p.corners).max(axis=0) for p in pieces])
    return (*(np.ascontiguousarray(np.vstack(some)) for some in rows), *begins, middle, radius, reach)


def inscribed_cylinders(surface: Surface) -> list[ConvexPiece]:
    """Prisms inside a closed surface, all inside cylinders round the z axis.

    Between two levels of corners the radius is that of the nearest point of the surface. A cylinder goes on through all neighbouring
    levels where there is room for it.

    Examples
    --------
    >>> import itertools
    >>> corners = np.array(list(itertools.product((-1.0, 1.0), (-2.0, 2.0), (0.0, 5.0))))
    >>> faces = [[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5], [2, 3, 7], [2, 7, 6], [0, 6, 4], [0, 2, 6]]
    >>> faces += [[1, 5, 7], [1, 7, 3]]
    >>> (cylinder,) = inscribed_cylinders(Surface(corners, np.array(faces)))
    >>> np.ptp(cylinder.corners, axis=0).round(9).tolist()
    [2.0, 2.0, 5.0]
    """
    triangles = surface.vertices[surface.faces]
    levels = np.sort(surface.vertices[:, 2])
    rounding = SAME_LEVEL * float(np.ptp(levels))
    first = np.diff(levels, prepend=-np.inf) > rounding
    last = np.append(first[1:], True)
    between = zip(levels[last] + rounding, levels[first][1:] - rounding, strict=False)
    radius = np.array([_free_radius(triangles, low, high) for low, high in between])
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    found: dict[tuple[int, int], float] = {}
    for r in np.unique(radius[radius > THIN * radius.max(initial=0.0)]).tolist():
        room = np.flatnonzero(np.diff(np.concatenate([[False], radius >= r, [False]])))
        found |= {(int(k), int(m)): r for k, m in room.reshape(-1, 2)}  # of one length the widest
    return [prism(r * circle, float(levels[last][k]), float(levels[first][m])) for (k, m), r in found.items()]


def _free_radius(triangles: Floats, low: float, high: float) -> float:
    """Distance from the z axis [mm] of the nearest point of triangles (t, 3, 3) between two levels; 0 where the axis is outside."""
    middle = (low + high) / 2
    if _winding(triangles, middle) < 0.5:
        return 0.0
    near = np.inf
    for triangle in triangles[(triangles[:, :, 2].max(axis=1) > low) & (triangles[:, :, 2].min(axis=1) < high)]:
        flat = _clipped(_clipped(triangle, low, 1.0), high, -1.0)[:, :2]
        if len(flat) > 1:
            near = min(near, _distance_from_origin(flat))
    return float(near) if np.isfinite(near) else 0.0


def _winding(triangles: Floats, level: float) -> float:
    """How often closed triangles go round the point of the z axis at a level: their solid angle, by van Oosterom and Strackee 1983."""
    a, b, c = (triangles[:, k] - [0.0, 0.0, level] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("td,td->t", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("td,td->t", a, b) * lc
    below += np.einsum("td,td->t", b, c) * la + np.einsum("td,td->t", c, a) * lb
    return float(2 * np.arctan2(volume, below).sum() / (4 * np.pi))


def _clipped(polygon: Floats, level: float, sign: float) -> Floats:
    """The part of a polygon (k, 3) above a level, or below it where the sign is negative."""
    kept: list[Floats] = []
    for one, two in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        s, t = sign * (one[2] - level), sign * (two[2] - level)
        if s >= 0:
            kept.append(one)
        if s * t < 0:
            kept.append(one + s / (s - t) * (two - one))
    return np.array(kept).reshape(-1, 3)


def _distance_from_origin(polygon: Floats) -> float:
    """Distance of the origin from a convex polygon (k, 2), 0 inside."""
    ahead = np.roll(polygon, -1, axis=0)
    edge = ahead - polygon
    side = edge[:, 0] * polygon[:, 1] - edge[:, 1] * polygon[:, 0]
    if len(polygon) > 2 and ((side > 0).all() or (side < 0).all()):
        return 0.0
    length = np.maximum((edge**2).sum(axis=1), 1e-300)
    share = np.clip(-(polygon * edge).sum(axis=1) / length, 0.0, 1.0)
    return float(np.linalg.norm(polygon + share[:, None] * edge, axis=1).min())
