"""The models hull and halfplane against closed forms, sampled collision and the dynamic programme of chains."""

from __future__ import annotations

import json

import numpy as np
import pytest
import scipy.sparse as sp
import shapely

import wiggleroom as wr
from tests.audit import part, reachable
from tests.oracle.blocks import block, outline
from tests.oracle.chain import stored
from tests.oracle.collision import overlaps as collide
from tests.test_program import close, slope, steps, whole
from wiggleroom.assembly.build import assemble
from wiggleroom.compare.approximate import approximate
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.freespace.models.halfplane import half_planes
from wiggleroom.freespace.models.hull import _ball, pair_hull
from wiggleroom.freespace.slices import pair_outlines
from wiggleroom.geometry.row_kinds import FACE
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import objective
from wiggleroom.solve.linear_programming import maximise


def outline_of(assembly: wr.Assembly, index: int, motion: np.ndarray) -> np.ndarray:
    """Corners of a part moved about its centroid."""
    x, y, angle = assembly.parts[index].at
    c, s = np.cos(angle), np.sin(angle)
    ring = assembly.parts[index].regions[0].outer @ np.array([[c, s], [-s, c]]) + (x, y)
    middle = np.array(shapely.Polygon(ring).centroid.coords[0])
    c, s = np.cos(motion[2]), np.sin(motion[2])
    return (ring - middle) @ np.array([[c, s], [-s, c]]) + middle + motion[:2]


def box(x0: float, y0: float, x1: float, y1: float) -> shapely.Polygon:
    return shapely.box(x0, y0, x1, y1)


def chain(joint: str, gap: float, n: int, angle: float = 0.0) -> wr.Assembly:
    """Blocks of the oracle in a row, the whole turned by `angle`, each outline stored in a turned frame of its own."""
    c, s = np.cos(angle), np.sin(angle)
    parts = []
    for k in range(n):
        own = 0.4 * k * (angle != 0)
        turned = outline(joint) @ np.array([[np.cos(own), np.sin(own)], [-np.sin(own), np.cos(own)]])
        at = (7 * angle + k * c, -3 * angle + k * s, angle - own)
        parts.append(Part(f"b{k + 1}", (Region(turned),), at, fixed=k == 0))
    return assemble(Drawing(tuple(parts), gap=gap, goals=(wr.Pull(f"b{n}", (-s, c)),)))


PEG = pair_outlines(box(-3, -3, 3, 3) - box(-1, -1, 1, 1), box(-0.9, -0.9, 0.9, 0.9))


def test_hull_of_a_square_peg_is_two_pyramids() -> None:
    hull = pair_hull(PEG, wr.Hull(), 1.0)
    assert hull is not None
    turn = np.arcsin(1 / (0.9 * np.sqrt(2))) - np.pi / 4  # 0.9 (cos + sin) = 1
    assert hull.ends == pytest.approx((-turn, turn), abs=1e-6)
    random = np.random.default_rng(0)
    g = random.uniform((-0.12, -0.12, -1.1 * turn), (0.12, 0.12, 1.1 * turn), (2000, 3))
    inside = (g @ hull.normal.T + hull.offset <= 0).all(1)
    wanted = np.abs(g[:, :2]).max(1) <= 0.1 * (1 - np.abs(g[:, 2]) / turn)
    assert (inside == wanted).mean() > 0.999


def test_turning_about_the_joint_reaches_further() -> None:
    for name in ("tee", "hook"):
        pair = chain(name, 0.01, 2, 0.6)
        ends = [wr.free_space(pair, "b1", "b2", model=wr.Hull(about)).angles for about in ("reference", "joint")]
        whole_range = wr.free_space(pair, "b1", "b2").angles
        assert whole_range[0] < ends[1][0] < ends[0][0] < 0 < ends[0][1] < ends[1][1] < whole_range[1]


