"""Options that mean the same in every command, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group, Parameter

if TYPE_CHECKING:
    from wiggleroom.assembly.model import Assembly
    from wiggleroom.drawing.model import Drawing, Goal

Many = Annotated[tuple[str, ...], Parameter(negative="", show_default=False)]


QUESTION = Group("Drawing and question", sort_key=1)
RESULTS = Group("Results", sort_key=2)
WORK = Group("Where it runs", sort_key=3)
"""Headings under which the help lists what many commands take; what a command alone takes comes first."""


@Parameter(name="*", group=QUESTION)
@dataclass(frozen=True, kw_only=True)
class Asked:
    """What is read, and what is asked of it.

    Parameters
    ----------
    gap
        Clearance across every joint [mm]: every outline moves inward by half of it. In place of the file's.
    unit
        Unit of the drawing, in place of the file's.
    flatten
        Largest distance between a curve and the straight edges that stand for it [mm]. By default gap/50.
    fix
        Parts that stand, by name: A,B. May repeat.
    pull
        A part and the way it is pulled: NAME:+y, NAME:-x, NAME:0.6,0.8, or at a point of it NAME:+y@12,1.
        May repeat; pulls add up.
    turn
        A part that is turned: NAME:ccw or NAME:cw. May repeat; adds to the pulls, in radians.
    objective
        In place of pulls, about all parts: translation, the largest sum of squared translations, or closer, neighbours
        as near each other as they come.
    """

    gap: float | None = None
    unit: Literal["mm", "cm", "m", "in", "px"] | None = None
    flatten: float | None = None
    fix: Many = ()
    pull: Many = ()
    turn: Many = ()
    objective: Literal["translation", "closer"] | None = None


def read(file: str, asked: Asked) -> Assembly:
    """Assembly that a file and the options describe; its notes go to stderr.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    """
    drawing, fixed, wanted = _said(file, asked)
    from wiggleroom.assembly.build import assemble

    return assemble(drawing, gap=asked.gap, fix=fixed, goals=wanted)


def asked_drawing(file: str, asked: Asked) -> Drawing:
    """The same as a drawing, its gap not applied yet: also where parts do not fit beside each other at that gap.

    Raises
    ------
    InputError
        With everything that is wrong with the options and the file, one line each.
    """
    from dataclasses import replace

    from wiggleroom.assembly.statements import statement_findings, unknown
    from wiggleroom.errors import InputError

    drawing, fixed, wanted = _said(file, asked)
    names = {p.name: None for p in drawing.parts}
    parts = tuple(replace(p, fixed=True) if p.name in fixed else p for p in drawing.parts)
    found = replace(drawing, parts=parts, goals=tuple(wanted) or drawing.goals)
    wrong = [f"fix: {unknown(name, names)}" for name in fixed if name not in names] + statement_findings(found)
    if wrong:
        raise InputError(wrong)
    return found


def asked_goals(asked: Asked) -> list[Goal]:
    """What the options ask to be made large.

    Raises
    ------
    InputError
        With everything that is wrong with these and with the numbers among the options, one line each.
    """
    from wiggleroom.cli.asking import goals
    from wiggleroom.drawing.model import WHOLE
    from wiggleroom.errors import InputError

    wrong = [
        f"--{option} {value:g}: it must be {right}"
        for option, value, right in (
            ("gap", asked.gap, "0 or more"),
            ("flatten", asked.flatten, "more than 0"),
        )
        if value is not None and not (math.isfinite(value) and (value > 0 or (value == 0 and option == "gap")))
    ]
    wanted, odd = goals(asked.pull, asked.turn)
    if asked.objective is not None:
        if asked.pull or asked.turn:
            wrong.append(f"--objective {asked.objective} stands in place of --pull and --turn; leave one of them out")
        wanted = [WHOLE[asked.objective]()]
    if wrong or odd:
        raise InputError([*wrong, *odd])
    return wanted


def _said(file: str, asked: Asked) -> tuple[Drawing, list[str], list[Goal]]:
    """What the file says, and the parts that stand and the goals that the options name."""
    from wiggleroom.cli.asking import names
    from wiggleroom.cli.say import note

    wanted = asked_goals(asked)

    from wiggleroom.drawing import read_drawing

    drawing = read_drawing(file, unit=asked.unit, flatten=asked.flatten, gap=asked.gap)
    for line in drawing.notes:
        note(line)
    return drawing, names(asked.fix, {p.name for p in drawing.parts}), wanted
