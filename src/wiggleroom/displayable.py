"""What shows itself in a notebook, assemblies and all that is found about them, and what of it can be drawn into a file."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any, ClassVar


class Displayable:
    """Something that Jupyter shows as a page that can be used, and other places as a few lines of text."""

    mime_bundle: ClassVar[Callable[[Any], dict[str, str]]]
    """Makes what is shown, by media type. The package's root sets it: reports stand to the right of everything shown."""

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:  # noqa: ARG002
        """What IPython asks for; it chooses among the media types itself."""
        return type(self).mime_bundle(self)


class Drawable(Displayable):
    """Something that can be drawn into a file too."""

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
