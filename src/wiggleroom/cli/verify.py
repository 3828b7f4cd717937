"""`wiggleroom verify`."""

from __future__ import annotations

from pathlib import Path

PROVEN, REFUSED = 0, 1


def verify(certificate: Path, file: str | None = None, /, *, gap: float | None = None) -> int:
    """Check a certificate of flex --prove --certificate, by code that shares nothing with what wrote it.

    Every region, every range of turns and every bound is worked out again in ball arithmetic. Exit code: 0 verified,
    1 not verified, 2 bad input. Needs the extra wiggleroom[verify].

    Example: wiggleroom verify proof.json puzzle.svg

    Parameters
    ----------
    certificate
        The file that flex --prove 0.01 --certificate wrote.
    file
        Assembly file or drawing: also compare its outlines with those of the certificate.
    gap
        Gap to read that file with; by default an assembly file's own, and for drawings the one that the certificate names.
    """
    from wiggleroom.errors import InputError, see_extra

    see_extra("verify", "verify needs python-flint", "flint")
    from wiggleroom.verify.check import Refused
    from wiggleroom.verify.check import read as content_of
    from wiggleroom.verify.check import verify as check

    try:
        content = content_of(certificate.read_text(encoding="utf-8"))
    except Refused as refusal:
        print(f"not verified: {refusal}")  # noqa: T201
        return REFUSED
    except (ValueError, RecursionError) as problem:
        wrong = f"{certificate}: this is not JSON ({problem}); give the file that flex --certificate wrote"
        raise InputError(wrong) from problem
    if not isinstance(content, dict) or not str(content.get("format", "")).startswith("wiggleroom.certificate/"):
        wrong = f'{certificate}: this is not a certificate: "format" must be "wiggleroom.certificate/1"'
        raise InputError(wrong)
    found = check(content)
    why = found.why or (_differs(content, file, gap) if file else "")
    if why:
        print(f"not verified: {why}")  # noqa: T201
        return REFUSED
    unit = "" if content.get("turns") else " mm"
    print(f"verified: no motion of {_asked(content)} that starts at rest is worth more than {found.at_most:.6g}{unit}")  # noqa: T201
    print(  # noqa: T201
        f"{found.bodies} bodies, {found.pairs} pairs that hold each other, {found.chords} chords, {found.programs} linear programs"
    )
    if file is None:
        print("the outlines are those in the certificate; name the drawing too to compare them")  # noqa: T201
    return PROVEN


def _asked(content: dict) -> str:
    """Parts that are asked about."""
    return ", ".join(dict.fromkeys("+".join(content["bodies"][row[0]]["parts"]) for row in content["goal"]))


def _differs(content: dict, file: str, gap: float | None) -> str:
    """What a drawing has different from a certificate; empty where nothing is."""
    import numpy as np

    from wiggleroom.assembly.build import read
    from wiggleroom.assembly.model import rings_at

    if gap is None and Path(file).suffix.lower() != ".json":
        gap = content["gap"]
    assembly = read(file, gap=gap)
    parts = {part.name: part for part in assembly.parts}
    barred = {frozenset(pair) for pair in assembly.drawing.ignore}
    said = sorted(name for body in content["bodies"] for name in body["parts"])
    if said != sorted(parts):
        return f"{file} has other parts than the certificate"
    for body in content["bodies"]:
        mine = np.array([p for rings in body["polygons"] for ring in rings for p in ring])
        own = [ring for n in body["parts"] for ring in rings_at(parts[n])]
        far = (
            max(_away(mine, np.vstack(own)), _away(np.vstack(own), mine))
            if len(body["parts"]) == 1
            else _away(mine, np.vstack(own))
        )
        if far > 1e-8 * assembly.size:
            return f"{'+'.join(body['parts'])} has other outlines in {file}: a corner lies {far:.3g} mm away"
    for a, b, *_ in content["pairs"]:
        for one in content["bodies"][a]["parts"]:
            for two in content["bodies"][b]["parts"]:
                if frozenset((one, two)) in barred:
                    return f"{file} says that {one} and {two} never collide, and the proof uses that they do"
    return ""


def _away(points: object, others: object) -> float:
    """Largest distance from one of some corners to the nearest of others [mm]."""
    from scipy.spatial import cKDTree

    return float(cKDTree(others).query(points)[0].max())
