"""`wiggleroom verify`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal, Part
    from wiggleroom.verify.checker import Verified
    from wiggleroom.verify.claim import Claim, Term
    from wiggleroom.verify.claim_comparison import Rings, Specification
    from wiggleroom.verify.space_checker import SpatialClaim
    from wiggleroom.verify.space_claim import SpatialGoal, SpatialSpecification

PROVEN, REFUSED = 0, 1
"""Exit codes."""
_NONE_ASKED = QuestionOptions()


def verify(certificate: Path, file: str | None = None, /, *, asked: QuestionOptions = _NONE_ASKED) -> int:
    """Check a certificate of flex --prove --certificate with independent code.

    Every region, every range of turns and every bound is recomputed in ball arithmetic. Give the drawing too, with the
    options of flex: outlines, glue, fixed parts, gap and pulls must be those of the certificate. Facts that neither the
    drawing nor an option states are printed as stated by the certificate only. Exit code: 0 verified, 1 not verified, 2
    bad input. Needs the extra verify.

    Example: wiggleroom verify proof.json puzzle.svg --gap 0.2 --fix p1 --pull p20:+x

    Parameters
    ----------
    certificate
        The file that flex --prove 0.01 --certificate wrote.
    file
        The assembly file or drawing of the certificate. Without it, the statement is about the outlines in the
        certificate.
    """
    from wiggleroom.errors import InputError, require_extra

    require_extra("verify", "verify needs python-flint", "flint")
    from wiggleroom.verify.certificate_structure import FORMAT
    from wiggleroom.verify.checker import Refused
    from wiggleroom.verify.checker import read_certificate as content_of
    from wiggleroom.verify.checker import verify as check
    from wiggleroom.verify.space_checker import SpatialClaim

    try:
        content = content_of(certificate.read_text(encoding="utf-8"))
    except Refused as refusal:
        print(f"not verified: {refusal}")  # noqa: T201
        return REFUSED
    except ValueError as problem:
        wrong = f"{certificate}: this is not JSON ({problem}); give the file that flex --certificate wrote"
        raise InputError(wrong) from problem
    if not isinstance(content, dict) or not str(content.get("format", "")).startswith("wiggleroom.certificate/"):
        wrong = f'{certificate}: this is not a certificate: "format" must be "{FORMAT}"'
        raise InputError(wrong)
    found = check(content)
    claim = found.claim
    if claim is None:
        print(f"not verified: {found.why}")  # noqa: T201
        return REFUSED
    if isinstance(claim, SpatialClaim):
        return _compared_in_space(found, claim, None if file is None else assembled_by(file, asked))
    return _compared(found, claim, drawn_by(file, asked, claim))


def _compared_in_space(found: Verified, claim: SpatialClaim, asked: SpatialSpecification | None) -> int:
    """Say what is verified in space, or in what the certificate differs from the file and the options."""
    from wiggleroom.verify.space_claim import spatial_difference, spatial_sentence

    why = "" if asked is None else spatial_difference(claim, asked)
    if why:
        print(f"not verified: {why}")  # noqa: T201
        return REFUSED
    print(f"verified: {spatial_sentence(claim, asked.source if asked else '')}")  # noqa: T201
    if asked is None:
        print("about the solids in this file, not compared with an assembly file")  # noqa: T201
    elif asked.goals is None:
        print("stated by the certificate only: what is asked")  # noqa: T201
    print(  # noqa: T201
        f"checked: {_counted(found.pairs, 'convex piece')}, {_counted(found.chords, 'point')}, "
        f"{_counted(found.programs, 'linear program')}"
    )
    return PROVEN


def _compared(found: Verified, claim: Claim, drawn: Specification) -> int:
    """Say what is verified, or in what the certificate differs from the drawing and the options."""
    from wiggleroom.verify.claim import sentence
    from wiggleroom.verify.claim_comparison import difference, unstated

    why = difference(claim, drawn)
    if why:
        print(f"not verified: {why}")  # noqa: T201
        return REFUSED
    print(f"verified: {sentence(claim, drawn.source)}")  # noqa: T201
    if drawn.bodies is None:
        print("about the outlines in this file, not compared with a drawing")  # noqa: T201
    for line in unstated(claim, drawn):
        print(f"stated by the certificate only: {line}")  # noqa: T201
    print(  # noqa: T201
        f"checked: {found.bodies} bodies, {_counted(found.pairs, 'pair')} that hold each other, "
        f"{_counted(found.chords, 'chord')}, {_counted(found.programs, 'linear program')}"
    )
    return PROVEN


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


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


def assembled_by(file: str, asked: QuestionOptions) -> SpatialSpecification:
    """What a file of an assembly in space and options say.

    Raises
    ------
    InputError
        With everything that is wrong with the options and the file, one line each.
    """
    from wiggleroom.assembly.assembly import placed_surface
    from wiggleroom.cli.in_space import read_in_space
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.errors import InputError
    from wiggleroom.spatial.bodies.spatial_bodies import grouped
    from wiggleroom.verify.space_claim import SpatialSpecification

    if not is_spatial_file(file):
        wrong = f"{file}: the certificate is about an assembly in space; name its file"
        raise InputError(wrong)
    assembly = read_in_space(file, asked)
    group = grouped(assembly)
    names = [
        frozenset(name for name, b in zip(assembly.names, group.body_of.tolist(), strict=True) if b == k)
        for k in range(len(group.bodies.at))
    ]
    surfaces = {}
    for part, made in zip(assembly.parts, assembly.solids, strict=True):
        placed = placed_surface(part, made.surface)
        surfaces[part.name] = placed.vertices, placed.faces
    return SpatialSpecification(
        Path(file).name,
        assembly.gap,
        {body: tuple(map(bool, free)) for body, free in zip(names, group.bodies.free, strict=True)},
        surfaces,
        dict(zip(names, group.bodies.at, strict=True)),
        _spatial_goals(assembly) if assembly.goals else None,
        bool(assembly.drawing.ignore),
    )


def _spatial_goals(assembly: Assembly) -> tuple[SpatialGoal, ...]:
    """Pulls and turns in space; where no point is named it is the part's reference point."""
    import numpy as np

    from wiggleroom.drawing.model import Pull, Turn
    from wiggleroom.errors import InputError
    from wiggleroom.verify.space_claim import SpatialGoal

    found = []
    for goal in assembly.goals:
        match goal:
            case Pull(part, direction, point, weight):
                at = assembly.reference[assembly.names.index(part)] if point is None else np.array(point)
                found.append(SpatialGoal(part, False, np.array(direction), at, weight))
            case Turn(part, sense, weight):
                found.append(SpatialGoal(part, True, np.array(sense), None, weight))
            case _:
                raise InputError("certificates are about pulls and turns; name one with --pull or --turn")
    return tuple(found)
