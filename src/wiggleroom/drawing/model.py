"""Parts, drawings and goals, in the plane and in space: what a file says, in millimetres and radians."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Vector = tuple[float, ...]
"""A point or a direction: two numbers in the plane, three in space."""

AXES = ("x", "y", "z", "rx", "ry", "rz")
"""Freedoms of a part in space, in order: moves along and turns about the axes of the world."""
UNTURNED = np.eye(3)
"""Orientation of a part whose own axes are those of the world."""
UNTURNED.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Region:
    """One piece of material: an outer outline and its holes.

    Parameters
    ----------
    outer : (n, 2) float64 [mm]
        Corners, counter-clockwise, the first not repeated at the end.
    holes : tuple of (m, 2) float64 [mm]
        Corners of each hole, clockwise, so that material lies left of every edge.
    """

    outer: Points
    holes: tuple[Points, ...] = ()


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


@dataclass(frozen=True, eq=False)
class ConvexPiece:
    """A convex polytope in the frame of its part.

    Parameters
    ----------
    corners : (k, 3) float64 [mm]
    normals : (f, 3) float64
        Outward unit normals of the faces; of two opposite ones only the first.
    edges : (e, 3) float64
        Unit directions of the edges, parallel ones once.
    """

    corners: Floats
    normals: Floats
    edges: Floats

    def placed(self, R: Floats, T: Floats | Vector) -> ConvexPiece:
        """The same piece turned by R (3, 3), then moved by T (3,) [mm]."""
        turned = np.ascontiguousarray(R.T)
        return ConvexPiece(
            np.ascontiguousarray(self.corners @ turned + T),
            np.ascontiguousarray(self.normals @ turned),
            np.ascontiguousarray(self.edges @ turned),
        )


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
    overshoot : float [mm]
        By how much the pieces, which then contain the solid, are larger at most than it is made; 0 where they make it up.
    mostly : float [mm]
        The same on 95 % of the surface.
    """

    pieces: tuple[ConvexPiece, ...]
    surface: Surface
    volume: float
    centroid: Floats
    steps: Floats = field(default_factory=lambda: np.zeros((0, 4)))
    overshoot: float = 0.0
    mostly: float = 0.0


Solid = Plate | Boxes | Surface
"""Material of a part in space, as drawn."""


@dataclass(frozen=True, eq=False)
class Part:
    """One rigid part: its material in its own frame, and the place of that frame.

    Parameters
    ----------
    name : str
        Unique in its drawing.
    regions : tuple of Region [mm]
        In the plane: material in the part's own frame, whose origin is the reference point.
    at : (x, y, angle) [mm, mm, rad], in space (x, y, z) [mm]
        Rest pose: the material turns by `angle`, in space by `R`, about its origin, then moves by (x, y) or (x, y, z).
    fixed : bool
        True where the part does not move.
    offset : float [mm]
        Extra outward displacement of this part's boundary (negative: smaller, looser); of a plate in space of its cut edges.
    aliases : tuple of str
        Other names of the part, such as its id beside a label; questions may use these too.
    outline_offsets : tuple of float [mm]
        Extra offsets of single outlines, counted through the outer outlines, each followed by its holes; empty for none.
    solid : Plate, Boxes, Surface or MadeSolid, optional
        In space: material in the part's own frame, a `MadeSolid` where the part is as made.
    R : (3, 3) float64
        In space: orientation at rest.
    lock : frozenset of str
        In space: locked freedoms among `AXES`.
    density : float
        In space: weight of a cubic millimetre, for `--weight`.
    """

    name: str
    regions: tuple[Region, ...] = ()
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    fixed: bool = False
    offset: float = 0.0
    aliases: tuple[str, ...] = ()
    outline_offsets: tuple[float, ...] = ()
    solid: Solid | MadeSolid | None = None
    R: Floats = field(default_factory=lambda: UNTURNED)
    lock: frozenset[str] = frozenset()
    density: float = 1.0

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return 2 if self.solid is None else 3


@dataclass(frozen=True)
class JointGap:
    """The gap of one joint [mm], which replaces the assembly's."""

    parts: tuple[str, str]
    gap: float


@dataclass(frozen=True)
class Tolerance:
    """Allowed deviation of a part, an outline or a joint, as stated on technical drawings.

    Parameters
    ----------
    parts : (name,) or (name, name)
        A part, whose outlines all deviate alike, or the two parts of a joint, whose gap varies.
    plus, minus : float [mm]
        Largest deviation to either side, 0 or more: of an outline out of the material (plus) or into it (minus), at right angles; of a
        joint's gap wider (plus) or narrower (minus).
    nominal : float or None [mm]
        Nominal value: a part's offset, a joint's gap, an outline's own offset. None: as drawn.
    outline : int, "thickness" or None
        Of a part: this outline alone, counted from 1 through its outer outlines, each followed by its holes; or the thickness of a plate,
        whose middle stays in place.
    """

    parts: tuple[str] | tuple[str, str]
    plus: float
    minus: float
    nominal: float | None = None
    outline: int | Literal["thickness"] | None = None


