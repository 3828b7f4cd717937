"""What ranges of turns leave of every joint: intervals of its own turn, of its first body's and of their mean, and corners of its region.

Regions cut alike are cut once. For that the ends of intervals are moved outwards a little, to a grid.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints, TurnDifferences
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion
from wiggleroom.freespace.outer.outer_facets import FINE_NORMALS, Facets, facets
from wiggleroom.freespace.outer.outer_region import OuterRegion
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TURN_GRID = 512
"""Intervals end at multiples of a region's whole turn divided by this."""
MIN_GRID_STEPS = 16
"""Where an interval is narrower than this many steps, the grid is finer by a power of two."""
GRID_MARGIN = 1e-6
"""Ends of an interval this share of a step from a multiple are moved out to the next one, so that rounding never cuts it."""
FINEST_GRID = 1e-9
"""No grid is finer than this divided by `MIN_GRID_STEPS` [rad]."""
MAX_COUPLED_ANGLE = 1.2
"""Turns of two bodies are coupled where their mean is known this well [rad]."""


class InfeasibleRanges(Exception):  # noqa: N818
    """No motion lies in the given ranges: they leave this pair no turn."""

    def __init__(self, pair: int) -> None:
        super().__init__(pair)
        self.pair = pair


@dataclass(eq=False)
class RegionCuts:
    """Regions, and what was cut out of them; a region may be replaced by a sharper one.

    Parameters
    ----------
    regions : list
    unlike : float [rad]
        Facets whose normals differ by less are one: fewer facets make quicker programs, and the bounds that follow hardly worse.
    """

    regions: list[OuterRegion | CagingSurface | LocalOuterRegion]
    unlike: float = FINE_NORMALS
    known: dict[tuple[float, int, int, int, int], Facets | None] = field(default_factory=dict)

    def cut(self, kind: int, low: float, high: float) -> Facets | None:
        """Facets and corners of a region between two turns; None where nothing is left."""
        region = self.regions[kind]
        least, most = region.turns
        if not least <= low <= high <= most:
            low, high = max(low, least), min(high, most)
        if low > high:
            return None
        whole = TURN_GRID / MIN_GRID_STEPS * max(high - low, FINEST_GRID)
        finer = max(0, int(np.ceil(np.log2((most - least) / whole)))) if most > least else 0
        count = TURN_GRID << finer
        step = (most - least) / count
        ends = (
            max(int(np.floor((low - least) / step - GRID_MARGIN)), 0),
            min(int(np.ceil((high - least) / step + GRID_MARGIN)), count),
        )
        key = (self.unlike, kind, finer, *ends)
        if key not in self.known:
            one = least if ends[0] == 0 else least + ends[0] * step
            other = most if ends[1] == count else least + ends[1] * step
            self.known[key] = facets(region, one, other, self.unlike)
        return self.known[key]

    def replace(self, kind: int, region: OuterRegion) -> None:
        """Put a sharper region in the place of one."""
        self.regions[kind] = region
        self.known = {key: cut for key, cut in self.known.items() if key[1] != kind}


