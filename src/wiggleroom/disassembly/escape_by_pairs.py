"""Bodies that leave their neighbours one after the other, each along the path that is free for the two alone, while others make room.

Near the gap at which tabs slip out of their sockets, such a path is a needle's eye: boxes of motions find it for two bodies, searches for
largest motions of all do not.

Each step along a path is a linear program: the furthest that the body gets along its piece, in small motions of all bodies that distances
of corners from edges allow. The two themselves keep to the piece exactly, so a needle's eye between them costs nothing; the path audit
judges every step.

Source: sequential linear programming with a trust region, as in Conn, Gould and Toint, "Trust-Region Methods" (2000).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wiggleroom.audit.audit_outlines import AuditOutlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.closed_pairs import ClosedPairs, alone, decisive_passage
from wiggleroom.disassembly.escape_search import EXIT_TESTS, escape_path
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.translation import TranslationEscape
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.near_corners import corners_near_edges
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.geometry.rigid_motions import about, of_parts
from wiggleroom.search.prepare import NEIGHBOUR_REACH, Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_BODIES = 200
"""Where more bodies than this are loose, nothing is led: all are audited at every step."""
MAX_SETS = 4
"""So many sets of bodies are led out, those first that have the fewest neighbours."""
MAX_PASSAGES = 4
"""Sets that have to pass more neighbours than this are left out."""
MAX_LENGTH = 40.0
"""Paths that are longer than this multiple of the clearance before they go straight on are left out: steps are of half a clearance."""
BEYOND = 6.0
"""Once it is past a neighbour, a body is led on by this multiple of the clearance."""


NamedPairs = tuple[tuple[str, str], ...]

MAX_MOVING = 24
"""So many bodies make room at most, those nearest to the one that is led."""
TRUST = 0.5
"""In a step bodies are shifted, and turned at their rims, by at most this multiple of the clearance."""
MARGIN = 0.02
"""Bodies come no nearer to each other than this multiple of the clearance, where they are not so near already."""
EFFORT = 1e-3
"""Cost of a motion, as a share of its length: bodies that need not move stay."""
MIN_TRUST = 1e-3
"""A step that is not free even at this multiple of the clearance ends the motion."""
MAX_SPLITS = 4
"""A step that the audit does not pass is sampled twice as finely at most this many times."""
MAX_STEPS = 150
"""Steps along a piece, at most."""
MAX_SLOW, SLOW = 8, 0.02
"""It ends after so many steps in a row that get less far along the piece than this multiple of the clearance."""


@dataclass(frozen=True, eq=False)
class RelativePath:
    """A path of body b past body a that is free for the two alone.

    Parameters
    ----------
    a, b : int
    pivot : (2,) float64 [mm]
    path : (k, 3) float64 [mm, mm, rad]
        Motions of b about the pivot while a is at rest; straight between them.
    """

    a: int
    b: int
    pivot: Floats
    path: Floats


@dataclass(frozen=True, eq=False)
class EscapeByPairs:
    """Bodies led out.

    Parameters
    ----------
    path : (k, n, 3) float64 [mm, mm, rad]
        Audited motions of all bodies to where `exit` begins.
    exit : TranslationEscape
    pairs : tuple of pairs of names
        Who was led past whom, one after the other, by the first part of each body.
    """

    path: Floats
    exit: TranslationEscape
    pairs: NamedPairs


def escape_by_pairs(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> EscapeByPairs | None:
    """The first set of bodies tied together that can be led out past all of its neighbours; None where none is.

    Parameters
    ----------
    ready : Prepared
    known : ClosedPairs
        Of its pairs that are not decided those that matter are looked at with more boxes.
    passages : PassagesByGap
        Those known of pairs; what is found is added.
    context : Context, optional
    """
    if not 2 <= (~ready.bodies.fixed).sum() <= MAX_BODIES:  # nobody else makes room, or every step takes long
        return None
    for pairs in _sets(ready, known, passages, context):
        for first in range(len(pairs)):
            found = _out_by_pairs(ready, known.group, [pairs[first], *pairs[:first], *pairs[first + 1 :]], context)
            if found is not None:
                return found
    return None


def escape_by_known_pairs(
    ready: Prepared, group: Ints, pairs: NamedPairs, passages: PassagesByGap, context: Context = UNLIMITED
) -> EscapeByPairs | None:
    """The same by what led out at another gap; None where it does not at this one."""
    names, found = [ready.assembly.names[members[0]] for members in ready.bodies.members], []
    for pair in pairs:
        if not set(pair) <= set(names):
            return None
        a, b = (names.index(name) for name in pair)
        way = decisive_passage(ready, a, b, passages, context)
        if way is None or way.path is None:
            return None
        found.append(RelativePath(a, b, way.pivot, way.path))
    return _out_by_pairs(ready, group, found, context)


def _sets(
    ready: Prepared, known: ClosedPairs, passages: PassagesByGap, context: Context
) -> Iterator[list[RelativePath]]:
    """The neighbours that each set of bodies tied together has to pass, sets with the fewest first."""
    bodies = ready.bodies
    near = neighbours(bodies, placed(bodies), NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
    one, other = known.group[near.a], known.group[near.b]
    loose = np.setdiff1d(known.group, known.group[bodies.fixed])
    beside = {int(g): np.flatnonzero((one != other) & ((one == g) | (other == g))) for g in loose}
    undecided = {(int(a), int(b)) for a, b in known.undecided}
    for g in sorted(beside, key=lambda g: len(beside[g]))[:MAX_SETS]:
        found: list[RelativePath] = []
        for a, b in zip(near.a[beside[g]].tolist(), near.b[beside[g]].tolist(), strict=True):
            if context.stopped:
                return
            look = decisive_passage if (a, b) in undecided else alone
            way = look(ready, a, b, passages, context)
            if way is None:  # slides lead apart: it needs not be led
                continue
            if way.path is None or len(found) == MAX_PASSAGES:
                break
            found.append(RelativePath(a, b, way.pivot, way.path))
        else:
            if found:
                yield found


def _out_by_pairs(ready: Prepared, group: Ints, pairs: list[RelativePath], context: Context) -> EscapeByPairs | None:
    """Bodies led past one neighbour after the other, each time the first of those left that they can be led past."""
    ground = int(np.flatnonzero(ready.bodies.fixed)[0])
    path, left, done = np.zeros((1, *ready.bodies.rest.shape)), list(pairs), []
    names = [ready.assembly.names[members[0]] for members in ready.bodies.members]
    while left:
        for one in left:
            past = _past_neighbour(ready, path[-1], one, context)
            if past is not None:
                break
        else:
            return None
        left.remove(one)
        done.append((names[one.a], names[one.b]))
        out = escape_path(ready, ground, group, past, EXIT_TESTS, context)
        if out is not None:
            return EscapeByPairs(np.concatenate([path, out[0][1:]]), out[1], tuple(done))
        path = np.concatenate([path, past[1:]])
    return None


def _past_neighbour(ready: Prepared, motion: Floats, one: RelativePath, context: Context) -> Floats | None:
    """Motions (k, n, 3) of all bodies on which one body passes another, from where all are on; None where others are in the way."""
    path = motion[None]
    back = RelativeSegment(one.a, one.b, one.pivot, _motion_past(ready, motion, one), one.path[0], free=False)
    pieces = [RelativeSegment(one.a, one.b, one.pivot, begin, end, free=True) for begin, end in pairwise(one.path)]
    if sum(segment.length(ready.bodies) for segment in pieces[:-1]) > MAX_LENGTH * ready.clearance:
        return None
    for segment in [back, *pieces]:
        last = segment is pieces[-1]
        most = BEYOND * ready.clearance if last else np.inf
        found = follow(ready, ready.outlines, path[-1], segment, most, context)
        path = np.concatenate([path, found.path[1:]])
        if found.share < 1 and not last:
            return None
    return path


def _motion_past(ready: Prepared, motion: Floats, one: RelativePath) -> Floats:
    """Motion (3,) of b about the pivot in assembly axes, as if a had stayed at rest."""
    bodies, pivot = ready.bodies, one.pivot
    x, y, turn = relative_pose(bodies, np.array([one.a]), np.array([one.b]), motion)[0]
    at = bodies.rest[one.a]
    moved = np.append(at[:2] + rotated(np.array([x, y]), at[2]), at[2] + turn) - bodies.rest[one.b]
    return np.asarray(about(moved[None], (pivot - bodies.rest[one.b, :2])[None])[0])


@dataclass(frozen=True, eq=False)
class RelativeSegment:
    """A straight piece of a motion of body b past body a.

    Parameters
    ----------
    a, b : int
    pivot : (2,) float64 [mm]
        Assembly coordinates.
    begin, end : (3,) float64 [mm, mm, rad]
        Motions of b about the pivot, in assembly axes, while a is at rest.
    free : bool
        True where the piece is known to be free for the two alone.
    """

    a: int
    b: int
    pivot: Floats
    begin: Floats
    end: Floats
    free: bool

    def length(self, bodies: Bodies) -> float:
        """How long it is [mm]: its shift, and its turn at the rim of b."""
        change = self.end - self.begin
        return float(np.hypot(*change[:2]) + bodies.radius[self.b] * abs(change[2]))

    def pose(self, bodies: Bodies, t: float) -> Floats:
        """Pose (3,) of b in the frame of a at a share t of the piece."""
        motion = np.zeros_like(bodies.rest)
        at = (1 - t) * self.begin + t * self.end
        motion[self.b] = about(at[None], (bodies.rest[self.b, :2] - self.pivot)[None])[0]
        return relative_pose(bodies, np.array([self.a]), np.array([self.b]), motion)[0]

    def rate(self, bodies: Bodies, t: float) -> Floats:
        """Derivative (3,) of that pose by t."""
        change, turn = self.end - self.begin, (1 - t) * self.begin[2] + t * self.end[2]
        x, y = rotated(bodies.rest[self.b, :2] - self.pivot, turn)
        along = change[:2] + change[2] * np.array([-y, x])
        return np.append(rotated(along, -bodies.rest[self.a, 2]), change[2])

    def placed(self, bodies: Bodies, motion: Floats, t: float) -> Floats:
        """The motions (n, 3) with b where the piece has it at a share t of it; with a there, seen from b, where b is fixed."""
        out, relative = motion.copy(), self.pose(bodies, t)
        if bodies.fixed[self.b]:
            pose = bodies.rest[self.b] + motion[self.b]
            turn = pose[2] - relative[2]
            out[self.a] = np.append(pose[:2] - rotated(relative[:2], turn), turn) - bodies.rest[self.a]
        else:
            pose = bodies.rest[self.a] + motion[self.a]
            out[self.b] = np.append(pose[:2] + rotated(relative[:2], pose[2]), pose[2] + relative[2])
            out[self.b] -= bodies.rest[self.b]
        return out


@dataclass(frozen=True, eq=False)
class FollowedPath:
    """Motions (k, n, 3) of all bodies, audited, from where they were on, and the share of the piece that they get along."""

    path: Floats
    share: float


def follow(
    ready: Prepared,
    parts: AuditOutlines,
    motion: Floats,
    segment: RelativeSegment,
    most: float = np.inf,
    context: Context = UNLIMITED,
) -> FollowedPath:
    """RelativeSegment a body along a piece for as far as all others can make room.

    Parameters
    ----------
    ready : Prepared
    parts : AuditOutlines
        Of its assembly.
    motion : (n, 3) float64 [mm, mm, rad]
        Where the bodies are; the two are where the piece begins.
    segment : RelativeSegment
    most : float [mm]
        It need not get further along the piece.
    context : Context, optional
    """
    bodies, clearance = ready.bodies, ready.clearance
    length = max(segment.length(bodies), 1e-12 * ready.size)
    last = min(1.0, most / length)
    path, t, slow, trust = [motion[None]], 0.0, 0, TRUST * clearance
    for _ in range(MAX_STEPS):
        if t >= last or slow == MAX_SLOW or context.stopped:
            break
        change, further = _step(ready, motion, segment, t, trust, last)
        further = last if last - further < 1e-9 else further
        if further == t:
            break
        piece = _audited(ready, parts, motion, motion + change, segment, t, further)
        if piece is None:
            trust /= 4
            if trust < MIN_TRUST * clearance:
                break
            continue
        slow = slow + 1 if (further - t) * length < SLOW * clearance else 0
        path.append(piece[1:])
        motion, t, trust = piece[-1], further, min(2 * trust, TRUST * clearance)
    return FollowedPath(np.concatenate(path), t / last)


def _audited(
    ready: Prepared,
    parts: AuditOutlines,
    one: Floats,
    other: Floats,
    segment: RelativeSegment,
    t: float,
    further: float,
) -> Floats | None:
    """The step as waypoints (k, n, 3) between which it is certainly free; None where it is not found to be."""
    for split in range(MAX_SPLITS + 1):
        shares = np.linspace(0.0, 1.0, 2**split + 1)
        points = [segment.placed(ready.bodies, one + s * (other - one), t + s * (further - t)) for s in shares[1:]]
        path = np.stack([one, *points])
        if audit_path(parts, of_parts(ready.assembly, ready.bodies, path)).free:
            return path
    return None


def _movable(bodies: Bodies, pose: Floats, segment: RelativeSegment) -> Ints:
    """Bodies that may make room, the two that are led among them."""
    apart = np.hypot(*(pose[:, :2] - pose[segment.b, :2]).T)
    apart[[segment.a, segment.b]] = -1.0
    apart[bodies.fixed] = np.inf
    order = np.argsort(apart, kind="stable")[:MAX_MOVING]
    return np.sort(order[apart[order] < np.inf])


def _meeting(ready: Prepared, pose: Floats, moving: Ints, segment: RelativeSegment, reach: float) -> list[list[int]]:
    """Pairs that may meet of a body that makes room and any other: their discs are no further apart than `reach` [mm]."""
    radius, n = ready.bodies.radius, len(pose)
    apart = np.hypot(*(pose[moving, None, :2] - pose[:, :2]).transpose(2, 0, 1)) - radius[moving, None] - radius
    row, other = np.nonzero(apart <= reach)
    one = moving[row]
    key = np.minimum(one, other) * n + np.maximum(one, other)
    known = min(segment.a, segment.b) * n + max(segment.a, segment.b) if segment.free else -1
    key = np.unique(key[(one != other) & (key != known) & ~np.isin(key, ready.ignored)])
    return np.column_stack([key // n, key % n]).tolist()


def _step(
    ready: Prepared, motion: Floats, segment: RelativeSegment, t: float, trust: float, last: float
) -> tuple[Floats, float]:
    """Change (n, 3) of the motions that a linear program proposes, and how far along the piece it leads."""
    from scipy.optimize import linprog  # slow to load
    from scipy.sparse import coo_array, hstack

    bodies, n, a, b = ready.bodies, len(motion), segment.a, segment.b
    pose = bodies.rest + motion
    moving = _movable(bodies, pose, segment)
    number = np.full(n, -1)
    number[moving] = np.arange(len(moving))
    unit = np.column_stack([np.ones((n, 2)), bodies.radius])  # a change of 1 carries the rim by 1 mm
    near = corners_near_edges(bodies, _meeting(ready, pose, moving, segment, 4 * trust), pose, 4 * trust)
    row, side = np.nonzero(number[near.who] >= 0)
    who, count = near.who[row, side], 3 * len(moving)
    column = 3 * number[who][:, None] + np.arange(3)
    closer = coo_array(
        ((-near.gradient[row, side] / unit[who]).ravel(), (np.repeat(row, 3), column.ravel())),
        shape=(len(near.distance), count + 1),
    ).tocsc()
    # b keeps to the piece: its change less that by a's is the rate times the step
    arm, rate = rotated(segment.pose(bodies, t)[:2], pose[a, 2]), segment.rate(bodies, t)
    kept = np.zeros((3, count + 1))
    if number[b] >= 0:
        kept[:, 3 * number[b] : 3 * number[b] + 3] = np.diag(1 / unit[b])
    if number[a] >= 0:
        carried = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]], [0.0, 0.0, 1.0]])
        kept[:, 3 * number[a] : 3 * number[a] + 3] = -carried / unit[a]
    kept[:, -1] = -np.append(rotated(rate[:2], pose[a, 2]), rate[2])
    cost = np.full(2 * count + 1, EFFORT)
    cost[count] = -max(segment.length(bodies), 1e-12 * ready.size)
    # every change as the difference of two that are not negative, so that both ways cost effort
    found = linprog(
        cost,
        A_ub=hstack([closer, -closer[:, :count]]).tocsr(),
        b_ub=np.maximum(near.distance - MARGIN * ready.clearance, 0.0),
        A_eq=np.hstack([kept, -kept[:, :count]]),
        b_eq=np.zeros(3),
        bounds=[(0.0, trust)] * count + [(0.0, last - t)] + [(0.0, trust)] * count,
        method="highs",
    )
    change = np.zeros_like(motion)
    if not found.success:
        return change, t
    change[moving] = (found.x[:count] - found.x[count + 1 :]).reshape(-1, 3) / unit[moving]
    return change, t + float(found.x[count])
