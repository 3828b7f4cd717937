"""The physics engine pulled to rest, against chains and boxes of known truth."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr

pytest.importorskip("pymunk")

from wiggleroom.bench.chains import convex_polygons, pulled_to_rest

from .oracle.blocks import JOINTS, block
from .oracle.chain import stored


@pytest.mark.parametrize("joint", JOINTS[:3])
def test_pieces_are_convex_and_fill_the_part(joint):
    shape = block(joint, 0.02)
    shape = shape.difference(shapely.Point(0, 0).buffer(0.1, 3))  # a hole as well
    pieces = [shapely.Polygon(p) for p in convex_polygons(shape)]
    assert all(p.area == pytest.approx(p.convex_hull.area, rel=1e-9) for p in pieces)
    assert sum(p.area for p in pieces) == pytest.approx(shape.area, rel=1e-9)
    assert shapely.union_all(pieces).symmetric_difference(shape).area < 1e-9
    assert len(pieces) <= shapely.get_num_coordinates(shape)


@pytest.mark.parametrize(("joint", "gap", "n"), [("tee", 0.02, 2), ("swallowtail", 0.03, 5)])
def test_chains_come_within_one_percent(joint, gap, n):
    found = pulled_to_rest(wr.patterns.chain(n, joint, gap))
    assert found.settled
    assert found.objective == pytest.approx(stored(joint, gap, n)[0], rel=0.01)
    assert found.deepest_overlap < 0.02 * gap
    assert not found.motion[0].any()


def boxes(pull, **more):
    """A square of side 1 in a square hole with play 0.2 on the left and 0.1 on the other sides, far away and turned."""
    hole = np.array([[-0.2, -0.1], [-0.2, 1.1], [1.1, 1.1], [1.1, -0.1]])
    frame = wr.Region(np.array([[-2.0, -2.0], [3.0, -2.0], [3.0, 3.0], [-2.0, 3.0]]), (hole,))
    plug = wr.Region(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    at = (500.0, -300.0, 0.0)
    parts = (wr.Part("frame", (frame,), at=at, fixed=True), wr.Part("plug", (plug,), at=at))
    return wr.assemble(wr.Drawing(parts, goals=(pull,), **more))


def test_a_box_stops_at_the_wall():
    left = pulled_to_rest(boxes(wr.Pull("plug", (-1.0, 0.0), point=(500.5, -299.5))))
    assert left.objective == pytest.approx(0.2, rel=0.01)
    assert left.motion[1, 2] == pytest.approx(0.0, abs=0.01)


def test_a_pulled_corner_turns_the_box_as_far_as_flex_finds():
    corner = wr.Pull("plug", (0.0, 1.0), point=(501.0, -300.0))
    assembly = boxes(corner)
    assert pulled_to_rest(assembly).objective == pytest.approx(wr.flex(assembly, search=0).objective, rel=0.01)


def test_glued_parts_move_as_one():
    chain = wr.patterns.chain(4, "tee", 0.02)
    glued = wr.assemble(wr.Drawing(chain.drawing.parts, 0.02, glue=(("b2", "b3"),), goals=chain.goals))
    found = pulled_to_rest(glued)
    assert found.objective == pytest.approx(wr.flex(glued, search=0).objective, rel=0.01)
    assert found.motion[1, 2] == found.motion[2, 2]


def test_no_rest_within_the_steps_is_said():
    assert not pulled_to_rest(wr.patterns.chain(5, "tee", 0.02), most=500).settled


def test_what_it_cannot_do():
    chain = wr.patterns.chain(3)
    with pytest.raises(wr.InputError, match="knows pulls only, no Turn"):
        pulled_to_rest(boxes(wr.Turn("plug")))
    with pytest.raises(wr.InputError, match="ignore each other"):
        pulled_to_rest(boxes(wr.Pull("plug", (1, 0)), ignore=(("frame", "plug"),)))
    with pytest.raises(wr.InputError, match='"b9" is not a part'):
        pulled_to_rest(chain, wr.Pull("b9", (0, 1)))
    with pytest.raises(wr.TouchingError):
        pulled_to_rest(wr.patterns.chain(3, gap=0.0))
