"""Results into files: pictures, models for viewers, films and pages, by the ending of the name.

Each kind of result and of file imports what it needs: pages and plans need much.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, cast

from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.report.films.film import film
from wiggleroom.report.finding import Finding
from wiggleroom.report.pictures.file_endings import (
    ANSWERS,
    FILMS,
    PAGE,
    SPATIAL_ANSWERS,
    SPATIAL_STUDIES,
    STUDIES,
    check_ending,
    ending,
)
from wiggleroom.report.pictures.stills import write_still
from wiggleroom.report.results.separability import Checked, as_answer, check_facts, check_title
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from wiggleroom.disassembly.interlock_result import Interlock
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.freespace.free_space import FreeSpace
    from wiggleroom.planning.plan import Plan
    from wiggleroom.report.results.separability import Checked

    Drawn = Answer | Checked | Plan
    Result = Drawn | Interlock | LargestGap | FreeSpace


Progress = Callable[[int, int], None]


def write_picture(
    found: Finding | Result, path: str | PathLike[str], *, command: str = "", progress: Progress | None = None
) -> None:
    """Write a picture (.svg, .png) or a page (.html); of what has a path a film too (.gif, .mp4, .film.svg), in space a model (.glb).

    A finding that shows a motion alone is drawn as that motion.

    Parameters
    ----------
    command : str
        What made a study; an answer knows it.
    progress : callable, optional
        Told how many of how many frames of a film are drawn.

    Raises
    ------
    InputError
        If the name has another ending, or there is nothing to show.
    MissingExtraError
        If a film needs a library that is not installed.
    """
    path = Path(path)
    if isinstance(found, Finding):
        if found.motion is None or found.figure is not None or found.tints is not None:
            _write_finding(found, path, command)
            return
        found = cast("Result", found.motion)
    if ending(path) == PAGE:
        write_whole(path, page_of(found, command))
        return
    shown = _drawn(found)
    if shown is None:
        from wiggleroom.report.free_space.space_report import space_picture

        check_ending(path, STUDIES)
        write_still(space_picture(cast("FreeSpace", found), command=command), path)
        return
    solid = shown.assembly.dimension == 3
    check_ending(path, SPATIAL_ANSWERS if solid else ANSWERS)
    if ending(path) in FILMS:
        _film(shown, path, command, progress)
    elif solid:
        _draw_solid(shown, path)
    else:
        write_still(_picture(shown, command), path)


def page_of(found: Result, command: str = "") -> str:
    """A result as one HTML page."""
    shown = _drawn(found)
    if shown is not None and shown.assembly.dimension == 3:
        return _page_in_space(shown, command)
    from wiggleroom.report.page import pages

    if isinstance(shown, Answer):
        return pages.page_of_answer(shown)
    if shown is None:
        return pages.page_of_space(cast("FreeSpace", found), command=command)
    from wiggleroom.report.page.plan_pictures import page_of_plan
    from wiggleroom.report.results.separability import Checked

    return (
        pages.page_of_check(shown, command=command)
        if isinstance(shown, Checked)
        else page_of_plan(shown, command=command)
    )


def _drawn(found: Result) -> Drawn | None:
    """What moves in a picture of a result; None for a free space.

    Raises
    ------
    InputError
        If no state was found on either side of a largest gap.
    """
    if isinstance(found, Answer):
        return found
    from wiggleroom.disassembly.interlock_result import Interlock
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.freespace.free_space import FreeSpace
    from wiggleroom.report.results.separability import Checked

    match found:
        case FreeSpace():
            return None
        case Interlock():
            return Checked(found)
        case LargestGap():
            side = found.apart or found.interlocked  # how it comes apart says more
            if side is None:
                message = (
                    "largest gap: no gap was found that holds it together, or at which it comes apart: nothing to show"
                )
                raise InputError(message)
            return Checked(side, found)
    return found


def _film(shown: Drawn, path: Path, command: str, progress: Progress | None) -> None:
    from wiggleroom.report.films.film import film_of_answer
    from wiggleroom.report.page.plan_pictures import film_of_plan
    from wiggleroom.report.results.separability import Checked
    from wiggleroom.report.solids.spatial_film import film_of_spatial
    from wiggleroom.report.write_picture import film_of_check

    match shown:
        case _ if shown.assembly.dimension == 3:
            film_of_spatial(shown.found if isinstance(shown, Checked) else shown, path, progress=progress)
        case Answer():
            film_of_answer(shown, path, progress=progress)
        case Checked():
            film_of_check(shown, path, command=command, progress=progress)
        case _:
            film_of_plan(shown, path, command=command, progress=progress)


def _picture(shown: Drawn, command: str) -> str:
    """SVG of a result in the plane."""
    if isinstance(shown, Answer):
        from wiggleroom.report.pictures.picture import picture

        return picture(shown)
    from wiggleroom.report.page.plan_pictures import picture_of_plan
    from wiggleroom.report.pictures.leaving_picture import picture_of_check
    from wiggleroom.report.results.separability import Checked

    if isinstance(shown, Checked):
        return picture_of_check(shown, command=command)
    return picture_of_plan(shown, command=command)


def _draw_solid(shown: Drawn, path: Path) -> None:
    """Write a picture or a model of a result in space."""
    from wiggleroom.report.results.separability import Checked
    from wiggleroom.report.solids.spatial_picture import draw_separation, draw_spatial

    match shown:
        case Answer():
            draw_spatial(shown, path)
        case Checked():
            draw_separation(shown.found, path)
        case _:
            from wiggleroom.report.results.plan_results import plan_facts, plan_title

            draw_separation(as_interlock(shown), path, [plan_title(shown), *plan_facts(shown)])


def _page_in_space(shown: Drawn, command: str) -> str:
    from wiggleroom.report.page.solid_page import page_of_separation, page_of_spatial_answer, page_of_spatial_study
    from wiggleroom.report.page.standalone_page import section
    from wiggleroom.report.results.separability import Checked

    match shown:
        case Answer():
            return page_of_spatial_answer(shown, command or shown.command)
        case Checked():
            return page_of_separation(shown.found, command)
    from wiggleroom.report.results.plan_results import plan_facts, plan_title, step_sentence

    rows = [(f"{k + 1}. {step_sentence(step)}",) for k, step in enumerate(shown.steps)]
    steps = section("Steps", columns=("one after the other",), rows=rows)
    about = witnessed(shown.assembly, (), Verdict.STATIONARY, 0.0, shown.path, PathState.CHECKED)
    return page_of_spatial_study(plan_title(shown), plan_facts(shown), [steps], about, command, at_end=False)


def as_interlock(found: Plan) -> Interlock:
    """The removals of a plan as escapes, each with its path from rest."""
    from wiggleroom.disassembly.interlock_result import Escape, Interlock

    escapes = [Escape(step.leaves, step.path) for step in found.steps if step.leaves]
    return Interlock(found.assembly, found.verdict, found.certainty, tuple(escapes), remains=found.remains)


def _write_finding(finding: Finding, path: Path, command: str) -> None:
    """Write a figure, parts coloured by a number each, or a page of sentences and tables."""
    solid = finding.figure is None and finding.assembly.dimension == 3
    check_ending(path, SPATIAL_STUDIES if solid else STUDIES)
    if ending(path) == PAGE:
        from wiggleroom.report.page.finding_page import page_of_finding

        write_whole(path, page_of_finding(finding, command=command))
    elif solid and isinstance(finding.motion, Answer):
        from wiggleroom.report.page.finding_page import solid_colours
        from wiggleroom.report.pictures.finding_picture import subtitle
        from wiggleroom.report.solids.spatial_picture import Shown, write_moved_parts

        motion, lines = finding.motion, [finding.title, ", ".join(subtitle(finding))]
        write_moved_parts(motion.assembly, motion.motion, path, lines, Shown(motion.contacts, solid_colours(finding)))
    else:
        from wiggleroom.report.pictures.finding_picture import picture_of_finding

        write_still(picture_of_finding(finding, command=command), path)


def film_of_check(
    checked: Checked, path: Path, *, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a film of all that leave, one after the other."""
    answer = as_answer(checked.found)
    film(
        answer.assembly,
        answer.waypoints,
        path,
        goals=answer.goals,
        pulled="leaves",
        title=check_title(checked.found),
        facts=tuple(check_facts(checked.found, checked.border)),
        command=command,
        progress=progress,
    )
