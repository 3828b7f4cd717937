"""What the readers of drawings find: drawn shapes, and the groups they stand in."""

from __future__ import annotations

from dataclasses import dataclass

from wiggleroom.drawing.pathdata import Subpath
from wiggleroom.drawing.transforms import Affine

MOST = 100_000
"""A drawing of more elements than this, copies counted, is refused."""


@dataclass(eq=False, slots=True)
class Group:
    """A group that may name or glue the parts in it; two groups are the same only if they are one element."""

    name: str
    glue: bool


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """One drawn element, in its own units, with the map to the page.

    Parameters
    ----------
    tag : str
        What the file calls this kind of element.
    place : str
        Where it stands in the file, for messages.
    name : str
        Its own name, or nothing.
    groups : tuple of Group
        From the outermost inward.
    fixed, even_odd : bool
        Whether its part stands; its fill rule, else non-zero.
    matrix : Affine
        From its own units to the page [mm].
    subpaths : list of Subpath
    """

    tag: str
    place: str
    name: str
    groups: tuple[Group, ...]
    fixed: bool
    even_odd: bool
    matrix: Affine
    subpaths: list[Subpath]

    def __str__(self) -> str:
        """Say what a message calls it."""
        return f'{self.tag} "{self.name}" ({self.place})' if self.name else f"{self.tag} in {self.place}"