@pytest.mark.parametrize(("joint", "angle"), [("tee", 0.7), ("hook", 0.0)])
def test_pair_models_against_sampled_collision(joint: str, angle: float) -> None:
    pair, body, D = chain(joint, 0.01, 2, angle), block(joint, 0.01), np.array([1.0, 0.0])
    walls = wr.free_space(pair, "b1", "b2")
    boxes = shapely.bounds([s.region for s in walls.slices])
    low, high = (*boxes[:, :2].min(0), walls.angles[0]), (*boxes[:, 2:].max(0), walls.angles[1])
    samples = np.random.default_rng(1).uniform(low, high, (20000, 3))
    # the pair may lie turned: the models speak of part a's own frame, the oracle of unturned blocks
    free = ~collide(body, body, samples, D) & reachable(walls, samples)
    for model, least, unsafe in (
        (wr.Hull(), 0.94, 0.005),
        (wr.Hull(slices=21), 0.99, 0.005),
        (wr.HalfPlane(), 0.97, 0.01),
    ):
        found = wr.free_space(pair, "b1", "b2", model=model).contains(samples)
        assert (found == free).mean() > least
        assert (found & ~free).mean() < unsafe


@pytest.mark.slow
@pytest.mark.parametrize(("joint", "gap"), [("swallowtail", 0.01)])
def test_chains_against_the_true_optimum(joint: str, gap: float) -> None:
    made, (best, _) = chain(joint, gap, 10), stored(joint, gap, 10)
    value = {
        model: wr.flex(made, model=model, search=0).objective / best
        for model in (wr.Hull(), wr.Hull("joint"), wr.Hull(slices=41), wr.Hull("joint", rounds=8), wr.HalfPlane())
    }
    assert 0.3 < value[wr.Hull()] < value[wr.Hull("joint")] < 0.8
    assert value[wr.Hull(slices=41)] == pytest.approx(1, abs=5e-3)
    assert value[wr.Hull("joint")] + 0.1 < value[wr.Hull("joint", rounds=8)] < 1 + 1e-6
    assert value[wr.HalfPlane()] == pytest.approx(1, abs=1e-5)


def test_a_short_chain_against_the_true_optimum() -> None:
    made, (best, _) = chain("swallowtail", 0.02, 5), stored("swallowtail", 0.02, 5)
    share = [
        wr.flex(made, model=m, search=0).objective / best
        for m in ("hull", wr.Hull("joint"), wr.Hull(slices=21), "halfplane")
    ]
    assert 0.3 < share[0] < share[1] < 0.8
    assert share[2:] == pytest.approx([1, 1], abs=2e-3)


def test_hull_by_both_solvers() -> None:
    pytest.importorskip("casadi")
    made = wr.patterns.jigsaw(2, 3, seed=4)
    ours, theirs = (wr.flex(made, model="hull", solver=s) for s in ("interior-point", "ipopt"))
    assert ours.objective == pytest.approx(theirs.objective, rel=1e-6)
    assert ours.verdict == theirs.verdict == "stationary"


SLOT = box(-3, -3, 3, 3) - box(-1, 0, 1, 4)


@pytest.mark.parametrize("slices", [3, 7])
def test_open_pair_is_followed_as_a_strip(slices: int) -> None:
    pair = pair_outlines(SLOT, box(-0.95, 0.05, 0.95, 2))
    hull = pair_hull(pair, wr.Hull(slices=slices), reach=5.0)
    assert hull is not None
    assert not hull.closed
    middle = min(hull.slices, key=lambda s: abs(s.angle)).region
    assert shapely.area(shapely.symmetric_difference(middle, box(-0.05, -0.05, 0.05, 5))) < 1e-9
    spots = np.random.default_rng(0).uniform(*np.reshape(middle.bounds, (2, 2)), (200, 2))
    moved = [shapely.affinity.translate(pair.material[1], *(0.999 * spot)) for spot in spots]
    assert not shapely.intersects(pair.material[0], moved).any()


def test_one_linear_program_at_rest_promises_what_it_cannot_keep() -> None:
    made = wr.patterns.grid(4, 4, gap=0.02)
    once, often, walls = (
        wr.flex(made, model=m, search=0) for m in (wr.HalfPlane(iterated=False), "halfplane", "walls")
    )
    assert not once.collision_free
    assert once.deepest_overlap > 1e-4
    assert often.objective == pytest.approx(walls.objective, rel=2e-3)
    assert often.deepest_overlap < 1e-6


