"""Freedoms in space: against closed forms, and every frame by a collision library."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks import spatial_burrs, spatial_overlaps

import wiggleroom as wr
from tests.test_spatial import spatial
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_live import SpatialLive

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
