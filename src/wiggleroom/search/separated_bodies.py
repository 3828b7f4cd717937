"""Free bodies that walls keep apart from all that is pulled, for ever: what is asked does not depend on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal, part_of
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.search.prepare import Prepared


def without_separated(ready: Prepared, goals: Sequence[Goal]) -> Assembly:
    """The assembly, with those free bodies fixed that no motion brings near to a pulled one.

    Fixed material cuts the plane into pieces. A body stays in the pieces in which it lies at rest, and meets only others that lie there.
    """
    assembly, bodies = ready.assembly, ready.bodies
    free = np.flatnonzero(~bodies.fixed)
    asked = {part_of(goal) for goal in goals}
    pulled = [bodies.body_of[k] for k, name in enumerate(assembly.names) if name in asked]
    meets = np.isin(free, pulled)
    if None in asked or meets.all():
        return assembly
    geometry, n = placed(bodies), len(bodies.fixed)
    passed = np.union1d(ready.ignored // n, ready.ignored % n)  # others may go through these
    walls = shapely.union_all(geometry[np.setdiff1d(np.flatnonzero(bodies.fixed), passed)])
    x0, y0, x1, y1 = shapely.total_bounds(geometry)
    margin = max(x1 - x0, y1 - y0)
    window = shapely.box(x0 - margin, y0 - margin, x1 + margin, y1 + margin)
    pieces = shapely.get_parts(shapely.difference(window, walls))
    lies = np.asarray(shapely.intersects(geometry[free][:, None], pieces[None]))
    if not lies.any(axis=1).all():
        return assembly
    before = np.zeros_like(meets)
    while (meets != before).any():
        before = meets
        here = np.flatnonzero(lies[meets].any(axis=0))
        meets = np.asarray(lies[:, here].any(axis=1))
    still = {assembly.names[part] for body in free[~meets] for part in bodies.members[body]}
    if not still:
        return assembly
    return replace(assembly, parts=tuple(replace(p, fixed=p.fixed or p.name in still) for p in assembly.parts))
