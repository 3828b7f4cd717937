"""Reports of `rank`, `tighten`, `sweep` and `sample`: one HTML file each."""

from __future__ import annotations

import numpy as np

from wiggleroom.analysis.rank import Ranking
from wiggleroom.analysis.sample import Sample
from wiggleroom.analysis.sweep import Sweep
from wiggleroom.analysis.tighten import Tightening
from wiggleroom.report import study_plots
from wiggleroom.report.blame import (
    picture_of_ranking,
    picture_of_tightening,
    ranking_facts,
    tightening_facts,
    tinted,
)
from wiggleroom.report.html import answer_sure, contacts_section, film_of, magnified, parts_section, ranking_sections
from wiggleroom.report.page import Section, figure, items, page, table
from wiggleroom.report.picture import picture
from wiggleroom.report.plots import histogram
from wiggleroom.report.ranking import ranking_sure
from wiggleroom.report.studies import QUANTILES, lost_sentence, sample_sure
from wiggleroom.report.words import headline, number, unit


def page_of_ranking(ranking: Ranking, *, command: str = "") -> str:
    """Ranking as one HTML page: coloured picture, parts and joints in order, film, and how sure it is."""
    answer = ranking.answer
    coloured = figure(picture_of_ranking(ranking, framed=False), magnified(answer), paper=True)
    sections = [
        Section("Parts, coloured by how much their gap matters", coloured, wide=True),
        *ranking_sections(ranking),
        film_of(answer),
        contacts_section(answer),
        Section("How sure is it", items([*ranking_sure(ranking), *answer_sure(answer)])),
    ]
    return page(headline(answer), ranking_facts(ranking), sections, command)


def page_of_tightening(found: Tightening, *, command: str = "") -> str:
    """Tightening as one HTML page: what is left, which parts are chosen, and how choices at random do."""
    after, before = found.after, found.before
    coloured = figure(picture_of_tightening(found, framed=False), magnified(after), paper=True)
    sections = [Section("The motion that is left, the tightened parts coloured", coloured, wide=True)]
    if len(found.random):
        marks = [
            (value, f"{said} {number(value)}")
            for value, said in ((after.objective, "these parts"), (before.objective, "as it is"))
            if value is not None
        ]
        what = f"motion {unit(before.goals)}".rstrip()
        plot = histogram(found.random, label=what, title="as many parts at random", marks=marks, framed=False)
        sections.append(Section(f"As many parts at random, {len(found.random)} times", figure(plot), wide=True))
    moved = [dict(zip(a.assembly.names, np.hypot(*a.motion[:, :2].T).tolist(), strict=True)) for a in (before, after)]
    rows = [(k + 1, name, moved[0][name], moved[1][name]) for k, name in enumerate(found.chosen)]
    sections += [
        Section("Make these tighter, in this order", table(["", "part", "moved mm before", "after"], rows)),
        contacts_section(after),
        film_of(after),
        parts_section(after),
        Section("How sure is it", items(answer_sure(after))),
    ]
    return page(headline(after), tightening_facts(found), sections, command)


def page_of_sweep(found: Sweep, *, command: str = "") -> str:
    """Sweep as one HTML page: the curve and its numbers.

    Raises
    ------
    InputError
        If no gap was finished.
    """
    what = unit(found.goals)
    rows: list[list[str | float]] = []
    for s in found.steps:
        value = float("nan") if s.objective is None else float(s.objective)
        rate = value / s.gap if s.gap > 0 else float("nan")
        rows.append([float(s.gap), value, rate, str(s.verdict), "checked" if s.checked else "not checked"])
    heads = ["gap mm", f"motion {what}".rstrip(), "per mm of gap", "verdict", "way"]
    sure = [
        ("loses its end", lost_sentence(found)),
        ("found", "each gap begins where the smaller one ended; parts that became smaller still fit there"),
    ]
    sections = [
        Section("Motion against gap", figure(study_plots.picture_of_sweep(found, framed=False)), wide=True),
        Section("Gaps", table(heads, rows), wide=True),
        Section("How sure is it", items(sure), wide=True),
    ]
    return page(study_plots.sweep_title(found), study_plots.sweep_facts(found), sections, command)


def page_of_sample(found: Sample, *, command: str = "") -> str:
    """Sample as one HTML page: histogram, numbers, which parts contribute, and the worst draw."""
    answer, bounded = found.answer, found.bounded
    what, names, share = unit(answer.goals), answer.assembly.names, found.contributions
    numbers: list[tuple[str, float]] = [("without variation", answer.objective or 0.0)]
    if len(bounded):
        numbers.append(("mean", float(bounded.mean())))
    if len(bounded) > 1:
        numbers.append(("standard deviation", float(bounded.std(ddof=1))))
    numbers += [(f"{100 * q:g} % of the draws below", found.quantile(q)) for q in QUANTILES]
    numbers.append(("worst", float(found.value[found.worst])))
    worst = found.extra[found.worst].tolist()
    parts = [(names[k], float(share[k]), worst[k]) for k in np.argsort(-share, kind="stable").tolist()]
    tints = tinted(answer, share, "% of the variance")
    coloured = figure(picture(answer, framed=False, tints=tints), magnified(answer), paper=True)
    sections = [
        Section("Motions of the draws", figure(study_plots.picture_of_sample(found, framed=False)), wide=True),
        Section("In numbers", table(["", f"motion {what}".rstrip()], numbers)),
        Section("Parts", table(["part", "contributes %", "extra gap mm in the worst draw"], parts)),
        Section("The motion without variation, parts coloured by what they contribute", coloured, wide=True),
        Section("How sure are the draws", items(sample_sure(found))),
        Section("How sure is the motion without variation", items(answer_sure(answer))),
    ]
    return page(study_plots.sample_title(found), study_plots.sample_facts(found), sections, command)
