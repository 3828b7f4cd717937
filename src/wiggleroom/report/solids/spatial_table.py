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
from wiggleroom.verdict import Certainty, Separability, Verdict

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.spatial.spatial_answer import SpatialAnswer
    from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly, SpatialEscape

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


def spatial_check_table(found: SpatialDisassembly, border: LargestGap | None = None) -> Group:
    """Page that `check` prints: verdict, who leaves in which order, what remains."""
    from rich.console import Group
    from rich.text import Text

    lines = [
        Text.assemble(
            (found.verdict.value, "bold"), f" at gap {number(found.assembly.gap)} mm: {check_sentence(found)}"
        )
    ]
    for k, escape in enumerate(found.escapes[:_MAX_PARTS]):
        far = escape.path[-1]
        who = [found.assembly.names.index(n) for n in escape.parts]
        along = far[who, :3].mean(axis=0)
        lines.append(Text(f"{k + 1:3}. {few(escape.parts)} in {towards(along.tolist())}"))
    if len(found.escapes) > _MAX_PARTS:
        lines.append(Text(f"     ... and {len(found.escapes) - _MAX_PARTS} more"))
    if found.escapes and len(found.remains) > 1:
        lines.append(Text(f"remains: {few(found.remains)}"))
    if found.verdict is Separability.COMES_APART:
        lines.append(Text("friction, glue and press fit are outside this verdict: it is about shapes alone"))
    if border is not None:
        from wiggleroom.report.results.separability import border_sentence

        lines.append(Text(border_sentence(border), style="bold"))
    lines.append(Text(f"seconds: {found.seconds:.2f}, {found.questions} questions", style="dim"))
    return Group(*lines)


def last_direction(found: SpatialDisassembly, escape: SpatialEscape) -> tuple[float, float, float]:
    """Direction (3,) in which parts leave at last."""
    who = [found.assembly.names.index(n) for n in escape.parts]
    x, y, z = (escape.path[-1, who, :3] - escape.path[-2, who, :3]).mean(axis=0).tolist()
    return x, y, z


def departure_words(found: SpatialDisassembly, escape: SpatialEscape) -> str:
    """Say who leaves and how, such as "lid leaves straight in +z"."""
    way = towards(last_direction(found, escape))
    who = f"{few(escape.parts)} {'leaves' if len(escape.parts) == 1 else 'leave together'}"
    if len(escape.path) == 2:
        return f"{who} straight in {way}"
    return f"{who} on a path of {len(escape.path)} points, at last in {way}"


def check_sentence(found: SpatialDisassembly) -> str:
    """Say what the verdict rests on."""
    if found.verdict is Separability.COMES_APART:
        return "every step of the path checked for overlap"
    if found.verdict is Separability.UNKNOWN:
        return "no path out was found, and not every motion was covered"
    return (
        "proven"
        if found.certainty is Certainty.PROVEN
        else "searched: no path out by slides, turns in place and largest motions; others were not tried"
    )
