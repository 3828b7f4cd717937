"""Step 2: bounds. What the pairs' regions leave, by weak duality, in ball arithmetic.

Body b moves its origin by (x, y) and turns by t. With arms p, q from both origins to the pivot of a pair, and tau where the pivot of B is
seen from A, phi = t_b - t_a,

    E = x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) p - R(t_a) tau = 0.

Let v be t_a less the middle of its range, u the mean of t_a and t_b less the middle m of its own. So for any force w of a pair, any
moment k, slopes l and n, couplings r and s, curvature c, and any weight g >= 0 of "goal >= worth",

    what is asked <= what is asked - sum of w . E + k (phi - t_b + t_a) + l (t_a - middle - v) + n ((t_a + t_b) / 2 - m - u)
        + r (cos m (sin t_b - sin t_a) - sin m (cos t_b - cos t_a) - 2 cos u sin(phi / 2))
        + s (cos m (cos t_b - cos t_a) + sin m (sin t_b - sin t_a) + 2 sin u sin(phi / 2))
        + c ((1 - cos(t_a - middle)) - (1 - cos v)) + g (goal - worth),

as every term in brackets is nought. The right side falls into a part for each body, a function alpha cos t + beta sin t + gamma t
whose largest value over a range of turns is known, and a part for each pair in (tau, phi), v and u. That one is linear in (tau, phi)
and in u but for remainders (d = tau less its middle, all absolute values at their largest, h that of v):

    w . R(middle + v) d = w . R(middle) (d + v J d) + at most |w| |d| (1 + h / 3) v^2 / 2, or without v J d at most |w| |d| 2 sin(h / 2),
    1 - cos v >= (1 - h^2 / 12) v^2 / 2 and >= 0, <= v^2 / 2 and <= 2,
    2 cos u sin(phi / 2) = c phi + at most e |phi|, where c - e and c + e are cos u sin(phi / 2) / (phi / 2) at the ends and 1,
    2 sin u sin(phi / 2) = u phi + at most |u phi| (u^2 / 6 + phi^2 / 24).

What is linear in (tau, phi) and u, or convex, is largest at corners; in v the largest value of a parabola over [-h, h] is taken. Bad
numbers give a bad bound, never a wrong one.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from wiggleroom.verify.ball_arithmetic import Point, Refused, exact, less, need, size
from wiggleroom.verify.work_limit import EXACT, WorkLimit

ROUNDED = 1e-12
"""Largest values over corners are found in double precision and made larger by this share of their terms, a thousand times their error."""
WIDEST = 1.5
"""Means of turns are known this well [rad], or couplings are refused."""


class Enclosure:
    """Corners of one region; what they are between two turns."""

    def __init__(self, region: dict[str, Any]) -> None:
        self.angles = np.array([float(angle) for angle, _ in region["loops"]])
        loops = [np.array(at, dtype=float).reshape(-1, 2) for _, at in region["loops"]]
        self.corners = np.vstack(
            [np.column_stack([at, np.full(len(at), t)]) for t, at in zip(self.angles, loops, strict=True)]
        )
        self.tracks = [
            (start[(pairs := np.array(tracks, dtype=int))[:, 0]], end[pairs[:, 1]])
            for (tracks, _), start, end in zip(region["seams"], loops, loops[1:], strict=False)
        ]
        self.far = float(np.hypot(*self.corners[:, :2].T).max()) * (1 + ROUNDED)
        self.steps = len(self.corners) + sum(len(start) for start, _ in self.tracks) + EXACT

    def between(self, low: float, high: float) -> np.ndarray:
        """Corners (k, 3) of all that the caging surface encloses between two turns: corners of loops, and tracks where they are cut."""
        turns = self.corners[:, 2]
        found = [self.corners[(low <= turns) & (turns <= high)]]
        for level in (low, high):
            if self.angles[0] <= level <= self.angles[-1]:
                k = min(int(np.searchsorted(self.angles, level, side="right")) - 1, len(self.tracks) - 1)
                share = (level - self.angles[k]) / (self.angles[k + 1] - self.angles[k])
                start, end = self.tracks[k]
                at = (1 - share) * start + share * end
                found.append(np.column_stack([at, np.full(len(at), level)]))
        return np.vstack(found)


class Case:
    """Bodies, regions and pairs, what is known of turns between bodies, and the goal, if there is one.

    `known` holds (a, b, low, high): in every motion low <= t_b - t_a <= high.
    """

    def __init__(
        self,
        origin: list[Point],
        fixed: list[bool],
        enclosures: list[Enclosure],
        pairs: list,
        goal: list,
        worth: arb,
        work: WorkLimit,
        doubt: arb | None = None,
    ) -> None:
        self.origin, self.fixed, self.enclosures, self.pairs = origin, fixed, enclosures, pairs
        self.goal, self.worth, self.work = goal, worth, work
        self.doubt = arb(0) if doubt is None else doubt
        self.known: list[tuple[int, int, float, float]] = []
        for a, b, kind, *_ in pairs:
            turns = enclosures[kind].angles
            self.known.append((a, b, float(turns[0]), float(turns[-1])))

    def first(self, low: list, high: list, far: list, names: list[str]) -> None:
        """Refuse first ranges that nothing shows: turns and shifts add up along ways to a fixed body."""
        steps = self._steps()
        up, down = self._shortest(steps[0]), self._shortest(steps[1])
        shifts = []
        for a, b, kind, x, y, _ in self.pairs:
            swing = 0.0
            for k in (a, b):
                arm = math.hypot(x - float(self.origin[k][0]), y - float(self.origin[k][1]))
                swing += arm * 2 * math.sin(min(max(up[k], down[k]), math.pi) / 2)
            step = (self.enclosures[kind].far + swing + float(self.doubt.upper())) * (1 + ROUNDED)
            shifts += [(a, b, step), (b, a, step)]
        most = self._shortest(shifts)
        for k, name in enumerate(names):
            if low[k] is not None:
                fits = -low[k] >= down[k] and high[k] >= up[k] and far[k] >= most[k]
                need(fits, f"nothing shows that {name} stays within its first range")

    def _steps(self) -> tuple[list, list]:
        up = [(a, b, high) for a, b, _, high in self.known] + [(b, a, -low) for a, b, low, _ in self.known]
        down = [(a, b, -low) for a, b, low, _ in self.known] + [(b, a, high) for a, b, _, high in self.known]
        return up, down

    def _shortest(self, steps: list[tuple[int, int, float]], start: list[float] | None = None) -> list[float]:
        """Length of the shortest way to each body along steps (from, to, length >= 0), from a fixed one or with a `start`; rounded up."""
        self.work.spend(4 * len(steps) + EXACT)
        out: list[list[tuple[int, float]]] = [[] for _ in self.fixed]
        for one, end, length in steps:
            out[one].append((end, length))
        found = [0.0 if fixed else math.inf for fixed in self.fixed] if start is None else list(start)
        heap = [(length, k) for k, length in enumerate(found) if length < math.inf]
        heapq.heapify(heap)
        while heap:
            length, k = heapq.heappop(heap)
            if length > found[k]:
                continue
            self.work.spend(len(out[k]))
            for end, more in out[k]:
                reached = math.nextafter(length + more, math.inf)
                if reached < found[end]:
                    found[end] = reached
                    heapq.heappush(heap, (reached, end))
        return found

    def spread(self, low: list, high: list) -> tuple[list, list]:
        """Ranges of turns, narrower where turns of other bodies say so."""
        up, down = self._steps()
        high = self._shortest(up, [math.inf if v is None else v for v in high])
        least = self._shortest(down, [math.inf if v is None else -v for v in low])
        ends = zip(low, least, high, strict=True)
        return [None if one is None else -v for one, v, _ in ends], [
            None if one is None else v for one, v in zip(low, high, strict=True)
        ]


class RangedCase:
    """One step of a proof: ranges of turns, of bodies and of pairs, in which multipliers are asked.

    `low`, `high` and `far` are of bodies, `turns` of pairs [[low, high], ..], all at least as wide as what is known.
    """

    def __init__(self, case: Case, low: list, high: list, far: list, turns: list) -> None:
        self.case, self.low, self.high, self.far = case, low, high, far
        need(len(turns) == len(case.pairs), "turns of pairs are not complete")
        for p, (one, two) in enumerate(turns):
            mine = self.pair(p)
            need(one <= mine[0] and mine[1] <= two, "nothing shows that a pair stays within its range")
        self.turns = turns
        self.shapes: dict[int, Shape] = {}

    def pair(self, p: int) -> tuple[float, float]:
        """Turns of a pair that ranges of its bodies and what is known of it leave, rounded outwards."""
        a, b = self.case.pairs[p][:2]
        need(None not in (self.low[a], self.low[b]), "a pair is used that nothing holds")
        low, high = self.low[b] - self.high[a], self.high[b] - self.low[a]
        least, most = self.case.known[p][2:]
        return max(math.nextafter(low, -math.inf), least), min(math.nextafter(high, math.inf), most)

    def most(self, multipliers: list, asked: tuple[int, int] | None, base: BaseBound | None = None) -> arb:
        """Bound of the goal, or of what a body (number, sign) turns in motions worth more than `worth`.

        Pairs that are not named have no multipliers, or the weight of the goal times those of the base.
        """
        unit, goal, rows = multipliers
        case = self.case
        weight = exact(goal) if asked else arb(1)
        need(bool(weight >= 0), "a weight is negative")
        need(len({row[0] for row in rows}) == len(rows), "a pair is named twice")
        of_one = exact(unit)
        case.work.spend(EXACT * (2 * len(rows) + 1))
        added = {p: self._pair(p, [of_one * v for v in whole]) for p, *whole in rows}
        bodies = {k for p in added for k in case.pairs[p][:2]} | ({asked[0]} if asked else set())
        total = -weight * case.worth if asked else arb(0)
        if base is None:
            case.work.spend(EXACT * len(case.goal))
            parts = self._goal_parts()
            bodies |= set(parts)
        else:
            parts = {k: list(base.parts[k]) for k in bodies if k in base.parts}
            less_of = [base.pairs[p] for p in added if p in base.pairs]
            for p in added:
                if p in base.pairs:
                    _gather(parts, case.pairs[p], base.pairs[p], -1)
            gone = sum((value for value, *_ in less_of), start=arb(0))
            gone += sum((base.bodies.get(k, arb(0)) for k in bodies), start=arb(0))
            total += weight * (base.total - gone)
        parts = {k: [weight * v for v in part] for k, part in parts.items()}
        if asked:
            _part(parts, asked[0])[4] += asked[1]
        for p, found in added.items():
            total += found[0]
            _gather(parts, case.pairs[p], found, 1)
        return total + sum((self._body(k, parts[k]) for k in bodies if k in parts), start=arb(0))

    def base(self, multipliers: list) -> BaseBound:
        """What multipliers say of the goal, pair by pair and body by body."""
        unit, _, rows = multipliers
        case, of_one = self.case, exact(unit)
        need(len({row[0] for row in rows}) == len(rows), "a pair is named twice")
        case.work.spend(EXACT * (len(case.goal) + 2 * len(rows) + 1))
        pairs = {p: self._pair(p, [of_one * v for v in whole]) for p, *whole in rows}
        parts = self._goal_parts()
        for p, found in pairs.items():
            _gather(parts, case.pairs[p], found, 1)
        bodies = {k: self._body(k, part) for k, part in parts.items()}
        total = sum((value for value, *_ in pairs.values()), start=arb(0))
        return BaseBound(pairs, parts, bodies, total + sum(bodies.values(), start=arb(0)))

    def _goal_parts(self) -> dict[int, list[arb]]:
        """Weights of x, y, cos t - 1, sin t and t of the bodies that are asked about."""
        parts: dict[int, list[arb]] = {}
        for body, dx, dy, px, py, spin in self.case.goal:
            part = _part(parts, body)
            _add(part, (exact(dx), exact(dy)), less((exact(px), exact(py)), self.case.origin[body]))
            part[4] += exact(spin)
        return parts

    def _body(self, k: int, part: list[arb]) -> arb:
        """What a body adds at most."""
        x, y, c, s, t = part
        if self.case.fixed[k] or all(v == 0 for v in part):
            return arb(0)
        need(self.far[k] is not None and self.low[k] is not None, "a body counts that nothing holds")
        return (abs(x) + abs(y)) * exact(self.far[k]) + highest(c, s, t, exact(self.low[k]), exact(self.high[k])) - c

    def _pair(self, p: int, multipliers: list[arb]) -> tuple[arb, list[arb], list[arb]]:
        """What a pair adds, and the weights that depend on the turns of its two bodies."""
        wx, wy, k, slope, lean, r, s, curvature = multipliers
        shape = self._shape(p)
        middle, own, mean = shape.middle, shape.own, shape.mean
        force = wx, wy
        one, two = [arb(0)] * 5, [arb(0)] * 5
        _add(two, (-wx, -wy), shape.arm_b)
        _add(one, force, shape.arm_a)
        if not (r == 0 and s == 0):
            c, z = shape.mean_turned
            for part, sign in ((one, -1), (two, 1)):
                part[2] += sign * (s * c - r * z)
                part[3] += sign * (r * c + s * z)
        one[4] += lean / 2 + k + slope
        two[4] += lean / 2 - k
        around = shape.own_turned
        one[2] -= curvature * around[0]
        one[3] -= curvature * around[1]
        total = wx * middle[0] + wy * middle[1] - slope * own - lean * mean + curvature * (1 - around[0])
        long = size(force)
        total += long * (self.case.doubt + shape.slip)
        twist = abs(k)
        if not (r == 0 and s == 0):
            if shape.coupling is None:
                raise Refused("turns are coupled that are not known well enough")
            chord, sag, skew = shape.coupling
            total += abs(r) * sag + abs(s) * skew
            k, twist = k - r * chord, twist + abs(r) * chord  # what cancels leaves the rounding of both
        # the force in axes turned by the middle of t_a
        rest = around[0] * wx + around[1] * wy, around[0] * wy - around[1] * wx
        half = shape.half
        # what is left of c (1 - cos v) less the remainder, as a share of v^2 / 2, rounded down
        left = curvature * (shape.least if curvature >= 0 else 1) - long * shape.remainder
        x, y, phi = shape.corners
        self.case.work.spend(len(phi))
        v = [float(n) for n in (rest[0], rest[1], k, slope, lean, s)]
        h, lever, hollow = shape.half_up, shape.half_mean, math.nextafter(float(left.lower()), -math.inf)
        level = x * v[0] + y * v[1] + phi * v[2]
        if v[4] or v[5]:
            level += np.abs(phi * v[5] - v[4]) * lever
        swing = np.abs(x * v[1] - y * v[0] - v[3])
        wide = shape.wide
        steep = wide[0] * (abs(v[0]) + abs(v[1])) + wide[1] * (abs(v[0]) + abs(v[1]))
        terms = steep * (1 + h) + (
            wide[2] * _up(twist) + (wide[2] * abs(v[5]) + abs(v[4])) * lever + abs(v[3]) * h + abs(hollow) * h * h
        )
        bounds = (
            arb(float((level + _parabola(swing, hollow, h)).max())),
            arb(float(level.max())) + long * shape.blur + abs(slope) * half,
        )
        if curvature < 0:
            bounds = bounds[0], bounds[1] - curvature * (half * half / 2).min(arb(2))
        best = bounds[0] if bounds[0] < bounds[1] else bounds[1]
        return total + best + arb(ROUNDED * terms), one, two

    def _shape(self, p: int) -> Shape:
        """Corners less their middle in the world's axes, and what else does not depend on multipliers; kept."""
        if p in self.shapes:
            return self.shapes[p]
        a, b, kind, pivot_x, pivot_y, axes = self.case.pairs[p]
        low, high = self.turns[p]
        enclosure = self.case.enclosures[kind]
        self.case.work.spend(3 * enclosure.steps)
        corners = enclosure.between(low, high)
        need(len(corners) > 0, "a pair is left no turn")
        c, s = math.cos(axes), math.sin(axes)
        at = np.column_stack([c * corners[:, 0] - s * corners[:, 1], s * corners[:, 0] + c * corners[:, 1]])
        middle = (at.min(0) + at.max(0)) / 2
        at = at - middle
        rounded = ROUNDED * (float(np.abs(corners[:, :2]).max()) + float(np.abs(middle).max()))
        reach = exact(float(np.hypot(*at.T).max()) * (1 + ROUNDED) + rounded)
        around = np.vstack([at.T, corners[:, 2]])
        one, two = exact(self.low[a]), exact(self.high[a])
        own, half = (one + two) / 2, (two - one) / 2
        sums = one + exact(self.low[b]), two + exact(self.high[b])
        mean, lean = (sums[0] + sums[1]) / 4, (sums[1] - sums[0]) / 4
        most = max(abs(low), abs(high))
        coupling = None
        if lean < WIDEST and most < WIDEST:
            f = exact(most)
            least = lean.cos() * ((f / 2).sin() / (f / 2) if most > 0 else arb(1))
            coupling = (1 + least) / 2, (1 - least) / 2 * f, lean * f * (lean * lean / 6 + f * f / 24)
        pivot = exact(pivot_x), exact(pivot_y)
        box = exact(middle[0]), exact(middle[1])
        arm = less(pivot, self.case.origin[a])
        self.shapes[p] = Shape(
            corners=around,
            wide=np.abs(around).max(1),
            middle=box,
            arm_a=(arm[0] + box[0], arm[1] + box[1]),
            arm_b=less(pivot, self.case.origin[b]),
            own=own,
            own_turned=(own.cos(), own.sin()),
            mean=mean,
            mean_turned=(mean.cos(), mean.sin()),
            half=half,
            half_up=_up(half),
            half_mean=_up(lean),
            least=(1 - half * half / 12).max(arb(0)),
            remainder=reach * (1 + half / 3),
            blur=reach * 2 * (half.min(arb.pi()) / 2).sin(),
            slip=exact(2 * rounded * (1 + _up(half))),
            coupling=coupling,
        )
        return self.shapes[p]


