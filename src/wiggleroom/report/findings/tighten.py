"""How the answer is told: which parts to make tighter."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.report.finding import Finding, Histogram, Panel, PartTints, Table
from wiggleroom.report.results.answer_words import headline, number, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.study_schema import RandomChoices, TightenResult

if TYPE_CHECKING:
    from wiggleroom.sensitivity.tighten import Tightening


CHOSEN_BY = {
    "rank": "by rank, a few at a time: a good choice, not provably the best",
    "draws": "the best of choices at random, which is better than the choice by rank; not provably the best",
    "all": "the best of all choices of as many parts, by climbs; searched",
}


def finding(found: Tightening, command: str = "") -> Finding:
    """The chosen parts, the motion that is left, and how choices at random do."""
    before = found.before
    gap = float(f"{found.gap - before.assembly.gap:.9g}")
    return Finding(
        title=f"{headline(found.after)} with {'these parts' if found.chosen else 'no part'} tighter",
        record=partial(_record, found, command),
        assembly=before.assembly,
        facts=_facts(found),
        sure=_sure(found),
        sections=(_chosen(found), *_panels(found)),
        data=_data(found),
        motion=found.after,
        tints=PartTints(dict.fromkeys(found.chosen, 1.0), legend="made tighter"),
        tab="Tighter",
        code=0 if found.reached and not found.stopped else 3,
        extra=dict.fromkeys(found.chosen, gap),
    )


def _facts(found: Tightening) -> list[str]:
    what, many = unit(found.before.goals), len(found.chosen)
    said = [
        f"instead of {number(found.before.objective or 0.0)} {what}".rstrip(),
        f"{many} {'part' if many == 1 else 'parts'} to a gap of {number(found.gap)} mm",
    ]
    if len(found.random):
        others = "the mean of all such choices" if found.chosen_by == "all" else "as many at random"
        said.append(f"{reduction_text(found.lowered, 0)}; {others}: {_at_random(found, 0)}")
    return said


def _sure(found: Tightening) -> list[tuple[str, str]]:
    """How parts were chosen, and how other choices do: a word and a sentence each."""
    said = [("chosen", CHOSEN_BY[found.chosen_by])] if found.chosen else []
    if found.limit is not None:
        word = "reached" if found.reached else "not reached, though every part that can be is tightened"
        said.append(("limit", f"{number(found.limit)} {unit(found.before.goals)}".rstrip() + f", {word}"))
    if len(found.random):
        other = "all choices" if found.chosen_by == "all" else "at random"
        many = len(found.random) - found.misfits
        said.append((other, f"{_at_random(found, 1)}, mean of {many} choices of as many parts"))
    drawing = found.before.assembly.drawing
    if any(joint.gap > drawing.gap and set(joint.parts) & set(found.chosen) for joint in drawing.gaps):
        said.append(("joints", "those with a larger gap of their own keep what theirs is more"))
    return said


def reduction_text(share: float, places: int) -> str:
    """Say by how much the motion gets less.

    >>> reduction_text(12.34, 0), reduction_text(float("nan"), 1)
    ('12 % less', 'no less')
    """
    return f"{share:.{places}f} % less" if math.isfinite(share) else "no less"


def _at_random(found: Tightening, places: int) -> str:
    """Say what tightening as many parts at random takes away, and how often the parts do not fit then."""
    if found.misfits == len(found.random):
        return "the parts do not fit"
    return reduction_text(found.lowered_at_random, places) + (f" ({found.misfits} do not fit)" if found.misfits else "")


def _moved(found: Tightening) -> list[tuple[int, str, float, float]]:
    """Order, name and motion [mm] before and after of every chosen part."""
    names, axes = found.before.assembly.names, found.before.assembly.dimension
    before, after = (np.linalg.norm(a.motion[:, :axes], axis=1) for a in (found.before, found.after))
    index = [names.index(name) for name in found.chosen]
    return [(n + 1, names[k], float(before[k]), float(after[k])) for n, k in enumerate(index)]


def _chosen(found: Tightening) -> Table:
    rows = [(str(order), name, before, after) for order, name, before, after in _moved(found)]
    heads = ("order", "part", "moved mm before", "after")
    return Table(heads, rows, "Make these tighter, in this order", text="Colour the parts to see which.")


def _data(found: Tightening) -> Table:
    return Table(("order", "part", "moved_before_mm", "moved_after_mm"), _moved(found))


def _panels(found: Tightening) -> tuple[Panel, ...]:
    """How choices at random do."""
    if not len(found.random):
        return ()
    marks = [
        (value, f"{said} {number(value)}")
        for value, said in ((found.after.objective, "these parts"), (found.before.objective, "as it is"))
        if value is not None
    ]
    plot = Histogram(found.random, f"motion {unit(found.before.goals)}".rstrip(), marks)
    return (Panel(f"As many parts at random, {len(found.random)} times", plot),)


def _record(found: Tightening, command: str) -> TightenResult:
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
