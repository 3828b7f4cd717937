"""How the answer is told: the largest motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.drawing.model import part_of
from wiggleroom.report.finding import Cell, Finding, Table
from wiggleroom.report.results.answer_words import (
    bound_sentence,
    certainty,
    force_bearing_contacts,
    goal_text,
    headline,
    number,
    proven,
    searched,
    short,
    solved,
    verdict_sentence,
)
from wiggleroom.report.results.json_results import flex_result
from wiggleroom.report.results.table import fixed
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.search.answer import Answer

MAX_PARTS = 12
"""Rows of the table of parts, those that move furthest."""
MAX_CONTACT_ROWS = 8
"""Rows of the table of contacts."""
COLOURS = {
    Verdict.PROVEN: "green",
    Verdict.OPTIMAL: "green",
    Verdict.STATIONARY: "yellow",
    Verdict.UNBOUNDED: "magenta",
    Verdict.STOPPED: "yellow",
}


def finding(answer: Answer) -> Finding:
    """Headline, verdict, the parts that move most, what holds them, and how sure it is."""
    facts = [f"{answer.verdict}: {verdict_sentence(answer)}"]
    if answer.objective is not None and len(answer.goals) > 1:
        facts += [f"  {goal_text(goal)}, weight {number(goal.weight)}" for goal in answer.goals]
    if answer.leaves:
        facts.append(f"leaves: {', '.join(answer.leaves)}")
    if answer.turns:
        facts.append(f"turns without limit: {', '.join(answer.turns)}")
    return Finding(
        title=headline(answer),
        record=partial(flex_result, answer),
        assembly=answer.assembly,
        facts=facts,
        sure=_sure(answer),
        sections=(_parts(answer), _contacts(answer)),
        motion=answer,
        code=3 if answer.verdict is Verdict.STOPPED else 0,
        verdict=answer.verdict,
        colour=COLOURS[answer.verdict],
    )


def _parts(answer: Answer) -> Table:
    """Parts moved most, the pulled ones always among them and first."""
    asked, axes = {part_of(goal) for goal in answer.goals}, answer.assembly.dimension
    names, shift, turn = answer.assembly.names, answer.motion[:, :axes], answer.motion[:, axes:]
    moved = np.linalg.norm(shift, axis=1).tolist()
    turned = np.degrees(turn[:, 0] if axes == 2 else np.linalg.norm(turn, axis=1)).tolist()
    farthest = max(moved)
    order = sorted(range(len(names)), key=lambda k: (names[k] not in asked, -round(moved[k], 9), k))
    moves = (answer.motion != 0).any(axis=1).tolist()
    still = len(names) - sum(moves)
    rows: list[tuple[Cell, ...]] = [
        (names[k], *(fixed(x, farthest) for x in shift[k].tolist()), f"{turned[k]:.3f}") for k in order if moves[k]
    ]
    heads = ("part", *(f"d{axis} mm" for axis in "xyz"[:axes]), "turn deg")
    foot = f"{still} at rest" if still else ""
    strong = [name for name in asked if name is not None]
    return Table(heads, rows, "Parts", MAX_PARTS, foot=foot, strong=strong)


def _contacts(answer: Answer) -> Table:
    """Contacts that hold the motion, largest force first."""
    size = answer.assembly.size
    rows: list[tuple[Cell, ...]] = [
        (" | ".join(short(n) for n in c.parts), *(fixed(x, size) for x in c.point), number(c.force, 3))
        for c in force_bearing_contacts(answer.contacts)
    ]
    heads = ("held by", *(f"{axis} mm" for axis in "xyz"[: answer.assembly.dimension]), "force")
    return Table(heads, rows, "Held by", MAX_CONTACT_ROWS)


def _sure(answer: Answer) -> list[tuple[str, str]]:
    """How sure the answer is, and what it cost: a word and a sentence each."""
    in_space, said = answer.assembly.dimension == 3, []
    if answer.bound is not None and answer.bound.kind == "quick" and not answer.bound.why:
        said.append(("truth", f"{proven(answer)}, a quick bound; --prove 0.01 brings it nearer"))
    elif answer.at_most is not None:
        said.append(("truth", proven(answer)) if answer.bound or not in_space else ("at most", bound_sentence(answer)))
    if answer.search is not None or (in_space and answer.objective is not None):
        said.append(("search", searched(answer)))
    said.append(("checked", f"{certainty(answer)}; deepest overlap {number(answer.deepest_overlap, 2)} mm"))
    said.append(("solved", solved(answer)))
    spent = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in answer.seconds.items())
    return [*said, ("seconds", spent)] if spent else said
