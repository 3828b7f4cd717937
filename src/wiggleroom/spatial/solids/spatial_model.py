"""What a spatial assembly is: solids as drawn and as made, parts and their roles."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Displayable
from wiggleroom.drawing.model import Goal, JointGap, Region
from wiggleroom.spatial.solids.convex import ConvexPiece

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AXES = ("x", "y", "z", "rx", "ry", "rz")
"""Freedoms of a part, in order: moves along and turns about the axes of the world."""


@dataclass(frozen=True, eq=False)
class Plate:
    """Outlines in the plane z = 0 of the part's own frame, thick towards +z [mm]."""

    regions: tuple[Region, ...]
    thickness: float


@dataclass(frozen=True, eq=False)
class Boxes:
    """Union of axis-aligned boxes (k, 2, 3) [mm] in the part's own frame."""

    boxes: Floats


@dataclass(frozen=True, eq=False)
class Surface:
    """Closed surface of triangles, outward: vertices (v, 3) [mm] and faces (f, 3)."""

    vertices: Floats
    faces: Ints


Solid = Plate | Boxes | Surface


@dataclass(frozen=True, eq=False)
class SpatialPart:
    """One rigid part as drawn.

    Parameters
    ----------
    name : str
    solid : Plate, Boxes or Surface
        In the part's own frame.
    at : (3,) float64 [mm]
        Where the origin of that frame lies at rest.
    R : (3, 3) float64
        How the frame is turned at rest.
    fixed : bool
    lock : frozenset of str
        Freedoms among `AXES` that the part has not.
    offset : float [mm]
        Outward displacement of the cut edges of a plate.
    density : float
        Weight of a cubic millimetre, for `--weight`.
    """

    name: str
    solid: Solid
    at: Floats
    R: Floats
    fixed: bool = False
    lock: frozenset[str] = frozenset()
    offset: float = 0.0
    density: float = 1.0


@dataclass(frozen=True, eq=False)
class SpatialDrawing:
    """Everything a file of format wiggleroom/2 says, in millimetres."""

    parts: tuple[SpatialPart, ...]
    gap: float = 0.0
    glue: tuple[tuple[str, ...], ...] = ()
    ignore: tuple[tuple[str, str], ...] = ()
    gaps: tuple[JointGap, ...] = ()
    goals: tuple[Goal, ...] = ()
    source: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class MadeSolid:
    """A solid as it is made, in the part's own frame.

    Parameters
    ----------
    pieces : tuple of ConvexPiece
        Convex pieces that may overlap; their union is the solid.
    surface : Surface
        Its boundary.
    volume : float [mm3]
        As drawn.
    centroid : (3,) float64 [mm]
        As drawn: the reference point.
    steps : (k, 4) float64
        Planes, by unit normal and offset [mm], of steps that end a joint's own gap inside a face: no gap moves them.
    """

    pieces: tuple[ConvexPiece, ...]
    surface: Surface
    volume: float
    centroid: Floats
    steps: Floats = field(default_factory=lambda: np.zeros((0, 4)))


@dataclass(frozen=True, eq=False)
class SpatialAssembly(Displayable):
    """Parts as made, at rest, and their roles.

    Parameters
    ----------
    drawing : SpatialDrawing
        With the gap that was applied.
    made : tuple of MadeSolid
        Of every part, in order.
    """

    dimension: ClassVar[int] = 3
    drawing: SpatialDrawing
    made: tuple[MadeSolid, ...]

    @property
    def parts(self) -> tuple[SpatialPart, ...]:
        """Parts as drawn."""
        return self.drawing.parts

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(p.name for p in self.drawing.parts)

    @property
    def gap(self) -> float:
        """The gap that was applied [mm]."""
        return self.drawing.gap

    @property
    def widest_gap(self) -> float:
        """The largest of all gaps, those of single joints too [mm]."""
        return max([self.gap, *(joint.gap for joint in self.drawing.gaps)])

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What the file asks for."""
        return self.drawing.goals

    @property
    def reference(self) -> Floats:
        """Reference points at rest (n, 3) [mm]: the centroids of the volumes."""
        return np.array([p.at + p.R @ m.centroid for p, m in zip(self.parts, self.made, strict=True)])

    @property
    def size(self) -> float:
        """Longest side of the box round all parts at rest [mm]."""
        points = [m.surface.vertices @ p.R.T + p.at for p, m in zip(self.parts, self.made, strict=True)]
        return float(np.ptp(np.vstack(points), axis=0).max())
