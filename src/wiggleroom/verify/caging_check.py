"""Step 1: caging surfaces. No path from rest leaves a caging surface, because everywhere on it a chord of A crosses a chord of B.

A caging surface is a stack of closed loops of translations (x, y), each at one turn. Two neighbouring loops are joined by tracks, straight
lines from a corner of one to a corner of the other. At every turn in between, tracks that follow each other bound a side of a loop. If
two chords cross at both of its ends, they cross all along it, because where two segments cross is a parallelogram of translations. Along a
track each of the four conditions f > 0 of that parallelogram is a function of the turn whose second derivative is bounded:

    f(s) >= min(f at both ends) - (largest |f''|) width^2 / 8.

The first and the last loop enclose nothing (one corner, or two: there and back). So the surface is closed, and as rest lies within its
loop at turn 0, all that can be reached does: its corners bound every motion of the pair.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from flint import arb, fmpq

from wiggleroom.verify.ball_arithmetic import (
    Point,
    Refused,
    cross,
    dot,
    exact,
    less,
    need,
    point,
    same_sign,
    size,
    turned,
)
from wiggleroom.verify.work_limit import EXACT, FLOAT, WorkLimit


def check_caging_surface(region: dict[str, Any]) -> None:
    """Refuse a region whose caging surface is not closed, lets something through or does not go round rest."""
    a, b = ([(point(c[0]), point(c[1])) for c in region[k]] for k in ("a", "b"))
    loops = [(exact(angle), [point(p) for p in at]) for angle, at in region["loops"]]
    seams = region["seams"]
    need(len(loops) >= 3 and len(seams) == len(loops) - 1, "loops and seams do not fit together")
    need(all(1 <= len(loops[k][1]) <= 2 for k in (0, -1)), "a caging surface does not end in a point or a line")
    rest = [at for angle, at in loops if angle == 0]
    need(len(rest) == 1 and _round(rest[0]), "no loop goes round rest")
    for one, two, (tracks, chords) in zip(loops, loops[1:], seams, strict=False):
        need(bool(one[0] < two[0]), "turns of loops do not rise")
        _check_seam(one, two, tracks, chords, a, b)


def _place(k: Any, rows: list) -> int:
    need(isinstance(k, int) and 0 <= k < len(rows), "a number names nothing")
    return k


def _check_seam(
    one: tuple[arb, list[Point]], two: tuple[arb, list[Point]], tracks: list, chords: list, a: list, b: list
) -> None:
    """Tracks go once round both loops, and between neighbouring ones the named chords cross."""
    (low, start), (high, end) = one, two
    need(len(tracks) == len(chords) + 1 and tracks[0] == tracks[-1], "a seam is not closed")
    gone = [0, 0]
    for before, after in itertools.pairwise(tracks):
        for k, corners in enumerate((start, end)):
            _place(after[k], corners)
            step = (after[k] - before[k]) % len(corners)
            if len(corners) == 1:
                step = 0
            need(step <= 1, "a track leaves out a corner")
            gone[k] += step
    for k, corners in enumerate((start, end)):
        need(gone[k] == (0 if len(corners) == 1 else len(corners)), "a seam does not go once round")
    width = high - low
    signs: dict[tuple[int, int, int, int], int] = {}  # a track is the end of one piece and the start of the next
    for piece, (k, m) in zip(itertools.pairwise(tracks), chords, strict=True):
        p, q = a[_place(k, a)], b[_place(m, b)]
        for i, j in piece:
            if (k, m, i, j) not in signs:
                at_low, at_high = [turned(v, low) for v in q], [turned(v, high) for v in q]
                signs[k, m, i, j] = _check_track(p, q, at_low, at_high, start[i], end[j], width)
        need(len({signs[k, m, i, j] for i, j in piece}) == 1, "two chords that are named do not cross everywhere")


def _check_track(
    a: tuple[Point, Point], b: tuple[Point, Point], low: list, high: list, start: Point, end: Point, width: arb
) -> int:
    """Sense in which two chords cross all along a track: 1 or -1."""
    first, second = _crossing(a, low, start), _crossing(a, high, end)
    sign = 1 if first[0] > 0 else -1
    move = less(end, start)
    long_a, long_b = size(less(a[1], a[0])), size(less(b[1], b[0]))
    slide = abs(dot(less(low[1], low[0]), move)) + width * size(move) * long_b
    for k in range(4):
        if k < 2:
            bend = long_a * size(b[k]) * width * width
        else:
            far = size(a[k - 2]) + size(start).max(size(end))
            bend = long_b * far * width * width + 2 * slide * width
        for value in (first[k], second[k]):
            need(bool(sign * value > bend / 8), "two chords that are named do not cross everywhere")
    return sign


def _crossing(a: tuple[Point, Point], b: list[Point], shift: Point) -> list[arb]:
    """Four areas that have one sign where the chord b, shifted, crosses the chord a."""
    along, other = less(a[1], a[0]), less(b[1], b[0])
    ends = [(v[0] + shift[0], v[1] + shift[1]) for v in b]
    return [
        -cross(along, less(ends[0], a[0])),
        cross(along, less(ends[1], a[0])),
        cross(other, less(a[0], ends[0])),
        -cross(other, less(a[1], ends[0])),
    ]


def _round(corners: list[Point]) -> bool:
    """Whether a polygon goes round the origin: an odd number of its sides pass the ray to the right; exact."""
    odd = False
    points = [(fmpq(*_ratio(x)), fmpq(*_ratio(y))) for x, y in corners]
    for (x, y), (u, v) in zip(points, points[1:] + points[:1], strict=True):
        if (y > 0) != (v > 0) and (x - (u - x) / (v - y) * y > 0):
            odd = not odd
    return odd


def _ratio(number: arb) -> tuple[int, int]:
    return float(number).as_integer_ratio()


AWRY = (0.9272, 0.3746)
"""Direction of the ray that tells inside from outside; no edge is likely to run that way."""
ROUNDING = 2.0**-50
"""Several times the relative error of one operation on doubles."""
TINY = 1e-300
"""More than what underflows."""


def check_inside(chord: tuple[Point, Point], polygons: list[list[list[Point]]]) -> None:
    """Refuse a chord that is not strictly inside one of the polygons: it meets none of their edges, and its start lies within."""
    for rings in polygons:
        edges = [(v, w) for ring in rings for v, w in zip(ring, ring[1:] + ring[:1], strict=True)]
        if _inside(chord, edges, False):
            return
    raise Refused("a chord does not lie inside its part")


def _inside(chord: tuple[Point, Point], edges: list[tuple[Point, Point]], odd: bool) -> bool:
    """Whether a chord meets none of the edges, and an odd number of them, with those passed already, lies on the ray from its start."""
    p, q = chord
    along, ray = less(q, p), (arb(AWRY[0]), arb(AWRY[1]))
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
        self.left = [AWRY[0] * at[:, 1] - AWRY[1] * at[:, 0] for at in (self.start, self.end)]
        self.far = float(np.abs(self.start).max())

    def near(self, p: np.ndarray, q: np.ndarray, error: float) -> np.ndarray:
        """Edges whose boxes meet that of the chord p q, or which may meet the line of the ray from p."""
        low, high = np.minimum(p, q) - error, np.maximum(p, q) + error
        boxes = ((self.low <= high) & (self.high >= low)).all(1)
        ray = AWRY[0] * p[1] - AWRY[1] * p[0]
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
    ray = np.broadcast_to(np.array(AWRY), edge.shape)
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
