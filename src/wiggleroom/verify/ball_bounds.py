"""Step 2: bounds. What the pairs' regions leave, by weak duality, in ball arithmetic.

Body b moves its origin by (x, y) and turns by t. With arms p, q from both origins to the pivot of a pair, and tau where the pivot of B is
seen from A,

    E = x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) p - R(t_a) tau = 0.

So for any forces w of pairs, any weights u >= 0 of facets n . tau + c (t_b - t_a) <= d and any weight g >= 0 of "goal >= worth",

    what is asked <= what is asked - sum of w . E + sum of u (d - n . tau - c (t_b - t_a)) + g (goal - worth),

and the right side falls into a part for each body, a function alpha cos t + beta sin t + gamma t whose largest value over a
range of turns is known, and a part for each pair, in which tau differs from the middle of its region by at most its
reach. Bad numbers give a bad bound,
never a wrong one.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from flint import arb

from wiggleroom.verify.ball_arithmetic import Point, exact, less, need, size, turned
from wiggleroom.verify.work_limit import EXACT, WorkLimit

ROUNDED = 1e-12
"""Largest values over corners are found in double precision and made larger by this share of their terms, a thousand times their error."""


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


class TurnRanges:
    """Turns of all bodies, None where nothing is known; cuts are taken back when a step of the proof is done."""

    def __init__(self, low: list, high: list, far: list) -> None:
        self.low, self.high, self.far = low, high, far

    @contextmanager
    def cut(self, cuts: list[tuple[int, int, float]]) -> Iterator[bool]:
        """For a while the turns of bodies are at most `end` (sign 1) or at least `end` (-1); True where this leaves some body no turn."""
        before = [(body, self.low[body], self.high[body]) for body, _, _ in cuts]
        for body, sign, end in cuts:
            if sign > 0:
                self.high[body] = min(self.high[body], end)
            else:
                self.low[body] = max(self.low[body], end)
        yield any(self.low[body] > self.high[body] for body, _, _ in cuts)
        for body, low, high in reversed(before):
            self.low[body], self.high[body] = low, high

    def pair(self, a: int, b: int) -> tuple[float, float]:
        """Turns of b against a, rounded outwards."""
        need(None not in (self.low[a], self.low[b]), "a pair is used that nothing holds")
        low, high = self.low[b] - self.high[a], self.high[b] - self.low[a]
        return math.nextafter(low, -math.inf), math.nextafter(high, math.inf)


class Case:
    """Regions, pairs and goal of a certificate, to ask what multipliers prove."""

    def __init__(self, content: dict[str, Any], work: WorkLimit) -> None:
        self.bodies = content["bodies"]
        self.fixed = [body["fixed"] for body in self.bodies]
        self.origin = [tuple(exact(v) for v in body["origin"]) for body in self.bodies]
        self.enclosures = [Enclosure(region) for region in content["regions"]]
        self.pairs = content["pairs"]
        self.goal = content["goal"]
        self.worth = exact(content["worth"])
        self.work = work

    def first(self) -> TurnRanges:
        """Ranges of the file, once it is sure that they hold: turns and shifts add up along ways to a fixed body."""
        spans = [(a, b, self.enclosures[kind].angles) for a, b, kind, *_ in self.pairs]
        up = self._shortest([(a, b, float(t[-1])) for a, b, t in spans] + [(b, a, -float(t[0])) for a, b, t in spans])
        down = self._shortest([(a, b, -float(t[0])) for a, b, t in spans] + [(b, a, float(t[-1])) for a, b, t in spans])
        steps = []
        for a, b, kind, x, y, _ in self.pairs:
            swing = 0.0
            for k in (a, b):
                arm = math.hypot(x - float(self.origin[k][0]), y - float(self.origin[k][1]))
                swing += arm * 2 * math.sin(min(max(up[k], down[k]), math.pi) / 2)
            step = (self.enclosures[kind].far + swing) * (1 + ROUNDED)
            steps += [(a, b, step), (b, a, step)]
        far = self._shortest(steps)
        for k, body in enumerate(self.bodies):
            if body["low"] is not None:
                fits = -body["low"] >= down[k] and body["high"] >= up[k] and body["far"] >= far[k]
                need(fits, f"nothing shows that {body['parts'][0]} stays within its first range")
        return TurnRanges(*([body[k] for body in self.bodies] for k in ("low", "high", "far")))

    def _shortest(self, steps: list[tuple[int, int, float]]) -> list[float]:
        """Length of the shortest way from a fixed body to each, along steps (from, to, length); rounded up."""
        out: list[list[tuple[int, float]]] = [[] for _ in self.bodies]
        for start, end, length in steps:
            out[start].append((end, length))
        found = [math.inf] * len(self.bodies)
        heap = [(0.0, k) for k, fixed in enumerate(self.fixed) if fixed]
        while heap:
            length, k = heapq.heappop(heap)
            if length >= found[k]:
                continue
            found[k] = length
            for end, more in out[k]:
                if found[end] == math.inf:
                    heapq.heappush(heap, (math.nextafter(length + more, math.inf), end))
        return found


class WeakDuality:
    """One step of a proof: facets of pairs, and the ranges of turns in which its multipliers are asked."""

    def __init__(self, case: Case, facets: list, ranges: TurnRanges) -> None:
        self.case, self.facets, self.ranges = case, facets, ranges
        self.pairs: dict[int, tuple[np.ndarray, arb, dict[int, float]]] = {}

    def most(self, multipliers: list, asked: tuple[int, int] | None) -> arb:
        """Bound of the goal, or of what a body (number, sign) turns in motions worth more than `worth`."""
        goal, pushes, weights = multipliers
        case, ranges = self.case, self.ranges
        parts: dict[int, list[arb]] = {}  # weights of x, y, cos t - 1, sin t, t
        weight = exact(goal) if asked else arb(1)
        need(bool(weight >= 0), "a weight is negative")
        total = -weight * case.worth if asked else arb(0)
        if asked:
            _part(parts, asked[0])[4] += asked[1]
        case.work.spend(EXACT * (len(case.goal) + len(pushes) + len(weights) + 1))
        for body, dx, dy, px, py, spin in case.goal:
            d = weight * exact(dx), weight * exact(dy)
            part = _part(parts, body)
            _add(part, d, less((exact(px), exact(py)), case.origin[body]))
            part[4] += weight * exact(spin)
        by_pair: dict[int, list] = {}
        for which, u in weights:
            need(bool(exact(u) >= 0), "a weight is negative")
            by_pair.setdefault(self.facets[which][0], []).append((which, exact(u)))
        forces = {p: (exact(x), exact(y)) for p, x, y in pushes}
        need(len(forces) == len(pushes), "a pair is named twice")
        for p in sorted({*forces, *by_pair}):
            total += self._pair(p, forces.get(p, (arb(0), arb(0))), by_pair.get(p, []), parts)
        for k, (x, y, c, s, t) in parts.items():
            if case.fixed[k] or all(v == 0 for v in (x, y, c, s, t)):
                continue
            need(ranges.far[k] is not None, "a body counts that nothing holds")
            total += (
                (abs(x) + abs(y)) * exact(ranges.far[k])
                + highest(c, s, t, exact(ranges.low[k]), exact(ranges.high[k]))
                - c
            )
        return total

    def _pair(self, p: int, force: Point, weights: list, parts: dict[int, list[arb]]) -> arb:
        """What a pair adds; what depends on the turns of its bodies goes to their parts."""
        a, b, _, x, y, axes = self.case.pairs[p]
        middle, reach, facets = self._corners(p, [which for which, _ in weights])
        mid = turned((exact(middle[0]), exact(middle[1])), exact(axes))  # the region in the world's axes
        pivot = exact(x), exact(y)
        origin = self.case.origin
        _add(_part(parts, b), (-force[0], -force[1]), less(pivot, origin[b]))
        arm = less(pivot, origin[a])
        _add(_part(parts, a), force, (arm[0] + mid[0], arm[1] + mid[1]))  # R(t_a) (p + mid), without p itself
        total = force[0] * mid[0] + force[1] * mid[1]
        low, high = exact(self.ranges.low[a]), exact(self.ranges.high[a])
        total += size(force) * reach * 2 * (((high - low) / 2).min(arb.pi()) / 2).sin()
        rest = turned(force, -(low + high) / 2 - exact(axes))
        for which, u in weights:
            nx, ny, c = (exact(v) for v in self.facets[which][1:])
            total += u * (exact(facets[which]) - nx * exact(middle[0]) - ny * exact(middle[1]))
            rest = less(rest, (u * nx, u * ny))
            parts[b][4] -= u * c
            parts[a][4] += u * c
        return total + size(rest) * reach

    def _corners(self, p: int, facets: list[int]) -> tuple[np.ndarray, arb, dict[int, float]]:
        """Middle (2,) of what a pair can reach in the ranges, reach from there, and most of facets; all kept."""
        known = self.pairs.get(p)
        new = [k for k in facets if known is None or k not in known[2]]
        if known is not None and not new:
            return known
        a, b, kind, *_ = self.case.pairs[p]
        enclosure = self.case.enclosures[kind]
        self.case.work.spend(enclosure.steps * (2 + len(new)))
        corners = enclosure.between(*self.ranges.pair(a, b))
        need(len(corners) > 0, "a pair is left no turn")
        if known is None:
            middle = (corners[:, :2].min(0) + corners[:, :2].max(0)) / 2
            reach = float(np.hypot(*(corners[:, :2] - middle).T).max()) * (1 + ROUNDED)
            known = self.pairs[p] = middle, exact(reach + ROUNDED * float(np.abs(corners).max())), {}
        for k in new:
            terms = corners * np.array(self.facets[k][1:], dtype=float)
            known[2][k] = float(terms.sum(1).max()) + ROUNDED * float(np.abs(terms).sum(1).max())
        return known


def _part(parts: dict[int, list[arb]], body: int) -> list[arb]:
    """Weights that belong to a body, nought at first."""
    return parts.setdefault(body, [arb(0)] * 5)


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
    radius = (alpha * alpha + beta * beta).sqrt()
    if not radius > 0:
        return best + 2 * radius
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