def test_both_linear_solvers_agree() -> None:
    pytest.importorskip("piqp")
    random = np.random.default_rng(5)
    rows = sp.csr_matrix(random.normal(size=(60, 12)))
    cost, least, bound = random.normal(size=12), -random.uniform(0.1, 1, 60), random.uniform(0.5, 2, 12)
    values = []
    for solver in ("piqp", "highs"):
        x = maximise(cost, rows, least, bound, solver).x
        assert x is not None
        assert (rows @ x >= least - 1e-7).all()
        assert (np.abs(x) <= bound + 1e-7).all()
        values.append(cost @ x)
    assert values[0] == pytest.approx(values[1], abs=1e-6)


def test_a_part_that_nothing_holds_leaves_by_every_model() -> None:
    made = assemble(
        Drawing(
            (part("a", box(-1, -1, 1, 1), fixed=True), part("b", box(-1, -1, 1, 1), (2.1, 0.0, 0.0))),
            goals=(wr.Pull("b", (1.0, 0.0)),),
        )
    )
    for model in ("walls", "hull", "halfplane", wr.HalfPlane(iterated=False)):
        answer = wr.flex(made, model=model, search=0)
        assert answer.verdict == "unbounded", model
        assert answer.objective is None
        assert answer.leaves == ("b",)


def test_wrong_models_are_refused() -> None:
    made = wr.patterns.chain(2)
    with pytest.raises(wr.InputError, match='no model "hulls": choose walls, hull, halfplane'):
        wr.flex(made, model="hulls", search=0)
    with pytest.raises(wr.InputError, match='no model "3"'):
        wr.flex(made, model=3, search=0)
    with pytest.raises(wr.InputError, match="3 or more"):
        wr.Hull(slices=2)
    with pytest.raises(wr.InputError, match="leave the solver out"):
        wr.flex(made, model="halfplane", solver="ipopt")
    with pytest.raises(wr.InputError, match="only the model walls"):
        wr.flex(made, model="hull", start=wr.flex(made, search=0))


def ring_and_peg() -> wr.Assembly:
    ring, peg = box(-3, -3, 3, 3) - box(-1, -1, 1, 1), box(-0.98, -0.98, 0.98, 0.98)
    return assemble(Drawing((part("ring", ring, fixed=True), part("peg", peg))))


@pytest.mark.parametrize("model", ["walls", "hull", "halfplane"])
def test_sum_of_squares_leaves_rest_for_a_corner(model: str) -> None:
    answer = wr.flex(ring_and_peg(), wr.Translation(), model=model, search=0)
    assert answer.objective == pytest.approx(2 * 0.02**2, rel=1e-4)
    assert np.abs(answer.motion[1, :2]) == pytest.approx(0.02, rel=1e-4)


def test_objective_of_the_whole_in_a_file(tmp_path) -> None:
    text = {
        "format": "wiggleroom/1", "objective": "translation", "gap": 0.04,
        "parts": [
            {"name": "ring", "outline": [[-3, -3], [3, -3], [3, 3], [-3, 3]], "fixed": True,
             "holes": [[[-1, -1], [-1, 1], [1, 1], [1, -1]]]},
            {"name": "peg", "outline": [[-1, -1], [1, -1], [1, 1], [-1, 1]]},
        ],
    }  # fmt: skip
    file = tmp_path / "peg.json"
    file.write_text(json.dumps(text))
    assembly = wr.read(file)
    assert assembly.goals == (wr.Translation(),)
    assert wr.flex(assembly, search=0).objective == pytest.approx(2 * 0.04**2, rel=1e-4)

    from wiggleroom.drawing.readers.assembly_file import read_assembly
    from wiggleroom.drawing.writers.assembly_writer import write_assembly

    assert read_assembly(write_assembly(assembly.drawing)).goals == (wr.Translation(),)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_ball_of_lemma_1_is_not_halved_where_a_corner_is_nearest(angle: float, mirrored: bool) -> None:
    # the other block stands beside the first one, its lower side in line with the upper one: that line runs through rest
    blocks = box(0, 0, 1, 1), box(1.5, 1, 2.5, 2)
    blocks = tuple(shapely.affinity.scale(b, -1 if mirrored else 1, 1, origin=(0, 0)) for b in blocks)
    blocks = tuple(shapely.affinity.rotate(b, angle, origin=(0, 0), use_radians=True) for b in blocks)
    ball = _ball(pair_outlines(*blocks), 0.0, np.zeros(2), 3.0)
    assert ball.area == pytest.approx(np.pi * 0.5**2, rel=0.01)  # all the way to the corner
    for x, y in 0.999 * shapely.get_coordinates(ball):
        assert not shapely.intersects(blocks[0], shapely.affinity.translate(blocks[1], x, y))


