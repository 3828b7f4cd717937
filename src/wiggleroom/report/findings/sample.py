"""How the answer is told: motion when gaps vary at random."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.report.finding import Finding, Histogram, Panel, PartTints, Table
from wiggleroom.report.results.answer_words import goals_text, headline, number, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.study_schema import CheckedDraws, SampleResult, SpreadEntry, WorstDraw, YieldEntry

if TYPE_CHECKING:
    from wiggleroom.sensitivity.sample import Sample


MAX_WORST_PARTS = 12
"""Rows that the terminal shows."""
QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
SHOWN_QUANTILES = (0.05, 0.5, 0.95)
"""Marked in the histogram."""


def finding(found: Sample, command: str = "") -> Finding:
    """The draws as a histogram, numbers, and which parts contribute."""
    answer = found.answer
    names, share = answer.assembly.names, found.contributions.tolist()
    return Finding(
        title=f"{goals_text(answer.goals)} when gaps vary",
        record=partial(_record, found, command),
        assembly=answer.assembly,
        facts=_facts(found),
        sure=_sure(found),
        sections=(Panel("Motions of the draws", _histogram(found)), _numbers(found), _parts(found)),
        data=_data(found),
        motion=answer,
        tints=PartTints(dict(zip(names, share, strict=True)), "% of the variance"),
        tab="Draws",
        code=0 if len(found.value) == found.asked else 3,
    )


def _facts(found: Sample) -> list[str]:
    bounded, what, spread = found.bounded, unit(found.answer.goals), found.spread
    together = f", {100 * spread.sheet:.0f} % shared by the sheet" if spread.sheet else ""
    said = [
        f"{headline(found.answer)} without variation",
        f"gaps vary: {spread.kind}, {number(spread.width)} mm{together}; {len(found.value)} draws, seed {found.seed}",
    ]
    if len(bounded):
        said.append(f"mean {number(float(bounded.mean()))} {what}".rstrip())
    if found.limit is not None:
        said.append(f"yield: {yield_sentence(found)}")
    if found.misfits:
        said.append(f"in {found.misfits} draws parts do not fit beside each other")
    if found.loose:
        said.append(f"in {found.loose} draws nothing stops the motion")
    return said


def yield_sentence(found: Sample) -> str:
    """Say how many draws keep the limit, and how sure that is."""
    good, low, high = found.yields
    least = "at least " if found.limit is not None and found.undecided.any() else ""
    kept = f"{least}{100 * good:.1f} % keep {number(found.limit or 0.0)} {unit(found.answer.goals)}".rstrip()
    return f"{kept} (95 % sure: {100 * low:.1f} to {100 * high:.1f} %)"


def _sure(found: Sample) -> list[tuple[str, str]]:
    """How the draws were checked: a word and a sentence each."""
    said = []
    if found.cut_short:
        said.append(("safe", f"in {found.cut_short} draws the motion is safe but not an optimum"))
    if len(found.value) < found.asked:
        said.append(("stopped", f"after {len(found.value)} of {found.asked} draws"))
    if found.tightest is not None and found.loosest is not None:
        what = unit(found.answer.goals)
        tight, loose = (_end_words(end, what) for end in (found.tightest, found.loosest))
        at = f"every part at its tightest of all draws {tight}, at its loosest {loose}; both asked as flex does"
        said.append(("bounds", at))
    if len(found.checked):
        off = f"off by up to {100 * found.largest_difference:.2g} %" if found.largest_difference else "right"
        said.append(("searched", f"{len(found.checked)} draws, as flex does; climbs of these were {off}"))
    if found.undecided.any():
        may = "move further than found" if found.limit is None else "break the limit"
        said.append(("open", f"{found.undecided.sum()} draws, which were climbed and not searched, may {may}"))
    return said


def _end_words(value: float, what: str) -> str:
    if math.isnan(value):
        return "does not fit"
    return "has no end" if math.isinf(value) else f"moves {number(value)} {what}".rstrip()


def _numbers(found: Sample) -> Table:
    bounded = found.bounded
    rows: list[tuple[str, float]] = [("without variation", found.answer.objective or 0.0)]
    if len(bounded):
        rows.append(("mean", float(bounded.mean())))
    if len(bounded) > 1:
        rows.append(("standard deviation", float(bounded.std(ddof=1))))
    if found.misfits < len(found.value):
        rows += [(f"{100 * q:g} % of the draws below", found.quantile(q)) for q in QUANTILES]
        rows.append(("worst", float(found.value[found.worst])))
    return Table(("draws", f"motion {unit(found.answer.goals)}".rstrip()), rows, "In numbers")


def _parts(found: Sample) -> Table:
    names, share, worst = found.answer.assembly.names, found.contributions, found.extra[found.worst].tolist()
    rows = [(names[k], float(share[k]), worst[k]) for k in np.argsort(-share, kind="stable").tolist()]
    return Table(("part", "contributes %", "extra gap mm in the worst draw"), rows, "Parts", MAX_WORST_PARTS)


def _data(found: Sample) -> Table:
    rows = [
        (k + 1, value, *extra)
        for k, (value, extra) in enumerate(zip(found.value.tolist(), found.extra.tolist(), strict=True))
    ]
    return Table(("draw", "objective", *found.answer.assembly.names), rows)


def _histogram(found: Sample) -> Histogram:
    """Motions of all draws that end, with quantiles and the limit."""
    ends = [(q, found.quantile(q)) for q in SHOWN_QUANTILES]
    marks = [(value, f"{100 * q:g} % below {number(value)}") for q, value in ends if np.isfinite(value)]
    limit = None if found.limit is None else (found.limit, f"limit {number(found.limit)}")
    return Histogram(found.bounded, f"motion {unit(found.answer.goals)}".rstrip(), marks, limit)


def _record(found: Sample, command: str) -> SampleResult:
    names, share = found.answer.assembly.names, found.contributions
    good, low, high = found.yields
    spread, worst, bounded = found.spread, found.worst, found.bounded
    order = np.argsort(-share, kind="stable").tolist()
    return SampleResult(
        dimension=dimension(found.answer.assembly),
        objective=found.answer.objective,
        spread=SpreadEntry(spread.width, spread.kind, spread.sheet, spread.bias),
        draws=len(found.value),
        asked=found.asked,
        seed=found.seed,
        mean=float(bounded.mean()) if len(bounded) else None,
        standard_deviation=float(bounded.std(ddof=1)) if len(bounded) > 1 else None,
        foreseen_standard_deviation=found.foreseen,
        quantiles={f"{q:g}": found.quantile(q) for q in QUANTILES},
        worst=WorstDraw(float(found.value[worst]), dict(zip(names, found.extra[worst].tolist(), strict=True))),
        unbounded=found.loose,
        misfits=found.misfits,
        cut_short=found.cut_short,
        limit=found.limit,
        yields=YieldEntry(good, float(low), float(high)),
        undecided=int(found.undecided.sum()),
        tightest=_end(found.tightest),
        loosest=_end(found.loosest),
        contributions_percent={names[k]: float(share[k]) for k in order},
        checked=CheckedDraws(len(found.checked), found.largest_difference),
        notes=list(found.answer.assembly.drawing.notes),
        command=command,
    )


def _end(value: float | None) -> float | str | None:
    """The largest motion of a state that bounds all draws, for JSON."""
    if value is None or math.isfinite(value):
        return value
    return "parts do not fit" if math.isnan(value) else "unbounded"
