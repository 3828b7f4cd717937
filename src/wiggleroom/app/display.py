"""What the page shows now: the outlines it was sent, and where the parts of its drawing are."""

from __future__ import annotations

import threading
import time
from collections.abc import Hashable
from typing import TYPE_CHECKING

import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from wiggleroom.app.dimension_messages import Shapes, shapes_of
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compare.monte_carlo import swing
from wiggleroom.freespace.free_space import FreeSlices
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.schema.replies import Outline, Pose, Solids

if TYPE_CHECKING:
    from wiggleroom.spatial.spatial_model import SpatialAssembly

Floats = NDArray[np.float64]

REPEAT_SECONDS = 3.0
"""Outlines that changed are told with every reply for so long [s]."""


class Display:
    """Outlines and motion that a page shows."""

    def __init__(self) -> None:
        self._outlines: Hashable = None
        self._shapes: list[Outline] | Solids = []
        self._told, self._since = threading.Event(), 0.0
        self._shown: tuple[Assembly, Floats] | None = None

    def move(self, assembly: Assembly | SpatialAssembly, motion: Floats) -> None:
        """Show the parts at a motion (n, 3); of parts in space nothing asks for it later."""
        self._shown = (assembly, motion) if isinstance(assembly, Assembly) else None

    def new_shapes(self, key: Hashable, assembly: Assembly | SpatialAssembly, stop: threading.Event) -> Shapes:
        """Outlines or solids of the shape `key` where the page may lack them: it drops replies that a newer request has overtaken."""
        now = time.monotonic()
        if key != self._outlines:
            self._outlines, self._since, self._shapes = key, now, shapes_of(assembly)
        elif self._told.is_set():
            self._since = now
        elif now > self._since + REPEAT_SECONDS:
            return UNSET
        self._told = stop
        return self._shapes

    def relative(self, space: FreeSlices) -> Pose:
        """Where the pair of a free space is shown: motion of its pivot [mm] and turn [deg]."""
        if self._shown is None or not set(space.parts) <= set(self._shown[0].names):
            return 0.0, 0.0, 0.0
        assembly, motion = self._shown
        a, b = (assembly.names.index(name) for name in space.parts)
        rest, now = assembly.rest, assembly.rest + motion
        tau = turn(now[b, :2] - now[a, :2], -now[a, 2]) - turn(rest[b, :2] - rest[a, :2], -rest[a, 2])
        phi = motion[b, 2] - motion[a, 2]
        pivot = tau + swing(space, np.array([phi]))[0]
        return float(pivot[0]), float(pivot[1]), float(np.degrees(phi))
