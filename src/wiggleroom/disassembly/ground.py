"""Which part stands where none is fixed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.errors import InputError

SAME_SIZE = 1e-6
"""Parts as drawn whose areas or volumes differ by less than this share are equally large."""


def with_ground(assembly: Assembly) -> Assembly:
    """The assembly with something that stands: where nothing is fixed the largest part, of equal ones the first, at every gap the same.

    Raises
    ------
    InputError
        If there is only one part.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> standing = with_ground(wr.patterns.jigsaw(2, 2, 0.02, seed=2))
    >>> sum(part.fixed for part in standing.parts)
    1
    """
    if len(assembly.parts) < 2:
        finding = f"{assembly.drawing.source or 'the assembly'}: there is only one part, which nothing can leave; give at least two"
        raise InputError(finding)
    if any(p.fixed for p in assembly.parts):
        return assembly
    size = drawn_sizes(assembly)
    largest = int(np.argmax(size >= (1 - SAME_SIZE) * size.max()))
    parts, drawn = (
        tuple(replace(p, fixed=k == largest) for k, p in enumerate(parts))
        for parts in (assembly.parts, assembly.drawing.parts)
    )
    return replace(assembly, parts=parts, drawing=replace(assembly.drawing, parts=drawn))


def drawn_sizes(assembly: Assembly) -> NDArray[np.float64]:
    """Area [mm2] of every part (n,) as drawn, in space its volume [mm3]."""
    if assembly.dimension == 3:
        return np.array([solid.volume for solid in assembly.solids])
    return np.array(
        [sum(shapely.Polygon(r.outer, r.holes).area for r in p.regions) for p in assembly.drawing.parts], dtype=float
    )
