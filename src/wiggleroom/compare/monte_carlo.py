"""A free space against sampled truth: random relative motions, each judged by general polygon geometry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.errors import InputError
from wiggleroom.freespace.free_space import FreeSlices, FreeSpace
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]

BATCH_SIZE = 2000
"""Samples whose polygons are in memory at a time."""


@dataclass(frozen=True)
class SampledAccuracy:
    """Counts of samples, spread evenly over the box round all slices.

    Parameters
    ----------
    samples : int
    free : int
        Truly free and reached from rest.
    accepted : int
        Said to be free by the model.
    unsafe : int
        Accepted although the parts overlap by more than 1e-9 of the drawing's size.
    lost : int
        Free, but not accepted.
    """

    samples: int
    free: int
    accepted: int
    unsafe: int
    lost: int


def sampled_accuracy(space: FreeSpace, assembly: Assembly, samples: int, *, seed: int = 0) -> SampledAccuracy:
    """Judge random relative motions by polygon intersection and by the model, and compare.

    Parameters
    ----------
    space : FreeSpace
        Of two parts of this assembly.
    samples : int
        At least 1.
    seed : int
        The same seed gives the same samples.

    Raises
    ------
    InputError
        If there are no samples.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> chain = wr.patterns.chain(2, joint="tee", gap=0.01)
    >>> sampled_accuracy(wr.free_space(chain, "b1", "b2"), chain, 500).unsafe
    0
    """
    if samples < 1:
        finding = f"samples {samples}: there must be at least 1"
        raise InputError(finding)
    boxes = shapely.bounds([s.region for s in space.slices])
    low, high = (*boxes[:, :2].min(0), space.angles[0]), (*boxes[:, 2:].max(0), space.angles[1])
    relative = np.random.default_rng(seed).uniform(low, high, (samples, 3))
    accepted = space.contains(relative)
    them = bodies(assembly)
    depth = depths(space, assembly, them, relative)
    row = them.body_of[assembly.names.index(space.parts[1])]
    free = (depth == 0) & reached(space, relative, float(them.radius[row]))
    unsafe = accepted & (depth > OVERLAP_TOLERANCE * assembly.size)
    return SampledAccuracy(
        samples, int(free.sum()), int(accepted.sum()), int(unsafe.sum()), int((free & ~accepted).sum())
    )


def depths(space: FreeSpace, assembly: Assembly, them: Bodies, relative: Floats) -> Floats:
    """How deep the parts overlap (k,) [mm] in each relative motion (k, 3): half to the whole of the width of what they share."""
    rows = [assembly.names.index(name) for name in space.parts]
    a, b = placed(them)[them.body_of[rows]]
    shapely.prepare(a)
    at_a, at_b = assembly.rest[rows[0]], assembly.rest[rows[1], :2]
    corners, depth = shapely.get_coordinates(b), np.zeros(len(relative))
    for first in range(0, len(relative), BATCH_SIZE):
        some = relative[first : first + BATCH_SIZE]
        n, m = len(some), len(corners)
        shift = rotated(some[:, :2], np.full(n, at_a[2]))
        moved = rotated(np.tile(corners - at_b, (n, 1)), np.repeat(some[:, 2], m)) + np.repeat(shift, m, axis=0) + at_b
        placed_b = shapely.set_coordinates(np.full(n, b), moved)
        hit = np.flatnonzero(shapely.intersects(a, placed_b))
        common = shapely.intersection(a, placed_b[hit])
        around = shapely.length(common)
        depth[first + hit] = np.divide(
            2 * shapely.area(common), around, out=np.zeros(len(hit)), where=(around > 0) & (shapely.area(common) > 0)
        )
    return depth


def reached(space: FreeSpace, relative: Floats, radius: float) -> NDArray[np.bool_]:
    """Which relative motions (k, 3) lie in the slice next in angle; free ones outside are cut off from rest.

    Slices are widened by what their rims may move in half a step, with contacts at most `radius` [mm] from the pivot.
    """
    angles = np.array([s.angle for s in space.slices])
    nearest = np.abs(relative[:, 2, None] - angles).argmin(axis=1)
    half = (space.angles[1] - space.angles[0]) / len(angles) / 2
    moved = relative[:, :2] + swing(space, relative[:, 2])
    regions = about_pivot(space)
    inside = np.zeros(len(relative), dtype=bool)
    for k in np.unique(nearest):
        who = np.flatnonzero(nearest == k)
        shapely.prepare(regions[k])
        inside[who] = shapely.dwithin(regions[k], shapely.points(moved[who]), half * radius)
    return inside & (np.abs(moved).max(axis=1) <= space.reach)


def swing(space: FreeSlices, phi: Floats) -> Floats:
    """How far the pivot moves (k, 2) [mm] when b turns about its reference point by `phi` (k,) [rad]."""
    return rotated(np.tile(space.pivot, (len(phi), 1)), phi) - space.pivot


def about_pivot(space: FreeSlices) -> list[shapely.Geometry]:
    """Slices as motions of the pivot, which lies in the joint, so that they stand above each other."""
    shift = swing(space, np.array([s.angle for s in space.slices]))
    return [shapely.transform(s.region, lambda p, d=d: p + d) for s, d in zip(space.slices, shift, strict=True)]
