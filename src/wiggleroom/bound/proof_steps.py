"""What a proof consists of: linear programs with the multipliers that prove what they say, cuts of turns, splits, windows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges
from wiggleroom.bound.joint_ranges import JointRanges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MULTIPLIER_BITS = 32
"""Multipliers are whole multiples of their largest divided by two to this power."""


def rounded(multipliers: Floats) -> Floats:
    """Multipliers (K, P, 8) with fewer digits, for every program (K) multiples of one power of two."""
    unit = multiplier_units(multipliers)[:, None, None]
    return np.asarray(np.round(multipliers / unit) * unit)


def multiplier_units(multipliers: Floats) -> Floats:
    """The power of two (K,) whose multiples the multipliers of each program are."""
    most = np.abs(multipliers).max((1, 2), initial=0.0)
    return np.asarray(2.0 ** (np.ceil(np.log2(np.maximum(most, 1e-250))) - MULTIPLIER_BITS))


@dataclass(frozen=True, eq=False)
class TurnCuts:
    """Turns of bodies that are at most `end` (sign 1) or at least `end` (sign -1), and multipliers that prove it.

    Parameters
    ----------
    body, sign : (K,) int64
    end : (K,) float64 [rad]
    goal : (K,) float64
        Weight of "worth at least the cutoff".
    joints : tuple of K arrays (k,) int64
    multipliers : tuple of K arrays (k, 8) float64
        Of these joints. All others have none, or `goal` times those of `base`.
    base : (P, 8) float64, optional
    """

    body: Ints
    sign: Ints
    end: Floats
    goal: Floats
    joints: tuple[Ints, ...]
    multipliers: tuple[Floats, ...]
    base: Floats | None = None

    def record(self) -> list[list[Any]]:
        """The same for a file."""
        every = zip(self.body, self.sign, self.end, self.goal, self.joints, self.multipliers, strict=True)
        return [[int(b), int(s), float(e), _multipliers(float(g), p, m)] for b, s, e, g, p, m in every]


@dataclass(eq=False)
class ProofNode:
    """One step: ranges in which programs are asked, the bound that one gave, the turns others cut, and what came after."""

    low: Floats | None = None
    high: Floats | None = None
    turns: Floats | None = None
    best: Floats | None = None
    value: float = np.inf
    cuts: TurnCuts | None = None
    split: tuple[int, float] | None = None
    empty: int | None = None
    nothing_left: bool = False
    depth: int = 0
    then: list[ProofNode] = field(default_factory=list)

    def follow(self) -> ProofNode:
        """A next step."""
        self.then.append(ProofNode(depth=self.depth + 1))
        return self.then[-1]

    def at(self, ranges: AngleRanges, joints: JointRanges | None) -> None:
        """Keep in which ranges it asks."""
        self.low, self.high = ranges.low, ranges.high
        self.turns = None if joints is None else np.column_stack([joints.low, joints.high])

    def bound(self) -> float:
        """What follows for the goal."""
        if self.empty is not None or self.nothing_left:
            return -np.inf
        if self.best is None:
            return np.inf
        return min(self.value, max((step.bound() for step in self.then), default=np.inf))

    def record(self) -> dict[str, Any]:
        """The same for a file: either what bounds the goal here, or the cuts and what followed."""
        out: dict[str, Any] = {"low": _numbers(self.low), "high": _numbers(self.high)}
        if self.empty is not None:
            return out | {"empty": self.empty}
        out["turns"] = [] if self.turns is None else self.turns.tolist()
        if not self.nothing_left and self.bound() == self.value and self.best is not None:
            return out | {"best": _multipliers(0.0, *_some(self.best))}
        if self.cuts is not None and self.cuts.base is not None:
            out["base"] = _multipliers(0.0, *_some(self.cuts.base))
        out["cuts"] = [] if self.cuts is None else self.cuts.record()
        if not self.nothing_left:
            out["then"] = [step.record() for step in self.then]
        if self.split is not None:
            out["split"] = list(self.split)
        return out


def _numbers(values: Floats | None) -> list[float | None]:
    return [] if values is None else [v if np.isfinite(v) else None for v in values.tolist()]


def _some(multipliers: Floats) -> tuple[Ints, Floats]:
    """The joints that have multipliers (P, 8), and these."""
    used = np.flatnonzero(multipliers.any(1))
    return used, multipliers[used]


def _multipliers(goal: float, joints: Ints, multipliers: Floats) -> list[Any]:
    """[unit, weight of the goal, [[joint, eight whole numbers], ..]]."""
    unit = float(multiplier_units(multipliers[None])[0])
    whole = np.round(multipliers / unit).astype(np.int64)
    return [unit, goal, np.column_stack([joints, whole]).tolist()]
