"""What a drawing says about its parts by name: references, numbers, roles, and what is wrong with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import TypeVar

import numpy as np
import shapely

from wiggleroom.assembly.loops import placed_regions
from wiggleroom.drawing.model import Closer, Drawing, Goal, Pull, Towards, Translation, Turn, Vector, W, Weight, part_of
from wiggleroom.drawing.outlines.naming import place_of
from wiggleroom.drawing.writers.glue_groups import glue_groups

AskedGoal = TypeVar("AskedGoal")

SMALLEST_FACTOR, LARGEST_FACTOR = 1e-100, 1e100
"""Goals are not counted by factors beyond these."""
_KINDS = {2: (Pull, Turn, W, Towards, Translation, Closer), 3: (Pull, Turn, Weight, Translation, Closer)}
"""Goals of the plane and of space."""
_COUNTS = {2: "in the plane it must be two numbers", 3: "in space it must be three numbers"}
USUAL = f"it must be a finite number, between {SMALLEST_FACTOR:g} and {LARGEST_FACTOR:g} in size unless it is 0"


def statement_findings(drawing: Drawing) -> list[str]:
    """Everything wrong with names, references, numbers and roles, whatever the outlines are."""
    fixed = {p.name: p.fixed for p in drawing.parts}
    goals = goal_findings(drawing.goals, fixed, drawing.glue, drawing.dimension)
    return [*_names(drawing), *_references(drawing), *_gap_numbers(drawing), *goals]


def goal_findings(
    goals: Iterable[Goal], fixed: Mapping[str, bool], glue: Iterable[Sequence[str]], dimension: int
) -> list[str]:
    """What is wrong with goals: questions of the other dimension, unknown parts, parts that stand, numbers that make no sense.

    Parameters
    ----------
    goals : goals
    fixed : mapping of names to bool
        All parts, and whether each stands.
    glue : groups of names
    dimension : int
        2 in the plane, 3 in space.

    Examples
    --------
    >>> goal_findings([Pull("lid", (0, 1))], {"lid": False}, (), 3)
    ['pull of "lid": direction is (0, 1): in space it must be three numbers']
    """
    goals = list(goals)
    asked = dict.fromkeys((_kind(goal), name) for goal in goals if (name := part_of(goal)) is not None)
    still = {name: "it is fixed" for name, stands in fixed.items() if stands}
    for anchor, name in glued_to(glue, still):
        still.setdefault(name, f'it is glued to "{anchor}", which is fixed')
    return [
        *(f"{kind}: {unknown(name, fixed)}" for kind, name in asked if name not in fixed),
        *(line for goal in goals for line in _goal_numbers(goal, dimension)),
        *(
            f'"{name}" cannot be moved ({kind}), for {still[name]}: fix it or move it, not both'
            for kind, name in asked
            if name in still
        ),
    ]


def with_roles(drawing: Drawing, gap: float, fix: Sequence[str], goals: Sequence[Goal]) -> tuple[Drawing, list[str]]:
    """The drawing with another gap [mm], with parts that stand besides its own, and with these goals where there are any.

    Returns
    -------
    Drawing
    list of str
        One line for each name in `fix` that no part has.
    """
    names, stand = {p.name: None for p in drawing.parts}, set(fix)
    wrong = [f"fix: {unknown(name, names)}" for name in fix if name not in names]
    parts = tuple(replace(p, fixed=True) if p.name in stand else p for p in drawing.parts)
    return replace(drawing, parts=parts, gap=gap, goals=tuple(goals) or drawing.goals), wrong


def given_goals(goals: AskedGoal | Sequence[AskedGoal] | None, own: tuple[AskedGoal, ...]) -> tuple[AskedGoal, ...]:
    """Goals of a question, one or several as they were given; those of the drawing, its `own`, where none were.

    Examples
    --------
    >>> given_goals(Turn("a"), ()) == given_goals([Turn("a")], ()) == given_goals(None, (Turn("a"),))
    True
    """
    if goals is None:
        return own
    return tuple(goals) if isinstance(goals, Iterable) else (goals,)


def missing_roles(fixed: Sequence[bool], goals: Sequence[object], direction: str) -> list[str]:
    """List what a question about motion lacks, in the plane or in space: a part that is `fixed`, one that is not, a pull.

    Examples
    --------
    >>> missing_roles([], (), "+z")[1]
    'nothing is pulled: say what moves with --pull NAME:+z'
    """
    found = []
    if not any(fixed):
        found.append("nothing is fixed: name the parts that stand with --fix NAME")
    elif all(fixed):
        found.append("everything is fixed: leave at least one part free to move")
    if not goals:
        found.append(f"nothing is pulled: say what moves with --pull NAME:{direction}")
    return found


class PartNames:
    """Names of parts as people give them: a name, an id beside it, or a point of the part as "@12,30" [mm].

    Calling it gives the name of the part; what no part is at is kept in `wrong`, one line each.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> known = PartNames(Drawing((Part("a", (square,)),)))
    >>> known("@1,1"), known("b"), known("@5,1"), known.wrong
    ('a', 'b', '@5,1', ['@5,1: there is no part at this point'])
    """

    def __init__(self, drawing: Drawing) -> None:
        self._drawing = drawing
        self._names = {p.name for p in drawing.parts}
        self._aliases = {alias: p.name for p in drawing.parts for alias in p.aliases}
        self.wrong: list[str] = []

    def __call__(self, name: str) -> str:
        """Name of the part."""
        point = None if name in self._names else place_of(name)
        if point is None:
            return name if name in self._names else self._aliases.get(name, name)
        shapes, owner = placed_regions(self._drawing.parts)
        inside = np.flatnonzero(shapely.intersects_xy(shapes, *point))
        area = shapely.area(shapes)
        if not len(inside):
            self.wrong.append(f"{name}: there is no part at this point")
            return name
        return self._drawing.parts[owner[min(inside, key=lambda k: area[k])]].name


def unknown(name: str, names: Iterable[str]) -> str:
    """Say that no part has this name, and which names come near.

    Examples
    --------
    >>> unknown("a11", ["a1", "b7"])
    'there is no part "a11": did you mean "a1"?'
    """
    known = list(names)
    folded = {n.casefold(): n for n in reversed(known)}
    near = [f'"{folded[n]}"' for n in get_close_matches(name.casefold(), folded, n=3)]
    if near:
        return f'there is no part "{name}": did you mean {" or ".join(near)}?'
    some = ", ".join(known[:8]) + (", ..." if len(known) > 8 else "")
    return f'there is no part "{name}": the parts are {some}' if known else f'there is no part "{name}"'


def _names(drawing: Drawing) -> list[str]:
    if not drawing.parts:
        return ["there are no parts: draw at least one closed outline"]
    count = Counter(p.name for p in drawing.parts)
    return [
        f'{n} parts have the name "{name}": every part needs a name of its own' for name, n in count.items() if n > 1
    ]


def _references(drawing: Drawing) -> list[str]:
    names = {p.name: None for p in drawing.parts}
    uses = [("glue", name) for group in drawing.glue for name in group]
    uses += [("ignore", name) for pair in drawing.ignore for name in pair]
    uses += [("gaps", name) for joint in drawing.gaps for name in joint.parts]
    found = [f"{kind}: {unknown(name, names)}" for kind, name in dict.fromkeys(uses) if name not in names]
    same = [j.parts[0] for j in drawing.gaps if j.parts[0] == j.parts[1]]
    return found + [f'gaps: "{name}" is named twice: a joint lies between two parts' for name in same]


def _gap_numbers(drawing: Drawing) -> list[str]:
    gaps = [("gap", drawing.gap), *((f"gap of {j.parts[0]} and {j.parts[1]}", j.gap) for j in drawing.gaps)]
    return [f"{what} is {gap:g}: it must be 0 or more" for what, gap in gaps if not 0 <= gap < np.inf]


def _goal_numbers(goal: Goal, dimension: int) -> list[str]:
    """What is wrong with the kind and the numbers of one goal."""
    name = part_of(goal)
    where = _kind(goal) if name is None else f'{_kind(goal)} of "{name}"'
    if not isinstance(goal, _KINDS[dimension]):
        return [
            f"{where} is a question about assemblies in space"
            if dimension == 2
            else f"{type(goal).__name__} is a question about drawings; in space ask with Pull or Turn"
        ]
    found = [] if _is_usual(goal.weight) else [f"{where}: weight is {goal.weight:g}: {USUAL}"]
    match goal:
        case Turn(sense=sense) if dimension == 2:
            return found if sense in ("ccw", "cw") else [*found, f'{where}: sense is "{sense}": it is ccw or cw']
        case Turn(sense=sense):
            return found + _direction(f"{where}: sense", sense, dimension)
        case Pull(direction=direction, point=point):
            return (
                found
                + _direction(f"{where}: direction", direction, dimension)
                + _spot(where, "point", point, dimension)
            )
        case Weight(direction=direction):
            return found + _direction(f"{where}: direction", direction, dimension)
        case Towards(target=target, point=point):
            return found + _spot(where, "target", target, dimension) + _spot(where, "point", point, dimension)
        case W(w=w):
            wrong = _nonzero(f"{where}: w", w)
            usual = all(map(_is_usual, w))
            return found + wrong + ([] if wrong or usual else [f"{where}: w is {numbers_text(w)}: {USUAL}"])
    return found


def _direction(what: str, values: Vector | str, dimension: int) -> list[str]:
    """What is wrong with a direction."""
    if isinstance(values, str):
        return [f"{what} is {values}: {_COUNTS[dimension]}"]
    return _count(what, values, dimension) or _nonzero(what, values)


def _nonzero(what: str, values: Vector) -> list[str]:
    if np.isfinite(values).all() and np.any(values):
        return []
    return [f"{what} is {numbers_text(values)}: it must be finite and not all zero"]


def _spot(where: str, word: str, values: Vector | None, dimension: int) -> list[str]:
    """What is wrong with a point, where there is one."""
    if values is None:
        return []
    wrong = _count(f"{where}: {word}", values, dimension)
    if wrong or np.isfinite(values).all():
        return wrong
    return [f"{where}: {word} is {numbers_text(values)}: it must be finite"]


def _count(what: str, values: Vector, dimension: int) -> list[str]:
    """What is wrong with how many numbers a vector has."""
    return [] if len(values) == dimension else [f"{what} is {numbers_text(values)}: {_COUNTS[dimension]}"]


def _is_usual(number: float) -> bool:
    """True where squares and products of a factor stay numbers."""
    return number == 0 or SMALLEST_FACTOR <= abs(number) <= LARGEST_FACTOR


def numbers_text(values: Sequence[float]) -> str:
    """Write numbers as a tuple, no longer than needed."""
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


def _kind(goal: Goal) -> str:
    """Word of files for a goal."""
    return type(goal).__name__.lower()


def glued_to(glue: Iterable[Sequence[str]], fixed: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of a fixed part and a part glued to it, directly or through others."""
    group = glue_groups(glue)
    anchors = {group[name]: name for name in fixed if name in group}
    return [(anchors[g], name) for name, g in group.items() if g in anchors]
