"""Joints that are alike in bodies that differ: where they are found, where they must not be, and that their regions hold."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.flexing import random_assembly
from tests.oracle import random_joints
from tests.oracle.slices import Slices
from wiggleroom.bound.congruent_joints import CONGRUENCE_WORK, CongruentJoint, congruent_joints
from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.outer_region import outer_region, pivot_of
from wiggleroom.freespace.outer.outer_slices import PairMaterial, corners_of
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.search.prepare import survey

TAB = np.array(
    [
        (0, -1),
        (0, -0.2),
        (-0.15, -0.2),
        (-0.15, -0.35),
        (-0.4, -0.35),
        (-0.4, 0.35),
        (-0.15, 0.35),
        (-0.15, 0.2),
        (0, 0.2),
        (0, 1),
    ]
)


def pair(height: float = 1.0, head: float = 0.35, gap: float = 0.01) -> PairMaterial:
    """A block with a slot and one with a tab, the outer corners `height` above the middle."""
    tab = TAB.copy()
    tab[[0, -1], 1] = -height, height
    tab[[4, 5], 1] = -head, head
    tab[[3, 6], 1] = -head, head
    b = shapely.Polygon([*tab, (1, height), (1, -height)])
    a = shapely.box(-1.5, -height, 0, height).difference(b.buffer(gap, join_style="mitre"))
    return PairMaterial(a, b, gap)


def moved(material: PairMaterial, angle: float, shift: tuple[float, float]) -> PairMaterial:
    """The pair elsewhere."""
    a, b = (shapely.transform(g, lambda p: rotated(p, angle) + shift) for g in (material.a, material.b))
    return PairMaterial(a, b, material.clearance)


@pytest.mark.parametrize("swapped", [False, True])
def test_a_joint_is_found_in_other_bodies_turned_and_swapped(swapped: bool) -> None:
    other = moved(pair(height=1.6), 0.7, (3.0, -2.0))
    if swapped:
        other = PairMaterial(other.b, other.a, other.clearance)
    joints, (_, found) = congruent_joints([pair(), other])
    assert len(joints) == 1
    assert found.swapped is swapped
    assert found.angle % (2 * np.pi) == pytest.approx(0.7)
    assert found.shift == pytest.approx((3, -2))


@pytest.mark.parametrize("change", [1e-6, 1e-4, -1e-6])
def test_a_joint_that_differs_a_little_is_another_one(change: float) -> None:
    assert len(congruent_joints([pair(), pair(height=1.6, head=0.35 + change)])[0]) == 2


@pytest.mark.parametrize("seed", range(3))
def test_strips_lie_in_their_bodies_and_have_no_edges_without_direction(seed: int) -> None:
    surveyed = survey(random_assembly(seed))
    for a, b, clearance in zip(surveyed.near.a, surveyed.near.b, surveyed.near.clearance, strict=True):
        whole = PairMaterial(surveyed.geometry[a], surveyed.geometry[b], float(clearance))
        strips = CongruentJoint(whole).strips
        for strip, body in ((strips.a, whole.a), (strips.b, whole.b)):
            assert strip.is_valid
            assert shapely.difference(strip, shapely.buffer(body, whole.margin)).area == 0
            start, end, *_ = corners_of(strip)
            assert np.hypot(*(end - start).T).min() > 1e-4 * whole.margin


@pytest.mark.parametrize("seed", range(2))
def test_regions_of_strips_hold_all_true_slices(seed: int) -> None:
    made = random_joints.tab_pair(seed, 0.02)
    a, b, apart = made.local()
    seen = shapely.transform(b, lambda p: p + apart)
    clearance = float(shapely.distance(a, seen))
    pivot, lever = pivot_of(a, seen, 3 * clearance)
    whole = PairMaterial(*(shapely.transform(g, lambda p: p - pivot) for g in (a, seen)), clearance)
    region = outer_region(CongruentJoint(whole).strips, lever, 4.0)
    if region is None:
        return
    slices = Slices(a, b, tuple(apart))
    normals = np.array([(np.cos(t), np.sin(t)) for t in np.linspace(0, 2 * np.pi, 24)])
    for phi in np.linspace(slices.low, slices.high, 9):
        corners = slices.corners(phi)
        if not len(corners):
            continue
        # the motion of the pivot, from that of b's origin
        arm = pivot - apart
        tau = corners + rotated(arm, float(phi)) - arm
        points, _ = region.points(phi - 1e-9, phi + 1e-9)
        assert ((points[:, :2] @ normals.T).max(0) >= (tau @ normals.T).max(0) - 1e-9).all()


def test_looking_for_joints_that_are_alike_stops_when_asked() -> None:
    joints, found = congruent_joints([pair(), pair(), pair()], budget=WorkBudget(1.5 * CONGRUENCE_WORK))
    assert len(joints) == len(found) == 1
