"""Bodies in the plane, as their freedoms are looked for: the walls at rest hold them."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.errors import Stop
from wiggleroom.geometry.bodies import Bodies, corners
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.live.loose_modes import Side, cut_off, picked
from wiggleroom.live.warm_start import TimeBudget, WarmSearch, state_at_rest
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, PointMotion, Points
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class PlanarLoose:
    """See `wiggleroom.live.loose_modes.LooseBodies`.

    Parameters
    ----------
    ready : Prepared
    """

    def __init__(self, ready: Prepared) -> None:
        self._ready = ready
        self._program = build_program(ready.bodies, ready.cells, ZERO_MOTION, length=ready.clearance)
        self.names, self.members = ready.assembly.names, tuple(map(tuple, ready.bodies.members))
        self.clearance = ready.clearance

    def stiffness(self) -> sp.csc_matrix:
        """Second derivatives of the barrier of the walls."""
        program = self._program
        n = len(program.scale)
        at = program.linearise(np.zeros(n))
        data = at.condensed(1.0 / np.maximum(at.h, 1e-9) ** 2, np.zeros(program.rows), share=0.0)
        upper = sp.csc_matrix((data, program.pattern.indices, program.pattern.indptr), shape=(n, n))
        return sp.csc_matrix(upper + sp.triu(upper, 1).T)

    def variables(self, body: int) -> Ints:
        """Which variables are freedoms of a body."""
        return np.asarray(3 * self._program.slot[body] + np.arange(3))

    def followed(self, direction: Floats, until: Stop) -> Side:
        """The largest motion along a direction."""
        assert isinstance(until, TimeBudget)
        ready, program = self._ready, self._program
        weights = (direction / program.scale).reshape(-1, 3)
        weights = weights / np.abs(weights[:, :2]).max(initial=1e-300)
        goal = PointMotion(program.free, weights[:, :2].copy(), np.zeros((len(program.free), 2)), weights[:, 2].copy())
        warm = WarmSearch(ready, goal, state_at_rest(ready), until)
        warm.reach()
        search = warm.search
        shown = np.zeros((1, len(ready.bodies.fixed), 3))
        if search.best is not None:
            checked = search.checked_path(search.best)
            motions, safe = checked.motions()[: checked.certain], OVERLAP_TOLERANCE * ready.size
            if search.unlimited:
                motions = motions[: cut_off(np.array([_furthest(ready.bodies, m).max() for m in motions]), ready.size)]
            some = motions[picked(len(motions))]
            free = [m for m in some if overlaps(ready.bodies, m, ready.ignored).deepest <= safe]
            shown = np.concatenate([shown, *(m[None] for m in free[1:])])
        endless = search.best is not None and search.unlimited
        end = program.variables(shown[-1])
        return Side(of_parts(ready.assembly, ready.bodies, shown), end, _furthest(ready.bodies, shown[-1]), endless)


def _furthest(bodies: Bodies, motion: Floats) -> Floats:
    """How far the furthest corner of each body is moved (n,) [mm]."""
    body, spot = corners(bodies)
    moved = Points(body, spot - bodies.rest[body, :2]).moved(motion)
    out = np.zeros(len(bodies.fixed))
    np.maximum.at(out, body, np.hypot(*moved.T))
    return out
