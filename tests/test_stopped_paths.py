"""A large assembly that is stopped early gives what it has reached and checked, also where no time is left for an audit."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom import maximise
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.deadline import GracePeriod
from wiggleroom.search import local_search


class AfterSteps:
    """Asks to stop once the solver has gone so many steps."""

    def __init__(self, steps: int) -> None:
        self.left = steps

    def __call__(self, told: wr.Progress) -> None:
        self.left -= told.stage == "solve"

    def is_set(self) -> bool:
        return self.left < 0


def grid() -> wr.Assembly:
    return wr.patterns.grid(11, 11, joint="tee", gap=0.02)


def deepest_area(assembly: wr.Assembly, waypoints: np.ndarray) -> float:
    """Largest area [mm2] that two parts share at a waypoint or half way between two, by general polygon geometry."""
    states = np.concatenate([waypoints, (waypoints[1:] + waypoints[:-1]) / 2])
    most = 0.0
    for motion in states:
        shapes = []
        for part, (x, y, turn) in zip(assembly.parts, assembly.rest + motion, strict=True):
            c, s = np.cos(turn), np.sin(turn)
            rings = [ring @ np.array([[c, s], [-s, c]]) + (x, y) for ring in (r.outer for r in part.regions)]
            shapes.append(shapely.Polygon(rings[0]))
        a, b = shapely.STRtree(shapes).query(shapes)
        meeting = shapely.intersection(np.array(shapes)[a[a < b]], np.array(shapes)[b[a < b]])
        most = max(most, float(shapely.area(meeting).max()))
    return most


@pytest.fixture
def audits_at_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local_search, "AUDIT_SECONDS", 0.0)
    monkeypatch.setattr(local_search, "AUDIT_SECONDS_PER_BODY", 0.0)


@pytest.mark.usefixtures("audits_at_every_step")
@pytest.mark.parametrize("steps", [8, 22])
def test_a_stopped_answer_keeps_what_was_audited_before(steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maximise, "GracePeriod", partial(GracePeriod, seconds=0.0))
    stop, whole = AfterSteps(steps), wr.flex(grid(), search=0).objective
    found = wr.flex(grid(), search=0, stop=stop, progress=stop)
    assert found.verdict == "stopped"
    assert found.path == "checked"
    assert 0.1 * whole < found.objective <= whole * (1 + 1e-6)
    assert audit_path(grid(), found.waypoints).free
    assert deepest_area(grid(), found.waypoints) < 1e-9
