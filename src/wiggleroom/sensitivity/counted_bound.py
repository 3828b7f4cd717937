"""A bound beside the answer of a study, for a counted amount of work."""

from __future__ import annotations

from wiggleroom.bound.prove import prove
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import InputError, MissingExtraError
from wiggleroom.search.answer import Answer

WORK = 20_000.0
"""Work of a proof, about milliseconds."""


def counted_bound(answer: Answer, within: float, work: float = WORK, context: Context = UNLIMITED) -> Answer:
    """The answer of `prove`; the answer itself where nothing can be proven of it.

    Parameters
    ----------
    answer : Answer
    within : float
        Share of the objective that the bound may lie above it.
    work : optional
        As for `prove`.
    context : Context, optional
    """
    try:
        return prove(answer, within, work=work, context=context)
    except (InputError, MissingExtraError):  # sums of squares have no bound, or the extra is not there
        return answer
