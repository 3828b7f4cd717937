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
from wiggleroom.geometry.near_corners import NearCorners, corners_near_edges, joined_corners

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

    def numbers(self, n: int) -> Ints:
        """Which of them every one of `n` bodies is (n,), 0 for all that go as one, -1 for those that stand."""
        number = np.full(n, -1)
        number[self.who] = 0 if self.as_one else np.arange(len(self.who))
        return number


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

    def near(self, pose: Floats, reach: float) -> NearCorners:
        """Corners of what moves nearer than `reach` [mm] to edges of all else, and the other way round, at poses (n, 3)."""
        n, who, never = len(pose), self.moving.who, set(self.ignored.tolist())
        pairs = [
            (a, b)
            for a in who.tolist()
            for b in np.flatnonzero(self.there).tolist()
            if a != b and not (b in who and (self.moving.as_one or b < a)) and min(a, b) * n + max(a, b) not in never
        ]
        return corners_near_edges(self.bodies, pairs, pose, reach)

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
    plenty = SUFFICIENT_CLEARANCE * problem.clearance
    narrowest = max(plenty, 2 * least + trust)  # a piece may be worth more than plenty where it is the narrowest
    # by any change, a corner of a body comes nearer by so much at most, and so does what it comes near to
    shift = (np.sqrt(2) if moving.as_one else (1 + np.sqrt(2)) * min(len(moving.who), 2)) * trust
    samples = _samples(problem, path, narrowest + shift)
    if not len(samples.piece):
        return None
    # variables: changes, their sizes, clearance of every piece, least clearance
    count, rows = 2 * free + k, len(samples.piece)
    row, column, entry = _changed_distances(problem, samples, dofs)
    every, last = np.arange(rows), rows + np.arange(k - 1)
    one, sizes = np.arange(free), rows + k - 1 + np.arange(2 * free)
    row = np.concatenate([row, every, last, last, sizes, sizes])
    column = np.concatenate([
        column, 2 * free + samples.piece, np.full(k - 1, count - 1), 2 * free + np.arange(k - 1),
        np.tile(one, 2), np.tile(free + one, 2),
    ])  # fmt: skip
    entry = np.concatenate([  # c_piece - change of the distance <= distance; least <= c_piece; |change| <= size
        -entry, np.ones(rows), np.ones(k - 1), np.full(k - 1, -1.0), np.repeat([1.0, -1.0], free), np.full(2 * free, -1.0),
    ])  # fmt: skip
    bound = np.append(samples.near.distance, np.zeros(k - 1 + 2 * free))
    matrix = coo_array((entry, (row, column)), shape=(len(bound), count))
    unit = np.ones((k - 1, dofs))
    if not moving.as_one:
        unit = np.tile(np.column_stack([np.ones((len(moving.who), 2)), 1 / radius[moving.who]]).ravel(), (k - 1, 1))
    limit = (trust * unit).ravel()
    cost = np.zeros(count)
    cost[free : 2 * free] = WEIGHTS[2] / (unit.ravel() * free)
    cost[2 * free : count - 1] = -WEIGHTS[1] / (k - 1)
    cost[-1] = -WEIGHTS[0]
    bounds = [
        *zip(-limit, limit, strict=True),
        *zip(np.zeros(free), limit, strict=True),
        *[(None, narrowest)] * (k - 1),
        (None, 0.1 * problem.size),
    ]
    found = linprog(cost, A_ub=matrix.tocsr(), b_ub=bound, bounds=bounds, method="highs")
    if not found.success:
        return None
    change = np.zeros_like(path)
    moved = found.x[:free].reshape(k - 1, dofs)
    if moving.as_one:
        change[1:, moving.who, :2] = moved[:, None, :]
    else:
        change[1:, moving.who] = moved.reshape(k - 1, len(moving.who), 3)
    return change


@dataclass(frozen=True, eq=False)
class PathSamples:
    """Corners near edges at places on a path: its piece, and how far along that (m,)."""

    near: NearCorners
    piece: Ints
    along: Floats


def _samples(problem: ClearanceProblem, path: Floats, reach: float) -> PathSamples:
    """Corners nearer than `reach` to edges, at places spread over every piece of a path."""
    bodies = problem.bodies
    found: list[NearCorners] = []
    piece: list[Ints] = []
    along: list[Floats] = []
    for k in range(len(path) - 1):
        begin, end = bodies.rest + path[k], bodies.rest + path[k + 1]
        length = np.abs(end - begin)[problem.moving.who, :2].max()
        count = int(np.clip(np.ceil(length / (SAMPLE_DISTANCE * problem.size)) + 1, SAMPLES_PER_PIECE, MAX_SAMPLES))
        for t in np.linspace(0.0, 1.0, count):
            near = problem.near(begin + t * (end - begin), reach)
            found.append(near)
            piece.append(np.full(len(near.distance), k))
            along.append(np.full(len(near.distance), t))
    return PathSamples(joined_corners(found), np.concatenate(piece), np.concatenate(along))


def _changed_distances(problem: ClearanceProblem, samples: PathSamples, dofs: int) -> tuple[Ints, Ints, Floats]:
    """Rows, columns and entries of the matrix that takes changes of the waypoints but the first to those of the distances."""
    moving, near = problem.moving, samples.near
    width = 2 if moving.as_one else 3
    mine = moving.numbers(len(problem.bodies.fixed))[near.who]
    row, column, entry = [], [], []
    ends = (samples.piece - 1, 1.0 - samples.along), (samples.piece, samples.along)  # waypoint -1 stays
    for waypoint, share in ends:
        r, side = np.nonzero((mine >= 0) & ((waypoint >= 0) & (share > 0))[:, None])
        row.append(np.repeat(r, width))
        column.append(((waypoint[r] * dofs + width * mine[r, side])[:, None] + np.arange(width)).ravel())
        entry.append((share[r, None] * near.gradient[r, side, :width]).ravel())
    return np.concatenate(row), np.concatenate(column), np.concatenate(entry)
