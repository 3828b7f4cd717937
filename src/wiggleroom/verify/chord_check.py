"""Whether chords lie inside the material of a body: a chord that meets no edge lies where its start does."""

from __future__ import annotations

import numpy as np
from flint import arb

from wiggleroom.verify.ball_arithmetic import Point, Refused, cross, less, need, same_sign
from wiggleroom.verify.work_limit import EXACT, FLOAT, WorkLimit

RAY = (0.9272, 0.3746)
"""Direction of the ray that tells inside from outside; no edge is likely to run that way."""
ROUNDING = 2.0**-50
"""Several times the relative error of one operation on doubles."""
TINY = 1e-300
"""More than what underflows."""


def _inside(chord: tuple[Point, Point], edges: list[tuple[Point, Point]], odd: bool) -> bool:
    """Whether a chord meets none of the edges, and an odd number of them, with those passed already, lies on the ray from its start."""
    p, q = chord
    along, ray = less(q, p), (arb(RAY[0]), arb(RAY[1]))
    for v, w in edges:
        edge, seen, then = less(w, v), less(v, p), less(w, p)
        if not (
            same_sign(cross(along, seen), cross(along, then)) or same_sign(cross(edge, seen), cross(edge, less(v, q)))
        ):
            return False
        if not same_sign(cross(ray, seen), cross(ray, then)):
            need(same_sign(cross(ray, seen), cross(then, ray)), "a chord's place is not certain")
            odd ^= same_sign(cross(seen, edge), cross(ray, edge))
    return odd


class Material:
    """Polygons of a body, to ask which chords lie inside.

    Nearly all edges are far from a chord: for these doubles tell on which side they lie, as they come out larger than their error can be.
    The others are compared in ball arithmetic.
    """

    def __init__(self, polygons: list[list[list[list[float]]]], work: WorkLimit) -> None:
        self.work = work
        self.polygons = [Edges([np.array(ring, dtype=float) for ring in rings]) for rings in polygons]

    def check(self, chord: tuple[Point, Point]) -> None:
        """Refuse a chord that is not strictly inside one of the polygons."""
        p, q = (np.array([float(v.mid()) for v in end]) for end in chord)
        error = max(float(v.rad()) for end in chord for v in end) + ROUNDING * float(np.abs([p, q]).max())
        for edges in self.polygons:
            self.work.spend(len(edges.start))
            some = edges.near(p, q, error)
            start, end = edges.start[some], edges.end[some]
            unsure, odd = _far_edges(p, q, error, start, end)
            self.work.spend(FLOAT * len(some) + EXACT * len(unsure))
            if _inside(chord, [(_exact_point(start[k]), _exact_point(end[k])) for k in unsure], odd):
                return
        raise Refused("a chord does not lie inside its part")


class Edges:
    """Edges of one polygon, their boxes and how far their ends lie to the left of the ray's direction."""

    def __init__(self, rings: list[np.ndarray]) -> None:
        self.start = np.vstack(rings)
        self.end = np.vstack([np.roll(ring, -1, 0) for ring in rings])
        self.low, self.high = np.minimum(self.start, self.end), np.maximum(self.start, self.end)
        self.left = [RAY[0] * at[:, 1] - RAY[1] * at[:, 0] for at in (self.start, self.end)]
        self.far = float(np.abs(self.start).max())

    def near(self, p: np.ndarray, q: np.ndarray, error: float) -> np.ndarray:
        """Edges whose boxes meet that of the chord p q, or which may meet the line of the ray from p."""
        low, high = np.minimum(p, q) - error, np.maximum(p, q) + error
        boxes = ((self.low <= high) & (self.high >= low)).all(1)
        ray = RAY[0] * p[1] - RAY[1] * p[0]
        wrong = 2 * error + 4 * ROUNDING * (self.far + float(np.abs(p).max())) + TINY
        one, two = (left - ray for left in self.left)
        apart = ((one > wrong) & (two > wrong)) | ((one < -wrong) & (two < -wrong))
        return np.flatnonzero(boxes | ~apart)


def _far_edges(
    p: np.ndarray, q: np.ndarray, error: float, start: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, bool]:
    """Edges that, for all doubles tell, the chord p q might meet, and whether an odd number of the others lies on the ray from p.

    `error` [mm] is how far p and q may be wrong.
    """
    edge, seen, then, last = end - start, start - p, end - p, start - q
    along = np.broadcast_to(q - p, edge.shape)
    ray = np.broadcast_to(np.array(RAY), edge.shape)
    left = _sides(along, seen, 2 * error, error) * _sides(along, then, 2 * error, error)
    across = _sides(edge, seen, 0.0, error) * _sides(edge, last, 0.0, error)
    one, two = _sides(ray, seen, 0.0, error), _sides(ray, then, 0.0, error)
    ahead = _sides(seen, edge, error, 0.0) * _sides(ray, edge, 0.0, 0.0)
    passes = one * two < 0
    sure = ((left > 0) | (across > 0)) & (one * two != 0) & (~passes | (ahead != 0))
    return np.flatnonzero(~sure), bool(np.count_nonzero(sure & passes & (ahead > 0)) % 2)


def _sides(u: np.ndarray, w: np.ndarray, du: float, dw: float) -> np.ndarray:
    """Signs of u x w (n,), 0 where vectors wrong by du and dw, and rounding, leave it open."""
    first, second = u[:, 0] * w[:, 1], u[:, 1] * w[:, 0]
    tall, wide = np.abs(u).sum(1), np.abs(w).sum(1)
    wrong = du * wide + dw * tall + 2 * du * dw + ROUNDING * tall * wide + TINY
    value = first - second
    return np.where(np.abs(value) > wrong, np.sign(value), 0.0)


def _exact_point(at: np.ndarray) -> Point:
    return arb(float(at[0])), arb(float(at[1]))
