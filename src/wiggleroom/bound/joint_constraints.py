"""Joints whose relative motion is bounded, and what follows for turns: difference constraints and shortest paths.

Every joint keeps the turn of its second body against its first within an interval. So do other pairs of bodies that a local
window has shown more about. Turns add up along paths between bodies: these are difference constraints, and what follows from
them is found by shortest paths.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

RANGE_FACTOR = 1 + 1e-4
"""First ranges are wider by this factor, so that facets are active and not the ranges."""
ROUNDING_MARGIN = 1e-12
"""Sums of turns are wider by this [rad], far above their rounding."""


class BoundedRegion(Protocol):
    """All that one body of a pair can reach, seen from the other, and some more."""

    @property
    def turns(self) -> tuple[float, float]:
        """Least and largest turn [rad]."""

    @property
    def far(self) -> float:
        """Largest motion of the pivot [mm]."""


@dataclass(frozen=True, eq=False)
class JointConstraints:
    """Pairs of bodies whose relative motion is bounded.

    Parameters
    ----------
    a, b : (P,) int64
    kind : (P,) int64
        Which outer region.
    arm_a, arm_b : (P, 2) float64 [mm]
        From each body's origin to the pivot, at rest, in the world's axes.
    axes : (P,) float64 [rad]
        Angle of A's axes at rest.
    """

    a: Ints
    b: Ints
    kind: Ints
    arm_a: Floats
    arm_b: Floats
    axes: Floats

    def some(self, which: Ints | Bools) -> JointConstraints:
        """Some of the pairs."""
        return JointConstraints(
            self.a[which], self.b[which], self.kind[which], self.arm_a[which], self.arm_b[which], self.axes[which]
        )


@dataclass(frozen=True, eq=False)
class TurnDifferences:
    """low <= turn of b - turn of a <= high, for the pairs of some joints first and then for other pairs of bodies.

    Parameters
    ----------
    a, b : (D,) int64
    low, high : (D,) float64 [rad]
    """

    a: Ints
    b: Ints
    low: Floats
    high: Floats


@dataclass(frozen=True, eq=False)
class AngleRanges:
    """Where bodies can be; infinite where nothing is known.

    Parameters
    ----------
    low, high : (n,) float64 [rad]
        Least and greatest turn.
    far : (n,) float64 [mm]
        Largest shift of the origin.
    """

    low: Floats
    high: Floats
    far: Floats


def turn_differences(joints: JointConstraints, regions: Sequence[BoundedRegion]) -> TurnDifferences:
    """What the regions of joints say of turns."""
    turns = np.array([regions[k].turns for k in joints.kind]).reshape(-1, 2)
    return TurnDifferences(joints.a, joints.b, turns[:, 0], turns[:, 1])


def first_ranges(
    fixed: Bools,
    joints: JointConstraints,
    regions: Sequence[BoundedRegion],
    turns: TurnDifferences | None = None,
    deviation: float = 0.0,
) -> AngleRanges:
    """Turns and shifts add up along paths to fixed bodies; the shortest path counts. Equations of joints hold up to `deviation` [mm]."""
    turns = turn_differences(joints, regions) if turns is None else turns
    up = shortest_paths(turns.a, turns.b, turns.high, -turns.low, fixed)
    down = shortest_paths(turns.a, turns.b, -turns.low, turns.high, fixed)
    swing = 2 * np.sin(np.minimum(np.maximum(up, down), np.pi) / 2)
    far = np.array([regions[k].far for k in joints.kind]) + deviation
    with np.errstate(invalid="ignore"):
        step = far + np.hypot(*joints.arm_a.T) * swing[joints.a] + np.hypot(*joints.arm_b.T) * swing[joints.b]
    shift = shortest_paths(joints.a, joints.b, step, step, fixed)
    return AngleRanges(-down * RANGE_FACTOR, up * RANGE_FACTOR, shift * RANGE_FACTOR)


def shortest_paths(a: Ints, b: Ints, forth: Floats, back: Floats, root: Bools) -> Floats:
    """Shortest paths (n,) from the roots where edge k costs forth[k] from a to b and back[k] the other way."""
    source, target = np.concatenate([a, b]), np.concatenate([b, a])
    length = np.concatenate([forth, back])
    distance = np.where(root, 0.0, np.inf)
    for _ in range(len(root)):
        shorter = distance.copy()
        np.minimum.at(shorter, target, distance[source] + length)
        if not (shorter < distance - ROUNDING_MARGIN).any():
            break
        distance = shorter
    return distance


def _excess(larger: Floats, smaller: Floats) -> Floats:
    """How far numbers lie above others, zero where they do not; infinite numbers that are equal do not."""
    return np.subtract(larger, smaller, out=np.zeros(len(larger)), where=larger > smaller)


def propagated(ranges: AngleRanges, turns: TurnDifferences) -> AngleRanges:
    """The same ranges, narrower where turns against other bodies say so."""
    low, high = ranges.low.copy(), ranges.high.copy()
    a, b = turns.a, turns.b
    for _ in range(len(low)):
        before = low.copy(), high.copy()
        np.minimum.at(high, b, before[1][a] + turns.high + ROUNDING_MARGIN)
        np.minimum.at(high, a, before[1][b] - turns.low + ROUNDING_MARGIN)
        np.maximum.at(low, b, before[0][a] + turns.low - ROUNDING_MARGIN)
        np.maximum.at(low, a, before[0][b] - turns.high - ROUNDING_MARGIN)
        gained = np.maximum(_excess(before[1], high), _excess(low, before[0]))  # turns without end stay out
        if (low > high).any() or not (gained > 10 * ROUNDING_MARGIN).any():
            break
    return replace(ranges, low=low, high=high)


def narrowed(ranges: AngleRanges, low: Floats, high: Floats) -> AngleRanges:
    """The same ranges with turns cut to the given ones."""
    return replace(ranges, low=np.maximum(ranges.low, low), high=np.minimum(ranges.high, high))
