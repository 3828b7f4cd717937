"""What a certificate claims, whole and in a sentence: who is asked about, in which direction, at which point, at which gap, beside whom."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal
from typing import Any

AXES = {(1.0, 0.0): "+x", (-1.0, 0.0): "-x", (0.0, 1.0): "+y", (0.0, -1.0): "-y"}


@dataclass(frozen=True)
class Term:
    """One pull or turn: direction . displacement of a point of a body + spin * turn of it.

    Parameters
    ----------
    parts : tuple of str
        Of the body that is asked about.
    direction : (dx, dy)
        Its length is the weight.
    point : (x, y) [mm] or None
        At rest; None where it is not said.
    spin : float
        Weight of the turn [rad], counter-clockwise.
    """

    parts: tuple[str, ...]
    direction: tuple[float, float]
    point: tuple[float, float] | None
    spin: float


@dataclass(frozen=True)
class Claim:
    """No motion from rest makes the sum of the terms larger than `at_most`.

    Parameters
    ----------
    at_most : float [mm], in radians where only turns are asked for
    gap : float [mm]
    bodies : tuple of tuples of str
        Names of the parts of each body.
    fixed : tuple of tuples of str
        The bodies that stand.
    terms : tuple of Term
    polygons : tuple of lists
        For each body its polygons, each an outer ring and its holes of points (x, y) [mm].
    pairs : tuple of pairs of int
        Bodies that the proof takes to collide.
    """

    at_most: float
    gap: float
    bodies: tuple[tuple[str, ...], ...]
    fixed: tuple[tuple[str, ...], ...]
    terms: tuple[Term, ...]
    polygons: tuple[list, ...]
    pairs: tuple[tuple[int, int], ...]

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return sum(map(len, self.bodies))


def claim_of(content: dict[str, Any]) -> Claim:
    """Find what a certificate claims; its form was checked."""
    bodies = tuple(tuple(body["parts"]) for body in content["bodies"])
    return Claim(
        float(content["at_most"]),
        float(content["gap"]),
        bodies,
        tuple(parts for parts, body in zip(bodies, content["bodies"], strict=True) if body["fixed"]),
        tuple(
            Term(bodies[k], (float(dx), float(dy)), (float(x), float(y)), float(spin))
            for k, dx, dy, x, y, spin in content["goal"]
        ),
        tuple(body["polygons"] for body in content["bodies"]),
        tuple((a, b) for a, b, *_ in content["pairs"]),
    )


def sentence(claim: Claim, source: str = "", note: str = "") -> str:
    """Say the whole claim.

    Parameters
    ----------
    claim : Claim
    source : str
        The drawing whose outlines these are; empty where none was compared.
    note : str
        Said of the gap.
    """
    glued = [_together(parts) for parts in claim.bodies if len(parts) > 1]
    fixed = [_together(parts) for parts in claim.fixed]
    conditions = [
        f"the gap is {claim.gap:.9g} mm{note}",
        f"{_list(fixed)} {'is' if len(fixed) == 1 else 'are'} fixed",
        f"{'nothing is' if not glued else _list(glued) + (' is' if len(glued) == 1 else ' are')} glued",
        f"there are {claim.parts} parts in all",
        f"outlines are those of {source}" if source else "outlines are those in this file",
    ]
    return f"no motion of {_asked(claim)} that starts at rest {_more(claim)}, where {', '.join(conditions[:-1])}, and {conditions[-1]}"


def describe_terms(terms: Iterable[Term]) -> str:
    """Pulls and turns in a few words.

    >>> describe_terms([Term(("a",), (0.0, 1.0), (2.0, 3.0), 0.0), Term(("b",), (0.0, 0.0), None, -1.0)])
    'point (2, 3) of a in direction +y; a turn of b clockwise'
    """
    return "; ".join(_told(term) for term in terms)


def describe_parts(parts: Iterable[str]) -> str:
    """Names one after the other; a name that could be taken for something else stands in quotation marks.

    >>> describe_parts(["b1", "b2 is fixed"])
    'b1, "b2 is fixed"'
    """
    return _list([_name(name) for name in parts])


def rounded_up(value: float, digits: int = 6) -> str:
    """Value with `digits` digits, never less than it is.

    >>> rounded_up(0.61542841), rounded_up(12.0), rounded_up(-1.23456789)
    ('0.615429', '12', '-1.23456')
    """
    exact = Decimal(value)
    if not exact:
        return "0"
    step = Decimal(1).scaleb(exact.adjusted() - digits + 1)
    up = exact.quantize(step, rounding=ROUND_CEILING).normalize()
    return f"{up:f}" if -5 <= up.adjusted() < 9 else f"{up:e}"


def _asked(claim: Claim) -> str:
    return _list(list(dict.fromkeys(_together(term.parts) for term in claim.terms)))


def _more(claim: Claim) -> str:
    """What no motion does."""
    most = rounded_up(claim.at_most)
    if len(claim.terms) == 1:
        term = claim.terms[0]
        length = math.hypot(*term.direction)
        if term.spin == 0 and abs(length - 1) < 1e-9:
            return (
                f"moves its point {_plane(term.point)} by more than {most} mm in direction {_direction(term.direction)}"
            )
        if length == 0 and abs(term.spin) == 1:
            degrees = rounded_up(math.degrees(claim.at_most) * (1 + 1e-14))
            return f"turns it {_sense(term.spin)} by more than {degrees} degrees"
    unit = {(True, False): " mm", (False, True): " radians"}.get(
        (any(any(t.direction) for t in claim.terms), any(t.spin for t in claim.terms)), " (mm and radians added)"
    )
    return f"makes {' plus '.join(_summand(term) for term in claim.terms)} more than {most}{unit}"


def _summand(term: Term) -> str:
    said = []
    length = math.hypot(*term.direction)
    if length:
        said.append(
            f"{length:.9g} times what point {_plane(term.point)} of {_together(term.parts)} moves in direction "
            f"{_direction(term.direction)} [mm]"
        )
    if term.spin:
        said.append(f"{abs(term.spin):.9g} times what {_together(term.parts)} turns {_sense(term.spin)} [rad]")
    return " plus ".join(said)


def _told(term: Term) -> str:
    length, said = math.hypot(*term.direction), []
    if length:
        at = "" if term.point is None else f"point {_plane(term.point)} of "
        weight = "" if abs(length - 1) < 1e-9 else f"{length:.9g} times "
        said.append(f"{weight}{at}{_together(term.parts)} in direction {_direction(term.direction)}")
    if term.spin:
        weight = "" if abs(term.spin) == 1 else f"{abs(term.spin):.9g} times "
        said.append(f"{weight}a turn of {_together(term.parts)} {_sense(term.spin)}")
    return " and ".join(said)


def _direction(direction: tuple[float, float]) -> str:
    length = math.hypot(*direction)
    unit = direction[0] / length, direction[1] / length
    return AXES.get((unit[0] + 0.0, unit[1] + 0.0), _plane(unit))


def _plane(point: tuple[float, float] | None) -> str:
    return "that is not said" if point is None else f"({point[0] + 0.0:.9g}, {point[1] + 0.0:.9g})"


def _sense(spin: float) -> str:
    return "counter-clockwise" if spin > 0 else "clockwise"


def _together(parts: Sequence[str]) -> str:
    return "+".join(_name(name) for name in parts)


def _name(name: str) -> str:
    plain = re.fullmatch(r"[A-Za-z0-9_][\w.:-]*", name) and name.isprintable()
    return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())


def _list(names: list[str]) -> str:
    return ", ".join(names)