@dataclass(frozen=True, eq=False)
class BaseBound:
    """What multipliers say of the goal: of each pair its value and the weights of its two bodies, of bodies weights and value, and all."""

    pairs: dict[int, tuple[arb, list[arb], list[arb]]]
    parts: dict[int, list[arb]]
    bodies: dict[int, arb]
    total: arb


@dataclass(frozen=True, eq=False)
class Shape:
    """What of a pair does not depend on multipliers, in the world's axes at rest.

    Parameters
    ----------
    corners : (3, k) float64
        Corners of the region, less `middle`.
    wide : (3,) float64
        Largest absolute values of these.
    middle : pair of arb [mm]
    arm_a, arm_b : pair of arb [mm]
        From both origins to the pivot, that of a to where it is in the middle of what can be.
    own, mean : arb [rad]
        Middle of the range of t_a, and of the range of the mean of t_a and t_b; both with their cosine and sine.
    half : arb [rad]
        Half of the range of t_a; `half_up` is not less, `half_mean` not less than half of the range of the mean.
    least : arb
        1 - cos v is at least this share of v^2 / 2.
    remainder, blur : arb [mm]
        A force errs by at most its length times remainder v^2 / 2 with products of v and tau, times blur without.
    slip : arb [mm]
        A corner that is rounded adds at most the force times this.
    coupling : triple of arb, optional
        c, e f and the error of u phi, f the largest |phi|; None where turns are not known well enough.
    """

    corners: np.ndarray
    wide: np.ndarray
    middle: Point
    arm_a: Point
    arm_b: Point
    own: arb
    own_turned: Point
    mean: arb
    mean_turned: Point
    half: arb
    half_up: float
    half_mean: float
    least: arb
    remainder: arb
    blur: arb
    slip: arb
    coupling: tuple[arb, arb, arb] | None


