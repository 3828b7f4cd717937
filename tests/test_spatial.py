"""Assemblies in space: the program's derivatives, answers against closed forms, ends and paths against a collision library."""

from __future__ import annotations

import itertools
import json
import re
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from benchmarks import spatial_burrs, spatial_overlaps
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal, Pull, Turn, Weight
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.bodies.rigid import SpatialPose, near_pieces
from wiggleroom.spatial.bodies.rotations import exponential, fixed_axes, logarithm
from wiggleroom.spatial.bodies.spatial_bodies import grouped
from wiggleroom.spatial.planes.separating_plane_program import SeparatingPlanePoint, build_planes
from wiggleroom.spatial.planes.spatial_objectives import Displacement, Nearness, SquaredTravel, SumOfTerms, Twist
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial


def spatial(*parts: dict, **more: object) -> Assembly:
    return assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "parts": list(parts), **more})))


def square(side: float) -> list[list[float]]:
    h = side / 2
    return [[-h, -h], [h, -h], [h, h], [-h, h]]


def ring(count: int, radius: float) -> list[list[float]]:
    angle = 2 * np.pi * np.arange(count) / count
    return (radius * np.column_stack([np.cos(angle), np.sin(angle)])).tolist()


PLATE = {
    "name": "plate",
    "outline": square(40),
    "holes": [square(10.4)],
    "thickness": 12,
    "at": [0, 0, -6],
    "fixed": True,
}
PEG = {"name": "peg", "boxes": [[-5, -5, -20, 5, 5, 20]]}


def sound(answer: Answer) -> Answer:
    assert answer.collision_free
    assert answer.path == "checked"
    return answer


@pytest.mark.parametrize("lock", [[], ["x", "rx"]], ids=["free", "a move and a turn locked"])
@pytest.mark.parametrize(
    "term",
    [
        Displacement(1, np.array([1.0, 2, 3]), np.array([0.3, -1, 2]), np.zeros(3)),
        Twist(1, np.array([0, 0.6, 0.8]), 2.0),
    ],
    ids=["displacement", "twist"],
)
def test_rows_and_objectives_have_the_derivatives_they_say(term: Displacement | Twist, lock: list[str]) -> None:
    bodies = grouped(spatial(PLATE, PEG | {"lock": lock})).bodies
    rng = np.random.default_rng(3)
    P = build_planes(bodies, SumOfTerms((term,)), near_pieces(bodies, bodies.rest, 2.0), length=0.4)
    turn = rng.normal(size=(2, 3)) * 0.4
    turn[1] *= bodies.free[1, 3:]
    pose = SpatialPose(bodies.at + rng.normal(size=(2, 3)) * 0.05, exponential(turn))
    n = P.start.n + 0.1 * rng.normal(size=P.start.n.shape)
    point = SeparatingPlanePoint(pose, n / np.linalg.norm(n, axis=1)[:, None], P.start.d.copy())
    at = P.linearise(point)

    def moved(u: np.ndarray, y: np.ndarray) -> SeparatingPlanePoint:
        from wiggleroom.spatial.planes.plane_fitting import move_planes

        change = at.change(u)
        there = SpatialPose(pose.T + change[:, :3], pose.R @ exponential(change[:, 3:]))
        n, d = np.empty_like(point.n), np.empty_like(point.d)
        move_planes(point.n, point.d, P.lever, P.length * y, 1.0, np.empty((2, 3)), n, d)
        return SeparatingPlanePoint(there, n, d)

    u, y = rng.normal(size=6 - len(lock)), rng.normal(size=(P.planes, 3))
    step = 1e-6
    ahead, back = (P.linearise(moved(s * step * u, s * step * y)) for s in (1, -1))
    assert np.allclose((ahead.h - back.h) / (2 * step), at.along(u, y), atol=1e-6)
    assert np.isclose((ahead.value - back.value) / (2 * step), at.gradient @ u, rtol=1e-6)
    lam = rng.random(P.rows) * (at.h > 0)
    force, moment = at.against(lam)
    assert np.isclose(force @ u + (moment * y).sum(), lam @ at.along(u, y))
    # the second derivative of the Lagrangian along the step, with the planes as they are in it
    far = 1e-3
    lagrangian = [lam @ P.values(moved(s * far * u, s * far * y)) for s in (1, 0, -1)]
    bend = (lagrangian[0] - 2 * lagrangian[1] + lagrangian[2]) / far**2
    zero = np.zeros(P.rows)
    data, inverse, mixed = at.condensed(zero + 1e-12, lam, np.zeros((1, 3)), 0.0)
    own = np.zeros((6, 6))
    k = P.pattern.own[1]
    own[k >= 0] = data[k[k >= 0]]
    own = own + np.triu(own, 1).T
    free = np.flatnonzero(bodies.free[1])
    own = own[np.ix_(free, free)]
    xi = at.seen(u)[0]
    planes = sum(
        (y[j] + inverse[j] @ mixed[j] @ xi) @ np.linalg.solve(inverse[j], y[j] + inverse[j] @ mixed[j] @ xi)
        for j in range(P.planes)
    )
    assert np.isclose(u @ own @ u + planes, -bend, rtol=2e-3, atol=1e-3 * abs(bend))


