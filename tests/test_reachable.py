"""Where a point can be brought: what is shaded is reached, and what is reached is shaded."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import box
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.live.reachable import reachable_region

HOLE = np.array([[-6.0, -5.0], [-6.0, 5.0], [6.0, 5.0], [6.0, -5.0]])


def disc_in_frame() -> wr.Assembly:
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    disc = Part("disc", (Region(4 * np.column_stack([np.cos(angle), np.sin(angle)])),))
    outer = np.array([[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]])
    return assemble(Drawing((Part("frame", (Region(outer, (HOLE,)),), fixed=True), disc)), gap=0.0)


def test_a_disc_is_reached_wherever_it_fits():
    """Its middle goes 2 mm to either side and 1 mm up and down, in closed form."""
    found = reachable_region(wr.Live(disc_in_frame()), "disc", (0.0, 0.0))
    assert found.exact
    assert not found.open
    assert found.region.bounds == pytest.approx((-2, -1, 2, 1), abs=0.02)
    assert found.region.area == pytest.approx(8, rel=0.02)


@pytest.mark.parametrize("joint", ["tee", "jigsaw"])
def test_of_two_bodies_all_that_drags_reach_is_shaded(joint):
    assembly = wr.patterns.chain(2, joint=joint, gap=0.02)
    live, random = wr.Live(assembly), np.random.default_rng(1)
    grip = (1.3, 0.2)
    region = reachable_region(live, "b2", grip).region
    for _ in range(20):
        angle, far = random.uniform(0, 2 * np.pi), random.uniform(0.005, 0.3)
        target = (grip[0] + far * np.cos(angle), grip[1] + far * np.sin(angle))
        shot = live.drag("b2", grip, target, start="rest", seconds=30)
        assert region.distance(shapely.Point(shot.reached)) < 0.1 * assembly.gap  # between two turns lies a little more


def test_of_more_bodies_every_corner_was_reached_and_the_session_stays():
    assembly = wr.patterns.chain(4, joint="tee", gap=0.02)
    live = wr.Live(assembly)
    x, y, _ = assembly.rest[3]
    before = live.drag("b4", (x, y), (x, y + 0.05), start="rest", seconds=30)
    found = reachable_region(live, "b4", (x, y))
    assert not found.exact
    after = live.drag("b4", (x, y), before.reached, seconds=30)
    assert after.distance < 0.01 * assembly.gap
    assert np.hypot(*(after.motion - before.motion)[3, :2]) < 0.1 * assembly.gap
    other = wr.Live(assembly)
    for corner in shapely.get_coordinates(found.region)[::4]:
        shot = other.drag("b4", (x, y), tuple(corner), start="rest", seconds=30)
        assert shot.distance < 0.1 * assembly.gap


def test_what_leaves_is_said():
    loose = assemble(Drawing((box("stands", 0, 0, 5, 5), box("goes", 5.5, 0, 9, 5))), gap=0.0)
    live = wr.Live(loose)
    live.design(fixed=["stands"])
    assert reachable_region(live, "goes", (7.0, 2.0)).open
