"""Assemblies, answers and studies in a notebook: the one-file page in a frame, and a few lines where no page can be shown."""

from __future__ import annotations

import html

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.interlock import Interlock
from wiggleroom.planning.plan import Plan
from wiggleroom.report import importance_picture, study_plots
from wiggleroom.report.answer_words import facts, headline, verdict_sentence
from wiggleroom.report.gap_limit import gap_facts, gap_sentence
from wiggleroom.report.pages import assembly_lines, page_of_answer, page_of_assembly
from wiggleroom.report.plan_results import plan_facts, plan_title
from wiggleroom.report.separability import check_facts, check_title
from wiggleroom.report.separability_picture import Checked
from wiggleroom.report.spatial_table import check_sentence, spatial_headline, spatial_sentence
from wiggleroom.report.study_results import lost_sentence
from wiggleroom.report.tolerance_results import tolerances_facts, tolerances_sentence
from wiggleroom.report.write_spatial import spatial_page
from wiggleroom.report.write_study import Study, assembly_of, in_space, page_of_study
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.gap_trials import AllowableGap
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.sweep import Sweep
from wiggleroom.sensitivity.tighten import Tightening
from wiggleroom.sensitivity.worst_case import WorstCase
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly
from wiggleroom.spatial.spatial_model import SpatialAssembly

HEIGHT = 560
"""Height of the frame [px]."""


def mime_bundle(found: Assembly | Answer | SpatialAnswer | SpatialDisassembly | Interlock | Study) -> dict[str, str]:
    """What a notebook shows: the page in a frame that may run its script and nothing else, and text.

    Where there is nothing to put on a page, an empty sweep, the text is alone.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> bundle = mime_bundle(wr.patterns.chain(2, gap=0.02))
    >>> print(bundle["text/plain"])
    2 parts, gap 0.02 mm
    b1 stands; asked: b2 in +y
    >>> sorted(bundle)
    ['text/html', 'text/plain']
    """
    said = lines(found)
    shown = {"text/plain": "\n".join(said)}
    if isinstance(found, Sweep) and all(step.answer is None for step in found.steps):
        return shown
    if isinstance(found, Sweep | Sample | AllowableGap) and _is_curve_in_space(found):
        return shown
    return shown | {"text/html": frame(_page(found), said[0])}


def frame(page: str, title: str) -> str:
    """Page in a frame of its own: it sees nothing of the notebook, and the notebook nothing of it."""
    return (
        f'<iframe title="{html.escape(title)}" srcdoc="{html.escape(page)}" sandbox="allow-scripts allow-downloads" '
        f'style="width:100%;height:{HEIGHT}px;border:1px solid #8884"></iframe>'
    )


def lines(found: Assembly | Answer | SpatialAnswer | SpatialDisassembly | Interlock | Study) -> list[str]:
    """What was found in a few lines of text, the headline first."""
    match found:
        case Assembly():
            return assembly_lines(found)
        case Answer():
            return [headline(found), f"{found.verdict}: {verdict_sentence(found)}", *facts(found)]
        case SpatialAnswer():
            return [spatial_headline(found), f"{found.verdict}: {spatial_sentence(found)}"]
        case SpatialDisassembly():
            return [f"{found.verdict} at gap {found.assembly.gap:g} mm: {check_sentence(found)}"]
        case Interlock():
            return [check_title(found), *check_facts(found, None)]
        case Checked():
            return [check_title(found.found), *check_facts(found.found, found.border)]
        case Plan():
            return [plan_title(found), *plan_facts(found)]
        case Ranking():
            return [headline(found.answer), *importance_picture.ranking_facts(found)]
        case Tightening():
            return [headline(found.after), *importance_picture.tightening_facts(found)]
        case Sweep():
            return [study_plots.sweep_title(found), lost_sentence(found)]
        case Sample():
            return [study_plots.sample_title(found), *study_plots.sample_facts(found)]
        case AllowableGap():
            return [gap_sentence(found), *gap_facts(found)]
        case WorstCase():
            return [tolerances_sentence(found), *tolerances_facts(found)]


def _is_curve_in_space(found: Sweep | Sample | AllowableGap) -> bool:
    return isinstance(assembly_of(found), SpatialAssembly) and in_space(found) is None


def _page(found: Assembly | Answer | SpatialAnswer | SpatialDisassembly | Interlock | Study) -> str:
    if isinstance(found, Assembly):
        return page_of_assembly(found)
    if isinstance(found, Answer):
        return page_of_answer(found)
    if isinstance(found, SpatialAnswer | SpatialDisassembly):
        return spatial_page(found)
    return page_of_study(Checked(found) if isinstance(found, Interlock) else found)