def test_square_peg_tilts_shifts_and_twists_as_closed_forms_say() -> None:
    assembly = spatial(PLATE, PEG)
    tilt = brentq(lambda a: 10.4 * np.cos(a) - 12 * np.sin(a) - 10, 0, 0.3)
    twist = brentq(lambda a: 10 * (np.cos(a) + np.sin(a)) - 10.4, 0, 0.5)
    assert sound(flex_spatial(assembly, Pull("peg", (1, 0, 0)))).objective == pytest.approx(0.2, abs=1e-7)
    found = sound(flex_spatial(assembly, [Pull("peg", (s, 0, 0), (0, 0, 20.0 * s)) for s in (1, -1)]))
    assert found.verdict == "optimal"
    # pulled apart at both ends the peg also turns about x a little, which the plane does not know
    assert found.objective == pytest.approx(1.31460622, abs=1e-7)
    assert found.objective >= 40 * np.sin(tilt) - 1e-7
    found = sound(flex_spatial(assembly, Turn("peg", (0, 0, 1))))
    assert found.objective >= twist - 1e-9
    locked = spatial(PLATE, PEG | {"lock": ["rx", "ry"]})
    assert sound(flex_spatial(locked, Turn("peg", (0, 0, 1)))).objective == pytest.approx(twist, abs=1e-7)
    assert sound(flex_spatial(locked, Turn("peg", (0, 0, -1)))).motion[1, 5] == pytest.approx(-twist, abs=1e-7)


@pytest.mark.parametrize("count", [6, 24])
def test_a_round_pin_in_a_round_hole_moves_as_its_polygons_say(count: int) -> None:
    pin = {"name": "pin", "outline": ring(count, 5.0), "thickness": 30, "at": [0, 0, -15], "lock": ["rx", "ry", "rz"]}
    assembly = spatial(PLATE | {"holes": [ring(count, 5.2)]}, pin)
    answer = sound(flex_spatial(assembly, Pull("pin", (1, 0, 0))))
    # both polygons have a corner on the x axis, so along x they meet corner to corner: the sides beside it hold
    assert answer.objective == pytest.approx(0.2, abs=1e-6)
    half = np.pi / count
    across = tuple(float(x) for x in (np.cos(half), np.sin(half), 0.0))
    answer = sound(flex_spatial(assembly, Pull("pin", across)))
    # the largest motion along a side's normal is to that side, 0.2 cos(half) away
    assert answer.objective == pytest.approx(0.2 * np.cos(half), abs=1e-6)


def test_motion_without_limit_names_what_leaves() -> None:
    answer = sound(flex_spatial(spatial(PLATE, PEG), Pull("peg", (0, 0, 1))))
    assert answer.verdict == "unbounded"
    assert answer.objective is None
    assert answer.leaves == ("peg",)


def test_a_part_that_nothing_holds_turns_without_limit() -> None:
    axle = {"name": "axle", "outline": ring(48, 5.0), "thickness": 30, "at": [0, 0, -15]}
    answer = sound(flex_spatial(spatial(PLATE, axle), Turn("axle", (0, 0, 1))))
    assert answer.verdict == "unbounded"
    assert answer.turns == ("axle",)


def test_contacts_balance_the_pull() -> None:
    assembly = spatial(PLATE, PEG | {"lock": ["z"]})
    answer = sound(flex_spatial(assembly, Pull("peg", (1, 0.3, 0), (0, 0, 20))))
    assert answer.verdict == "optimal"
    force, moment = np.zeros(3), np.zeros(3)
    pulled = np.array([1, 0.3, 0]) / np.hypot(1, 0.3)
    at = answer.assembly.reference[1] + answer.motion[1, :3]
    grip = at + exponential(answer.motion[1, 3:]) @ (np.array([0, 0, 20.0]) - answer.assembly.reference[1])
    for c in answer.contacts:
        assert c.parts == ("plate", "peg")
        force += c.force * np.array(c.normal)
        moment += np.cross(np.array(c.point) - at, c.force * np.array(c.normal))
    assert np.allclose(force[:2], -pulled[:2], atol=1e-5)
    assert np.allclose(moment, -np.cross(grip - at, pulled), atol=1e-3)


