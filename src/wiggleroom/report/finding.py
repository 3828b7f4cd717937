"""What a study found, ready to be shown: sentences, tables, a figure and a record, before anything is drawn or printed.

Renderers of the terminal, of CSV, of pictures and of pages take a `Finding` and know nothing of the study.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mark = tuple[float, str]
"""A value on the x axis and what is written beside its line."""
Cell = str | float | int | None


@dataclass(frozen=True, eq=False)
class Table:
    """Rows under their heads.

    Parameters
    ----------
    heads : sequence of str
        With units. Columns in % have one decimal on the terminal.
    rows : sequence of sequences of str, number or None
        All of them; what is unknown or has no end is None or not finite.
    title : str
        Heading on a page.
    most : int, optional
        Rows that the terminal shows.
    foot : str
        What a last row says of what has none.
    strong : sequence of str
        First cells of rows that stand out.
    digits : int
        Significant digits of numbers on the terminal.
    rest : sequence of cells
        Last row in place of those that the terminal leaves out.
    text : str
        Sentence under the heading on a page.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    title: str = ""
    most: int | None = None
    digits: int = 4
    rest: Sequence[Cell] = ()
    foot: str = ""
    strong: Sequence[str] = ()
    text: str = ""


@dataclass(frozen=True, eq=False)
class Curve:
    """Points joined in order, such as motion against gap; broken where y is not finite.

    Parameters
    ----------
    x, y : (k,) float64
    labels : (along x, along y)
        With units.
    marks : sequence of (value, text)
        Vertical lines.
    level : (value, text), optional
        Horizontal line.
    most : (k,) float64, optional
        Upper end of a band above the curve.
    """

    x: Floats
    y: Floats
    labels: tuple[str, str]
    marks: Sequence[Mark] = ()
    level: Mark | None = None
    most: Floats | None = None


@dataclass(frozen=True, eq=False)
class Histogram:
    """How often values (k,) occur.

    Parameters
    ----------
    values : (k,) float64
    label : str
        With its unit.
    marks : sequence of (value, text)
    limit : (value, text), optional
    """

    values: Floats
    label: str
    marks: Sequence[Mark] = ()
    limit: Mark | None = None


@dataclass(frozen=True, eq=False)
class Bars:
    """One value (k,) for each name."""

    names: Sequence[str]
    values: Floats
    label: str


Figure = Curve | Histogram | Bars


@dataclass(frozen=True, eq=False)
class PartTints:
    """Parts coloured by a number each, from nothing to the largest; without a unit, those that have one are marked.

    Parameters
    ----------
    values : mapping of names to float
    unit : str
    legend : str
        What a mark means, where there is no unit.
    """

    values: Mapping[str, float]
    unit: str = ""
    legend: str = ""


@dataclass(frozen=True, eq=False)
class Panel:
    """A figure under its heading."""

    title: str
    figure: Figure


@dataclass(frozen=True, eq=False)
class Finding:
    """What a study found.

    Parameters
    ----------
    title : str
        The answer in one line.
    record : callable
        Makes the record of everything, for JSON.
    assembly : Assembly
        As it was asked about.
    facts : sequence of str
        Lines under the title.
    sure : sequence of (term, sentence)
        How sure it is.
    sections : sequence of Table and Panel
        As a page shows them one under the other; a figure that comes first is the picture.
    data : Table, optional
        For spreadsheets: heads are names of columns.
    motion : Answer, Interlock, Checked or Plan, optional
        What a page shows, and a picture where no figure comes first, with parts coloured by `tints`; its table where there is no `data`.
    tints : PartTints, optional
    tab : str
        Name of the page's tab.
    code : int
        Exit code of the command: 0 answered, 1 the answer is no, 3 no verdict.
    colour : str
        On the terminal, of the verdict where a line begins with it.
    verdict : str
    page : callable, optional
        Makes fields of `StandalonePage` that stand in place of those that are made of the rest.
    extra : mapping of names to float
        Extra gaps [mm] that it proposes.
    gap : float, optional [mm]
        Gap of the whole assembly that it proposes.
    """

    title: str
    record: Callable[[], Struct]
    assembly: Any
    facts: Sequence[str] = ()
    sure: Sequence[tuple[str, str]] = ()
    sections: Sequence[Table | Panel] = ()
    data: Table | None = None
    motion: Any = None
    tints: PartTints | None = None
    tab: str = "Study"
    code: int = 0
    colour: str = ""
    verdict: str = ""
    page: Callable[[], Mapping[str, Any]] | None = None
    extra: Mapping[str, float] = field(default_factory=dict)
    gap: float | None = None

    @property
    def figure(self) -> Figure | None:
        """The figure that comes first; None where the picture is that of the motion."""
        first = self.sections[0] if self.sections else None
        return first.figure if isinstance(first, Panel) else None

    @property
    def tables(self) -> list[Table]:
        """All tables."""
        return [section for section in self.sections if isinstance(section, Table)]
