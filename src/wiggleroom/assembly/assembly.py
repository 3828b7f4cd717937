"""The assembly: parts as they are made, gap applied, with roles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Displayable
from wiggleroom.drawing.model import Drawing, Goal, Part
from wiggleroom.errors import InputError


@dataclass(frozen=True, eq=False)
class Assembly(Displayable):
    """Parts as made, at rest, and their roles.

    Parameters
    ----------
    parts : tuple of Part
        Material after gap and offsets, each in its own frame; same order as in the drawing.
    drawing : Drawing
        Where they came from, with the gap that was applied in `drawing.gap`.
    """

    dimension: ClassVar[int] = 2
    parts: tuple[Part, ...]
    drawing: Drawing

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(p.name for p in self.parts)

    @property
    def gap(self) -> float:
        """The gap that was applied [mm]."""
        return self.drawing.gap

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What the file asks for."""
        return self.drawing.goals

    @cached_property
    def rest(self) -> NDArray[np.float64]:
        """Rest poses (n, 3) [mm, mm, rad], not to be written to."""
        return np.array([p.at for p in self.parts], dtype=float).reshape(-1, 3)

    @cached_property
    def size(self) -> float:
        """Longer side of the box round all parts at rest [mm]."""
        points = np.vstack([place(r.outer, p.at) for p in self.parts for r in p.regions])
        return float(np.ptp(points, axis=0).max())

    def as_cut(self) -> Drawing:
        """Drawing of the parts as they are made, for a cutter: no gap is left to apply."""
        return replace(self.drawing, parts=self.parts, gap=0.0, gaps=())


if TYPE_CHECKING:
    from typing_extensions import TypeVar

    AnyAssembly = TypeVar("AnyAssembly", default=Assembly)
else:
    from typing import TypeVar

    AnyAssembly = TypeVar("AnyAssembly")
"""What a result is about: an assembly in the plane, or one in space. Type checkers take the plane's where none is named."""


def require_planar(assembly: object, question: str) -> None:
    """Raise InputError where a question that is for parts in the plane is asked of something else, as of an assembly in space."""
    if not isinstance(assembly, Assembly):
        message = f"{question}: is for an Assembly of parts in the plane; this is a {type(assembly).__name__}"
        raise InputError(message)


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
