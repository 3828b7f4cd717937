"""A bound beside the answer of a study, for a counted amount of work."""

from __future__ import annotations

from collections.abc import Callable

from wiggleroom.bound.prove import prove
from wiggleroom.errors import InputError, MissingExtraError, Stop
from wiggleroom.search.answer import Answer
from wiggleroom.search.progress import Progress

WORK = 20_000.0
"""Work of a proof, about milliseconds."""


def counted_bound(
    answer: Answer,
    within: float,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    work: float = WORK,
) -> Answer:
    """The answer of `prove`; the answer itself where nothing can be proven of it.

    Parameters
    ----------
    answer : Answer
    within : float
        Share of the objective that the bound may lie above it.
    stop, progress, work : optional
        As for `prove`.
    """
    try:
        return prove(answer, within, work=work, stop=stop, progress=progress)
    except (InputError, MissingExtraError):  # sums of squares have no bound, or the extra is not there
        return answer
