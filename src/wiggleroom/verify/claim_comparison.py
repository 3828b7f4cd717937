"""Whether a certificate speaks of a drawing: whole rings, bodies, glue, fixed parts, gap and goal are compared, one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wiggleroom.verify.claim import Claim, Term, describe_parts, describe_terms

ALIKE = 1e-12
"""Corners and points agree where they differ by no more than this share of the drawing's size, and the rounding of their coordinates."""

Rings = list[np.ndarray]


@dataclass(frozen=True, eq=False)
class Specification:
    """What a drawing and the options beside it say; None for what neither says.

    Parameters
    ----------
    source : str
        Name of the drawing; empty where there is none.
    gap : float [mm] or None
    fixed : frozenset of str or None
        Names of the parts that stand.
    terms : tuple of Term or None
        Pulls and turns, each of one part.
    bodies : tuple of (names, polygons) or None
        Parts that move as one, and their polygons at rest: each an outer ring and holes (n, 2) [mm], material left of every edge.
    ignored : frozenset of pairs of str
        Parts that never collide.
    """

    source: str = ""
    gap: float | None = None
    fixed: frozenset[str] | None = None
    terms: tuple[Term, ...] | None = None
    bodies: tuple[tuple[frozenset[str], list[Rings]], ...] | None = None
    ignored: frozenset[frozenset[str]] = frozenset()


def difference(claim: Claim, asked: Specification) -> str:
    """The first thing in which a certificate differs from a drawing and options, in one line; empty where there is none."""
    where = asked.source or "the command"
    size = _size(asked)
    return (
        _bodies(claim, asked, where)
        or _fixed(claim, asked, where)
        or _outlines(claim, asked, where, size)
        or _gap(claim, asked, where)
        or _goal(claim, asked, where, size)
        or _ignored(claim, asked, where)
    )


def unstated(claim: Claim, asked: Specification) -> list[str]:
    """What a certificate alone states."""
    found = []
    if asked.gap is None:
        found.append(f"that the gap is {claim.gap:.9g} mm")
    if asked.fixed is None:
        names = [name for parts in claim.fixed for name in parts]
        found.append(f"that {describe_parts(names)} {'is' if len(names) == 1 else 'are'} fixed")
    if asked.terms is None:
        found.append(f"what is asked ({describe_terms(claim.terms)})")
    elif any(term.point is None and any(term.direction) for term in asked.terms):
        found.append(f"which point is meant ({describe_terms(claim.terms)})")
    return found


def _size(asked: Specification) -> float:
    if asked.bodies is None:
        return 0.0
    corners = np.vstack([ring for _, polygons in asked.bodies for rings in polygons for ring in rings])
    return float(np.ptp(corners, axis=0).max()) * ALIKE + float(np.abs(corners).max()) * 2.0**-49


def _bodies(claim: Claim, asked: Specification, where: str) -> str:
    if asked.bodies is None:
        return ""
    mine, own = {n for parts in claim.bodies for n in parts}, {n for parts, _ in asked.bodies for n in parts}
    if mine != own:
        more, less = sorted(mine - own), sorted(own - mine)
        said = [f"it has {describe_parts(more)}" for _ in more[:1]] + [
            f"it lacks {describe_parts(less)}" for _ in less[:1]
        ]
        return f"{where} has other parts than the certificate: {' and '.join(said)}"
    groups = {parts for parts, _ in asked.bodies}
    for parts in claim.bodies:
        if frozenset(parts) not in groups:
            real = next(group for group in groups if parts[0] in group)
            return f"the certificate has {_body(parts)}, {where} has {_body(sorted(real))}"
    return ""


def _body(parts: Sequence[str]) -> str:
    return f"{describe_parts(parts)} glued together" if len(parts) > 1 else f"{describe_parts(parts)} by itself"


def _fixed(claim: Claim, asked: Specification, where: str) -> str:
    """Bodies stand where one of their parts does."""
    if asked.fixed is None:
        return ""
    names = {n for parts in claim.bodies for n in parts}
    lost = sorted(asked.fixed - names)
    if lost:
        return f"{where} fixes {describe_parts(lost)}, which the certificate does not have"
    stands = {parts for parts in claim.bodies if asked.fixed & set(parts)}
    for parts in claim.bodies:
        if (parts in claim.fixed) != (parts in stands):
            one, two = ("the certificate", where) if parts in claim.fixed else (where, "the certificate")
            return f"{one} fixes {describe_parts(parts)}, {two} does not"
    return ""