def test_weight_lets_everything_sink() -> None:
    tray = {"name": "tray", "boxes": [[0, 0, 0, 20, 20, 2], [0, 0, 0, 2, 20, 8], [18, 0, 0, 20, 20, 8]], "fixed": True}
    block = {"name": "block", "boxes": [[4, 4, 2.5, 16, 16, 6]], "density": 2.0}
    answer = sound(flex_spatial(spatial(tray, block), Weight((0, 0, -1))))
    assert answer.objective == pytest.approx(2 * 12 * 12 * 3.5 * 0.5, rel=1e-6)


def test_glued_parts_move_as_one_and_ignored_ones_pass() -> None:
    wall = {"name": "wall", "boxes": [[0, 0, 0, 1, 10, 10]], "fixed": True}
    stop = {"name": "stop", "boxes": [[10, 0, 0, 11, 10, 10]], "fixed": True}
    one = {"name": "one", "boxes": [[2, 0, 0, 4, 10, 10]], "lock": []}
    two = {"name": "two", "boxes": [[4, 0, 0, 7, 10, 10]]}
    glued = spatial(wall, stop, one, two, glue=[["one", "two"]])
    answer = sound(flex_spatial(glued, Pull("one", (-1, 0, 0)), search=0))  # further climbs turn them round the wall
    assert np.allclose(answer.motion[2], answer.motion[3])
    free = spatial(wall, stop, one, two, glue=[["one", "two"]], ignore=[["wall", "one"], ["wall", "two"]])
    assert flex_spatial(free, Pull("one", (-1, 0, 0))).verdict == "unbounded"


def test_rotations_are_those_of_scipy() -> None:
    rng = np.random.default_rng(0)
    w = rng.normal(size=(200, 3)) * rng.choice([1e-12, 1e-4, 1.0], (200, 1))
    assert np.allclose(exponential(w), Rotation.from_rotvec(w).as_matrix(), atol=1e-14)
    R = Rotation.random(200, random_state=1)
    assert np.allclose(logarithm(R.as_matrix()), R.as_rotvec(), atol=1e-12)
    assert np.allclose(
        fixed_axes(np.array([20.0, -50, 110])), Rotation.from_euler("xyz", [20, -50, 110], degrees=True).as_matrix()
    )


@pytest.mark.parametrize("angle", [-1e-15, 720.0])
def test_a_turn_that_is_none_but_for_rounding(angle: float) -> None:
    assert np.allclose(fixed_axes(np.array([0.0, 0.0, angle])), np.eye(3), atol=1e-14)


def test_a_turn_is_counted_on_past_half_a_turn() -> None:
    twist = SumOfTerms((Twist(0, np.array([0, 0, 1.0]), 1.0),))
    value = 0.0
    for angle in np.arange(0.0, 12.0, 0.5):
        value = twist.value(SpatialPose(np.zeros((1, 3)), exponential(np.array([[0, 0, angle]]))), value)
        assert value == pytest.approx(angle)


def test_touching_parts_are_named() -> None:
    with pytest.raises(wr.TouchingError, match=r'"a" and "b" touch at rest') as raised:
        flex_spatial(
            spatial(
                {"name": "a", "boxes": [[0, 0, 0, 1, 1, 1]], "fixed": True},
                {"name": "b", "boxes": [[1, 0, 0, 2, 1, 1]]},
            ),
            Pull("b", (1, 0, 0)),
        )
    assert raised.value.parts == ("a", "b")


@pytest.mark.parametrize("family", [spatial_overlaps.burr, spatial_overlaps.pegs, spatial_overlaps.cells])
def test_no_end_and_no_path_overlaps_by_the_collision_library(family) -> None:
    rng = np.random.default_rng(7)
    for _ in range(3):
        drawing, shapes = family(rng)
        name = next(p.name for p in drawing.parts if not p.fixed)
        assembly = assemble_spatial(drawing)
        answer = flex_spatial(assembly, Pull(name, (0.3, -0.5, 0.8)))
        judge = spatial_overlaps.Judge(shapes, assembly.reference, [p.fixed for p in drawing.parts])
        assert judge.depth(answer.motion) < spatial_overlaps.SHALLOW
        for one, other in itertools.pairwise(answer.waypoints):
            assert judge.depth(spatial_overlaps.between(one, other, 0.5)) < spatial_overlaps.SHALLOW


