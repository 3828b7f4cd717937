"""Bodies led past others while all others make room: how far they get, against exact distances, and paths by dense sampling."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import part_at
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.build import assemble
from wiggleroom.disassembly.closed_pairs import ClosedPairs, closed_pairs
from wiggleroom.disassembly.escape_by_pairs import RelativeSegment, escape_by_known_pairs, escape_by_pairs, follow
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.drawing.model import Drawing
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.search.prepare import Prepared, prepare_without_cells, survey


def ready_of(assembly: Assembly) -> Prepared:
    return prepare_without_cells(assembly, survey(assembly))


def deepest(assembly: Assembly, motions: np.ndarray, between: int = 10) -> float:
    """Largest common area of two parts on a path (k, parts, 3), by dense sampling."""
    shapes = [shapely.Polygon(p.regions[0].outer, p.regions[0].holes) for p in assembly.parts]
    worst = 0.0
    for one, other in pairwise(motions):
        for t in np.linspace(0, 1, between):
            at = assembly.rest + one + t * (other - one)
            moved = [shapely.transform(s, lambda p, q=q: place(p, q)) for s, q in zip(shapes, at, strict=True)]
            worst = max(worst, *(moved[i].intersection(moved[j]).area for i in range(len(at)) for j in range(i)))
    return worst


FLOOR = shapely.box(0, -10, 60, -2)
SLIDE = shapely.box(2, 0, 12, 10)


def scene(block_stands: bool) -> Assembly:
    """A slide on a floor, and a block 4 mm in front of it."""
    block = shapely.box(16, 1, 26, 9)
    shapes = {"floor": (FLOOR, True), "slide": (SLIDE, False), "block": (block, block_stands)}
    return assemble(Drawing(tuple(part_at(n, s, (*s.centroid.coords[0], 0.0), f) for n, (s, f) in shapes.items())))


@pytest.mark.parametrize("stands", [True, False])
def test_what_is_led_gets_as_far_as_what_is_in_its_way_gives_way(stands: bool) -> None:
    ready = ready_of(scene(stands))
    segment = RelativeSegment(0, 1, np.array([7.0, 5.0]), np.zeros(3), np.array([20.0, 0.0, 0.0]), free=True)
    found = follow(ready, ready.outlines, np.zeros((3, 3)), segment)
    assert deepest(ready.assembly, of_parts(ready.assembly, ready.bodies, found.path)) < 1e-9
    slid = found.path[-1, 1]
    assert found.share == pytest.approx(slid[0] / 20)
    assert not slid[1:].any()
    if stands:
        assert 3.9 < slid[0] <= 4
    else:
        assert found.share == 1
        assert found.path[-1, 2, 0] >= 16


@pytest.mark.parametrize("fixed", [0, 1])
def test_a_piece_is_kept_to_exactly_whichever_of_the_two_stands(fixed: int) -> None:
    """Along the piece the one as seen from the other turns about the pivot and is shifted, evenly; others push nothing."""
    names = ("floor", "slide")
    shapes = {"floor": FLOOR, "slide": SLIDE, "aside": shapely.box(0, 30, 5, 35)}
    parts = [part_at(n, s, (*s.centroid.coords[0], 0.3), n == names[fixed]) for n, s in shapes.items()]
    ready = ready_of(assemble(Drawing(tuple(parts))))
    pivot, end = np.array([1.0, 0.5]), np.array([3.0, 8.0, 0.7])
    segment = RelativeSegment(0, 1, pivot, np.zeros(3), end, free=True)
    found = follow(ready, ready.outlines, np.zeros((3, 3)), segment)
    assert found.share == 1
    seen = np.array([relative_pose(ready.bodies, np.array([0]), np.array([1]), m)[0] for m in found.path])
    t = (seen[:, 2] - seen[0, 2]) / end[2]
    assert (np.diff(t) > 0).all()
    at = ready.bodies.rest[0]
    for share, pose in zip(t, seen, strict=True):
        expected = place(ready.bodies.rest[1:2, :2] - pivot, np.append(share * end[:2] + pivot, share * end[2]))
        assert place(pose[None, :2], at)[0] == pytest.approx(expected[0], abs=1e-9)


@pytest.mark.slow
def test_a_corner_of_a_jigsaw_is_led_out_at_a_needles_eye() -> None:
    """Two pieces as one leave the two others past the neck of one tab; it is asked again at a larger gap, and not at a smaller one."""
    passages = PassagesByGap()
    every = np.arange(4)
    pairs = ()
    for gap, leaves in ((0.03, True), (0.031, True), (0.029, False)):
        assembly = with_ground(wr.patterns.jigsaw(2, 2, gap, seed=2))
        ready = ready_of(assembly)
        if pairs:
            found = escape_by_known_pairs(ready, every, pairs, passages)
        else:
            known = closed_pairs(ready, ClosedPairs(every, every, np.zeros((0, 2), dtype=np.int64)), passages)
            found = escape_by_pairs(ready, known, passages)
        assert (found is not None) == leaves
        if found is not None:
            pairs = found.pairs
            assert pairs == (("b2-1", "b2-2"),)
            assert set(found.exit.who) == {2, 3}
            motions = of_parts(assembly, ready.bodies, found.path)
            assert deepest(assembly, motions) < 1e-9
    assert escape_by_known_pairs(ready, every, (("b2-1", "gone"),), passages) is None
