"""What `tighten`, `sweep` and `sample` found, as JSON and as tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import UNSET

from wiggleroom.report.results.answer_words import goals_text, headline, number, rounded_up, short, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.report.results.table import columns
from wiggleroom.schema.study_schema import (
    CheckedDraws,
    RandomChoices,
    SampleResult,
    SpreadEntry,
    SweepEntry,
    SweepResult,
    TightenResult,
    WorstDraw,
    YieldEntry,
)
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.sweep import Sweep
from wiggleroom.sensitivity.tighten import Tightening
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from rich.console import Group

MAX_WORST_PARTS = 12
"""Rows of the table."""
QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


def tighten_result(found: Tightening, command: str = "") -> TightenResult:
    """Everything `tighten --json` says."""
    fits = found.random[np.isfinite(found.random)]
    return TightenResult(
        dimension=dimension(found.before.assembly),
        objective=found.before.objective,
        tightened=found.after.objective,
        verdict=found.after.verdict,
        lowered_percent=_finite(found.lowered),
        parts=list(found.chosen),
        chosen_by=found.chosen_by,
        gap=found.gap,
        limit=found.limit,
        reached=found.reached,
        random=RandomChoices(
            len(found.random),
            float(np.mean(fits)) if len(fits) else None,
            _finite(found.lowered_at_random),
            found.misfits,
        ),
        notes=list(found.before.assembly.drawing.notes),
        command=command,
    )


def _finite(value: float) -> float | None:
    """A number that JSON can hold, or None."""
    return value if math.isfinite(value) else None


def reduction_text(share: float, places: int) -> str:
    """Say by how much the motion gets less.

    >>> reduction_text(12.34, 0), reduction_text(float("nan"), 1)
    ('12 % less', 'no less')
    """
    return f"{share:.{places}f} % less" if math.isfinite(share) else "no less"


def at_random(found: Tightening, places: int) -> str:
    """Say what tightening as many parts at random takes away, and how often the parts do not fit then."""
    if found.misfits == len(found.random):
        return "the parts do not fit"
    return reduction_text(found.lowered_at_random, places) + (f" ({found.misfits} do not fit)" if found.misfits else "")


def tighten_table(found: Tightening) -> Group:
    """Page that `tighten` prints."""
    from rich.console import Group
    from rich.text import Text

    what = unit(found.before.goals)
    if found.after.objective is None:
        now = "nothing stops it"
    else:
        now = f"{number(found.after.objective)} {what}".rstrip() + f", {reduction_text(found.lowered, 1)}"
    lines = [Text(headline(found.before), style="bold"), Text()]
    if found.chosen:
        parts = ", ".join(short(n) for n in found.chosen)
        lines += [Text(f"make tighter:  {parts}"), Text(f"to a gap of:   {number(found.gap)} mm, their share of it")]
        drawing = found.before.assembly.drawing
        if any(joint.gap > drawing.gap and set(joint.parts) & set(found.chosen) for joint in drawing.gaps):
            lines.append(Text("               joints with a larger gap of their own keep what theirs is more"))
        lines.append(Text(f"then:          {now}", style="bold"))
    if found.limit is not None:
        word = "reached" if found.reached else "not reached, though every part that can be is tightened"
        lines.append(Text(f"limit:         {number(found.limit)} {what}".rstrip() + f", {word}"))
    lines += [Text(f"{term + ':':<15}{said}") for term, said in tighten_sure(found)]
    return Group(*lines)


CHOSEN_BY = {
    "rank": "by rank, a few at a time: a good choice, not provably the best",
    "draws": "the best of choices at random, which is better than the choice by rank; not provably the best",
    "all": "the best of all choices of as many parts, by climbs; searched",
}


def tighten_sure(found: Tightening) -> list[tuple[str, str]]:
    """How parts were chosen, and how other choices do: a word and a sentence each."""
    said = [("chosen", CHOSEN_BY[found.chosen_by])] if found.chosen else []
    if len(found.random):
        other = "all choices" if found.chosen_by == "all" else "at random"
        said.append(
            (other, f"{at_random(found, 1)}, mean of {len(found.random) - found.misfits} choices of as many parts")
        )
    return said


def sweep_result(found: Sweep, command: str = "") -> SweepResult:
    """Everything `sweep --json` says."""
    proven = has_band(found)
    return SweepResult(
        dimension=dimension(found.assembly),
        gaps=[
            SweepEntry(
                s.gap,
                s.objective,
                s.verdict,
                PathState.of(s.checked),
                s.at_most if proven else UNSET,
            )
            for s in found.steps
        ],
        lost_between=found.lost,
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def sweep_table(found: Sweep) -> Group:
    """Page that `sweep` prints."""
    from rich.console import Group
    from rich.text import Text

    what = unit(found.goals)
    proven = has_band(found)
    rows = columns("gap mm", f"motion {what}".rstrip(), *(["at most"] if proven else []), "per mm of gap", "verdict")
    for s in found.steps:
        value = "" if s.objective is None else number(s.objective)
        rate = "" if s.objective is None or s.gap == 0 else number(s.objective / s.gap, 3)
        most = [] if not proven else ["" if s.at_most is None else rounded_up(s.at_most)]
        rows.add_row(number(s.gap), value, *most, rate, str(s.verdict))
    said = [lost_sentence(found), *([band_sentence(found)] if proven else [])]
    return Group(Text(goals_text(found.goals, 3), style="bold"), Text(), rows, Text(), *map(Text, said))


def has_band(found: Sweep) -> bool:
    """Whether bounds were proven."""
    return any(s.at_most is not None for s in found.steps)


def band_sentence(found: Sweep) -> str:
    """Say how wide the proven band is."""
    ends = [s for s in found.steps if s.objective is not None]
    shares = [s.at_most / s.objective - 1 for s in ends if s.at_most is not None and s.objective]
    without = sum(s.at_most is None for s in ends)
    said = f"proven: at these gaps no motion is more than {rounded_up(100 * max(shares, default=0.0))} % above the one found"
    return said + (f"; {without} of {len(ends)} gaps have no bound" if without else "")


def lost_sentence(found: Sweep) -> str:
    """Say at which gap nothing stops the motion any more."""
    if found.lost is not None:
        low, high = (number(gap) for gap in found.lost)
        return f"nothing stops the motion from a gap of {high} mm on; at {low} mm a search found an end"
    free = [s.gap for s in found.steps if s.verdict == Verdict.UNBOUNDED]
    if free:
        return f"nothing stops the motion at a gap of {number(free[0])} mm, the first that leaves room"
    if found.steps and all(s.verdict in (Verdict.TOUCHING, Verdict.NOT_MAKEABLE) for s in found.steps):
        return "at none of these gaps is there a motion to ask for"
    return "nothing in this range sets it free" if found.steps else "stopped before the first gap was done"


def sample_result(found: Sample, command: str = "") -> SampleResult:
    """Everything `sample --json` says."""
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


def sample_table(found: Sample) -> Group:
    """Page that `sample` prints."""
    from rich.console import Group
    from rich.text import Text

    what, bounded = unit(found.answer.goals), found.bounded
    rows = columns("motion", what)
    if len(bounded):
        rows.add_row("mean", number(float(bounded.mean())))
        if len(bounded) > 1:
            rows.add_row("standard deviation", number(float(bounded.std(ddof=1)), 3))
    if found.misfits < len(found.value):
        for q in QUANTILES:
            rows.add_row(f"{100 * q:g} % of the draws below", number(found.quantile(q)))
        rows.add_row("worst", number(float(found.value[found.worst])), style="bold")
    share = found.contributions
    parts = columns("contributes", "%")
    for k in np.argsort(-share, kind="stable")[:MAX_WORST_PARTS].tolist():
        parts.add_row(short(found.answer.assembly.names[k]), f"{share[k]:.1f}")
    lines = [
        Text(f"{headline(found.answer)} without variation", style="bold"),
        Text(f"gaps vary: {spread_words(found)}; {len(found.value)} draws, seed {found.seed}"),
    ]
    shown = (rows, Text()) if rows.row_count else ()
    return Group(
        *lines,
        Text(),
        *shown,
        parts,
        Text(),
        *[Text(f"{term + ':':<9} {line}") for term, line in sample_sure(found)],
    )


def spread_words(found: Sample) -> str:
    """Say how the gaps vary."""
    spread = found.spread
    together = f", {100 * spread.sheet:.0f} % shared by the sheet" if spread.sheet else ""
    return f"{spread.kind}, {number(spread.width)} mm{together}"


def yield_sentence(found: Sample) -> str:
    """Say how many draws keep the limit, and how sure that is."""
    good, low, high = found.yields
    least = "at least " if found.limit is not None and found.undecided.any() else ""
    kept = f"{least}{100 * good:.1f} % keep {number(found.limit or 0.0)} {unit(found.answer.goals)}".rstrip()
    return f"{kept} (95 % sure: {100 * low:.1f} to {100 * high:.1f} %)"


def sample_sure(found: Sample) -> list[tuple[str, str]]:
    """Yield, misfits, and how it was checked: a word and a sentence each."""
    said = []
    if found.limit is not None:
        said.append(("yield", yield_sentence(found)))
    if found.misfits:
        said.append(("misfits", f"in {found.misfits} draws parts do not fit beside each other"))
    if found.loose:
        said.append(("loose", f"in {found.loose} draws nothing stops the motion"))
    if found.cut_short:
        said.append(("safe", f"in {found.cut_short} draws the motion is safe but not an optimum"))
    if len(found.value) < found.asked:
        said.append(("stopped", f"after {len(found.value)} of {found.asked} draws"))
    if found.tightest is not None and found.loosest is not None:
        what = unit(found.answer.goals)
        tight, loose = (_end_words(end, what) for end in (found.tightest, found.loosest))
        said.append(
            (
                "bounds",
                f"every part at its tightest of all draws {tight}, at its loosest {loose}; both asked as flex does",
            )
        )
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
