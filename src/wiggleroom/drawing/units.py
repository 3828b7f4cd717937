"""Units at the file edge: everything inside is millimetres."""

from __future__ import annotations

import math
from collections.abc import Mapping

from wiggleroom.errors import InputError

UNITS: Mapping[str, float] = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "px": 25.4 / 96, "pt": 25.4 / 72}
"""Length of one unit [mm]; px is the CSS pixel, 96 to the inch, pt the point, 72 to the inch."""
PER_INCH = "dpi"
"""What follows the number in a unit such as "90dpi", 90 of which are an inch."""


def millimetres(unit: str) -> float:
    """Length of one `unit` [mm].

    Parameters
    ----------
    unit : str
        Name of the unit, or how many of it are an inch, as "90dpi".

    Raises
    ------
    InputError
        If the unit is not known; the line lists the known ones.

    Examples
    --------
    >>> millimetres("in"), millimetres("100dpi")
    (25.4, 0.254)
    """
    if unit.endswith(PER_INCH):
        try:
            return 25.4 / _positive(float(unit.removesuffix(PER_INCH)))
        except ValueError:
            pass
    if unit not in UNITS:
        message = f'unit "{unit}" is not known; it must be one of {", ".join(UNITS)}'
        raise InputError(message)
    return UNITS[unit]


def unit_of(unit: str | None, dpi: float | None) -> str | None:
    """Unit of a drawing from the two ways to say it: by name, or as units an inch.

    Raises
    ------
    InputError
        If both are given, or `dpi` is no resolution.

    Examples
    --------
    >>> unit_of(None, 90.0), unit_of("pt", None), unit_of(None, None)
    ('90dpi', 'pt', None)
    """
    if dpi is None:
        return unit
    if unit is not None:
        message = f"unit {unit} and dpi {dpi:g} both say how long a unit of the drawing is; leave one of them out"
        raise InputError(message)
    try:
        return f"{_positive(dpi):.12g}{PER_INCH}"
    except ValueError:
        message = f"dpi is {dpi:g}; it must be the number of units in an inch, such as 72, 90 or 96"
        raise InputError(message) from None


def _positive(number: float) -> float:
    if not 0 < number < math.inf:
        raise ValueError("not a resolution")
    return number
