"""What the gaps of single joints are worth: each moves only the edges that face each other, and the corners between those and others."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.joint_edges import JointEdges, joint_edges
from wiggleroom.assembly.mitre import fits
from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.geometry.bodies import BodyShapes
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.program.gap_sensitivity import Gains
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.active_set import feet

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FLAT = 1e-4
"""An edge within this share of the clearance of another, all along, lies flat on it."""
NEAR_END = 1e-6
"""Share of a flat contact that lies between the end of a stretch and what is on either side of it."""
SAME_PLACE = 1e-9
"""Joints whose parts lie to each other alike, to this share of the assembly's size, are the same."""

PARALLEL = 1e-9
"""Edges whose unit normals differ by less are on one line where a corner touches both."""


class _At(NamedTuple):
    """Pairs of a wall and a joint of the part that its edge or corner belongs to, and which `outline` the joint moves."""

    wall: Ints
    joint: Ints
    outline: Ints


class _Pieces(NamedTuple):
    """Pieces of several outlines, one outline after the other; those of outline k are `first[k]` to `first[k + 1]`.

    Each begins at `start` (k, 2) and runs along the unit vector `ahead` (k, 2) for `length` (k,) [mm]; `inward` and `moves` (k,) are
    those of `JointEdges`.
    """

    first: Ints
    start: Floats
    ahead: Floats
    length: Floats
    inward: Floats
    moves: Floats

    @classmethod
    def of(cls, outlines: list[JointEdges]) -> _Pieces:
        """Those of some outlines."""
        first = np.concatenate([[0], np.cumsum([len(o.moves) for o in outlines], dtype=np.int64)])
        none = np.zeros((0, 2))
        start, end = (np.concatenate([none, *(getattr(o, name) for o in outlines)]) for name in ("start", "end"))
        inward, moves = (np.concatenate([none[:, 0], *(getattr(o, n) for o in outlines)]) for n in ("inward", "moves"))
        length = np.hypot(*(end - start).T)
        return cls(first, start, (end - start) / length[:, None], length, inward, moves)

    def ends_along(self, outline: int, start: Floats, end: Floats, near: float) -> list[float]:
        """Where pieces of an outline, as made, end on the way between two points of one of its edges: shares of it in (0, 1)."""
        mine = slice(*self.first[outline : outline + 2])
        way = end - start
        far = np.hypot(*way)
        ahead, along = self.ahead[mine], way / max(far, 1e-300)
        off = start - self.start[mine]
        beside = off[:, 1] * ahead[:, 0] - off[:, 0] * ahead[:, 1] - self.inward[mine]
        turned = ahead[:, 0] * along[1] - ahead[:, 1] * along[0]
        on = (np.abs(beside) <= near) & (np.abs(turned) * far <= near)
        first = -off[on] @ along
        ends = np.concatenate([first, first + self.length[mine][on] * (ahead[on] @ along)])
        room = 2 * NEAR_END * far
        return np.unique(np.round(ends[(ends > room) & (ends < far - room)] / far, 9)).tolist()


