"""Everything that was found as one HTML page each: an answer, a check, and every study."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from msgspec.structs import asdict

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compare.monte_carlo import SampledAccuracy
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.errors import InputError
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.report.free_space.space_report import space_facts, space_picture, space_result
from wiggleroom.report.free_space.space_report import space_headline as space_headline
from wiggleroom.report.free_space.space_solid import space_message
from wiggleroom.report.page.standalone_page import packed_frames, section, shown_answer, shown_drawing, standalone_page
from wiggleroom.report.page.study_messages import check_message, ranking_message, step_message
from wiggleroom.report.page.study_tabs import sample_message, tightening_message
from wiggleroom.report.pictures import study_plots
from wiggleroom.report.pictures.importance_picture import ranking_facts
from wiggleroom.report.results.allowable_gap_results import gap_facts, gap_sentence, gap_sure
from wiggleroom.report.results.answer_words import assembly_lines, headline, unit
from wiggleroom.report.results.separability import Checked, check_facts, check_title
from wiggleroom.report.results.study_results import band_sentence, has_band, lost_sentence
from wiggleroom.report.results.tolerance_results import (
    tolerance_name,
    tolerances_facts,
    tolerances_sentence,
    tolerances_sure,
)
from wiggleroom.schema.standalone_schema import StandaloneCheck
from wiggleroom.schema.study_replies import StudyReply, StudyTab, Title
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.gap_trials import AllowableGap
from wiggleroom.sensitivity.perturbation import can_be_ranked
from wiggleroom.sensitivity.rank import Ranking, rank_at_once
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.sweep import Sweep
from wiggleroom.sensitivity.tighten import Tightening
from wiggleroom.sensitivity.worst_case import WorstCase
from wiggleroom.verdict import PathState


def page_of_answer(answer: Answer, found: Interlock | None = None) -> str:
    """Answer as one HTML page: drawing, film, contacts, parts, how sure it is, and the command.

    Whose gap matters is said too where the motion ends at walls, from the forces of the answer itself.

    Parameters
    ----------
    found : Interlock, optional
        Whether the same assembly comes apart, where that is known.
    """
    told = _about(answer, answer.command) | ({} if found is None else _check(Checked(found), ""))
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


def page_of_ranking(ranking: Ranking, *, command: str = "") -> str:
    """Ranking as one HTML page: coloured parts, parts and joints in order, and the answer that they are about."""
    answer = ranking.answer
    told = _about(answer, command) | {"rank": ranking_message(ranking, command), "tab": "gaps"}
    return standalone_page(headline(answer), **told, said=Title(headline(answer), ranking_facts(ranking)))


def page_of_check(checked: Checked, *, command: str = "") -> str:
    """Check as one HTML page: the verdict, who leaves in which order and how as films, and how sure it is."""
    found, title = checked.found, check_title(checked.found)
    said = Title(title, check_facts(found, checked.border))
    return standalone_page(
        title, opened=shown_drawing(found.assembly), said=said, tab="apart", **_check(checked, command)
    )


def page_of_sweep(found: Sweep, *, command: str = "") -> str:
    """Sweep as one HTML page: the curve, its numbers, and the whole answer at every gap under a slider.

    Raises
    ------
    InputError
        If no gap was finished.
    """
    answers = {step.gap: step.answer for step in found.steps if step.answer is not None}
    if not answers:
        finding = "sweep: there is no gap with an answer to show"
        raise InputError(finding)
    what = unit(found.goals)
    rows: list[list[str | float]] = []
    for s in found.steps:
        value = float("nan") if s.objective is None else float(s.objective)
        rate = value / s.gap if s.gap > 0 else float("nan")
        most = [float("nan") if s.at_most is None else s.at_most] if has_band(found) else []
        rows.append([float(s.gap), value, *most, rate, str(s.verdict), PathState.of(s.checked)])
    band = ["at most"] if has_band(found) else []
    heads = ["gap mm", f"motion {what}".rstrip(), *band, "per mm of gap", "verdict", "path"]
    sure = [
        ("loses its end", lost_sentence(found)),
        (
            "found",
            "each gap is searched; what a smaller gap has shown counts too, for parts that became smaller still fit",
        ),
        *([("bound", band_sentence(found))] if has_band(found) else []),
    ]
    first = min(answers, key=lambda gap: abs(gap - found.assembly.gap))
    told = {
        "opened": shown_drawing(next(iter(answers.values())).assembly, found.goals),
        "begin": first,
        "answers": shown_answer(answers, command),
        "steps": [step_message(step) for step in found.steps],
        "lost": found.lost,
        "study": StudyTab("Gaps", [section("Motion against gap", columns=heads, rows=rows, terms=sure)]),
    }
    return standalone_page(study_plots.sweep_title(found), **told)


def page_of_tightening(found: Tightening, *, command: str = "") -> str:
    """Tightening as one HTML page: what is left, which parts are chosen, and how choices at random do."""
    told = _about(found.after, command) | _study(tightening_message(found, command))
    return standalone_page(headline(found.after), **told)


def page_of_sample(found: Sample, *, command: str = "") -> str:
    """Sample as one HTML page: histogram, numbers, which parts contribute, the worst draw, and the answer without variation."""
    told = _about(found.answer, command) | _study(sample_message(found, command))
    return standalone_page(study_plots.sample_title(found), **told)


def page_of_gap(found: AllowableGap, *, command: str = "") -> str:
    """Gap that answers a maker's question as one HTML page: the curve, the trials, and the motion at the answer."""
    held, apart = found.sides
    if (apart or held) is not None:
        return page_of_check(Checked(cast(Interlock, apart or held)), command=command)
    title = gap_sentence(found)
    rows = [
        (t.gap, "" if t.value is None else t.value, "" if t.at_most is None else t.at_most, t.verdict)
        for t in found.trials
    ]
    what = "overlap mm" if found.question == "fits" else f"motion {unit(found.goals)}".rstrip()
    sections = [
        section("Against the gap", svg=study_plots.picture_of_gap(found, framed=False)),
        section("How sure is it", terms=gap_sure(found)),
        section("Everything that was tried", columns=["gap mm", what, "at most", "verdict"], rows=rows),
    ]
    near = [t.answer for t in found.trials if t.answer is not None and t.gap == found.gap]
    shown: dict[str, Any] = _about(near[0], command) if near else {"opened": shown_drawing(found.assembly, found.goals)}
    told = shown | {"said": Title(title, gap_facts(found)), "tab": "study", "study": StudyTab("Gap", sections)}
    return standalone_page(title, **told)


