"""Where many solves run: options of the commands that ask the same question again and again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from wiggleroom.cli.options import WORK

if TYPE_CHECKING:
    from wiggleroom.assembly.model import Assembly


@Parameter(name="*", group=WORK)
@dataclass(frozen=True, kw_only=True)
class Running:
    """Where the work is done; the numbers are the same everywhere.

    Parameters
    ----------
    workers
        Processes on this machine. By default one for each processor.
    cluster
        Dask scheduler that gets the work instead: tcp://host:port. Needs the extra wiggleroom[cluster].
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
def unless_stopped(stop: Event) -> Iterator[None]:
    """Take what is missing after Ctrl-C for an interruption, not for bad input."""
    from wiggleroom.errors import InputError

    try:
        yield
    except InputError:
        if stop.is_set():
            raise KeyboardInterrupt from None
        raise


def complete(assembly: Assembly) -> Assembly:
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
