"""Outlines moved along their normals, edge by edge: what is made is the drawn region without what its edges sweep.

Every edge that moves inward sweeps a strip over its length. At corners where strips spread, a kite between both lines belongs to them.
What moves outward does the same outside. Where neighbouring edges move alike, corners are mitred. Where they do not, the corner
stays mitred while both lines meet within both strips; else the edge that moves further ends at the drawn corner, in a step at right angles
to it. Strips and kites only grow with the displacement of any edge, so what is made only gets smaller.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.loops import Loops, dot_products, polygons
from wiggleroom.drawing.model import Points

RIGHT_ANGLE = 1e-9
"""Edges whose directions have a smaller cosine turn by a right angle or more."""
STRAIGHT = 1e-12
"""Edges that turn by a smaller sine go straight on."""
ROUNDING = 1e-12
"""Areas below this share of that of the region are rounding."""
AT_ONCE = 1_000_000
"""Pairs of points and segments that are looked at together."""


@dataclass(frozen=True, eq=False)
class _Corners:
    """What happens at every corner: unit edge directions `along` (n, 2), the mitre's shift, and where a step takes its place."""

    loops: Loops
    inward: NDArray[np.float64]
    before: NDArray[np.int64]
    along: Points
    normal: Points
    shift: Points
    step: NDArray[np.bool_]

    @property
    def mitre(self) -> Points:
        """Where moved lines meet."""
        return self.loops.points + self.shift

    @property
    def end(self) -> Points:
        """End of the moved edge that comes in."""
        return self.loops.points + self.inward[self.before][:, None] * self.normal[self.before]

    @property
    def start(self) -> Points:
        """Start of the moved edge that goes out."""
        return self.loops.points + self.inward[:, None] * self.normal

    @property
    def turn(self) -> NDArray[np.float64]:
        """Sine of the angle between both edges, positive where the corner is convex."""
        left = self.along[self.before]
        return left[:, 0] * self.along[:, 1] - left[:, 1] * self.along[:, 0]

    @property
    def mixed(self) -> NDArray[np.bool_]:
        """Where one edge moves inward and the other outward."""
        return self.inward[self.before] * self.inward < 0

    @property
    def shortens(self) -> NDArray[np.bool_]:
        """Where both edges lose length, of edges that move to the same side."""
        left = self.along[self.before]
        stepped = self.turn * np.sign(self.inward[self.before] + self.inward) > STRAIGHT
        mitred = (dot_products(self.shift, left) < 0) & (dot_products(self.shift, self.along) > 0)
        return np.where(self.step, stepped, mitred) & ~self.mixed

    @property
    def taken(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Points]:
        """Sharp corners where the outgoing edge cuts off what the other one adds, or the incoming one does; and down to where."""
        behind, ahead, left = self.inward[self.before], self.inward, self.along[self.before]
        sharp = self.mixed & ~self.step & (dot_products(left, self.along) < -RIGHT_ANGLE)
        outgoing = np.where(self.turn > 0, ahead, -ahead) > 0
        run = np.maximum(np.abs(self.turn), 1e-18)
        back, on = ((np.abs(by) / run)[:, None] for by in (ahead, behind))
        foot = self.loops.points + np.where(outgoing[:, None], -back * left, on * self.along)
        return sharp & outgoing, sharp & ~outgoing, foot

    @property
    def steps(self) -> tuple[Points, Points]:
        """Both ends of steps between edges that move to the same side: on the line through the corner along the further one's normal."""
        behind, ahead = self.inward[self.before], self.inward
        cosine = np.where(self.step, dot_products(self.along[self.before], self.along), 1.0)
        goes_further = np.abs(ahead) > np.abs(behind)
        low = self.loops.points + (behind / cosine)[:, None] * self.normal
        high = self.loops.points + (ahead / cosine)[:, None] * self.normal[self.before]
        further = goes_further[:, None]
        return np.where(further, low, self.end), np.where(further, self.start, high)


def offset_ring(loops: Loops, inward: NDArray[np.float64]) -> tuple[Loops, NDArray[np.bool_]]:
    """Every edge moved to its left, corners where neighbouring lines meet.

    Parameters
    ----------
    loops : Loops [mm]
        Material left of every edge.
    inward : (n,) float64 [mm]
        Displacement of each edge into the material; negative moves it out.

    Returns
    -------
    Loops
        Same corners in the same order; a step adds one or two.
    (k,) bool
        Loops whose every edge kept its direction. Where an edge is used up the loop is not the moved
        outline, and `resolved` has to work it out.

    Examples
    --------
    >>> from wiggleroom.assembly.loops import chained
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> offset_ring(chained([square]), np.array([1.0, 0.5, 0.5, 0.5]))[0].points.tolist()
    [[0.5, 1.0], [3.5, 1.0], [3.5, 3.5], [0.5, 3.5]]
    """
    moved = [_moved(some, inward[corners]) for some, _, corners in loops.batches()]
    points, counts, forward = (np.concatenate(column) for column in zip(*moved, strict=True))
    return Loops(points, counts), forward


