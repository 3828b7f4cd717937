"""Waypoints of a step moved so that its least clearance is largest, by sequential linear programming.

Samples are taken on every piece of the path. There the distances of corners of what moves from edges of all else, and the other way round,
are linear in small changes of the waypoints. Each program makes the least of them as large as it can, and then those of every piece, up
to what is plenty. A change is kept where the exact distances along the pieces grew. Source: sequential linear programming with a trust
region, as in Conn, Gould and Toint, "Trust-Region Methods" (2000).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MAX_PROGRAMS = 12
"""Most linear programs for one step."""
SAMPLES_PER_PIECE = 5
"""Least samples of a piece."""
SAMPLE_DISTANCE = 0.04
"""Samples of a long piece lie no further apart than this share of the drawing's size."""
MAX_SAMPLES = 40
"""Most samples of a piece."""
REACH = 4.0
"""Corners count that are nearer than this multiple of the clearance, and of how far waypoints may move."""
SUFFICIENT_CLEARANCE = 1.0
"""Pieces that are not the narrowest need no more than this multiple of the typical clearance."""
WEIGHTS = 1.0, 0.1, 1e-3
"""Of the least clearance, of the mean of those of all pieces, and of the distance that waypoints are moved."""
MAX_TRUST = 0.1
"""Waypoints are moved by at most this share of the drawing's size at once."""
MIN_GAIN = 0.01
"""A gain below this share of the typical clearance is none."""


@dataclass(frozen=True, eq=False)
class MovingBodies:
    """What moves in a step.

    Parameters
    ----------
    who : (m,) int64
        Bodies.
    as_one : bool
        They go straight as one, none of them turning.
    """

    who: Ints
    as_one: bool


@dataclass(frozen=True, eq=False)
class ClearanceProblem:
    """What stays the same while the waypoints of a step are moved.

    Parameters
    ----------
    bodies : Bodies
    there : (n,) bool
        Bodies that have not left.
    ignored : (k,) int64
        Keys a * n + b of pairs that never collide.
    clearance, size : float [mm]
        Typical clearance, and size of the drawing.
    moving : MovingBodies
    """

    bodies: Bodies
    there: Bools
    ignored: Ints
    clearance: float
    size: float
    moving: MovingBodies

    def least(self, path: Floats) -> float:
        """Exact least clearance of a path (k, n, 3), up to a share of the size [mm]."""
        apart = least_distances(self.bodies, path, self.there, self.ignored, 0.1 * self.size)
        return float(apart[self.moving.who].min(initial=0.1 * self.size))

    def pieces(self, path: Floats) -> Floats:
        """The same of every piece (k - 1,)."""
        return np.array([self.least(path[k : k + 2]) for k in range(len(path) - 1)])


def largest_clearance_path(problem: ClearanceProblem, path: Floats) -> Floats:
    """The path (k, n, 3) [mm, mm, rad] of the bodies, its waypoints but the first moved to where the clearance is largest."""
    trust = problem.clearance
    best = problem.pieces(path)
    for _ in range(MAX_PROGRAMS):
        change = _change(problem, path, float(best.min()), trust)
        if change is None:
            break
        trial = path + change
        pieces = problem.pieces(trial)
        gain = _worth(problem, pieces) - _worth(problem, best)
        if gain > MIN_GAIN * problem.clearance:
            path, best = trial, pieces
            trust = min(1.5 * trust, MAX_TRUST * problem.size)
        else:
            trust /= 3
            if trust < 0.02 * problem.clearance:
                break
    return path


def _worth(problem: ClearanceProblem, pieces: Floats) -> float:
    """What the program maximises, from the exact clearances of the pieces [mm]."""
    plenty = np.minimum(pieces, SUFFICIENT_CLEARANCE * problem.clearance)
    return float(WEIGHTS[0] * pieces.min() + WEIGHTS[1] * plenty.mean())


def _change(problem: ClearanceProblem, path: Floats, least: float, trust: float) -> Floats | None:
    """Change (k, n, 3) of the waypoints that a linear program proposes; None where there is nothing to gain."""
    from scipy.optimize import linprog  # slow to load
    from scipy.sparse import coo_array

    moving, radius = problem.moving, problem.bodies.radius
    k, dofs = len(path), 2 if moving.as_one else 3 * len(moving.who)
    free = (k - 1) * dofs
    rows: list[tuple[Floats, Ints, float, int]] = []
    for piece in range(k - 1):
        rows += _rows(problem, path, piece, REACH * (least + trust), dofs)
    if not rows:
        return None
    # variables: changes, their sizes, clearance of every piece, least clearance
    count = 2 * free + k
    entry: list[Floats] = []
    row: list[Ints] = []
    column: list[Ints] = []
    bound: list[float] = []
    for r, (value, where, apart, piece) in enumerate(rows):  # c_piece - value . change <= apart
        entry.append(np.append(-value, 1.0))
        column.append(np.append(where, 2 * free + piece))
        row += [np.full(len(where) + 1, r)]
        bound.append(apart)
    r = len(rows)
    for piece in range(k - 1):  # least <= c_piece
        entry.append(np.array([1.0, -1.0]))
        column.append(np.array([count - 1, 2 * free + piece]))
        row.append(np.full(2, r))
        bound.append(0.0)
        r += 1
    one = np.arange(free)
    for sign in (1.0, -1.0):  # |change| <= size
        entry.append(np.repeat([sign, -1.0], free))
        column.append(np.concatenate([one, free + one]))
        row.append(np.tile(r + one, 2))
        bound += [0.0] * free
        r += free
    matrix = coo_array((np.concatenate(entry), (np.concatenate(row), np.concatenate(column))), shape=(r, count))
    unit = np.ones((k - 1, dofs))
    if not moving.as_one:
        unit = np.tile(np.column_stack([np.ones((len(moving.who), 2)), 1 / radius[moving.who]]).ravel(), (k - 1, 1))
    limit = (trust * unit).ravel()
    cost = np.zeros(count)
    cost[free : 2 * free] = WEIGHTS[2] / (unit.ravel() * free)
    cost[2 * free : count - 1] = -WEIGHTS[1] / (k - 1)
    cost[-1] = -WEIGHTS[0]
    plenty = SUFFICIENT_CLEARANCE * problem.clearance
    narrowest = max(plenty, 2 * least + trust)  # a piece may be worth more than plenty where it is the narrowest
    bounds = [
        *zip(-limit, limit, strict=True),
        *zip(np.zeros(free), limit, strict=True),
        *[(None, narrowest)] * (k - 1),
        (None, 0.1 * problem.size),
    ]
    found = linprog(cost, A_ub=matrix.tocsr(), b_ub=np.array(bound), bounds=bounds, method="highs")
    if not found.success:
        return None
    change = np.zeros_like(path)
    moved = found.x[:free].reshape(k - 1, dofs)
    if moving.as_one:
        change[1:, moving.who, :2] = moved[:, None, :]
    else:
        change[1:, moving.who] = moved.reshape(k - 1, len(moving.who), 3)
    return change


