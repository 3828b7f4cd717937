"""IPOPT through CasADi for bodies and planes: an independent check of our method in space.

The program is written down once more as CasADi expressions, in other variables: rotations as modified Rodrigues parameters, normals
of planes by stereographic projection. Derivatives come from CasADi, not from our kernels.

Source: Schaub and Junkins, "Stereographic orientation parameters for attitude dynamics" (1996).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError, Stop
from wiggleroom.solve.casadi_ipopt import IterationMonitor, import_casadi, ipopt_options, iteration_listener
from wiggleroom.solve.factorisation import factor
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential, quaternion
from wiggleroom.spatial.planes.graph_retraction import GraphRetraction
from wiggleroom.spatial.planes.separating_plane_newton import SeparatingPlaneIterate, SeparatingPlaneSystem
from wiggleroom.spatial.planes.separating_plane_program import (
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    beside_rest,
    parted,
)
from wiggleroom.spatial.planes.separating_plane_settings import SETTINGS
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution
from wiggleroom.spatial.planes.spatial_objectives import Nearness, SquaredTravel, SumOfTerms, Term, Twist
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_TWIST = 0.9 * 2 * np.pi
"""The parameters of a rotation grow without limit towards a whole turn [rad]."""
TOLERANCE = 3e-8
"""Relative tolerance of the objective, as in our own method."""
FIRST_MU = 0.1
"""Barrier parameter at the start, in units of the objective's largest derivative per clearance."""


