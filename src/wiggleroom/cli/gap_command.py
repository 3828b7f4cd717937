"""`wiggleroom gap`."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import StudyOutputs, command_line, tell
from wiggleroom.cli.running import TimeLimit

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS = QuestionOptions(), StudyOutputs(), TimeLimit()


def gap(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: StudyOutputs = _NO_OUTPUTS,
    limit: TimeLimit = _ENDLESS,
    at_most: float | None = None,
    holds: Annotated[bool, Parameter(negative="")] = False,
    fits: float | None = None,
    kerf: float | None = None,
) -> int:
    """Find the gap to draw: the largest that keeps a motion small or the parts together, or the smallest that fits.

    Answers one of --at-most, --holds and --fits, with a state that was checked on either side: the answer and the
    nearest gap that fails lie no more than one per cent apart. Proven is an answer that a bound vouches for, else it is
    searched. Exit code: 0 answered, 3 no such gap, or the time was over before both sides lay near each other.

    Example: wiggleroom gap box.svg --fix box --pull lid:+x --at-most 0.5

    Example: wiggleroom gap puzzle.svg --holds --picture border.svg

    Example: wiggleroom gap puzzle.svg --fits 0.1 --kerf 0.15

    --fits is about the parts where they are drawn, not shifted; they may overlap there.

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space. Its own gap is where the search begins.
    at_most
        The largest gap at which the motion asked for is no more than this [mm, turns in rad].
    holds
        The largest gap at which the parts interlock.
    fits
        The smallest gap at which the parts, where they are drawn and not shifted, do not overlap when every outline is up to so much
        larger all round [mm]; 0: as drawn.
    kerf
        Width of the cut [mm]: the answer is also given as the offset to set at the cutter.
    """
    import math

    from wiggleroom.cli.in_space import read_in_space, refuse_page
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.errors import InputError

    outputs.check(file)
    refuse_page(file, None if holds else outputs.picture)
    if kerf is not None and not (math.isfinite(kerf) and kerf >= 0):
        wrong = f"--kerf {kerf:g}: it must be 0 or more"
        raise InputError(wrong)
    command = command_line()
    with interruptible(limit.time) as stop, unless_stopped(stop), progress() as show:
        from wiggleroom.drawing.dimension import is_spatial_file
        from wiggleroom.gap_questions import allowable_gap

        space, may_overlap = is_spatial_file(file), fits is not None
        assembly = read_in_space(file, asked, stop=stop) if space else read(file, asked, stop, overlapping=may_overlap)

        found = allowable_gap(assembly, at_most=at_most, holds=holds, fits=fits, stop=stop, progress=show)
    from dataclasses import replace

    from wiggleroom.report.results.allowable_gap_results import gap_result, gap_table

    shown = outputs if found.trials else replace(outputs, picture=None)  # nothing was found that could be drawn
    tell(
        shown,
        lambda: gap_result(found, command, kerf),
        lambda: gap_table(found, kerf),
        found,
        command,
    )
    return 3 if found.gap is None or found.stopped else 0
