"""Which bodies can meet: pairs that are too far apart are culled by a tree search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.outline_distances import OutlineDistances
from wiggleroom.geometry.relative_pose import relative_pose

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of bodies that can meet.

    Parameters
    ----------
    a, b : (P,) int64
        Bodies, a < b.
    clearance : (P,) float64 [mm]
        Distance at the poses that were asked about.
    """

    a: Ints
    b: Ints
    clearance: Floats


def ignored_matrix(ignored: Ints, count: int) -> NDArray[np.bool_]:
    """Pairs (n, n) of `count` bodies that never collide, both ways round, from keys a * n + b (k,).

    Examples
    --------
    >>> np.argwhere(ignored_matrix(np.array([5]), 3)).tolist()
    [[1, 2], [2, 1]]
    """
    never = np.zeros((count, count), dtype=np.bool_)
    never[ignored // count, ignored % count] = True
    return never | never.T


def neighbours(
    bodies: Bodies,
    geometry: NDArray[np.object_],
    reach: float,
    *,
    ignored: Ints,
    motion: Floats | None = None,
    stop: Stop | None = None,
) -> Pairs:
    """Pairs of bodies no further apart than `reach`, except fixed with fixed and `ignored` ones; congruent pairs are measured once.

    Parameters
    ----------
    bodies : Bodies
    geometry : (n,) shapely geometries
        Material of the bodies where they are now, from `placed`.
    reach : float [mm]
    ignored : (k,) int64
        Keys a * n + b of pairs to leave out.
    motion : (n, 3) float64 [mm, mm, rad], optional
        Of the bodies, where they are not at rest now.
    stop : optional
        Anything with `is_set()`, asked between distances of outlines of many corners.

    Returns
    -------
    Pairs
        Sorted by (a, b).

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    low_x, low_y, high_x, high_y = shapely.bounds(geometry).T
    around = shapely.box(low_x - reach, low_y - reach, high_x + reach, high_y + reach)
    i, j = shapely.STRtree(geometry).query(around)
    keep = (i < j) & ~(bodies.fixed[i] & bodies.fixed[j]) & ~np.isin(i * len(geometry) + j, ignored)
    i, j = i[keep], j[keep]
    first, label = congruence_classes(bodies, i, j, relative_pose(bodies, i, j, motion))
    apart = np.full(len(first), np.inf)
    one, other = geometry[i[first]], geometry[j[first]]
    shapely.prepare(one)  # in one thread: what is prepared may not be shared
    within = shapely.dwithin(one, other, reach)
    shapely.destroy_prepared(one)
    apart[within] = OutlineDistances(geometry).between(i[first][within], j[first][within], stop)
    near = np.flatnonzero(within[label])
    near = near[np.lexsort((j[near], i[near]))]
    return Pairs(i[near], j[near], apart[label[near]])


def hulls_meet(bodies: Bodies, geometry: NDArray[np.object_], *, ignored: Ints, stop: Stop | None = None) -> Pairs:
    """Pairs of bodies whose convex hulls overlap, except fixed with fixed and `ignored` ones; arguments as for `neighbours`.

    Source: Mind the Gap, section 4.4: the pairs that get collision constraints.
    """
    around = shapely.convex_hull(geometry)
    i, j = shapely.STRtree(around).query(around, predicate="intersects")
    keep = (i < j) & ~(bodies.fixed[i] & bodies.fixed[j]) & ~np.isin(i * len(geometry) + j, ignored)
    i, j = i[keep], j[keep]
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    return Pairs(i, j, OutlineDistances(geometry).between(i, j, stop))
