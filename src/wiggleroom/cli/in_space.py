"""The commands for assemblies in space, files of format wiggleroom/2."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.outputs import EXIT_CODES, Outputs, Places, command_line, tell
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.cli.sheet_options import SheetOptions
    from wiggleroom.deadline import Deadline
    from wiggleroom.spatial.solids.spatial_model import SpatialAssembly

_OF_DRAWINGS = ("unit", "dpi", "only", "skip", "join", "solid", "hole")
"""Options that say how a drawing is read, a cutting sheet too."""


def read_in_space(
    file: str, asked: QuestionOptions, sheet: SheetOptions | None = None, stop: Deadline | None = None
) -> SpatialAssembly:
    """Spatial assembly that a file, or a cutting sheet, and the options describe; its notes go to stderr.

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
    from wiggleroom.errors import InputError

    asked_for, wrong = goals(asked.pull, asked.turn, asked.weight, dimension=3)
    if asked.gap is not None and not (math.isfinite(asked.gap) and asked.gap >= 0):
        wrong.append(f"--gap {asked.gap:g}: it must be 0 or more")
    drawn = sheet is not None and sheet.given
    for option in ("unit", "dpi", "flatten", "objective", "only", "skip", "join", "solid", "hole"):
        if getattr(asked, option) not in (None, ()) and not (drawn and option in _OF_DRAWINGS):
            wrong.append(
                f"--{option.replace('_', '-')} is for parts in the plane; {file} is asked in space: leave it out"
            )
    if wrong:
        raise InputError(wrong)
    from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
    from wiggleroom.spatial.solids.spatial_file import read_spatial

    if sheet is not None and sheet.given:
        from wiggleroom.cli.options import read_options
        from wiggleroom.cli.sheet_options import assembled_sheet, sure_text

        found = assembled_sheet(file, sheet, unit=asked.length_unit, options=read_options(asked), stop=stop)
        drawing = replace(read_spatial(sure_text(file, found)), source=found.source, notes=found.notes)
    else:
        with at_once(stop):
            drawing = read_spatial(file if "\n" in file else Path(file))
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
    drawing = replace(drawing, glue=(*drawing.glue, *glued), ignore=(*drawing.ignore, *pairs), gaps=own)
    with at_once(stop):
        return assemble_spatial(drawing, gap=asked.gap, fix=fixed, goals=asked_for)


def read_question(
    file: str, asked: QuestionOptions, sheet: SheetOptions | None = None, stop: Deadline | None = None
) -> Assembly | SpatialAssembly:
    """Assembly of either dimension, if a question about motion can be asked of it; its notes go to stderr.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    """
    from wiggleroom.cli.options import read
    from wiggleroom.cli.running import require_question
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.errors import InputError

    if not (sheet is not None and sheet.given) and not is_spatial_file(file):
        return require_question(read(file, asked, stop))
    from wiggleroom.spatial.spatial_flex import lacking

    assembly = read_in_space(file, asked, sheet, stop)
    wrong = lacking(assembly, assembly.goals)
    if wrong:
        raise InputError(wrong)
    return assembly


def refuse_page(file: str, *places: Path | None, spatial: bool = False) -> None:
    """Check that no page is asked for of curves in space; with `spatial` the file is known to be in space.

    Raises
    ------
    InputError
        If one is.
    """
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.errors import InputError

    for place in places:
        if place is not None and place.suffix.lower() == ".html" and (spatial or is_spatial_file(file)):
            message = f"{place}: curves in space are not made into a page; name an .svg or .png"
            raise InputError(message)


def spatial_places(outputs: Outputs) -> Places:
    """Where everything goes, by the name of its option, and which endings are right in space.

    Raises
    ------
    InputError
        If outlines of moved parts are asked for.
    """
    from wiggleroom.cli.outputs import TABLE
    from wiggleroom.errors import InputError
    from wiggleroom.report.pictures.file_endings import SPATIAL_ANSWERS

    if outputs.moved is not None:
        message = (
            f"--moved {outputs.moved}: outlines are of drawings; in space --picture moved.glb writes the moved parts"
        )
        raise InputError(message)
    return {
        "--json": (outputs.json, ()),
        "--picture": (outputs.picture, SPATIAL_ANSWERS),
        "--csv": (outputs.csv, TABLE),
    }


def flex_in_space(
    file: str,
    asked: QuestionOptions,
    outputs: Outputs,
    solver: str,
    search: int | None,
    limit: float | None,
    sheet: SheetOptions,
) -> int:
    """`wiggleroom flex` of an assembly in space."""
    import time

    from wiggleroom.cli.outputs import check_outputs
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible
    from wiggleroom.questions import flex

    check_outputs(file, spatial_places(outputs), outputs.force)
    begin = time.perf_counter()
    with interruptible(limit) as stop, unless_stopped(stop):
        assembly = read_in_space(file, asked, sheet, stop)
        spent = time.perf_counter() - begin
        answer = flex(assembly, solver=solver, search=search, stop=stop)
    seconds = {"read": spent} | answer.seconds | {"total": time.perf_counter() - begin}
    answer = replace(answer, seconds=seconds, command=command_line())
    from wiggleroom.report.results.json_results import flex_result
    from wiggleroom.report.results.table import table

    tell(outputs, lambda: flex_result(answer), lambda: table(answer), answer, answer.command)
    return 3 if answer.verdict is Verdict.STOPPED else 0


def check_in_space(
    file: str, asked: QuestionOptions, outputs: Outputs, largest_gap: bool, seconds: float | None, sheet: SheetOptions
) -> int:
    """`wiggleroom check` of an assembly in space."""
    from wiggleroom.cli.outputs import check_outputs
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible
    from wiggleroom.gap_questions import largest_gap as find_largest_gap
    from wiggleroom.questions import check

    check_outputs(file, spatial_places(outputs), outputs.force)
    command = command_line()
    with interruptible(seconds) as stop, unless_stopped(stop):
        assembly = read_in_space(file, asked, sheet, stop)
        found = check(assembly, stop=stop)
        border = find_largest_gap(assembly, stop=stop) if largest_gap else None
    from wiggleroom.report.results.separability import Checked, check_result, check_table

    shown = Checked(found, border)
    tell(outputs, lambda: check_result(found, border, command), lambda: check_table(found, border), shown, command)
    return EXIT_CODES[found.verdict]
