"""Rigid bodies (a part, or parts glued together) and the distinct shapes among them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.drawing.writers.glue_groups import body_numbers

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CONGRUENCE_TOLERANCE = 1e-10
"""Two shapes are the same where all corners agree to this share of their radius."""


@dataclass(frozen=True, eq=False)
class BodyShapes:
    """Distinct outlines, concatenated: corner k of shape s is row `first[s] + k`.

    Edge k runs from corner k to corner `after[k]`; material lies left of it.

    Parameters
    ----------
    corner : (N, 2) float64 [mm]
        In the shape's frame, whose origin is its centroid.
    after : (N,) int64
        Row of the next corner of the same ring.
    normal : (N, 2) float64
        Outward unit normal of each edge.
    length : (N,) float64 [mm]
        Length of each edge.
    member : (N,) int64
        Which of the body's parts the corner belongs to (0 where there is one).
    first : (S + 1,) int64
    radius : (S,) float64 [mm]
        Largest distance of a corner from the origin.
    run : (C + 1,) int64
        Rows where runs of consecutive edges start; runs are the leaves of the search for near edges.
    run_first : (S + 1,) int64
        First run of each shape.
    run_disc : (C, 3) float64 [mm]
        Centre and radius of a disc round each run.
    """

    corner: Floats
    after: Ints
    normal: Floats
    length: Floats
    member: Ints
    first: Ints
    radius: Floats
    run: Ints
    run_first: Ints
    run_disc: Floats

    @cached_property
    def level(self) -> Floats:
        """How far (N,) [mm] the line of each edge lies from the origin, outward."""
        return np.asarray((self.normal * self.corner).sum(1))


@dataclass(frozen=True, eq=False)
class Bodies:
    """What moves as one.

    Parameters
    ----------
    shapes : BodyShapes
    shape : (n,) int64
        Shape of each body.
    rest : (n, 3) float64 [mm, mm, rad]
        Pose of the shape's frame at rest.
    fixed : (n,) bool
    body_of : (parts,) int64
        Body that each part belongs to.
    members : tuple of tuples of int
        Parts of each body, in order.
    """

    shapes: BodyShapes
    shape: Ints
    rest: Floats
    fixed: NDArray[np.bool_]
    body_of: Ints
    members: tuple[tuple[int, ...], ...]

    @property
    def radius(self) -> Floats:
        """Radius of each body about its origin (n,) [mm]."""
        return self.shapes.radius[self.shape]


def bodies(assembly: Assembly) -> Bodies:
    """Join glued parts and find which bodies have the same shape, wherever they lie and however they are turned.

    Parameters
    ----------
    assembly : Assembly

    Returns
    -------
    Bodies
    """
    groups = _groups(assembly)
    table: dict[tuple, list[int]] = {}
    known: list[tuple[list[Floats], list[int]]] = []
    own: dict[int, tuple[int, Floats]] = {}
    shape, rest = np.zeros(len(groups), dtype=np.int64), np.zeros((len(groups), 3))
    for b, group in enumerate(groups):
        first = assembly.parts[group[0]]
        key = id(first.regions)
        if len(group) == 1 and key in own:
            shape[b], frame = own[key]
        else:
            rings, member = _gather(assembly, group)
            rings, frame = _canonical(rings)
            shape[b] = _same(rings, member, table, known)
            if len(group) == 1:
                own[key] = int(shape[b]), frame
        rest[b, :2] = place(frame[None, :2], first.at)[0]
        rest[b, 2] = first.at[2] + frame[2]
    fixed = np.array([any(assembly.parts[p].fixed for p in g) for g in groups])
    body_of = np.empty(len(assembly.parts), dtype=np.int64)
    for b, group in enumerate(groups):
        body_of[list(group)] = b
    return Bodies(_stack(known), shape, rest, fixed, body_of, tuple(groups))


def _groups(assembly: Assembly) -> list[tuple[int, ...]]:
    """Parts that move as one, in order of their first member."""
    groups: dict[int, list[int]] = {}
    for part, body in enumerate(body_numbers(assembly.names, assembly.drawing.glue)):
        groups.setdefault(body, []).append(part)
    return [tuple(g) for g in groups.values()]


def _gather(assembly: Assembly, group: tuple[int, ...]) -> tuple[list[Floats], list[int]]:
    """Rings of a body in the frame of its first part, and the member each ring belongs to."""
    x, y, angle = assembly.parts[group[0]].at
    rings, member = [], []
    for m, p in enumerate(group):
        part = assembly.parts[p]
        for region in part.regions:
            for ring in (region.outer, *region.holes):
                if m:
                    world = place(ring, part.at) - (x, y)
                    ring = place(world, (0.0, 0.0, -angle))
                rings.append(np.asarray(ring, dtype=float))
                member.append(m)
    return rings, member


def _canonical(rings: list[Floats]) -> tuple[list[Floats], Floats]:
    """Rings in a frame that depends on the shape alone, and that frame (x, y, angle) in the old one."""
    x0 = rings[0][0]
    area = np.array([_area(r - x0) for r in rings])
    middle = x0 + sum(_moment(r - x0) for r in rings) / area.sum()
    centred = [r - middle for r in rings]
    lead = centred[int(area.argmax())]
    size = np.abs(lead).max()
    edge = np.roll(lead, -1, 0) - lead
    before = np.roll(edge, 1, 0)
    marks = np.column_stack(
        [np.hypot(*lead.T), np.hypot(*edge.T), edge[:, 0] * before[:, 1] - edge[:, 1] * before[:, 0]]
    )
    marks = np.round(marks / [size, size, size * size], 7)
    start = min(_first_of_smallest_turns(marks), key=lambda k: np.arctan2(edge[k, 1], edge[k, 0]) % (2 * np.pi - 1e-9))
    angle = float(np.arctan2(edge[start, 1], edge[start, 0]))
    turned = [place(r, (0.0, 0.0, -angle)) for r in centred]
    turned[int(area.argmax())] = np.roll(turned[int(area.argmax())], -start, 0)
    return turned, np.array([middle[0], middle[1], angle])


def _first_of_smallest_turns(marks: Floats) -> list[int]:
    """Starts of the lexicographically smallest cyclic order of rows; several where the shape is symmetric."""
    n = len(marks)
    alive = np.arange(n)
    for step in range(n):
        rows = marks[(alive + step) % n]
        for column in range(rows.shape[1]):
            keep = rows[:, column] == rows[:, column].min()
            alive, rows = alive[keep], rows[keep]
        if len(alive) == 1:
            break
    return [int(k) for k in alive]


def _same(rings: list[Floats], member: list[int], table: dict, known: list) -> int:
    """Index of these rings among the known shapes; added where new."""
    flat = np.vstack(rings)
    size = np.abs(flat).max()
    key = (
        tuple(len(r) for r in rings),
        tuple(member),
        *np.round(flat[:4].ravel() / size, 5) + 0.0,
        round(float(size), 6),
    )
    for s in table.get(key, []):
        if np.abs(np.vstack(known[s][0]) - flat).max() <= CONGRUENCE_TOLERANCE * size:
            return s
    known.append((rings, member))
    table.setdefault(key, []).append(len(known) - 1)
    return len(known) - 1


def _stack(known: list[tuple[list[Floats], list[int]]]) -> BodyShapes:
    corners = np.vstack([ring for rings, _ in known for ring in rings])
    count = np.array([len(ring) for rings, _ in known for ring in rings])
    shape = np.repeat(np.arange(len(known)), [len(rings) for rings, _ in known])
    start = np.cumsum(count) - count
    nexts = np.arange(len(corners)) + 1
    nexts[start + count - 1] = start
    first = np.concatenate([[0], np.cumsum(np.bincount(shape, count, len(known)))]).astype(np.int64)
    # runs of a ring are as nearly equal as can be
    longest = np.maximum(4, np.rint(0.7 * np.sqrt(np.diff(first))))[shape]
    runs = np.maximum(1, np.rint(count / longest)).astype(np.int64)
    ring = np.repeat(np.arange(len(count)), runs)
    nth = np.arange(len(ring)) - (np.cumsum(runs) - runs)[ring]
    run = start[ring] + nth * (count // runs)[ring] + np.minimum(nth, (count % runs)[ring])
    run_end = np.concatenate([run[1:], [len(corners)]])
    last = corners[nexts[run_end - 1]]
    low, high = (np.minimum.reduceat(corners, run), np.maximum.reduceat(corners, run))
    middle = (np.minimum(low, last) + np.maximum(high, last)) / 2
    inside = np.hypot(*(corners - np.repeat(middle, run_end - run, axis=0)).T)
    disc = np.maximum(np.maximum.reduceat(inside, run), np.hypot(*(last - middle).T))
    along = corners[nexts] - corners
    length = np.hypot(*along.T)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    return BodyShapes(
        corners, nexts, normal, length, np.repeat(np.concatenate([m for _, m in known]), count), first,
        np.maximum.reduceat(np.hypot(*corners.T), first[:-1]), np.concatenate([run, [len(corners)]]),
        np.concatenate([[0], np.cumsum(np.bincount(shape[ring], minlength=len(known)))]), np.column_stack([middle, disc]),
    )  # fmt: skip


def _area(ring: Floats) -> float:
    """Area of a ring (n, 2), positive where it turns counter-clockwise."""
    x, y = ring.T
    return float(x @ np.roll(y, -1) - np.roll(x, -1) @ y) / 2


def _moment(ring: Floats) -> Floats:
    """First moment (2,) of the area of a ring."""
    after = np.roll(ring, -1, 0)
    cross = ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]
    return ((ring + after) * cross[:, None]).sum(0) / 6


def corners(bodies: Bodies) -> tuple[Ints, Floats]:
    """Body (N,) of every corner, and where it lies at rest (N, 2) [mm]."""
    shapes, count = bodies.shapes, np.diff(bodies.shapes.first)[bodies.shape]
    body = np.repeat(np.arange(len(count)), count)
    row = np.arange(len(body)) + np.repeat(shapes.first[bodies.shape] - (np.cumsum(count) - count), count)
    c, s = np.cos(bodies.rest[body, 2]), np.sin(bodies.rest[body, 2])
    x, y = shapes.corner[row].T
    return body, np.column_stack([c * x - s * y, s * x + c * y]) + bodies.rest[body, :2]
