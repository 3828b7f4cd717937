"""What answers and studies have in common: they can be shown in a file."""

from __future__ import annotations

from importlib import import_module
from os import PathLike
from typing import Any, Protocol, cast

DRAWER = "wiggleroom.report.draw"
"""The module whose `draw` makes pictures; named here, because reports stand to the right of analyses."""


class Drawer(Protocol):
    """What makes pictures."""

    def draw(self, found: Any, path: str | PathLike[str]) -> None:
        """Show `found` in a file of the kind that the ending of `path` says."""


class Shown:
    """Something that can be shown."""

    def draw(self, path: str | PathLike[str]) -> None:
        """Show it in a file; written whole or not at all.

        Endings: .svg or .png a picture; .html a report with everything; of an answer also .gif, .mp4 (extra `film`) or
        .film.svg, a film.

        Raises
        ------
        InputError
            If the name has another ending.
        """
        drawer = cast(Drawer, import_module(DRAWER))
        drawer.draw(self, path)
