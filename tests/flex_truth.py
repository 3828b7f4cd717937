"""Checks of answers that share nothing with the engine: collisions, objectives, balance of forces, climbs."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numba
import numpy as np
import scipy.optimize
import shapely

from tests.oracle.collision import depths, overlaps, relative_motion
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal, Pull, Turn
from wiggleroom.search.answer import Answer

Motion = np.ndarray
DEEP = 1e-9  # share of the size that parts may overlap
BETWEEN = 20  # points looked at on every piece of a path, at least
STRIDE = 2e-3  # share of the size that a part moves from one of them to the next, at most


def world(assembly: Assembly) -> list[list[shapely.Polygon]]:
    """Material of every part where it rests."""
    out = []
    for p in assembly.parts:
        x, y, angle = p.at
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, s], [-s, c]])
        out.append([shapely.Polygon(r.outer @ turn + (x, y), [h @ turn + (x, y) for h in r.holes]) for r in p.regions])
    return out


class Ground:
    """Collision truth of an assembly for many motions at once."""

    def __init__(self, assembly: Assembly):
        self.at = assembly.rest[:, :2]
        self.size = assembly.size
        self.free = [k for k, p in enumerate(assembly.parts) if not p.fixed]
        local = [
            [shapely.transform(r, lambda c, o=o: c - o) for r in regions]
            for regions, o in zip(world(assembly), self.at, strict=True)
        ]
        self.local = local
        radius = [max(np.hypot(*shapely.get_coordinates(r).T).max() for r in regions) for regions in local]
        self.radius = radius
        never = _never(assembly)
        fixed = [p.fixed for p in assembly.parts]
        n = len(local)
        self.pairs = [
            (i, j, p, q, radius[i] + radius[j])
            for i in range(n)
            for j in range(i + 1, n)
            if frozenset((i, j)) not in never and not (fixed[i] and fixed[j])
            for p in local[i]
            for q in local[j]
        ]

    def depth(self, motions: Motion) -> np.ndarray:
        """Deepest overlap (k,) of any two parts for motions (k, n, 3)."""
        worst = np.zeros(len(motions))
        for i, j, p, q, reach in self.pairs:
            relative, near = self._near(motions, i, j, reach)
            if near.any():
                worst[near] = np.maximum(worst[near], depths(p, q, relative[near], self.at[j] - self.at[i]))
        return worst

    def free_of_overlap(self, motions: Motion) -> np.ndarray:
        """Which motions (k, n, 3) have no overlap at all, (k,) bool."""
        good = np.ones(len(motions), dtype=bool)
        for i, j, p, q, reach in self.pairs:
            relative, near = self._near(motions, i, j, reach)
            near &= good
            if near.any():
                good[near] = ~overlaps(p, q, relative[near], self.at[j] - self.at[i])
        return good

    def contacts(self, motion: Motion, within: float) -> tuple[np.ndarray, np.ndarray]:
        """Corners no further than `within` from an edge: derivative (m, 3n) of their distance, and the distance (m,)."""
        n, rows, room = len(motion), [np.zeros((0, len(motion), 3))], [np.zeros(0)]
        for i, j, p, q, reach in self.pairs:
            if np.hypot(*(self.at[j] - self.at[i] + motion[j, :2] - motion[i, :2])) > reach + within:
                continue
            for a, b, one, other in ((i, j, p, q), (j, i, q, p)):
                corner = _placed(_edges(one)[:, 0], self.at[a], motion[a])
                edges = _placed(_edges(other), self.at[b], motion[b])
                found, away, normal = _close(corner, edges, within)
                row = np.zeros((len(found), n, 3))
                for k, sign in ((a, 1), (b, -1)):
                    arm = corner[found] - self.at[k] - motion[k, :2]
                    turned = normal[:, 1] * arm[:, 0] - normal[:, 0] * arm[:, 1]
                    row[:, k] += sign * np.column_stack([normal, turned])
                rows.append(row)
                room.append(away)
        return np.concatenate(rows).reshape(-1, 3 * n), np.concatenate(room)

    def _near(self, motions: Motion, i: int, j: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
        apart = self.at[j] - self.at[i] + motions[:, j, :2] - motions[:, i, :2]
        return relative_motion(self.at[i], self.at[j], motions[:, i], motions[:, j]), np.hypot(*apart.T) < reach


@lru_cache(maxsize=1000)
def _edges(shape: shapely.Polygon) -> np.ndarray:
    """Edges (k, 2, 2) with material on their left; they begin at every corner once."""
    made = shapely.orient_polygons(shape)
    rings = [shapely.get_coordinates(r) for r in (made.exterior, *made.interiors)]
    return np.concatenate([np.stack([r[:-1], r[1:]], axis=1) for r in rings])


def _placed(points: np.ndarray, at: np.ndarray, move: np.ndarray) -> np.ndarray:
    """Points (..., 2) after a motion."""
    c, s = np.cos(move[2]), np.sin(move[2])
    return points @ np.array([[c, s], [-s, c]]) + (at + move[:2])


@numba.njit(cache=True)
def _close(corners: np.ndarray, edges: np.ndarray, within: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners (m,) that are close to an edge, each its distance (m,) and the edge's outward normal (m, 2)."""
    found, away = np.empty((len(corners), len(edges)), dtype=np.bool_), np.empty((len(corners), len(edges)))
    normal = np.empty((len(edges), 2))
    for j in range(len(edges)):
        x, y = edges[j, 0]
        ex, ey = edges[j, 1, 0] - x, edges[j, 1, 1] - y
        long = np.hypot(ex, ey)
        normal[j] = ey / long, -ex / long
        for i in range(len(corners)):
            dx, dy = corners[i, 0] - x, corners[i, 1] - y
            along = (dx * ex + dy * ey) / long
            away[i, j] = dx * normal[j, 0] + dy * normal[j, 1]
            found[i, j] = abs(away[i, j]) < within and -1e-9 * long < along < long * (1 + 1e-9)
    who, at = np.nonzero(found)
    return who, away.ravel()[who * len(edges) + at], normal[at]


