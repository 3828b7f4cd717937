"""A limit on the time of long work, in the form of a request to stop."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

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