def test_figures_of_the_paper_model_on_chains() -> None:
    # worked out once by an independent prototype: blocks turned about their centres
    for joint, gap, wanted in (("swallowtail", 0.01, 0.642), ("swallowtail", 0.02, 1.285), ("tee", 0.01, 0.695)):
        assert wr.flex(chain(joint, gap, 10), model="hull").objective == pytest.approx(wanted, abs=1.5e-3)


def test_faces_in_a_program_have_exact_derivatives() -> None:
    made = chain("hook", 0.02, 4, 0.5)
    ready = approximate(made, wr.Hull("joint"))
    of = build_program(ready.bodies, ready.faces, objective(made, ready.bodies, made.goals), length=ready.clearance)
    assert (of.geometry.kind == FACE).all()
    random = np.random.default_rng(3)
    motion = np.zeros((4, 3))
    motion[of.free] = random.uniform(-0.3, 0.3, (3, 3))
    u, lam = of.variables(motion), random.uniform(0, 2, of.rows)
    at = of.linearise(u)
    close(at.jacobian().toarray(), slope(of.values, u, steps(of)), 1e-8)
    curved = slope(lambda v: of.linearise(v).transposed_jacobian_product(lam) + of.linearise(v).gradient, u, steps(of))
    close(whole(of, at.condensed(np.zeros(of.rows), lam)), -curved, 1e-8)


def test_half_planes_are_distances_and_their_derivatives() -> None:
    made = chain("tee", 0.01, 2)
    ready = approximate(made, wr.HalfPlane())
    there = np.array([[0.0, 0, 0], [0.003, -0.002, 0.004]])
    here = half_planes(ready.bodies, *ready.near, there, 0.05)
    step = np.array([2e-7, -3e-7, 2e-7])
    after = half_planes(ready.bodies, *ready.near, there + np.array([np.zeros(3), step]), 0.05)
    assert len(here.offset) == len(after.offset) > 20
    g = (after.rest - here.rest)[here.pair]
    np.testing.assert_allclose(-after.offset, -here.offset - (here.normal * g).sum(1), atol=1e-12)
    corners = outline_of(made, 1, there[1])
    walls = shapely.LinearRing(outline_of(made, 0, there[0]))
    nearest = min(walls.distance(shapely.Point(p)) for p in corners)
    assert -here.offset.max() == pytest.approx(nearest, abs=1e-12)


def test_extension_that_takes_in_forbidden_space_is_discarded() -> None:
    # a bar rests above a floor; a post stands in the strip over it, further away than what counts as nearby
    floor = box(-3, -3, 3, 0) | box(0.9, 0, 1.1, 2)
    pair = pair_outlines(floor, box(-0.5, 0.1, 0.5, 0.6))
    hull = pair_hull(pair, wr.Hull(), reach=3.0)
    assert hull is not None
    middle = hull.slices[1].region
    for x, y in shapely.get_coordinates(middle) * 0.999:
        assert not shapely.intersects(pair.material[0], shapely.affinity.translate(pair.material[1], x, y))
    assert np.hypot(*shapely.get_coordinates(middle).T).max() < 0.6  # the ball of Lemma 1, not the window
