"""What a comparison found: records for machines, and sheets of columns for people."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Record = dict[str, Any]
"""One line: plain values by name. `published` is True where the figures are not ours but printed in a paper; `at_least` lists the values
that the truth is above, because a limit ended the work."""


@dataclass(frozen=True)
class Column:
    """One column of a sheet.

    Parameters
    ----------
    key : str
        Where its values are in the records.
    head : str
    places : int, optional
        Decimals of its numbers; None for words.
    wide : bool
        True: only where there is room for it, not on a terminal.
    right : bool
        True: its words stand to the right, as numbers do.
    star : str
        Key of a value; where that is not 0, a star is put behind the number.
    """

    key: str
    head: str
    places: int | None = None
    wide: bool = False
    right: bool = False
    star: str = ""

    @property
    def numbers(self) -> bool:
        """Whether it is set to the right."""
        return self.right or self.places is not None

    def cell(self, record: Record) -> str:
        """Value as people read it; a dash where there is none.

        >>> Column("total_seconds", "total s", 1).cell({"total_seconds": 12.34})
        '12.3'
        """
        value = record.get(self.key)
        if value is None or value == "":
            return "-"
        if self.places is None:
            return str(value)
        more = "> " if self.key in record.get("at_least", ()) else ""
        star = "*" if record.get(self.star) else ""
        return f"{more}{value + 0.0:,.{self.places}f}{star}"


@dataclass(frozen=True)
class ResultTable:
    """Records under columns, with a title where there is more than one sheet; lines with the same first value belong together."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Record, ...]


@dataclass(frozen=True)
class Bench:
    """One comparison.

    Parameters
    ----------
    name : str
        "accuracy", "speed", "chains" or "interlock".
    title : str
    records : tuple of dict
        Everything, a line for each assembly and method.
    sheets : tuple of ResultTable
        The same for people.
    notes : tuple of str
        What the figures mean and where they come from.
    command : str
        What to type to have it measured again.
    cut : bool
        True where it was stopped before the last line.
    """

    name: str
    title: str
    records: tuple[Record, ...]
    sheets: tuple[ResultTable, ...]
    notes: tuple[str, ...]
    command: str
    cut: bool = False