def _at_joints(of: Ints, part: Ints, joint: Ints, outline: Ints) -> _At:
    """Each wall with all joints of its part `of` (w,), where `part` (j,), ascending, `joint` and `outline` list the parts of joints."""
    low, high = np.searchsorted(part, of, "left"), np.searchsorted(part, of, "right")
    count = high - low
    wall = np.repeat(np.arange(len(of)), count)
    place = np.arange(len(wall)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
    return _At(wall, joint[place], outline[place])


@njit(**NO_ALLOCATION)
def _nearest_pieces(outline, first, start, ahead, length, inward, point, along, out):
    """Fill `out` (q,) with the piece of each outline that, as made, is nearest to a point and runs along a unit vector."""
    for q in range(len(outline)):
        begin, end = first[outline[q]], first[outline[q] + 1]
        longest = 0.0
        for k in range(begin, end):
            longest = max(longest, length[k])
        least = np.inf
        for k in range(begin, end):
            x, y = point[q, 0] - start[k, 0], point[q, 1] - start[k, 1]
            beside = y * ahead[k, 0] - x * ahead[k, 1] - inward[k]
            run = x * ahead[k, 0] + y * ahead[k, 1]
            beyond = max(-run, run - length[k], 0.0)
            # as far off as the longest piece is long, where they run in opposite directions
            turned = 1.0 - along[q, 0] * ahead[k, 0] - along[q, 1] * ahead[k, 1]
            off = np.hypot(beside, beyond) + longest * turned
            if off < least:
                least, out[q] = off, k


class JointGains:
    """The joints of walls that hold a motion, and what the gap of each does to these walls.

    Parameters
    ----------
    assembly : Assembly
    program : Program
    some : Gains
        Of the walls.

    Attributes
    ----------
    joints : (m, 2) int64
        Pairs of parts.
    """

    def __init__(self, assembly: Assembly, program: Program, some: Gains) -> None:
        pairs = np.sort(np.column_stack([some.edge_part, some.corner_part]), axis=1)
        self.joints: Ints = np.unique(pairs, axis=0).reshape(-1, 2)
        self._assembly, self._program = assembly, program
        self._pieces, part, joint, outline = self._joint_outlines()
        self._owners = part, joint, outline
        self._edge, self._corner = (_at_joints(of, *self._owners) for of in (some.edge_part, some.corner_part))
        shapes = program.bodies.shapes
        before, body = np.argsort(shapes.after)[some.corner], some.corner_body
        spot = shapes.corner[some.corner]
        self._behind, self._ahead = (
            self._nearest(self._corner, some.corner_part, body, spot, edge) for edge in (before, some.corner)
        )
        self._normals = shapes.normal[before], shapes.normal[some.corner]

    def _joint_outlines(self) -> tuple[_Pieces, Ints, Ints, Ints]:
        """What joints move: pieces of outlines, and for each part of a joint the part, the joint, and which of the outlines it is."""
        assembly = self._assembly
        known: dict[tuple[object, ...], tuple[JointEdges, JointEdges] | None] = {}
        alone = {name for joint in assembly.drawing.gaps for name in joint.parts}
        outlines: list[JointEdges] = []
        number: dict[tuple[object, ...], int] = {}
        found = []
        for k, (a, b) in enumerate(self.joints.tolist()):
            key = self._key(a, b) if alone.isdisjoint((assembly.names[a], assembly.names[b])) else (k,)
            if key not in known:
                known[key] = joint_edges(assembly.drawing, (a, b))
                number[key] = len(outlines)
                outlines += known[key] or ()
            if known[key] is not None:
                found += [(a, k, number[key]), (b, k, number[key] + 1)]
        part, joint, outline = np.array(sorted(found), dtype=np.int64).reshape(-1, 3).T.copy()
        return _Pieces.of(outlines), part, joint, outline

    def _key(self, a: int, b: int) -> tuple[object, ...]:
        """What is alike where two joints are."""
        one, other = (self._assembly.drawing.parts[k] for k in (a, b))
        x, y, angle = np.subtract(other.at, one.at)
        c, s = np.cos(one.at[2]), np.sin(one.at[2])
        size = SAME_PLACE * self._assembly.size
        place = np.round(np.array([c * x + s * y, c * y - s * x, angle * self._assembly.size]) / size)
        alike = ((id(part.regions), part.offset, part.outline_offsets) for part in (one, other))
        return (*alike, *place.tolist())

    def at(self, some: Gains, u: Floats, holds: Ints) -> sp.csr_matrix:
        """Gain (m, k) of each of k rows at u (3F,) for 1 mm more gap in each joint; `some` are the gains of the same walls there."""
        shapes = self._program.bodies.shapes
        foot = np.clip(feet(self._program, u, holds[some.column]), 0.0, 1.0)[:, None]
        spot = shapes.corner[some.edge] + foot * (shapes.corner[shapes.after[some.edge]] - shapes.corner[some.edge])
        by_edge = self._moves(self._edge, some.edge_part, some.edge_body, spot, some.edge)
        wall = self._corner.wall
        one, other = (normal[wall] for normal in self._normals)
        behind, ahead = self._behind, self._ahead
        mitred = fits(self._pieces.inward[behind], self._pieces.inward[ahead], (one * other).sum(axis=1))
        moves = self._pieces.moves
        by_corner = _corner_gain(some.toward[wall], one, other, moves[behind], moves[ahead], mitred)
        joint = np.concatenate([self._edge.joint, self._corner.joint])
        column = some.column[np.concatenate([self._edge.wall, wall])]
        shape = len(self.joints), len(holds)
        return sp.csr_matrix((np.concatenate([by_edge, by_corner]), (joint, column)), shape=shape)

    def between(self, some: Gains, u: Floats, holds: Ints) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Contacts where a joint's stretch ends under flat edges: mean of rows (k, e) that each is, and gain (m, e) like that of `at`.

        There are two at each end, one on either side of it.
        """
        shapes = self._program.bodies.shapes
        foot = feet(self._program, u, holds[some.column])[:, None]
        spot = shapes.corner[some.edge] + foot * (shapes.corner[shapes.after[some.edge]] - shapes.corner[some.edge])
        flat = flat_contacts(shapes, some, spot)
        contact, share = self._ends_between(flat)
        gain = self._gain_between(flat, contact, share)
        jumps = np.flatnonzero(abs(gain[:, 0::2] - gain[:, 1::2]).sum(axis=0) > 0)
        keep = np.column_stack([2 * jumps, 2 * jumps + 1]).ravel()
        row, column = some.column[flat.walls[contact[keep]]], np.arange(len(keep))
        mean = np.column_stack([1 - share[keep], share[keep]])
        shape = len(holds), len(keep)
        return sp.csr_matrix((mean.T.ravel(), (row.T.ravel(), np.tile(column, 2))), shape=shape), gain[:, keep]

    def _ends_between(self, flat: FlatContacts) -> tuple[Ints, Floats]:
        """Just before and behind each end of a stretch: which flat contact it lies in (e,), and the share (e,) of the way there."""
        contact, share = [], []
        for side in flat.sides:
            where = _at_joints(side.part, *self._owners)
            start, end = (self._in_parts(side.part, side.body, point) for point in (side.start, side.end))
            for k, outline in zip(where.wall.tolist(), where.outline.tolist(), strict=True):
                ends = self._pieces.ends_along(outline, start[k], end[k], FLAT * self._program.length)
                share += [s for end in ends for s in (end - NEAR_END, end + NEAR_END)]
                contact += [k] * 2 * len(ends)
        return np.array(contact, dtype=np.int64), np.array(share)

    def _gain_between(self, flat: FlatContacts, contact: Ints, share: Floats) -> sp.csc_matrix:
        """Gain (m, e) of flat contacts at shares of the way along each: both edges move there."""
        total = sp.csc_matrix((len(self.joints), len(contact)))
        for side in flat.sides:
            where = _at_joints(side.part[contact], *self._owners)
            point = (1 - share)[:, None] * side.start[contact] + share[:, None] * side.end[contact]
            move = self._moves(where, side.part[contact], side.body[contact], point, side.edge[contact])
            total += sp.csc_matrix((move, (where.joint, where.wall)), shape=total.shape)
        return total

    def _in_parts(self, part: Ints, body: Ints, point: Floats) -> Floats:
        """Points (w, 2) of the frames of bodies, in those of their parts."""
        rest, at = self._program.bodies.rest[body], np.array([p.at for p in self._assembly.parts])[part]
        return rotated(point, rest[:, 2] - at[:, 2]) + rotated(rest[:, :2] - at[:, :2], -at[:, 2])

    def _moves(self, where: _At, part: Ints, body: Ints, point: Floats, edge: Ints) -> Floats:
        """How far the edges of walls (w,), at points (w, 2) of the frames of their bodies, move for each of the pairs of wall and joint."""
        return self._pieces.moves[self._nearest(where, part, body, point, edge)]

    def _nearest(self, where: _At, part: Ints, body: Ints, point: Floats, edge: Ints) -> Ints:
        """The pieces of outlines that these edges are."""
        bodies = self._program.bodies
        rest, at = bodies.rest[body], np.array([p.at for p in self._assembly.parts])[part]
        along = np.column_stack([-bodies.shapes.normal[edge][:, 1], bodies.shapes.normal[edge][:, 0]])
        turn = rest[:, 2] - at[:, 2]
        spot = self._in_parts(part, body, point)
        out = np.zeros(len(where.wall), dtype=np.int64)
        some = self._pieces[:5]
        _nearest_pieces(where.outline, *some, spot[where.wall], rotated(along, turn)[where.wall], out)
        return out


def _corner_gain(
    toward: Floats, one: Floats, other: Floats, behind: Floats, ahead: Floats, mitred: NDArray[np.bool_]
) -> Floats:
    """What walls gain where the edges before and after their corners move inward by `behind` and `ahead` (q,).

    With the edges' outward normals `one` and `other` (q, 2) a mitred corner moves by m with one . m = -behind and other . m = -ahead. Where
    a step joins both edges the nearer of its two corners counts.
    """
    total, apart = one + other, one - other
    mean, half = (behind + ahead) / 2, (behind - ahead) / 2
    along = [(toward * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-18) for d in (total, apart)]
    meet = -2 * (mean * along[0] + np.where(half != 0, half * along[1], 0.0))
    stepped = np.minimum(-behind * (toward * one).sum(axis=1), -ahead * (toward * other).sum(axis=1))
    return np.where((half != 0) & ~mitred, stepped, meet)


@dataclass(frozen=True, eq=False)
class FlatSide:
    """One of both edges (f,) of contacts between flat edges.

    Parameters
    ----------
    part, body, edge : (f,) int64
    start, end : (f, 2) float64 [mm]
        Where it touches with the first and the second wall, in the frame of its body.
    """

    part: Ints
    body: Ints
    edge: Ints
    start: Floats
    end: Floats


@dataclass(frozen=True, eq=False)
class FlatContacts:
    """Contacts between flat edges: two walls each (f, 2), numbers among the gains, and both sides of what touches between them."""

    walls: Ints
    sides: tuple[FlatSide, FlatSide]


def flat_contacts(shapes: BodyShapes, some: Gains, foot: Floats) -> FlatContacts:
    """Contacts between flat edges, among walls that hold; `foot` (w, 2) is where each corner stands on its edge, in the edge's frame.

    Flat edges touch all along. Where a stretch that a joint's gap moves ends between two corners, a step stands up there, and one of its
    corners carries what a corner beyond it did.

    Two corners at the ends of one edge stand on one line; or a corner of each body stands on the edge of the other that ends at its own.
    """
    of_pair = defaultdict(list)
    for wall, bodies in enumerate(np.sort(np.column_stack([some.edge_body, some.corner_body]), axis=1).tolist()):
        of_pair[tuple(bodies)].append(wall)
    found = []
    for walls in of_pair.values():
        for i, j in combinations(walls, 2):
            beside = _edge_between(shapes, some, i, j)
            if beside >= 0:
                found.append((i, j, beside))
    first, last, edge = np.array(found, dtype=np.int64).reshape(-1, 3).T
    mixed = (some.edge_body[first] != some.edge_body[last])[:, None]
    spot = shapes.corner[some.corner]
    ends = np.where(mixed, spot[last], foot[last]), np.where(mixed, foot[last], spot[last])
    one = FlatSide(some.edge_part[first], some.edge_body[first], some.edge[first], foot[first], ends[0])
    other = FlatSide(some.corner_part[first], some.corner_body[first], edge, spot[first], ends[1])
    return FlatContacts(np.column_stack([first, last]), (one, other))


def _edge_between(shapes: BodyShapes, some: Gains, i: int, j: int) -> int:
    """The edge of the corner's body that lies flat on that of wall i from its corner to where wall j touches; -1 where none does."""
    corner, edge, after = some.corner, some.edge, shapes.after
    if some.edge_body[i] == some.edge_body[j]:
        apart = shapes.normal[edge[i]] - shapes.normal[edge[j]]
        if np.abs(apart).max() > PARALLEL:
            return -1
        if after[corner[i]] == corner[j]:
            return int(corner[i])
        return int(corner[j]) if after[corner[j]] == corner[i] else -1
    ends = (edge[i], after[edge[i]]), (edge[j], after[edge[j]])
    return int(edge[j]) if corner[j] in ends[0] and corner[i] in ends[1] else -1
