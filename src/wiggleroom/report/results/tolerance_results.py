"""Worst case within tolerances, as JSON and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wiggleroom.drawing.model import Tolerance
from wiggleroom.report.results.answer_words import goals_text, number, short, unit
from wiggleroom.report.results.table import columns
from wiggleroom.schema.gap_schema import ContributionEntry, CornerEntry, TolerancesResult
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.worst_case import WorstCase
from wiggleroom.verdict import Certainty

if TYPE_CHECKING:
    from rich.console import Group

MAX_CONTRIBUTIONS = 15
"""Rows of the table."""


def tolerances_result(found: WorstCase, command: str = "") -> TolerancesResult:
    """Everything `tolerances --json` says."""
    return TolerancesResult(
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


def tolerance_name(tolerance: Tolerance) -> str:
    """What a tolerance is about.

    >>> tolerance_name(Tolerance(("a",), 0.1, 0.1, outline=2)), tolerance_name(Tolerance(("a", "b"), 0.1, 0.1))
    ('a, outline 2', 'a | b')
    """
    name = " | ".join(short(part) for part in tolerance.parts)
    return name if tolerance.outline is None else f"{name}, outline {tolerance.outline}"


def _moves(answer: Answer) -> str:
    if answer.objective is None:
        return "nothing stops it"
    return f"{number(answer.objective)} {unit(answer.goals)}".rstrip()


def tolerances_sentence(found: WorstCase) -> str:
    """Answer in one line."""
    return f"{goals_text(found.nominal.goals)} within tolerances: {_moves(found.loosest)} at worst"


def tolerances_sure(found: WorstCase) -> list[tuple[str, str]]:
    """Nominal, worst and best case, and how sure they are: a word and a sentence each."""
    what = unit(found.nominal.goals)
    said = [("nominal", _moves(found.nominal))]
    most = found.loosest.at_most
    bound = (
        "no further motion was found there, which is no proof"
        if most is None
        else f"proven: at most {number(most)} {what}".rstrip()
    )
    said.append(("worst", f"{_moves(found.loosest)}, every outline as far in as allowed; {bound}"))
    if found.tightest is None:
        said.append(("best", f"does not fit: {found.misfit}"))
    else:
        said.append(("best", f"{_moves(found.tightest)}, every outline as far out as allowed"))
    sums = f"sum {number(found.first_order)} {what}, root of squares {number(found.root_sum_square)} {what}"
    said.append(("1st order", sums.rstrip()))
    if found.limit is not None:
        kept = "kept" if found.keeps else "not kept"
        sure = "proven" if found.certainty is Certainty.PROVEN else "searched"
        said.append(("limit", f"{number(found.limit)} {what} is {kept} ({sure})"))
    if found.stopped:
        said.append(("stopped", "not everything was worked out in time"))
    return said


def tolerances_facts(found: WorstCase) -> list[str]:
    """Facts under the title."""
    return [f"{term}: {said}" for term, said in tolerances_sure(found)]


def tolerances_table(found: WorstCase) -> Group:
    """Page that `tolerances` prints."""
    from rich.console import Group
    from rich.text import Text

    rows = columns("tolerance", "+ mm", "- mm", "mm per mm", "adds mm", "%")
    for share, c in list(zip(found.percent.tolist(), found.contributions, strict=True))[:MAX_CONTRIBUTIONS]:
        t = c.tolerance
        rows.add_row(
            tolerance_name(t), number(t.plus), number(t.minus), number(c.slope, 3), number(c.looser, 3), f"{share:.1f}"
        )
    more = len(found.contributions) - MAX_CONTRIBUTIONS
    return Group(
        Text(tolerances_sentence(found), style="bold"),
        *[Text(f"{term + ':':<9} {said}") for term, said in tolerances_sure(found)],
        Text(),
        rows,
        *([Text(f"and {more} smaller ones; --csv has all")] if more > 0 else []),
    )
