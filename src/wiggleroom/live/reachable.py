"""Where a point of a part can be brought: of two bodies from their free space, of more by samples."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.free_space import free_slices
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.live.live_session import Live

Floats = NDArray[np.float64]
Spot = tuple[float, float]

DIRECTIONS = 24
"""Number of directions in which a point is pulled where several bodies move."""
SLICES = 128
"""Number of turns at which slices are made where one body moves in another."""
FAR = 2.0
"""Distance of the targets [drawing sizes]."""
DRAG_SECONDS = 0.4
"""A drag to one of them takes no longer [s]."""


@dataclass(frozen=True, eq=False)
class Reach:
    """Places that a point of a part can be brought to.

    Parameters
    ----------
    region : shapely polygon or multipolygon [mm]
    exact : bool
        True where it is worked out from the free space, all of it at many turns; False where its corners alone were reached.
    open : bool
        True where the part leaves: the region is cut off.
    """

    region: shapely.Geometry
    exact: bool
    open: bool


def reachable_region(live: Live, part: str, grip: Spot, *, stop: Stop | None = None) -> Reach:
    """Bring a point of a part, given at rest [mm], as far as it goes from rest in all directions; the session stays where it is.

    Raises
    ------
    InputError
        If there is no such part, or it cannot move.
    StoppedError
        If it was asked to stop.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = reachable_region(wr.Live(wr.patterns.chain(2, joint="tee", gap=0.02)), "b2", (1.0, 0.0))
    >>> found.exact, round(found.region.bounds[2] - 1.0, 3)
    (True, 0.02)
    """
    assembly = live.assembly
    bodies = live.ready.bodies
    if len(bodies.fixed) == 2 and bodies.fixed.sum() == 1:
        fixed = int(np.flatnonzero(bodies.fixed)[0])
        space = free_slices(assembly, assembly.names[bodies.members[fixed][0]], part, SLICES, stop=stop)
        at = assembly.rest[assembly.names.index(space.parts[0])]
        arm = rotated(np.subtract(grip, assembly.rest[assembly.names.index(part), :2])[None], np.array([-at[2]]))[0]
        angles = np.array([s.angle for s in space.slices])
        swing = rotated(np.tile(arm, (len(angles), 1)), angles) - arm
        shifted = [shapely.transform(s.region, lambda p, d=d: p + d) for s, d in zip(space.slices, swing, strict=True)]
        own = shapely.union_all(shifted)
        region = shapely.transform(own, lambda p: rotated(p, np.array([at[2]])) + grip)
        return Reach(region, exact=True, open=not space.closed)
    far, places, leaves = FAR * live.ready.size, [], False
    with live.aside():
        for k in range(DIRECTIONS):
            go_on(stop)
            angle = 2 * math.pi * k / DIRECTIONS
            target = (grip[0] + far * math.cos(angle), grip[1] + far * math.sin(angle))
            result = live.drag(part, grip, target, start="rest", seconds=DRAG_SECONDS, stop=stop)
            assert result.reached is not None
            places.append(result.reached)
            leaves = leaves or math.dist(result.reached, grip) > 0.9 * far
    return Reach(shapely.Polygon(places).buffer(0), exact=False, open=leaves)
