"""Any freedoms of a part may be locked: against closed forms, against sampled collisions, and along the whole way."""

from __future__ import annotations

import itertools
import sys

import fcl
import numpy as np
import pytest
from benchmarks import spatial_overlaps
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from tests.test_spatial import PEG, PLATE, sound, spatial, square
from wiggleroom.drawing.model import Pull, Turn
from wiggleroom.errors import InputError, MissingExtraError
from wiggleroom.spatial.spatial_flex import flex_spatial

AXES = ("x", "y", "z", "rx", "ry", "rz")
ARM = [[-3, -3, -3, 3, 3, 3], [3, -1, -1, 20, 1, 1]]
POSTS = [
    {"name": "right", "boxes": [[10, 2.5, -30, 12, 4.5, 30]], "fixed": True},
    {"name": "left", "boxes": [[14, -6, -30, 16, -4, 30]], "fixed": True},
    {"name": "above", "boxes": [[15, -30, 3.5, 18, 30, 5]], "fixed": True},
    {"name": "below", "boxes": [[8, -30, -5, 9, 30, -2.5]], "fixed": True},
]


@pytest.mark.parametrize(
    ("moves", "turns"),
    [
        *(((), turns) for turns in ((), ("ry",), ("rx", "rz"), ("rx", "ry", "rz"))),
        (("x",), ("ry",)),
        (("y", "z"), ("rx", "rz")),
    ],
    ids=str,
)
def test_a_lock_holds_along_the_whole_path(moves: tuple[str, ...], turns: tuple[str, ...]) -> None:
    lock = [*moves, *turns]
    assembly = spatial(PLATE, PEG | {"lock": lock})
    rng = np.random.default_rng(len(lock))
    goal = Pull("peg", tuple(rng.normal(size=3)) if "z" in moves else (*rng.normal(size=2), 0.0), (5, 5, 20))
    answer = flex_spatial(assembly, goal)
    assert answer.collision_free
    held = [k for k, axis in enumerate(AXES) if axis in lock]
    for one, other in itertools.pairwise(answer.waypoints[:, 1]):
        start, end = Rotation.from_rotvec(one[3:]), Rotation.from_rotvec(other[3:])
        for share in (0.0, 0.3, 0.7, 1.0):
            turn = (start * Rotation.from_rotvec(share * (start.inv() * end).as_rotvec())).as_rotvec()
            between = np.concatenate([one[:3] + share * (other[:3] - one[:3]), turn])
            assert np.abs(between[held]).max(initial=0.0) < 1e-12
    if answer.verdict == "optimal":
        freer = flex_spatial(spatial(PLATE, PEG | {"lock": lock[:-1]}), goal) if lock else answer
        assert freer.objective is None or freer.objective >= answer.objective - 1e-7


def test_a_peg_that_may_not_tilt_about_one_axis_moves_as_closed_forms_say() -> None:
    tilt = brentq(lambda a: 10 / np.cos(a) + 12 * np.tan(a) - 10.4, 1e-4, 0.3)
    twist = brentq(lambda a: 10 * (np.cos(a) + np.sin(a)) - 10.4, 1e-3, 0.3)
    assembly = spatial(PLATE, PEG | {"lock": ["rx"]})
    assert sound(flex_spatial(assembly, Turn("peg", (0, 1, 0)))).objective == pytest.approx(tilt, abs=1e-7)
    assert sound(flex_spatial(assembly, Turn("peg", (0, 0, -1)))).objective == pytest.approx(twist, abs=1e-7)
    about_locked = sound(flex_spatial(assembly, Turn("peg", (1, 0, 0))))
    assert (about_locked.verdict, about_locked.objective) == ("optimal", pytest.approx(0.0, abs=1e-9))


