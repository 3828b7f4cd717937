"""How the answer is told: whether it comes apart."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from wiggleroom.report.finding import Finding
from wiggleroom.report.results.answer_words import few, number
from wiggleroom.report.results.separability import border_sentence, check_result, extent_text, leaves, remains, why
from wiggleroom.verdict import Separability

if TYPE_CHECKING:
    from wiggleroom.report.results.separability import Checked

MAX_ESCAPES = 12
"""Escapes that are listed."""
CODES = {Separability.INTERLOCKED: 0, Separability.COMES_APART: 1, Separability.UNKNOWN: 3}
COLOURS = {Separability.INTERLOCKED: "green", Separability.COMES_APART: "magenta", Separability.UNKNOWN: "yellow"}


def finding(checked: Checked, command: str = "") -> Finding:
    """Verdict, who leaves in which order, what spins and what remains."""
    found, border = checked.found, checked.border
    facts = [f"{k + 1:3}. {leaves(found, escape)}" for k, escape in enumerate(found.escapes[:MAX_ESCAPES])]
    if len(found.escapes) > MAX_ESCAPES:
        facts.append(f"     ... and {len(found.escapes) - MAX_ESCAPES} more")
    if found.escapes and len(found.remains) > 1:
        facts.append(remains(found))
    if found.spins:
        facts.append(f"turns in place without limit: {few(found.spins)}")
    if found.verdict is Separability.COMES_APART and found.assembly.dimension == 3:
        facts.append("friction, glue and press fit are outside this verdict: it is about shapes alone")
    if border is not None:
        facts.append(border_sentence(border))
    spent = f"{found.seconds:.2f}" + (" without the largest gap" if border is not None else "")
    tried = f", {extent_text(found)}" if found.questions or found.states > 1 else ""
    return Finding(
        title=f"{found.verdict} at gap {number(found.assembly.gap)} mm: {why(found)}",
        record=partial(check_result, found, border, command),
        assembly=found.assembly,
        facts=facts,
        sure=[("seconds", f"{spent}{tried}")],
        motion=checked,
        code=CODES[found.verdict],
        verdict=found.verdict,
        colour=COLOURS[found.verdict],
    )
