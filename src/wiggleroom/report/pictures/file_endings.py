"""What the ending of a file's name says about a picture, and which endings show what."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from wiggleroom.errors import InputError

FILM_SVG = ".film.svg"
"""An SVG of this name plays; any other is a still picture."""
STILLS = (".svg", ".png")
FILMS = (".gif", ".mp4", FILM_SVG)
PAGE = ".html"
ANSWERS = (*STILLS, *FILMS, PAGE)
STUDIES = (*STILLS, PAGE)
"""Endings of pictures of an answer, and of everything that has no path to make a film of."""
SPATIAL_ANSWERS = (*STILLS, *FILMS, ".glb", PAGE)
SPATIAL_STUDIES = (*STILLS, ".glb", PAGE)
"""The same in space."""


def ending(path: PurePath) -> str:
    """Ending of a name in small letters.

    >>> ending(PurePath("a.b/Moved.film.SVG")), ending(PurePath("film.svg")), ending(PurePath("moved"))
    ('.film.svg', '.svg', '')
    """
    return FILM_SVG if path.name.lower().endswith(FILM_SVG) else path.suffix.lower()


def wrong_ending(path: PurePath, endings: Sequence[str]) -> str:
    """Say what is wrong with the ending of a name, or nothing.

    >>> wrong_ending(PurePath("a.gif"), STUDIES)
    'the name must end in .svg, .png or .html; films come from flex, check and plan'
    """
    found = ending(path)
    if not endings or found in endings:
        return ""
    listed = " or ".join(p for p in (", ".join(endings[:-1]), endings[-1]) if p)
    return f"the name must end in {listed}" + ("; films come from flex, check and plan" if found in FILMS else "")


def check_ending(path: PurePath, endings: Sequence[str]) -> None:
    """Check that the ending of a picture's name is one of `endings`.

    Raises
    ------
    InputError
        If it is not.
    """
    problem = wrong_ending(path, endings)
    if problem:
        finding = f"picture {path}: {problem}"
        raise InputError(finding)
