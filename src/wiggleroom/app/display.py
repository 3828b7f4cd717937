"""What the page shows now: the outlines it was sent, and where the parts of its drawing are."""

from __future__ import annotations

from collections.abc import Hashable
from hashlib import blake2s
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.app.dimension_messages import Outlines, shapes_of
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.compare.monte_carlo import swing
from wiggleroom.freespace.free_space import FreeSlices
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.schema.reply_base import Pose

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly

Floats = NDArray[np.float64]

NAME_BYTES = 12
"""Length of the name of outlines."""


class Display:
    """Outlines and motion that a page shows."""

    def __init__(self) -> None:
        self._key: Hashable = None
        self._outlines = Outlines("", [])
        self._shown: tuple[Assembly, Floats] | None = None

    def move(self, assembly: Assembly, motion: Floats) -> None:
        """Show the parts at a motion (n, 3); of parts in space nothing asks for it later."""
        self._shown = (assembly, motion) if assembly.dimension == 2 else None

    def new_outlines(self, key: Hashable, assembly: Assembly, shown: str) -> Outlines | None:
        """Outlines or solids that depend on `key`; None where the page shows them already: those named `shown`."""
        name = blake2s(repr(key).encode(), digest_size=NAME_BYTES).hexdigest()
        if name == shown:
            return None
        if key != self._key:
            self._key, self._outlines = key, Outlines(name, shapes_of(assembly))
        return self._outlines

    def relative(self, space: FreeSlices) -> Pose:
        """Where the pair of a free space is shown: motion of its pivot [mm] and turn [deg]."""
        if self._shown is None or not set(space.parts) <= set(self._shown[0].names):
            return 0.0, 0.0, 0.0
        assembly, motion = self._shown
        a, b = (assembly.names.index(name) for name in space.parts)
        rest, now = assembly.rest, assembly.rest + motion
        tau = rotated(now[b, :2] - now[a, :2], -now[a, 2]) - rotated(rest[b, :2] - rest[a, :2], -rest[a, 2])
        phi = motion[b, 2] - motion[a, 2]
        pivot = tau + swing(space, np.array([phi]))[0]
        return float(pivot[0]), float(pivot[1]), float(np.degrees(phi))
