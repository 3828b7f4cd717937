"""What a proof did, step by step, as a certificate keeps it: cuts of turns, splits, and the multipliers that show them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.linear_relaxation import AngleRanges, LinearRelaxation

Floats = NDArray[np.float64]


@dataclass(eq=False)
class ProofNode:
    """One linear program: the bound that it gave, the turns it cut, and what came after.

    Multipliers are [goal, [[pair, x, y], ..], [[facet, multiplier], ..]]: the weight of "worth at least the cut", the force with which each
    pair of a loop is held together, and facets by their place in `facets`.
    """

    facets: list[list[float]] = field(default_factory=list)
    best: list[Any] | None = None
    value: float = np.inf
    cuts: list[list[Any]] = field(default_factory=list)
    split: tuple[int, float] | None = None
    empty: int | None = None
    nothing_left: bool = False
    depth: int = 0
    then: list[ProofNode] = field(default_factory=list)
    place: dict[int, int] = field(default_factory=dict)

    def follow(self) -> ProofNode:
        """A next step."""
        self.then.append(ProofNode(depth=self.depth + 1))
        return self.then[-1]

    def ask(self, linear: LinearRelaxation, y: Floats, value: float) -> None:
        """Keep what shows that the goal is at most `value`."""
        self.best, self.value = [0.0, *self._multipliers(linear, y[: len(linear.low)])], value

    def cut(
        self, linear: LinearRelaxation, y: Floats, scale: float, body: int, sign: float, end: float, ranges: AngleRanges
    ) -> None:
        """Keep what shows that a body turns no further than `end`, where that is news."""
        before = ranges.high[body] if sign > 0 else ranges.low[body]
        if sign * (before - end) > 0:
            unit = float(linear.unit[linear.turn[body]])
            goal = max(-float(y[-1]), 0.0) * scale * unit
            self.cuts.append([body, int(sign), end, [goal, *self._multipliers(linear, y[:-1] * unit)]])

    def _multipliers(self, linear: LinearRelaxation, y: Floats) -> list[list[Any]]:
        raw = y * linear.scale
        pairs = np.unique(linear.facet[:, 0])
        k, r = len(pairs), len(linear.facet)
        force = np.column_stack([raw[-r - 2 * k : -r - k], raw[-r - k : -r]])
        rows = np.flatnonzero(raw[-r:] > 0)
        for row in rows.tolist():
            if row not in self.place:
                p, number = linear.facet[row].tolist()
                self.place[row] = len(self.facets)
                self.facets.append([p, *linear.cut[p].normal[number].tolist()])
        used = np.flatnonzero((force != 0).any(1))
        pushes = [[int(pairs[u]), *force[u].tolist()] for u in used]
        return [pushes, [[self.place[int(row)], float(raw[-r:][row])] for row in rows]]

    def bound(self) -> float:
        """What follows for the goal."""
        if self.empty is not None or self.nothing_left:
            return -np.inf
        if self.best is None:
            return np.inf
        return min(self.value, max((step.bound() for step in self.then), default=np.inf))

    def record(self) -> dict[str, Any]:
        """The same for a file: either what bounds the goal here, or the cuts and what followed."""
        if self.empty is not None:
            return {"empty": self.empty}
        if not self.nothing_left and self.bound() == self.value:
            return {"facets": self.facets, "best": self.best}
        out: dict[str, Any] = {"facets": self.facets, "cuts": self.cuts}
        if not self.nothing_left:
            out["then"] = [step.record() for step in self.then]
        if self.split is not None:
            out["split"] = list(self.split)
        return out
