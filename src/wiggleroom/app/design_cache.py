"""From the drawing that is open and a design to an assembly; what was made for a gap is kept for the next request."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any, Generic, TypeVar

from msgspec import UNSET

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.statements import statement_findings, unknown
from wiggleroom.drawing.model import WHOLE, Drawing, Goal, JointGap, Pull, Turn, W, Weight
from wiggleroom.errors import InputError
from wiggleroom.report.page.page_messages import DOWN
from wiggleroom.schema.requests import Design, GoalEntry

T = TypeVar("T")

MAX_DESIGNS = 8
"""Number of designs whose outlines are kept."""


class LruCache(Generic[T]):
    """The last few things that were worked out, by what they depend on."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._found: OrderedDict[Hashable, T] = OrderedDict()

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """What is kept under `key`, or what `make` makes."""
        if key in self._found:
            self._found.move_to_end(key)
            return self._found[key]
        value = make()
        self.keep(key, value)
        return value

    def peek(self, key: Hashable) -> T | None:
        """What is kept under `key`, if anything is."""
        return self._found.get(key)

    def keep(self, key: Hashable, value: T) -> None:
        """Keep a value; the one that was not used for longest goes."""
        self._found[key] = value
        self._found.move_to_end(key)
        while len(self._found) > self._most:
            self._found.popitem(last=False)


class DesignedDrawing:
    """One drawing with the gap, the roles and the question of designs.

    Parameters
    ----------
    drawing : Drawing
    """

    def __init__(self, drawing: Drawing) -> None:
        self._drawing = drawing
        self._names = {p.name: None for p in drawing.parts}

    def gap(self, design: Design) -> float:
        """The gap of a design [mm]."""
        return self._drawing.gap if design.gap is None else design.gap

    def drawing(self, design: Design) -> Drawing:
        """The drawing with the roles of a design, as it was drawn.

        Raises
        ------
        InputError
            If the design names parts that are not there.
        """
        named = named_parts(design)
        wrong = [f"{what}: {unknown(name, self._names)}" for what, name in named if name not in self._names]
        if wrong:
            raise InputError(wrong)
        fixed = set(design.fixed)
        parts = tuple(p if p.fixed == (p.name in fixed) else replace(p, fixed=not p.fixed) for p in self._drawing.parts)
        glue = tuple(map(tuple, design.glue))
        gaps = joint_gaps(design, self._drawing.gaps)
        return replace(self._drawing, parts=parts, gap=self.gap(design), glue=glue, gaps=gaps, goals=goals_of(design))


class DesignCache(DesignedDrawing):
    """Assemblies of one drawing in the plane.

    Parameters
    ----------
    drawing : Drawing
    """

    def __init__(self, drawing: Drawing) -> None:
        super().__init__(drawing)
        self._made: LruCache[Assembly] = LruCache(MAX_DESIGNS)

    def shape(self, design: Design) -> Hashable:
        """What the outlines as made depend on."""
        return (
            self.gap(design),
            tuple(sorted(design.extra.items())),
            joint_gaps(design, ()),
            tuple(map(tuple, design.glue)),
        )

    def body(self, design: Design) -> Hashable:
        """What the free spaces of pairs depend on."""
        return self.shape(design), tuple(sorted(design.fixed))

    def assembly(self, design: Design) -> Assembly:
        """Parts as made for a design.

        Raises
        ------
        InputError
            With everything that is wrong, one line each.
        """
        used = self.drawing(design)
        wrong = statement_findings(used)
        if wrong:
            raise InputError(wrong)
        offset = {name: -extra / 2 for name, extra in design.extra.items()}
        made = self._made.get(self.shape(design), lambda: assemble(replace(used, goals=()), offset=offset))
        fixed = [p.fixed for p in used.parts]
        parts = tuple(replace(p, fixed=f) if p.fixed != f else p for p, f in zip(made.parts, fixed, strict=True))
        return Assembly(parts, self.with_offsets(design))

    def with_offsets(self, design: Design) -> Drawing:
        """The drawing with the roles and the extra gaps of a design, as it was drawn; raises as `drawing` does."""
        used = self.drawing(design)
        offset = {name: -extra / 2 for name, extra in design.extra.items()}
        drawn = tuple(replace(p, offset=p.offset + offset[p.name]) if p.name in offset else p for p in used.parts)
        return replace(used, parts=drawn)


def named_parts(design: Design) -> list[tuple[str, str]]:
    """Parts that a design names besides its glue, each with what it says of them."""
    named = [("fixed", n) for n in design.fixed] + [("extra", n) for n in design.extra]
    joints = [] if design.gaps is UNSET else design.gaps
    return named + [("gaps", n) for *pair, _ in joints for n in pair]


def joint_gaps(design: Design, otherwise: tuple[JointGap, ...]) -> tuple[JointGap, ...]:
    """Gaps of single joints that a design says, or those that stand where it says none."""
    return otherwise if design.gaps is UNSET else tuple(JointGap((a, b), gap) for a, b, gap in design.gaps)


def goals_of(design: Design) -> tuple[Goal, ...]:
    """Goals of a design.

    Raises
    ------
    InputError
        If an entry asks for nothing, or for two things at once.
    """
    if isinstance(design.goals, str):
        return (Weight(DOWN) if design.goals == "weight" else WHOLE[design.goals](),)
    return tuple(_goal(k, entry) for k, entry in enumerate(design.goals))


def _goal(k: int, entry: GoalEntry) -> Goal:
    asked: list[Any] = [x for x in (entry.direction, entry.turn, entry.w) if x is not None]
    if len(asked) != 1:
        finding = f'goals[{k}]: must have one of "direction", "turn" or "w"; it has {len(asked)}'
        raise InputError(finding)
    if entry.turn is not None:
        return Turn(entry.part, entry.turn, entry.weight)
    if entry.w is not None:
        return W(entry.part, entry.w, entry.weight)
    assert entry.direction is not None
    return Pull(entry.part, entry.direction, entry.point, entry.weight)