def _rows(
    problem: ClearanceProblem, path: Floats, piece: int, reach: float, dofs: int
) -> list[tuple[Floats, Ints, float, int]]:
    """Distances at samples of a piece, each with its derivatives by the changes of the waypoints."""
    bodies, moving = problem.bodies, problem.moving
    begin, end = bodies.rest + path[piece], bodies.rest + path[piece + 1]
    length = np.abs(end - begin)[moving.who, :2].max()
    count = int(np.clip(np.ceil(length / (SAMPLE_DISTANCE * problem.size)) + 1, SAMPLES_PER_PIECE, MAX_SAMPLES))
    found = []
    mine = {int(b): m for m, b in enumerate(moving.who)}
    for t in np.linspace(0.0, 1.0, count):
        pose = begin + t * (end - begin)
        shares = [(piece - 1, 1.0 - t), (piece, t)]  # waypoint 0 stays
        for b, c, point, normal, apart in corners_near_edges(problem, pose, reach):
            value, where = [], []
            for body, sign in ((b, 1.0), (c, -1.0)):
                if body not in mine:
                    continue
                arm = point - pose[body, :2]
                turn = -normal[0] * arm[1] + normal[1] * arm[0]
                for waypoint, share in shares:
                    if waypoint < 0 or share == 0.0:
                        continue
                    base = waypoint * dofs
                    if moving.as_one:
                        value += [sign * share * normal[0], sign * share * normal[1]]
                        where += [base, base + 1]
                    else:
                        at = base + 3 * mine[body]
                        value += [sign * share * normal[0], sign * share * normal[1], sign * share * turn]
                        where += [at, at + 1, at + 2]
            found.append((np.array(value), np.array(where, dtype=np.int64), apart, piece))
    return found


def corners_near_edges(
    problem: ClearanceProblem, pose: Floats, reach: float
) -> list[tuple[int, int, Floats, Floats, float]]:
    """Corners of one body near edges of another: both bodies, the point, the unit vector away from the edge, and the distance."""
    bodies, moving, n = problem.bodies, problem.moving, len(pose)
    never = set(problem.ignored.tolist())
    found = []
    for a in moving.who.tolist():
        for b in np.flatnonzero(problem.there).tolist():
            twice = b in moving.who and (moving.as_one or b < a)
            if a == b or twice or min(a, b) * n + max(a, b) in never:
                continue
            apart = np.hypot(*(pose[a, :2] - pose[b, :2])) - bodies.radius[a] - bodies.radius[b]
            if apart > reach:
                continue
            found += _corners_at_edges(bodies, a, b, pose, reach)
            found += _corners_at_edges(bodies, b, a, pose, reach)
    return found


def _corners_at_edges(
    bodies: Bodies, a: int, b: int, pose: Floats, reach: float
) -> list[tuple[int, int, Floats, Floats, float]]:
    """Corners of a that lie nearer than `reach` to an edge of b, each with the nearest of b's edges."""
    p, q = _corners(bodies, a, pose[a]), _corners(bodies, b, pose[b])
    shapes = bodies.shapes
    row = slice(shapes.first[bodies.shape[b]], shapes.first[bodies.shape[b] + 1])
    begin = q
    end = q[shapes.after[row] - row.start]
    low, high = q.min(axis=0) - reach, q.max(axis=0) + reach
    near = np.flatnonzero(((p > low) & (p < high)).all(axis=1))
    if not len(near):
        return []
    along = end - begin
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((p[near, None] - begin) * along).sum(axis=2) / square, 0.0, 1.0)
    foot = begin + t[..., None] * along
    away = p[near, None] - foot
    distance = np.hypot(away[..., 0], away[..., 1])
    edge = distance.argmin(axis=1)
    found = []
    for i, e in enumerate(edge.tolist()):
        d = float(distance[i, e])
        if d > reach:
            continue
        if d > 1e-9 * reach:
            normal = away[i, e] / d
        else:  # touching: away from the edge
            x, y = along[e] / np.sqrt(square[e])
            normal = np.array([y, -x])
        found.append((a, b, foot[i, e], normal, d))
    return found


def _corners(bodies: Bodies, body: int, pose: Floats) -> Floats:
    shapes = bodies.shapes
    c, s = np.cos(pose[2]), np.sin(pose[2])
    corner = shapes.corner[shapes.first[bodies.shape[body]] : shapes.first[bodies.shape[body] + 1]]
    return corner @ np.array([[c, s], [-s, c]]) + pose[:2]
