"""Answers in space as pages of plain tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.drawing.model import Pull, Turn, Weight
from wiggleroom.report.results.answer_words import (
    certainty,
    few,
    goal_text,
    number,
    rounded_up,
    searched,
    sense_text,
    short,
    solved,
    towards,
    unit,
)
from wiggleroom.report.results.table import columns, fixed
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

    from wiggleroom.spatial.spatial_answer import SpatialAnswer

_MAX_PARTS, _MAX_CONTACTS = 12, 8
_COLOURS = {Verdict.PROVEN: "green", Verdict.OPTIMAL: "green", Verdict.UNBOUNDED: "magenta"}
_SENTENCES = {
    Verdict.OPTIMAL: "the optimality conditions hold, contacts balance the pull",
    Verdict.STATIONARY: "the optimality conditions of first order hold, but there is a direction that curves upwards",
}


def spatial_headline(answer: SpatialAnswer) -> str:
    """Say what was found, in one line, such as "lid moves 0.2 mm in +z"."""
    asked = ", ".join(goal_text(g) for g in answer.goals[:4]) + (" and more" if len(answer.goals) > 4 else "")
    if answer.objective is None:
        return f"nothing stops {asked}"
    if len(answer.goals) == 1:
        goal, value = answer.goals[0], answer.objective / answer.goals[0].weight
        match goal:
            case Pull():
                at = "" if goal.point is None else f" at ({', '.join(number(x) for x in goal.point)})"
                return f"{short(goal.part)}{at} moves {number(value)} mm in {towards(goal.direction)}"
            case Turn():
                return f"{short(goal.part)} turns {number(math.degrees(value))}° {sense_text(goal.sense)}"
            case Weight():
                return f"sum of volume times density times sinking {number(value)}, towards {towards(goal.direction)}"
    return f"{number(answer.objective)}: {asked}"


def spatial_sentence(answer: SpatialAnswer) -> str:
    """Say what the verdict means."""
    return _SENTENCES.get(answer.verdict, answer.verdict.sentence)


def spatial_bound_sentence(answer: SpatialAnswer) -> str:
    """Say what no motion exceeds, and why; or why nothing is known."""
    if answer.at_most is not None:
        return f"{rounded_up(answer.at_most)} {unit(answer.goals)}, as a cross-section shows".replace(" ,", ",")
    return "no bound was found; one is worked out only where all parts are locked to one plane"


def spatial_table(answer: SpatialAnswer) -> Group:
    """Page that `flex` prints: headline, verdict, the parts that move most, what holds them, and how sure it is."""
    from rich.console import Group
    from rich.text import Text

    sentence = spatial_sentence(answer)
    lines = [
        Text(spatial_headline(answer), style="bold"),
        Text.assemble((answer.verdict.value, f"bold {_COLOURS.get(answer.verdict, 'yellow')}"), f": {sentence}"),
    ]
    if answer.leaves:
        lines.append(Text(f"leaves: {few(answer.leaves)}"))
    if answer.turns:
        lines.append(Text(f"turns without limit: {few(answer.turns)}"))
    names, motion = answer.assembly.names, answer.motion
    moved = np.linalg.norm(motion[:, :3], axis=1)
    order = np.argsort(-moved, kind="stable")
    parts = columns("part", "dx mm", "dy mm", "dz mm", "turn deg")
    still = [k for k in order if not motion[k].any()]
    moving = [k for k in order if motion[k].any()]
    farthest = float(moved.max(initial=0.0))
    for k in moving[:_MAX_PARTS]:
        shift = [fixed(x, farthest) for x in motion[k, :3].tolist()]
        parts.add_row(short(names[k]), *shift, f"{math.degrees(answer.turn[k]):.3f}")
    if len(moving) > _MAX_PARTS:
        parts.add_row(f"... and {len(moving) - _MAX_PARTS} more", "", "", "", "", style="dim")
    if still:
        parts.add_row(f"{len(still)} at rest", "", "", "", "", style="dim")
    page: list[RenderableType] = [*lines, Text(), parts, Text()]
    if answer.contacts:
        held = columns("held by", "x mm", "y mm", "z mm", "force")
        for c in answer.contacts[:_MAX_CONTACTS]:
            where = [fixed(x, answer.assembly.size) for x in c.point]
            held.add_row(" | ".join(short(n) for n in c.parts), *where, number(c.force, 3))
        if len(answer.contacts) > _MAX_CONTACTS:
            held.add_row(f"... and {len(answer.contacts) - _MAX_CONTACTS} more", "", "", "", "", style="dim")
        page += [held, Text()]
    spent = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in answer.seconds.items())
    overlap = f"deepest overlap {number(answer.deepest_overlap, 2)} mm"
    most = [] if answer.at_most is None else [f"at most:  {spatial_bound_sentence(answer)}"]
    sure = [
        *most,
        *([f"search:   {searched(answer)}"] if answer.objective is not None else []),
        f"checked:  {certainty(answer)}; {overlap}",
        f"solved:   {solved(answer)}",
        f"seconds:  {spent}",
    ]
    return Group(*page, *[Text(line) for line in sure])
