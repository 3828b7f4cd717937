"""Motions that are as large as the largest: how parts that carry force may slide on what they lie on without loss.

A bar that is pulled against two stops may slide along them: where it lies decides how they share the load, so what the gap of
either is worth is another number at every place. To first order these optima are the null space of the KKT matrix of the rows
that hold, in motions and multipliers together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Program
from wiggleroom.sensitivity.dual_face import null_space_sample

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class FlatMotionSettings:
    """Parameters of the search for other optima.

    Parameters
    ----------
    min_motion : float in (0, 1)
        A random direction of which less than this share is motion changes forces alone.
    max_turn : float [rad]
        No part turns by more: the optima are followed along straight lines.
    """

    min_motion: float = 1e-4
    max_turn: float = 0.2


SETTINGS = FlatMotionSettings()


@dataclass(frozen=True, eq=False)
class OtherOptimum:
    """A point as good as the solution, to first order: variables `u` (V,) and the multipliers `force` (k,) of the rows that hold there."""

    u: Floats
    force: Floats


def other_optima(program: Program, u: Floats, holds: Ints, force: Floats) -> list[OtherOptimum]:
    """Ends of straight lines of optima through a solution, in random directions; none where the motion is the only one as large.

    Parameters
    ----------
    program : Program
    u : (V,) float64
        The solution.
    holds : (k,) int64
        Rows with a force.
    force : (k,) float64
        Their multipliers, in units of the program.

    Source: the null space of the KKT matrix; Nocedal and Wright, Numerical Optimization, section 16.1.
    """
    if not len(holds):
        return []
    at = program.linearise(u)
    jacobian = at.jacobian()
    size = force.max()
    share = force / size
    lam = np.zeros(program.rows)
    lam[holds] = force
    pattern = program.pattern
    upper = sp.csc_matrix((at.condensed(np.zeros(program.rows), lam) / size, pattern.indices, pattern.indptr))
    curvature = upper + sp.triu(upper, 1).T
    scaled = (sp.diags_array(share) @ jacobian[holds]).tocsr()
    loaded = np.flatnonzero(np.repeat(abs(scaled).sum(axis=0).reshape(-1, 3).any(axis=1), 3))
    curvature, scaled = curvature[loaded][:, loaded], scaled[:, loaded]
    kkt = sp.block_array([[curvature, scaled.T], [scaled, None]], format="csr")
    z = null_space_sample(kkt)
    d, y = z[: len(loaded)], z[len(loaded) :]
    some = np.hypot.reduce(d, axis=0) > SETTINGS.min_motion
    d, y = d[:, some], y[:, some]
    y = y - null_space_sample(scaled, y)  # only the change of forces that the motion needs
    step = np.zeros((len(u), d.shape[1]))
    step[loaded] = d
    room = np.maximum(np.delete(at.h, holds), 0.0)
    closing = -np.delete((jacobian @ step), holds, axis=0)
    turn = np.abs(step[2::3] * program.scale[2::3, None]).max(axis=0, initial=0.0)
    found = []
    for k in range(step.shape[1]):
        for sign in (1.0, -1.0):
            speed = np.concatenate([sign * closing[:, k], -sign * y[:, k], turn[k : k + 1]])
            least = np.concatenate([room, np.ones(len(holds)), [SETTINGS.max_turn]])
            blocks = speed > 0
            far = sign * float((least[blocks] / speed[blocks]).min(initial=np.inf))
            if np.isfinite(far):
                found.append(OtherOptimum(u + far * step[:, k], force * (1 + far * y[:, k])))
    return found
