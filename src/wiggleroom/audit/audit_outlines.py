"""Outlines of all parts, moved inward by the depth of overlap that counts as none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

INSET = 2e-10
"""Outlines are moved inward by this share of the drawing's size before they are judged."""
LONGEST_MITRE = 4.0
"""A corner moves inward by at most this multiple of its edges."""
ULPS = 32.0
"""Rounding errors of a coordinate that was turned and moved, in units of the last place of the largest number involved."""
EDGES_IN_RUN = 8
"""Edges that share one disc: runs that are far apart are set aside whole."""


@dataclass(frozen=True, eq=False)
class AuditOutlines:
    """Outlines of parts, each distinct one once: the edges of shape s are rows `first[s]` to `first[s + 1]`.

    Parameters
    ----------
    rest : (n, 3) float64 [mm, mm, rad]
        Where the parts lie at rest; corners are given in these frames.
    shape : (n,) int64
        The shape of each part.
    corner : (N, 2) float64 [mm]
        Where each edge begins.
    next_corner : (N,) int64
        Row of the corner where each edge ends.
    direction : (N, 2) float64
        Unit vector along each edge.
    length : (N,) float64 [mm]
    first : (S + 1,) int64
    ring : (R,) int64
        Row of the first corner of every ring.
    first_ring : (S + 1,) int64
        First ring of every shape.
    run : (C + 1,) int64
        Rows where runs of consecutive edges begin, and the end of the last.
    first_run : (S + 1,) int64
        First run of every shape.
    run_disc : (C, 3) float64 [mm]
        Centre and radius of a disc round each run.
    disc : (S, 3) float64 [mm]
        Centre and radius of a disc round each shape.
    reach : (S,) float64 [mm]
        Largest distance of a corner from the reference point of the parts.
    body : (n,) int64
        Parts of the same number are glued together, and never collide.
    fixed : (n,) bool
    ignored : (k,) int64
        Keys a * n + b, a < b, of pairs of parts that never collide.
    rounding : float [mm]
        More than rounding can change the distance of a corner from an edge.
    """

    rest: Floats
    shape: Ints
    corner: Floats
    next_corner: Ints
    direction: Floats
    length: Floats
    first: Ints
    ring: Ints
    first_ring: Ints
    run: Ints
    first_run: Ints
    run_disc: Floats
    disc: Floats
    reach: Floats
    body: Ints
    fixed: NDArray[np.bool_]
    ignored: Ints
    rounding: float


def outlines(assembly: Assembly) -> AuditOutlines:
    """Flatten the outlines of an assembly and move them inward by `INSET` of its size.

    Two parts that overlap by less than that, for example where they touch, are then a little apart.
    """
    rest = assembly.rest
    shape, rings, outer, owner = _distinct(assembly)
    count = np.array([len(r) for r in rings])
    start = np.cumsum(count) - count
    corner = np.concatenate(rings)
    size = assembly.size
    rounding = ULPS * np.finfo(float).eps * (size + 2 * float(np.hypot(*corner.T).max()))
    inset = max(INSET * size, 4 * rounding)

    after = np.arange(1, len(corner) + 1)
    after[start + count - 1] = start
    corner = _turned(corner, after, start, count, np.array(outer))
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    corner = _inward(corner, before, after, inset)
    corner, after, start, count = _without_points(corner, after, start, count)
    edge = corner[after] - corner
    length = np.hypot(*edge.T)

    shapes = np.arange(shape.max() + 2)
    of_ring = np.array(owner)
    first_ring = np.searchsorted(of_ring, shapes)
    first = np.append(start, len(corner))[first_ring]
    run, owner_of_run = _runs(start, count, of_ring)
    disc_of_run = _discs(corner, after, run)
    low, high = np.minimum.reduceat(corner, first[:-1]), np.maximum.reduceat(corner, first[:-1])
    middle = (low + high) / 2
    of_corner = np.repeat(shapes[:-1], np.diff(first))
    radius = np.maximum.reduceat(np.hypot(*(corner - middle[of_corner]).T), first[:-1])
    return AuditOutlines(
        rest=rest,
        shape=shape,
        corner=corner,
        next_corner=after,
        direction=edge / length[:, None],
        length=length,
        first=first,
        ring=start,
        first_ring=first_ring,
        run=np.append(run, len(corner)),
        first_run=np.searchsorted(owner_of_run, shapes),
        run_disc=disc_of_run,
        disc=np.column_stack([middle, radius]),
        reach=np.maximum.reduceat(np.hypot(*corner.T), first[:-1]),
        body=_bodies(assembly),
        fixed=np.array([p.fixed for p in assembly.parts]),
        ignored=_ignored(assembly),
        rounding=rounding,
    )


