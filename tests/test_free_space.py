"""Free spaces: nothing that overlaps is accepted, hardly anything that can be reached is refused."""

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.audit import as_assembly, audit, part, polygon
from tests.oracle.geometry import turn
from tests.oracle.random_joints import peg_pair, tab_pair
from tests.oracle.slices import Slices
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.free_space import free_space

FAMILIES = ["tee", "swallowtail", "dovetail", "revolute", "finger", "jigsaw"]
MAX_LOST = 0.005


def family(name, below=False, gap=0.01):
    """Assembly of two neighbours and their names."""
    if below:
        return wr.patterns.grid(1, 2, name, gap), ("b1-1", "b1-2")
    return wr.patterns.chain(2, name, gap), ("b1", "b2")


def audited(assembly, names, samples):
    space = free_space(assembly, *names)
    found = audit(space, *(polygon(p) for p in assembly.parts), np.array(assembly.parts[1].at[:2]), samples)
    assert found.free > 0.02 * samples  # the box is not empty
    assert found.unsafe == 0
    assert found.lost <= MAX_LOST * found.free
    assert space.coverage >= 0.998
    return space


@pytest.mark.parametrize(("name", "below"), [(name, bool(k % 2)) for k, name in enumerate(FAMILIES)])
def test_families(name, below):
    space = audited(*family(name, below), 50_000)
    assert space.closed == (name != "finger")
    assert space.rows == space.cells.is_wall.sum()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("make", [tab_pair, peg_pair])
def test_random_pairs(make, seed):
    audited(as_assembly(make(seed)), "ab", 20_000)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("make", [tab_pair, peg_pair])
def test_random_pairs_with_holes(make, seed):
    audited(as_assembly(make(seed, holes=True)), "ab", 20_000)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 13))
@pytest.mark.parametrize("make", [tab_pair, peg_pair])
def test_more_random_pairs(make, seed):
    audited(as_assembly(make(seed, gap=0.02, holes=seed % 2 == 0)), "ab", 200_000)


def moved(shape, at, motion):
    """Material given in its own frame, after `motion` from the pose `at`."""
    pose = np.asarray(at) + motion
    return shapely.transform(shape, lambda p: p @ turn(pose[2]).T + pose[:2])


def contract_motion(at_a, at_b, move_a, move_b):
    """tau = R(theta_A)^T (T_B - T_A) less the same at rest; phi = turn of B less turn of A."""
    a, b = np.add(at_a, move_a), np.add(at_b, move_b)
    tau = turn(a[2]).T @ (b[:2] - a[:2]) - turn(at_a[2]).T @ np.subtract(at_b, at_a)[:2]
    return [*tau, move_b[2] - move_a[2]]


def in_frame(shape, at):
    """A shape that lies in the assembly, in the frame of a part at `at`."""
    return shapely.transform(shape, lambda p: (p - at[:2]) @ turn(at[2]))


def near_motions(space, at_a, at_b, count, rng):
    """World motions of both parts whose relative motion is about as large as the free space."""
    low = np.array([*np.min([s.region.bounds[:2] for s in space.slices], 0), space.angles[0]])
    high = np.array([*np.max([s.region.bounds[2:] for s in space.slices], 0), space.angles[1]])
    for tau_x, tau_y, phi in rng.uniform(low, high, (count, 3)):
        move_a = rng.uniform(-2, 2, 3)
        angle = at_a[2] + move_a[2]
        apart = turn(at_a[2]).T @ np.subtract(at_b, at_a)[:2] + [tau_x, tau_y]
        move_b = np.add(at_a, move_a)[:2] + turn(angle) @ apart - np.asarray(at_b)[:2]
        yield move_a, np.array([*move_b, move_a[2] + phi])


def test_parts_in_turned_frames_and_glued_bodies_against_placed_shapes():
    """Frames at odd places and angles, both parts moved: what is accepted agrees with shapes placed in the world."""
    pair, rng = tab_pair(3, gap=0.04), np.random.default_rng(5)
    left, right = pair.made
    at = {"a": (0.4, -0.3, 0.8), "b": (1.2, 0.3, -2.1), "c": (-0.2, 0.6, 2.5), "d": (1.0, -0.9, 1.1)}
    # the pieces that meet are c and d; a and b are lids on their far sides
    lids = {"a": shapely.box(-0.7, -0.4, -0.45, 0.4), "b": shapely.box(1.44, -0.4, 1.7, 0.4)}
    world = {**lids, "c": left, "d": right}
    parts = tuple(part(k, in_frame(g, at[k]), at[k]) for k, g in world.items())
    assembly = assemble(Drawing(parts, glue=(("a", "c"), ("d", "b"))))
    space = free_space(assembly, "a", "b")
    sides = [["a", "c"], ["b", "d"]]
    bodies = [in_frame(shapely.union_all([world[k] for k in side]), at[side[0]]) for side in sides]
    moves = list(near_motions(space, at["a"], at["b"], 12_000, rng))
    relative = np.array([contract_motion(at["a"], at["b"], *m) for m in moves])
    accepted = space.contains(relative)
    free = np.array([not moved(bodies[0], at["a"], m).intersects(moved(bodies[1], at["b"], n)) for m, n in moves])
    assert accepted.sum() > 200
    assert not (accepted & ~free).any()
    side_b = shapely.transform(bodies[1], lambda p: p @ turn(at["b"][2] - at["a"][2]).T)
    truth = Slices(bodies[0], side_b, turn(at["a"][2]).T @ np.subtract(at["b"], at["a"])[:2])
    refused = relative[free & ~accepted]  # free, but are they connected to rest?
    lost = sum(shapely.intersects_xy(f, x, y) for x, y, phi in refused for f in truth.at(phi))
    assert lost <= MAX_LOST * free.sum()


