"""How the answer is told: worst case within tolerances."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.report.finding import Bars, Finding, Panel, Table
from wiggleroom.report.results.answer_words import goals_text, number, short, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.gap_schema import ContributionEntry, CornerEntry, TolerancesResult
from wiggleroom.verdict import Certainty

if TYPE_CHECKING:
    from wiggleroom.drawing.model import Tolerance
    from wiggleroom.search.answer import Answer
    from wiggleroom.sensitivity.worst_case import WorstCase


MAX_CONTRIBUTIONS = 15
"""Rows that the terminal shows."""


def finding(found: WorstCase, command: str = "") -> Finding:
    """Worst and best, who contributes, and the motion at the worst corner."""
    bars = Bars(
        [tolerance_name(c.tolerance) for c in found.contributions],
        np.array([c.looser for c in found.contributions]),
        "adds to the worst case mm",
    )
    return Finding(
        title=f"{goals_text(found.nominal.goals)} within tolerances: {_moves(found.loosest)} at worst",
        record=partial(_record, found, command),
        assembly=found.assembly,
        sure=_sure(found),
        sections=(Panel("What each adds", bars), _table(found)),
        data=_data(found),
        motion=found.loosest,
        tab="Tolerances",
        code=0 if not found.stopped else 3,
    )


def tolerance_name(tolerance: Tolerance) -> str:
    """What a tolerance is about.

    >>> from wiggleroom.drawing.model import Tolerance
    >>> tolerance_name(Tolerance(("a",), 0.1, 0.1, outline=2)), tolerance_name(Tolerance(("a", "b"), 0.1, 0.1))
    ('a, outline 2', 'a | b')
    """
    name = " | ".join(short(part) for part in tolerance.parts)
    if tolerance.outline is None:
        return name
    return f"{name}, thickness" if tolerance.outline == "thickness" else f"{name}, outline {tolerance.outline}"


def _moves(answer: Answer) -> str:
    if answer.objective is None:
        return "nothing stops it"
    return f"{number(answer.objective)} {unit(answer.goals)}".rstrip()


def _sure(found: WorstCase) -> list[tuple[str, str]]:
    """Nominal, worst and best case, and how sure they are: a word and a sentence each."""
    what = unit(found.nominal.goals)
    said = [("nominal", _moves(found.nominal))]
    most = found.loosest.at_most
    bound = (
        "no further motion was found there, which is no proof"
        if most is None
        else f"proven: at most {number(most)} {what}".rstrip()
    )
    said.append(("worst", f"{_moves(found.loosest)}, everything as loose as allowed; {bound}"))
    if found.tightest is None:
        said.append(("best", f"does not fit: {found.misfit}"))
    else:
        said.append(("best", f"{_moves(found.tightest)}, everything as tight as allowed"))
    sums = f"sum {number(found.first_order)} {what}, root of squares {number(found.root_sum_square)} {what}"
    said.append(("1st order", sums.rstrip()))
    if found.limit is not None:
        kept = "kept" if found.keeps else "not kept"
        sure = "proven" if found.certainty is Certainty.PROVEN else "searched"
        said.append(("limit", f"{number(found.limit)} {what} is {kept} ({sure})"))
    if found.stopped:
        said.append(("stopped", "not everything was worked out in time"))
    return said


def _table(found: WorstCase) -> Table:
    rows = [
        (tolerance_name(c.tolerance), c.tolerance.plus, c.tolerance.minus, c.slope, c.looser, share)
        for c, share in zip(found.contributions, found.percent.tolist(), strict=True)
    ]
    heads = ("tolerance", "+ mm", "- mm", "mm per mm", "adds mm", "%")
    return Table(heads, rows, "Contributions", MAX_CONTRIBUTIONS, text="To first order, one at a time.")


def _data(found: WorstCase) -> Table:
    rows = []
    for share, one in zip(found.percent.tolist(), found.contributions, strict=True):
        t = one.tolerance
        alone = "thickness" if t.outline == "thickness" else "outline"
        kind = "joint" if len(t.parts) == 2 else "part" if t.outline is None else alone
        names = (*t.parts, "")[:2]
        rows.append(
            (
                kind,
                *names,
                t.outline,
                t.nominal,
                t.plus,
                t.minus,
                one.slope,
                one.looser,
                one.tighter,
                share,
            )
        )
    heads = ("kind", "name", "other", "outline", "nominal_mm", "plus_mm", "minus_mm")
    return Table((*heads, "per_mm", "looser_mm", "tighter_mm", "percent"), rows)


def _record(found: WorstCase, command: str) -> TolerancesResult:
    return TolerancesResult(
        dimension=dimension(found.assembly),
        objective=found.nominal.objective,
        worst=_corner(found.loosest),
        best=None if found.tightest is None else _corner(found.tightest),
        misfit=found.misfit,
        first_order=found.first_order,
        root_sum_square=found.root_sum_square,
        limit=found.limit,
        keeps_limit=found.keeps,
        certainty=found.certainty,
        stopped=found.stopped,
        contributions=[
            ContributionEntry(
                parts=list(c.tolerance.parts),
                outline=c.tolerance.outline,
                nominal=c.tolerance.nominal,
                plus=c.tolerance.plus,
                minus=c.tolerance.minus,
                mm_per_mm=c.slope,
                looser=c.looser,
                tighter=c.tighter,
                percent=share,
            )
            for c, share in zip(found.contributions, found.percent.tolist(), strict=True)
        ],
        notes=list(found.nominal.assembly.drawing.notes),
        command=command,
    )


def _corner(answer: Answer) -> CornerEntry:
    return CornerEntry(
        objective=answer.objective,
        at_most=answer.at_most,
        verdict=answer.verdict,
        path=answer.path,
    )
