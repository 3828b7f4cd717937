"""Outer regions of all pairs that hold each other, congruent ones worked out once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.bound.congruent_joints import (
    CONGRUENCE_TOLERANCE,
    STRIP_WIDTHS,
    Congruence,
    CongruentJoint,
    congruent_joints,
)
from wiggleroom.bound.joint_constraints import JointConstraints
from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.local_outer_region import LocalOuterRegion, NearSides, local_outer_region
from wiggleroom.freespace.outer.outer_region import OuterRegion, outer_region, pivot_of, reached_slices
from wiggleroom.freespace.outer.outer_slices import PairMaterial
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.relative_pose import relative_pose, rotated
from wiggleroom.search.prepare import Survey

if TYPE_CHECKING:
    from wiggleroom.freespace.outer.caging_surface import CagingSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WORKERS = 2
PAIR_WORK = 1.0
"""Work of cutting two bodies out about the pivot of their joint."""
"""Number of regions that are worked out at once."""
Region = TypeVar("Region")
PIVOT_REACH = 3.0
"""The pivot of a pair is found from the edges within this many clearances."""


def outer_regions(
    surveyed: Survey, budget: WorkBudget, certify: bool = False
) -> tuple[JointConstraints, list[OuterRegion | CagingSurface]]:
    """Outer regions of the pairs whose joint closes, and which pair has which; fewer where the budget ends before all are done.

    With `certify` they are caging surfaces, which a certificate can show.
    """
    return _regions(surveyed, budget, lambda material, lever, most, own: _region(material, lever, most, own, certify))


def local_outer_regions(surveyed: Survey, budget: WorkBudget) -> tuple[JointConstraints, list[LocalOuterRegion]]:
    """The same from walls round rest, in a fraction of the time: they may reach a little further, and close fewer joints."""

    def region(material: PairMaterial, _: float, __: float, own: WorkBudget) -> LocalOuterRegion | None:
        sides = NearSides(material)
        return None if own.spend(sides.work) else local_outer_region(sides)

    return _regions(surveyed, budget, region)


def _regions(
    surveyed: Survey,
    budget: WorkBudget,
    region_of: Callable[[PairMaterial, float, float, WorkBudget], Region | None],
) -> tuple[JointConstraints, list[Region]]:
    """Regions of the pairs whose joint closes; `region_of` is told the material, its lever [mm] how far it counts [mm], and its budget."""
    them, a, b = surveyed.bodies, surveyed.near.a, surveyed.near.b
    first, label = congruence_classes(them, a, b, relative_pose(them, a, b), CONGRUENCE_TOLERANCE)
    made = [
        material_of(them, surveyed.geometry, int(a[k]), int(b[k]), float(surveyed.near.clearance[k]))
        for k in first.tolist()
        if not budget.spend(PAIR_WORK)
    ]
    if len(made) < len(first):
        return links_about(them, a[:0], b[:0], np.zeros(0, dtype=np.int64), []), []
    limit = them.radius[a[first]] + them.radius[b[first]]
    held: list[Congruence] = [Congruence(0, False, 0.0, np.zeros(2))] * len(first)
    regions: list[Region] = []
    kind = np.full(len(first), -1, dtype=np.int64)

    def region(one: tuple[CongruentJoint, int], own: WorkBudget) -> Region | None:
        joint, c = one
        if joint.strips is joint.material and np.isfinite(joint.width):
            return None
        most = min(joint.width * joint.material.clearance, float(limit[c]))
        return region_of(joint.strips, made[c][2], most, own)

    for width in (*STRIP_WIDTHS, np.inf):
        # what strips alone leave open, wider ones may close, or whole bodies
        open_ = np.flatnonzero(kind < 0).tolist()
        joints, found = congruent_joints([made[c][0] for c in open_], width, budget)
        leader = [open_[next(i for i, one in enumerate(found) if one.joint == k)] for k in range(len(joints))]
        closed: list[Region | None] = [None] * len(joints)  # also those that the budget does not reach
        for k, r in enumerate(budget.in_order(region, [*zip(joints, leader, strict=True)], WORKERS)):
            closed[k] = r
        number = len(regions) - 1 + np.cumsum([r is not None for r in closed])
        regions += [r for r in closed if r is not None]
        for c, one in zip(open_, found, strict=False):  # fewer are found where the budget ends
            if closed[one.joint] is not None:
                kind[c], held[c] = number[one.joint], one
    known = np.flatnonzero(kind[label] >= 0)
    placements = [placement(them, int(a[k]), int(b[k]), made[c][1], held[c]) for c, k in enumerate(first.tolist())]
    label = label[known]
    return links_about(them, a[known], b[known], kind[label], [placements[c] for c in label.tolist()]), regions


@dataclass(frozen=True, eq=False)
class JointPlacement:
    """Where a joint lies in a pair of bodies.

    Parameters
    ----------
    swapped : bool
        Whether its first body is the pair's second.
    pivot : (2,) float64 [mm]
    angle : float [rad]
        Its pivot and the angle of its axes in the frame of its first body.
    """

    swapped: bool
    pivot: Floats
    angle: float


def placement(them: Bodies, a: int, b: int, pivot: Floats, held: Congruence) -> JointPlacement:
    """Placement of a joint in bodies `a` and `b`, of which `pivot` (2,) [mm] in the frame of `a` is the origin of the pair's material."""
    x, y, angle = them.rest[a]
    at = rotated(pivot + held.shift, float(angle)) + np.array([x, y])
    one = b if held.swapped else a
    axes = float(angle + held.angle - them.rest[one, 2])
    return JointPlacement(held.swapped, rotated(at - them.rest[one, :2], -float(them.rest[one, 2])), axes)


