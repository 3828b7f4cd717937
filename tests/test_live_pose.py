"""Drags that begin where parts were left, with others pinned, and the least motion of the others; in the plane and in space."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import affinity

import wiggleroom as wr
from tests.test_page_pose import LATCH
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.errors import InputError
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.spatial_live import SpatialLive

SLIDER, LIFTED = 3, 4


@pytest.fixture
def latch(tmp_path: Path) -> Assembly:
    path = tmp_path / "latch.json"
    path.write_text(json.dumps(LATCH))
    return wr.read(str(path))


def as_told(motion: np.ndarray) -> np.ndarray:
    """As a page knows it, which keeps single precision."""
    return motion.astype(np.float32).astype(np.float64)


def overlap(assembly: Assembly, motion: np.ndarray) -> float:
    """Largest common area of two parts [mm2], by shapely alone."""
    placed = []
    for part, (dx, dy, turn) in zip(assembly.parts, motion, strict=True):
        whole = shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in part.regions])
        x, y, angle = part.at
        there = affinity.rotate(whole, angle + turn, origin=(0, 0), use_radians=True)
        placed.append(affinity.translate(there, x + dx, y + dy))
    return max(a.intersection(b).area for k, a in enumerate(placed) for b in placed[:k])


@pytest.mark.parametrize("step", [2.0, 15.0])
def test_what_holds_a_part_stays_however_often_that_is_pulled(latch: Assembly, step: float) -> None:
    """The latch must be lifted by 5 mm; nothing lifts it while the slider is led on."""
    live = wr.Live(latch)
    for k in range(1, 9):
        led = live.drag("slider", (20, 15), (20 + step * k, 15), seconds=9)
        assert led.motion[SLIDER, 0] < 0.6
        assert led.motion[LIFTED, 1] < 5


def test_a_drag_begins_where_the_part_before_was_left(latch: Assembly) -> None:
    live = wr.Live(latch)
    live.drag("latch", (45, 50), (45, 62), start="rest", seconds=3)
    live.others_back("latch")
    lifted = as_told(live.drag("latch", (45, 50), (45, 62), seconds=3).motion)
    assert live.leave(lifted)
    from_rest = live.drag("slider", (20, 15), (50, 15), start="rest", seconds=3)
    assert from_rest.distance > 29  # the latch holds it
    for one in (live, wr.Live(latch)):  # with the cells that led there, and without
        found = one.drag("slider", (20, 15), (50, 15), start=lifted, seconds=3)
        assert found.distance < 0.01
        assert overlap(one.assembly, found.motion) < 1e-3
        back = one.others_back("slider", seconds=5)
        after = found.motion if back is None else back
        assert after[LIFTED] == pytest.approx(lifted[LIFTED], abs=0.01)  # nobody asked it to move
        assert after[SLIDER] == pytest.approx(found.motion[SLIDER], abs=0.01)
        assert overlap(one.assembly, after) < 1e-3


def test_parts_that_touch_may_be_left_although_rounding_lets_them_overlap(latch: Assembly) -> None:
    pressed = wr.Live(latch).drag("slider", (20, 15), (50, 15), start="rest", seconds=3).motion
    pressed[SLIDER, 0] += 1e-5  # into the latch
    assert overlap(latch, pressed) > 0
    live = wr.Live(latch)  # a process that knows of no drag
    assert live.leave(pressed)
    found = live.drag("latch", (45, 50), (45, 62), start=pressed, seconds=3)
    assert found.distance < 0.01
    assert overlap(latch, found.motion) < 1e-9


def test_parts_that_overlap_cannot_be_left_so(latch: Assembly) -> None:
    live = wr.Live(latch)
    wrong = np.zeros((5, 3))
    wrong[SLIDER, 0] = 30.0
    assert overlap(live.assembly, wrong) > 1
    assert not live.leave(wrong)
    with pytest.raises(InputError, match="bring them back to rest"):
        live.drag("slider", (20, 15), (50, 15), start=wrong)


def test_a_pinned_part_stands_and_cannot_be_dragged(latch: Assembly) -> None:
    live = wr.Live(latch)
    found = live.drag("latch", (45, 50), (45, 62), start="rest", seconds=3, pinned=("slider",))
    assert (found.motion[SLIDER] == 0).all()
    assert found.distance < 0.01
    held = live.drag("slider", (20, 15), (50, 15), start="rest", seconds=3, pinned=("latch",))
    assert (held.motion[LIFTED] == 0).all()
    assert held.blocking[0] == "latch" or "latch" in held.blocking
    with pytest.raises(InputError, match="pinned"):
        live.drag("slider", (20, 15), (50, 15), pinned=("slider",))


def test_in_space_a_drag_begins_at_a_pose_too() -> None:
    boxes = {
        "format": "wiggleroom/2",
        "parts": [
            {"name": "floor", "boxes": [[0, 0, 0, 40, 9, 1]], "fixed": True},
            {"name": "gate", "boxes": [[0, 0, 0, 2, 9, 9]], "at": [20, 0, 1.5]},
            {"name": "block", "boxes": [[0, 0, 0, 4, 4, 4]], "at": [4, 2, 1.5]},
        ],
    }
    live = SpatialLive()
    live.take(assemble_spatial(read_spatial(json.dumps(boxes))))
    up = live.drag("gate", (21, 4, 5), (21, 4, 15), pinned=("block",)).motion
    assert live.leave(as_told(up))
    through = live.drag("block", (6, 4, 3), (36, 4, 3), start=as_told(up), pinned=("gate",))
    assert through.distance < 0.01
    assert through.motion[1] == pytest.approx(up[1])
    held = live.drag("block", (6, 4, 3), (36, 4, 3), start="rest", pinned=("gate",), seconds=2)
    assert (held.motion[1] == 0).all()
    assert held.distance > 5  # it may turn and climb, but the gate is higher than what it reaches in one straight way
    wrong = np.zeros((3, 6))
    wrong[2, 0] = 15.0
    assert not live.leave(wrong)
    with pytest.raises(InputError, match="overlap"):
        live.drag("block", (6, 4, 3), (36, 4, 3), start=wrong)