def test_the_checks_see_what_overlaps() -> None:
    from wiggleroom.spatial.overlaps.overlap_check import deepest_overlap
    from wiggleroom.spatial.overlaps.swept_check import SweptCheck

    assembly = spatial(PLATE, PEG)
    rest, into, past = np.zeros((2, 6)), np.zeros((2, 6)), np.zeros((2, 6))
    into[1, 0], past[1, 0] = 0.25, 60.0
    assert deepest_overlap(assembly, rest) == 0
    assert deepest_overlap(assembly, into) == pytest.approx(0.05)
    swept = SweptCheck(assembly)
    assert not swept.overlaps(rest, rest)
    assert swept.overlaps(rest, into)
    assert deepest_overlap(assembly, past) == 0
    assert swept.overlaps(rest, past)  # free at both ends, through the plate between
    spin = np.zeros((2, 6))
    spin[1, 5] = np.pi / 2  # a square looks the same after a quarter turn, but cannot get there
    assert deepest_overlap(assembly, spin) == 0
    assert swept.overlaps(rest, spin)


def test_once_it_was_asked_to_stop_no_path_is_free() -> None:
    from wiggleroom.spatial.overlaps.swept_check import SweptCheck

    blocks = [{"name": n, "boxes": [[x, 0, 0, x + 1, 1, 1]]} for n, x in (("a", 0.0), ("b", 2.2))]
    swept, rest, past, stop = SweptCheck(spatial(*blocks)), np.zeros((2, 6)), np.zeros((2, 6)), threading.Event()
    past[1, :2] = -2.2, 2.2
    assert swept.doubtful(rest, past, stop=stop) == []
    assert swept.room(rest, [1], np.array([-1.0, 0, 0]), 60.0, stop) == pytest.approx(1.2)
    stop.set()
    assert swept.doubtful(rest, past, stop=stop) == [(0, 1)]
    assert swept.room(rest, [1], np.array([-1.0, 0, 0]), 60.0, stop) == 0


def test_a_sweep_in_space_finds_where_the_motion_loses_its_end() -> None:
    # a bar across a slot of 10: from a gap of 2 on its heads, 12 wide, pass through
    bar = {
        "name": "bar",
        "boxes": [[-10, -4, -4, 10, 4, 4], [-10, -6, -4, -8, 6, 4], [8, -6, -4, 10, 6, 4]],
        "lock": ["y", "z", "rx", "ry", "rz"],
    }
    wall = {"name": "wall", "boxes": [[-3, 5, -5, 3, 9, 5], [-3, -9, -5, 3, -5, 5]], "fixed": True}
    found = wr.sweep(spatial(bar, wall), [0.5, 1.0, 1.5], wr.Pull("bar", (1, 0, 0)))
    assert found.lost is not None
    assert found.lost[0] <= 1.0 <= found.lost[1]
    assert found.lost[1] - found.lost[0] <= 2e-3
    assert found.steps[0].objective == pytest.approx(5.5, abs=1e-6)
    assert found.steps[-1].verdict == "unbounded"


def test_a_sweep_in_space_says_what_is_missing() -> None:
    with pytest.raises(wr.InputError, match="nothing is pulled"):
        wr.sweep(spatial(PLATE, PEG), [0.1])


def test_a_question_in_space_needs_a_part_that_is_free() -> None:
    with pytest.raises(wr.InputError, match="everything is fixed"):
        wr.flex(spatial(PLATE | {"fixed": True}, PEG | {"fixed": True}), wr.Pull("peg", (0, 0, 1)))


def test_pulls_of_random_burrs_end_with_a_verdict() -> None:
    rng = np.random.default_rng(11)
    parts = spatial_burrs.random_burr(rng, 3)
    assembly = spatial_burrs.assembled(parts)
    fixed = assemble_spatial(assembly.drawing, fix=["p0"])
    for direction in ((1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0)):
        answer = sound(flex_spatial(fixed, Pull("p1", direction)))
        assert answer.verdict in ("optimal", "unbounded")