@dataclass(frozen=True)
class Pull:
    """Ask for the largest motion of a material point along a direction fixed in the world.

    Parameters
    ----------
    part : str
        Name of the pulled part.
    direction : (dx, dy), in space (dx, dy, dz)
        Any length but zero; normalised on use.
    point : (x, y) or (x, y, z) [mm], optional
        Assembly coordinates at rest; by default the part's reference point.
    weight : float
        Factor of this term in the objective.
    """

    part: str
    direction: Vector
    point: Vector | None = None
    weight: float = 1.0


@dataclass(frozen=True)
class Turn:
    """Ask for the largest turn [rad] of a part.

    Parameters
    ----------
    part : str
    sense : "ccw" or "cw", in space (x, y, z)
        In space the axis of the twist, fixed in the world, right-handed.
    weight : float
        Factor of this term in the objective.
    """

    part: str
    sense: str | Vector = "ccw"
    weight: float = 1.0


@dataclass(frozen=True)
class Weight:
    """Ask how far all parts sink together, in space: each pulled at its centroid by volume times density [mm4 for density 1]."""

    direction: Vector
    weight: float = 1.0


@dataclass(frozen=True)
class W:
    """The paper's objective: w . (x, y, theta) of one part's motion [mm, mm, rad], linear.

    Source: Mind the Gap, section 4.4.
    """

    part: str
    w: tuple[float, float, float]
    weight: float = 1.0


@dataclass(frozen=True)
class Translation:
    """Ask for the largest sum of squared translations [mm2] of all parts.

    Source: Mind the Gap, section 4.4.
    """

    weight: float = 1.0


@dataclass(frozen=True)
class Closer:
    """Ask neighbouring parts to come closer: the largest loss of the squared distances [mm2] of their reference points.

    Source: Mind the Gap, section 4.4; between neighbours.
    """

    weight: float = 1.0


@dataclass(frozen=True)
class Towards:
    """Ask a material point of a part to come as near as possible to a place: the largest loss of their squared distance [mm2].

    Parameters
    ----------
    part : str
    target : (x, y) [mm]
        Assembly coordinates.
    point : (x, y) [mm], optional
        Assembly coordinates at rest; by default the part's reference point.
    weight : float
        Factor of this term in the objective.
    """

    part: str
    target: tuple[float, float]
    point: tuple[float, float] | None = None
    weight: float = 1.0


Goal = Pull | Turn | W | Towards | Translation | Closer | Weight

WHOLE: dict[str, type[Translation] | type[Closer]] = {"translation": Translation, "closer": Closer}
"""Goals of the whole assembly by the names that files and commands use; each stands in place of all pulls."""


def part_of(goal: Goal) -> str | None:
    """The part that a goal names, or None where it is about the whole assembly."""
    return None if isinstance(goal, Translation | Closer | Weight) else goal.part


@dataclass(frozen=True, eq=False)
class Flattening:
    """How the curves of a file became edges; the file and the gap alone decide it.

    Parameters
    ----------
    error : float [mm]
        Chord error of the edges as they are.
    at_no_gap, finest : float [mm]
        Chord error where there is no gap, and the least of all.
    parts : tuple of Part
        As they were read.
    again : callable
        The same parts at another chord error.
    """

    error: float
    at_no_gap: float
    finest: float
    parts: tuple[Part, ...]
    again: Callable[[float], tuple[Part, ...]]


@dataclass(frozen=True, eq=False)
class Drawing:
    """Content of a file: parts as drawn, and the fixed, glued, ignored and pulled ones.

    Parameters
    ----------
    parts : tuple of Part
        As drawn, before gap and offset.
    gap : float [mm]
        Clearance across every joint, as in the file; 0 means as drawn.
    glue : tuple of tuples of names
        Groups of parts that move as one.
    ignore : tuple of pairs of names
        Parts that never collide.
    gaps : tuple of JointGap
        Joints with a gap of their own.
    goals : tuple of Pull, Turn, W, Towards, Translation, Closer or Weight
        The question; several goals add up.
    source : str
        The file's name, for messages.
    notes : tuple of str
        Notes for the user (omitted paths, assumed unit), one line each.
    tolerances : tuple of Tolerance
        Manufacturing tolerances, for questions about tolerances.
    flattening : Flattening or None
        Flattening of its curves; None without curves, or if their polygons are given for every gap.
    """

    parts: tuple[Part, ...]
    gap: float = 0.0
    glue: tuple[tuple[str, ...], ...] = ()
    ignore: tuple[tuple[str, str], ...] = ()
    gaps: tuple[JointGap, ...] = ()
    goals: tuple[Goal, ...] = ()
    source: str = ""
    notes: tuple[str, ...] = ()
    tolerances: tuple[Tolerance, ...] = ()
    flattening: Flattening | None = None

    @cached_property
    def dimension(self) -> int:
        """2 in the plane, 3 in space, as its parts are."""
        return max((part.dimension for part in self.parts), default=2)
