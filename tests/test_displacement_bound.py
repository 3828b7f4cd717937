"""What no point of any part exceeds: no motion that is found comes to it, whichever regions it is from."""

from __future__ import annotations

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.bound import displacement_bound
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.bound.outer_regions import outer_regions
from wiggleroom.deadline import WorkBudget

WAYS = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]


@pytest.mark.parametrize("walls", [True, False])
@pytest.mark.parametrize("made", ["jigsaw", "swallowtails"])
def test_no_motion_exceeds_it(made: str, walls: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    assembly = (
        wr.patterns.jigsaw(3, 2, gap=0.5, pitch=40)
        if made == "jigsaw"
        else wr.patterns.chain(3, joint="swallowtail", gap=0.4, pitch=20)
    )
    if not walls:  # outer slices do it where walls close no joint
        monkeypatch.setattr(
            displacement_bound, "local_outer_regions", lambda surveyed, _: outer_regions(surveyed, WorkBudget(0.0))
        )
    most = furthest(assembly, 600_000)
    assert most is not None
    found = [wr.flex(assembly, wr.Pull(assembly.names[-1], way), search=0) for way in WAYS]
    reached = max(one.objective for one in found if one.objective is not None)
    assert 0 < reached <= most
    assert np.isfinite(most)
    assert most < 40 * reached
