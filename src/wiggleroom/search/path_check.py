"""The path from rest: waypoints that the audit vouches for, with more of them where straight motion cuts a corner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.audit.audit_outlines import AuditOutlines
from wiggleroom.audit.path_audit import PathAudit, audit_path
from wiggleroom.deadline import GracePeriod
from wiggleroom.errors import Stop
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.search.incumbent import PathSegment
from wiggleroom.search.prepare import Prepared
from wiggleroom.solve.factorisation import Factor, factor

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_SPLITS = 12
"""A piece of the path is halved at most this often."""
SPLIT_BATCH = 32
"""Number of pieces that are halved before the next audit, first pieces first: where one of them fails, the rest is of no use."""
MAX_PIECES, LATE_PIECES, MIN_PIECES = 500_000, 40_000, 4
"""Pieces, times bodies, that are audited at once, as memory allows; the same after a request to stop, which takes some tenths of a
second; and the fewest pieces."""
MOVED_AT_ONCE = 100_000
"""Bodies, times waypoints, whose parts' motions are worked out at once."""
MAX_UNKNOWN_SPLITS = 3
"""The same where the pair that may overlap on it is not in its program."""


@dataclass(frozen=True, eq=False)
class _Point:
    """A waypoint: variables in the program of a leg, the point of the leg at or before it, and how often its piece was halved."""

    segment: int
    index: int
    u: Floats
    depth: int


@dataclass(frozen=True, eq=False)
class CheckedPath:
    """A path from rest.

    Parameters
    ----------
    segments : tuple of PathSegment
        Its legs.
    points : tuple
        Its waypoints, those between points of the search included.
    certain : int
        Number of waypoints up to which certainly no two parts overlap anywhere.
    kept : tuple of PathSegment
        The legs up to the last point of the search that is certain.
    missed : (p,) and (p,) int64
        Pairs of bodies that may overlap and are not in the program of the last of these legs.
    """

    segments: tuple[PathSegment, ...]
    points: tuple[_Point, ...]
    certain: int
    kept: tuple[PathSegment, ...]
    missed: tuple[Ints, Ints]

    @property
    def sure(self) -> bool:
        """True where nothing overlaps anywhere along the path."""
        return self.certain == len(self.points)

    def motion(self, k: int) -> Floats:
        """A waypoint (n, 3) [mm, mm, rad] of the bodies: all at once are much in a large assembly."""
        return np.asarray(_motions(self.segments, (self.points[k],))[0])

    def motions(self) -> Floats:
        """All waypoints (k, n, 3) [mm, mm, rad] of the bodies."""
        return _motions(self.segments, self.points)

    def waypoints(self, ready: Prepared, count: int) -> Floats:
        """The first waypoints (count, parts, 3) [mm, mm, rad] of the parts, about the reference points, which move straight in between."""
        return _waypoints(ready, self.segments, self.points[:count])


@dataclass(frozen=True, eq=False)
class CertainPrefix:
    """The beginning of a path, as far as it was audited already.

    Parameters
    ----------
    segments : tuple of PathSegment
        The legs of the path, which may go on.
    points : tuple
        Its waypoints, those between points of the search included, from rest to the last that is certain.
    """

    segments: tuple[PathSegment, ...] = ()
    points: tuple[_Point, ...] = ()

    def along(self, segments: Sequence[PathSegment]) -> list[_Point]:
        """Those of its waypoints that are on another path as well, up to the last common point of the search; at least the first."""
        common, last = (0, 0), 0
        for k, (own, other) in enumerate(zip(self.segments, segments, strict=False)):
            if own.program is not other.program:
                break
            pairs = zip(own.points, other.points, strict=False)
            same = next((i for i, (u, v) in enumerate(pairs) if u is not v and not np.array_equal(u, v)), None)
            end = min(len(own.points), len(other.points)) if same is None else same
            if end:
                common = k, end - 1
            if same is not None or len(own.points) != len(other.points):
                break
        for number, point in enumerate(self.points):
            at = point.segment, point.index
            if at <= common and point.u is self.segments[at[0]].points[at[1]]:
                last = number
        return list(self.points[: last + 1]) or [_Point(0, 0, segments[0].points[0], 0)]