def page_of_tolerances(found: WorstCase, *, command: str = "") -> str:
    """Worst case within tolerances as one HTML page: who contributes, the numbers, and the motion at the worst corner."""
    title = tolerances_sentence(found)
    rows = [
        (tolerance_name(c.tolerance), c.tolerance.plus, c.tolerance.minus, c.slope, c.looser, share)
        for c, share in zip(found.contributions, found.percent.tolist(), strict=True)
    ]
    heads = ["tolerance", "plus mm", "minus mm", "mm per mm", "adds mm", "%"]
    sections = [
        section("Worst and best", terms=tolerances_sure(found)),
        section("Contributions", "To first order, one at a time.", columns=heads, rows=rows),
    ]
    told = _about(found.loosest, command) | {
        "said": Title(title, tolerances_facts(found)),
        "tab": "study",
        "study": StudyTab("Tolerances", sections),
    }
    return standalone_page(title, **told)


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


def _study(found: StudyReply) -> dict[str, Any]:
    """A study and what stands in place of the answer's headline."""
    return {"tab": "study", "said": found.said, "study": found.study, "tints": found.tints}


def _check(checked: Checked, command: str) -> dict[str, Any]:
    """A verdict with the paths of those that leave."""
    found = checked.found
    paths = [packed_frames(found.assembly, escape.path) for escape in found.escapes]
    return {"check": StandaloneCheck(check_message(found, command, checked.border), paths)}


def _about(answer: Answer, command: str) -> dict[str, Any]:
    """A drawing and the answer to one question about it."""
    gap = answer.assembly.gap
    return {
        "opened": shown_drawing(answer.assembly, answer.goals),
        "answers": shown_answer({gap: answer}, command),
        "tab": "answer",
    }
