"""Plans as JSON (`wiggleroom.plan/1`), as a page for the terminal, and in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import STILL, Step
from wiggleroom.report.answer_words import few, number, towards
from wiggleroom.schema.fields import PartMotion
from wiggleroom.schema.results import PlanAssemblyEntry, PlanResult, PlanSearchEntry, PlanStepEntry
from wiggleroom.verdict import Certainty, Separability

if TYPE_CHECKING:
    from rich.console import Group

Floats = NDArray[np.float64]

_COLOURS = {Separability.INTERLOCKED: "green", Separability.COMES_APART: "magenta", Separability.UNKNOWN: "yellow"}
_MOST_STEPS = 40


def plan_result(found: Plan, command: str = "") -> PlanResult:
    """Everything `plan --json` says; lengths in mm, angles in degrees."""
    names = found.assembly.names
    steps = [_step(names, step) for step in found.steps]
    return PlanResult(
        verdict=found.verdict,
        certainty=found.certainty,
        targets=list(found.targets),
        order=[list(parts) for parts in found.order],
        level=list(found.level),
        moves=found.moves,
        steps=steps,
        assembly=[
            PlanAssemblyEntry(step=k + 1, parts=s.parts, path=s.path[::-1], axis=s.axis, held=s.held)
            for k, s in reversed(list(enumerate(steps)))
        ],
        remains=list(found.remains),
        rest=found.rest,
        search=PlanSearchEntry(states=found.states, whole=found.whole, questions=found.questions),
        gap=found.assembly.gap,
        seconds=round(found.seconds, 4),
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def _step(names: tuple[str, ...], step: Step) -> PlanStepEntry:
    shown = np.flatnonzero(step.there & np.any(np.abs(step.way) > STILL, axis=(0, 2)))
    path = [
        {names[k]: PartMotion(float(m[k, 0]), float(m[k, 1]), math.degrees(m[k, 2])) for k in shown} for m in step.way
    ]
    return PlanStepEntry(
        parts=list(step.parts),
        as_one=step.as_one,
        leaves=list(step.leaves),
        moves=step.moves,
        path=path,
        clearance=step.clearance,
        room=step.room,
        turn_room_deg=math.degrees(step.turn_room),
        axis=step.axis,
        held=list(step.held),
    )


def plan_table(found: Plan) -> Group:
    """Page that `plan` prints: the steps one after the other, the level, and how far the search went; fits into 80 columns."""
    from rich.console import Group
    from rich.text import Text

    lines = [Text.assemble((plan_title(found), f"bold {_COLOURS[found.verdict]}"))]
    lines += [Text(f"{k + 1:3}. {step_sentence(step)}") for k, step in enumerate(found.steps[:_MOST_STEPS])]
    if len(found.steps) > _MOST_STEPS:
        lines.append(Text(f"     ... and {len(found.steps) - _MOST_STEPS} more steps; --json has all"))
    lines += [Text(line) for line in plan_facts(found)]
    lines.append(Text(f"seconds: {found.seconds:.2f}, {searched_sentence(found)}", style="dim"))
    return Group(*lines)


def plan_title(found: Plan) -> str:
    """Verdict, moves and gap in one line."""
    gap = f"at gap {number(found.assembly.gap)} mm"
    if found.verdict is Separability.COMES_APART:
        what = f"{few(found.targets)} taken out" if found.targets else "taken apart"
        return f"{what} in {found.moves} move{'s' if found.moves != 1 else ''} {gap}"
    what = f"no way to take out {few(found.targets)}" if found.targets else "no plan"
    sure = "" if found.verdict is Separability.UNKNOWN else f", {found.certainty}"
    return f"{what} {gap}: {found.verdict}{sure}"


def plan_facts(found: Plan) -> list[str]:
    """Level, order and what is left."""
    said = []
    if found.steps:
        said.append(f"level: {'.'.join(map(str, found.level)) or '0'} (moves up to each removal)")
        nearest = min(found.steps, key=lambda s: s.clearance)
        said.append(
            f"least clearance: {number(nearest.clearance, 3)} mm, in step {found.steps.index(nearest) + 1}; every step "
            "checked for overlap"
        )
    if found.remains and found.verdict is Separability.COMES_APART:
        sure = {Separability.INTERLOCKED: "interlocked", Separability.UNKNOWN: "nothing more was found to leave"}
        said.append(f"remains: {few(found.remains)} ({sure.get(found.rest, found.rest)})")
    return said


def step_sentence(step: Step) -> str:
    """Who moves, and how."""
    many = len(step.parts) > 1
    verb = ("leave" if many else "leaves") if step.leaves else ("move" if many else "moves")
    together = " as one" if many and step.as_one else " at the same time" if many else ""
    return f"{few(step.parts)} {verb}{together} {_how(step)}, clearance {number(step.clearance, 3)} mm"


def _how(step: Step) -> str:
    """Directions of the pieces of a step."""
    names = np.flatnonzero(np.any(np.abs(step.way - step.way[:1]) > STILL, axis=(0, 2)))
    pieces = np.diff(step.way[:, names[0]], axis=0)
    if len(pieces) <= 3 and not np.abs(pieces[:, 2]).max() > STILL:
        straight = [
            f"{towards((x, y))}"
            + ("" if step.leaves and k == len(pieces) - 1 else f" by {number(math.hypot(x, y))} mm")
            for k, (x, y, _) in enumerate(pieces.tolist())
            if math.hypot(x, y) > STILL
        ]
        if straight:
            return "in " + ", then ".join(straight)
    return f"on a way of {len(step.way)} points"


def searched_sentence(found: Plan) -> str:
    """How far the search went."""
    said = f"{found.states} state{'s' if found.states != 1 else ''} visited"
    if found.questions:
        said += f", {found.questions} largest motion{'s' if found.questions != 1 else ''} searched"
    if found.verdict is not Separability.COMES_APART and found.certainty is not Certainty.PROVEN:
        said += ", all that slides lead to" if found.whole else ", cut short"
    return said
