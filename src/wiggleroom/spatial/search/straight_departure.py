"""Which parts can go straight in one direction, for ever: what is ahead of them comes along or stops them.

Source: the blocking graph of Wilson and Latombe 1994, with the check of whole paths in place of infinitesimal steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared

Floats = NDArray[np.float64]

FAR = 3.0
"""A part that left is shown this many times as far away as all parts are spread."""


class StraightDeparture:
    """Bodies that block each other on the path in a direction (3,) from a motion (n, 6); once it was asked to stop none leaves."""

    def __init__(self, ready: SpatialPrepared, motion: Floats, direction: Floats, stop: Stop | None = None) -> None:
        self._ready, self._motion, self._direction, self._stop = ready, motion, direction, stop
        moves = ready.grouping.bodies.free[:, :3]
        self._loose: NDArray[np.bool_] = np.asarray(moves[:, np.abs(direction) > 1e-12].all(axis=1))
        self._blocked: dict[int, set[int]] = {}

    def parts_with(self, bodies: Sequence[int]) -> list[int]:
        """Parts that leave together with these bodies; empty where something that stands, or everything, would have to."""
        group, todo = set(bodies), list(bodies)
        while todo:
            body = todo.pop()
            if not self._loose[body]:
                return []
            ahead = self._ahead(body) - group
            group |= ahead
            todo += ahead
        if not group or len(group) == len(self._loose):
            return []
        return [k for k, body in enumerate(self._ready.grouping.body_of.tolist()) if body in group]

    def first(self) -> list[int]:
        """Parts of the first group that leaves; empty where none does."""
        return next((found for body in range(len(self._loose)) if (found := self.parts_with([body]))), [])

    def end(self, parts: Sequence[int]) -> Floats:
        """Motion (n, 6) with these parts far away."""
        end = self._motion.copy()
        places = self._ready.assembly.reference + end[:, :3]
        spread = float(np.ptp(places, axis=0).max()) + self._ready.size
        end[list(parts), :3] += FAR * spread * self._direction
        return end

    def _ahead(self, body: int) -> set[int]:
        """Other bodies that a body meets."""
        if body not in self._blocked:
            body_of = self._ready.grouping.body_of
            mine = np.flatnonzero(body_of == body).tolist()
            pairs = self._ready.checker.doubtful(self._motion, self.end(mine), only=mine, stop=self._stop)
            self._blocked[body] = {int(body_of[k]) for pair in pairs for k in pair} - {body}
        return self._blocked[body]
