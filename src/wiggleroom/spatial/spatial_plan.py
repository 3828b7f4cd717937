"""Plans in space: in which order and along which paths parts are taken apart, each stage begun where the one before ended."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.disassembly_sequence import Disassembly
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.plan import Plan, check_targets, planned
from wiggleroom.spatial.spatial_disassembly import SpatialStages
from wiggleroom.spatial.spatial_plan_geometry import SpatialPlanGeometry

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def plan_spatial(
    assembly: Assembly, targets: Sequence[str] = (), *, gravity: tuple[float, ...] | None = None, context: Context
) -> Plan:
    """Plan how an assembly in space is taken apart; see `wiggleroom.plan`.

    Raises
    ------
    InputError
        If a target is unknown or fixed, there is only one body, or all are fixed; if gravity has no direction.
    TouchingError
        If two parts touch at rest.
    """
    began = time.perf_counter()
    targets = tuple(dict.fromkeys(targets))
    standing = with_ground(assembly)
    check_targets(standing, targets)
    geometry = SpatialPlanGeometry(standing)
    weight = None if gravity is None else Gravity(geometry.falling(), gravity)
    look = SpatialStages(standing, context)
    n = len(standing.names)
    done = Disassembly(standing.names, look.stages, np.zeros((n, 6)))
    done.last = done.take_apart(np.arange(n), targets=targets)
    stuck = look.stuck
    for departure in done.departures:  # taking those apart that left together adds more
        if targets or context.stopped:
            break
        if len(departure.parts) > 1:
            done.take_apart(departure.parts)
            stuck += look.stuck
    done.together = tuple(stuck)
    return planned(assembly, targets, done, geometry, weight, context, began)