def _never(assembly: Assembly) -> set[frozenset[int]]:
    """Pairs that never collide: ignored, or glued to each other."""
    index = {name: k for k, name in enumerate(assembly.names)}
    pairs = {frozenset((index[a], index[b])) for a, b in assembly.drawing.ignore}
    for group in assembly.drawing.glue:
        pairs |= {frozenset((index[a], index[b])) for a in group for b in group if a != b}
    return pairs


def between(waypoints: Motion, stride: float = np.inf) -> Motion:
    """Waypoints (k, n, 3) and at least `BETWEEN` points on every straight piece, `stride` [mm] apart at most."""
    pieces = []
    for a, b in itertools.pairwise(waypoints):
        far = np.hypot(*(b - a)[:, :2].T).max()
        share = np.linspace(0, 1, max(BETWEEN, int(far / stride)) + 1, endpoint=False)
        pieces.append(a + share[:, None, None] * (b - a))
    return np.concatenate([*pieces, waypoints[-1:]])


def value_of(assembly: Assembly, goals: Iterable[Goal], motions: Motion) -> np.ndarray:
    """Sum of the goals for motions (..., n, 3), from their definition alone."""
    index = {name: k for k, name in enumerate(assembly.names)}
    total = np.zeros(motions.shape[:-2])
    for goal in goals:
        k = index[goal.part]
        x, y, theta = np.moveaxis(motions[..., k, :], -1, 0)
        if isinstance(goal, Pull):
            at = np.asarray(assembly.parts[k].at[:2])
            arm = complex(*(np.asarray(goal.point if goal.point is not None else at) - at))
            moved = x + 1j * y + arm * np.expm1(1j * theta)
            total += goal.weight * (moved / (complex(*goal.direction) / abs(complex(*goal.direction)))).real
        elif isinstance(goal, Turn):
            total += goal.weight * theta * (1 if goal.sense == "ccw" else -1)
        else:
            total += goal.weight * (goal.w[0] * x + goal.w[1] * y + goal.w[2] * theta)
    return total


def check_safe(answer: Answer, ground: Ground | None = None) -> None:
    """What every answer promises: no overlap, fixed parts still, rest included, the path free if it is said to be."""
    assembly = answer.assembly
    ground = ground or Ground(assembly)
    still = [p.fixed for p in assembly.parts]
    assert answer.waypoints.shape[1:] == answer.motion.shape == (len(still), 3)
    assert np.all(np.isfinite(answer.waypoints))
    assert np.all(answer.waypoints[:, still] == 0)
    assert np.all(answer.waypoints[0] == 0)
    assert np.array_equal(answer.waypoints[-1], answer.motion)
    assert ground.depth(answer.motion[None])[0] <= DEEP * ground.size
    assert answer.collision_free
    assert answer.deepest_overlap <= DEEP * ground.size
    assert answer.path in ("checked", "not checked")
    assert ground.depth(answer.waypoints).max() <= DEEP * ground.size or answer.path == "not checked"
    if answer.path == "checked":
        worst = ground.depth(between(answer.waypoints, STRIDE * ground.size)).max()
        assert worst <= DEEP * ground.size, f"{worst:.3g} deep on the way"
    if answer.objective is None:
        assert answer.verdict == "unbounded"
        assert answer.leaves or answer.turns
    else:
        shown = value_of(assembly, answer.goals, answer.motion)
        assert abs(answer.objective - shown) <= 1e-12 * ground.size + 1e-12 * abs(shown)
        assert answer.objective >= 0
        assert not answer.leaves
        assert not answer.turns


