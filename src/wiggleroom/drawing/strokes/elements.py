"""What the readers of drawings find: drawn strokes and texts of an artwork, and the groups they stand in."""

from __future__ import annotations

from dataclasses import dataclass

from wiggleroom.drawing.strokes.pathdata import Subpath

MAX_ELEMENTS = 100_000
"""A drawing of more elements than this, copies counted, is refused."""


NO_SIZE = "element without size"
"""What artworks call elements that draw nothing because they have no size."""


@dataclass(eq=False, slots=True)
class Group:
    """A group or layer that may name or glue the parts in it; two are the same only if they are one element.

    Parameters
    ----------
    name : str
        What may name the only part in it.
    glue : bool
        Whether parts in it move as one.
    marks : tuple of str
        Everything that the file calls it: label, id, class.
    """

    name: str
    glue: bool
    marks: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Stroke:
    """One drawn element on the page.

    Parameters
    ----------
    tag : str
        What the file calls this kind of element.
    place : str
        Where it stands in the file, for messages.
    paths : tuple of Subpath [mm]
        On the page, y up.
    name, label : str
        Its id, and what a person called it; or nothing.
    groups : tuple of Group
        Layers and groups around it, from the outermost inward.
    layer : str
        The layer it stands on, as people see it.
    marks : tuple of str
        Words of its own that may say what it is for, such as a class.
    colour : str
        Of the line, as `#rrggbb`, or nothing.
    fill : str
        Of the inside, likewise.
    line_type : str
        Pattern of the line by name, such as "CENTER"; nothing for a line without gaps.
    styled : bool
        Whether the file says a colour of the line or the inside; else it is black by default, which means little.
    fixed, even_odd : bool
        Whether its part stands; its fill rule, else non-zero.
    hole : bool
        Whether its layer says that it is one.
    whole : bool
        Whether its pieces are one part.
    piece : (name, number, count) or None
        What the file says about the part whose outline this is.
    pool : tuple
        Open strokes of one pool may be edges of one outline.
    """

    tag: str
    place: str
    paths: tuple[Subpath, ...]
    name: str = ""
    label: str = ""
    groups: tuple[Group, ...] = ()
    layer: str = ""
    marks: tuple[str, ...] = ()
    colour: str = ""
    fill: str = ""
    line_type: str = ""
    styled: bool = True
    fixed: bool = False
    even_odd: bool = False
    hole: bool = False
    whole: bool = False
    piece: tuple[str, int, int] | None = None
    pool: tuple[object, ...] = ()

    def __str__(self) -> str:
        """Say what a message calls it."""
        name = self.label or self.name
        return f'{self.tag} "{name}" ({self.place})' if name else f"{self.tag} in {self.place}"


@dataclass(frozen=True, slots=True)
class Lettering:
    """A text and the point where it stands [mm]."""

    text: str
    at: complex


@dataclass(frozen=True, eq=False)
class Artwork:
    """Everything that a file draws.

    Parameters
    ----------
    file : str
        Its name, for messages.
    strokes : tuple of Stroke
        In drawing order.
    texts : tuple of Lettering
    notes, findings : tuple of str
        What was assumed, and what is wrong, so far.
    left_out : dict
        How many elements of which kind are no strokes.
    view : (x, y, width, height) or None [mm]
        The sheet that the file shows.
    program : str
        Who wrote the file, where that decides how it is read.
    """

    file: str
    strokes: tuple[Stroke, ...]
    texts: tuple[Lettering, ...] = ()
    notes: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    left_out: tuple[tuple[str, int], ...] = ()
    view: tuple[float, float, float, float] | None = None
    program: str = ""
