"""Numbers with their rounding error (python-flint's balls), and what is needed of plane vectors of them."""

from __future__ import annotations

from typing import Any

from flint import arb

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
    need(abs(number) < 1e130, f"{number!r} is no number that can be used")
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


def dot(p: Point, q: Point) -> arb:
    """Scalar product of two vectors."""
    return p[0] * q[0] + p[1] * q[1]


def less(p: Point, q: Point) -> Point:
    """From q to p."""
    return p[0] - q[0], p[1] - q[1]


def size(p: Point) -> arb:
    """Length of a vector."""
    return (p[0] * p[0] + p[1] * p[1]).sqrt()


def same_sign(x: arb, y: arb) -> bool:
    """Whether both are certainly positive or both certainly negative."""
    return bool((x > 0 and y > 0) or (x < 0 and y < 0))
