"""Answer as a page of plain tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from wiggleroom.drawing.model import part_of
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
from wiggleroom.verdict import Separability, Verdict

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
    from rich.table import Table

    from wiggleroom.search.answer import Answer

MAX_PARTS = 12
"""Rows of the table of parts, those that move furthest."""
MAX_CONTACT_ROWS = 8
"""Rows of the table of contacts."""
MIN_NAME = 8
"""Columns of names are at least as wide, however long what stands beside them is."""
SEPARABILITY_COLOURS = {
    Separability.INTERLOCKED: "green",
    Separability.COMES_APART: "magenta",
    Separability.UNKNOWN: "yellow",
}
"""Colours of verdicts on the terminal."""
_COLOURS = {
    Verdict.PROVEN: "green",
    Verdict.OPTIMAL: "green",
    Verdict.STATIONARY: "yellow",
    Verdict.UNBOUNDED: "magenta",
    Verdict.STOPPED: "yellow",
}


def table(answer: Answer[Any]) -> Group:
    """Page that `flex` prints: headline, verdict, the parts that move most, what holds them, and how sure it is.

    Fits into 80 columns; colours show on a terminal only.
    """
    from rich.console import Group
    from rich.text import Text

    colour = _COLOURS[answer.verdict]
    lines = [
        Text(headline(answer), style="bold"),
        Text.assemble((answer.verdict.value, f"bold {colour}"), f": {verdict_sentence(answer)}"),
    ]
    if answer.objective is not None and len(answer.goals) > 1:
        lines += [Text(f"  {goal_text(goal)}, weight {number(goal.weight)}") for goal in answer.goals]
    if answer.leaves:
        lines.append(Text(f"leaves: {', '.join(answer.leaves)}"))
    if answer.turns:
        lines.append(Text(f"turns without limit: {', '.join(answer.turns)}"))
    page: list[RenderableType] = [*lines, Text(), _parts(answer), Text()]
    if any(c.force > 0 for c in answer.contacts):
        page += [_contacts(answer), Text()]
    return Group(*page, *[Text(line) for line in _sure(answer)])


def _parts(answer: Answer[Any]) -> Table:
    """Parts moved most, the pulled ones always among them and first."""
    asked, axes = {part_of(goal) for goal in answer.goals}, answer.assembly.dimension
    names, shift, turn = answer.assembly.names, answer.motion[:, :axes], answer.motion[:, axes:]
    moved = np.linalg.norm(shift, axis=1).tolist()
    turned = np.degrees(turn[:, 0] if axes == 2 else np.linalg.norm(turn, axis=1)).tolist()
    farthest = max(moved)
    order = sorted(range(len(names)), key=lambda k: (names[k] not in asked, -round(moved[k], 9), k))
    moves = (answer.motion != 0).any(axis=1).tolist()
    still = [k for k in order if not moves[k]]
    order = [k for k in order if moves[k]]
    found = columns("part", *(f"d{axis} mm" for axis in "xyz"[:axes]), "turn deg")
    for k in order[:MAX_PARTS]:
        style = "bold" if names[k] in asked else ""
        found.add_row(
            short(names[k]), *(fixed(x, farthest) for x in shift[k].tolist()), f"{turned[k]:.3f}", style=style
        )
    rest = len(order) - MAX_PARTS
    if rest > 0:
        found.add_row(f"... and {rest} more", style="dim")
    if still:
        found.add_row(f"{len(still)} at rest", style="dim")
    return found


def _contacts(answer: Answer[Any]) -> Table:
    """Contacts that hold the motion, largest force first."""
    held = force_bearing_contacts(answer.contacts)
    found = columns("held by", *(f"{axis} mm" for axis in "xyz"[: answer.assembly.dimension]), "force")
    size = answer.assembly.size
    for c in held[:MAX_CONTACT_ROWS]:
        found.add_row(" | ".join(short(n) for n in c.parts), *(fixed(x, size) for x in c.point), number(c.force, 3))
    if len(held) > MAX_CONTACT_ROWS:
        found.add_row(f"... and {len(held) - MAX_CONTACT_ROWS} more", style="dim")
    return found


def _sure(answer: Answer[Any]) -> list[str]:
    """How sure the answer is, and what it cost."""
    spent = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in answer.seconds.items())
    in_space = answer.assembly.dimension == 3
    most = [f"at most:  {bound_sentence(answer)}" if in_space else f"truth:    {proven(answer)}"]
    if answer.at_most is None:
        most = []
    if answer.bound is not None and answer.bound.kind == "quick" and not answer.bound.why:
        most = [f"truth:    {proven(answer)}, a quick bound; --prove 0.01 brings it nearer"]
    tried = answer.search is not None or (in_space and answer.objective is not None)
    return [
        *most,
        *([f"search:   {searched(answer)}"] if tried else []),
        f"checked:  {certainty(answer)}; deepest overlap {number(answer.deepest_overlap, 2)} mm",
        f"solved:   {solved(answer)}",
        *([f"seconds:  {spent}"] if spent else []),
    ]


def columns(first: str, *others: str, words: str = "") -> Table:
    """Plain table without rows: the first column for names, the others for numbers, and one more for words where it has a heading.

    Where a line is too narrow, words and names are folded; numbers stay whole, and the line gets longer rather than lose a column.
    """
    from rich import box
    from rich.cells import cell_len
    from rich.table import Table

    class Named(Table):
        def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
            widths = [max(map(cell_len, (str(c.header), *map(str, c.cells)))) for c in self.columns]
            least = [
                width if c.no_wrap else min(width, MIN_NAME) for width, c in zip(widths, self.columns, strict=True)
            ]
            needed = sum(least) + 3 * (len(least) - 1)
            yield from super().__rich_console__(console, options.update(max_width=max(options.max_width, needed)))

    found = Named(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, header_style="dim")
    found.add_column(first, overflow="fold", min_width=MIN_NAME)
    for column in others:
        found.add_column(column, justify="right", no_wrap=True)
    if words:
        found.add_column(words, overflow="fold")
    return found


def fixed(value: float, largest: float) -> str:
    """`value` with as many decimals as show four digits of the largest, so that columns line up."""
    places = 3 if largest == 0 else min(max(3 - math.floor(math.log10(largest)), 0), 9)
    return f"{value + 0.0:.{places}f}"
