"""Answers, checks, drawings and free spaces as one HTML page each."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec.structs import asdict

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compare.monte_carlo import SampledAccuracy
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.report.free_space.space_report import space_facts, space_picture, space_result
from wiggleroom.report.free_space.space_report import space_headline as space_headline
from wiggleroom.report.free_space.space_solid import space_message
from wiggleroom.report.page.standalone_page import packed_frames, section, shown_answer, shown_drawing, standalone_page
from wiggleroom.report.page.study_messages import check_message, ranking_message
from wiggleroom.report.results.answer_words import assembly_lines, headline
from wiggleroom.report.results.separability import Checked, check_facts, check_title
from wiggleroom.schema.standalone_schema import StandaloneCheck
from wiggleroom.schema.study_replies import StudyTab, Title
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.perturbation import can_be_ranked
from wiggleroom.sensitivity.rank import rank_at_once


def page_of_answer(answer: Answer, found: Interlock | None = None) -> str:
    """Answer as one HTML page: drawing, film, contacts, parts, how sure it is, and the command.

    Whose gap matters is said too where the motion ends at walls, from the forces of the answer itself.

    Parameters
    ----------
    found : Interlock, optional
        Whether the same assembly comes apart, where that is known.
    """
    told = about_answer(answer, answer.command) | ({} if found is None else _check(Checked(found), ""))
    if answer.model == "walls" and can_be_ranked(answer):
        told["rank"] = ranking_message(rank_at_once(answer), answer.command)
    return standalone_page(headline(answer), **told)


def page_of_assembly(assembly: Assembly) -> str:
    """Assembly as one HTML page: the parts as they are made, at rest, and what the file asks."""
    title, *more = assembly_lines(assembly)
    rows: list[list[str | float]] = []
    for part in assembly.parts:
        width, height = np.ptp(np.vstack([region.outer for region in part.regions]), axis=0).tolist()
        rows.append([part.name, width, height, "stands" if part.fixed else ""])
    table = section("Parts", columns=["part", "width mm", "height mm", ""], rows=rows)
    shown = shown_drawing(assembly, assembly.goals)
    return standalone_page(title, opened=shown, said=Title(title, more), tab="study", study=StudyTab("Parts", [table]))


def page_of_check(checked: Checked, *, command: str = "") -> str:
    """Check as one HTML page: the verdict, who leaves in which order and how as films, and how sure it is."""
    found, title = checked.found, check_title(checked.found)
    said = Title(title, check_facts(found, checked.border))
    return standalone_page(
        title, opened=shown_drawing(found.assembly), said=said, tab="apart", **_check(checked, command)
    )


def page_of_space(space: FreeSpace, judged: SampledAccuracy | None = None, *, command: str = "") -> str:
    """Free space of a pair as one HTML page: the solid to be turned, slices, cells, and how they were judged."""
    result = space_result(space, judged, command)
    cells = [(k + 1, c.walls, *c.angles_deg) for k, c in enumerate(result.cells)]
    sections = [
        section("Picture", svg=space_picture(space, judged, framed=False)),
        section("Slices", columns=["turn °", "area mm²"], rows=[(s.angle_deg, s.area) for s in result.slices]),
        section("Cells", columns=["cell", "walls", "from °", "to °"], rows=cells),
    ]
    if result.audit is not None:
        judgement = [(term, str(value)) for term, value in asdict(result.audit).items()]
        sections.append(section("Judged against polygon intersection", terms=judgement))
    told = {
        "opened": shown_drawing(space.assembly),
        "said": Title(space_headline(space), space_facts(space, judged)),
        "tab": "space",
        "space": space_message(space, (0.0, 0.0, 0.0), command),
        "study": StudyTab("Slices and cells", sections),
    }
    return standalone_page(space_headline(space), **told)


def _check(checked: Checked, command: str) -> dict[str, Any]:
    """A verdict with the paths of those that leave."""
    found = checked.found
    paths = [packed_frames(found.assembly, escape.path) for escape in found.escapes]
    return {"check": StandaloneCheck(check_message(found, command, checked.border), paths)}


def about_answer(answer: Answer, command: str) -> dict[str, Any]:
    """A drawing and the answer to one question about it."""
    gap = answer.assembly.gap
    return {
        "opened": shown_drawing(answer.assembly, answer.goals),
        "answers": shown_answer({gap: answer}, command),
        "tab": "answer",
    }
