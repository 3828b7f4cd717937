"""Joints that are alike although the bodies round them differ: what holds for one of them holds for all.

A region that two pieces of material keep closed stays closed round any two bodies that hold these pieces: more material forbids
more. So the region of a joint is worked out for the *strips* of both bodies along each other alone, and belongs to every pair of bodies in
which the same strips lie in the same way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.outer.outer_slices import SAFETY_MARGIN, PairMaterial, corners_of, loops
from wiggleroom.geometry.relative_pose import turn

Floats = NDArray[np.float64]

STRIP_WIDTH = 20.0
"""Strips are so many clearances wide: a joint seldom lets its bodies go further."""
CORNER_REACH = 4.0
"""Corners that lie within so many clearances of the other body tell joints from each other."""
CONGRUENCE_TOLERANCE = 2e-10
"""Bodies hold a strip but for this share of its size, a fiftieth of what regions are too large by."""
ANGLE_TOLERANCE = 1e-7
"""Corners are alike where their angles differ by less [rad]."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of a body near the other one of its pair.

    Parameters
    ----------
    at : (n, 2) float64 [mm]
    angle : (n,) float64 [rad]
        By which the boundary turns there.
    way : (n,) float64 [rad]
        Direction of the side that begins there.
    long : (n,) float64 [mm]
        Its length if it ends near the other body, too, else nought.
    """

    at: Floats
    angle: Floats
    way: Floats
    long: Floats


@dataclass(frozen=True, eq=False)
class Joint:
    """Strips of two bodies along each other, to look for in other pairs."""

    material: PairMaterial

    @cached_property
    def strips(self) -> PairMaterial:
        """What of both bodies lies near the other one."""
        return self.material.strips(STRIP_WIDTH * self.material.clearance)

    @cached_property
    def _inner(self) -> tuple[shapely.Geometry, shapely.Geometry]:
        """Strips less what congruent ones may differ by."""
        off = CONGRUENCE_TOLERANCE / SAFETY_MARGIN * self.strips.margin
        a, b = (shapely.buffer(g, -off, join_style="mitre") for g in (self.strips.a, self.strips.b))
        return a, b

    @cached_property
    def _corners(self) -> Corners:
        return near_corners(self.material.a, self.material.b, CORNER_REACH * self.material.clearance)

    def motion_onto(self, other: PairMaterial, corners: Corners) -> tuple[float, Floats] | None:
        """Turn [rad] and shift (2,) [mm] that carry the strips into the two bodies of another pair, None where none does.

        `corners` are those of the first of the two, from `near_corners`.
        """
        mine = self._corners
        if abs(other.clearance - self.material.clearance) > 1e-6 * self.material.clearance or len(mine.at) < 2:
            return None
        first = int(mine.long.argmax())
        second = int(np.hypot(*(mine.at - mine.at[first]).T).argmax())
        close = 1e-7 * self.strips.radius
        alike = np.abs(corners.angle - mine.angle[first]) < ANGLE_TOLERANCE
        for k in np.flatnonzero(alike):
            angle = float(corners.way[k] - mine.way[first])
            shift = corners.at[k] - turn(mine.at[first], angle)
            there = turn(mine.at[second], angle) + shift
            if np.hypot(*(corners.at - there).T).min() > close:
                continue
            moved = [shapely.transform(g, lambda p, a=angle, s=shift: turn(p, a) + s) for g in self._inner]
            if shapely.covers(other.a, moved[0]) and shapely.covers(other.b, moved[1]):
                return angle, shift
        return None


def near_corners(a: shapely.Geometry, b: shapely.Geometry, reach: float) -> Corners:
    """Corners of `a` within `reach` [mm] of `b`."""
    at, _, come, go = corners_of(a)
    _, after = loops(a)
    near = shapely.dwithin(shapely.points(at), b, reach)
    long = np.where(near[after], np.hypot(*(at[after] - at).T), 0.0)
    angle = np.arctan2(come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0], (come * go).sum(1))
    return Corners(at[near], angle[near], np.arctan2(go[near, 1], go[near, 0]), long[near])


@dataclass(frozen=True, eq=False)
class Congruence:
    """How a pair holds the strips of a joint.

    Parameters
    ----------
    joint : int
        Number of the joint.
    swapped : bool
        Whether the pair's second body takes the place of the joint's first.
    angle : float [rad]
    shift : (2,) float64 [mm]
        Turn and shift that carry the joint onto the pair.
    """

    joint: int
    swapped: bool
    angle: float
    shift: Floats


def congruent_joints(materials: Sequence[PairMaterial]) -> tuple[list[Joint], list[Congruence]]:
    """Joints that differ, and which of them each pair holds."""
    joints: list[Joint] = []
    found: list[Congruence] = []
    for material in materials:
        shapely.prepare([material.a, material.b])
        known = _known(joints, material)
        if known is None:
            known = Congruence(len(joints), False, 0.0, np.zeros(2))
            joints.append(Joint(material))
        found.append(known)
    return joints, found


def _known(joints: list[Joint], material: PairMaterial) -> Congruence | None:
    """Which of some joints a pair holds; None where it holds none."""
    reach = CORNER_REACH * material.clearance
    for swapped in (False, True):
        pair = PairMaterial(material.b, material.a, material.clearance) if swapped else material
        corners = near_corners(pair.a, pair.b, reach)
        for k, joint in enumerate(joints):
            motion = joint.motion_onto(pair, corners)
            if motion is not None:
                return Congruence(k, swapped, *motion)
    return None
