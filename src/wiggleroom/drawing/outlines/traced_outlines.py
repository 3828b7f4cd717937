"""Outlines of a drawing, and what was found while they were traced."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import shapely

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.strokes.elements import Stroke


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed outline of material, with holes that its own path says.

    Parameters
    ----------
    region : Region [mm]
    stroke : Stroke
        What drew it, or the first of its edges.
    row : int
        Place of the stroke in the file.
    face : bool
        Whether it is a piece of a closed outline that lines cut.
    of_lines : bool
        Whether it is a face that open lines bound elsewhere.
    """

    region: Region
    stroke: Stroke
    row: int
    face: bool = False
    of_lines: bool = False

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """What lies inside the outer outline."""
        return shapely.Polygon(self.region.outer)


@dataclass(frozen=True, eq=False)
class Remark:
    """Something about the drawing that has a place, for pictures of it.

    Parameters
    ----------
    kind : str
        One of "open end", "crossing", "overlap", "left out", "mended", "hole".
    lines : tuple of (n, 2) float64 [mm]
        Where: points or lines.
    """

    kind: str
    lines: tuple[Points, ...]


@dataclass(eq=False)
class Traced:
    """Outlines of a drawing, and what was found on the way; filled while it is traced.

    Parameters
    ----------
    outlines : list of Outline
        In drawing order.
    tolerance : float [mm]
        Chord error of curves.
    join : float [mm]
        Ends nearer than this were joined.
    at_no_gap : float or None [mm]
        Chord error without a gap; None where there are no curves, or their chord error was given.
    finest : float [mm]
        Least chord error that the size of the drawing allows.
    further : bool
        Whether ends with no other one near were joined over more.
    notes, findings : list of str
    remarks : list of Remark
    open_lines : int
        How many lines are not closed.
    divided : int
        How many closed outlines these cut.
    """

    file: str
    tolerance: float
    join: float
    at_no_gap: float | None = None
    finest: float = 0.0
    outlines: list[Outline] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    remarks: list[Remark] = field(default_factory=list)
    open_lines: int = 0
    further: bool = True
    divided: int = 0

    def note(self, line: str) -> None:
        """Say something about the file."""
        self.notes.append(f"{self.file}: {line}")


@dataclass(frozen=True, eq=False)
class OpenLine:
    """An open path."""

    corners: Points
    stroke: Stroke
    row: int
