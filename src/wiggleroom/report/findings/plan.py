"""How the answer is told: a plan of taking apart."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from wiggleroom.report.finding import Finding
from wiggleroom.report.findings.check import COLOURS
from wiggleroom.report.results.plan_results import (
    PlanTolerances,
    plan_facts,
    plan_result,
    plan_title,
    searched_sentence,
    step_sentence,
    tolerance_sentences,
)
from wiggleroom.verdict import Separability

if TYPE_CHECKING:
    from wiggleroom.planning.plan import Plan

MAX_STEPS = 40
"""Steps that are listed."""


def finding(found: Plan, told: PlanTolerances, command: str = "") -> Finding:
    """The steps one after the other, the level, and how far the search went."""
    facts = [f"{k + 1:3}. {step_sentence(step)}" for k, step in enumerate(found.steps[:MAX_STEPS])]
    if len(found.steps) > MAX_STEPS:
        facts.append(f"     ... and {len(found.steps) - MAX_STEPS} more steps; --json has all")
    return Finding(
        title=plan_title(found),
        record=partial(plan_result, found, command, told),
        assembly=found.assembly,
        facts=[*facts, *plan_facts(found), *tolerance_sentences(told)],
        sure=[("seconds", f"{found.seconds:.2f}, {searched_sentence(found)}")],
        motion=found,
        code=3 if found.verdict is Separability.UNKNOWN else 0,
        verdict=plan_title(found),
        colour=COLOURS[found.verdict],
    )