def test_square_peg_is_a_box_of_known_size():
    ring = shapely.box(-2, -2, 2, 2).difference(shapely.box(-1, -1, 1, 1))
    assembly = assemble(Drawing((part("ring", ring), part("peg", shapely.box(-0.9, -0.9, 0.9, 0.9)))))
    space = free_space(assembly, "ring", "peg")
    inside, outside = 0.1 - 1e-9, 0.1 + 1e-9
    corners = [[inside, inside, 0], [-inside, inside, 0], [outside, 0, 0], [0, -outside, 0], [np.nan, 0, 0]]
    assert space.contains(np.array(corners)).tolist() == [True, True, False, False, False]
    assert space.contains(np.zeros((0, 3))).shape == (0,)


def test_order_of_parts_can_be_turned_round():
    """Seen from the other part the same motions are free."""
    assembly = wr.patterns.chain(2, "tee", 0.01)
    there, back = free_space(assembly, "b1", "b2"), free_space(assembly, "b2", "b1")
    assert back.angles == pytest.approx((-there.angles[1], -there.angles[0]), abs=1e-6)
    relative = np.random.default_rng(2).uniform([-0.015, -0.02, -0.03], [0.015, 0.02, 0.03], (5000, 3))
    apart = np.array(assembly.parts[1].at[:2])
    inverse = [[*(turn(-p) @ -np.add(apart, (x, y)) + apart), -p] for x, y, p in relative]
    same = there.contains(relative) == back.contains(np.array(inverse))
    assert same.mean() > 0.998


def test_open_pairs_keep_to_a_window():
    assembly = wr.patterns.grid(2, 2, "tee", 0.02)
    space = free_space(assembly, "b1-1", "b2-2")
    assert not space.closed
    assert 0 < space.reach < 1
    assert space.contains(np.zeros((1, 3)))[0]
    assert not space.contains(np.array([[2 * space.reach, 0, 0]]))[0]
    assert space.coverage > 0.99


def test_parts_far_apart_turn_all_the_way():
    square = shapely.box(-0.5, -0.5, 0.5, 0.5)
    assembly = assemble(Drawing((part("a", square), part("b", square, (9.0, 0.0, 0.0)))))
    space = free_space(assembly, "a", "b")
    assert space.contains(np.array([[0, 0, 3.0], [0, 0, -3.0], [0, 0, 6.0], [0.1, 0.1, 40.0]])).all()


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("a", "x"), 'no part "x"'),
        (("a", "a"), "named twice"),
        (("a", "c"), "glued"),
        (("a", "d"), "never collide"),
        (("a", "e"), "touch at rest"),
    ],
)
def test_questions_without_an_answer(names, words):
    square = shapely.box(0, 0, 1, 1)
    places = {"a": (0, 0, 0), "b": (3, 0, 0), "c": (0, 3, 0), "d": (6, 0, 0), "e": (-1, 0, 0)}
    parts = tuple(part(k, square, at) for k, at in places.items())
    assembly = assemble(Drawing(parts, glue=(("a", "c"),), ignore=(("d", "c"), ("d", "a"))))
    with pytest.raises(wr.InputError, match=words):
        free_space(assembly, *names)
    assert free_space(assembly, "b", "d").coverage > 0.99


@pytest.mark.parametrize("model", ["hulls"])
def test_other_models(model):
    with pytest.raises(wr.InputError, match="choose walls"):
        free_space(wr.patterns.chain(2), "b1", "b2", model=model)


def test_open_spaces_are_worked_out_as_far_as_asked():
    wedge = wr.patterns.chain(2, "swallowtail", 0.02, neck=0.4, end=0.3)
    space = free_space(wedge, "b1", "b2", reach=0.4)
    found = audit(space, *(polygon(p) for p in wedge.parts), np.array(wedge.parts[1].at[:2]), 20_000)
    assert space.reach == 0.4
    assert found.unsafe == 0
    assert found.lost <= MAX_LOST * found.free
    assert space.contains(np.array([[0.39, 0.0, 0.0], [0.41, 0.0, 0.0]])).tolist() == [True, False]


@pytest.mark.parametrize("reach", [0.0, np.nan])
def test_a_reach_that_is_no_length_is_refused(reach):
    with pytest.raises(wr.InputError, match="reach"):
        free_space(wr.patterns.chain(2, "finger"), "b1", "b2", reach=reach)
