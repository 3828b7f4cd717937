"""Answers in space into files: pictures, models for viewers and pages, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from wiggleroom.disassembly.interlock_result import Escape, Interlock
from wiggleroom.files import write_whole
from wiggleroom.planning.plan import Plan
from wiggleroom.report.page.solid_page import page_of_separation, page_of_spatial_answer, page_of_spatial_study
from wiggleroom.report.page.standalone_page import section
from wiggleroom.report.pictures.file_endings import FILMS, PAGE, SPATIAL_ANSWERS, check_ending, ending
from wiggleroom.report.results.plan_results import plan_facts, plan_title, step_sentence
from wiggleroom.report.solids.spatial_picture import draw_separation, draw_spatial
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.verdict import PathState, Verdict

SpatialFound = Answer | Interlock | Plan
"""What is shown as parts in space."""


def write_spatial(
    found: SpatialFound, path: Path, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a picture (.svg, .png), a model of the moved parts (.glb), a page (.html), or a film of the path (.gif, .mp4, .film.svg).

    Raises
    ------
    InputError
        If the name has another ending.
    """
    check_ending(path, SPATIAL_ANSWERS)
    if ending(path) in FILMS:
        from wiggleroom.report.solids.spatial_film import film_of_spatial

        film_of_spatial(found, path, progress=progress)
    elif ending(path) == PAGE:
        write_whole(path, spatial_page(found, command))
    elif isinstance(found, Answer):
        draw_spatial(found, path)
    elif isinstance(found, Plan):
        draw_separation(as_interlock(found), path, [plan_title(found), *plan_facts(found)])
    else:
        draw_separation(found, path)


def spatial_page(found: SpatialFound, command: str = "") -> str:
    """The same as one HTML page."""
    if isinstance(found, Answer):
        return page_of_spatial_answer(found, command or found.command)
    if isinstance(found, Plan):
        rows = [(f"{k + 1}. {step_sentence(step)}",) for k, step in enumerate(found.steps)]
        steps = section("Steps", columns=("one after the other",), rows=rows)
        about = witnessed(found.assembly, (), Verdict.STATIONARY, 0.0, found.path, PathState.CHECKED)
        return page_of_spatial_study(plan_title(found), plan_facts(found), [steps], about, command, at_end=False)
    return page_of_separation(found, command)


def as_interlock(found: Plan) -> Interlock:
    """The removals of a plan as escapes, each with its path from rest."""
    escapes = [Escape(step.leaves, step.path) for step in found.steps if step.leaves]
    return Interlock(found.assembly, found.verdict, found.certainty, tuple(escapes), remains=found.remains)
