"""Options that mean the same in every command, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group, Parameter

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.assembly.inventory import InventoryRow
    from wiggleroom.deadline import Deadline
    from wiggleroom.drawing.model import Drawing, Goal
    from wiggleroom.drawing.outlines.traced_outlines import Remark
    from wiggleroom.drawing.strokes.read_options import ReadOptions

Many = Annotated[tuple[str, ...], Parameter(negative="", show_default=False)]


QUESTION = Group("Drawing and question", sort_key=1)
RESULTS = Group("Results", sort_key=2)
WORK = Group("Time and processes", sort_key=3)
"""Headings under which the help lists what many commands take; what a command alone takes comes first."""


@Parameter(name="*", group=QUESTION)
@dataclass(frozen=True, kw_only=True)
class QuestionOptions:
    """What is read, and what is asked of it.

    Parameters
    ----------
    gap
        Clearance across every joint [mm]: every outline moves inward by half of it. Replaces the file's gap.
    unit
        Unit of the drawing. Replaces the file's.
    dpi
        Units of the drawing per inch, such as 90 or 72. Replaces the file's.
    flatten
        Largest distance between a curve and its polygon [mm], at every gap. Default: gap/50; without a gap 1e-4 of the
        median part size.
    fix
        Fixed parts, by name: A,B, or by a point of the part in mm: @12,30. May repeat.
    pull
        A part and its pull: NAME:+y, NAME:-x, NAME:0.6,0.8, or at a point NAME:+y@12,1; in space NAME:+z,
        NAME:0,0.6,0.8, NAME:+z@12,1,3. May repeat; pulls add up.
    turn
        A part to turn: NAME:ccw or NAME:cw; in space NAME:+z, right-handed about a direction. May repeat; adds to the
        pulls, in radians.
    objective
        Replaces pulls. translation: the largest sum of squared translations of all parts. closer: neighbours as near
        each other as possible.
    weight
        In space: direction of weight, such as -z. Pulls every part at its centroid by volume times density, in addition
        to the pulls.
    only
        Read only these layers, colours or names of a drawing: A,B. May repeat.
    skip
        Leave out these layers, colours or names: A,B. May repeat.
    join
        Join open ends nearer than this [mm]. Default: the smaller of 0.05 mm and a hundredth of the shortest line.
    solid
        Outlines inside others to read as parts, not holes: NAME, @x,y for the one around a point, or all. May repeat.
    hole
        Outlines to cut out of the parts around or under them: NAME, @x,y or all. May repeat.
    ignore
        Two parts that never collide, such as stacked sheets: A,B. May repeat.
    glue
        Parts that move as one: A,B,C. May repeat.
    gap_of
        The gap of one joint [mm]: A,B:0.3. May repeat.
    """

    gap: float | None = None
    unit: Literal["mm", "cm", "m", "in", "px", "pt"] | None = None
    dpi: float | None = None
    flatten: float | None = None
    fix: Many = ()
    pull: Many = ()
    turn: Many = ()
    objective: Literal["translation", "closer"] | None = None
    weight: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None
    only: Many = ()
    skip: Many = ()
    join: float | None = None
    solid: Many = ()
    hole: Many = ()
    ignore: Many = ()
    glue: Many = ()
    gap_of: Many = ()

    @property
    def length_unit(self) -> str | None:
        """Unit of the drawing that the options say, by name or by units an inch."""
        from wiggleroom.drawing.units import unit_of

        return unit_of(self.unit, self.dpi)


def read_options(asked: QuestionOptions) -> ReadOptions:
    """How a drawing is read; parts that are fixed or pulled are parts wherever they lie."""
    from wiggleroom.cli.asking import goals, split_words
    from wiggleroom.drawing.model import part_of
    from wiggleroom.drawing.strokes.read_options import ReadOptions

    named = [part_of(goal) for goal in goals(asked.pull, asked.turn)[0]]
    return ReadOptions(
        only=tuple(split_words(asked.only)),
        skip=tuple(split_words(asked.skip)),
        join=asked.join,
        solid=(*split_words(asked.solid), *split_words(asked.fix), *(name for name in named if name)),
        hole=tuple(split_words(asked.hole)),
    )


def read(file: str, asked: QuestionOptions, stop: Deadline | None = None, *, overlapping: bool = False) -> Assembly:
    """Assembly that a file and the options describe; its notes, and what looks odd about it, go to stderr.

    Parts may overlap where that is said.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    KeyboardInterrupt
        After Ctrl-C, or once the time of `stop` is over.
    """
    from wiggleroom.cli.say import note
    from wiggleroom.cli.watch import at_once

    with at_once(stop):
        drawing, fixed, wanted = _read_with_roles(file, asked)
        from wiggleroom.assembly.build import assemble, with_notes

        assembly = with_notes(assemble(drawing, gap=asked.gap, fix=fixed, goals=wanted, overlapping=overlapping))
    for line in assembly.drawing.notes[len(drawing.notes) :]:
        note(line)
    return assembly


@dataclass(frozen=True, eq=False)
class InspectedFile:
    """A file as it was read, whether or not it can be worked with.

    Parameters
    ----------
    assembly : Assembly
        Parts as made; as drawn where the gap cannot be applied.
    rows : tuple of InventoryRow
        Parts as drawn.
    remarks : tuple of Remark
        Places of what is wrong, left out or assumed.
    findings : tuple of str
        What is wrong, one line each.
    """

    assembly: Assembly
    rows: tuple[InventoryRow, ...]
    remarks: tuple[Remark, ...]
    findings: tuple[str, ...]


def inspect_file(file: str, asked: QuestionOptions) -> InspectedFile:
    """Read a file with all that is wrong with it.

    Raises
    ------
    InputError
        Where there is nothing to see, or an option names no part.
    """
    from dataclasses import replace

    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.assembly.build import with_notes
    from wiggleroom.assembly.findings import examine
    from wiggleroom.assembly.inventory import inventory
    from wiggleroom.assembly.statements import unknown
    from wiggleroom.drawing.read import reading
    from wiggleroom.errors import InputError

    wanted = goals_of_options(asked)
    found = reading(file, unit=asked.length_unit, flatten=asked.flatten, gap=asked.gap, options=read_options(asked))
    drawing, fixed, goals = with_roles(found.drawing, asked, wanted) if found.drawing.parts else (found.drawing, [], [])
    names = [p.name for p in drawing.parts]
    wrong = [f"fix: {unknown(name, names)}" for name in fixed if name not in names]
    if wrong:
        raise InputError(wrong)
    parts = tuple(replace(p, fixed=True) if p.name in fixed else p for p in drawing.parts)
    gap = drawing.gap if asked.gap is None else asked.gap
    used = replace(drawing, parts=parts, gap=gap, goals=tuple(goals) or drawing.goals)
    made, findings = examine(used) if parts else ((), ())
    shown = made if len(made) == len(parts) else tuple(p for p in parts if p.regions)
    assembly = with_notes(Assembly(shown, used)) if not findings else Assembly(shown, used)
    return InspectedFile(assembly, inventory(used, found.layers), found.remarks, (*found.findings, *findings))


def asked_drawing(file: str, asked: QuestionOptions) -> Drawing:
    """The same as a drawing, its gap not applied yet: also where parts do not fit beside each other at that gap.

    Raises
    ------
    InputError
        With everything that is wrong with the options and the file, one line each.
    """
    from dataclasses import replace

    from wiggleroom.assembly.statements import statement_findings, unknown
    from wiggleroom.errors import InputError

    drawing, fixed, wanted = _read_with_roles(file, asked)
    names = {p.name: None for p in drawing.parts}
    parts = tuple(replace(p, fixed=True) if p.name in fixed else p for p in drawing.parts)
    found = replace(drawing, parts=parts, goals=tuple(wanted) or drawing.goals)
    wrong = [f"fix: {unknown(name, names)}" for name in fixed if name not in names] + statement_findings(found)
    if wrong:
        raise InputError(wrong)
    return found


def _read_with_roles(file: str, asked: QuestionOptions) -> tuple[Drawing, list[str], list[Goal]]:
    """What the file says, and the parts that stand and the goals that the options name."""
    from wiggleroom.assembly.inventory import size_lines
    from wiggleroom.cli.say import note
    from wiggleroom.drawing import read_drawing
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.errors import InputError

    if is_spatial_file(file):
        answering = "flex, check, plan, gap, clearances, rank, tighten, sweep, sample, tolerances, draw and parts"
        message = f"{file}: is an assembly in space, which {answering} take; this command is for drawings"
        raise InputError(message)
    wanted = goals_of_options(asked)
    drawing = read_drawing(
        file, unit=asked.length_unit, flatten=asked.flatten, gap=asked.gap, options=read_options(asked)
    )
    for line in (*size_lines(drawing), *drawing.notes):
        note(line)
    return with_roles(drawing, asked, wanted)


def goals_of_options(asked: QuestionOptions) -> list[Goal]:
    """Goals that the options name; what is wrong with any option is told at once."""
    from wiggleroom.cli.asking import goals
    from wiggleroom.drawing.model import WHOLE
    from wiggleroom.errors import InputError

    wrong = [
        f"--{option} {value:g}: it must be {right}"
        for option, value, right in (
            ("gap", asked.gap, "0 or more"),
            ("join", asked.join, "0 or more"),
            ("flatten", asked.flatten, "more than 0"),
        )
        if value is not None and not (math.isfinite(value) and (value > 0 or (value == 0 and option != "flatten")))
    ]
    if asked.weight is not None:
        wrong.append("--weight is for assemblies in space; use --pull")
    wanted, odd = goals(asked.pull, asked.turn)
    if asked.objective is not None:
        if asked.pull or asked.turn:
            wrong.append(f"--objective {asked.objective} stands in place of --pull and --turn; leave one of them out")
        wanted = [WHOLE[asked.objective]()]
    if wrong or odd:
        raise InputError([*wrong, *odd])
    return wanted


def with_roles(drawing: Drawing, asked: QuestionOptions, wanted: list[Goal]) -> tuple[Drawing, list[str], list[Goal]]:
    """Drawing with what the options glue, ignore and give a gap; the parts that stand, and the goals, by name.

    Raises
    ------
    InputError
        With one line for every option that cannot be read, or point that lies in no part.
    """
    from dataclasses import replace

    from wiggleroom.assembly.statements import PartNames
    from wiggleroom.cli.asking import group_findings, joint_gaps, names
    from wiggleroom.drawing.model import part_of
    from wiggleroom.errors import InputError

    known = PartNames(drawing)
    members = {p.name for p in drawing.parts}
    glued = [tuple(map(known, names([text], members))) for text in asked.glue]
    ignored = [tuple(map(known, names([text], members))) for text in asked.ignore]
    gaps, wrong = joint_gaps(asked.gap_of, members, known)
    fixed = [known(name) for name in names(asked.fix, members)]
    goals = [goal if (name := part_of(goal)) is None else replace(goal, part=known(name)) for goal in wanted]  # type: ignore[arg-type]
    wrong += group_findings(asked.glue, glued, asked.ignore, ignored)
    if wrong or known.wrong:
        raise InputError([*wrong, *known.wrong])
    asked_pairs = {frozenset(gap.parts) for gap in gaps}
    used = replace(
        drawing,
        glue=(*drawing.glue, *glued),
        ignore=(*drawing.ignore, *((group[0], group[1]) for group in ignored)),
        gaps=(*(joint for joint in drawing.gaps if frozenset(joint.parts) not in asked_pairs), *gaps),
    )
    return used, fixed, goals
