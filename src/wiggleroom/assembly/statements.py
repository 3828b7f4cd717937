"""What a drawing says about its parts by name: references, numbers, roles, and what is wrong with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import TypeVar

import numpy as np
import shapely

from wiggleroom.assembly.loops import placed_regions
from wiggleroom.drawing.model import Closer, Drawing, Goal, Pull, Towards, Translation, Turn, W, part_of
from wiggleroom.drawing.outlines.naming import place_of
from wiggleroom.drawing.writers.glue_groups import glue_groups

AskedGoal = TypeVar("AskedGoal")

SMALLEST_FACTOR, LARGEST_FACTOR = 1e-100, 1e100
"""Goals are not counted by factors beyond these."""
USUAL = f"it must be a finite number, between {SMALLEST_FACTOR:g} and {LARGEST_FACTOR:g} in size unless it is 0"


def statement_findings(drawing: Drawing) -> list[str]:
    """Everything wrong with names, references, numbers and roles, whatever the outlines are."""
    return [*_names(drawing), *_references(drawing), *_numbers(drawing), *_roles(drawing)]


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
    uses += [(_kind(goal), part) for goal in drawing.goals if (part := part_of(goal)) is not None]
    found = [f"{kind}: {unknown(name, names)}" for kind, name in dict.fromkeys(uses) if name not in names]
    same = [j.parts[0] for j in drawing.gaps if j.parts[0] == j.parts[1]]
    return found + [f'gaps: "{name}" is named twice: a joint lies between two parts' for name in same]


def _numbers(drawing: Drawing) -> list[str]:
    found = []
    for what, gap in [("gap", drawing.gap), *((f"gap of {j.parts[0]} and {j.parts[1]}", j.gap) for j in drawing.gaps)]:
        if not 0 <= gap < np.inf:
            found.append(f"{what} is {gap:g}: it must be 0 or more")
    for goal in drawing.goals:
        found += _goal_numbers(goal)
    return found


def _goal_numbers(goal: Goal) -> list[str]:
    where = _kind(goal) if isinstance(goal, Translation | Closer) else f'{_kind(goal)} of "{goal.part}"'
    found = [] if _is_usual(goal.weight) else [f"{where}: weight is {goal.weight:g}: {USUAL}"]
    if isinstance(goal, Translation | Closer):
        return found
    if isinstance(goal, Turn):
        return found if goal.sense in ("ccw", "cw") else [*found, f'{where}: sense is "{goal.sense}": it is ccw or cw']
    if isinstance(goal, Towards):
        spots = {"target": goal.target, "point": goal.point}
        return found + [
            f"{where}: {word} is {numbers_text(spot)}: it must be finite"
            for word, spot in spots.items()
            if spot is not None and not np.isfinite(spot).all()
        ]
    vector = goal.direction if isinstance(goal, Pull) else goal.w
    if not np.isfinite(vector).all() or not np.any(vector):
        word = "direction" if isinstance(goal, Pull) else "w"
        found.append(f"{where}: {word} is {numbers_text(vector)}: it must be finite and not all zero")
    elif isinstance(goal, W) and not all(map(_is_usual, vector)):
        found.append(f"{where}: w is {numbers_text(vector)}: {USUAL}")
    if isinstance(goal, Pull) and goal.point is not None and not np.isfinite(goal.point).all():
        found.append(f"{where}: point is {numbers_text(goal.point)}: it must be finite")
    return found


def _is_usual(number: float) -> bool:
    """True where squares and products of a factor stay numbers."""
    return number == 0 or SMALLEST_FACTOR <= abs(number) <= LARGEST_FACTOR


def numbers_text(values: Sequence[float]) -> str:
    """Write numbers as a tuple, no longer than needed."""
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


def _kind(goal: Goal) -> str:
    return {
        Pull: "pull", Turn: "turn", W: "w", Towards: "towards", Translation: "translation", Closer: "closer",
    }[type(goal)]  # fmt: skip


def _roles(drawing: Drawing) -> list[str]:
    """Goals of parts that cannot move, themselves or through glue."""
    still = {p.name: "it is fixed" for p in drawing.parts if p.fixed}
    for anchor, name in glued_to(drawing.glue, still):
        still.setdefault(name, f'it is glued to "{anchor}", which is fixed')
    asked = dict.fromkeys((_kind(goal), part_of(goal)) for goal in drawing.goals)
    return [
        f'"{name}" cannot be moved ({kind}), for {still[name]}: fix it or move it, not both'
        for kind, name in asked
        if name is not None and name in still
    ]


def glued_to(glue: Iterable[Sequence[str]], fixed: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of a fixed part and a part glued to it, directly or through others."""
    group = glue_groups(glue)
    anchors = {group[name]: name for name in fixed if name in group}
    return [(anchors[g], name) for name, g in group.items() if g in anchors]