def links_about(them: Bodies, a: Ints, b: Ints, kind: Ints, places: Sequence[JointPlacement]) -> JointConstraints:
    """Links of pairs (P,) that have a region each, about the pivots of their joints."""
    swapped = np.array([p.swapped for p in places], dtype=bool)
    one, two = np.where(swapped, b, a), np.where(swapped, a, b)
    pivot = np.array([p.pivot for p in places]).reshape(-1, 2)
    arm = rotated(pivot, them.rest[one, 2])
    axes = them.rest[one, 2] + np.array([p.angle for p in places])
    return JointConstraints(one, two, kind, arm, them.rest[one, :2] + arm - them.rest[two, :2], axes)


def material_of(
    them: Bodies, geometry: NDArray[np.object_], a: int, b: int, clearance: float
) -> tuple[PairMaterial, Floats, float]:
    """Two bodies about the pivot of their joint, the pivot in the frame of body `a`, and its lever [mm]; `geometry` (n,) lies at rest."""
    pivot, lever = pivot_of(geometry[a], geometry[b], PIVOT_REACH * clearance)
    x, y, angle = them.rest[a]

    def seen(shape: shapely.Geometry) -> shapely.Geometry:
        return shapely.transform(shape, lambda p: rotated(p - pivot, np.full(len(p), -angle)))

    material = PairMaterial(seen(geometry[a]), seen(geometry[b]), clearance)
    return material, rotated((pivot - (x, y))[None], np.array([-angle]))[0], lever


def _region(
    material: PairMaterial, lever: float, limit: float, budget: WorkBudget, certify: bool
) -> OuterRegion | CagingSurface | None:
    """Region of one pair, None where the joint is open or the budget ended first."""
    if not certify:
        return outer_region(material, lever, limit, budget)
    from wiggleroom.freespace.outer.caging_surface import caging_surface  # only certificates need it

    # chords are checked in every pair by themselves: of strips only their own size matters
    own = PairMaterial(material.a, material.b, material.clearance)
    slices = reached_slices(own, lever, limit, budget)
    return None if slices is None else caging_surface(own, slices, budget)
