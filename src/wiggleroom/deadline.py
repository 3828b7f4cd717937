"""Limits on long work, in the form of a request to stop: on its time where somebody asks for that, else on work that is counted."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TypeVar

from wiggleroom.errors import InputError, Stop


@dataclass(frozen=True, eq=False)
class Deadline:
    """Stops what is asked to stop, and everything once its time is over.

    Parameters
    ----------
    seconds : float or None [s]
        From now on; None without a limit.
    stop : optional
        Anything with `is_set()`, which still stops it earlier.

    Raises
    ------
    InputError
        If the time is not a number of seconds above 0.

    Examples
    --------
    >>> Deadline(1e-9).is_set(), Deadline(60.0).is_set(), Deadline(None).is_set()
    (True, False, False)
    """

    seconds: float | None
    stop: Stop | None = None
    begin: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        if self.seconds is not None and not 0 < self.seconds < math.inf:
            wrong = f"time {self.seconds:g}: it must be a number of seconds, more than 0"
            raise InputError(wrong)

    @property
    def spent(self) -> float:
        """Time since it began [s]."""
        return time.monotonic() - self.begin

    @property
    def left(self) -> float:
        """Time left [s]; infinite without a limit."""
        return math.inf if self.seconds is None else self.seconds - self.spent

    @property
    def over(self) -> bool:
        """True once the time is over."""
        return self.left <= 0

    def is_set(self) -> bool:
        """True where it was asked to stop, or the time is over."""
        return self.over or (self.stop is not None and self.stop.is_set())


Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(eq=False)
class WorkBudget:
    """Ends work once so much of it was counted, at the same place on every machine; a request to stop ends it earlier.

    Parameters
    ----------
    work : float
        About milliseconds of one machine; infinite without a limit.
    stop : optional
        Anything with `is_set()`.
    whole : WorkBudget, optional
        What this is a part of: what is spent here is spent there too.

    Examples
    --------
    >>> budget = WorkBudget(10.0)
    >>> budget.spend(4.0), budget.part(0.5).spend(3.0), budget.left, budget.spend(3.0)
    (False, True, 3.0, True)
    """

    work: float = math.inf
    stop: Stop | None = None
    whole: WorkBudget | None = None
    spent: float = field(default=0.0, init=False)

    @property
    def left(self) -> float:
        """Work that may still be done."""
        return max(self.work - self.spent, 0.0)

    def spend(self, work: float) -> bool:
        """Count some work; True where it was the last."""
        self.spent += work
        if self.whole is not None:
            self.whole.spend(work)
        return self.is_set()

    def is_set(self) -> bool:
        """True where the work is spent, or it was asked to stop."""
        return (
            self.spent >= self.work
            or (self.whole is not None and self.whole.is_set())
            or (self.stop is not None and self.stop.is_set())
        )

    def part(self, share: float) -> WorkBudget:
        """A budget of a share of what is left."""
        return WorkBudget(share * self.left, whole=self)

    def in_order(
        self, function: Callable[[Item, WorkBudget], Result], items: Sequence[Item], workers: int
    ) -> Iterator[Result]:
        """Results of a function of some items and a budget, worked out side by side; which there are does not depend on the threads.

        Each may spend all that is left now. Items are left out once those before them have spent it.
        """
        own = [WorkBudget(self.left, self._asked) for _ in items]
        with ThreadPoolExecutor(workers) as pool:
            done = [pool.submit(function, item, budget) for item, budget in zip(items, own, strict=True)]
            try:
                for future, budget in zip(done, own, strict=True):
                    if self.is_set():
                        return
                    result = future.result()
                    self.spend(budget.spent)
                    yield result
            finally:
                for future, budget in zip(done, own, strict=True):
                    future.cancel()
                    budget.work = 0.0

    @property
    def _asked(self) -> Stop | None:
        """The request to stop, of this or of what it is a part of."""
        return self.stop if self.whole is None else self.whole._asked


GRACE_SECONDS = 1.0
"""Processor time of all threads [s] that may pass after a request to stop, so that the best motion so far is checked and returned."""


@dataclass(eq=False)
class GracePeriod:
    """A request to stop, and a little time after it: long enough to check and return the best motion so far.

    Parameters
    ----------
    stop : Stop
    seconds : float [s]
        Of processor time, from when the request is first seen.

    Examples
    --------
    >>> asked = GracePeriod(Deadline(1e-9), seconds=60.0)
    >>> asked.is_set(), asked.end.is_set()
    (True, False)
    """

    stop: Stop
    seconds: float = GRACE_SECONDS
    _seen: float | None = field(default=None, init=False)

    def is_set(self) -> bool:
        """True where it was asked to stop."""
        if self._seen is None and self.stop.is_set():
            self._seen = time.process_time()
        return self._seen is not None

    @property
    def end(self) -> Stop:
        """The later request to stop at the end of the period."""
        return _EndOfGrace(self)


@dataclass(frozen=True, eq=False)
class _EndOfGrace:
    period: GracePeriod

    def is_set(self) -> bool:
        """True where the period is over."""
        period = self.period
        return period.is_set() and time.process_time() - (period._seen or 0.0) > period.seconds
