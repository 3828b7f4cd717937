"""A finding for the terminal, and its table for spreadsheets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from wiggleroom.report.finding import Cell, Finding, Table
from wiggleroom.report.results.answer_words import number, short
from wiggleroom.report.results.table import columns

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.table import Table as RichTable
    from rich.text import Text


def finding_text(finding: Finding) -> Group:
    """What a command prints: title, facts, tables, and how sure it is."""
    from rich.console import Group
    from rich.text import Text

    told = {sentence for _, sentence in finding.sure}
    facts = [_coloured(fact, finding) for fact in finding.facts if fact not in told]
    lines: list[RenderableType] = [_coloured(finding.title, finding, "bold"), *facts]
    for table in finding.tables:
        if table.rows:
            lines += [Text(), _table(table)]
    width = max((len(term) for term, _ in finding.sure), default=0) + 2
    if finding.sure:
        lines += [Text()] if finding.tables else []
        lines += [Text(f"{term + ':':<{width}}{sentence}") for term, sentence in finding.sure]
    return Group(*lines)


def _coloured(line: str, finding: Finding, style: str = "") -> Text:
    """A line in its style, the verdict at its start in its colour."""
    from rich.text import Text

    if not finding.colour or not line.startswith(finding.verdict):
        return Text(line, style=style)
    return Text.assemble((finding.verdict, f"bold {finding.colour}"), (line[len(finding.verdict) :], style))


def _table(table: Table) -> RichTable:
    """Table with as many rows as the terminal shows, and a line for the rest."""
    found = columns(*table.heads)

    def add(row: Sequence[Cell], style: str) -> None:
        found.add_row(
            *(_cell(cell, head, table.digits) for cell, head in zip(row, table.heads, strict=True)), style=style
        )

    for row in table.rows[: table.most]:
        add(row, "bold" if row[0] in table.strong else "")
    left = 0 if table.most is None else len(table.rows) - table.most
    if left > 0:
        last = [f"... and {left} more", *table.rest]
        add([*last, *[""] * (len(table.heads) - len(last))], "dim")
    if table.foot:
        add([table.foot, *[""] * (len(table.heads) - 1)], "dim")
    return found


def _cell(value: Cell, head: str, digits: int) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return short(value)
    if not math.isfinite(value):
        return ""
    return f"{value:.1f}" if head.endswith("%") else number(value, digits)
