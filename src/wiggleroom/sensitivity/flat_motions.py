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
    places : int
        So many are looked at on each line, the last of them its end.
    max_rows_with_places : int
        Where more rows have a force only the ends are looked at.
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
    places: int = 8
    max_rows_with_places: int = 100
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
    """Places on straight lines of optima through a solution, in random directions; none where the motion is the only one as large.

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
    test = _RatioTest.of(program, u, holds, loaded, at.h, jacobian)
    places = SETTINGS.places if len(holds) <= SETTINGS.max_rows_with_places else 1
    found = []
    for k in _distinct(d):
        for sign in (1.0, -1.0):
            direction, change = sign * step[:, k], sign * y[:, k]
            far, end = test.end(direction, change)
            if not np.isfinite(far):
                continue
            free = _free_share(program, u, end)
            for share in free * np.linspace(0, 1, places + 1)[1:] if free > 0 else ():
                found.append(OtherOptimum(u + share * (end - u), force * (1 + share * far * change)))
    return found


@dataclass(frozen=True, eq=False)
class _RatioTest:
    """What ends a straight line of optima from `u` (V,): rows without force, with some `room`, and how parts without force make more.

    `beside` (r, V) are the derivatives of these rows, `aside` those by the `idle` variables, of which none changes by more than `most`;
    `turn` (V,) is how far each variable turns a part [rad].

    Source: the ratio test of active-set methods; Nocedal and Wright, Numerical Optimization, section 16.5.
    """

    u: Floats
    beside: sp.csr_matrix
    room: Floats
    idle: Ints
    aside: sp.csr_matrix
    most: Floats
    turn: Floats

    @classmethod
    def of(
        cls, program: Program, u: Floats, holds: Ints, loaded: Ints, h: Floats, jacobian: sp.csr_matrix
    ) -> _RatioTest:
        """Of a solution with rows `h` (R,), of which some carry the force of the variables `loaded`."""
        others = np.setdiff1d(np.arange(program.rows), holds)
        few = program.rows <= SETTINGS.max_rows
        idle = np.setdiff1d(np.arange(len(u)), loaded) if few else np.zeros(0, dtype=np.int64)
        beside, turn = jacobian[others], np.where(np.arange(len(u)) % 3 == 2, program.scale, 0.0)
        return cls(u, beside, np.maximum(h[others], 0.0), idle, beside[:, idle], _most_aside(program, idle), turn)

    def end(self, direction: Floats, change: Floats) -> tuple[float, Floats]:
        """How far optima lie along a direction (V,), and the point there; forces change by the share `change` (k,) on the way."""
        turn = np.abs(self.turn * direction).max(initial=0.0)
        steady = _far(np.append(-change, turn), np.append(np.ones(len(change)), SETTINGS.max_turn))
        closing = -(self.beside @ direction)
        far = min(steady, _far(closing, self.room))
        if not np.isfinite(far):
            return far, self.u
        end = self.u + far * direction
        if len(self.idle):  # parts without force make room
            furthest = min(steady, _far(closing, self.room + abs(self.aside) @ self.most))
            rows = sp.hstack([sp.csr_matrix(-closing[:, None]), self.aside], format="csr")
            cost = np.append(1.0, np.zeros(len(self.idle)))
            x = maximise(cost, rows, -self.room, np.append(furthest, self.most)).x
            if x is not None and x[0] > far:
                far = float(x[0])
                end = self.u + far * direction
                end[self.idle] += x[1:]
        return far, end


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