def climbed(answer: Answer, ground: Ground, seed: int = 0, rounds: int = 80, start: Motion | None = None) -> float:
    """Objective after climbing from beside the answer: linear programs over corners near edges, every step tested.

    `start` (n, 3) is where the climb begins; by default a little back from the answer and a little aside, without overlap.
    """
    at = _beside(answer, ground, seed) if start is None else start
    if at is None:
        return 0.0
    reach = 0.02 * max(np.abs(answer.motion[:, :2]).max(), 1e-6 * ground.size)
    best = float(value_of(answer.assembly, answer.goals, at))
    trust = reach
    for _ in range(rounds):
        move = _best_move(answer, ground, at, trust)
        shares = np.array([1, 0.999, 0.99, 0.9, 0.7, 0.4, 0.1])[:, None, None]
        steps = at + shares * move
        values = value_of(answer.assembly, answer.goals, steps)
        good = ground.free_of_overlap(steps) & (values > best)
        if good.any():
            k = int(np.argmax(np.where(good, values, -np.inf)))
            at, trust = steps[k], trust * (2 if k == 0 else 0.7)
            if values[k] - best < 1e-9 * abs(best) and trust < 1e-6 * reach:
                break
            best = float(values[k])
        else:
            trust /= 4
        trust = min(trust, reach)
        if trust < 1e-9 * reach:
            break
    return best


def _beside(answer: Answer, ground: Ground, seed: int) -> Motion | None:
    """A motion without overlap near the answer's."""
    rng = np.random.default_rng(seed)
    path = between(answer.waypoints)
    path = path[value_of(answer.assembly, answer.goals, path) < answer.objective * (1 - 1e-5)]
    reach = min(answer.assembly.gap or np.inf, np.abs(answer.motion[:, :2]).max() + 1e-6 * ground.size)
    lever = np.array([1.0, 1.0, len(ground.at) / ground.size])
    for share in (0.003, 1e-3, 1e-4, 0):
        noise = rng.standard_normal((100, len(ground.free), 3)) * lever * reach * share
        moves = path[-1 - rng.integers(0, min(30, len(path)), 100)]
        moves[:, ground.free] += noise
        good = ground.free_of_overlap(moves)
        if good.any():
            moves = moves[good]
            return moves[np.argmax(value_of(answer.assembly, answer.goals, moves))]
    return None


def _best_move(answer: Answer, ground: Ground, at: Motion, trust: float) -> Motion:
    """Move (n, 3) that raises the objective most while no corner near an edge crosses it, to first order."""
    n, free = len(at), ground.free
    lever = np.tile([1.0, 1.0, len(at) / ground.size * 2], n)
    gain = slope(answer.assembly, answer.goals, at).ravel()
    rows, room = ground.contacts(at, 4 * trust)
    bounds = [(-trust * w, trust * w) if k // 3 in free else (0, 0) for k, w in enumerate(lever)]
    scale = np.abs(gain * lever).max()
    found = scipy.optimize.linprog(
        -gain / scale, A_ub=-rows if len(rows) else None, b_ub=room if len(rows) else None, bounds=bounds
    )
    return found.x.reshape(n, 3) if found.status == 0 else np.zeros((n, 3))


def slope(assembly: Assembly, goals: Iterable[Goal], motion: Motion) -> Motion:
    """Derivative (n, 3) of the objective, by differences."""
    goals, out = tuple(goals), np.zeros_like(motion)
    index = {name: k for k, name in enumerate(assembly.names)}
    size = 1e-5 * assembly.size * np.array([1.0, 1.0, 1.0 / assembly.size])
    for k in {index[goal.part] for goal in goals}:
        steps = np.zeros((2, 3, *motion.shape))
        steps[0, range(3), k, range(3)], steps[1, range(3), k, range(3)] = size, -size
        up, down = value_of(assembly, goals, motion + steps)
        out[k] = (up - down) / (2 * size)
    return out


def unbalanced(answer: Answer, ground: Ground) -> float:
    """Largest force or torque that no contact takes up on a free part, as a share of the pull."""
    index = {name: k for k, name in enumerate(answer.assembly.names)}
    pull = slope(answer.assembly, answer.goals, answer.motion)
    total = pull.copy()
    for contact in answer.contacts:
        for name, sign in zip(contact.parts, (-1, 1), strict=True):
            k = index[name]
            x, y = contact.point - ground.at[k] - answer.motion[k, :2]
            nx, ny = contact.normal
            total[k] += sign * contact.force * np.array([nx, ny, x * ny - y * nx])
    length = np.array([1.0, 1.0, max(ground.radius)])
    return float(np.abs(total / length)[ground.free].max() / np.abs(pull / length).max())


def off_outline(answer: Answer, ground: Ground) -> float:
    """Largest distance of a contact's point from the outline of either of its parts."""
    index, worst = {name: k for k, name in enumerate(answer.assembly.names)}, 0.0
    for contact in answer.contacts:
        point = shapely.Point(contact.point)
        for k in (index[name] for name in contact.parts):
            x, y, theta = answer.motion[k]
            c, s = np.cos(theta), np.sin(theta)
            place = lambda p, c=c, s=s, x=x, y=y, k=k: p @ np.array([[c, s], [-s, c]]) + ground.at[k] + (x, y)  # noqa: E731
            worst = max(
                worst, min(shapely.distance(shapely.transform(r, place).boundary, point) for r in ground.local[k])
            )
    return worst


def improved(answer: Answer, seeds: Sequence[int] = (0, 1, 2)) -> float:
    """By what share of the objective climbs that begin beside the answer end above it."""
    ground = Ground(answer.assembly)
    assert answer.objective is not None
    best = max(climbed(answer, ground, seed) for seed in seeds)
    return best / max(answer.objective, 1e-12) - 1
