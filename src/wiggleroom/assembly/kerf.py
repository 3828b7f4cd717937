"""Outlines for a cut that takes a strip of material away, half of it on either side of the line."""

from __future__ import annotations

import math

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing
from wiggleroom.errors import InputError, OverlapError


def compensated(assembly: Assembly, kerf: float) -> Drawing:
    """The parts with their outlines half a kerf further out: cut along these lines they are as they are made.

    Parameters
    ----------
    assembly : Assembly
    kerf : float [mm]
        Width of the cut; 0 for a cutter that compensates it by itself.

    Raises
    ------
    InputError
        If it is no width, or parts that lie beside each other would overlap.

    Examples
    --------
    >>> import numpy as np
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> made = assemble(Drawing((Part("a", (square,)),)), gap=0.5)
    >>> compensated(made, 0.2).parts[0].regions[0].outer[0].tolist()
    [0.15, 0.15]
    """
    if not (math.isfinite(kerf) and kerf >= 0):
        message = f"kerf {kerf:g}: it must be 0 mm or more"
        raise InputError(message)
    if not kerf:
        return assembly.as_cut()
    try:
        return assemble(assembly.drawing, offset={part.name: kerf / 2 for part in assembly.parts}).as_cut()
    except OverlapError as problem:
        message = (
            f"kerf {kerf:g} mm: parts that lie beside each other would overlap at gap {assembly.gap:g} mm; "
            "give a larger gap, lay them apart, or let the cutter compensate"
        )
        raise InputError(message) from problem