def solve_with_ipopt(
    program: SeparatingPlaneProgram,
    *,
    seed: int = 0,
    horizon: float = np.inf,
    most_turn: float = np.inf,
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> SeparatingPlaneSolution:
    """Largest objective of a program from a point beside rest; options as of `SeparatingPlaneSolver`.

    Raises
    ------
    MissingExtraError
        If CasADi is not installed.
    """
    casadi = import_casadi()
    coordinates = _Coordinates(program)
    start = beside_rest(program, seed)
    at = program.linearise(start)
    unit = float(np.abs(at.gradient).max(initial=0.0)) or 1.0
    x, value, rows = _expressions(casadi, coordinates)
    twisted = any(isinstance(t, Twist) for t in coordinates.objective.terms)
    watch = _SeparatingPlaneMonitor(
        coordinates=coordinates, most_turn=min(most_turn, MAX_TWIST) if twisted else np.inf,
        unit=unit, horizon=horizon, stop=stop, progress=progress,
    )  # fmt: skip
    listener = iteration_listener(casadi, watch, coordinates.variables, program.rows)
    options = ipopt_options(listener, FIRST_MU, TOLERANCE)
    solver = casadi.nlpsol("flex", "ipopt", {"x": x, "f": -value / unit, "g": rows}, options)
    out = solver(x0=coordinates.of(start), lbg=0.0, lam_g0=-FIRST_MU / np.maximum(at.h, 1e-9))
    if watch.error is not None:
        raise watch.error
    if watch.status:
        status = watch.status
    else:
        watch.see(
            np.array(out["x"]).ravel(), -float(out["f"]), np.array(out["g"]).ravel(), -np.array(out["lam_g"]).ravel()
        )
        status = SolverStatus.CONVERGED if solver.stats()["success"] else SolverStatus.FAILED
    return _solution(program, watch, status, unit)


def _solution(
    program: SeparatingPlaneProgram, watch: _SeparatingPlaneMonitor, status: SolverStatus, unit: float
) -> SeparatingPlaneSolution:
    """The last point inside all rows, with the conditions there as our own program sees them."""
    last = program.linearise(watch.path[-1], watch.value)
    slack = np.maximum(last.h, SETTINGS.least_slack)
    state = SeparatingPlaneIterate(last, slack, np.maximum(watch.lam, 1e-300), unit, 0.0, program.start.pose, 0.0)
    lacking = state.residuals(0.0)
    error = max(float(slack @ watch.lam), lacking.imbalance) / max(abs(last.value / unit), 1.0)
    curved = False
    if status is SolverStatus.CONVERGED:
        system = SeparatingPlaneSystem(factor(program.pattern), GraphRetraction(program))
        system.set(state, lacking)
        curved = system.factorise(SETTINGS.least_curvature)
    return SeparatingPlaneSolution(
        last.point, watch.lam * unit / program.length, last.value, status, watch.iteration, tuple(watch.path), error, curved
    )  # fmt: skip


@dataclass(eq=False)
class _Coordinates:
    """Variables x: six for each body that moves, less what is locked, then three for each plane.

    A body's are its displacement and four times its modified Rodrigues parameters, the rotation vector to first order; a plane's are its
    stereographic coordinates from the normal at rest, and the change of its offset. Units are those of the program.
    """

    program: SeparatingPlaneProgram

    def __post_init__(self) -> None:
        """Frames of the planes at rest: normal and two tangents (K, 3, 3)."""
        P = self.program
        if not isinstance(P.objective, SumOfTerms):
            message = f'solver "ipopt" cannot take the objective "{type(P.objective).__name__}"; leave the solver out'
            raise InputError(message)
        self.objective = P.objective
        normal = P.start.n
        least = np.eye(3)[np.abs(normal).argmin(axis=1)]
        first = np.cross(normal, least)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        self.frame = np.stack([normal, first, np.cross(normal, first)], axis=1)
        self.tilt = P.length / (2 * P.lever)
        self.bodies = int((P.slot >= 0).sum())
        self.variables = self.bodies + 3 * P.planes

    def of(self, point: SeparatingPlanePoint) -> Floats:
        """Variables of a point."""
        P, q = self.program, quaternion(point.pose.R)
        q = np.where(q[:, :1] < 0, -q, q)
        change = np.hstack([point.pose.T - P.bodies.at, 4 * q[:, 1:] / (1 + q[:, :1])])
        seen = np.einsum("kij,kj->ki", self.frame, point.n)
        y = seen[:, 1:] / (1 + seen[:, :1]) / self.tilt[:, None]
        planes = np.column_stack([y, (point.d - P.start.d) / P.length])
        return np.concatenate([P.packed(change / P.scale), planes.ravel()])

    def largest_turn(self, change: Floats) -> float:
        """Largest turn of a body [rad] in a change of the variables, to first order."""
        P = self.program
        return float(np.abs((P.unpacked(change[: self.bodies]) * P.scale)[:, 3:]).max(initial=0.0))

    def point(self, x: Floats) -> SeparatingPlanePoint:
        """The point that has some variables."""
        P = self.program
        change = P.unpacked(x[: self.bodies]) * P.scale
        p = change[:, 3:] / 4
        length = np.linalg.norm(p, axis=1, keepdims=True)
        turn = p * np.where(length > 1e-150, 4 * np.arctan(length) / np.maximum(length, 1e-150), 4.0)
        planes = x[self.bodies :].reshape(-1, 3)
        y = planes[:, :2] * self.tilt[:, None]
        square = (y**2).sum(axis=1, keepdims=True)
        n = np.einsum("ki,kij->kj", np.hstack([1 - square, 2 * y]) / (1 + square), self.frame)
        pose = SpatialPose(P.bodies.at + change[:, :3], exponential(turn))
        return SeparatingPlanePoint(pose, n, P.start.d + P.length * planes[:, 2])


def _expressions(casadi: Any, of: _Coordinates) -> tuple[Any, Any, Any]:
    """Variables x, objective [mm or rad] and rows (R,) in units of `length`, as sparse CasADi expressions."""
    P = of.program
    x = casadi.MX.sym("x", of.variables)
    column = [_column(casadi, x, P.slot[:, k]) * P.scale[:, k] for k in range(6)]
    T = [column[k] + P.bodies.at[:, k] for k in range(3)]
    p = [column[k] / 4 for k in range(3, 6)]
    R = _rotation(p)
    value = sum(_term(casadi, term, P, column, p, R) for term in of.objective.terms)
    return x, value, _rows(casadi, of, x, T, R) / P.length


def _column(casadi: Any, x: Any, slot: Ints) -> Any:
    """One variable of all bodies, zero where it is locked."""
    return casadi.vertcat(x, 0)[np.where(slot >= 0, slot, x.shape[0]).tolist(), 0]


def _rotation(p: list) -> list[list]:
    """Rotation matrices of modified Rodrigues parameters, entry by entry."""
    square = p[0] ** 2 + p[1] ** 2 + p[2] ** 2
    below = (1 + square) ** 2
    cross = [[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]]
    twice = [[p[i] * p[j] - (square if i == j else 0) for j in range(3)] for i in range(3)]
    return [
        [(1.0 if i == j else 0.0) + (8 * twice[i][j] + 4 * (1 - square) * cross[i][j]) / below for j in range(3)]
        for i in range(3)
    ]


def _term(casadi: Any, term: Term, program: SeparatingPlaneProgram, column: list, p: list, R: list[list]) -> Any:
    """One term of the objective."""

    def place(b: int, arm: Floats) -> list:
        at = program.bodies.at[b]
        return [column[i][b] + at[i] + sum(R[i][j][b] * arm[j] for j in range(3)) for i in range(3)]

    match term:
        case Twist():
            turn = [entry[term.body] for entry in p]
            along = sum(term.direction[k] * turn[k] for k in range(3))
            return term.weight * 2 * casadi.atan2(2 * along, 1 - sum(t**2 for t in turn))
        case Nearness():
            ends = [place(b, arm) for b, arm in zip((term.one, term.other), term.arms, strict=True)]
            return term.weight * (term.apart - sum((x - y) ** 2 for x, y in zip(*ends, strict=True)))
    begin = term.rest + term.arm
    moved = [x - begin[i] for i, x in enumerate(place(term.body, term.arm))]
    if isinstance(term, SquaredTravel):
        return term.weight * sum(x**2 for x in moved)
    return sum(term.direction[i] * moved[i] for i in range(3))


def _rows(casadi: Any, of: _Coordinates, x: Any, T: list, R: list[list]) -> Any:
    """Rows (R,) [mm]: corners of A behind the plane, those of B before it, in A's frame."""
    P = of.program
    own = np.arange(P.rows) - np.repeat(P.row[:-1], np.diff(P.row)) < np.repeat(P.own, np.diff(P.row))
    plane = np.repeat(np.arange(P.planes), np.diff(P.row))
    planes = casadi.reshape(x[of.bodies :], 3, P.planes).T
    y = [planes[:, k] * of.tilt for k in range(2)]
    square = y[0] ** 2 + y[1] ** 2
    n = [
        (of.frame[:, 0, i] * (1 - square) + 2 * of.frame[:, 1, i] * y[0] + 2 * of.frame[:, 2, i] * y[1]) / (1 + square)
        for i in range(3)
    ]
    level = P.start.d + P.length * planes[:, 2] + sum(n[i] * P.c[:, i] for i in range(3))
    k = plane[own]
    behind = level[k.tolist(), 0] - sum(n[i][k.tolist(), 0] * P.V[own, i] for i in range(3))
    k = plane[~own]
    pair = np.repeat(np.arange(len(P.a)), np.diff(P.plane))[k]
    a, b = P.a[pair].tolist(), P.b[pair].tolist()
    corner = P.V[~own]
    world = [T[i][b] + sum(R[i][j][b] * corner[:, j] for j in range(3)) - T[i][a] for i in range(3)]
    seen = [sum(R[i][j][a] * world[i] for i in range(3)) for j in range(3)]
    before = sum(n[i][k.tolist(), 0] * seen[i] for i in range(3)) - level[k.tolist(), 0]
    back = np.argsort(np.concatenate([np.flatnonzero(own), np.flatnonzero(~own)]))
    return casadi.vertcat(behind, before)[back.tolist(), 0]


@dataclass(eq=False, kw_only=True)
class _SeparatingPlaneMonitor(IterationMonitor):
    """What is kept of the iterates: the path inside all rows, and the last multipliers."""

    coordinates: _Coordinates
    most_turn: float
    value: float = 0.0
    lam: Floats = field(init=False)
    before: Floats = field(init=False)
    path: list[SeparatingPlanePoint] = field(init=False)

    def __post_init__(self) -> None:
        """Begin at rest."""
        program = self.coordinates.program
        self.lam, self.path = np.zeros(program.rows), [program.start]
        self.before = self.coordinates.of(program.start)

    def keep(self, u: Floats, value: float, h: Floats, lam: Floats) -> bool:  # noqa: ARG002
        """Keep one iterate; True where it is beyond the horizon or turns without limit."""
        program = self.coordinates.program
        self.lam = np.maximum(lam, 0.0)
        steps = 1 + int(self.coordinates.largest_turn(u - self.before))
        for share in np.linspace(0, 1, steps + 1)[1:]:
            point = self.coordinates.point(self.before + share * (u - self.before))
            rows = program.values(point)
            if rows.min(initial=np.inf) <= 0:
                point = parted(program, point, rows)
            if program.values(point).min(initial=np.inf) > 0:
                self.path.append(point)
                self.value = program.objective.value(point.pose, self.value)
        self.before = u
        moved = np.abs(self.path[-1].pose.T - program.bodies.at).max(initial=0.0)
        return bool(moved > self.horizon or abs(self.value) > self.most_turn)