def test_the_key_of_a_burr_leaves_across_its_axis_once_it_is_out() -> None:
    from benchmarks.spatial_figures import carried, keyed_burr

    cells = keyed_burr(1)
    # on the grid: the first move of the key is along x only, and out there nothing stops it across
    blocked = {step for step in spatial_burrs.STEPS if 1 in carried(cells, 0, step)}
    assert blocked == {s for s in spatial_burrs.STEPS if s[0] == 0}
    out = [{(x + 12, y, z) for x, y, z in cells[0]}, *cells[1:]]
    assert carried(out, 0, (0, 1, 0)) == {0}
    gap = 0.05
    assembly = assemble_spatial(spatial_burrs.assembled(cells, gap).drawing, fix=("p1",))
    judge = spatial_overlaps.Judge(
        [spatial_overlaps.voxel_judge(v, gap / 2) for v in cells], assembly.reference, [k == 1 for k in range(6)]
    )
    answer = sound(flex_spatial(assembly, Pull("p0", (0, -1, 0))))
    assert answer.verdict == "unbounded"
    assert answer.leaves == ("p0",)
    assert np.abs(answer.waypoints[:, 0, 0]).max() > 2  # it goes along x on its way
    for one, other in itertools.pairwise(answer.waypoints):
        for share in (0.0, 0.5, 1.0):
            assert judge.depth(spatial_overlaps.between(one, other, share)) < spatial_overlaps.SHALLOW


def test_parts_glued_to_what_stands_do_not_end_a_check_with_an_error() -> None:
    base = {"name": "base", "boxes": [[0, 0, 0, 10, 10, 1]], "fixed": True}
    post = {"name": "post", "boxes": [[0, 0, 1, 1, 1, 5]]}
    lid = {"name": "lid", "boxes": [[2, 2, 2, 8, 8, 3]]}
    found = wr.check(spatial(base, post, lid, glue=[["base", "post"]]))
    assert [e.parts for e in found.escapes] == [("lid",)]
    assert found.remains == ("base", "post")


@pytest.mark.parametrize("glue", [[["base", "post"], ["post", "lid"]], [["post", "lid"], ["base", "post"]]])
def test_what_is_glued_to_what_stands_through_others_cannot_be_pulled(glue: list[list[str]]) -> None:
    base = {"name": "base", "boxes": [[0, 0, 0, 10, 10, 1]], "fixed": True}
    post = {"name": "post", "boxes": [[0, 0, 2, 1, 1, 5]]}
    lid = {"name": "lid", "boxes": [[2, 2, 2, 8, 8, 3]]}
    with pytest.raises(wr.InputError, match='"lid" cannot be moved'):
        spatial(base, post, lid, glue=glue, pull=[{"part": "lid", "direction": [0, 0, 1]}])


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (Pull("lid", (0, 1)), 'pull of "lid": direction is (0, 1): in space it must be three numbers'),
        (Pull("lid", (0, 0, 1), (1, 2)), 'pull of "lid": point is (1, 2): in space it must be three numbers'),
        (Turn("lid"), 'turn of "lid": sense is ccw: in space it must be three numbers'),
        (wr.W("lid", (1, 0, 0)), "W is a question about drawings"),
    ],
)
def test_goals_of_drawings_are_refused_in_space(goal: Goal, words: str) -> None:
    base = {"name": "base", "boxes": [[0, 0, 0, 10, 10, 1]], "fixed": True}
    lid = {"name": "lid", "boxes": [[2, 2, 2, 8, 8, 3]]}
    with pytest.raises(wr.InputError, match=re.escape(words)):
        wr.flex(spatial(base, lid), goal)


def test_squared_translations_are_those_of_the_closed_form() -> None:
    """A peg with 0.3 mm of room to every side goes into a corner; at rest there is no derivative."""
    found = sound(wr.flex(spatial(PLATE, PEG | {"lock": ["z"]}, gap=0.1), wr.Translation(weight=0.5)))
    assert found.objective == pytest.approx(0.5 * 2 * 0.3**2, rel=1e-6)
    assert np.abs(found.motion[1, :2]) == pytest.approx([0.3, 0.3], abs=1e-6)
    assert found.search is not None
    assert found.search.starts >= 7


def test_what_leaves_has_no_largest_translation() -> None:
    assert wr.flex(spatial(PLATE, PEG, gap=0.1), wr.Translation()).verdict == "unbounded"


def test_a_second_solver_finds_the_same_translation() -> None:
    pytest.importorskip("casadi")
    found = wr.flex(spatial(PLATE, PEG | {"lock": ["z"]}, gap=0.1), wr.Translation(), solver="ipopt", search=0)
    assert found.objective == pytest.approx(2 * 0.3**2, rel=1e-6)


