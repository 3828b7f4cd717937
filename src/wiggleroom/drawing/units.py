"""Units at the file edge: everything inside is millimetres."""

from __future__ import annotations

from collections.abc import Mapping

from wiggleroom.errors import InputError

UNITS: Mapping[str, float] = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "px": 25.4 / 96}
"""Length of one unit [mm]; px is the CSS pixel, 96 to the inch."""


def millimetres(unit: str) -> float:
    """Length of one `unit` [mm].

    Parameters
    ----------
    unit : str
        Name of the unit.

    Raises
    ------
    InputError
        If the unit is not known; the line lists the known ones.

    Examples
    --------
    >>> millimetres("in")
    25.4
    """
    if unit not in UNITS:
        message = f'unit "{unit}" is not known; it must be one of {", ".join(UNITS)}'
        raise InputError(message)
    return UNITS[unit]
