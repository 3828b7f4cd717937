"""`wiggleroom verify`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions

if TYPE_CHECKING:
    from wiggleroom.verify.checker import Verified
    from wiggleroom.verify.claim import Claim
    from wiggleroom.verify.claim_comparison import Specification

PROVEN, REFUSED = 0, 1
"""Exit codes."""
_NONE_ASKED = QuestionOptions()


def verify(certificate: Path, file: str | None = None, /, *, asked: QuestionOptions = _NONE_ASKED) -> int:
    """Check a certificate of flex --prove --certificate, by code that shares nothing with what wrote it.

    Every region, every range of turns and every bound is worked out again in ball arithmetic. Give the drawing too, and
    the options that flex had: outlines, glue, fixed parts, gap and pulls must be those of the certificate. What neither
    the drawing nor an option states is printed as stated by the certificate only. Exit code: 0 verified, 1 not
    verified, 2 bad input. Needs the extra verify.

    Example: wiggleroom verify proof.json puzzle.svg --gap 0.2 --fix p1 --pull p20:+x

    Parameters
    ----------
    certificate
        The file that flex --prove 0.01 --certificate wrote.
    file
        The assembly file or drawing that it is about. Without it, what is verified is about the outlines in the
        certificate.
    """
    from wiggleroom.errors import InputError, require_extra

    require_extra("verify", "verify needs python-flint", "flint")
    from wiggleroom.cli.verify_drawing import drawn_by
    from wiggleroom.verify.certificate_structure import FORMAT
    from wiggleroom.verify.checker import Refused
    from wiggleroom.verify.checker import read_certificate as content_of
    from wiggleroom.verify.checker import verify as check

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
    return _compared(found, claim, drawn_by(file, asked, claim))


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
