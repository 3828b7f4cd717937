"""A short search for better motions that shares nothing with the program: linear programs on distances, a tree of states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.optimize
import shapely
from numpy.typing import NDArray

from benchmarks.attack.oracle import Ground

Floats = NDArray[np.float64]

REACH = 3.0
"""Corners nearer to an edge than this multiple of a step are in the linear program."""
MIN_STEP, FIRST_STEP, LARGEST_STEP = 1e-5, 0.01, 0.08
"""Steps, as shares of the size."""
MAX_AWAY = 4.0


@dataclass(frozen=True, eq=False)
class Reached:
    """A state reached from rest: waypoints (k, n, 3) and the goal's value at the last."""

    path: list[Floats]
    value: float


class Climber:
    """Climbs from state to state; every step is looked at by the judge before it is taken."""

    def __init__(self, ground: Ground, seed: int, programs: int) -> None:
        self.ground, self.left = ground, programs
        self.rng = np.random.default_rng([seed, 99])
        self.free = np.flatnonzero(~ground.fixed)
        self.lever = np.tile([1.0, 1.0, 0.0], (len(ground.names), 1))
        self.lever[:, 2] = 1.0 / np.maximum(ground.radius, 1e-9)
        self.glued = _groups(ground)

    def search(self, enough: float = np.inf) -> Reached:
        """The best state found before the linear programs are used up, or the first worth more than `enough`."""
        still = np.zeros((len(self.ground.names), 3))
        tree = [Reached([still], 0.0)]
        best = self.climb(tree[0], None, 25)
        tree.append(best)
        while self.left > 0 and best.value <= enough:
            begin = tree[int(self.rng.integers(len(tree)))] if self.rng.random() < 0.6 else best
            aside = self.climb(begin, self._wish(), int(self.rng.integers(2, 9)))
            end = self.climb(aside, None, 15)
            tree += [aside, end]
            best = max(best, end, key=lambda r: r.value)
        return best

    def climb(self, begin: Reached, wish: Floats | None, most: int) -> Reached:
        """Go uphill from a state: of the goal, or of a random wish (n, 3)."""
        path, at, step = list(begin.path), begin.path[-1], FIRST_STEP * self.ground.size
        gained = 0
        for _ in range(most):
            if (
                self.left <= 0
                or np.abs(at[:, :2]).max() > MAX_AWAY * self.ground.size
                or step < MIN_STEP * self.ground.size
            ):
                break
            self.left -= 1
            slope = self.ground.slope(at) if wish is None else wish
            move = self._move(at, slope, step)
            if move is None:
                break
            after = self._clear(at, move)
            if after is None:
                step /= 4
                continue
            gain = float((slope * (after - at)).sum())
            if gain < 1e-7 * step * np.abs(slope * self.lever).max():
                step /= 4
                gained += 1
                if gained > 3:
                    break
                continue
            path.append(after)
            at, step = after, min(2 * step, LARGEST_STEP * self.ground.size)
        return Reached(path, self.ground.value(at))

    def _wish(self) -> Floats:
        wish = np.zeros_like(self.lever)
        if self.rng.random() < 0.5:  # above all: turn one body
            wish[self.rng.choice(self.free), 2] = self.rng.choice([-1.0, 1.0])
        else:
            wish[self.free] = self.rng.standard_normal((len(self.free), 3)) * self.lever[self.free]
        return wish

    def _clear(self, at: Floats, move: Floats) -> Floats | None:
        """The end of the longest of some shares of a move that stays clear of everything."""
        for share in (1.0, 0.5, 0.15):
            after = at + share * move
            if self.ground.overlap_on(np.stack([at, after]), levels=5) is None:
                return after
        return None

    def _move(self, at: Floats, slope: Floats, step: float) -> Floats | None:
        """The move (n, 3) that gains most while no corner passes an edge near it, to first order."""
        ground, rows, room = self.ground, [], []
        shapes = [s[0] for s in ground.at(at[None])]
        place = ground.rest[:, :2] + at[:, :2]
        n = len(place)
        for i, j in ground.pairs:
            if shapely.distance(shapes[i], shapes[j]) > REACH * step:
                continue
            for a, b in ((i, j), (j, i)):
                corner = shapely.get_coordinates(shapes[a])
                edges = _edges(shapes[b])
                far, spot, normal = _nearest(corner, edges)
                c, e = np.nonzero(far < REACH * step)
                if len(c) > 400:
                    keep = np.argsort(far[c, e])[:400]
                    c, e = c[keep], e[keep]
                m = normal[c, e]
                row = np.zeros((len(c), n, 3))
                for p, sign in ((a, 1.0), (b, -1.0)):
                    arm = (corner[c] if p == a else spot[c, e]) - place[p]
                    row[:, p, :2] += sign * m
                    row[:, p, 2] += sign * (m[:, 1] * arm[:, 0] - m[:, 0] * arm[:, 1])
                rows.append(row)
                room.append(far[c, e])
        unit = self.lever * step
        gain = (slope * unit).ravel()
        if np.abs(gain).max() == 0:
            return None
        limit = np.where(self.ground.fixed, 0.0, 1.0).repeat(3)
        equal = self._rigid(at, unit)
        found = scipy.optimize.linprog(
            -gain / np.abs(gain).max(),
            A_ub=-(np.concatenate(rows) * unit).reshape(-1, 3 * n) / step if rows else None,
            b_ub=np.concatenate(room) / step if rows else None,
            A_eq=equal, b_eq=None if equal is None else np.zeros(len(equal)),
            bounds=np.column_stack([-limit, limit]),
        )  # fmt: skip
        return None if found.x is None else self._together(at, (found.x.reshape(n, 3) * unit))

    def _rigid(self, at: Floats, unit: Floats) -> Floats | None:
        """Rows that keep glued parts together."""
        n, rows = len(at), []
        place = self.ground.rest[:, :2] + at[:, :2]
        for first, *others in self.glued:
            for p in others:
                arm = place[p] - place[first]
                for axis, lever in ((0, -arm[1]), (1, arm[0]), (2, 0.0)):
                    row = np.zeros((n, 3))
                    row[p, axis], row[first, axis] = 1.0, -1.0
                    row[first, 2] -= lever
                    rows.append((row * unit).ravel() / unit[0, 0])
        return np.array(rows) if rows else None

    def _together(self, at: Floats, move: Floats) -> Floats:
        """The move with glued parts carried along exactly."""
        after = at + move
        for first, *others in self.glued:
            c, s = np.cos(after[first, 2]), np.sin(after[first, 2])
            for p in others:
                arm = self.ground.rest[p, :2] - self.ground.rest[first, :2]
                after[p, 2] = after[first, 2]
                after[p, :2] = after[first, :2] + np.array([[c - 1, -s], [s, c - 1]]) @ arm
        return after - at


