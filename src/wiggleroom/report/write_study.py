"""Checks, plans and free spaces into files; a module of its own, because it imports all that works them out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.planning.plan import Plan
from wiggleroom.report.films.separability_film import film_of_check
from wiggleroom.report.free_space.space_report import space_picture
from wiggleroom.report.page import pages
from wiggleroom.report.page.plan_pictures import film_of_plan, page_of_plan, picture_of_plan
from wiggleroom.report.pictures.file_endings import ANSWERS, FILMS, PAGE, STUDIES, check_ending, ending
from wiggleroom.report.pictures.leaving_picture import picture_of_check
from wiggleroom.report.pictures.stills import write_still
from wiggleroom.report.results.separability import Checked
from wiggleroom.report.write_spatial import SpatialFound, spatial_page, write_spatial

Study = Checked | Plan
StudyResult = Interlock | LargestGap | FreeSpace | Study
"""As the questions return them; a check and a largest gap are drawn as `Checked`."""


def draw_study(
    found: StudyResult, path: Path, command: str, progress: Callable[[int, int], None] | None = None
) -> None:
    """Write what was found, as `wiggleroom.report.write_picture.write_picture` does."""
    shown = in_space(found)
    if shown is not None:
        write_spatial(shown, path, command, progress)
        return
    found = as_checked(found)
    check_ending(path, ANSWERS if isinstance(found, Checked | Plan) else STUDIES)
    kind = ending(path)
    if kind in FILMS and isinstance(found, Checked):
        film_of_check(found, path, command=command, progress=progress)
    elif kind in FILMS and isinstance(found, Plan):
        film_of_plan(found, path, command=command, progress=progress)
    elif kind == PAGE:
        write_whole(path, page_of_study(found, command))
    else:
        write_still(_picture(found, command), path)


def in_space(found: StudyResult) -> SpatialFound | None:
    """What is shown as parts in space; None for curves, and for drawings."""
    if assembly_of(found).dimension == 2:
        return None
    match found:
        case Interlock() | Plan():
            return found
        case Checked():
            return found.found
        case LargestGap():
            return found.apart or found.interlocked
    return None


def as_checked(found: StudyResult) -> Study | FreeSpace:
    """What is drawn of a result: of a largest gap the state on one of its sides.

    Raises
    ------
    InputError
        If no state was found on either side.
    """
    match found:
        case Interlock():
            return Checked(found)
        case LargestGap():
            return Checked(_side(found), found)
        case _:
            return found


def _side(found: LargestGap) -> Any:
    """The state on that side of a largest gap that says more: how it comes apart, where that is known."""
    side = found.apart or found.interlocked
    if side is None:
        raise InputError(
            "largest gap: no gap was found that holds it together, or at which it comes apart: nothing to show"
        )
    return side


def _picture(found: Study | FreeSpace, command: str) -> str:
    match found:
        case Checked():
            return picture_of_check(found, command=command)
        case Plan():
            return picture_of_plan(found, command=command)
        case FreeSpace():
            return space_picture(found, command=command)


def page_of_study(found: StudyResult, command: str = "") -> str:
    """Study or check as one HTML page."""
    shown = in_space(found)
    if shown is not None:
        return spatial_page(shown, command)
    found = as_checked(found)
    match found:
        case Checked():
            return pages.page_of_check(found, command=command)
        case Plan():
            return page_of_plan(found, command=command)
        case FreeSpace():
            return pages.page_of_space(found, command=command)


def assembly_of(found: SpatialFound | StudyResult) -> Any:
    """The assembly that was asked about."""
    match found:
        case Checked():
            return found.found.assembly
        case LargestGap():
            return _side(found).assembly
    return found.assembly
