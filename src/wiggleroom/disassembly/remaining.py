"""An assembly some parts of which were moved or taken away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Part

Ints = NDArray[np.int64]


def without_parts(assembly: Assembly, who: Ints) -> Assembly:
    """The assembly as made, without the parts `who` (k,); it asks for nothing, and joints have no gaps of their own to apply.

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> without_parts(wr.patterns.chain(3, joint="tee", gap=0.02), np.array([1])).names
    ('b1', 'b3')
    """
    gone = set(who.tolist())
    parts = tuple(p for k, p in enumerate(assembly.parts) if k not in gone)
    names = {p.name for p in parts}
    old = assembly.drawing
    drawing = replace(
        old,
        parts=parts,
        glue=tuple(g for g in (tuple(n for n in g if n in names) for g in old.glue) if len(g) > 1),
        ignore=tuple(p for p in old.ignore if set(p) <= names),
        gaps=(),
        goals=(),
    )
    return Assembly(parts, drawing)


def only(assembly: Assembly, who: Ints) -> Assembly:
    """The assembly as made, with the parts `who` (k,) alone."""
    return without_parts(assembly, np.setdiff1d(np.arange(len(assembly.parts)), who))


def displaced(assembly: Assembly, motion: NDArray[np.float64]) -> Assembly:
    """The assembly as made, at rest where a motion (n, 3) [mm, mm, rad] of its parts has taken it.

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> displaced(wr.patterns.chain(2, joint="tee", gap=0.02), np.array([[0, 0, 0], [0.01, 0, 0]])).rest[1, 0]
    np.float64(1.01)
    """
    if not motion.any():
        return assembly

    def at(parts: tuple[Part, ...]) -> tuple[Part, ...]:
        poses = (assembly.rest + motion).tolist()
        return tuple(replace(p, at=(x, y, angle)) for p, (x, y, angle) in zip(parts, poses, strict=True))

    return Assembly(at(assembly.parts), replace(assembly.drawing, parts=at(assembly.drawing.parts)))