def _outlines(claim: Claim, asked: Specification, where: str, near: float) -> str:
    if asked.bodies is None:
        return ""
    own = dict(asked.bodies)
    for parts, polygons in zip(claim.bodies, claim.polygons, strict=True):
        why = _polygons(polygons, own[frozenset(parts)], near)
        if why:
            gaps = _gap(claim, asked, where)
            return f"{describe_parts(parts)} has other outlines in {where}: {why}" + (f"; {gaps}" if gaps else "")
    return ""


def _polygons(mine: list[list[list]], own: list[Rings], near: float) -> str:
    """What is different between two sets of polygons, in any order; each ring may begin at any of its corners."""
    if len(mine) != len(own):
        return f"{len(own)} separate pieces there, {len(mine)} in the certificate"
    made = [[np.array(ring, dtype=float) for ring in rings] for rings in mine]
    match = _matched([rings[0] for rings in made], [rings[0] for rings in own])
    pairs = [(rings, own[k]) for rings, k in zip(made, match, strict=True)]
    return next(
        (why for one, two in pairs if (why := _rings(one[:1], two[:1], near) or _rings(one[1:], two[1:], near))), ""
    )


def _rings(mine: Rings, own: Rings, near: float) -> str:
    if len(mine) != len(own):
        return f"{len(own)} holes there, {len(mine)} in the certificate"
    for ring, k in zip(mine, _matched(mine, own), strict=True):
        if len(own[k]) != len(ring):
            return f"a ring of {len(own[k])} corners there, of {len(ring)} in the certificate"
        away = _apart(ring, own[k])
        if not away <= near:
            return f"a corner lies {away:.3g} mm away"
    return ""


def _matched(mine: Rings, own: Rings) -> list[int]:
    """For each ring another one that is most like it, none twice: as many corners if there is one, and nearest in the middle."""
    middle, corners = np.array([ring.mean(0) for ring in own]).reshape(-1, 2), np.array([len(ring) for ring in own])
    free, found = np.ones(len(own), dtype=bool), []
    for ring in mine:
        some = np.flatnonzero(free & (corners == len(ring)))
        some = some if len(some) else np.flatnonzero(free)
        found.append(int(some[np.hypot(*(middle[some] - ring.mean(0)).T).argmin()]))
        free[found[-1]] = False
    return found


def _apart(ring: np.ndarray, other: np.ndarray) -> float:
    """Largest distance of corners that belong together, in the same order round [mm]."""
    start = int(np.hypot(*(other - ring[0]).T).argmin())
    return float(np.hypot(*(ring - np.roll(other, -start, 0)).T).max())


def _gap(claim: Claim, asked: Specification, where: str) -> str:
    if asked.gap is None or abs(asked.gap - claim.gap) <= ALIKE * asked.gap:
        return ""
    return f"the gap is {claim.gap:.9g} mm in the certificate, {asked.gap:.9g} mm in {where}"


def _goal(claim: Claim, asked: Specification, where: str, near: float) -> str:
    if asked.terms is None:
        return ""
    body = {name: parts for parts in claim.bodies for name in parts}
    left = list(claim.terms)
    for term in asked.terms:
        match = next((t for t in left if body.get(term.parts[0]) == t.parts and _same(t, term, near)), None)
        if match is None:
            return f"the certificate is about {describe_terms(claim.terms)}; {where} asks for {describe_terms(asked.terms)}"
        left.remove(match)
    if left:
        return f"the certificate adds {describe_terms(left)}, which {where} does not ask"
    return ""


def _same(mine: Term, asked: Term, near: float) -> bool:
    exact = 1e-12 * max(np.hypot(*asked.direction), abs(asked.spin))
    turned = np.hypot(mine.direction[0] - asked.direction[0], mine.direction[1] - asked.direction[1]) <= exact
    placed = not any(asked.direction) or asked.point is None or mine.point is None
    if not placed and asked.point is not None and mine.point is not None:
        away = np.hypot(mine.point[0] - asked.point[0], mine.point[1] - asked.point[1])
        placed = bool(away <= max(near, ALIKE * float(np.hypot(*asked.point))))
    return bool(turned and abs(mine.spin - asked.spin) <= exact and placed)


def _ignored(claim: Claim, asked: Specification, where: str) -> str:
    for a, b in claim.pairs:
        for one in claim.bodies[a]:
            for two in claim.bodies[b]:
                if frozenset((one, two)) in asked.ignored:
                    pair = f"{describe_parts([one])} and {describe_parts([two])}"
                    return f"{where} says that {pair} never collide, and the proof uses that they do"
    return ""
