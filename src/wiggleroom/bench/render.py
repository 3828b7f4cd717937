"""Comparisons as tables on the terminal, as Markdown and as JSON."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wiggleroom.bench.result import Bench, Record, ResultTable
from wiggleroom.errors import InputError
from wiggleroom.report.results.table import columns

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table


def bench_table(found: Bench) -> Group:
    """Page that `bench` prints; published figures are dim."""
    from rich.console import Group
    from rich.text import Text

    page: list[Text | Table] = [Text(found.title, style="bold")]
    for sheet in found.sheets:
        page.append(Text())
        if sheet.title:
            page.append(Text(sheet.title))
        page.append(_rich(sheet))
    cut = ["Stopped before the last line."] if found.cut else []
    return Group(*page, Text(), *[Text(note) for note in (*cut, *found.notes)])


def _rich(sheet: ResultTable) -> Table:
    """Table; where lines share their first value, it stands once in a line of its own over them."""
    shown = [c for c in sheet.columns if not c.wide]
    groups = [shown[0].cell(row) for row in sheet.rows]
    together = len(set(groups)) < len(groups)
    others = shown[1:] if together else shown
    found = columns(others[0].head, *[c.head.replace(" ", "\n") for c in others[1:]])  # narrow columns
    found.padding = (0, 1, 0, 0)
    for k, (column, made) in enumerate(zip(others, found.columns, strict=True)):
        made.no_wrap, made.overflow = k == 0, "fold"
        if not column.numbers:
            made.justify = "left"
    last = ""
    for name, row in zip(groups, sheet.rows, strict=True):
        cells = [column.cell(row) for column in others]
        if together and name != last:
            last = name
            found.add_row(name, *[""] * (len(others) - 1), style="bold")
        if together:
            cells[0] = f"  {cells[0]}"
        found.add_row(*cells, style="dim" if row.get("published") else "")
    return found


def bench_markdown(found: Bench) -> str:
    """Section of a page: heading, the command that made it, tables, what they mean.

    Published figures are in italics. The section stands between two marks by which it is found again.
    """
    begin, end = _marks(found.name)
    lines = [begin, f"## {found.title}", "", f"`{found.command}`", ""]
    for sheet in found.sheets:
        if sheet.title:
            lines += [f"**{sheet.title}**", ""]
        lines.append("| " + " | ".join(c.head for c in sheet.columns) + " |")
        lines.append("| " + " | ".join("---:" if c.numbers else "---" for c in sheet.columns) + " |")
        for row in sheet.rows:
            cells = [column.cell(row) for column in sheet.columns]
            if row.get("published"):
                cells = [cell if cell == "-" else f"*{cell}*" for cell in cells]
            lines.append("| " + " | ".join(cells) + " |")
        lines.append("")
    cut = ["Stopped before the last line."] if found.cut else []
    for note in (*cut, *found.notes):
        lines += [note, ""]
    return "\n".join([*lines[:-1], end])


def with_section(page: str, name: str, section: str) -> str:
    r"""Page with the section of that name put in the place of the old one, or at its end; the rest stays as it is.

    Raises
    ------
    InputError
        If the page has only one of the two marks, or has them twice.

    Examples
    --------
    >>> begin, end = _marks("speed")
    >>> page = f"# Mine\n\n{begin}\nold\n{end}\n\nmore\n"
    >>> with_section(page, "speed", f"{begin}\nnew\n{end}") == page.replace("old", "new")
    True
    """
    begin, end = _marks(name)
    old = re.findall(f"{re.escape(begin)}.*?{re.escape(end)}", page, re.DOTALL)
    if page.count(begin) != len(old) or page.count(end) != len(old) or len(old) > 1:
        finding = f'the page must have the marks "{begin}" and "{end}" once each, in this order, or not at all'
        raise InputError(finding)
    if old:
        return page.replace(old[0], section)
    return (page.rstrip("\n") + "\n\n" if page.strip() else "") + section + "\n"


def bench_record(found: list[Bench], command: str, machine: Record) -> Record:
    """Everything `bench --json` says; format `wiggleroom.bench/1`."""
    return {
        "format": "wiggleroom.bench/1",
        "tables": {
            bench.name: {"title": bench.title, "stopped": bench.cut, "notes": list(bench.notes)} for bench in found
        },
        **{bench.name: list(bench.records) for bench in found},
        "machine": machine,
        "command": command,
    }


def _marks(name: str) -> tuple[str, str]:
    return f"<!-- bench {name} -->", f"<!-- end of bench {name} -->"
