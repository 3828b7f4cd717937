"""Answers and studies into files: pictures, films and reports, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.files import write_whole
from wiggleroom.report.pictures.file_endings import ANSWERS, FILMS, PAGE, check_ending, ending
from wiggleroom.report.pictures.stills import write_still
from wiggleroom.search.answer import Answer

if TYPE_CHECKING:
    from wiggleroom.report.write_study import StudyResult


def write_picture(
    found: Answer | StudyResult,
    path: str | PathLike[str],
    *,
    command: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write a picture (.svg, .png) or a report (.html) of an answer or a study; of an answer, and of escape paths, a film too.

    Of answers in space there are models too (.glb).

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
    if not isinstance(found, Answer):
        from wiggleroom.report.write_study import draw_study

        draw_study(found, path, command, progress)
        return
    if found.assembly.dimension == 3:
        from wiggleroom.report.write_spatial import write_spatial

        write_spatial(found, path, command, progress)
        return
    check_ending(path, ANSWERS)
    kind = ending(path)
    if kind in FILMS:
        from wiggleroom.report.films.film import film_of_answer

        film_of_answer(found, path, progress=progress)
    elif kind == PAGE:
        from wiggleroom.report.page.pages import page_of_answer

        write_whole(path, page_of_answer(found))
    else:
        from wiggleroom.report.pictures.picture import picture

        write_still(picture(found), path)
