"""An assembly some parts of which were taken away."""

from __future__ import annotations

from dataclasses import replace

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.geometry.bodies import Ints


def without(assembly: Assembly, who: Ints) -> Assembly:
    """The assembly as made, without the parts `who` (k,).

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> without(wr.patterns.chain(3, joint="tee", gap=0.02), np.array([1])).names
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
