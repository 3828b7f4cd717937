"""Outer regions of all pairs that hold each other, congruent ones worked out once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import JointConstraints
from wiggleroom.freespace.outer.caging_surface import CagingSurface, caging_surface
from wiggleroom.freespace.outer.outer_region import OuterRegion, outer_region, pivot_of, reached_slices
from wiggleroom.freespace.outer.outer_slices import PairMaterial
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.neighbours import classes, relative_pose
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WORKERS = 2
"""So many regions are worked out at once."""
PIVOT_REACH = 3.0
"""The pivot of a pair is found from the edges within so many clearances."""


def outer_regions(
    ground: Survey, over: Callable[[], bool], certify: bool = False
) -> tuple[JointConstraints, list[OuterRegion | CagingSurface]]:
    """Outer regions of the pairs whose joint closes, and which pair has which; fewer where it is `over` before all are done.

    With `certify` they are caging surfaces, which a certificate can show.
    """
    them, a, b = ground.bodies, ground.near.a, ground.near.b
    first, label = classes(them, a, b, relative_pose(them, a, b))

    def region(k: int) -> tuple[OuterRegion | CagingSurface | None, Floats]:
        if over():
            return None, np.zeros(2)
        return _region(ground, int(a[k]), int(b[k]), float(ground.near.clearance[k]), over, certify)

    with ThreadPoolExecutor(WORKERS) as pool:
        made = list(pool.map(region, first.tolist()))
    kind = np.cumsum([found is not None for found, _ in made]) - 1
    kind[[found is None for found, _ in made]] = -1
    pivots = np.array([pivot for _, pivot in made]).reshape(-1, 2)
    known = np.flatnonzero(kind[label] >= 0)
    label = label[known]
    regions = [found for found, _ in made if found is not None]
    return links_about(them, a[known], b[known], kind[label], pivots[label]), regions


def links_about(them: Bodies, a: Ints, b: Ints, kind: Ints, pivots: Floats) -> JointConstraints:
    """Links of pairs (P,) that have a region each, about pivots (P, 2) [mm] in the frames of their first bodies."""
    axes = them.rest[a, 2]
    arm = turn(pivots, axes)
    return JointConstraints(a, b, kind, arm, them.rest[a, :2] + arm - them.rest[b, :2], axes)


def material_of(
    them: Bodies, geometry: NDArray[np.object_], a: int, b: int, clearance: float
) -> tuple[PairMaterial, Floats, float]:
    """Two bodies about the pivot of their joint, the pivot in the frame of body `a`, and its lever [mm]; `geometry` (n,) lies at rest."""
    pivot, lever = pivot_of(geometry[a], geometry[b], PIVOT_REACH * clearance)
    x, y, angle = them.rest[a]

    def seen(shape: shapely.Geometry) -> shapely.Geometry:
        return shapely.transform(shape, lambda p: turn(p - pivot, np.full(len(p), -angle)))

    material = PairMaterial(seen(geometry[a]), seen(geometry[b]), clearance)
    return material, turn((pivot - (x, y))[None], np.array([-angle]))[0], lever


def _region(
    ground: Survey, a: int, b: int, clearance: float, over: Callable[[], bool], certify: bool
) -> tuple[OuterRegion | CagingSurface | None, Floats]:
    """Region of one pair, None where the joint is open or it was `over` first, and its pivot in the frame of body `a`."""
    them = ground.bodies
    material, pivot, lever = material_of(them, ground.geometry, a, b, clearance)
    limit = float(them.radius[a] + them.radius[b])
    if not certify:
        return outer_region(material, lever, limit, over), pivot
    slices = reached_slices(material, lever, limit, over)
    return (None if slices is None else caging_surface(material, slices, over)), pivot
