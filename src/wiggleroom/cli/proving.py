"""What `flex --prove` does after the answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wiggleroom.deadline import Deadline
    from wiggleroom.search.answer import Answer


def check_proof(share: float, model: str) -> None:
    """Refuse, before the long work, what cannot be proven.

    Raises
    ------
    InputError
        If a number makes no sense or the model only approximates contacts.
    MissingExtraError
        If highspy is not installed.
    """
    from wiggleroom.bound.prove import check_request
    from wiggleroom.errors import InputError
    from wiggleroom.solve.dual_linear_program import need_highs

    check_request(share, names=("--prove", "--time"))
    if model != "walls":
        wrong = f"--prove: a bound is proven with --model walls only, not {model}"
        raise InputError(wrong)
    need_highs()


def with_proof(
    answer: Answer,
    share: float,
    certify: bool,
    stop: Deadline,
    show: Callable[[Any], None] | None,
) -> Answer:
    """Answer with a bound, or as it was, with a line on stderr that says why there is none."""
    from dataclasses import replace

    from wiggleroom.bound.prove import prove
    from wiggleroom.cli.say import note

    limit = None if stop.seconds is None else max(stop.left, 1e-9)
    done = prove(answer, share, seconds=limit, certify=certify, stop=stop, progress=show)
    if done.bound is None:
        return done
    if done.bound.why:
        note(f"{'no bound' if done.at_most is None else 'no nearer bound'}: {done.bound.why}")
    elif done.bound.within is not None and done.bound.within > share:
        note(f"bound: within {done.bound.within:.2%} of the answer; more --time may bring it nearer")
    return replace(done, seconds={**done.seconds, "prove": done.bound.seconds})


def write_certificate(answer: Answer, path: Path) -> None:
    """Write what was proven for `wiggleroom verify`; nothing is written where nothing was proven, which is said."""
    import json

    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole
    from wiggleroom.report.results.answer_words import rounded_up

    if answer.bound is None or answer.bound.certificate is None:
        note(f"no certificate: nothing was proven, {path} is not written")
        return
    paper = answer.bound.certificate
    write_whole(path, json.dumps(paper) + "\n")
    if answer.at_most is not None and paper["at_most"] > answer.at_most * (1 + 1e-9):
        note(
            f"{path}: proves at most {rounded_up(paper['at_most'])}; the nearer bound of the answer has no certificate"
        )
