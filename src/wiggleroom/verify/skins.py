"""Step 1: skins. No way from rest leaves a skin, because everywhere on it a chord of A crosses a chord of B.

A skin is a stack of closed loops of translations (x, y), each at one turn; two neighbouring ones are joined by tracks, straight lines
from a corner of one to a corner of the other. At every turn in between, tracks that follow each other bound a side of a loop. If two chords
cross at both of its ends, they cross all along it, because where two segments cross is a parallelogram of translations. Along a
track each of the four conditions f > 0 of that parallelogram is a function of the turn whose second derivative is bounded:

    f(s) >= min(f at both ends) - (largest |f''|) width^2 / 8.

The first and the last loop enclose nothing (one corner, or two: there and back). So the skin is a closed surface, and as rest lies within
its loop at turn 0, all that can be reached does: its corners bound every motion of the pair.
"""

from __future__ import annotations

import itertools
from typing import Any

from flint import arb, fmpq

Point = tuple[arb, arb]


class Refused(Exception):  # noqa: N818
    """The certificate does not prove what it says."""


def need(fits: bool, what: str) -> None:
    """Refuse where something does not hold for certain."""
    if not fits:
        raise Refused(what)


def exact(number: Any) -> arb:
    """A number of the file, as it stands."""
    need(isinstance(number, int | float) and not isinstance(number, bool), f"{number!r} is no number")
    need(abs(number) < 1e100, f"{number!r} is no number that can be used")
    return arb(float(number))


def point(pair: Any) -> Point:
    """A point of the file."""
    need(isinstance(pair, list) and len(pair) == 2, f"{pair!r} is no point")
    return exact(pair[0]), exact(pair[1])


def turned(p: Point, angle: arb) -> Point:
    """A point turned about the origin."""
    c, s = angle.cos(), angle.sin()
    return c * p[0] - s * p[1], s * p[0] + c * p[1]


def cross(p: Point, q: Point) -> arb:
    """Signed area of two vectors."""
    return p[0] * q[1] - p[1] * q[0]


def less(p: Point, q: Point) -> Point:
    """From q to p."""
    return p[0] - q[0], p[1] - q[1]


def size(p: Point) -> arb:
    """Length of a vector."""
    return (p[0] * p[0] + p[1] * p[1]).sqrt()


def check_skin(region: dict[str, Any]) -> None:
    """Refuse a region whose skin is not closed, lets something through or does not go round rest."""
    a, b = ([(point(c[0]), point(c[1])) for c in region[k]] for k in ("a", "b"))
    loops = [(exact(angle), [point(p) for p in at]) for angle, at in region["loops"]]
    seams = region["seams"]
    need(len(loops) >= 3 and len(seams) == len(loops) - 1, "loops and seams do not fit together")
    need(all(1 <= len(loops[k][1]) <= 2 for k in (0, -1)), "a skin does not end in a point or a line")
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
    ways: dict[tuple[int, int, int, int], int] = {}  # a track is the end of one piece and the start of the next
    for piece, (k, m) in zip(itertools.pairwise(tracks), chords, strict=True):
        p, q = a[_place(k, a)], b[_place(m, b)]
        for i, j in piece:
            if (k, m, i, j) not in ways:
                at_low, at_high = [turned(v, low) for v in q], [turned(v, high) for v in q]
                ways[k, m, i, j] = _check_track(p, q, at_low, at_high, start[i], end[j], width)
        need(len({ways[k, m, i, j] for i, j in piece}) == 1, "two chords that are named do not cross everywhere")


def _check_track(
    a: tuple[Point, Point], b: tuple[Point, Point], low: list, high: list, start: Point, end: Point, width: arb
) -> int:
    """Which way two chords cross all along a track: 1 or -1."""
    first, second = _crossing(a, low, start), _crossing(a, high, end)
    way = 1 if first[0] > 0 else -1
    move = less(end, start)
    long_a, long_b = size(less(a[1], a[0])), size(less(b[1], b[0]))
    slide = abs(_dot(less(low[1], low[0]), move)) + width * size(move) * long_b
    for k in range(4):
        if k < 2:
            bend = long_a * size(b[k]) * width * width
        else:
            far = size(a[k - 2]) + abs_max(size(start), size(end))
            bend = long_b * far * width * width + 2 * slide * width
        for value in (first[k], second[k]):
            need(bool(way * value > bend / 8), "two chords that are named do not cross everywhere")
    return way


def abs_max(p: arb, q: arb) -> arb:
    """Not less than either."""
    return p.max(q)


def _dot(p: Point, q: Point) -> arb:
    return p[0] * q[0] + p[1] * q[1]


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


AWRY = (arb("0.9272"), arb("0.3746"))
"""Direction of the ray that tells inside from outside; no edge is likely to run that way."""


def check_inside(chord: tuple[Point, Point], polygons: list[list[list[Point]]]) -> None:
    """Refuse a chord that is not strictly inside one of the polygons: it meets none of their edges, and its start lies within."""
    p, q = chord
    along = less(q, p)
    for rings in polygons:
        clear, odd = True, False
        for ring in rings:
            for v, w in zip(ring, ring[1:] + ring[:1], strict=True):
                edge, seen, then = less(w, v), less(v, p), less(w, p)
                clear &= _same(cross(along, seen), cross(along, then)) or _same(
                    cross(edge, seen), cross(edge, less(v, q))
                )
                if not _same(cross(AWRY, seen), cross(AWRY, then)):
                    need(_same(cross(AWRY, seen), cross(then, AWRY)), "a chord's place is not certain")
                    odd ^= _same(cross(seen, edge), cross(AWRY, edge))
        if clear and odd:
            return
    raise Refused("a chord does not lie inside its part")


def _same(x: arb, y: arb) -> bool:
    return bool((x > 0 and y > 0) or (x < 0 and y < 0))
