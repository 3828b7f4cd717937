"""What answers and studies have in common: they can be drawn into a file, and show themselves in notebooks."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any, ClassVar

from wiggleroom.displayable import Displayable


class Drawable(Displayable):
    """Something that can be drawn."""

    writer: ClassVar[Callable[[Any, str | PathLike[str]], None]]
    """Draws `self` into a file. The package's root sets it: reports stand to the right of searches."""

    def draw(self, path: str | PathLike[str]) -> None:
        """Draw it into a file; written whole or not at all.

        Endings: .svg or .png a picture; .html a report with everything; of an answer also .gif, .mp4 (extra `film`) or
        .film.svg, a film.

        Raises
        ------
        InputError
            If the name has another ending.
        """
        type(self).writer(self, path)
