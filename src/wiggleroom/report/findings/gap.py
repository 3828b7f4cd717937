"""How the answer is told: which gap to draw."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from msgspec import UNSET

from wiggleroom.report.finding import Curve, Finding, Panel, Table
from wiggleroom.report.results.answer_words import goals_text, number, rounded_up, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.gap_schema import GapResult, GapTrial
from wiggleroom.verdict import Certainty, PathState

if TYPE_CHECKING:
    from wiggleroom.sensitivity.gap_trials import AllowableGap, Trial


MAX_TRIALS = 12
"""Rows of the table: the trials nearest the answer."""
GAP_DIGITS = 5
"""Digits of a gap in words."""


def finding(found: AllowableGap, command: str = "") -> Finding:
    """The gap, how sure it is, and everything that was tried."""
    held, apart = found.sides
    near = [t.answer for t in found.trials if t.answer is not None and t.gap == found.gap]
    state = apart or held
    return Finding(
        title=gap_sentence(found),
        record=partial(_record, found, command),
        assembly=found.assembly,
        sure=[*gap_sure(found), *kerf_sentences(found)],
        sections=_sections(found),
        data=_data(found),
        motion=state if state is not None else near[0] if near else None,
        tab="Gap",
        gap=found.gap,
        code=0 if found.gap is not None and not found.stopped else 3,
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
    what = "outline" if found.assembly.dimension == 2 else "face"
    larger = f" with every {what} {limit} mm further out" if found.limit else ""
    return f"smallest gap {gap}: as drawn, not shifted, no parts overlap{larger}"


def gap_sure(found: AllowableGap) -> list[tuple[str, str]]:
    """How sure the answer is, and what lies on its other side: a word and a sentence each."""
    said = []
    if found.gap is not None:
        said.append((str(found.certainty), _certainty(found)))
    if found.beyond is not None:
        said.append(("beyond", _beyond(found, found.beyond)))
    if found.fits_from is not None and found.gap is not None:
        said.append(("fits", f"from {number(found.fits_from, GAP_DIGITS)} mm, as drawn, not shifted"))
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


def kerf_sentences(found: AllowableGap) -> list[tuple[str, str]]:
    """What to set at the cutter, so that the gap comes out; nothing where no kerf is known."""
    gap, kerf = found.gap, found.kerf
    offset = None if kerf is None else found.cut_offset(kerf)
    if gap is None or kerf is None or offset is None:
        return []
    side = "outward" if offset >= 0 else "inward"
    said = [("kerf", f"of {number(kerf)} mm: offset the cut by {number(abs(offset))} mm {side}, drawing as it is")]
    if gap >= kerf:
        lines = f"wiggleroom convert FILE cut.svg --gap {number(gap)} --kerf {number(kerf)}"
        said.append(("or", f"cut along the lines of: {lines}"))
    return said


def _what(found: AllowableGap) -> str:
    return "overlap mm" if found.question == "fits" else f"motion {unit(found.goals)}".rstrip()


def _table(found: AllowableGap) -> Table:
    """Trials nearest the answer, in order of the gap."""
    middle = found.gap if found.gap is not None else found.trials[0].gap
    nearest = sorted(sorted(found.trials, key=lambda t: abs(t.gap - middle))[:MAX_TRIALS], key=lambda t: t.gap)
    rows = [(t.gap, t.value, t.at_most, str(t.verdict)) for t in nearest]
    return Table(("gap mm", _what(found), "at most", "verdict"), rows, "Tried nearest the answer", digits=GAP_DIGITS)


def _data(found: AllowableGap) -> Table:
    rows = [(t.gap, t.value, t.at_most, str(t.verdict), str(PathState.of(t.checked))) for t in found.trials]
    return Table(("gap", "objective", "at_most", "verdict", "path"), rows)


def _sections(found: AllowableGap) -> list[Panel | Table]:
    """What was tried: as a curve, where there is no state to be shown, and as a table."""
    if not found.trials:
        return []
    curve = [] if any(found.sides) else [Panel("Against the gap", _curve(found))]
    return [*curve, *([] if found.question == "holds" else [_table(found)])]


def _curve(found: AllowableGap) -> Curve:
    """Motion, or overlap, against the gap with the crossing marked."""
    marks = [] if found.gap is None else [(found.gap, f"{found.certainty}: {number(found.gap, GAP_DIGITS)} mm")]
    if found.beyond is not None:
        marks.append((found.beyond, f"fails: {number(found.beyond, GAP_DIGITS)} mm"))
    level = (found.limit, f"limit {number(found.limit)}") if found.question == "at most" and found.limit else None
    return Curve(
        np.array([t.gap for t in found.trials]),
        np.array([_finite(t) for t in found.trials]),
        ("gap mm", _what(found)),
        marks,
        level,
    )


def _finite(trial: Trial) -> float:
    return math.nan if trial.value is None or math.isinf(trial.value) else trial.value


def _record(found: AllowableGap, command: str) -> GapResult:
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
        fits_from=UNSET if fits else found.fits_from,
        kerf=UNSET if found.kerf is None else found.kerf,
        offset=UNSET if found.kerf is None else found.cut_offset(found.kerf),
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
