"""Free spaces against sampled truth: who is accepted though it overlaps, who is refused though it could be reached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from tests.oracle.collision import depths, overlaps
from tests.oracle.random_joints import Pair
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.freespace.free_space import FreeSpace

DEEP = 1e-9  # share of the size that an accepted sample may overlap
LEVER = (
    1.0  # mm per radian that the boundary of a slice moves, for blocks of side 1: their reach round the reference point
)


@dataclass(frozen=True)
class Audit:
    """Counts of samples, spread evenly over the box round all slices."""

    samples: int
    free: int
    unsafe: int
    lost: int


def audit(
    space: FreeSpace, A: shapely.Polygon, B: shapely.Polygon, D: np.ndarray, samples: int, seed: int = 0
) -> Audit:
    """Sample relative motions of B, resting at `D` in A's frame and not turned against it."""
    boxes = shapely.bounds([s.region for s in space.slices])
    low, high = (*boxes[:, :2].min(0), space.angles[0]), (*boxes[:, 2:].max(0), space.angles[1])
    relative = np.random.default_rng(seed).uniform(low, high, (samples, 3))
    accepted = space.contains(relative)
    meet = overlaps(A, B, relative, D)
    doubtful = np.flatnonzero(accepted & meet)
    size = max(np.ptp(shapely.get_coordinates(p), axis=0).max() for p in (A, B))
    unsafe = int((depths(A, B, relative[doubtful], D) > DEEP * size).sum()) if len(doubtful) else 0
    free = ~meet
    free[free] = reachable(space, relative[free])
    return Audit(samples, int(free.sum()), unsafe, int((free & ~accepted).sum()))


def reachable(space: FreeSpace, relative: np.ndarray) -> np.ndarray:
    """Which motions lie in the slice next in angle, widened by half a step: free ones outside are cut off from rest."""
    angles = np.array([s.angle for s in space.slices])
    nearest = np.searchsorted((angles[1:] + angles[:-1]) / 2, relative[:, 2])
    inside = np.zeros(len(relative), dtype=bool)
    step = np.diff(angles).max() / 2
    for k in np.unique(nearest):
        who = np.flatnonzero(nearest == k)
        region = space.slices[k].region
        shapely.prepare(region)
        inside[who] = shapely.dwithin(region, shapely.points(relative[who, :2]), LEVER * step)
    return inside & _in_window(space, relative)


def _in_window(space: FreeSpace, relative: np.ndarray) -> np.ndarray:
    """Whether the pivot stays in the window of an open space."""
    c, s = np.cos(relative[:, 2]), np.sin(relative[:, 2])
    x, y = space.pivot
    moved = relative[:, :2] + np.column_stack([c * x - s * y - x, s * x + c * y - y])
    return np.abs(moved).max(axis=1) <= space.reach


def polygon(part: Part) -> shapely.Polygon:
    """Material of a part of one region in its own frame."""
    (region,) = part.regions
    return shapely.Polygon(region.outer, region.holes)


def part(
    name: str, shape: shapely.Polygon, at: tuple[float, float, float] = (0.0, 0.0, 0.0), fixed: bool = False
) -> Part:
    """Part with this material in its own frame."""
    rings = [
        shapely.get_coordinates(r)[:-1] for r in (lambda p: (p.exterior, *p.interiors))(shapely.orient_polygons(shape))
    ]
    return Part(name, (Region(rings[0], tuple(rings[1:])),), at, fixed)


def as_assembly(pair: Pair) -> Assembly:
    """A random pair as made, "a" and "b"."""
    A, B, D = pair.local()
    return assemble(Drawing((part("a", A, fixed=True), part("b", B, (float(D[0]), float(D[1]), 0.0)))), gap=0.0)
