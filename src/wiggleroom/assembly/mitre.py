"""Outlines moved along their normals, edge by edge, with exact mitred corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.loops import Loops, dot_products, polygons
from wiggleroom.drawing.model import Points

STEP_COSINE = np.cos(np.radians(20.0))
"""Edges that turn less than this and move by different amounts are joined by a step: a mitre would run far off."""


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
    def shortens(self) -> NDArray[np.bool_]:
        """Where both edges lose length."""
        return (dot_products(self.shift, self.along[self.before]) < 0) & (dot_products(self.shift, self.along) > 0)


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
        Same corners in the same order; a step adds one.
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
        step = corner.step[:, None]
        first, second = np.where(step, corner.end, first), np.where(step, corner.start, second)
    forward = np.logical_and.reduceat(dot_products(first[loops.after] - second, corner.along) > 0, loops.starts)
    if not steps:
        return first, loops.counts, forward
    both = np.stack([first, second], axis=1)
    keep = np.column_stack([np.ones(len(first), dtype=bool), corner.step])
    counts = loops.counts + np.add.reduceat(corner.step.astype(np.int64), loops.starts)
    return both[keep], counts, forward


def _corners(loops: Loops, inward: NDArray[np.float64]) -> _Corners:
    before = loops.before
    edge = loops.points[loops.after] - loops.points
    along = edge / np.hypot(*edge.T)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    behind, there = inward[before], inward
    # n1 . shift = d1 and n2 . shift = d2, written so that nearly straight corners lose no digits
    shift, half = _scaled(normal[before] + normal, (behind + there) / 2), (behind - there) / 2
    step = half != 0
    if step.any():  # else neighbouring edges move alike
        shift = shift + np.where(step[:, None], _scaled(normal[before] - normal, half), 0.0)
        step &= dot_products(along[before], along) > STEP_COSINE
    return _Corners(loops, inward, before, along, normal, shift, step)


def _scaled(direction: Points, amount: NDArray[np.float64]) -> Points:
    """`direction` scaled so that its part along either normal is `amount`; finite even for a needle's tip."""
    return direction * (2 * amount / np.maximum(dot_products(direction, direction), 1e-18))[:, None]


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
    both = np.stack([corner.end, loops.points, corner.start], axis=1)
    single = ~(corner.step | corner.shortens)
    both[single, 0] = corner.mitre[single]
    keep = np.column_stack([np.ones(len(single), dtype=bool), ~single, ~single])
    raw = Loops(both[keep], loops.counts + 2 * np.add.reduceat((~single).astype(np.int64), loops.starts))
    ends = np.stack([raw.points, raw.points[raw.after]], axis=1)
    segments = ends[(ends[:, 0] != ends[:, 1]).any(axis=1)]
    net = shapely.union_all(shapely.linestrings(segments))
    faces = shapely.get_parts(shapely.polygonize([net]))
    if not len(faces):
        return []
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    left = shapely.union_all(faces[_winding(inside, segments) > 0])
    drawn = polygons(loops, np.zeros(len(loops.counts), dtype=np.int64))[0]
    return _without_dust(shapely.get_parts(left), 1e-12 * drawn.area)


def _winding(points: Points, segments: NDArray[np.float64]) -> NDArray[np.int64]:
    """How often closed loops of segments (m, 2, 2) wind round each point (n, 2), counter-clockwise positive."""
    start, end = segments[None, :, 0] - points[:, None], segments[None, :, 1] - points[:, None]
    side = start[..., 0] * end[..., 1] - start[..., 1] * end[..., 0]
    up = (start[..., 1] <= 0) & (end[..., 1] > 0) & (side > 0)
    down = (start[..., 1] > 0) & (end[..., 1] <= 0) & (side < 0)
    return up.sum(axis=1) - down.sum(axis=1)


def _without_dust(pieces: NDArray[np.object_], smallest: float) -> list[shapely.Polygon]:
    """Polygons without pieces and holes that are rounding errors, material left of every edge."""
    kept = []
    for piece in pieces[shapely.area(pieces) > smallest]:
        holes = [h for h in piece.interiors if shapely.area(shapely.Polygon(h)) > smallest]
        kept.append(shapely.orient_polygons(shapely.Polygon(piece.exterior, holes)))
    return kept