def _moved(loops: Loops, inward: NDArray[np.float64]) -> tuple[Points, NDArray[np.int64], NDArray[np.bool_]]:
    """Points and counts of moved loops, and which of them kept the directions of all their edges."""
    corner = _corners(loops, inward)
    first = second = corner.mitre
    if steps := corner.step.any():
        first, second = _ends(corner)
    forward = np.logical_and.reduceat(dot_products(first[loops.after] - second, corner.along) > 0, loops.starts)
    if not steps:
        return first, loops.counts, forward
    through = corner.step & corner.mixed
    three = np.stack([first, loops.points, second], axis=1)
    keep = np.column_stack([np.ones(len(first), dtype=bool), through, corner.step])
    return three[keep], _more(loops, keep), forward


def _ends(corner: _Corners) -> tuple[Points, Points]:
    """Where the moved edge that comes in ends, and the one that goes out begins."""
    step, through = corner.step[:, None], (corner.step & corner.mixed)[:, None]
    low, high = corner.steps
    first = np.where(through, corner.end, np.where(step, low, corner.mitre))
    return first, np.where(through, corner.start, np.where(step, high, corner.mitre))


def _more(loops: Loops, keep: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Counts (k,) of loops where those of some points `keep` (n, m) are kept in place of each corner."""
    return np.add.reduceat(keep.sum(axis=1), loops.starts)


def _corners(loops: Loops, inward: NDArray[np.float64]) -> _Corners:
    before = loops.before
    edge = loops.points[loops.after] - loops.points
    length = np.hypot(*edge.T)
    along = edge / length[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    step = inward[before] != inward
    if step.any():  # else neighbouring edges move alike
        cosine = dot_products(along[before], along)
        inward = _without_used_up(inward, before, along, length, cosine)
        step = inward[before] != inward
        step &= ~fits(inward[before], inward, cosine)
    behind, there = inward[before], inward
    # n1 . shift = d1 and n2 . shift = d2, written so that nearly straight corners lose no digits
    shift, half = _scaled(normal[before] + normal, (behind + there) / 2), (behind - there) / 2
    if half.any():
        shift = shift + np.where(half[:, None] != 0, _scaled(normal[before] - normal, half), 0.0)
    return _Corners(loops, inward, before, along, normal, shift, step)


def fits(behind: NDArray[np.float64], ahead: NDArray[np.float64], cosine: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where the lines of two edges that move by `behind` and `ahead` [mm] meet within both strips; edges turn by `cosine`.

    Examples
    --------
    >>> fits(np.array([1.0, 1.0, 1.0]), np.array([2.0, 2.0, 1.0]), np.array([0.9, 0.0, 1.0])).tolist()
    [False, True, True]
    """
    one, other = np.abs(behind), np.abs(ahead)
    meets = (behind * ahead >= 0) & (one >= cosine * other) & (other >= cosine * one)
    return meets | (behind == ahead) | (cosine <= RIGHT_ANGLE)


def _without_used_up(
    inward: NDArray[np.float64],
    before: NDArray[np.int64],
    along: Points,
    length: NDArray[np.float64],
    cosine: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Displacements (n,) [mm], 0 where an edge is used up by neighbours that move to the other side.

    At a convex corner of a right angle or sharper the edge that moves inward takes from the one that moves outward, at a reflex one
    the other way round.
    """
    behind = inward[before]
    met = (behind * inward < 0) & (cosine <= RIGHT_ANGLE)
    if not met.any():
        return inward
    left = along[before]
    sine = left[:, 0] * along[:, 1] - left[:, 1] * along[:, 0]
    takes = met & (np.where(sine > 0, inward, -inward) > 0)  # the edge that goes out takes from the one that comes in
    used = np.zeros(len(inward))
    run = np.maximum(np.abs(sine), 1e-18)
    np.add.at(used, before[takes], (np.abs(inward) / run)[takes])
    gives = met & ~takes
    used[gives] += (np.abs(behind) / run)[gives]
    return np.where(used >= length, 0.0, inward)


def _scaled(direction: Points, amount: NDArray[np.float64]) -> Points:
    """`direction` scaled so that its part along either normal is `amount`; finite even for a needle's tip."""
    return direction * (2 * amount / np.maximum(dot_products(direction, direction), 1e-18))[:, None]


def sweeps_all(loops: Loops, inward: NDArray[np.float64], made: shapely.Polygon) -> bool:
    """Whether one region, made by `offset_ring`, has nothing that strips of its edges sweep.

    Strips go on to the end of their edges where mitres and steps cut across them; an edge that is shorter than that does not cover it.
    """
    corner = _corners(loops, inward)
    outgoing, incoming, foot = corner.taken
    first, second = _ends(corner)
    short = corner.shortens
    sides = [
        (short, corner.end, first),
        (short, second, corner.start),
        (outgoing, foot, corner.start),
        (incoming, corner.end, foot),
    ]
    cuts = np.where(corner.mixed, corner.turn, corner.inward[corner.before] + corner.inward) > 0
    for cut in (True, False):
        corners = [np.stack([loops.points, x, y], axis=1)[some & (cuts == cut)] for some, x, y in sides]
        swept = shapely.union_all(shapely.make_valid(shapely.polygons(np.concatenate(corners))))
        left = shapely.intersection(swept, made) if cut else shapely.difference(swept, made)
        if left.area > ROUNDING * made.area:
            return False
    return True


def resolved(loops: Loops, inward: NDArray[np.float64]) -> list[shapely.Polygon]:
    """Work out what is left of one region where edges are used up, holes open or pieces fall apart.

    The moved edges, joined through the old corner where it shrinks, wind once round everything that is left and
    never round what is gone, so the pieces are the faces with positive winding number.

    Examples
    --------
    >>> from wiggleroom.assembly.loops import chained
    >>> notched = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.9], [3.9, 4.0], [0.0, 4.0]])
    >>> [piece.area for piece in resolved(chained([notched]), np.full(5, 1.0))]
    [4.0]
    """
    corner = _corners(loops, inward)
    through = corner.shortens | (corner.step & corner.mixed)
    outgoing, incoming, foot = corner.taken
    low, high = _ends(corner)
    first = np.where((through | incoming)[:, None], corner.end, low)
    second = np.where((through | outgoing)[:, None], corner.start, high)
    five = np.stack([first, foot, loops.points, foot, second], axis=1)
    bent = through | outgoing | incoming
    keep = np.stack([np.full(len(bent), True), outgoing, bent, incoming, bent | corner.step], axis=1)
    raw = Loops(five[keep], _more(loops, keep))
    ends = np.stack([raw.points, raw.points[raw.after]], axis=1)
    segments = ends[(ends[:, 0] != ends[:, 1]).any(axis=1)]
    net = shapely.union_all(shapely.linestrings(segments))
    faces = shapely.get_parts(shapely.polygonize([net]))
    if not len(faces):
        return []
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    left = shapely.union_all(faces[_winding(inside, segments) > 0])
    drawn = polygons(loops, np.zeros(len(loops.counts), dtype=np.int64))[0]
    return _without_dust(shapely.get_parts(left), ROUNDING * drawn.area)


def _winding(points: Points, segments: NDArray[np.float64]) -> NDArray[np.int64]:
    """How often closed loops of segments (m, 2, 2) wind round each point (n, 2), counter-clockwise positive."""
    counts = []
    for some in np.array_split(points, 1 + len(points) * len(segments) // AT_ONCE):
        start, end = segments[None, :, 0] - some[:, None], segments[None, :, 1] - some[:, None]
        side = start[..., 0] * end[..., 1] - start[..., 1] * end[..., 0]
        up = (start[..., 1] <= 0) & (end[..., 1] > 0) & (side > 0)
        down = (start[..., 1] > 0) & (end[..., 1] <= 0) & (side < 0)
        counts.append(up.sum(axis=1) - down.sum(axis=1))
    return np.concatenate(counts)


def _without_dust(pieces: NDArray[np.object_], smallest: float) -> list[shapely.Polygon]:
    """Polygons without pieces and holes that are rounding errors, material left of every edge."""
    kept = []
    for piece in pieces[shapely.area(pieces) > smallest]:
        holes = [h for h in piece.interiors if shapely.area(shapely.Polygon(h)) > smallest]
        kept.append(shapely.orient_polygons(shapely.Polygon(piece.exterior, holes)))
    return kept
