"""Tolerances as the trade writes them: nominal, plus and minus of a part, an outline or a joint, in a table or a file."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Literal

from wiggleroom.drawing.model import Tolerance
from wiggleroom.drawing.readers.assembly_schema import ToleranceEntry
from wiggleroom.drawing.readers.source import load
from wiggleroom.errors import InputError

COLUMNS = ("part", "other", "outline", "nominal", "plus", "minus")
"""Heads of the table; `part` and one of `plus` and `minus` are needed, and the order is free."""


def tolerance_findings(entry: ToleranceEntry) -> list[str]:
    """What is wrong with an entry, apart from names that no part has.

    Examples
    --------
    >>> tolerance_findings(ToleranceEntry(0.1, -0.2, part="a"))
    ['minus is -0.2; it must be 0 or more, as the sign is in the word']
    """
    found = []
    if (entry.part is None) == (entry.parts is None):
        found.append('must have "part", or "parts" with the two of a joint')
    for word, value in (("plus", entry.plus), ("minus", entry.minus)):
        if not value >= 0:
            found.append(f"{word} is {value:g}; it must be 0 or more, as the sign is in the word")
    if entry.outline is not None and (entry.parts is not None or (entry.outline != "thickness" and entry.outline < 1)):
        found.append("outline counts from 1, through the outlines of one part")
    if entry.parts is not None and entry.nominal is not None and entry.nominal < 0:
        found.append(f"nominal is {entry.nominal:g}; the gap of a joint must be 0 or more")
    return found


def read_tolerances(path: str | Path) -> tuple[Tolerance, ...]:
    r"""Tolerances [mm] from a table with a head: part, other, outline, nominal, plus, minus.

    `other` makes a joint of a part and another one; `outline` is the number of one outline, or the word thickness. What is not given
    is left empty; a tolerance with plus alone, or minus alone, has none to the other side.

    Raises
    ------
    InputError
        With one line for each row that cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "t.csv"
    ...     _ = path.write_text("part,other,plus,minus\nlid,,0.05,0.1\nlid,box,0.02,\n")
    ...     read_tolerances(path)[1]
    Tolerance(parts=('lid', 'box'), plus=0.02, minus=0.0, nominal=None, outline=None)
    """
    source = load(Path(path), opening="", name="tolerances")
    lines = io.StringIO(source.text)
    try:
        sample = csv.Sniffer().sniff(source.text.partition("\n")[0], delimiters=",;\t")
    except csv.Error:
        sample = csv.excel()  # type: ignore[assignment]
    table = csv.DictReader(lines, dialect=sample)
    heads = [(head or "").strip().lower() for head in table.fieldnames or ()]
    table.fieldnames = heads
    if "part" not in heads or not {"plus", "minus"} & set(heads):
        message = f"{source.name}: the first line must name the columns: {', '.join(COLUMNS)}"
        raise InputError(message)
    odd = [head for head in heads if head not in COLUMNS]
    findings = [f'{source.name}: there is no column "{head}"; known are {", ".join(COLUMNS)}' for head in odd]
    found = []
    for row in table:
        where = f"{source.name}: line {table.line_num}"
        cells = {head: (row.get(head) or "").strip() for head in COLUMNS}
        if not any(cells.values()):
            continue
        thick = cells["outline"].lower() == "thickness"
        if thick:
            cells["outline"] = ""
        numbers = {word: _number(cells[word]) for word in ("outline", "nominal", "plus", "minus")}
        wrong = [
            f"{word} is {cells[word]}; it must be a number"
            for word, value in numbers.items()
            if value is None and cells[word]
        ]
        if numbers["outline"] is not None and numbers["outline"] != int(numbers["outline"]):
            wrong.append("outline counts from 1, through the outlines of one part")
        if not cells["part"]:
            wrong.append("part is missing")
        names = (cells["part"], cells["other"]) if cells["other"] else (cells["part"],)
        outline: int | Literal["thickness"] | None = None
        if thick:
            outline = "thickness"
        elif numbers["outline"] is not None:
            outline = int(numbers["outline"])
        pair = names if len(names) == 2 else None
        entry = ToleranceEntry(
            numbers["plus"] or 0.0,
            numbers["minus"] or 0.0,
            None if pair else names[0],
            pair,
            outline,
            numbers["nominal"],
        )
        wrong = wrong or tolerance_findings(entry)
        findings += [f"{where}: {line}" for line in wrong]
        found.append(Tolerance(names, entry.plus, entry.minus, entry.nominal, outline))  # type: ignore[arg-type]
    if findings:
        raise InputError(findings)
    if not found:
        message = f"{source.name}: has no rows; give one for each tolerance"
        raise InputError(message)
    return tuple(found)


def _number(text: str) -> float | None:
    """A finite number, also with a decimal comma; None where it is none."""
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        return None
    return value if abs(value) < float("inf") else None
