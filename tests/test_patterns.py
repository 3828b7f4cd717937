"""Joint families and patterns: edge counts, clearances, roles."""

from itertools import combinations

import numpy as np
import pytest
import shapely

from wiggleroom.assembly import patterns
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.errors import InputError

FAMILIES = ["tee", "swallowtail", "dovetail", "revolute", "finger", "jigsaw"]


def clearances(assembly):
    """Distance of every pair whose centres lie within 1.5 pitches, and whether they are side by side."""
    shapes, _ = placed_regions(assembly.parts)
    centres = assembly.rest[:, :2]
    for i, j in combinations(range(len(shapes)), 2):
        apart = np.hypot(*(centres[i] - centres[j]))
        if apart < 1.5:
            yield shapely.distance(shapes[i], shapes[j]), apart < 1.1
            assert not shapes[i].intersects(shapes[j])


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize(
    "make", [lambda *a: patterns.chain(3, *a), lambda *a: patterns.grid(3, 2, *a), lambda *a: patterns.frame(3, 4, *a)]
)
def test_neighbours_are_exactly_one_gap_apart(family, make):
    gap = 0.01
    for distance, beside in clearances(make(family, gap)):
        if beside:
            assert distance == pytest.approx(gap, abs=1e-12)
        else:
            assert distance >= gap - 1e-12


@pytest.mark.parametrize("family", FAMILIES)
def test_drawn_blocks_fill_the_plane(family):
    """As drawn, tab and pocket share every corner: the block is a unit square in area and no gap is left."""
    shapes, _ = placed_regions(patterns.grid(3, 3, family).drawing.parts)
    assert shapely.area(shapes) == pytest.approx(1.0, abs=1e-12)
    joined = shapely.union_all(shapes, grid_size=1e-9)
    assert joined.area == pytest.approx(9.0, abs=1e-6)
    assert len(joined.interiors) == 0


def test_the_chain_block_of_the_design():
    tail = patterns.chain(2, "swallowtail").drawing.parts[0].regions[0].outer
    wanted = [(-0.5, -0.5), (0.5, -0.5), (0.5, -0.1), (0.25, -0.2), (0.25, 0.2), (0.5, 0.1)]
    wanted += [(0.5, 0.5), (-0.5, 0.5), (-0.5, 0.1), (-0.75, 0.2), (-0.75, -0.2), (-0.5, -0.1)]
    assert np.allclose(tail, wanted, atol=1e-15)
    tee = patterns.chain(2, "tee").drawing.parts[0].regions[0].outer
    assert tee[:, 0].min() == pytest.approx(-0.68)
    assert np.ptp(tee[tee[:, 0] < -0.6][:, 1]) == pytest.approx(0.30)


@pytest.mark.parametrize("family", ["tee", "swallowtail", "dovetail", "revolute", "jigsaw"])
def test_a_joint_holds_straight_pulls(family):
    """Moved out by its depth and more, in small steps, the next block hits the first one."""
    a, b = placed_regions(patterns.chain(2, family, 0.01).parts)[0]
    assert any(a.intersects(shapely.affinity.translate(b, x, 0)) for x in np.linspace(0, 0.3, 61))


def test_roles_names_and_places():
    chain = patterns.chain(4)
    assert [p.fixed for p in chain.parts] == [True, False, False, False]
    assert chain.goals[0].part == "b4"
    assert chain.goals[0].direction == (0.0, 1.0)
    grid = patterns.grid(3, 2, "t", pitch=10, gap=0.1)
    assert grid.names == ("b1-1", "b2-1", "b3-1", "b1-2", "b2-2", "b3-2")
    assert np.allclose(grid.rest[:, :2], [[0, 0], [10, 0], [20, 0], [0, 10], [10, 10], [20, 10]])
    assert grid.goals[0].part == "b3-2"
    frame = patterns.frame(15, 15)
    assert len(frame.parts) == 56
    assert frame.names[0] == "b1-1"
    assert frame.goals[0].part == "b15-15"


def test_jigsaw_pieces_all_differ_and_fit():
    puzzle = patterns.jigsaw(6, 5, gap=0.01, seed=3)
    assert len({p.regions[0].outer.tobytes() for p in puzzle.parts}) == 30
    for distance, beside in clearances(puzzle):
        assert distance == pytest.approx(0.01, abs=1e-12) if beside else distance >= 0.01 - 1e-12
    drawn = shapely.union_all(placed_regions(puzzle.drawing.parts)[0], grid_size=1e-9)
    assert drawn.symmetric_difference(shapely.box(-0.5, -0.5, 5.5, 4.5)).area < 1e-6
    same, other = patterns.jigsaw(6, 5, seed=3), patterns.jigsaw(6, 5, seed=4)
    assert np.array_equal(same.parts[7].regions[0].outer, puzzle.parts[7].regions[0].outer)
    assert not np.array_equal(other.drawing.parts[7].regions[0].outer, puzzle.drawing.parts[7].regions[0].outer)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: patterns.chain(3, "swalowtail"), "choose swallowtail"),
        (lambda: patterns.chain(3, "tee", steam=0.2), 'no size "steam": it has stem, stem_depth'),
        (lambda: patterns.chain(3, "tee", stem=float("nan")), "choose sizes that fit"),
        (lambda: patterns.chain(3, "tee", head=1.4), "choose sizes that fit"),
        (lambda: patterns.chain(3, "revolute", neck=0.5), "choose sizes that fit"),
        (lambda: patterns.chain(3, "finger", fingers=2.5), "whole number"),
        (lambda: patterns.chain(1), "n is 1: it must be at least 2"),
        (lambda: patterns.grid(0, 4), "nx is 0"),
        (lambda: patterns.chain(3, gap=1.2), "vanishes at gap 1.2"),
        (lambda: patterns.chain(3, gap=-0.4), "gap is -0.4"),
        (lambda: patterns.chain(3, pitch=0.0), "outline"),
    ],
)
def test_patterns_that_cannot_be_made(ask, words):
    with pytest.raises(InputError, match=words):
        ask()