def check_path(
    ready: Prepared, segments: Sequence[PathSegment], stop: Stop | None = None, known: CertainPrefix | None = None
) -> CheckedPath:
    """Check a path that consists of legs, each inside the cells of one program.

    Pieces of which the audit is not certain are halved, with waypoints inside the cells, as long as that may help. What is `known` is not
    audited again. Once it is asked to stop, the audit goes on for what is left of a grace period; up to where it gets the path is certain.
    """
    begun = (known or CertainPrefix()).along(segments)
    points, certain, audit = _audited(ready, segments, begun, stop)
    if certain == len(points):
        none = np.zeros(0, dtype=np.int64)
        return CheckedPath(tuple(segments), tuple(points), len(points), tuple(segments), (none, none))
    last = points[max(certain - 1, 0)]
    kept = (
        *segments[: last.segment],
        PathSegment(segments[last.segment].program, segments[last.segment].points[: last.index + 1]),
    )
    strangers = missed(ready.bodies, audit, kept[-1].program)
    return CheckedPath(tuple(segments), tuple(points), certain, kept, strangers)


def certain_prefix(
    ready: Prepared, segments: Sequence[PathSegment], stop: Stop | None, known: CertainPrefix
) -> CertainPrefix:
    """What is certain of a path that may go on, from what is `known`."""
    points, certain, _ = _audited(ready, segments, known.along(segments), stop)
    return CertainPrefix(tuple(segments), tuple(points[:certain]))


