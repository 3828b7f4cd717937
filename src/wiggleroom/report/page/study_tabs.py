"""Studies as a tab of the page: the same live and in a file."""

from __future__ import annotations

import numpy as np

from wiggleroom.report.page.standalone_page import section
from wiggleroom.report.pictures import study_plots
from wiggleroom.report.pictures.importance_picture import tightening_facts
from wiggleroom.report.pictures.plots import histogram
from wiggleroom.report.results.answer_words import headline, number, unit
from wiggleroom.report.results.study_results import QUANTILES, sample_sure
from wiggleroom.schema.study_replies import StudyReply, StudyTab, Tints, Title
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.tighten import Tightening


def tightening_message(found: Tightening, command: str) -> StudyReply:
    """Which parts to make tighter: what is left, who is chosen in which order, and how choices at random do."""
    after, before = found.after, found.before
    axes = after.assembly.dimension
    moved = [
        dict(zip(a.assembly.names, np.linalg.norm(a.motion[:, :axes], axis=1).tolist(), strict=True))
        for a in (before, after)
    ]
    rows = [(k + 1, name, moved[0][name], moved[1][name]) for k, name in enumerate(found.chosen)]
    heads = ["order", "part", "moved mm before", "after"]
    sections = [
        section("Make these tighter, in this order", "Colour the parts to see which.", columns=heads, rows=rows)
    ]
    if len(found.random):
        marks = [
            (value, f"{said} {number(value)}")
            for value, said in ((after.objective, "these parts"), (before.objective, "as it is"))
            if value is not None
        ]
        what = f"motion {unit(before.goals)}".rstrip()
        plot = histogram(found.random, label=what, title="as many parts at random", marks=marks, framed=False)
        sections.append(section(f"As many parts at random, {len(found.random)} times", svg=plot))
    return StudyReply(
        of="tighten",
        said=Title(headline(after), tightening_facts(found)),
        study=StudyTab("Tighter", sections),
        tints=Tints("", dict.fromkeys(found.chosen, 1.0)),
        command=command,
        extra=dict.fromkeys(found.chosen, float(f"{found.gap - before.assembly.gap:.9g}")),
    )


def sample_message(found: Sample, command: str) -> StudyReply:
    """How far it moves where gaps vary: the draws, numbers, which parts contribute, and how sure that is."""
    answer, bounded = found.answer, found.bounded
    what, names, share = unit(answer.goals), answer.assembly.names, found.contributions
    numbers: list[tuple[str, float]] = [("without variation", answer.objective or 0.0)]
    if len(bounded):
        numbers.append(("mean", float(bounded.mean())))
    if len(bounded) > 1:
        numbers.append(("standard deviation", float(bounded.std(ddof=1))))
    if found.misfits < len(found.value):
        numbers += [(f"{100 * q:g} % of the draws below", found.quantile(q)) for q in QUANTILES]
        numbers.append(("worst", float(found.value[found.worst])))
    worst = found.extra[found.worst].tolist()
    parts = [(names[k], float(share[k]), worst[k]) for k in np.argsort(-share, kind="stable").tolist()]
    sections = [
        section("Motions of the draws", svg=study_plots.picture_of_sample(found, framed=False)),
        section("In numbers", columns=["what", f"motion {what}".rstrip()], rows=numbers),
        section("Parts", columns=["part", "contributes %", "extra gap mm in the worst draw"], rows=parts),
        section("How sure are the draws", terms=sample_sure(found)),
    ]
    return StudyReply(
        of="sample",
        said=Title(study_plots.sample_title(found), study_plots.sample_facts(found)),
        study=StudyTab("Draws", sections),
        tints=Tints("% of the variance", dict(zip(names, share.tolist(), strict=True))),
        command=command,
    )