class Arm:
    """The arm about its reference point, judged by a collision library; rotation vectors are across x."""

    def __init__(self, reference: np.ndarray) -> None:
        self.reference = reference
        self.mine = [self._box(b) for b in ARM]
        self.posts = [fcl.CollisionObject(*self._box(p["boxes"][0], np.zeros(3))) for p in POSTS]

    def _box(self, box: list[float], about: np.ndarray | None = None) -> tuple[fcl.Box, fcl.Transform]:
        low, high = np.array(box[:3], float), np.array(box[3:], float)
        middle = (low + high) / 2 - (self.reference if about is None else about)
        return fcl.Box(*(high - low)), fcl.Transform(np.eye(3), middle)

    def free(self, turn: np.ndarray) -> bool:
        R = Rotation.from_rotvec(turn).as_matrix()
        for shape, at in self.mine:
            moved = fcl.CollisionObject(shape, fcl.Transform(R, R @ at.getTranslation() + self.reference))
            if any(fcl.collide(moved, post, fcl.CollisionRequest(), fcl.CollisionResult()) for post in self.posts):
                return False
        return True

    def best(self, direction: np.ndarray, point: np.ndarray) -> float:
        """Largest displacement of a point among the rotations that a flood from rest reaches, then nearer and nearer to it."""

        def value(turn: np.ndarray) -> float:
            R = Rotation.from_rotvec(turn).as_matrix()
            return float(direction @ (R @ (point - self.reference) + self.reference - point))

        step, start = 0.02, (0, 0)
        seen, todo = {start}, [start]
        while todo:
            j, k = todo.pop()
            for near in ((j + 1, k), (j - 1, k), (j, k + 1), (j, k - 1)):
                if near not in seen and max(map(abs, near)) < 60 and self.free(np.array([0, *np.multiply(step, near)])):
                    seen.add(near)
                    todo.append(near)
        middle = max((np.array([0, *np.multiply(step, at)]) for at in seen), key=value)
        while step > 1e-5:
            around = [middle + step * np.array([0, j, k]) for j, k in itertools.product(range(-12, 13), repeat=2)]
            middle = max((t for t in around if self.free(t)), key=value)
            step *= 0.6
        return value(middle)


@pytest.mark.parametrize("seed", range(2))
def test_an_arm_that_may_not_roll_reaches_what_sampling_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    arm = {"name": "arm", "boxes": ARM, "lock": ["x", "y", "z", "rx"]}
    assembly = spatial(*POSTS, arm)
    direction, point = rng.normal(size=3) * [0.2, 1, 1], rng.uniform([-3, -3, -3], [20, 3, 3])
    direction /= np.linalg.norm(direction)
    answer = sound(flex_spatial(assembly, Pull("arm", tuple(direction), tuple(point))))
    assert answer.verdict == "optimal"
    assert abs(answer.motion[4, 3]) < 1e-12
    assert answer.objective == pytest.approx(Arm(assembly.reference[4]).best(direction, point), abs=2e-4)


def test_ipopt_says_the_same_of_locked_parts() -> None:
    pytest.importorskip("casadi")
    rng = np.random.default_rng(10)
    lock = [str(rng.choice(AXES[3:])), "z"]
    assembly = spatial(PLATE, PEG | {"lock": lock})
    goal = Pull("peg", tuple(rng.normal(size=3)), tuple(rng.uniform(-5, 5, 3) * [1, 1, 4]))
    ours, theirs = (wr.flex(assembly, goal, solver=s) for s in ("interior-point", "ipopt"))
    assert ours.objective == pytest.approx(theirs.objective, rel=1e-6)


def test_what_turns_without_limit_does_so_about_what_is_left_free() -> None:
    pin = {"name": "pin", "boxes": [[-2, -2, -4, 2, 2, 4]], "lock": ["x", "y", "z", "rx"]}
    assert wr.flex(spatial(PLATE, pin), wr.Turn("pin", (0, 0, 1))).turns == ("pin",)
    leaning = {"name": "pin", "boxes": [[-2, -2, -4, 2, 2, 4]], "lock": ["x", "y", "z", "rx", "ry"]}
    assert wr.flex(spatial(PLATE, leaning), wr.Turn("pin", (0.6, 0, 0.8))).turns == ("pin",)


def test_a_lock_decides_whether_a_part_can_be_taken_out() -> None:
    # a cap that only moves along z: locked there, it stays
    cap = {"name": "cap", "boxes": [[-4, -4, 0, 4, 4, 2], [-1, -1, -3, 1, 1, 0]]}
    floor = {
        "name": "floor",
        "outline": square(12),
        "holes": [square(2.2)],
        "thickness": 2,
        "at": [0, 0, -2.1],
        "fixed": True,
    }
    assert wr.check(spatial(floor, cap | {"lock": ["ry"]})).verdict == "comes apart"
    held = wr.check(spatial(floor, cap | {"lock": ["z", "ry"]}))
    assert held.verdict == "interlocked"