def _audited(
    ready: Prepared, segments: Sequence[PathSegment], begun: list[_Point], stop: Stop | None
) -> tuple[list[_Point], int, PathAudit]:
    """Waypoints of a path whose first ones are certain, up to how many of them it is, and the audit that ended it.

    After a request to stop a few pieces are audited at a time, so that those which are certain by the end of the grace period count.
    """
    late = stop.end if isinstance(stop, GracePeriod) else stop
    last = begun[-1]
    points = [last]
    points += [
        _Point(k, i, u, 0)
        for k, segment in enumerate(segments)
        for i, u in enumerate(segment.points)
        if i and (k, i) > (last.segment, last.index)
    ]
    before = begun[:-1]
    while True:
        stopped = stop is not None and stop.is_set()
        end = 1 + max(MIN_PIECES, (LATE_PIECES if stopped else MAX_PIECES) // len(ready.bodies.fixed))
        ahead, rest = points[:end], points[end:]
        audit = audit_path(ready.outlines, _waypoints(ready, segments, ahead), late)
        free = audit.free
        if not free and audit.certain and not (stop is not None and stop.is_set()):
            ahead, free = _refined(ready, segments, ready.outlines, ahead, audit, stop)
            if not free:  # else every piece has been judged already
                audit = audit_path(ready.outlines, _waypoints(ready, segments, ahead), late)
        if not free:
            return [*before, *ahead, *rest], len(before) + audit.certain, audit
        if not rest:
            return [*before, *ahead], len(before) + len(ahead), audit
        before, points = [*before, *ahead[:-1]], [ahead[-1], *rest]


def missed(bodies: Bodies, audit: PathAudit, program: Program) -> tuple[Ints, Ints]:
    """Pairs of bodies a < b that may overlap on a path and are not in a program."""
    n, cells = len(bodies.fixed), program.cells
    pairs = np.sort(bodies.body_of[np.column_stack([audit.a, audit.b])], axis=1).reshape(-1, 2)
    keys = np.setdiff1d(pairs[:, 0] * n + pairs[:, 1], cells.a * n + cells.b)
    return keys // n, keys % n


def missed_at(ready: Prepared, motions: Floats, program: Program) -> tuple[Ints, Ints]:
    """The same for waypoints (k, n, 3) [mm, mm, rad] of the bodies; pairs in the program are not looked at."""
    known = _part_pairs(ready.bodies.body_of, program.cells.a, program.cells.b)
    others = replace(ready.outlines, ignored=np.concatenate([ready.outlines.ignored, known]))
    return missed(ready.bodies, audit_path(others, of_parts(ready.assembly, ready.bodies, motions)), program)


def _part_pairs(body_of: Ints, a: Ints, b: Ints) -> Ints:
    """Keys p * n + q, p < q, of the pairs of parts that belong to pairs of bodies; `body_of` (n,) is the body of every part."""
    order, count = np.argsort(body_of, kind="stable"), np.bincount(body_of)
    first, many = np.cumsum(count) - count, count[a] * count[b]
    pair = np.repeat(np.arange(len(a)), many)
    k = np.arange(len(pair)) - np.repeat(np.cumsum(many) - many, many)
    p = order[first[a[pair]] + k // count[b[pair]]]
    q = order[first[b[pair]] + k % count[b[pair]]]
    return np.asarray(np.minimum(p, q) * len(body_of) + np.maximum(p, q))


def _motions(segments: Sequence[PathSegment], points: Sequence[_Point]) -> Floats:
    return np.array([segments[p.segment].program.motion(p.u) for p in points])


def _waypoints(ready: Prepared, segments: Sequence[PathSegment], points: Sequence[_Point]) -> Floats:
    out = np.empty((len(points), len(ready.assembly.parts), 3))
    few = max(1, MOVED_AT_ONCE // len(ready.bodies.fixed))
    for k in range(0, len(points), few):
        out[k : k + few] = of_parts(ready.assembly, ready.bodies, _motions(segments, points[k : k + few]))
    return out


def _refined(
    ready: Prepared,
    segments: Sequence[PathSegment],
    parts: AuditOutlines,
    points: list[_Point],
    audit: PathAudit,
    stop: Stop | None,
) -> tuple[list[_Point], bool]:
    """The path with more points on the doubtful pieces, one stretch of them after the other; True where all are free now."""
    out: list[_Point] = []
    begin = 0
    doubtful, refiner = audit.doubtful, _Refiner(segments)
    while begin < len(points):
        out.append(points[begin])
        end = begin
        while end < len(doubtful) and doubtful[end]:
            end += 1
        if end > begin:
            stretch, certain = _refined_stretch(ready, segments, parts, points[begin : end + 1], refiner, stop)
            out += stretch[1:-1]
            if not certain:  # what comes later is of no use
                return [*out, *points[end:]], False
        begin = max(end, begin + 1)
    return out, True


def _refined_stretch(
    ready: Prepared,
    segments: Sequence[PathSegment],
    parts: AuditOutlines,
    points: list[_Point],
    refiner: _Refiner,
    stop: Stop | None,
) -> tuple[list[_Point], bool]:
    """Halve the doubtful pieces of a stretch until none is left, or that does not help; True where none is."""
    doubtful = np.ones(len(points) - 1, dtype=bool)
    while True:
        halved = set(np.flatnonzero(doubtful)[:SPLIT_BATCH].tolist())
        finer = [points[0]]
        for k, after in enumerate(points[1:]):
            if k in halved:
                finer.append(refiner.middle(points[k], after))
            finer.append(replace(after, depth=after.depth + (k in halved)))
        points = finer
        audit = audit_path(parts, _waypoints(ready, segments, points), stop)
        doubtful = audit.doubtful
        if audit.free:
            return points, True
        if stop is not None and stop.is_set():
            return points, False
        k = int(doubtful.argmax())
        stranger = len(missed(ready.bodies, audit, segments[points[k + 1].segment].program)[0]) > 0
        if audit.certain == 0 or points[k + 1].depth >= (MAX_UNKNOWN_SPLITS if stranger else MAX_SPLITS):
            return points, False


class _Refiner:
    """Waypoints in between, inside the cells of each leg's program."""

    def __init__(self, segments: Sequence[PathSegment]) -> None:
        self._segments = segments
        self._tools: dict[int, tuple[Retraction, Factor]] = {}

    def middle(self, before: _Point, after: _Point) -> _Point:
        """The waypoint half way between two that follow each other."""
        segment = after.segment
        program = self._segments[segment].program
        if segment not in self._tools:
            self._tools[segment] = Retraction(program), factor(program.pattern)
        u = before.u
        if before.segment != segment:
            u = program.variables(self._segments[before.segment].program.motion(u))
        index = before.index if before.segment == segment else 0
        return _Point(segment, index, _middle(program, *self._tools[segment], u, after.u), after.depth + 1)


def _middle(program: Program, retraction: Retraction, matrix: Factor, u: Floats, v: Floats) -> Floats:
    """A point half way between two, moved until its rows are about the mean of theirs, where they fell behind.

    Rows that do not hold at one of the two are left alone: such pairs are far apart, behind their walls. Where rows would drive
    it far aside it stays half way.
    """
    at_u, at_v = program.values(u), program.values(v)
    target = (np.minimum(at_u, at_v) > 0) * (at_u + at_v) / 2
    between = middle = retraction.between(u, v)
    weight, none = np.where(target > 0, 1.0 / np.maximum(target, 1e-12) ** 2, 0.0), np.zeros_like(target)
    del at_u, at_v  # in assemblies of a million parts these arrays count
    at = None
    for _ in range(10):
        at = program.linearise(middle, at)
        short = np.where(target > 0, np.maximum(target - at.h, 0.0), 0.0)
        if (short <= target / 2).all():
            break
        shift = 1e-6
        while not matrix.update(at.condensed(weight, none, share=0.0), shift):
            shift *= 100
        middle = retraction.step(middle, matrix.solve(at.transposed_jacobian_product(weight * short)), at)
    halves = np.abs(middle - between).max() <= np.abs(v - u).max() / 2  # else pieces would not get shorter
    return middle if halves else between
