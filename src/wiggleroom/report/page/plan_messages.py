"""Plans as the page reads them."""

from __future__ import annotations

from wiggleroom.planning.plan import Plan
from wiggleroom.report.results.plan_results import plan_facts, plan_title, searched_sentence, step_sentence
from wiggleroom.schema.study_replies import LeavingEntry, PlanReply


def plan_message(found: Plan, command: str) -> PlanReply:
    """How it is taken apart, step by step, and how sure that is."""
    return PlanReply(
        verdict=found.verdict,
        words=plan_title(found),
        facts=plan_facts(found),
        sure=plan_sure(found),
        steps=plan_steps(found),
        remains=list(found.remains),
        command=command,
    )


def plan_steps(found: Plan) -> list[LeavingEntry]:
    """Who moves in every step, and how."""
    return [LeavingEntry(list(step.parts), step_sentence(step)) for step in found.steps]


def plan_sure(found: Plan) -> list[tuple[str, str]]:
    """What a plan rests on and what it took: a word and a sentence each."""
    return [("verdict", plan_title(found)), ("certainty", found.certainty), ("search", searched_sentence(found))]


def plan_options(found: Plan) -> tuple[str, ...]:
    """Options of the command that asks for the same plan."""
    said = [f"--target={name}" for name in found.targets]
    if found.gravity is not None:
        said.append("--gravity=" + ",".join(f"{x:.12g}" for x in found.gravity))
    return tuple(said)
