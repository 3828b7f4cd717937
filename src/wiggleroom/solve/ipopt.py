"""IPOPT through CasADi: the paper's solver, and an independent check of ours.

The program is written down once more as CasADi expressions, so first and second derivatives come from CasADi, not from
our kernels.

Source: Mind the Gap, section 4.4; Waechter and Biegler, "On the implementation of an interior-point filter line-search
algorithm for large-scale nonlinear programming" (2006).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError, Stop
from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE, FACE, HIGH_TURN, LOW_TURN
from wiggleroom.program.constraint_rows import Rows
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.program.objectives import Nearness, PointMotion, Points, SquaredTravel, Sum
from wiggleroom.solve.casadi_ipopt import IterationMonitor, import_casadi, ipopt_options, iteration_listener
from wiggleroom.solve.interior_point_settings import INITIAL_BARRIER, WARM_START_GAP
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def solve(
    program: Program,
    start: Floats | None = None,
    *,
    mu: float = INITIAL_BARRIER,
    tolerance: float = 1e-6,
    horizon: float = np.inf,
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Solution:
    """Largest objective from a point strictly inside all rows; see `wiggleroom.solve.interior_point.solve`.

    Raises
    ------
    MissingExtraError
        If CasADi is not installed.
    InputError
        If the objective is of a kind that has no CasADi expression.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01), solver="ipopt")
    >>> round(answer.objective, 4)
    0.0261
    """
    casadi = import_casadi()
    u = np.zeros(len(program.scale)) if start is None else start
    at = program.linearise(u)
    unit = float(np.abs(at.gradient).max()) or 1.0
    watch = _IpoptMonitor(program=program, u=u, unit=unit, horizon=horizon, stop=stop, progress=progress)
    variables, value, rows = _expressions(casadi, program)
    nlp = {"x": variables, "f": -value / unit, "g": rows}
    listener = iteration_listener(casadi, watch, len(program.scale), program.rows)
    solver = casadi.nlpsol("flex", "ipopt", nlp, ipopt_options(listener, mu, tolerance))
    out = solver(x0=u, lbg=0.0, lam_g0=-mu / np.maximum(at.h, 1e-9))
    if watch.error is not None:
        raise watch.error
    stats = solver.stats()
    if watch.status:
        end, end_lam, status = watch.u, watch.lam, watch.status
    else:
        end, end_lam = np.array(out["x"]).ravel(), np.maximum(-np.array(out["lam_g"]).ravel(), 0.0)
        status = SolverStatus.CONVERGED if stats["success"] else SolverStatus.FAILED
    left = _error(program, end, end_lam, unit)
    return Solution(end, end_lam * unit, status, watch.iteration, watch.inner, watch.inner_mu, tuple(watch.path), left)


def described() -> str:
    """The linear solver and the options that IPOPT is given, for whoever quotes its times."""
    options = {
        k.removeprefix("ipopt."): v
        for k, v in ipopt_options(None, INITIAL_BARRIER, 1e-6).items()
        if k.startswith("ipopt.")
    }
    told = ("linear_solver", "nlp_scaling_method", "tol", "acceptable_tol", "mu_init", "bound_relax_factor", "max_iter")
    return "through CasADi, exact derivatives; " + ", ".join(f"{name} {options[name]}" for name in told)


def _expressions(casadi: Any, program: Program) -> tuple[Any, Any, Any]:
    """Variables u (3F,), objective [mm] and rows (R,) in units of `program.length`, as sparse CasADi expressions."""
    u = casadi.MX.sym("u", len(program.scale))
    n, rest = len(program.slot), program.bodies.rest
    standing = np.flatnonzero(program.slot < 0)
    order = np.empty((n, 3), dtype=np.int64)  # where each body's motion stands among free ones, then fixed ones
    order[np.concatenate([program.free, standing])] = np.arange(3 * n).reshape(-1, 3)
    motion = casadi.vertcat(u * program.scale, casadi.DM.zeros(3 * len(standing)))
    column = [motion[order[:, k].tolist(), 0] for k in range(3)]
    value = _objective(casadi, program.objective, column)
    pose = [column[k] + rest[:, k] for k in range(3)]
    return u, value, _rows(casadi, program, pose) / program.length


def _objective(casadi: Any, objective: object, motion: list) -> Any:
    """Objective [mm] as an expression of the motions of all bodies, one column each."""
    if isinstance(objective, Sum):
        return sum(_objective(casadi, term, motion) for term in objective.terms)
    if isinstance(objective, SquaredTravel):
        dx, dy = _moved(casadi, objective.points, motion)
        return objective.weight * casadi.sum1(dx**2 + dy**2)
    if isinstance(objective, Nearness):
        (ax, ay), (bx, by) = (_moved(casadi, points, motion) for points in (objective.one, objective.other))
        (x, y), dx, dy = objective.apart.T, bx - ax, by - ay
        return -objective.weight * casadi.sum1(dx * (2 * x + dx) + dy * (2 * y + dy))
    if not isinstance(objective, PointMotion):
        message = (
            f'solver "ipopt" cannot take the objective "{type(objective).__name__}"; use the solver "interior-point"'
        )
        raise InputError(message)
    (dx, dy), (x, y) = objective.direction.T, _moved(casadi, objective.points, motion)
    return casadi.sum1(dx * x + dy * y + objective.turn * motion[2][objective.body.tolist(), 0])


def _moved(casadi: Any, points: Points, motion: list) -> tuple[Any, Any]:
    """Displacements (k,) [mm] of material points along x and y."""
    x, y, angle = (column[points.body.tolist(), 0] for column in motion)
    c, s, (px, py) = casadi.cos(angle), casadi.sin(angle), points.arm.T
    return x + c * px - s * py - px, y + s * px + c * py - py


def _rows(casadi: Any, program: Program, pose: list) -> Any:
    """Rows (R,) [mm] as an expression of the poses of all bodies, one column each.

    Source: Mind the Gap, Eq. (2), corrected, and (4); walls instead of the hull.
    """
    a, b = program.cells.a.tolist(), program.cells.b.tolist()
    c, s = casadi.cos(pose[2][a, 0]), casadi.sin(pose[2][a, 0])
    x, y = pose[0][b, 0] - pose[0][a, 0], pose[1][b, 0] - pose[1][a, 0]
    psi = pose[2][b, 0] - pose[2][a, 0]
    pair, sees = program.cells.pair, (c * x + s * y, c * y - s * x, psi, casadi.cos(psi), casadi.sin(psi))
    parts, places = [], []
    for kind in (A_EDGE, B_EDGE, LOW_TURN, HIGH_TURN, FACE):
        k = np.flatnonzero(program.geometry.kind == kind)
        if len(k):
            parts.append(_of_kind(kind, [e[pair[k].tolist(), 0] for e in sees], program.geometry, pair, k))
            places.append(k)
    if not parts:
        return casadi.MX(0, 1)
    back = np.argsort(np.concatenate(places))
    return casadi.vertcat(*parts)[back.tolist(), 0]


def _of_kind(kind: int, sees: list, rows: Rows, pair: Ints, k: Ints) -> Any:
    """Rows k, all of one kind, where B is seen at `sees`: x, y, angle, its cosine and sine."""
    x, y, psi, c, s = sees
    if kind == LOW_TURN:
        return rows.lever[pair[k]] * (psi - rows.ends[pair[k], 0])
    if kind == HIGH_TURN:
        return rows.lever[pair[k]] * (rows.ends[pair[k], 1] - psi)
    line = rows.line[k]
    (nx, ny), (vx, vy), off = rows.normal[line].T, rows.corner[rows.point[k]].T, rows.off[line]
    if kind == B_EDGE:
        return nx * (c * (vx - x) + s * (vy - y)) + ny * (c * (vy - y) - s * (vx - x)) - off
    turning = rows.per_turn[line] * psi if kind == FACE else 0.0
    return nx * (x + c * vx - s * vy) + ny * (y + s * vx + c * vy) + turning - off


@dataclass(eq=False, kw_only=True)
class _IpoptMonitor(IterationMonitor):
    """What is kept of the iterates: the last one, points inside all rows, and the one from which the next program can start."""

    program: Program
    u: Floats
    lam: Floats = field(init=False)
    inner: Floats = field(init=False)
    inner_mu: float = INITIAL_BARRIER
    path: list[Floats] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin at the start."""
        self.inner, self.lam = self.u, np.zeros(self.program.rows)

    def keep(self, u: Floats, value: float, h: Floats, lam: Floats) -> bool:
        """Keep one iterate; True where it is inside all rows and beyond the horizon."""
        self.u, self.lam = u, lam
        inside = h.min(initial=np.inf) > 0
        if inside:
            self.path.append(u)
            if len(self.path) == 1 or h @ lam > WARM_START_GAP * max(abs(value), 1.0):
                self.inner, self.inner_mu = u, float(h @ lam) / max(len(h), 1)
        return bool(inside and np.abs(self.program.motion(u)[:, :2]).max(initial=0.0) > self.horizon)


def _error(program: Program, u: Floats, lam: Floats, unit: float) -> float:
    """Largest of complementarity, violation and dual residual, in units of the objective."""
    at = program.linearise(u)
    gap, infeasible = float(lam @ np.maximum(at.h, 0.0)), float(lam @ np.maximum(-at.h, 0.0))
    wrong = float(np.abs(at.gradient / unit + at.transposed_jacobian_product(lam)).max(initial=0.0))
    return max(gap, infeasible, wrong) / max(abs(at.value) / unit, 1.0)