def _groups(ground: Ground) -> list[list[int]]:
    return [[ground.names.index(name) for name in group] for group in ground.made.get("glue", [])]


def _edges(shape: shapely.Polygon) -> Floats:
    """Edges (m, 2, 2) with material on their left."""
    out = []
    for piece in shapely.get_parts(shapely.orient_polygons(shape)):
        for ring in (piece.exterior, *piece.interiors):
            points = np.asarray(ring.coords)
            out.append(np.stack([points[:-1], points[1:]], axis=1))
    edges = np.concatenate(out)
    return edges[(edges[:, 0] != edges[:, 1]).any(axis=1)]


def _nearest(corner: Floats, edges: Floats) -> tuple[Floats, Floats, Floats]:
    """Distance (c, m) of corners from edges, the nearest points and the directions from there to the corners."""
    edge = edges[:, 1] - edges[:, 0]
    long = np.hypot(*edge.T)
    off = corner[:, None] - edges[None, :, 0]
    along = np.clip((off * edge).sum(-1) / long**2, 0.0, 1.0)
    spot = edges[None, :, 0] + along[..., None] * edge
    apart = corner[:, None] - spot
    far = np.hypot(apart[..., 0], apart[..., 1])
    outward = np.column_stack([edge[:, 1], -edge[:, 0]]) / long[:, None]
    tiny = 1e-9 * long.max()
    normal = np.where((far < tiny)[..., None], outward, apart / np.maximum(far, tiny)[..., None])
    return far, spot, normal
