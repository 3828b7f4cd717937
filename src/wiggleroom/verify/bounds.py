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

import functools
from typing import Any

import numpy as np
from flint import arb

from wiggleroom.verify.skins import Point, exact, less, need, size, turned

ROUNDED = 1e-12
"""Largest values over corners are found in double precision and made larger by this share of their terms, a thousand times their error."""


class Room:
    """Corners of one region; what they are between two turns."""

    def __init__(self, region: dict[str, Any]) -> None:
        self.angles = [float(angle) for angle, _ in region["loops"]]
        self.loops = [np.array(at, dtype=float).reshape(-1, 2) for _, at in region["loops"]]
        self.tracks = [np.array(tracks, dtype=int) for tracks, _ in region["seams"]]
        self.far = max(float(np.hypot(*at.T).max()) for at in self.loops) * (1 + ROUNDED)
        self.between = functools.cache(self._between)  # one range of turns is asked for again and again

    def _between(self, low: float, high: float) -> np.ndarray:
        """Corners (k, 3) of all that the skin encloses between two turns: corners of loops, and tracks where they are cut."""
        found = [
            np.column_stack([at, np.full(len(at), t)])
            for t, at in zip(self.angles, self.loops, strict=True)
            if low <= t <= high
        ]
        for level in (low, high):
            for k, tracks in enumerate(self.tracks):
                one, two = self.angles[k], self.angles[k + 1]
                if one <= level <= two:
                    share = (level - one) / (two - one)
                    at = (1 - share) * self.loops[k][tracks[:, 0]] + share * self.loops[k + 1][tracks[:, 1]]
                    found.append(np.column_stack([at, np.full(len(at), level)]))
        return np.vstack(found) if found else np.zeros((0, 3))


class Ranges:
    """Turns and shifts of all bodies, None where nothing is known."""

    def __init__(self, low: list, high: list, far: list) -> None:
        self.low, self.high, self.far = low, high, far

    def cut(self, low: list, high: list) -> Ranges:
        """The same with other turns."""
        return Ranges(low, high, self.far)

    def pair(self, a: int, b: int) -> tuple[float, float]:
        """Turns of b against a, rounded outwards."""
        need(None not in (self.low[a], self.low[b]), "a pair is used that nothing holds")
        low, high = self.low[b] - self.high[a], self.high[b] - self.low[a]
        return float(np.nextafter(low, -np.inf)), float(np.nextafter(high, np.inf))


