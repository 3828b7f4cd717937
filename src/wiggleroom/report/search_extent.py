"""How far a search for ways out went, in words."""

from __future__ import annotations

from wiggleroom.disassembly.interlock import Interlock
from wiggleroom.planning.plan import Plan


def extent(found: Interlock | Plan) -> str:
    """States that were visited, those in which parts were turned, and largest motions that were searched."""
    said = _some(found.states, "state") + " visited"
    if found.turned:
        all_ = "in all" if found.turned == found.states and found.whole else f"in {found.turned:,}"
        said += f", parts turned {all_} of them"
    if found.questions:
        said += f", {_some(found.questions, 'largest motion')} searched"
        said += f" ({found.unanswered:,} without an end that is certain)" if found.unanswered else ""
    return said


def _some(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' if count != 1 else ''}" if count else f"no {what}s"
