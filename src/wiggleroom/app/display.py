"""What the page shows now: the outlines it was sent, and where the parts of its drawing are."""

from __future__ import annotations

import threading
import time
from collections.abc import Hashable

import numpy as np
from msgspec import UNSET, UnsetType
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compare.monte_carlo import swing
from wiggleroom.freespace.free_space import FreeSlices
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.report.page_messages import rings_message
from wiggleroom.schema.replies import Outline, Pose

Floats = NDArray[np.float64]

REPEAT_SECONDS = 3.0
"""Outlines that changed are told with every reply for so long [s]."""


class Display:
    """Outlines and motion that a page shows."""

    def __init__(self) -> None:
        self._outlines: Hashable = None
        self._rings: list[Outline] = []
        self._told, self._since = threading.Event(), 0.0
        self._shown: tuple[Assembly, Floats] | None = None

    def move(self, assembly: Assembly, motion: Floats) -> None:
        """Show the parts at a motion (n, 3)."""
        self._shown = assembly, motion

    def new_rings(self, key: Hashable, assembly: Assembly, stop: threading.Event) -> list[Outline] | UnsetType:
        """Outlines of the shape `key`, where the page may not have them: a page drops replies that a newer request has overtaken."""
        now = time.monotonic()
        if key != self._outlines:
            self._outlines, self._since, self._rings = key, now, rings_message(assembly.parts)
        elif self._told.is_set():
            self._since = now
        elif now > self._since + REPEAT_SECONDS:
            return UNSET
        self._told = stop
        return self._rings

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
