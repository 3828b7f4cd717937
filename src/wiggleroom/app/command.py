"""The command line that answers what is on screen."""

from __future__ import annotations

import shlex

from wiggleroom.app.design_cache import goals_of, joint_gaps
from wiggleroom.app.open_requests import File, saved_name
from wiggleroom.drawing.strokes.chord_error import chord_error
from wiggleroom.drawing.units import PER_INCH
from wiggleroom.schema.requests import Design, GoalEntry


def command(name: str, file: File, design: Design, more: tuple[str, ...] = (), *, pulled: bool = True) -> str:
    """Command of this name: with options that say the design, else about the assembly file that `save` makes, else none.

    Parameters
    ----------
    name : str
        flex, rank, check, ...
    more : tuple of str
        Arguments and options of the command itself.
    pulled : bool
        False: it does not matter what is pulled.
    """
    said = options(file, design, pulled=pulled)
    if said is None and design.extra and file.drawing.dimension == 3:
        return ""  # neither options nor files say extra gaps of single parts in space
    if said is None:
        return shlex.join(["wiggleroom", name, saved_name(file.name), *more])
    return shlex.join(["wiggleroom", name, file.path, *more, *said])


def options(file: File, design: Design, *, pulled: bool = True) -> list[str] | None:
    """Options that make the design of the file; None where none can."""
    drawing = file.drawing
    before = {p.name for p in drawing.parts if p.fixed}
    glue = {frozenset(group) for group in design.glue}
    joints = joint_gaps(design, drawing.gaps)
    if not {frozenset(j.parts) for j in file.joints} <= {frozenset(j.parts) for j in joints}:
        return None  # options give joints a gap of their own, and take none away
    if design.extra or glue != {frozenset(g) for g in drawing.glue} or not before <= set(design.fixed):
        return None
    gap = drawing.gap if design.gap is None else design.gap
    found = reading_options(file)
    how = file.flattening
    if file.flatten is not None and (how is None or file.flatten != chord_error(gap, how.at_no_gap, how.finest)):
        found += ["--flatten", repr(file.flatten)]
    found += ["--gap", f"{gap:.12g}", *file.ignored]
    for joint in joints:
        if joint not in file.joints:
            found += ["--gap-of", f"{','.join(joint.parts)}:{joint.gap:.12g}"]
    for part in design.fixed:
        if part not in before:
            found += _option("--fix", part)
    asked = _goals(file, design) if pulled else []
    return None if asked is None else [*found, *asked]


def reading_options(file: File) -> list[str]:
    """Options that say how the file was read."""
    unit, how = file.unit or "", file.options
    found = ["--dpi", unit.removesuffix(PER_INCH)] if unit.endswith(PER_INCH) else ["--unit", unit] if unit else []
    for name, words in (("--only", how.only), ("--skip", how.skip), ("--solid", how.solid), ("--hole", how.hole)):
        for word in words:
            found += _option(name, word)
    return found if how.join is None else [*found, "--join", f"{how.join:.12g}"]


def _goals(file: File, design: Design) -> list[str] | None:
    if goals_of(design) == file.drawing.goals:
        return []
    if design.goals == "weight":
        return ["--weight=-z"]
    if isinstance(design.goals, str):
        return ["--objective", design.goals]
    found = []
    for entry in design.goals:
        if entry.weight != 1 or entry.w is not None:
            return None
        if entry.turn is not None:
            found += _option(
                "--turn", f"{entry.part}:{entry.turn if isinstance(entry.turn, str) else _axis(entry.turn)}"
            )
        else:
            found += _option("--pull", f"{entry.part}:{_direction(entry)}")
    return found if found else None


def _option(name: str, value: str) -> list[str]:
    """An option and its value, in one word where the value looks like an option."""
    return [f"{name}={value}"] if value.startswith("-") else [name, value]


def _direction(entry: GoalEntry) -> str:
    assert entry.direction is not None
    axis = _axis(entry.direction)
    return axis if entry.point is None else f"{axis}@{','.join(map(repr, entry.point))}"


def _axis(direction: tuple[float, ...]) -> str:
    """A direction as options write it.

    >>> _axis((0.0, 0.0, -1.0)), _axis((0.6, 0.8))
    ('-z', '0.6,0.8')
    """
    for k, name in enumerate("xyz"[: len(direction)]):
        if abs(direction[k]) == 1 and sum(map(abs, direction)) == 1:
            return ("+" if direction[k] > 0 else "-") + name
    return ",".join(map(repr, direction))