def test_parts_come_closer_as_the_closed_form_says() -> None:
    """Two bars between walls meet where their squared distances from each other and from the walls' middle are least."""
    walls = [[-20, -20, 0, -10, 20, 10], [10, -20, 0, 20, 20, 10], [-10, -20, 0, 10, -6, 10], [-10, 6, 0, 10, 20, 10]]
    bars = [
        {"name": name, "boxes": [[low, -5, 0, high, 5, 10]], "lock": ["z", "rx", "ry"]}
        for name, low, high in (("left", -8, -3), ("right", 2, 8))
    ]
    assembly = spatial({"name": "walls", "boxes": walls, "fixed": True}, *bars, gap=0.1)
    found = sound(wr.flex(assembly, wr.Closer()))
    assert found.objective == pytest.approx(10.5**2 - 5.4**2 + 5.5**2 + 5.0**2 - 2 * 2.7**2, rel=1e-6)
    assert found.verdict == "optimal"


@pytest.mark.parametrize("seed", range(2))
def test_derivatives_of_squares_are_those_of_differences(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = SpatialPose(rng.normal(size=(2, 3)), exponential(rng.normal(size=(2, 3))))
    terms = (
        SquaredTravel(0, rng.normal(size=3), rng.normal(size=3), 0.7),
        Nearness(0, 1, rng.normal(size=(2, 3)), 3.0, 1.3),
    )
    objective = SumOfTerms(terms)

    def moved(x: np.ndarray) -> SpatialPose:
        step = x.reshape(2, 6)
        return SpatialPose(pose.T + step[:, :3], pose.R @ exponential(step[:, 3:]))

    def value(x: np.ndarray) -> float:
        return objective.value(moved(x))

    step = 1e-4 * np.eye(12)
    gradient = np.array([(value(e) - value(-e)) / 2e-4 for e in step])
    assert objective.gradient(pose).ravel() == pytest.approx(gradient, rel=1e-6, abs=1e-6)
    second = np.array(
        [[(value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / 4e-8 for b in step] for a in step]
    )
    own, both = objective.hessian(pose), objective.coupled(pose)[0]
    assert second[:6, :6] == pytest.approx(own[0], abs=1e-5)
    assert second[6:, 6:] == pytest.approx(own[1], abs=1e-5)
    assert second[:6, 6:] == pytest.approx(both, abs=1e-5)


def test_the_command_asks_for_the_whole_assembly(
    command: Callable[..., int], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.json").write_text(
        json.dumps({"format": "wiggleroom/2", "gap": 0.1, "parts": [PLATE, PEG | {"lock": ["z"]}]})
    )
    assert command("flex", tmp_path / "a.json", "--objective", "translation", "--json", "-") == 0
    assert json.loads(capfd.readouterr().out)["objective"] == pytest.approx(0.18, rel=1e-6)
    assert command("flex", tmp_path / "a.json", "--objective", "closer", "--pull", "peg:+x") == 2
    assert "leave one of them out" in capfd.readouterr().err


def test_a_sweep_in_space_follows_the_closed_form() -> None:
    locked = spatial(PLATE, PEG | {"lock": ["rx", "ry", "rz"]})
    found = wr.sweep(locked, [0.3, 0.0, 0.1], wr.Pull("peg", (1, 0, 0)))
    assert [s.gap for s in found.steps] == [0.0, 0.1, 0.3]
    assert [s.objective for s in found.steps] == pytest.approx([0.2, 0.3, 0.5], abs=1e-7)
    assert all(s.checked and s.verdict == "optimal" for s in found.steps)
    assert found.lost is None


def test_chains_of_plates_locked_in_the_plane_move_as_the_drawing_does() -> None:
    for joint in ("tee", "swallowtail"):
        flat = wr.patterns.chain(10, joint=joint, gap=0.01)
        truth = wr.flex(flat, wr.Pull(flat.names[-1], (0, 1))).objective
        parts = [
            {
                "name": p.name,
                "outline": p.regions[0].outer.tolist(),
                "thickness": 0.4,
                "at": [p.at[0], p.at[1], 0],
                "fixed": p.fixed,
                "lock": ["z", "rx", "ry"],
            }
            for p in flat.drawing.parts
        ]
        answer = sound(
            flex_spatial(
                spatial(*parts, gap=0.01), Pull(flat.names[-1], (0, 1, 0), (*flat.drawing.parts[-1].at[:2], 0.2))
            )
        )
        assert answer.objective == pytest.approx(truth, abs=1e-6)
        assert answer.iterations <= 30
