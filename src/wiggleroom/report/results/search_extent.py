"""How far a search for escape paths went, in words and as JSON."""

from __future__ import annotations

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.planning.plan import Plan
from wiggleroom.schema.disassembly_schema import StateSearchEntry


def extent_text(found: Interlock | Plan) -> str:
    """Words for the states that were visited, those in which parts were turned, and the largest motions that were searched."""
    said = []
    if found.states > 1:
        said.append(f"{found.states:,} states visited")
        if found.turned:
            all_ = found.turned == found.states and found.whole
            said.append("parts turned in all of them" if all_ else f"parts turned in {found.turned:,} of them")
    count = found.questions
    without = f" ({found.unanswered:,} without an end that is certain)" if found.unanswered else ""
    said.append(f"{count or 'no'} largest motion{'s' if count > 1 else ''} searched{without}")
    return ", ".join(said)


def search_entry(found: Interlock | Plan) -> StateSearchEntry:
    """The same as JSON."""
    return StateSearchEntry(
        states=found.states,
        turned=found.turned,
        whole=found.whole,
        questions=found.questions,
        unanswered=found.unanswered,
    )