def _parabola(slope: np.ndarray, curvature: float, half: float) -> np.ndarray:
    """Largest slope v - curvature v^2 / 2 for 0 <= v <= half, of slopes (k,) of at least nought."""
    end = slope * half - curvature * half * half / 2
    if curvature <= 0:
        return end
    inside = slope < curvature * half
    return np.where(inside, slope * slope / np.where(inside, 2 * curvature, 1.0), end)


def _up(value: arb) -> float:
    """A double that is not less."""
    return math.nextafter(float(value.upper()), math.inf)


def _part(parts: dict[int, list[arb]], body: int) -> list[arb]:
    """Weights that belong to a body, nought at first."""
    return parts.setdefault(body, [arb(0)] * 5)


def _gather(parts: dict[int, list[arb]], pair: list, found: tuple[arb, list[arb], list[arb]], sign: int) -> None:
    """Add what a pair gives its two bodies, or take it away."""
    for body, more in zip(pair[:2], found[1:], strict=True):
        parts[body] = [v + sign * m for v, m in zip(_part(parts, body), more, strict=True)]


def _add(part: list, force: Point, arm: Point) -> None:
    """Weights of force . (x, y) + force . (R(t) - 1) arm."""
    part[0] += force[0]
    part[1] += force[1]
    part[2] += force[0] * arm[0] + force[1] * arm[1]
    part[3] += force[1] * arm[0] - force[0] * arm[1]


def highest(alpha: arb, beta: arb, gamma: arb, low: arb, high: arb) -> arb:
    """Upper bound of alpha cos t + beta sin t + gamma t for all t between `low` and `high`."""

    def value(t: arb) -> arb:
        return alpha * t.cos() + beta * t.sin() + gamma * t

    need(bool(low <= high), "a range is empty")
    best = value(low).max(value(high))
    square = alpha * alpha + beta * beta
    if not square > 0:  # nothing but rounding, for all one can tell: no more than the two together
        return best + 2 * (abs(alpha) + abs(beta))
    radius = square.sqrt()
    if abs(gamma) > radius:
        return best  # it rises or falls throughout
    if not abs(gamma) < radius:
        return best + (radius + abs(gamma)) * (high - low)
    top = arb.atan2(beta, alpha) + (gamma / radius).asin()
    # tops rise or fall throughout: the first or the last one is highest
    first, last = (math.floor(float((end - top) / (2 * arb.pi()))) for end in (low, high))
    for turns in {
        *range(first - 1, first + 3),
        *range(last - 2, last + 2),
    }:
        t = top + 2 * arb.pi() * turns
        if not (t < low or t > high):
            best = best.max(value(t))
    return best
