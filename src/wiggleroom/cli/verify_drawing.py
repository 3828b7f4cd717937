"""What a drawing and options say, for `wiggleroom verify` to compare with a certificate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.cli.options import QuestionOptions
    from wiggleroom.drawing.model import Goal, Part
    from wiggleroom.verify.claim import Claim, Term
    from wiggleroom.verify.claim_comparison import Rings, Specification


def drawn_by(file: str | None, asked: QuestionOptions, claim: Claim) -> Specification:
    """What a drawing and options say; without a drawing, the options alone.

    A drawing other than an assembly file states no gap: where no option does, it is read at the gap of the claim.

    Raises
    ------
    InputError
        With everything that is wrong with the options and the file, one line each.
    """
    from dataclasses import replace

    from wiggleroom.cli.options import read
    from wiggleroom.errors import InputError
    from wiggleroom.verify.claim_comparison import Specification

    if asked.objective is not None:
        wrong = "--objective: certificates are about pulls and turns; name them with --pull and --turn"
        raise InputError(wrong)
    if file is None:
        return _options(asked, claim)
    stated = asked.gap is not None or Path(file).suffix.lower() == ".json"
    assembly = read(file, asked if stated else replace(asked, gap=claim.gap))
    fixed = frozenset(part.name for part in assembly.parts if part.fixed)
    place = {part.name: (part.at[0], part.at[1]) for part in assembly.parts}
    return Specification(
        Path(file).name,
        assembly.gap if stated else None,
        fixed or None,
        _terms(assembly.goals, file, place) if assembly.goals else None,
        _bodies(assembly),
        frozenset(frozenset(pair) for pair in assembly.drawing.ignore),
    )


def _options(asked: QuestionOptions, claim: Claim) -> Specification:
    from wiggleroom.cli.asking import names
    from wiggleroom.cli.options import goals_of_options
    from wiggleroom.errors import InputError
    from wiggleroom.verify.claim_comparison import Specification

    odd = [
        f"--{name} is for a drawing; name it too" for name in ("unit", "flatten") if getattr(asked, name) is not None
    ]
    if odd:
        raise InputError(odd)
    goals = goals_of_options(asked)
    fixed = frozenset(names(asked.fix, {name for parts in claim.bodies for name in parts}))
    return Specification(gap=asked.gap, fixed=fixed or None, terms=_terms(goals, "the command", {}) if goals else None)


def _terms(goals: Sequence[Goal], source: str, place: dict[str, tuple[float, float]]) -> tuple[Term, ...]:
    """Pulls, turns and Ws as terms of a claim; where no point is named it is the part's reference point, at `place`."""
    import math

    from wiggleroom.drawing.model import Pull, Turn, W
    from wiggleroom.errors import InputError
    from wiggleroom.verify.claim import Term

    found = []
    for goal in goals:
        match goal:
            case Pull(part, (dx, dy), point, weight):
                share = weight / math.hypot(dx, dy)
                found.append(
                    Term((part,), (share * dx, share * dy), (point[0], point[1]) if point else place.get(part), 0.0)
                )
            case Turn(part, sense, weight):
                found.append(Term((part,), (0.0, 0.0), place.get(part), weight if sense == "ccw" else -weight))
            case W(part, (wx, wy, turn), weight):
                found.append(Term((part,), (weight * wx, weight * wy), place.get(part), weight * turn))
            case _:
                wrong = f"{source} asks for sums of squares, which no certificate is about; name the pull with --pull"
                raise InputError(wrong)
    return tuple(found)


def _bodies(assembly: Assembly) -> tuple[tuple[frozenset[str], list[Rings]], ...]:
    """Parts that move as one, and what they cover."""
    together = {name: frozenset((name,)) for name in assembly.names}  # apart from what the proof was made with
    for names in assembly.drawing.glue:
        joined = frozenset().union(*(together[name] for name in names))
        together |= dict.fromkeys(joined, joined)
    members: dict[frozenset[str], list[Part]] = {}
    for part in assembly.parts:
        members.setdefault(together[part.name], []).append(part)
    return tuple((names, _covered(parts)) for names, parts in members.items())


def _covered(parts: list[Part]) -> list[Rings]:
    """Outer ring and holes of every polygon that parts make up together, material left of every edge."""
    import shapely

    from wiggleroom.assembly.assembly import place

    regions = [
        [place(ring, part.at) for ring in (region.outer, *region.holes)] for part in parts for region in part.regions
    ]
    if len(regions) == 1:
        return regions
    whole = shapely.union_all([shapely.Polygon(outer, holes) for outer, *holes in regions])
    return [
        [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
        for polygon in shapely.get_parts(shapely.orient_polygons(whole))
    ]
