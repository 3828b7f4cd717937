"""One root error; its leaves carry part names and numbers, and every message says what, where and what would be right."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol


def where_raised(problem: BaseException) -> str:
    """File and line in which an error was raised, " (name.py:12)"; empty where that is not known."""
    place, trace = "", problem.__traceback__
    while trace is not None:
        place = f" ({Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno})"
        trace = trace.tb_next
    return place


def grouped(lines: Sequence[str], most: int = 3) -> tuple[str, ...]:
    """Findings with those of one cause, more than `most` of them, in one line: the first, and how many there are.

    Parameters
    ----------
    lines : sequence of str
        Each "where: what"; lines that differ only in numbers and in quoted names have one cause.
    most : int

    Examples
    --------
    >>> grouped([f'a.svg: part "{n}": crosses itself at ({n}, 0) mm' for n in range(5)], most=3)
    ('a.svg: part "0": crosses itself at (0, 0) mm (and 4 more like it: "1", "2", "3", ...)',)
    """
    causes: dict[str, list[str]] = {}
    for line in dict.fromkeys(lines):
        causes.setdefault(re.sub(r'"[^"]*"|#?[-+.\d]+(?:e[-+]?\d+)?', "#", line), []).append(line)
    found = []
    for alike in causes.values():
        if len(alike) <= most:
            found += alike
            continue
        names = [match.group() for line in alike[1:] if (match := re.search(r'"[^"]*"', line))]
        listed = ", ".join(list(dict.fromkeys(names))[:3])
        said = f": {listed}, ..." if listed else ""
        found.append(f"{alike[0]} (and {len(alike) - 1} more like it{said})")
    return tuple(found)


class WiggleroomError(Exception):
    """Base class of all errors of wiggleroom."""


class InputError(WiggleroomError):
    """The drawing, the assembly or the question cannot be used as given.

    Parameters
    ----------
    findings : str or sequence of str
        One plain line per finding: what, where (file, part, element), what would be right.
    """

    def __init__(self, findings: str | Sequence[str]) -> None:
        self.findings: tuple[str, ...] = (findings,) if isinstance(findings, str) else tuple(findings)
        super().__init__("\n".join(self.findings))


class TouchingError(InputError):
    """Two parts touch at rest after gap and offsets, so there is no room to move; carries names and the clearance [mm].

    The clearance is negative where they overlap.
    """

    def __init__(self, finding: str, parts: tuple[str, str], clearance: float) -> None:
        super().__init__(finding)
        self.parts = parts
        self.clearance = clearance


class OverlapError(InputError):
    """Parts overlap at rest after gap and offsets; nothing else is wrong with the drawing."""


class FreeSpaceError(InputError):
    """No free space was found round where two parts lie, although they do not touch."""


class UnsureError(WiggleroomError):
    """What the question rests on is not sure, so no answer is given.

    Parameters
    ----------
    findings : sequence of str
        One plain line for everything that is not sure.
    """

    def __init__(self, findings: Sequence[str]) -> None:
        self.findings = tuple(findings)
        super().__init__("\n".join(self.findings))


class Stop(Protocol):
    """Anything with `is_set`, asked now and then while long work runs; True to stop."""

    def is_set(self) -> bool:
        """True to stop."""


class StoppedError(WiggleroomError):
    """Work was stopped before there was a result."""


def is_asked(stop: Stop | None) -> bool:
    """True where the work was asked to stop."""
    return stop is not None and stop.is_set()


def go_on(stop: Stop | None) -> None:
    """Raise StoppedError where the work was asked to stop."""
    if is_asked(stop):
        raise StoppedError("asked to stop")


class MissingExtraError(WiggleroomError):
    """An optional library is needed; the message names the extra that installs it."""


def require_extra(extra: str, what: str, *libraries: str) -> None:
    """Check that the libraries of an extra are installed, without importing them.

    Parameters
    ----------
    extra : str
        Name of the extra in `pip install '.[extra]'`.
    what : str
        What needs it, such as "the solver ipopt needs CasADi".

    Raises
    ------
    MissingExtraError
        If one of them is not.
    """
    if any(find_spec(name) is None for name in libraries):
        message = f"{what}: in the folder of wiggleroom's sources, pip install '.[{extra}]'"
        raise MissingExtraError(message)
