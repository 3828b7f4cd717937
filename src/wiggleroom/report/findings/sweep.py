"""How the answer is told: motion against gap."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import UNSET

from wiggleroom.report.finding import Curve, Finding, Panel, Table
from wiggleroom.report.results.answer_words import goals_text, number, rounded_up, unit
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.study_schema import SweepEntry, SweepResult
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from wiggleroom.sensitivity.sweep import Sweep


def finding(found: Sweep, command: str = "") -> Finding:
    """The curve, its numbers, and where it loses its end."""
    answers = {step.gap: step.answer for step in found.steps if step.answer is not None}
    first = min(answers, key=lambda gap: abs(gap - found.assembly.gap)) if answers else None
    bound = [("bound", band_sentence(found))] if has_band(found) else []

    def page() -> dict[str, Any]:
        from wiggleroom.report.page.standalone_page import shown_answer, shown_drawing
        from wiggleroom.report.page.study_messages import step_message

        return {
            "opened": shown_drawing(next(iter(answers.values())).assembly, found.goals),
            "begin": first,
            "answers": shown_answer(answers, command),
            "steps": [step_message(step) for step in found.steps],
            "lost": found.lost,
            "tab": UNSET,
            "said": UNSET,
        }

    return Finding(
        title=f"{goals_text(found.goals)} against the gap",
        record=partial(_record, found, command),
        assembly=found.assembly,
        facts=_facts(found),
        sure=[
            ("loses its end", lost_sentence(found)),
            (
                "found",
                "each gap is searched; what a smaller gap has shown counts too, for parts that became smaller still fit",
            ),
            *bound,
        ],
        sections=(*([Panel("Curve", _curve(found))] if found.steps else []), _table(found)),
        data=_data(found),
        motion=None if first is None else answers[first],
        tab="Gaps",
        code=0 if not found.stopped else 3,
        page=page if answers else None,
    )


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


def _facts(found: Sweep) -> list[str]:
    odd = [s.verdict for s in found.steps if s.verdict in (Verdict.TOUCHING, Verdict.NOT_MAKEABLE)]
    unsure = sum(not s.checked for s in found.steps if s.objective is not None)
    without = f"{len(odd)} {'gap' if len(odd) == 1 else 'gaps'} without room: {', '.join(dict.fromkeys(odd))}"
    return [
        f"{len(found.steps)} gaps",
        lost_sentence(found),
        *([band_sentence(found)] if has_band(found) else []),
        *([without] if odd else []),
        *([f"path not checked at {unsure}"] if unsure else []),
    ]


def _table(found: Sweep) -> Table:
    proven = has_band(found)
    heads = (
        "gap mm",
        f"motion {unit(found.goals)}".rstrip(),
        *(["at most"] if proven else []),
        "per mm of gap",
        "verdict",
        "path",
    )
    rows = []
    for s in found.steps:
        rate = None if s.objective is None or s.gap == 0 else s.objective / s.gap
        most = [None if s.at_most is None else float(rounded_up(s.at_most))] if proven else []
        rows.append((s.gap, s.objective, *most, rate, str(s.verdict), str(PathState.of(s.checked))))
    return Table(heads, rows, "Motion against gap")


def _data(found: Sweep) -> Table:
    proven = has_band(found)
    rows = [(s.gap, s.objective, str(s.verdict), *([s.at_most] if proven else [])) for s in found.steps]
    return Table(("gap", "objective", "verdict", *(["at_most"] if proven else [])), rows)


def _curve(found: Sweep) -> Curve:
    """Motion against gap, with the gap at which the motion loses its end."""
    marks = [] if found.lost is None else [(found.lost[1], f"nothing stops it from {number(found.lost[1])} mm on")]
    return Curve(
        np.array([s.gap for s in found.steps]),
        np.array([np.nan if s.objective is None else s.objective for s in found.steps]),
        ("gap mm", f"motion {unit(found.goals)}".rstrip()),
        marks=marks,
        most=np.array([np.nan if s.at_most is None else s.at_most for s in found.steps]),
    )


def _record(found: Sweep, command: str) -> SweepResult:
    proven = has_band(found)
    return SweepResult(
        dimension=dimension(found.assembly),
        gaps=[
            SweepEntry(s.gap, s.objective, s.verdict, PathState.of(s.checked), s.at_most if proven else UNSET)
            for s in found.steps
        ],
        lost_between=found.lost,
        notes=list(found.assembly.drawing.notes),
        command=command,
    )
