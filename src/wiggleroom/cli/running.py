"""Where many solves run: options of the commands that ask the same question again and again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from wiggleroom.cli.options import WORK

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.deadline import Deadline


@Parameter(name="*", group=WORK)
@dataclass(frozen=True, kw_only=True)
class TimeLimit:
    """How long it may take.

    Parameters
    ----------
    time
        Seconds that the answer may take; then the best so far is given, as far as it was found or proven (exit 3 where
        that is no whole answer).
    """

    time: float | None = None


@Parameter(name="*", group=WORK)
@dataclass(frozen=True, kw_only=True)
class Running:
    """Where the work is done; the numbers are the same everywhere.

    Parameters
    ----------
    workers
        Processes on this machine. By default one for each processor.
    cluster
        Dask scheduler that gets the work instead: tcp://host:port. Needs the extra cluster.
    """

    workers: int | None = None
    cluster: str | None = None

    def options(self) -> dict[str, Any]:
        """Arguments of the functions that do the work.

        Raises
        ------
        InputError
            If a number makes no sense.
        """
        from wiggleroom.errors import InputError

        if self.workers is not None and self.workers < 1:
            wrong = f"--workers {self.workers}: it must be at least 1"
            raise InputError(wrong)
        return {"workers": self.workers, "cluster": self.cluster}


@contextmanager
def unless_stopped(stop: Deadline) -> Iterator[None]:
    """Take what is missing after Ctrl-C, or after the time is over, for an interruption, not for bad input.

    Raises
    ------
    StoppedError
        If the time was over before there was anything to say.
    """
    from wiggleroom.errors import InputError, StoppedError

    try:
        yield
    except (InputError, StoppedError, KeyboardInterrupt):
        if stop.over:
            message = f"stopped after {stop.seconds:g} s, before there was anything to say; give more --time"
            raise StoppedError(message) from None
        if stop.is_set():
            raise KeyboardInterrupt from None
        raise


def require_question(assembly: Assembly) -> Assembly:
    """The assembly, if a question about motion can be asked of it.

    Raises
    ------
    InputError
        If nothing is fixed or pulled.
    """
    from wiggleroom.assembly.findings import role_findings
    from wiggleroom.errors import InputError

    lacking = role_findings(assembly.drawing)
    if lacking:
        raise InputError(lacking)
    return assembly
