"""From SVG user units to millimetres with y up."""

from __future__ import annotations

from wiggleroom.drawing.readers.svg_program import program_of
from wiggleroom.drawing.readers.xmltree import Element
from wiggleroom.drawing.strokes.transforms import (
    SVG_UNITS,
    Affine,
    Box,
    is_empty_view_box,
    parse_length,
    parse_view_box,
)
from wiggleroom.drawing.units import millimetres
from wiggleroom.errors import InputError


def page_map(root: Element, unit: str | None, file: str, text: str = "") -> tuple[Affine, Box, tuple[str, ...]]:
    """Map of user units to the page, the viewport, and notes.

    Parameters
    ----------
    root : Element
        The outermost svg element.
    unit : str, optional
        What one user unit is, whatever the file says.
    file : str
        Its name, for messages.
    text : str
        The whole file: comments in it may say which program wrote it.

    Returns
    -------
    (Affine, Box, tuple of str)
        x = (x - viewBox left) scale, y = (viewBox bottom - y) scale [mm].

    Raises
    ------
    InputError
        If width, height, viewBox or `unit` cannot be read.

    Examples
    --------
    >>> root = Element("svg", {"width": "20mm", "height": "10mm", "viewBox": "5 0 40 20"}, 1)
    >>> page_map(root, None, "a.svg")
    (Affine(a=0.5, b=0.0, c=0.0, d=-0.5, e=-2.5, f=10.0), Box(x=5.0, y=0.0, width=40.0, height=20.0), ())
    """
    try:
        width, height = (_user_length(root.attributes.get(key, "")) for key in ("width", "height"))
        said = root.attributes.get("viewBox", "")
        view = parse_view_box(said) if said and not is_empty_view_box(said) else None
        fixed = millimetres(unit) if unit is not None else None
    except (ValueError, InputError) as error:
        message = f"{file}: {error}" if isinstance(error, InputError) else f"{file}: svg in line {root.line}: {error}"
        raise InputError(message) from None
    box = view or Box(0.0, 0.0, width or 0.0, height or 0.0)
    across = width if _is_physical(root.attributes.get("width", "")) else None
    up = height if _is_physical(root.attributes.get("height", "")) else None
    program = program_of(root, text, box)
    notes: tuple[str, ...] = ()
    if said and view is None:
        notes = (f'{file}: the viewBox "{said}" has no size, and is ignored',)
    if fixed is not None:
        x = y = fixed
    elif (across or up) and (view or program is None):
        x, y = _scales(view, across, up, root.attributes.get("preserveAspectRatio", "").strip())
    elif program is not None:
        x = y = program.unit * (_pixels(view, width, height) if program.of_page else 1.0)
        notes += (f"{file}: {program.said}; --unit and --dpi say otherwise",)
    else:
        x = y = 1.0
        notes += (f"{file}: has no physical size; 1 user unit is taken as 1 mm (--unit and --dpi say otherwise)",)
    return Affine(x, 0.0, 0.0, -y, -x * box.x, y * (box.y + box.height)), box, notes


def _pixels(view: Box | None, width: float | None, height: float | None) -> float:
    """Pixels of the page per user unit."""
    if view is None:
        return 1.0
    return min([size / whole for size, whole in ((width, view.width), (height, view.height)) if size] or [1.0])


def _user_length(text: str) -> float | None:
    """Width or height in CSS pixels; None where it is missing or a share of the window."""
    if not text.strip() or text.strip().endswith("%") or text.strip() == "auto":
        return None
    length = parse_length(text, 0.0)
    if length <= 0:
        message = f'size "{text}" must be larger than 0'
        raise ValueError(message)
    return length


def _is_physical(text: str) -> bool:
    return any(text.strip().lower().endswith(unit) for unit in SVG_UNITS if unit != "px")


def _scales(view: Box | None, width: float | None, height: float | None, aspect: str) -> tuple[float, float]:
    """Millimetres per user unit across and up, as `preserveAspectRatio` says."""
    pixel = SVG_UNITS["px"]
    if view is None:
        return pixel, pixel
    found = [size * pixel / whole for size, whole in ((width, view.width), (height, view.height)) if size]
    if aspect.startswith("none"):
        return found[0], found[-1]
    scale = max(found) if aspect.endswith("slice") else min(found)
    return scale, scale
