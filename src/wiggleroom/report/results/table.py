"""Plain tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderResult
    from rich.table import Table

MIN_NAME = 8
"""Columns of names are at least as wide, however long what stands beside them is."""


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
