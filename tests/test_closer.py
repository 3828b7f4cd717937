"""Neighbours as near each other as they come, and assemblies at the edge of sense."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.audit import part
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing

RING = shapely.box(-3, -3, 3, 3) - shapely.box(-1.2, -1.2, 1.2, 1.2)


def ring_round_bolt(x: float, y: float) -> wr.Assembly:
    """A ring with 0.2 mm of room round a bolt, its reference point (x, y) away from the bolt's."""
    bolt = part("bolt", shapely.box(-1, -1, 1, 1), (0.0, 0.0, 0.0), True)
    return assemble(Drawing((bolt, part("ring", RING, (x, y, 0.0), False)), goals=(wr.Closer(),)), gap=0.0)


@pytest.mark.parametrize(("x", "y"), [(0.0, 0.0), (0.05, 0.02), (-0.15, 0.1), (1e-6, 0.0)])
def test_a_ring_that_can_be_centred_is_centred_and_no_better_place_is_left(x: float, y: float) -> None:
    """What the squared distance can lose at most is all of it."""
    answer = wr.flex(ring_round_bolt(x, y), search=0)
    assert answer.verdict == "optimal"
    assert answer.objective == pytest.approx(x**2 + y**2, rel=1e-6, abs=1e-12)
    assert answer.motion[1, :2] == pytest.approx((-x, -y), abs=1e-5)
    assert not answer.contacts


def test_nothing_moves_where_rest_is_best() -> None:
    answer = wr.flex(ring_round_bolt(0.0, 0.0), search=0)
    assert answer.objective == 0.0
    assert not answer.motion.any()


def test_a_ring_that_cannot_be_centred_is_held_by_the_bolt() -> None:
    """Its reference point lies outside the room that the bolt leaves: it comes 0.2 mm nearer along x, and no less along y than it likes."""
    shape = shapely.transform(RING, lambda points: points + np.array([1.0, 0.05]))
    bolt = part("bolt", shapely.box(-1, -1, 1, 1), (0.0, 0.0, 0.0), True)
    drawing = Drawing((bolt, part("ring", shape, (-1.0, -0.05, 0.0), False)), goals=(wr.Closer(),))
    answer = wr.flex(assemble(drawing, gap=0.0), search=0)
    assert answer.verdict == "optimal"
    assert answer.objective >= 1.0**2 + 0.05**2 - 0.8**2 - 1e-6  # straight; turned, perhaps a little more
    assert answer.contacts


FRAME, BLOCK = shapely.box(-2, -2, 2, 2) - shapely.box(-1, -1, 1, 1), shapely.box(-0.8, -0.8, 0.8, 0.8)


def framed(far: float = 0.0, **more: object) -> wr.Assembly:
    shapes = [shapely.transform(g, lambda points: points + np.array([far, 0.0])) for g in (FRAME, BLOCK)]
    parts = part("f", shapes[0], (0.0, 0.0, 0.0), True), part("b", shapes[1], (0.0, 0.0, 0.0), False)
    return assemble(Drawing(parts, goals=(wr.Pull("b", (1, 0)),), **more), gap=0.0)


def test_what_meets_nothing_is_unbounded() -> None:
    assert wr.flex(framed(ignore=(("f", "b"),)), search=0).verdict == "unbounded"


def test_a_reference_point_far_away_is_moved_into_the_outline() -> None:
    assembly = framed(1e8)
    assert wr.flex(assembly, search=0).objective == pytest.approx(0.2, rel=1e-6)
    assert "reference point" in assembly.drawing.notes[0]
    assert not framed(100.0).drawing.notes


def test_closer_is_optimal_where_no_neighbour_can_come_nearer() -> None:
    blocks = part("a", BLOCK, (0.0, 0.0, 0.0), True), part("b", shapely.box(50, 0, 51, 1), (0.0, 0.0, 0.0), False)
    answer = wr.flex(assemble(Drawing(blocks, goals=(wr.Closer(),)), gap=0.0), search=0)
    assert (answer.verdict, answer.objective) == ("optimal", 0.0)