@pytest.mark.parametrize("fully", [False, True])
def test_locked_parts_side_by_side_are_held(fully: bool) -> None:
    # each block only tips about x, and the plate below is in the way
    plate = {"name": "plate", "boxes": [[0, 0, 0, 30, 30, 5]], "fixed": True}
    tips = ["x", "y", "z", "ry", "rz"]
    blocks = [{"name": f"b{x}", "boxes": [[x, 10, 5.1, x + 8, 20, 10]], "lock": tips} for x in (2, 10.1)]
    still = {"name": "still", "boxes": [[18.2, 10, 5.1, 26, 20, 10]], "lock": list(AXES)}
    held = wr.check(spatial(plate, *blocks, *([still] if fully else [])))
    assert (held.verdict, held.certainty) == ("interlocked", "searched")


@pytest.mark.slow
def test_glued_parts_stay_together_between_way_points() -> None:
    """A thin peg turns in its hole and swings a block along that is glued to it, far away: half way the block is where the peg has it."""
    hole = [[-5.2, -3], [-5.2, 3], [5.2, 3], [5.2, -3]]
    frame = {"name": "frame", "outline": square(20), "holes": [hole], "thickness": 4, "fixed": True}
    peg = {"name": "peg", "boxes": [[-5, -0.5, -1, 5, 0.5, 5]]}
    block = {"name": "block", "boxes": [[60, -1, 5.5, 62, 1, 6.5]]}
    covers = [{"name": f"cover {z}", "boxes": [[-20, -20, z, 20, 20, z + 1]], "fixed": True} for z in (-2.5, 5.5)]
    found = wr.flex(spatial(frame, peg, block, *covers, glue=[["peg", "block"]]), wr.Turn("peg", (0, 0, 1)))
    assert found.objective > 0.4
    reference = found.assembly.reference
    arm = reference[2] - reference[1]
    for one, other in itertools.pairwise(found.waypoints):
        for share in (0.0, 0.5):
            middle = spatial_overlaps.between(one, other, share)
            R = Rotation.from_rotvec(middle[1, 3:])
            seen = R.inv().apply(middle[2, :3] + arm - middle[1, :3])
            assert np.abs(seen - arm).max() < (1e-4 if share else 1e-9) * 62


# -- IPOPT in space --------------------------------------------------------------------------------------------------


def test_a_square_peg_moves_as_closed_forms_say():
    pytest.importorskip("casadi")
    assembly = spatial(PLATE, PEG | {"lock": ["rx", "ry"]})
    twist = brentq(lambda a: 10 * (np.cos(a) + np.sin(a)) - 10.4, 0, 0.5)
    turned = wr.flex(assembly, Turn("peg", (0, 0, 1)), solver="ipopt")
    assert turned.objective == pytest.approx(twist, abs=1e-7)
    assert (turned.verdict, turned.path, turned.solver) == ("optimal", "checked", "ipopt")
    assert wr.flex(assembly, wr.Pull("peg", (1, 0, 0)), solver="ipopt").objective == pytest.approx(0.2, abs=1e-7)


def test_a_tilting_peg_moves_as_our_own_method_says():
    pytest.importorskip("casadi")
    assembly = spatial(PLATE, PEG)
    pulls = [wr.Pull("peg", (s, 0, 0), (0, 0, 20.0 * s)) for s in (1, -1)]
    ours, theirs = (wr.flex(assembly, pulls, solver=s) for s in ("interior-point", "ipopt"))
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-7)
    assert theirs.collision_free
    assert sum(c.force for c in theirs.contacts) == pytest.approx(sum(c.force for c in ours.contacts), rel=1e-2)


def test_what_leaves_and_what_turns_without_limit_is_named():
    pytest.importorskip("casadi")
    assembly = spatial(PLATE, PEG)
    assert wr.flex(assembly, wr.Pull("peg", (0, 0, 1)), solver="ipopt").leaves == ("peg",)
    pin = {"name": "pin", "boxes": [[-2, -2, -20, 2, 2, 20]]}
    assert wr.flex(spatial(PLATE, pin), Turn("pin", (0, 0, 1)), solver="ipopt").turns == ("pin",)


def test_a_solver_that_is_not_there_is_said(monkeypatch):
    pytest.importorskip("casadi")
    assembly = spatial(PLATE, PEG)
    pull = wr.Pull("peg", (1, 0, 0))
    with pytest.raises(InputError, match='"simplex" is not known; solvers are interior-point, ipopt'):
        wr.flex(assembly, pull, solver="simplex")
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingExtraError, match=r"pip install '.\[ipopt\]'"):
        wr.flex(assembly, pull, solver="ipopt")
