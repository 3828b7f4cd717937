"""A bound beside an answer that takes counted work, so that nothing depends on the clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from wiggleroom.bound.prove import prove
from wiggleroom.errors import InputError, MissingExtraError, Stop
from wiggleroom.search.answer import Answer
from wiggleroom.search.progress import Progress

PROOF_STEPS = 100
"""Most steps of a proof: linear programs, and tightenings of all turns."""
ENDLESS = 1e9
"""Stands for no limit of time [s]."""


@dataclass(eq=False)
class StepLimit:
    """A request to stop after so many steps, or earlier where `stop` is set; it counts as it is told of progress."""

    steps: int
    stop: Stop | None
    progress: Callable[[Progress], None] | None
    done: int = field(default=0, init=False)

    def is_set(self) -> bool:
        """True where all steps are done, or it was asked to stop."""
        return self.done >= self.steps or (self.stop is not None and self.stop.is_set())

    def tell(self, progress: Progress) -> None:
        """Count a step."""
        self.done += 1
        if self.progress is not None:
            self.progress(progress)


def counted_bound(
    answer: Answer,
    within: float,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    steps: int = PROOF_STEPS,
) -> Answer:
    """The answer of `prove` after a counted number of steps at most; the same where nothing can be proven of it.

    Parameters
    ----------
    answer : Answer
    within : float
        Share of the objective that the bound may lie above it.
    stop, progress : optional
        As for `prove`.
    steps : int
        Linear programs and tightenings, at most.
    """
    limit = StepLimit(steps, stop, progress)
    try:
        return prove(answer, within, seconds=ENDLESS, stop=limit, progress=limit.tell)
    except (InputError, MissingExtraError):  # sums of squares have no bound, or the extra is not there
        return answer
