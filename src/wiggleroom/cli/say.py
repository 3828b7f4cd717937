"""What goes to stdout and stderr."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import RenderableType


def note(line: str) -> None:
    """One line for people on stderr."""
    print(line, file=sys.stderr)  # noqa: T201


def show(page: RenderableType) -> None:
    """Page on stdout, in colour on a terminal only."""
    from rich.console import Console

    Console(file=sys.stdout, highlight=False, markup=False, emoji=False).print(page, crop=False)
