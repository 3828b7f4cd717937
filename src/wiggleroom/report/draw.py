"""Answers into files: pictures, films and reports, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from wiggleroom.analysis.answer import Answer
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole

STILLS = (".svg", ".png")
PICTURES = (*STILLS, ".gif", ".mp4", ".html")
PLAYS = ".film.svg"
"""An SVG of this name plays; any other is a still picture."""


def draw(answer: Answer, path: str | PathLike[str], *, progress: Callable[[int, int], None] | None = None) -> None:
    """Write an answer as a picture (.svg, .png), a film (.gif, .mp4, .film.svg) or a report (.html).

    Parameters
    ----------
    progress : callable, optional
        Told how many of how many frames of a film are drawn.

    Raises
    ------
    InputError
        If the name has another ending.
    MissingExtraError
        If a film needs a library that is not installed.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind in (".gif", ".mp4") or path.name.lower().endswith(PLAYS):
        from wiggleroom.report.film import film_of_answer

        film_of_answer(answer, path, progress=progress)
    elif kind == ".html":
        from wiggleroom.report.html import report

        write_whole(path, report(answer))
    elif kind in STILLS:
        from wiggleroom.report.picture import picture

        write_svg(picture(answer), path)
    else:
        finding = f"picture {path}: the name must end in {', '.join(PICTURES[:-1])} or {PICTURES[-1]}"
        raise InputError(finding)


def write_svg(svg: str, path: Path) -> None:
    """Write a still picture as SVG or, where the name says so, as PNG; whole or not at all.

    Raises
    ------
    InputError
        If the name does not end in .svg or .png.
    """
    if path.suffix.lower() == ".png":
        from wiggleroom.report.png import png

        write_whole(path, png(svg))
    elif path.suffix.lower() == ".svg":
        write_whole(path, svg)
    else:
        finding = f"picture {path}: the name must end in .svg or .png"
        raise InputError(finding)