def _distinct(assembly: Assembly) -> tuple[Ints, list[Floats], list[bool], list[int]]:
    """Shape (n,) of each part; rings of the distinct shapes, which of them are outer ones, and the shape that each belongs to."""
    rings: list[Floats] = []
    outer: list[bool] = []
    owner: list[int] = []
    known: dict[tuple[tuple[bytes, ...], ...], int] = {}
    shape = np.empty(len(assembly.parts), dtype=np.int64)
    for p, part in enumerate(assembly.parts):
        regions = [[np.asarray(ring, dtype=float) for ring in (region.outer, *region.holes)] for region in part.regions]
        new = len(known)
        shape[p] = known.setdefault(tuple(tuple(ring.tobytes() for ring in region) for region in regions), new)
        for region in regions if shape[p] == new else []:
            rings += region
            outer += [k == 0 for k in range(len(region))]
            owner += [new] * len(region)
    return shape, rings, outer, owner


def _turned(corner: Floats, after: Ints, start: Ints, count: Ints, outer: NDArray[np.bool_]) -> Floats:
    """Corners (N, 2) of rings, in reverse where needed so that material lies left of their edges: within outer rings, outside of holes."""
    x, y = (corner - np.repeat(corner[start], count, axis=0)).T
    area = np.add.reduceat(x * y[after] - x[after] * y, start)
    backwards = np.repeat((area > 0) != outer, count)
    row = np.arange(len(corner))
    mirrored = np.repeat(2 * start + count - 1, count) - row
    return corner[np.where(backwards, mirrored, row)]


def _inward(corner: Floats, before: Ints, after: Ints, inset: float) -> Floats:
    """Corners (N, 2) moved along their bisectors, so that both edges move inward by `inset` [mm]."""
    edge = corner[after] - corner
    long = np.hypot(*edge.T)
    edge /= np.where(long > 0, long, 1.0)[:, None]
    inner = np.column_stack([-edge[:, 1], edge[:, 0]])
    both = inner + inner[before]
    share = np.maximum(1.0 + (inner * inner[before]).sum(axis=1), 2.0 / LONGEST_MITRE**2)
    return corner + inset * both / share[:, None]


def _without_points(corner: Floats, after: Ints, start: Ints, count: Ints) -> tuple[Floats, Ints, Ints, Ints]:
    """The same rings without edges of no length."""
    point = (corner[after] == corner).all(axis=1)
    if not point.any():
        return corner, after, start, count
    keep = ~point
    left = np.add.reduceat(keep, start)
    begin = np.cumsum(left) - left
    nexts = np.arange(1, int(left.sum()) + 1)
    nexts[begin + left - 1] = begin
    return corner[keep], nexts, begin, left


def _runs(start: Ints, count: Ints, of_ring: Ints) -> tuple[Ints, Ints]:
    """First rows of runs of edges within each ring, and the shape that each belongs to."""
    pieces = -(-count // EDGES_IN_RUN)
    ring = np.repeat(np.arange(len(count)), pieces)
    within = np.arange(len(ring)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return start[ring] + within * EDGES_IN_RUN, of_ring[ring]


def _discs(corner: Floats, after: Ints, run: Ints) -> Floats:
    """Discs (C, 3) round runs of edges."""
    far = corner[after]
    low = np.minimum(np.minimum.reduceat(corner, run), np.minimum.reduceat(far, run))
    high = np.maximum(np.maximum.reduceat(corner, run), np.maximum.reduceat(far, run))
    middle = (low + high) / 2
    of_edge = np.repeat(np.arange(len(run)), np.diff(np.append(run, len(corner))))
    away = np.maximum(np.hypot(*(corner - middle[of_edge]).T), np.hypot(*(far - middle[of_edge]).T))
    return np.column_stack([middle, np.maximum.reduceat(away, run)])


def _bodies(assembly: Assembly) -> Ints:
    """Number (n,) of the body that each part belongs to."""
    index = {name: k for k, name in enumerate(assembly.names)}
    body = np.arange(len(index))
    for names in assembly.drawing.glue:
        together = np.unique(body[[index[name] for name in names]])
        body[np.isin(body, together)] = together[0]
    return body


def _ignored(assembly: Assembly) -> Ints:
    """Keys of the pairs of parts that the drawing says never collide."""
    index = {name: k for k, name in enumerate(assembly.names)}
    pairs = (sorted((index[one], index[other])) for one, other in assembly.drawing.ignore)
    return np.array([a * len(index) + b for a, b in pairs], dtype=np.int64)