class Case:
    """Regions, pairs and goal of a certificate, to ask what multipliers prove."""

    def __init__(self, content: dict[str, Any]) -> None:
        self.bodies = content["bodies"]
        self.fixed = [body["fixed"] for body in self.bodies]
        self.origin = [tuple(exact(v) for v in body["origin"]) for body in self.bodies]
        self.rooms = [Room(region) for region in content["regions"]]
        self.pairs = content["pairs"]
        self.goal = content["goal"]
        self.worth = exact(content["worth"])

    def first(self) -> Ranges:
        """Ranges of the file, once it is sure that they hold: turns and shifts add up along ways to a fixed body."""
        count = len(self.bodies)
        nothing = [0.0 if f else np.inf for f in self.fixed]
        up, down, far = list(nothing), list(nothing), list(nothing)
        for _ in range(count):
            for a, b, kind, x, y, _ in self.pairs:
                room = self.rooms[kind]
                low, high = room.angles[0], room.angles[-1]
                up[b], down[b] = min(up[b], up[a] + high), min(down[b], down[a] - low)
                up[a], down[a] = min(up[a], up[b] - low), min(down[a], down[b] + high)
                arms = [np.hypot(x - float(o[0]), y - float(o[1])) for o in (self.origin[a], self.origin[b])]
                swing = sum(
                    arm * 2 * np.sin(min(max(up[k], down[k]), np.pi) / 2) for arm, k in zip(arms, (a, b), strict=True)
                )
                step = room.far + swing
                far[a], far[b] = min(far[a], far[b] + step), min(far[b], far[a] + step)
        for k, body in enumerate(self.bodies):
            if body["low"] is not None:
                fits = -body["low"] >= down[k] * (1 + ROUNDED) and body["high"] >= up[k] * (1 + ROUNDED)
                need(
                    fits and body["far"] >= far[k] * (1 + ROUNDED),
                    f"nothing shows that {body['parts'][0]} stays within its first range",
                )
        return Ranges(*([body[k] for body in self.bodies] for k in ("low", "high", "far")))

    def most(self, ranges: Ranges, facets: list, multipliers: list, asked: tuple[int, int] | None) -> arb:
        """Bound of the goal, or of what a body (number, sign) turns in motions worth more than `worth`."""
        goal, pushes, weights = multipliers
        parts = [[arb(0)] * 5 for _ in self.bodies]  # weights of x, y, cos t - 1, sin t, t
        weight = exact(goal) if asked else arb(1)
        need(bool(weight >= 0), "a weight is negative")
        total = -weight * self.worth if asked else arb(0)
        if asked:
            parts[asked[0]][4] += asked[1]
        for body, dx, dy, px, py, spin in self.goal:
            d = weight * exact(dx), weight * exact(dy)
            _add(parts[body], d, less((exact(px), exact(py)), self.origin[body]))
            parts[body][4] += weight * exact(spin)
        by_pair: dict[int, list] = {}
        for which, u in weights:
            need(bool(exact(u) >= 0), "a weight is negative")
            by_pair.setdefault(facets[which][0], []).append((facets[which][1:], exact(u)))
        forces = {p: (exact(x), exact(y)) for p, x, y in pushes}
        need(len(forces) == len(pushes), "a pair is named twice")
        for p in sorted({*forces, *by_pair}):
            total += self._pair(p, ranges, forces.get(p, (arb(0), arb(0))), by_pair.get(p, []), parts)
        for k, (x, y, c, s, t) in enumerate(parts):
            if self.fixed[k] or all(v == 0 for v in (x, y, c, s, t)):
                continue
            need(ranges.far[k] is not None, "a body counts that nothing holds")
            total += (
                (abs(x) + abs(y)) * exact(ranges.far[k])
                + highest(c, s, t, exact(ranges.low[k]), exact(ranges.high[k]))
                - c
            )
        return total

    def _pair(self, p: int, ranges: Ranges, force: Point, facets: list, parts: list) -> arb:
        """What a pair adds; what depends on the turns of its bodies goes to their parts."""
        a, b, kind, x, y, axes = self.pairs[p]
        corners = self.rooms[kind].between(*ranges.pair(a, b))
        need(len(corners) > 0, "a pair is left no turn")
        middle = (corners[:, :2].min(0) + corners[:, :2].max(0)) / 2
        reach = exact(
            float(np.hypot(*(corners[:, :2] - middle).T).max()) * (1 + ROUNDED) + ROUNDED * float(np.abs(corners).max())
        )
        mid = turned((exact(middle[0]), exact(middle[1])), exact(axes))  # the region in the world's axes
        pivot = exact(x), exact(y)
        _add(parts[b], (-force[0], -force[1]), less(pivot, self.origin[b]))
        arm = less(pivot, self.origin[a])
        _add(parts[a], force, (arm[0] + mid[0], arm[1] + mid[1]))  # R(t_a) (p + mid), without p itself
        total = force[0] * mid[0] + force[1] * mid[1]
        low, high = exact(ranges.low[a]), exact(ranges.high[a])
        total += size(force) * reach * 2 * (((high - low) / 2).min(arb.pi()) / 2).sin()
        rest = turned(force, -(low + high) / 2 - exact(axes))
        for (nx, ny, c), u in facets:
            terms = corners * (nx, ny, c)
            most = float(terms.sum(1).max()) + ROUNDED * float(np.abs(terms).sum(1).max())
            normal = exact(nx), exact(ny)
            total += u * (exact(most) - normal[0] * exact(middle[0]) - normal[1] * exact(middle[1]))
            rest = less(rest, (u * normal[0], u * normal[1]))
            parts[b][4] -= u * exact(c)
            parts[a][4] += u * exact(c)
        return total + size(rest) * reach


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
    turns = int((float(low) - float(top)) / 6.28) - 2
    while bool(top + 2 * arb.pi() * turns < high) or turns < 0:
        t = top + 2 * arb.pi() * turns
        if not (t < low or t > high):
            best = best.max(value(t))
        turns += 1
    return best
