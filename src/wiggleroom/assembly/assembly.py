"""The assembly: parts as they are made, gap applied, with roles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Displayable
from wiggleroom.drawing.model import Drawing, Goal, MadeSolid, Part, Surface
from wiggleroom.errors import InputError


@dataclass(frozen=True, eq=False)
class Assembly(Displayable):
    """Parts as made, at rest, and their roles.

    Parameters
    ----------
    parts : tuple of Part
        Material after gap and offsets, each in its own frame; in the order of the drawing. In space every one is a `MadeSolid`.
    drawing : Drawing
        The drawing, with the applied gap in `drawing.gap`.
    """

    parts: tuple[Part, ...]
    drawing: Drawing

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return self.drawing.dimension

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(p.name for p in self.parts)

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

    @cached_property
    def rest(self) -> NDArray[np.float64]:
        """Rest poses (n, 3) [mm, mm, rad] in the plane, not to be written to."""
        return np.array([p.at for p in self.parts], dtype=float).reshape(-1, 3)

    @cached_property
    def solids(self) -> tuple[MadeSolid, ...]:
        """Material of the parts in space, in order."""
        return tuple(p.solid for p in self.parts if isinstance(p.solid, MadeSolid))

    @property
    def overshoot(self) -> float:
        """By how much a part in space as it is taken here is larger at most than it is made [mm]: what moves moves, and more may."""
        return max((solid.overshoot for solid in self.solids), default=0.0)

    @cached_property
    def reference(self) -> NDArray[np.float64]:
        """Reference points at rest (n, 2) or (n, 3) [mm], in space the centroids of the volumes; not to be written to."""
        if self.dimension == 2:
            return self.rest[:, :2]
        return np.array([p.at + p.R @ solid.centroid for p, solid in zip(self.parts, self.solids, strict=True)])

    @cached_property
    def size(self) -> float:
        """Longest side of the box round all parts at rest [mm]."""
        return float(np.ptp(np.vstack([corners_at(part) for part in self.parts]), axis=0).max())

    def as_cut(self) -> Drawing:
        """Drawing of the parts as they are made, for a cutter: no gap is left to apply."""
        return replace(self.drawing, parts=self.parts, gap=0.0, gaps=())


def require_planar(assembly: object, question: str) -> None:
    """Raise InputError where a question that is for parts in the plane is asked of something else, as of an assembly in space."""
    if isinstance(assembly, Assembly) and assembly.dimension == 2:
        return
    what = "in space" if getattr(assembly, "dimension", 2) == 3 else f"a {type(assembly).__name__}"
    message = f"{question}: is for an Assembly of parts in the plane; this is {what}"
    raise InputError(message)


def corners_at(part: Part) -> NDArray[np.float64]:
    """Corners (k, 2) or (k, 3) [mm] of a part as made, at rest, in assembly coordinates; those of holes are left out."""
    if isinstance(part.solid, MadeSolid):
        return placed_surface(part, part.solid.surface).vertices
    return np.vstack([place(region.outer, part.at) for region in part.regions])


def placed_surface(part: Part, surface: Surface) -> Surface:
    """A surface of a part's own frame where the part lies at rest, in assembly coordinates."""
    return Surface(surface.vertices @ part.R.T + part.at, surface.faces)


def rings_at(part: Part) -> list[NDArray[np.float64]]:
    """Outlines and holes of a part at rest (n, 2) [mm], in assembly coordinates."""
    return [place(ring, part.at) for region in part.regions for ring in (region.outer, *region.holes)]


def place(points: NDArray[np.float64], pose: tuple[float, float, float]) -> NDArray[np.float64]:
    """Points (n, 2) [mm] of a part's own frame in assembly coordinates at `pose` (x, y, angle) [mm, mm, rad]."""
    x, y, angle = pose
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]]) + (x, y)


def moved_drawing(assembly: Assembly, motion: NDArray[np.float64]) -> Drawing:
    """Drawing of the parts as made where a motion (n, 3) [mm, mm, rad] has taken them; it asks for nothing.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> part = Part("a", (Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])),))
    >>> moved_drawing(Assembly((part,), Drawing((part,))), np.array([[1.0, 2.0, 0.0]])).parts[0].at
    (1.0, 2.0, 0.0)
    """
    parts = tuple(
        replace(part, at=tuple(pose))
        for part, pose in zip(assembly.parts, (assembly.rest + motion).tolist(), strict=True)
    )
    return replace(assembly.as_cut(), parts=parts, goals=())
