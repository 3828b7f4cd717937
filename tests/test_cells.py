"""Cells of a pair: every pose inside is free of overlap, by shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import affinity

from tests.flexing import polygon_part
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.cells.cells import grow_cells, select
from wiggleroom.geometry.bodies import bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION


def tip_over_notch(depth, half, clearance, tilt):
    """A pin whose tip stands over a notch of the same angle in a long bar."""
    tip = shapely.Polygon([(-half, 0), (0, -depth), (half, 0), (half, 0.8), (-half, 0.8)])
    notch = shapely.Polygon([(-9 * half, 8 * depth), (0, -depth), (9 * half, 8 * depth)])
    bar = shapely.box(-2, -0.7, 3, 0.1) - affinity.translate(notch, 0, -clearance)
    turned = [affinity.rotate(shape, tilt, origin=(0, 0), use_radians=True) for shape in (bar, tip)]
    parts = polygon_part("bar", turned[0], fixed=True), polygon_part("pin", turned[1])
    return bodies(assemble(Drawing(parts, gap=0.0)))


@pytest.mark.parametrize(("depth", "tilt"), [(0.05, 0.0), (0.15, 0.3), (0.05, 2.0)])
def test_a_tip_over_a_notch_of_its_angle_has_a_cell_that_holds_no_overlap(depth, tilt):
    clearance = 0.02
    them = tip_over_notch(depth, 0.12, clearance, tilt)
    a, b = np.array([0]), np.array([1])
    cells, good = grow_cells(them, a, b, relative_pose(them, a, b), np.full(1, clearance))
    assert good.all()
    assert poses_inside(them, cells, clearance) > 100  # the pin can leave upwards


def poses_inside(them, cells, clearance):
    """How many random poses of the second body are inside the cell, once it is sure that none of them overlaps."""
    program = build_program(them, select(cells, np.array([0])), ZERO_MOTION, length=clearance)
    rng, inside = np.random.default_rng(1), 0
    for scale in (0.02, 0.2, 1.0):
        for _ in range(400):
            motion = np.zeros((2, 3))
            motion[1] = rng.uniform(-scale, scale, 3)
            if program.values(program.variables(motion)).min() < 0:
                continue
            inside += 1
            one, other = placed(them, motion)
            assert shapely.intersection(one, other).area < 1e-12
    return inside


@pytest.mark.parametrize("tilt", [0.0, 2.0])
def test_a_block_in_a_thin_bracket_has_a_cell_that_holds_no_overlap(tilt):
    # the back of the thin leg is nearer to the block than the arm is, and only leg and arm together part it from the block
    bracket = [
        (5.136, 4.243),
        (5.553, 4.284),
        (5.568, 4.378),
        (5.234, 4.603),
        (5.088, 4.622),
        (5.147, 3.765),
        (5.282, 3.817),
    ]
    block = [(5.439, 3.895), (5.487, 4.211), (5.174, 4.178), (5.293, 3.838)]
    turned = [
        affinity.rotate(shapely.Polygon(ring), tilt, origin=(0, 0), use_radians=True) for ring in (bracket, block)
    ]
    parts = polygon_part("bracket", turned[0], fixed=True), polygon_part("block", turned[1])
    them = bodies(assemble(Drawing(parts, gap=0.0)))
    clearance = turned[0].distance(turned[1])
    a, b = np.array([0]), np.array([1])
    cells, good = grow_cells(them, a, b, relative_pose(them, a, b), np.full(1, clearance))
    assert good.all()
    assert cells.ends[0, 1] - cells.ends[0, 0] > 0.01
    assert poses_inside(them, cells, clearance) > 30
