"""A proven bound: no motion is worth more.

The relaxation is asked for its best value. Then the range of every body's turn is cut to what motions worth more than a little above the
witness can have, which makes the relaxation tighter, again and again, until it leaves no room above, or until the time is up. Where outer
regions hold it up, their intervals of turns are refined.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import shapely
from numpy.typing import NDArray

from wiggleroom.analysis.prepare import Prepared
from wiggleroom.analysis.search import Progress
from wiggleroom.freespace.outer import Outer, holding, outer_region, pivot_of, refined
from wiggleroom.freespace.outer_slices import Facing
from wiggleroom.freespace.relative import turn
from wiggleroom.pairs.neighbours import classes, placed, relative_rest
from wiggleroom.program.objectives import PointMotion
from wiggleroom.program.relax import Linear, Links, NothingLeft, Ranges, first_ranges, narrowed, relaxation
from wiggleroom.solve.bounds import LinearBounds
from wiggleroom.solve.newton import Stop

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR = 3.0
"""The pivot of a pair is found from the edges within so many clearances."""
CUT = 0.6
"""Motions worth more than the witness by this share of what is asked for are looked for; a bound above that is tightened."""
LEAST = 0.01
"""Intervals of turns are refined until they blur by this share of the clearance."""


@dataclass(frozen=True)
class Bound:
    """A value that no motion can exceed.

    Parameters
    ----------
    at_most : float
        [mm], turns in [rad]; infinite where nothing is proven.
    seconds : float
    sweeps : int
        So often all turns were tightened.
    why : str
        Why nothing is proven; empty where something is.
    """

    at_most: float
    seconds: float
    sweeps: int = 0
    why: str = ""


def prove(
    ready: Prepared,
    goal: PointMotion,
    witness: float,
    within: float,
    seconds: float,
    stop: Stop | None,
    tell: Callable[[Progress], None],
) -> Bound:
    """Work out a bound of `goal` no further than the share `within` above `witness`, or the best that the time allows."""
    clock = _Clock(time.perf_counter(), seconds, stop)
    links, regions = outer_regions(ready, clock, tell)
    ranges = first_ranges(ready.bodies, links, regions)
    asked = goal.body[(goal.direction != 0).any(1) | (goal.turn != 0)]
    if not (ready.bodies.fixed[asked] | np.isfinite(ranges.far[asked])).all():
        return Bound(np.inf, clock.spent, 0, "what is pulled is not held by joints that close round it")
    aim = within * max(abs(witness), 1e-3 * ready.clearance)
    cut = witness + CUT * aim
    best, sweeps = np.inf, 0
    while True:
        tell(Progress("prove", sweeps, 0, min(best, 1e300)))
        try:
            linear = relaxation(ready.bodies, links, regions, ranges, goal, ready.clearance, ready.size)
        except NothingLeft:
            best = min(best, cut)
            break
        solver, scale = _asked(linear, clock.left)
        value = solver.most_of(linear.cost)
        before, best = best, min(best, max(value, cut))
        if best <= witness + aim or clock.over:
            break
        sharper = _sharpened(linear, solver.y, links, regions, LEAST * ready.clearance)
        if sharper is not None and not clock.over:
            regions = sharper
            if before - best > 0.05 * (best - witness):
                continue
        solver.change_row(len(linear.low), cut * scale, np.inf)
        ranges, gained = _tightened(linear, solver, ranges, clock)
        sweeps += 1
        if clock.over or (sharper is None and gained < 0.02):
            break
    return Bound(float(best), clock.spent, sweeps, "" if np.isfinite(best) else "no bound was found in the time given")


@dataclass(frozen=True)
class _Clock:
    began: float
    seconds: float
    stop: Stop | None

    @property
    def spent(self) -> float:
        return time.perf_counter() - self.began

    @property
    def left(self) -> float:
        return self.seconds - self.spent

    @property
    def over(self) -> bool:
        return self.left <= 0 or (self.stop is not None and self.stop.is_set())


def outer_regions(ready: Prepared, clock: _Clock, tell: Callable[[Progress], None]) -> tuple[Links, list[Outer]]:
    """Outer regions of all pairs whose joint closes, congruent ones once, and which pair has which."""
    them = ready.bodies
    a, b = ready.cells.a, ready.cells.b
    first, label = classes(them, a, b, relative_rest(them, a, b))
    geometry = placed(them)
    regions: list[Outer] = []
    kind = np.full(len(first), -1, dtype=np.int64)
    pivots = np.zeros((len(first), 2))
    for c, k in enumerate(first):
        if clock.over:
            break
        tell(Progress("outer regions", 0, c, np.nan))
        one, other = geometry[a[k]], geometry[b[k]]
        clearance = float(shapely.distance(one, other))
        pivot, lever = pivot_of(one, other, NEAR * clearance)
        pose = them.rest[a[k]]

        def seen(g: shapely.Geometry, pivot: Floats = pivot, angle: float = -pose[2]) -> shapely.Geometry:
            return shapely.transform(g, lambda p: turn(p - pivot, np.full(len(p), angle)))

        facing = Facing(seen(one), seen(other), clearance)
        region = outer_region(facing, lever, float(them.radius[a[k]] + them.radius[b[k]]))
        if region is not None:
            kind[c], pivots[c] = len(regions), turn((pivot - pose[:2])[None], -pose[2:])[0]
            regions.append(region)
    known = np.flatnonzero(kind[label] >= 0)
    a, b, label = a[known], b[known], label[known]
    axes = them.rest[a, 2]
    arm_a = turn(pivots[label], axes)
    arm_b = them.rest[a, :2] + arm_a - them.rest[b, :2]
    return Links(a, b, kind[label], arm_a, arm_b, axes), regions


def _asked(linear: Linear, limit: float) -> tuple[LinearBounds, float]:
    """The linear program with the goal as its last row, and the factor of that row."""
    scale = 1.0 / max(float(np.abs(linear.cost).max()), 1e-300)
    rows = sp.vstack([linear.rows, sp.csr_matrix(linear.cost * scale)]).tocsr()
    low, high = np.append(linear.low, -np.inf), np.append(linear.high, np.inf)
    return LinearBounds(rows, low, high, linear.least, linear.most, max(limit, 0.1)), scale


def _tightened(linear: Linear, solver: LinearBounds, ranges: Ranges, clock: _Clock) -> tuple[Ranges, float]:
    """Cut every body's turn to what the program leaves it; also the largest share that was cut off."""
    low, high = ranges.low.copy(), ranges.high.copy()
    for body in np.flatnonzero(linear.turn >= 0):
        if clock.over:
            break
        column = linear.turn[body]
        cost = np.zeros(len(linear.cost))
        for sign, end in ((1.0, high), (-1.0, low)):
            cost[column] = sign
            most = solver.most_of(cost) * linear.unit[column]
            end[body] = sign * (most + 1e-12)
    cut = narrowed(ranges, low, high)
    width, was = cut.high - cut.low, ranges.high - ranges.low
    held = linear.turn >= 0
    return cut, float((1 - width[held] / np.maximum(was[held], 1e-300)).max(initial=0.0))


def _sharpened(linear: Linear, y: Floats, links: Links, regions: list[Outer], accuracy: float) -> list[Outer] | None:
    """Regions with narrower intervals where their facets hold the program up; None where there are none left."""
    active = np.flatnonzero(np.abs(y[-len(linear.facet) - 1 : -1]) > 1e-9)
    wanted: dict[int, list[Ints]] = {}
    for p in np.unique(linear.facet[active, 0]):
        which = linear.facet[active[linear.facet[active, 0] == p], 1]
        kind = int(links.kind[p])
        wanted.setdefault(kind, []).append(holding(regions[kind], linear.cut[int(p)], which, accuracy))
    sharper = list(regions)
    for kind, found in wanted.items():
        these = np.unique(np.concatenate(found))
        if len(these):
            sharper[kind] = refined(regions[kind], these)
    return sharper if any(s is not r for s, r in zip(sharper, regions, strict=True)) else None
