"""Answers and studies into files: pictures, films and reports, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.interlock import Interlock
from wiggleroom.analysis.rank import Ranking
from wiggleroom.analysis.sample import Sample
from wiggleroom.analysis.sweep import Sweep
from wiggleroom.analysis.tighten import Tightening
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.report.apart_page import Checked, film_of_check, page_of_check, picture_of_check
from wiggleroom.report.endings import ANSWERS, FILMS, PAGE, STILLS, STUDIES, ending, unlike

Study = Ranking | Tightening | Sweep | Sample | Checked


def draw(
    found: Answer | Interlock | Study,
    path: str | PathLike[str],
    *,
    command: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write a picture (.svg, .png) or a report (.html) of an answer or a study; of an answer, and of ways out, a film too.

    Parameters
    ----------
    command : str
        What made a study; an answer knows it.
    progress : callable, optional
        Told how many of how many frames of a film (.gif, .mp4, .film.svg) are drawn.

    Raises
    ------
    InputError
        If the name has another ending, or there is nothing to show.
    MissingExtraError
        If a film needs a library that is not installed.
    """
    path = Path(path)
    if isinstance(found, Interlock):
        found = Checked(found)
    see(path, ANSWERS if isinstance(found, Answer | Checked) else STUDIES)
    kind = ending(path)
    if kind in FILMS and isinstance(found, Answer):
        from wiggleroom.report.film import film_of_answer

        film_of_answer(found, path, progress=progress)
    elif kind in FILMS and isinstance(found, Checked):
        film_of_check(found, path, command=command, progress=progress)
    elif kind == PAGE:
        write_whole(path, _page(found, command))
    else:
        write_svg(_picture(found, command), path)


def _picture(found: Answer | Study, command: str) -> str:
    from wiggleroom.report import blame, picture, study_plots

    match found:
        case Answer():
            return picture.picture(found)
        case Checked():
            return picture_of_check(found, command=command)
        case Ranking():
            return blame.picture_of_ranking(found, command=command)
        case Tightening():
            return blame.picture_of_tightening(found, command=command)
        case Sweep():
            return study_plots.picture_of_sweep(found, command=command)
        case Sample():
            return study_plots.picture_of_sample(found, command=command)


def _page(found: Answer | Study, command: str) -> str:
    from wiggleroom.report import html, study_pages

    match found:
        case Answer():
            return html.report(found)
        case Checked():
            return page_of_check(found, command=command)
        case Ranking():
            return study_pages.page_of_ranking(found, command=command)
        case Tightening():
            return study_pages.page_of_tightening(found, command=command)
        case Sweep():
            return study_pages.page_of_sweep(found, command=command)
        case Sample():
            return study_pages.page_of_sample(found, command=command)


def see(path: Path, endings: tuple[str, ...]) -> None:
    """See that the ending of a picture's name is one of `endings`.

    Raises
    ------
    InputError
        If it is not.
    """
    problem = unlike(path, endings)
    if problem:
        finding = f"picture {path}: {problem}"
        raise InputError(finding)


def write_svg(svg: str, path: Path) -> None:
    """Write a still picture as SVG or, where the name says so, as PNG; whole or not at all.

    Raises
    ------
    InputError
        If the name does not end in .svg or .png.
    """
    see(path, STILLS)
    if ending(path) == ".png":
        from wiggleroom.report.png import png

        write_whole(path, png(svg))
    else:
        write_whole(path, svg)
