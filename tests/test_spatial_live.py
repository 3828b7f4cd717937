"""Parts in space that are dragged, and their freedoms: as closed forms say, and free by an independent collision library."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from benchmarks import spatial_burrs, spatial_overlaps

import wiggleroom as wr
from tests.test_spatial import PEG, PLATE, spatial
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Pull
from wiggleroom.errors import InputError
from wiggleroom.live.live_result import LiveResult
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.planes.spatial_objectives import SpatialApproach
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_live import SpatialLive


class Patient(SpatialLive):
    """With all the time that kernels need to be compiled."""

    def drag(self, *where: object, **how: object) -> LiveResult:
        return super().drag(*where, seconds=60, **how)  # type: ignore[arg-type]


def live(assembly: Assembly) -> SpatialLive:
    one = Patient()
    one.take(assembly)
    return one


def test_the_approach_has_the_derivatives_it_says() -> None:
    rng = np.random.default_rng(3)
    begin = SpatialPose(rng.normal(size=(3, 3)), exponential(rng.normal(size=(3, 3))))
    pose = SpatialPose(rng.normal(size=(3, 3)), exponential(rng.normal(size=(3, 3))))
    term = SpatialApproach(1, np.array([1.0, 2, 3]), np.array([4.0, 1, 2]), begin, np.array([2.0, 3, 1]), 1.7, 0.3)

    def at(u: np.ndarray) -> SpatialPose:
        return SpatialPose(pose.T + u[:, :3], pose.R @ exponential(u[:, 3:]))

    h, gradient = 1e-5, term.gradient(pose)
    hessian = term.hessian(pose)
    for body in range(3):
        for k in range(6):
            step = np.zeros((3, 6))
            step[body, k] = h
            assert (term.value(at(step)) - term.value(at(-step))) / (2 * h) == pytest.approx(
                gradient[body, k], abs=1e-7
            )
            for m in range(6):  # along two directions at once, about the same pose
                other = np.zeros((3, 6))
                other[body, m] = h
                both = [term.value(at(a * step + b * other)) for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
                second = (both[0] - both[1] - both[2] + both[3]) / (4 * h * h)
                assert second == pytest.approx(hessian[body, k, m], abs=2e-4)


def test_a_peg_goes_to_the_wall_of_its_hole_and_no_further() -> None:
    peg = live(spatial(PLATE, {**PEG, "lock": ["rx", "ry", "rz"]}, gap=0.1))
    found = peg.drag("peg", (0, 0, 0), (2, 0, 0))
    assert found.settled
    assert found.reached == pytest.approx((0.3, 0, 0), abs=1e-3)
    assert found.reached[0] < 0.3
    assert found.blocking == ("plate",)
    assert found.contacts[0].force == pytest.approx(1.0, abs=0.01)
    assert found.contacts[0].normal[0] == pytest.approx(1.0 if found.contacts[0].parts[0] == "peg" else -1.0, abs=1e-6)


def test_a_part_goes_where_the_hand_leads_it_and_back_again() -> None:
    peg = live(spatial(PLATE, PEG, gap=0.1))
    out = peg.drag("peg", (0, 0, 0), (0, 0, 45))
    assert out.settled
    assert out.distance < 1e-3
    aside = peg.drag("peg", (0, 0, 0), (30, 0, 45))
    assert aside.reached == pytest.approx((30, 0, 45), abs=1e-3)
    down = peg.drag("peg", (0, 0, 0), (12, 0, 0))  # now it stands on the plate
    assert down.reached[2] > 5
    assert down.blocking == ("plate",)


def test_what_is_in_the_way_is_pushed_and_what_is_not_stays() -> None:
    floor = {"name": "floor", "boxes": [[-50, -20, -2, 50, 20, 0]], "fixed": True}
    blocks = [
        {"name": n, "boxes": [[0, 0, 0, 6, 6, 6]], "at": [x, 0, 0.1], "lock": ["rx", "ry"]}
        for n, x in (("a", 0), ("b", 8), ("c", 30))
    ]
    pushed = live(spatial(floor, *blocks, gap=0.05)).drag("a", (3, 3, 3.1), (9, 3, 3.1))
    names = ["floor", "a", "b", "c"]
    assert pushed.distance < 0.05
    assert pushed.motion[names.index("b"), 0] > 3.9
    assert np.abs(pushed.motion[names.index("c")]).max() < 0.1


def test_another_design_begins_at_rest_and_an_answer_can_be_gone_on_from() -> None:
    assembly = spatial(PLATE, {**PEG, "lock": ["z", "rx", "ry", "rz"]}, gap=0.1)
    peg = live(assembly)
    peg.drag("peg", (0, 0, 0), (2, 0, 0))
    goals = (Pull("peg", (0, 1, 0)),)
    answer = peg.settle(goals)
    went_on = peg.drag("peg", (0, 0, 0), (0, 0.25, 0), start="answer", goals=goals)
    assert answer.objective == pytest.approx(0.3, abs=1e-6)
    assert went_on.reached[1] == pytest.approx(0.25, abs=1e-3)
    peg.take(replace(assembly))
    assert peg.drag("peg", (0, 0, 0), (0, 0, 0)).motion.any() == np.False_


def test_what_cannot_be_dragged_is_said_in_one_line() -> None:
    peg = live(spatial(PLATE, PEG, gap=0.1))
    with pytest.raises(InputError, match="fixed"):
        peg.drag("plate", (0, 0, 0), (1, 0, 0))
    with pytest.raises(InputError, match="pegs"):
        peg.drag("pegs", (0, 0, 0), (1, 0, 0))
    with pytest.raises(InputError, match="three numbers"):
        peg.drag("peg", (0, 0), (1, 0))


def test_a_drag_stops_when_it_is_asked_to() -> None:
    peg = live(spatial(PLATE, PEG, gap=0.1))
    stop = threading.Event()
    stop.set()
    began = time.monotonic()
    found = peg.drag("peg", (0, 0, 0), (9, 9, 9), stop=stop)
    assert time.monotonic() - began < 3
    assert not found.settled or found.distance < 1e-3


@pytest.mark.parametrize("family", ["burr", "crate"])
def test_no_stop_of_a_random_drag_overlaps_by_the_collision_library(family: str) -> None:
    rng = np.random.default_rng(11)
    drawing, shapes = getattr(spatial_overlaps, family)(rng)
    assembly = assemble_spatial(drawing)
    hand = live(assembly)
    judge = spatial_overlaps.Judge(shapes, assembly.reference, [p.fixed for p in drawing.parts])
    free = [k for k, p in enumerate(assembly.parts) if not p.fixed]
    moved = 0.0
    for _ in range(8):
        k = int(rng.choice(free))
        grip = assembly.reference[k] + rng.normal(size=3)
        target = grip + rng.normal(size=3) * assembly.size * float(rng.choice([0.02, 0.2, 1.0]))
        found = hand.drag(assembly.names[k], grip.tolist(), target.tolist())
        assert judge.depth(found.motion) < spatial_overlaps.SHALLOW
        moved = max(moved, float(np.abs(found.motion[:, :3]).max()))
    assert moved > 0


# -- freedoms --------------------------------------------------------------------------------------------------------


FRAME = {"name": "frame", "boxes": [[-9, -9, 0, -5.3, 9, 10], [5.3, -9, 0, 9, 9, 10], [-5.3, -9, 0, 5.3, -6, 10], [-5.3, 6, 0, 5.3, 9, 10]],
         "fixed": True}  # fmt: skip
BLOCK = {"name": "block", "boxes": [[-5, -5, 1, 5, 5, 9]]}


def live_of(assembly: wr.Assembly) -> SpatialLive:
    live = SpatialLive()
    live.take(assembly)
    return live


def test_the_loosest_freedom_is_that_with_the_most_room() -> None:
    """0.3 mm of room along x and 1 mm along y."""
    first, second = live_of(spatial(FRAME, BLOCK | {"lock": ["z", "rx", "ry", "rz"]})).wiggle()
    assert (first.parts, first.ends, second.ends) == (("block",), True, True)
    assert first.size == pytest.approx(1.0, abs=1e-6)
    assert second.size == pytest.approx(0.3, abs=1e-6)
    assert np.abs(first.frames[:, 1, 1]).max() == pytest.approx(1.0, abs=1e-6)
    assert np.ptp(first.frames[:, 1, 1]) == pytest.approx(2.0, abs=1e-6)  # to both ends


def test_what_nothing_stops_is_cut_off() -> None:
    (along,) = live_of(spatial(FRAME, BLOCK | {"lock": ["x", "y", "rx", "ry", "rz"]})).wiggle()
    assert not along.ends
    assert 0 < along.size <= 0.31 * 18
    with pytest.raises(wr.InputError, match="fixed"):
        live_of(spatial(FRAME, BLOCK)).wiggle("frame")


def test_no_frame_of_a_burr_overlaps() -> None:
    gap = 0.05
    parts = spatial_burrs.random_burr(np.random.default_rng(64), 4)
    assembly = assemble_spatial(spatial_burrs.assembled(parts, gap).drawing, fix=("p0",))
    judge = spatial_overlaps.Judge(
        [spatial_overlaps.voxel_judge(part, gap / 2) for part in parts],
        assembly.reference,
        [part.fixed for part in assembly.parts],
    )
    found = live_of(assembly).wiggle(seconds=60.0)
    assert found
    for mode in found:
        assert all(spatial_overlaps.worst_on(judge, frame[None]) < spatial_overlaps.SHALLOW for frame in mode.frames)
        assert not mode.frames[0].any()
        assert not mode.frames[-1].any()
