"""The commands for assemblies in space, files of format wiggleroom/2."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.cli.sheet_options import SheetOptions
    from wiggleroom.deadline import Deadline
    from wiggleroom.drawing.model import Drawing

_OF_DRAWINGS = ("unit", "dpi", "flatten", "only", "skip", "join", "solid", "hole")
"""Options that say how a drawing is read; all but `flatten` go with a cutting sheet, too."""


def read_in_space(
    file: str,
    asked: QuestionOptions,
    sheet: SheetOptions | None = None,
    stop: Deadline | None = None,
    *,
    overlapping: bool = False,
) -> Assembly:
    """Spatial assembly that a file, or a cutting sheet, and the options describe; its notes go to stderr.

    Plates of a sheet may press on each other where that is said.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    UnsureError
        Where it is not sure how the panels of a sheet go together.
    """
    from wiggleroom.cli.say import note
    from wiggleroom.cli.watch import at_once
    from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

    drawing = draw_in_space(file, asked, sheet, stop, overlapping=overlapping)
    with at_once(stop):
        found = assemble_spatial(drawing, gap=asked.gap, overlapping=overlapping)
    for line in found.drawing.notes[len(drawing.notes) :]:
        note(line)
    return found


def draw_in_space(
    file: str,
    asked: QuestionOptions,
    sheet: SheetOptions | None = None,
    stop: Deadline | None = None,
    *,
    overlapping: bool = False,
) -> Drawing:
    """Parts as a file, or a cutting sheet, and the options describe them; its notes go to stderr.

    Plates of a sheet may press on each other where that is said.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    UnsureError
        Where it is not sure how the panels of a sheet go together.
    """
    from wiggleroom.assembly.statements import unknown
    from wiggleroom.cli.asking import goals, group_findings, joint_gaps, names
    from wiggleroom.cli.say import note
    from wiggleroom.cli.watch import at_once
    from wiggleroom.drawing.model import WHOLE
    from wiggleroom.errors import InputError

    asked_for, wrong = goals(asked.pull, asked.turn, asked.weight, dimension=3)
    if asked.objective is not None:
        if asked_for:
            wrong.append(
                f"--objective {asked.objective} stands in place of --pull, --turn and --weight; leave one of them out"
            )
        asked_for = [WHOLE[asked.objective]()]
    if asked.gap is not None and not (math.isfinite(asked.gap) and asked.gap >= 0):
        wrong.append(f"--gap {asked.gap:g}: it must be 0 or more")
    drawn = sheet is not None and sheet.given
    for option in _OF_DRAWINGS:
        if getattr(asked, option) not in (None, ()) and not (drawn and option != "flatten"):
            wrong.append(
                f"--{option.replace('_', '-')} is for parts in the plane; {file} is asked in space: leave it out"
            )
    if wrong:
        raise InputError(wrong)
    from wiggleroom.spatial.solids.spatial_file import read_spatial

    if sheet is not None and sheet.given:
        from wiggleroom.cli.options import read_options
        from wiggleroom.cli.sheet_options import assembled_sheet, sure_text

        found = assembled_sheet(
            file, sheet, unit=asked.length_unit, options=read_options(asked), stop=stop, overlapping=overlapping
        )
        drawing = replace(read_spatial(sure_text(file, found), stop=stop), source=found.source, notes=found.notes)
    else:
        with at_once(stop):
            drawing = read_spatial(file if "\n" in file else Path(file), stop=stop)
    for line in drawing.notes:
        note(line)
    members = {p.name: None for p in drawing.parts}
    fixed = names(asked.fix, set(members))
    glued, ignored = ([tuple(names([text], set(members))) for text in texts] for texts in (asked.glue, asked.ignore))
    gaps, odd = joint_gaps(asked.gap_of, set(members), str)
    wrong += odd
    for option, groups in (("glue", glued), ("ignore", ignored), ("gap-of", [joint.parts for joint in gaps])):
        wrong += [f"--{option}: {unknown(name, members)}" for group in groups for name in group if name not in members]
    wrong += group_findings(asked.glue, glued, asked.ignore, ignored)
    if wrong:
        raise InputError(wrong)
    pairs = tuple((one, other) for one, other in ignored)
    asked_pairs = {frozenset(joint.parts) for joint in gaps}
    own = (*(joint for joint in drawing.gaps if frozenset(joint.parts) not in asked_pairs), *gaps)
    parts = tuple(replace(p, fixed=p.fixed or p.name in fixed) for p in drawing.parts)
    glue, ignore = (*drawing.glue, *glued), (*drawing.ignore, *pairs)
    return replace(drawing, parts=parts, glue=glue, ignore=ignore, gaps=own, goals=tuple(asked_for) or drawing.goals)
