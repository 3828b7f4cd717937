"""Boxes of poses that can be reached from rest, and the largest value in them.

The domain, a box round rest, is split into leaves. Linear programs from the rows of a box cut off what is not free. A path of free poses
from rest passes from a leaf to another one that shares a pose with it. The leaves so reached bound the motion, if none of them meets the
border of the domain: else the domain is enlarged there. The leaf of the largest value is refined first.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.deadline import WorkBudget
from wiggleroom.solve.dual_linear_program import DualLinearProgram
from wiggleroom.spatial.proof.pose_rows import Box, Contacts, Pairs, Rows, linearised, rotation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

PENALTY = 100.0
"""How much of the goal a millimetre of violated rows costs, so that a program without solutions has one, and multipliers that show it."""
SHRUNK = 0.7
"""Cuts are repeated where a side has become shorter than this share."""
ROUNDS = 4
"""Most repetitions of cuts."""
LEAST_CUT = 1e-3
"""Share of a side that is worth a cut."""
ROUNDING = 1e-10
"""Ends of cuts and bounds are larger by this share."""
ROW_WORK = 0.004
"""Work of a linear program for each row, about milliseconds."""
EDGE_WORK = 1e-4
"""Of looking whether an edge bites into a piece, for each of its faces."""
LARGEST_TURN = 64.0
"""Largest component of a, the tangent of half the turn; beyond, nothing is proven."""
TRIES = 3
"""So often a leaf is cut again because points were added, before it is split."""
GOAL = (6, 1)
"""Names the best pose of a leaf among the extreme ones."""
ADDED = 8
"""Most points that are added at a time."""
MOST_POINTS = 1500
FIRST = 4.0
"""The first domain reaches so far, as a multiple of the clearance."""
COARSE = 10.0
"""Leaves at the border of the domain are split until linearisation leaves out less than this multiple of a tenth of the clearance."""
FIRM = 0.1
"""Turns that are smaller [rad] have little say in where the origin is put."""
BITE = 1e-3
"""An edge that is deeper in a piece than this share of the clearance gives a point."""


@dataclass(frozen=True, eq=False)
class LinearGoal:
    """direction . displacement of a material point, or the tangent of half the turn about a direction.

    Parameters
    ----------
    direction : (3,) float64
    arm : (3,) float64 [mm] or None
        None where the turn is asked.
    """

    direction: Floats
    arm: Floats | None

    def above(self, box: Box) -> tuple[float, Floats]:
        """Constant and slope (6,) about the middle of a box of a linear function that is nowhere less."""
        m, d, n = box.middle, box.half, self.direction
        if self.arm is None:
            return float(n @ m[3:]), np.concatenate([np.zeros(3), n])
        value, g, _, high = linearised(n, self.arm, m[3:], d[3:])
        return float(n @ m[:3] + value - n @ self.arm + high), np.concatenate([n, g])


@dataclass(eq=False)
class Leaf:
    """A box of poses, the step of the proof that belongs to it, and what is known of it."""

    box: Box
    step: dict[str, Any]
    value: float
    done: bool = False
    poses: dict[tuple[int, int], Floats] = field(default_factory=dict)
    tries: int = 0
    near: tuple[Pairs, ...] | None = None


@dataclass(eq=False)
class Domain:
    """All poses that are looked at: a box, and the tree of its steps."""

    box: Box
    root: dict[str, Any]
    free: Bools
    leaves: list[Leaf] = field(default_factory=list)


class Unbounded(Exception):  # noqa: N818
    """Nothing keeps the body within the largest domain."""


@dataclass(frozen=True)
class Lengths:
    """Radius of the body, clearance between neighbours, and the largest displacement that is looked at [mm]."""

    radius: float
    clearance: float
    reach: float


class PoseFlood:
    """The flood from rest.

    Parameters
    ----------
    contacts : (of points that move, of points that are fixed)
    edges : (ends that move (k, 2, 3), ends that are fixed) [mm]
    material : function
        What a point of an edge is called, and where it is exactly; None where it is no material. `material(fixed, point)`.
    goal : LinearGoal
    free : (6,) bool
    lengths : Lengths
    """

    def __init__(
        self,
        contacts: tuple[Contacts, Contacts],
        edges: tuple[Floats, Floats],
        material: Callable[[bool, Floats], tuple[int, Floats] | None],
        goal: LinearGoal,
        free: Bools,
        lengths: Lengths,
        budget: WorkBudget,
    ) -> None:
        self.contacts, self.edges, self.material, self.goal = contacts, edges, material, goal
        self.radius, self.clearance, self.reach = lengths.radius, lengths.clearance, lengths.reach
        self.scale = np.array([1.0, 1.0, 1.0, *[2 * self.radius] * 3])
        self.budget = budget
        half = np.where(free, FIRST * self.clearance / self.scale, 0.0)
        box = Box(-half, half.copy())
        self.domain = Domain(box, {}, free)
        self.domain.leaves.append(Leaf(box, self.domain.root, np.inf))
        self.closed, self.target = False, -np.inf

    def run(self, target: float, tell: Callable[[int, int, float], None]) -> float:
        """The least bound that is found, at most `target` where the work suffices; infinite where none is.

        `tell` hears how many boxes are reached, how many of them meet the border, and the bound so far.
        """
        best, self.target = np.inf, target
        while not self.budget.is_set():
            reached = self.reached()
            leaves = [self.domain.leaves[k] for k in reached]
            outer = [leaf for leaf in leaves if self._sides(leaf)]
            if not outer:
                best = min(best, max(leaf.value for leaf in leaves))
            tell(len(leaves), len(outer), best)
            todo = [leaf for leaf in outer if not leaf.done] or [leaf for leaf in leaves if not leaf.done]
            todo.sort(key=lambda leaf: -leaf.value)
            if todo and (outer or todo[0].value > target):
                for leaf in todo[:8]:
                    if not self.budget.is_set():
                        self.contract(leaf)
                continue
            if outer:
                worst = max(outer, key=lambda leaf: self.coarse(leaf.box))
                if self.coarse(worst.box) > COARSE:
                    self.split(worst, 3)
                elif not self._learn(outer):
                    self.enlarge(outer)
                continue
            worst = max(leaves, key=lambda leaf: leaf.value)
            self.closed = True
            if worst.value <= target:
                return float(worst.value)
            if worst.tries < TRIES and GOAL in worst.poses and self.add_points([worst.poses[GOAL]]):
                worst.tries += 1
                self.contract(worst)
                continue
            self.split(worst)
        return float(best)

    def _learn(self, outer: list[Leaf]) -> bool:
        """New points from where leaves meet the border of the domain, and the leaves cut again; False where there were none."""
        again = []
        for leaf in outer:
            poses = [leaf.poses[side] for side in self._sides(leaf) if side in leaf.poses]
            if leaf.tries < TRIES and self.add_points(poses):
                leaf.tries += 1
                again.append(leaf)
        for leaf in again:
            if not self.budget.is_set():
                self.contract(leaf)
        return bool(again)

    def coarse(self, box: Box) -> float:
        """How much linearisation leaves out, against a tenth of the clearance."""
        d = box.half[3:]
        middle = 1 + float(box.middle[3:] @ box.middle[3:])
        return float(2 * self.radius * (d @ d) / middle / (0.1 * self.clearance))

    def _sides(self, leaf: Leaf) -> list[tuple[int, int]]:
        """Sides of the domain that a leaf meets."""
        box, own = self.domain.box, leaf.box
        free = self.domain.free
        return [(k, -1) for k in range(6) if free[k] and own.low[k] <= box.low[k]] + [
            (k, 1) for k in range(6) if free[k] and own.high[k] >= box.high[k]
        ]

    def enlarge(self, outer: list[Leaf]) -> None:
        """Slabs beyond the sides of the domain that leaves meet."""
        for axis, sign in sorted({side for leaf in outer for side in self._sides(leaf)}):
            low, high = self.domain.box.low.copy(), self.domain.box.high.copy()
            width = high[axis] - low[axis]
            more_low, more_high = low.copy(), high.copy()
            if sign > 0:
                at = high[axis]
                high[axis] = more_high[axis] = at + width
                more_low[axis] = at
            else:
                at = low[axis]
                low[axis] = more_low[axis] = at - width
                more_high[axis] = at
            if max(np.abs(low[:3]).max(), np.abs(high[:3]).max()) > self.reach:
                raise Unbounded("nothing was found that keeps it near: it may leave")
            if max(np.abs(low[3:]).max(), np.abs(high[3:]).max()) > LARGEST_TURN:
                raise Unbounded("it turns by half a turn or more, and bounds in space end there")
            more = Leaf(Box(more_low, more_high), {}, np.inf)
            sides = [self.domain.root, more.step] if sign > 0 else [more.step, self.domain.root]
            self.domain.root = {"split": [axis, float(at)], "then": sides}
            self.domain.box = Box(low, high)
            self.domain.leaves.append(more)

    def split(self, leaf: Leaf, first: int = 0) -> None:
        """Two halves of a leaf, across the longest side of those from `first` on."""
        box = leaf.box
        width = (box.high - box.low) * self.scale
        width[:first] = -1.0
        axis = int(width.argmax())
        at = float(box.middle[axis])
        low, high = box.low.copy(), box.high.copy()
        high[axis] = low[axis] = at
        halves = [Leaf(b, {}, leaf.value, near=leaf.near) for b in (Box(box.low, high), Box(low, box.high))]
        leaf.step.clear()
        leaf.step |= {"split": [axis, at], "then": [half.step for half in halves]}
        self.domain.leaves.remove(leaf)
        self.domain.leaves += halves
        for half in halves:
            self.contract(half)

    def reached(self) -> list[int]:
        """Leaves that a path from rest may reach."""
        low = np.array([leaf.box.low for leaf in self.domain.leaves])
        high = np.array([leaf.box.high for leaf in self.domain.leaves])
        new = ((low <= 0) & (high >= 0)).all(axis=1)
        seen = new.copy()
        todo = np.flatnonzero(new).tolist()
        while todo:
            k = todo.pop()
            more = ~seen & (low <= high[k]).all(axis=1) & (high >= low[k]).all(axis=1)
            seen |= more
            todo += np.flatnonzero(more).tolist()
        return np.flatnonzero(seen).tolist()

    def contract(self, leaf: Leaf) -> None:
        """Bound the goal in a leaf; where that is not enough, or it meets the border, cut off what is not free first, again and again."""
        leaf.done = True
        free = self.domain.free
        for turn in range(ROUNDS + 1):
            box = leaf.box
            m, d = box.middle, box.half
            rows, program = self._program(leaf)
            self._bound(leaf, rows, program)
            if turn == ROUNDS or (leaf.value <= self.target and not self._sides(leaf)):
                return
            cuts: list[list[Any]] = []
            low, high = box.low.copy(), box.high.copy()
            for axis, sign in ((int(k), s) for k in np.flatnonzero(free & (d > 0)) for s in (1, -1)):
                y, leaf.poses[axis, sign] = self._asked(program, np.eye(6)[axis] * sign, box)
                end = self._most(rows, y, 0.0, np.eye(6)[axis] * sign, d) + sign * m[axis]
                end += ROUNDING * (abs(end) + d[axis])
                before = high[axis] if sign > 0 else -low[axis]
                if not end < before - LEAST_CUT * 2 * d[axis]:
                    continue
                (high if sign > 0 else low)[axis] = sign * end
                cuts.append([axis, sign, float(sign * end), _used(y)])
                if low[axis] > high[axis]:
                    leaf.step.clear()
                    leaf.step |= _tidy(rows, {"cuts": cuts})
                    self.domain.leaves.remove(leaf)
                    return
            if not cuts:
                return
            below: dict[str, Any] = {}
            leaf.step.clear()
            leaf.step |= _tidy(rows, {"cuts": cuts}) | {"then": [below]}
            leaf.step, leaf.box = below, Box(low, high)
            if not ((high - low)[d > 0] < SHRUNK * (2 * d)[d > 0]).any():
                rows, program = self._program(leaf)
                self._bound(leaf, rows, program)
                return

    def _rows(self, leaf: Leaf) -> Rows:
        """All rows of a leaf."""
        parts, leaf.near = zip(
            *(c.rows(leaf.box, near) for c, near in zip(self.contacts, leaf.near or (None, None), strict=True)),
            strict=True,
        )
        return Rows(*(np.concatenate([getattr(r, f.name) for r in parts]) for f in fields(Rows)))

    def calmest(self) -> Floats:
        """The point [mm] from the origin that moves least in the largest turns which rows at rest allow."""
        free, half = self.domain.free, np.append(np.full(3, 2 * self.radius), np.full(3, 0.5))
        near = np.where(free, 1.5 * self.clearance / self.scale, 0.0)
        rows = self._rows(Leaf(Box(-near, near), {}, np.inf))
        half = np.where(free, half, 0.0) * self.scale
        matrix = sp.csr_matrix(rows.slope / self.scale)
        program = DualLinearProgram(matrix, -rows.constant, np.full(len(rows.point), np.inf), -half, half)
        A, b = [FIRM * np.eye(3)], [np.zeros(3)]
        for axis in np.vstack([np.eye(6)[3:], -np.eye(6)[3:]]):
            program.ask(axis)
            u, turn = program.x[:3] / self.scale[:3], 2 * program.x[3:6] / self.scale[3:]
            A.append(np.cross(np.eye(3), turn))
            b.append(-u)
        return np.asarray(np.linalg.lstsq(np.vstack(A), np.concatenate(b), rcond=None)[0])

    def _program(self, leaf: Leaf) -> tuple[Rows, DualLinearProgram]:
        """All rows of a leaf, and a linear program of them, in which rows may be violated at a price."""
        rows = self._rows(leaf)
        count, half = len(rows.point), leaf.box.half * self.scale
        self.budget.spend(ROW_WORK * (200 + count))
        matrix = sp.csr_matrix(np.hstack([rows.slope / self.scale, np.ones((count, 1))]))
        high = np.full(count, np.inf)
        program = DualLinearProgram(matrix, -rows.constant, high, np.append(-half, 0.0), np.append(half, 1e6))
        return rows, program

    def _asked(self, program: DualLinearProgram, cost: Floats, box: Box) -> tuple[Floats, Floats]:
        """Multipliers of the largest cost (6,) . (pose - middle), and the pose."""
        cost = cost / self.scale
        size = float(np.linalg.norm(cost)) or 1.0
        y = size * np.maximum(-program.ask(np.append(cost / size, -PENALTY)), 0.0)
        self.budget.spend(ROW_WORK * (200 + program.count))
        return y, box.middle + np.clip(program.x[:6] / self.scale, -box.half, box.half)

    def _bound(self, leaf: Leaf, rows: Rows, program: DualLinearProgram) -> None:
        """The largest value of the goal in a leaf."""
        constant, slope = self.goal.above(leaf.box)
        y, leaf.poses[GOAL] = self._asked(program, slope, leaf.box)
        d = leaf.box.half
        value = self._most(rows, y, constant, slope, d)
        leaf.value = float(value + ROUNDING * (abs(value) + np.abs(slope) @ d))
        leaf.step.clear()
        leaf.step |= _tidy(rows, {"best": _used(y)})

    def _most(self, rows: Rows, y: Floats, constant: float, slope: Floats, d: Floats) -> float:
        """What multipliers prove: no free pose of the box makes constant + slope . (pose - middle) larger."""
        total = slope + y @ rows.slope if len(y) else slope
        return float(constant + y @ rows.constant + np.abs(total) @ d)

    def add_points(self, poses: list[Floats]) -> int:
        """Middles of what edges of one body bite into pieces of the other at some poses; how many were new."""
        found = 0
        for contacts, ends, fixed in zip(self.contacts, self.edges, (False, True), strict=True):
            if len(contacts.points) > MOST_POINTS or not len(ends) or not poses:
                continue
            self.budget.spend(EDGE_WORK * len(poses) * len(ends) * len(contacts.normals))
            placed = np.array(
                [(ends - p[:3]) @ rotation(p[3:]) if fixed else ends @ rotation(p[3:]).T + p[:3] for p in poses]
            )
            edge, first, last, depth = contacts.bites(placed.reshape(-1, 2, 3))
            start, stop = ends[edge % len(ends)].transpose(1, 0, 2)
            points = start + ((first + last) / 2)[:, None] * (stop - start)
            most = len(contacts.points) + ADDED * len(poses)
            for i in np.argsort(-depth):
                if depth[i] < BITE * self.clearance or len(contacts.points) >= most:
                    break
                if len(contacts.points) and np.abs(contacts.points - points[i]).max(axis=1).min() < self.clearance:
                    continue
                named = self.material(fixed, points[i])
                if named is not None:
                    contacts.add(np.array([named[0]]), named[1][None])
                    found += 1
        return found


def _used(y: Floats) -> list[list[float]]:
    """Multipliers that are not zero, with the number of their row."""
    return [[int(k), float(y[k])] for k in np.flatnonzero(y > 1e-12)]


def _tidy(rows: Rows, step: dict[str, Any]) -> dict[str, Any]:
    """A step with the rows alone that its multipliers use."""
    every = [cut[3] for cut in step.get("cuts", [])] + [step[k] for k in ("best",) if k in step]
    used = sorted({k for multipliers in every for k, _ in multipliers})
    number = {k: i for i, k in enumerate(used)}
    out: dict[str, Any] = {"rows": [[int(rows.point[k]), int(rows.piece[k]), int(rows.face[k])] for k in used]}
    if "cuts" in step:
        out["cuts"] = [[a, s, e, [[number[k], y] for k, y in multipliers]] for a, s, e, multipliers in step["cuts"]]
    if "best" in step:
        out["best"] = [[number[k], y] for k, y in step["best"]]
    return out
