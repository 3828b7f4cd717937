"""How thick the shell of a part may be: a share of the least gap to the other parts at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wiggleroom.drawing.model import Drawing, MadeSolid, Surface
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.errors import Stop, go_on
from wiggleroom.spatial.solids.solid_boolean import solid_of

SHARE = 1e-3
"""Share of the least gap by which a shell may stand out of its part where that is sharp."""
LEAST = 1e-7
"""Shells are no thinner than this share of the size of their part."""
MOST = 1e-4
"""Nor thicker than this."""


def shell_thickness(
    drawing: Drawing, solids: Sequence[MadeSolid], users: Sequence[int], stop: Stop | None = None
) -> float:
    """Thickness [mm] of the shell of a solid of which some parts of a drawing are made."""
    may = collidable(drawing.glue, drawing.ignore)
    size = float(np.ptp(solids[users[0]].surface.vertices, axis=0).max())
    least = MOST * size / SHARE
    for user in users:
        own, part = solid_of(solids[user].surface), drawing.parts[user]
        for its, made in zip(drawing.parts, solids, strict=True):
            if its is part or not may(its.name, part.name):
                continue
            go_on(stop)
            seen = (made.surface.vertices @ its.R.T + its.at - part.at) @ part.R
            least = min(least, _gap(own, solid_of(Surface(seen, made.surface.faces)), least))
    return max(SHARE * least, LEAST * size)


def _gap(one: Any, other: Any, most: float) -> float:
    """Least distance of two solids of the library [mm], or `most` where it is more."""
    reach = most / 256  # a longer reach compares more faces
    while reach < most:
        found = float(one.min_gap(other, reach))
        if found < reach:
            return found
        reach *= 4
    return float(one.min_gap(other, most))
