"""What regions, pairs and windows say of turns and shifts before any multiplier does: shortest paths to fixed bodies, rounded outwards."""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from wiggleroom.verify.ball_arithmetic import Point, need
from wiggleroom.verify.work_limit import EXACT, WorkLimit

ROUNDED = 1e-12
"""Numbers worked out in double precision are made larger by this share of their terms, a thousand times their error."""


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


@dataclass(frozen=True)
class Bodies:
    """Where the origin of each body is, and whether it stands."""

    origin: list[Point]
    fixed: list[bool]


class Case:
    """Bodies, regions and pairs, what is known of turns between bodies, and the goal, if there is one.

    `known` holds (a, b, low, high): in every motion low <= t_b - t_a <= high. Its first rows belong to the pairs.
    """

    def __init__(
        self,
        bodies: Bodies,
        enclosures: list[Enclosure],
        pairs: list,
        goal: list,
        worth: arb,
        work: WorkLimit,
        doubt: arb | None = None,
    ) -> None:
        self.origin, self.fixed, self.enclosures, self.pairs = bodies.origin, bodies.fixed, enclosures, pairs
        self.goal, self.worth, self.work = goal, worth, work
        self.doubt = arb(0) if doubt is None else doubt
        self.known: list[tuple[int, int, float, float]] = []
        for a, b, kind, *_ in pairs:
            turns = enclosures[kind].angles
            self.known.append((a, b, float(turns[0]), float(turns[-1])))
        self._pairs_of: dict[tuple[int, int], list[int]] = {}
        for p, (a, b, *_) in enumerate(pairs):
            self._pairs_of.setdefault((a, b), []).append(p)

    def learn(self, a: int, b: int, low: float, high: float) -> None:
        """Add what was shown of the turn of b against a, of their pair too if they are one."""
        self.known.append((a, b, low, high))
        for p in self._pairs_of.get((a, b), []):
            self.narrow(p, low, high)
        for p in self._pairs_of.get((b, a), []):
            self.narrow(p, -high, -low)

    def narrow(self, p: int, low: float, high: float) -> None:
        """Keep the turn of a pair between two ends."""
        a, b, least, most = self.known[p]
        self.known[p] = a, b, max(least, low), min(most, high)

    def first(self, low: list, high: list, far: list, names: list[str]) -> None:
        """Refuse first ranges that nothing shows: turns and shifts add up along paths to a fixed body."""
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
        """Length of the shortest path to each body along steps (from, to, length >= 0), from a fixed one or with a `start`; rounded up."""
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
