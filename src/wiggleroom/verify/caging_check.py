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

from flint import arb, fmpq

from wiggleroom.verify.ball_arithmetic import (
    Point,
    cross,
    dot,
    exact,
    less,
    need,
    point,
    size,
    turned,
)


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
