"""Motions that are as large as the largest: how parts that carry force may slide on what they lie on without loss.

A bar that is pulled against two stops may slide along them: where it lies decides how they share the load, so what the gap of
either is worth is another number at every place. To first order these optima are the null space of the KKT matrix of the rows
that hold, in motions and multipliers together. Parts that carry no force make room for them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.sensitivity.dual_face import null_space_sample
from wiggleroom.solve.linear_programming import maximise

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
    max_rows : int
        In programs with more rows parts without force stay where they are.
    max_advances : int
        Steps on the way to another optimum, each as long as bodies without walls between them are surely apart.
    min_advance : float
        The way ends after a step that is a smaller share of what came before it.
    same_direction : float
        Cosine from which on two directions count as one.
    """

    min_motion: float = 1e-4
    max_turn: float = 0.2
    max_rows: int = 3000
    max_advances: int = 30
    min_advance: float = 1e-4
    same_direction: float = 1 - 1e-9


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
    curvature = -(upper + sp.triu(upper, 1).T)  # of the Lagrangian; a condensed matrix holds its opposite
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
    others = np.setdiff1d(np.arange(program.rows), holds)
    room, beside = np.maximum(at.h[others], 0.0), jacobian[others]
    closing = -(beside @ step)
    turn = np.abs(step[2::3] * program.scale[2::3, None]).max(axis=0, initial=0.0)
    idle = np.setdiff1d(np.arange(len(u)), loaded) if program.rows <= SETTINGS.max_rows else np.zeros(0, dtype=np.int64)
    aside, most = beside[:, idle], _most_aside(program, idle)
    steady_room = np.append(np.ones(len(holds)), SETTINGS.max_turn)
    found = []
    for k in _distinct(d):
        for sign in (1.0, -1.0):
            steady = _far(np.append(-sign * y[:, k], turn[k]), steady_room)
            far = min(steady, _far(sign * closing[:, k], room))
            if not np.isfinite(far):
                continue
            end = u + far * sign * step[:, k]
            if len(idle):  # parts without force make room
                furthest = min(steady, _far(sign * closing[:, k], room + abs(aside) @ most))
                rows = sp.hstack([sp.csr_matrix(-sign * closing[:, k : k + 1]), aside], format="csr")
                cost = np.append(1.0, np.zeros(len(idle)))
                x = maximise(cost, rows, -room, np.append(furthest, most)).x
                if x is not None and x[0] > far:
                    far = float(x[0])
                    end = u + far * sign * step[:, k]
                    end[idle] += x[1:]
            free = _free_share(program, u, end)
            if free > 0:
                found.append(OtherOptimum(u + free * (end - u), force * (1 + free * far * sign * y[:, k])))
    return found


def _free_share(program: Program, u: Floats, end: Floats) -> float:
    """Share of the straight way to `end` (V,) on which bodies without walls between them in the program surely do not meet.

    Pairs that overlap where it begins are those that are ignored. Source: conservative advancement; Mirtich, Impulse-based Dynamic
    Simulation of Rigid Body Systems (1996).
    """
    bodies, one, other = program.bodies, program.motion(u), program.motion(end)
    change = other - one
    speed = np.hypot(*change[:, :2].T) + bodies.radius * np.abs(change[:, 2])
    middle, reach = bodies.rest[:, :2] + one[:, :2], bodies.radius + speed
    discs = shapely.box(*(middle - reach[:, None]).T, *(middle + reach[:, None]).T)
    a, b = shapely.STRtree(discs).query(discs)
    pair = np.column_stack([program.cells.a, program.cells.b]).astype(np.int64)
    walled = np.isin(a * len(speed) + b, pair.min(axis=1) * len(speed) + pair.max(axis=1))
    some = (a < b) & ~walled & (speed[a] + speed[b] > 0) & ~(bodies.fixed[a] & bodies.fixed[b])
    a, b = a[some], b[some]
    begin = placed(bodies, one)
    apart = shapely.distance(begin[a], begin[b])
    a, b, apart = a[apart > 0], b[apart > 0], apart[apart > 0]
    closing = speed[a] + speed[b]
    share = 0.0
    for _ in range(SETTINGS.max_advances):
        step = float((apart / closing).min(initial=np.inf))
        share += step
        if share >= 1:
            return 1.0
        there = placed(bodies, one + share * change)
        apart = shapely.distance(there[a], there[b])
        if step < SETTINGS.min_advance * share:
            break
    return share


def _most_aside(program: Program, idle: Ints) -> Floats:
    """How far variables of parts without force may change: turns by `max_turn`, shifts by as much at the rim."""
    radius = program.bodies.radius[program.free[idle // 3]]
    return SETTINGS.max_turn * np.where(idle % 3 < 2, radius, 1.0) / program.scale[idle]


def _far(speed: Floats, room: Floats) -> float:
    """How far a motion gets that uses up room at some speeds."""
    blocks = speed > 0
    return float((room[blocks] / speed[blocks]).min(initial=np.inf))


def _distinct(d: Floats) -> list[int]:
    """Columns of directions (V, m) of which no earlier one is the same or the opposite."""
    unit = d / np.hypot.reduce(d, axis=0)
    kept: list[int] = []
    for k in range(d.shape[1]):
        if not kept or np.abs(unit[:, kept].T @ unit[:, k]).max() < SETTINGS.same_direction:
            kept.append(k)
    return kept
