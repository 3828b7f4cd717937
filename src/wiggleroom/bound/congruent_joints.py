"""Joints that are alike although the bodies round them differ: what holds for one of them holds for all.

A region that two pieces of material keep closed stays closed round any two bodies that hold these pieces: more material forbids
more. So the region of a joint is worked out for the *strips* of both bodies along each other alone, and belongs to every pair of bodies in
which the same strips lie in the same way.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.outer_slices import PairMaterial, corners_of, loops
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CONGRUENCE_WORK = 3.0
"""Work of looking for the joint of a pair among those that are known."""
STRIP_WIDTHS = (20.0, 80.0, 320.0)
"""Widths of strips [clearances]: a joint seldom lets its bodies go further; the next width is for those that it does."""
CORNER_REACH = 0.2
"""Corners that lie within this share of the width of the other body tell joints from each other."""
CONGRUENCE_TOLERANCE = 2e-10
"""Bodies agree with their strip, and pairs of one class with each other, to this share of their size: a fiftieth of the regions' margin."""
MAX_SIZE_RATIO = 4.0
"""Pairs share a joint where none of them is larger than the one that it was worked out for by more than this factor, as those of a
class differ by a share of their own size."""
MAX_REFERENCES, MIN_COMMON_CORNERS = 6, 0.5
"""At most this many corners are tried as the reference; where at least this share finds its like, strips are compared."""
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
    heading : (n,) float64 [rad]
        Direction of the side that begins there.
    long, back : (n,) float64 [mm]
        Its length, and that of the side that ends there, where both ends lie near the other body, else nought.
    """

    at: Floats
    angle: Floats
    heading: Floats
    long: Floats
    back: Floats

    @cached_property
    def tree(self) -> shapely.STRtree:
        """To look for corners in a place."""
        return shapely.STRtree(shapely.points(self.at))

    def alike(self, rows: Ints, other: Corners, close: float) -> Bools:
        """Which corners of another body (m,) may be these of our own (k,): they turn alike, and a side is as long; (k, m)."""
        same = np.abs(other.angle - self.angle[rows, None]) < ANGLE_TOLERANCE
        side = np.zeros_like(same)
        for mine, theirs in ((self.long, other.long), (self.back, other.back)):
            side |= (np.abs(theirs - mine[rows, None]) < close) & (theirs > 0)
        return same & side


@dataclass(frozen=True, eq=False)
class CongruentJoint:
    """Strips of two bodies along each other, `width` clearances wide, to look for in other pairs."""

    material: PairMaterial
    width: float = STRIP_WIDTHS[0]

    @cached_property
    def strips(self) -> PairMaterial:
        """What of both bodies lies near the other one."""
        return self.material.strips(self.width * self.material.clearance)

    @cached_property
    def _inner(self) -> tuple[shapely.Geometry, shapely.Geometry]:
        """Strips less what congruent ones may differ by."""
        off = CONGRUENCE_TOLERANCE * self.strips.extent
        a, b = (shapely.buffer(g, -off, join_style="mitre") for g in (self.strips.a, self.strips.b))
        return a, b

    @cached_property
    def _corners(self) -> Corners:
        return near_corners(self.material.a, self.material.b, CORNER_REACH * self.width * self.material.clearance)

    @property
    def reference_angles(self) -> Floats:
        """By which the boundary turns at the corners that are looked for in other pairs [rad]."""
        mine = self._corners
        return mine.angle[np.argsort(-mine.long, kind="stable")[:MAX_REFERENCES]]

    def motion_onto(self, other: PairMaterial, corners: Corners) -> tuple[float, Floats] | None:
        """Turn [rad] and shift (2,) [mm] that carry the strips into the two bodies of another pair, None where none does.

        `corners` are those of the first of the two, from `near_corners`.
        """
        mine = self._corners
        alike = abs(other.clearance - self.material.clearance) <= 1e-6 * self.material.clearance
        if not alike or other.extent > MAX_SIZE_RATIO * self.material.extent or len(mine.at) < 2:
            return None
        close = 1e-7 * self.strips.radius
        # the longest sides may be those that end where the bodies do, elsewhere in another pair
        first = np.argsort(-mine.long, kind="stable")[:MAX_REFERENCES]
        for j, k in zip(*np.nonzero(mine.alike(first, corners, 2 * close)), strict=True):
            angle = float(corners.heading[k] - mine.heading[first[j]])
            shift = corners.at[k] - rotated(mine.at[first[j]], angle)
            there = rotated(mine.at, angle) + shift
            common, _ = corners.tree.query(shapely.points(there), "dwithin", close)
            if len(np.unique(common)) < MIN_COMMON_CORNERS * len(there):
                continue
            moved = [shapely.transform(g, lambda p, a=angle, s=shift: rotated(p, a) + s) for g in self._inner]
            if shapely.covers(other.a, moved[0]) and shapely.covers(other.b, moved[1]):
                return angle, shift
        return None


def near_corners(a: shapely.Geometry, b: shapely.Geometry, reach: float) -> Corners:
    """Corners of `a` within `reach` [mm] of `b`."""
    at, _, come, go = corners_of(a)
    _, after = loops(a)
    near = shapely.dwithin(shapely.points(at), b, reach)
    long = np.where(near[after], np.hypot(*(at[after] - at).T), 0.0)
    back = np.zeros(len(at))
    back[after] = np.where(near, long, 0.0)
    angle = np.arctan2(come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0], (come * go).sum(1))
    return Corners(at[near], angle[near], np.arctan2(go[near, 1], go[near, 0]), long[near], back[near])


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


class KnownJoints:
    """Joints that were met so far, with strips of some width, found again by the angles of their corners."""

    def __init__(self, width: float = STRIP_WIDTHS[0]) -> None:
        self.width = width
        self.joints: list[CongruentJoint] = []
        self._by_angle: dict[int, set[int]] = {}

    def congruence(self, material: PairMaterial) -> Congruence:
        """Which joint a pair holds, a new one where it holds none of those."""
        shapely.prepare([material.a, material.b])
        reach = CORNER_REACH * self.width * material.clearance
        for swapped in (False, True):
            pair = PairMaterial(material.b, material.a, material.clearance, material.size) if swapped else material
            corners = near_corners(pair.a, pair.b, reach)
            keys = {k + side for k in _angle_keys(corners.angle) for side in (-1, 0, 1)}
            alike = set().union(*(self._by_angle.get(k, set()) for k in keys))
            for number in sorted(alike):
                motion = self.joints[number].motion_onto(pair, corners)
                if motion is not None:
                    return Congruence(number, swapped, *motion)
        return self._added(CongruentJoint(material, self.width))

    def _added(self, joint: CongruentJoint) -> Congruence:
        number = len(self.joints)
        self.joints.append(joint)
        for key in _angle_keys(joint.reference_angles):
            self._by_angle.setdefault(key, set()).add(number)
        return Congruence(number, False, 0.0, np.zeros(2))


def _angle_keys(angles: Floats) -> list[int]:
    return np.round(angles / (10 * ANGLE_TOLERANCE)).astype(np.int64).tolist()


def congruent_joints(
    materials: Sequence[PairMaterial], width: float = STRIP_WIDTHS[0], budget: WorkBudget | None = None
) -> tuple[list[CongruentJoint], list[Congruence]]:
    """Joints that differ, with strips of some width, and which of them each pair holds; of the first ones where the budget ends before."""
    known = KnownJoints(width)
    budget = budget or WorkBudget()
    some = itertools.takewhile(lambda _: not budget.spend(CONGRUENCE_WORK), materials)
    found = [known.congruence(material) for material in some]
    return known.joints, found
