"""Hulls of many pairs at once; congruent pairs are worked out once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.models.halfspaces import Halfspaces, seen_point, spread
from wiggleroom.freespace.models.hull import PairHull, pair_hull
from wiggleroom.freespace.models.pair_models import Hull
from wiggleroom.freespace.slices import pair_outlines
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose, rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Hulls:
    """Hulls of P pairs: the faces of all, and the distinct hulls (C,) with the class (P,) of each pair."""

    faces: Halfspaces
    distinct: tuple[PairHull, ...]
    label: Ints


def hulls(
    bodies: Bodies,
    a: Ints,
    b: Ints,
    reference: Floats,
    model: Hull,
    motion: Floats | None = None,
    stop: Stop | None = None,
) -> Hulls | None:
    """Hull of every pair, worked out where the bodies lie now; None where two of them touch there.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
        Pairs.
    reference : (n, 2) float64 [mm]
        Reference point of every body in its own frame.
    model : Hull
    motion : (n, 3) float64 [mm, mm, rad], optional
        Where the bodies lie; by default at rest.
    stop : optional
        Asked before every pair.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    pose = relative_pose(bodies, a, b, motion)
    first, label = congruence_classes(bodies, a, b, pose)
    key = np.column_stack([label, np.round(reference[b] / (1e-9 * bodies.radius[b, None]))])
    _, first, label = np.unique(key, axis=0, return_index=True, return_inverse=True)
    label = label.ravel()
    geometry = placed(bodies, motion, np.unique(np.concatenate([a[first], b[first]])))
    where = bodies.rest if motion is None else bodies.rest + motion
    found, points = [], np.zeros((len(first), 2))
    for k, pair in enumerate(first):
        go_on(stop)
        one, other = int(a[pair]), int(b[pair])
        material = geometry[one], geometry[other]
        if model.about == "joint":
            pivot = joint_point(*material)
            points[k] = rotated(pivot - where[other, :2], np.array([-where[other, 2]]))[0]
        else:
            points[k] = reference[other]
            pivot = where[other, :2] + rotated(points[k], where[other, 2:])[0]
        own = [shapely.transform(g, lambda p: rotated(p - pivot, np.array([-where[one, 2]]))) for g in material]  # noqa: B023
        hull = pair_hull(pair_outlines(own[0], own[1]), model, float(bodies.radius[[one, other]].max()))
        if hull is None:
            return None
        found.append(hull)
    row, normal, offset = spread([(h.normal, h.offset) for h in found], label)
    point = points[label]
    return Hulls(Halfspaces(a, b, row, normal, offset, point, seen_point(pose, point)), tuple(found), label)


def joint_point(a: shapely.Geometry, b: shapely.Geometry) -> Floats:
    """Middle (x, y) [mm] of the material of b that lies near a."""
    near = shapely.intersection(b, shapely.buffer(a, 2 * shapely.distance(a, b)))
    return shapely.get_coordinates(shapely.centroid(near))[0]