@dataclass(frozen=True, eq=False)
class JointRanges:
    """For every joint (P,): intervals, and its region in the world's axes at rest.

    Parameters
    ----------
    turn, half_turn : (P,) float64 [rad]
        Middle and half width of the first body's turn.
    mean, half_mean : (P,) float64 [rad]
        The same of the mean of both bodies' turns.
    low, high : (P,) float64 [rad]
        Of the second body's turn against the first.
    middle, half : (P, 2) float64 [mm]
        Box that holds tau.
    reach : (P,) float64 [mm]
        Largest length of tau less `middle`.
    bend, blur : (P,) float64 [mm]
        A force errs by at most its length times bend, where products of turn and tau are kept, else times blur.
    chord, sag, skew : (P,) float64
        2 cos v sin(phi/2) differs from chord * phi by at most sag [rad], 2 sin v sin(phi/2) from v * phi by at most skew.
    coupled : (P,) bool
        Whether the last three say anything.
    cuts : tuple of Facets
        In the axes of the first body.
    corner : tuple of (c, 3) float64
        Corners in the world's axes, less `middle`.
    """

    turn: Floats
    half_turn: Floats
    mean: Floats
    half_mean: Floats
    low: Floats
    high: Floats
    middle: Floats
    half: Floats
    reach: Floats
    bend: Floats
    blur: Floats
    chord: Floats
    sag: Floats
    skew: Floats
    coupled: NDArray[np.bool_]
    cuts: tuple[Facets, ...]
    corner: tuple[Floats, ...]

    def some(self, which: Ints) -> JointRanges:
        """Of some of the joints."""
        every: dict[str, Any] = {f.name: getattr(self, f.name) for f in fields(self)}
        arrays = {k: v[which] for k, v in every.items() if isinstance(v, np.ndarray)}
        return JointRanges(
            **arrays, cuts=tuple(self.cuts[p] for p in which), corner=tuple(self.corner[p] for p in which)
        )


def joint_ranges(
    joints: JointConstraints, regions: RegionCuts, ranges: AngleRanges, turns: TurnDifferences
) -> JointRanges:
    """Work out what some ranges leave of every joint.

    Raises
    ------
    InfeasibleRanges
        If they leave a pair no turn at all.
    """
    a, b, count = joints.a, joints.b, len(joints.a)
    low = np.maximum(ranges.low[b] - ranges.high[a], turns.low[:count])
    high = np.minimum(ranges.high[b] - ranges.low[a], turns.high[:count])
    cuts: list[Facets] = []
    for p, (kind, one, two) in enumerate(zip(joints.kind.tolist(), low.tolist(), high.tolist(), strict=True)):
        found = regions.cut(kind, one, two)
        if found is None:
            raise InfeasibleRanges(p)
        cuts.append(found)
    corners = [
        np.column_stack([rotated(cut.corner[:, :2], float(angle)), cut.corner[:, 2]])
        for cut, angle in zip(cuts, joints.axes, strict=True)
    ]
    margin = np.array([cut.margin for cut in cuts])
    box = np.array([(c[:, :2].min(0), c[:, :2].max(0)) for c in corners]).reshape(-1, 2, 2)
    middle, half = box.mean(1), (box[:, 1] - box[:, 0]) / 2 + margin[:, None]
    corners = [c - np.append(m, 0.0) for c, m in zip(corners, middle, strict=True)]
    reach = np.array([np.hypot(*c[:, :2].T).max() for c in corners]) + margin
    low, high = np.array([cut.low for cut in cuts]), np.array([cut.high for cut in cuts])
    one, two = ranges.low, ranges.high
    own, half_turn = (one[a] + two[a]) / 2, (two[a] - one[a]) / 2 * (1 + 1e-12) + 1e-15
    mean = (one[a] + two[a] + one[b] + two[b]) / 4
    half_mean = (two[a] - one[a] + two[b] - one[b]) / 4 * (1 + 1e-12) + 1e-15
    most = np.maximum(np.abs(low), np.abs(high))
    coupled = (half_mean < MAX_COUPLED_ANGLE) & (most < 1.0)
    h, f = np.minimum(half_mean, MAX_COUPLED_ANGLE), np.minimum(most, 1.0)
    least = np.cos(h) * np.sinc(f / 2 / np.pi)
    v = np.minimum(half_turn, np.pi)
    return JointRanges(
        own,
        half_turn,
        mean,
        half_mean,
        low,
        high,
        middle,
        half,
        reach * (1 + 1e-12),
        reach * (v**2 / 2 + v**3 / 6) * (1 + 1e-12),
        reach * 2 * np.sin(v / 2) * (1 + 1e-12),
        (1 + least) / 2,
        (1 - least) / 2 * most * (1 + 1e-12) + 1e-15,
        h * most * (h * h / 6 + most**2 / 24) * (1 + 1e-12) + 1e-15,
        coupled,
        tuple(cuts),
        tuple(corners),
    )
