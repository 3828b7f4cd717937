"""Answers in space into files: pictures, models for viewers and pages, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.files import write_whole
from wiggleroom.report.page.solid_page import page_of_separation, page_of_spatial_answer
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.file_endings import FILMS, PAGE, SPATIAL_ANSWERS, SPATIAL_STUDIES, check_ending, ending
from wiggleroom.report.pictures.importance_picture import ranking_facts, shade, tightening_facts
from wiggleroom.report.results.answer_words import headline
from wiggleroom.report.solids.solid_colours import Colour
from wiggleroom.report.solids.spatial_picture import draw_separation, draw_spatial, write_moved_parts
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.tighten import Tightening

SpatialFound = Answer[Any] | Interlock[Any] | Ranking | Tightening
"""What is shown as parts in space; rankings and tightenings of assemblies in space."""


def write_spatial(
    found: SpatialFound, path: Path, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a picture (.svg, .png), a model of the moved parts (.glb), a page (.html), or a film of the path (.gif, .mp4, .film.svg).

    Raises
    ------
    InputError
        If the name has another ending.
    """
    moves = isinstance(found, Answer | Interlock)
    check_ending(path, SPATIAL_ANSWERS if moves else SPATIAL_STUDIES)
    if isinstance(found, Answer | Interlock) and ending(path) in FILMS:
        from wiggleroom.report.solids.spatial_film import film_of_spatial

        film_of_spatial(found, path, progress=progress)
        return
    if ending(path) == PAGE:
        write_whole(path, spatial_page(found, command))
        return
    match found:
        case Answer():
            draw_spatial(found, path)
        case Interlock():
            draw_separation(found, path)
        case _:
            answer, facts, fill = _coloured(found)
            lines = [headline(answer), ", ".join(facts)]
            write_moved_parts(answer.assembly, answer.motion, path, lines, answer.contacts, fill)


def spatial_page(found: SpatialFound, command: str = "") -> str:
    """The same as one HTML page."""
    match found:
        case Answer():
            return page_of_spatial_answer(found, command or found.command)
        case Interlock():
            return page_of_separation(found, command)
    answer, facts, fill = _coloured(found)
    return page_of_spatial_answer(answer, command, fill, facts)


def _coloured(found: Ranking | Tightening) -> tuple[Answer[Any], list[str], list[Colour]]:
    """Answer, facts, and colours of the parts: by what their gap is worth, or by whether they were made tighter."""
    if isinstance(found, Ranking):
        value = found.importance.clip(min=0)
        most = float(value.max(initial=0.0)) or 1.0
        return found.answer, ranking_facts(found), [_rgb(shade(float(v) / most)) for v in value]
    chosen, other = _rgb(palette.CHOSEN), _rgb(palette.NEUTRAL[0])
    fill = [chosen if name in found.chosen else other for name in found.after.assembly.names]
    return found.after, tightening_facts(found), fill


def _rgb(colour: str) -> Colour:
    """Red, green and blue of "#rrggbb".

    >>> _rgb("#0a10ff")
    (10, 16, 255)
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
