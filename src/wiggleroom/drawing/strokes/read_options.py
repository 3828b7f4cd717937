"""What is asked of reading a drawing."""

from __future__ import annotations

from dataclasses import dataclass, field

from wiggleroom.errors import Stop


@dataclass(frozen=True)
class ReadOptions:
    """How a drawing is read, besides what it says itself.

    Parameters
    ----------
    only, skip : tuple of str
        Layers, colours or names that alone are read, or that are left out.
    join : float, optional [mm]
        Open ends nearer than this are joined; by default the smaller of 0.05 mm and a hundredth of the shortest line.
    solid : tuple of str
        Names, or points as "@x,y", of outlines inside others that are parts, not holes; "all" for all of them.
    stop : optional
        Anything with `is_set()`, asked after every element and every outline.
    hole : tuple of str
        Names, or points as "@x,y", of outlines that are cut out of the parts around or under them; "all" for all inside or
        across the edge of another one.
    """

    only: tuple[str, ...] = ()
    skip: tuple[str, ...] = ()
    join: float | None = None
    solid: tuple[str, ...] = ()
    stop: Stop | None = field(default=None, compare=False)
    hole: tuple[str, ...] = ()
