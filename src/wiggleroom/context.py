"""What a question may use while it is worked on: who stops it, who hears how far it is, and where it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from wiggleroom.deadline import GracePeriod
from wiggleroom.errors import Stop, go_on


@dataclass(frozen=True, kw_only=True)
class Context:
    """Stop, progress and workers, as one argument.

    Parameters
    ----------
    stop : optional
        Anything with `is_set()`.
    progress : callable, optional
        Called as a search goes on: with a `Progress`, in space with the number of iterations and the value.
    counted : callable, optional
        Called with how many of how many are done.
    workers : int, optional
        Processes on this machine; by default one for each processor.
    cluster : str, optional
        Address of a Dask scheduler, tcp://host:port, that gets the work instead (extra `cluster`).
    """

    stop: Stop | None = None
    progress: Callable[..., None] | None = None
    counted: Callable[[int, int], None] | None = None
    workers: int | None = None
    cluster: str | None = None

    @property
    def stopped(self) -> bool:
        """True where the work is to end."""
        return self.stop is not None and self.stop.is_set()

    @property
    def left(self) -> float | None:
        """Time that is left [s]; None where there is no limit."""
        seconds = getattr(self.stop, "seconds", None)
        return None if seconds is None else max(getattr(self.stop, "left", 0.0), 1e-9)

    @property
    def silent(self) -> Context:
        """The same, heard by nobody."""
        return replace(self, progress=None, counted=None)

    def with_stop(self, stop: Stop) -> Context:
        """The same, ended by another request: a limit on time or work, which asks the one before too."""
        return replace(self, stop=stop)

    @property
    def with_grace(self) -> Context:
        """The same, with a little time after a request to stop: enough to check the best motion so far."""
        return self if self.stop is None else self.with_stop(GracePeriod(self.stop))

    def go_on(self) -> None:
        """Raise StoppedError where the work is to end."""
        go_on(self.stop)

    def tell(self, *told: Any) -> None:
        """Tell how far it is, where somebody listens."""
        if self.progress is not None:
            self.progress(*told)


UNLIMITED = Context()
"""Nobody stops the work, and nobody hears of it."""
