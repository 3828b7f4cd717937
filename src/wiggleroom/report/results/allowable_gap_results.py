"""The gap that answers a maker's question, as JSON and as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec import UNSET

from wiggleroom.report.results.answer_words import goals_text, number, rounded_up, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.report.results.table import columns
from wiggleroom.schema.gap_schema import GapResult, GapTrial
from wiggleroom.sensitivity.gap_trials import AllowableGap, Trial
from wiggleroom.verdict import Certainty, PathState

if TYPE_CHECKING:
    from rich.console import Group

MAX_TRIALS = 12
"""Rows of the table: the trials nearest the answer."""
GAP_DIGITS = 5
"""Digits of a gap in words."""


def gap_result(found: AllowableGap, command: str = "", kerf: float | None = None) -> GapResult:
    """Everything `gap --json` says."""
    fits = found.question == "fits"
    return GapResult(
        dimension=dimension(found.assembly),
        question=found.question,
        limit=found.limit,
        gap=found.gap,
        certainty=found.certainty,
        beyond=found.beyond,
        searched_gap=found.searched_gap,
        proven_gap=found.proven_gap,
        stopped=found.stopped,
        note=found.why,
        kerf=UNSET if kerf is None else kerf,
        offset=UNSET if kerf is None else found.cut_offset(kerf),
        trials=[
            GapTrial(
                gap=t.gap,
                objective=UNSET if fits else t.value,
                overlap=t.value if fits else UNSET,
                at_most=t.at_most,
                verdict=str(t.verdict),
                path=PathState.of(t.checked),
            )
            for t in found.trials
        ],
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def gap_sentence(found: AllowableGap) -> str:
    """Answer in one line."""
    what, limit = unit(found.goals), number(found.limit or 0.0)
    if found.gap is None:
        return f"no gap: {found.why}"
    gap = f"{number(found.gap, GAP_DIGITS)} mm"
    match found.question:
        case "at most":
            return f"largest gap {gap}: {goals_text(found.goals)} stays below {limit} {what}".rstrip()
        case "holds":
            return f"largest gap {gap}: interlocked"
    larger = f" with every outline {limit} mm larger" if found.limit else ""
    return f"smallest gap {gap}: as drawn, not shifted, no parts overlap{larger}"


def gap_sure(found: AllowableGap) -> list[tuple[str, str]]:
    """How sure the answer is, and what lies on its other side: a word and a sentence each."""
    said = []
    if found.gap is not None:
        said.append((str(found.certainty), _certainty(found)))
    if found.beyond is not None:
        said.append(("beyond", _beyond(found, found.beyond)))
    proven, searched = found.proven_gap, found.searched_gap
    if found.question == "at most" and found.certainty is Certainty.SEARCHED:
        lower = "no gap was proven" if proven is None else f"proven up to {number(proven, GAP_DIGITS)} mm"
        said.append(("proof", lower))
    elif found.question == "at most" and searched is not None and searched != found.gap:
        said.append(("searched", f"nothing further was found up to {number(searched, GAP_DIGITS)} mm either"))
    if found.why and found.gap is not None:
        said.append(("note", found.why))
    if found.stopped:
        said.append(("stopped", "before both sides lay near each other; more --time brings them nearer"))
    return said


def _certainty(found: AllowableGap) -> str:
    trial = next((t for t in found.trials if t.gap == found.gap), None)
    match found.question:
        case "at most" if found.certainty is Certainty.PROVEN and trial is not None and trial.at_most is not None:
            return f"no motion at this gap is worth more than {rounded_up(trial.at_most)}"
        case "at most":
            return "no further motion was found at this gap, searched as flex does, which is no proof"
        case "holds":
            return (
                "every path out is closed"
                if found.certainty is Certainty.PROVEN
                else "no path out was found, which is no proof"
            )
    return "by exact geometry, of the parts where they are drawn; shifted, they may fit at a smaller gap"


def _beyond(found: AllowableGap, gap: float) -> str:
    trial = next((t for t in found.trials if t.gap == gap), None)
    at = f"at {number(gap, GAP_DIGITS)} mm"
    match found.question:
        case "at most":
            value = None if trial is None else trial.value
            moves = (
                "nothing stops it" if value is None or math.isinf(value) else f"it moves {number(value, GAP_DIGITS)}"
            )
            return f"{at} {moves}, along a path that was checked"
        case "holds":
            return f"{at} it comes apart, along a path that was checked"
    return f"{at} parts overlap by {number(trial.value or 0.0, 3)} mm" if trial else at


def kerf_sentences(found: AllowableGap, kerf: float) -> list[str]:
    """What to set at the cutter, so that the gap comes out."""
    offset = found.cut_offset(kerf)
    if found.gap is None or offset is None:
        return []
    side = "outward" if offset >= 0 else "inward"
    lines = [f"with a kerf of {number(kerf)} mm: offset the cut by {number(abs(offset))} mm {side}, drawing as it is"]
    if found.gap >= kerf:
        lines.append(
            f"or cut along the lines of: wiggleroom convert FILE cut.svg --gap {number(found.gap)} --kerf {number(kerf)}"
        )
    return lines


def gap_table(found: AllowableGap, kerf: float | None = None) -> Group:
    """Page that `gap` prints."""
    from rich.console import Group
    from rich.text import Text

    lines = [Text(gap_sentence(found), style="bold")]
    lines += [Text(f"{term + ':':<10} {said}") for term, said in gap_sure(found)]
    lines += [] if kerf is None else [Text(line) for line in kerf_sentences(found, kerf)]
    if found.question == "holds" or not found.trials:
        return Group(*lines)
    what = "overlap mm" if found.question == "fits" else f"motion {unit(found.goals)}".rstrip()
    rows = columns("gap mm", what, "at most", "verdict")
    for t in _nearest(found):
        value = "" if t.value is None or math.isinf(t.value) else number(t.value, GAP_DIGITS)
        rows.add_row(
            number(t.gap, GAP_DIGITS), value, "" if t.at_most is None else number(t.at_most, GAP_DIGITS), str(t.verdict)
        )
    return Group(*lines, Text(), rows)


def _nearest(found: AllowableGap) -> list[Trial]:
    """Trials nearest the answer, in order of the gap."""
    middle = found.gap if found.gap is not None else found.trials[0].gap
    return sorted(sorted(found.trials, key=lambda t: abs(t.gap - middle))[:MAX_TRIALS], key=lambda t: t.gap)


def gap_facts(found: AllowableGap) -> list[str]:
    """Facts under the title."""
    return [f"{term}: {said}" for term, said in gap_sure(found)]
