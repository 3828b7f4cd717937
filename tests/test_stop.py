"""Whatever is asked, and whenever it is told to stop, it comes back within a second of work."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom import context
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.cli.study_command import unless_stopped
from wiggleroom.cli.watch import at_once, interruptible
from wiggleroom.deadline import GracePeriod
from wiggleroom.drawing import write_drawing
from wiggleroom.search import local_search
from wiggleroom.search.progress import Progress

DRAWINGS = Path(__file__).parents[1] / "examples" / "drawings"


@pytest.fixture(scope="module")
def jigsaw() -> wr.Assembly:
    """Twenty pieces, one of them fixed; everything that is compiled has been."""
    drawing = wr.read(DRAWINGS / "pyjigsaw_4x5.svg", gap=2.0).drawing
    fixed = assemble(replace(drawing, parts=tuple(replace(p, fixed=p.name == "p1") for p in drawing.parts)), gap=2.0)
    pair = wr.patterns.chain(2, joint="swallowtail", gap=0.02)
    wr.check(pair)
    wr.free_space(pair, "b1", "b2")
    for model in ("walls", "hull", "halfplane"):
        wr.flex(pair, model=model, search=0)
    return fixed


PULL = wr.Pull("p20", (1, 0))
LATE = 3.0
"""A second on an idle machine, and room for one that is not [s]; what is asked takes longer."""
ASKED: dict[str, Callable[[wr.Assembly, threading.Event], Any]] = {
    "check": lambda a, stop: wr.check(a, stop=stop),
    "largest gap": lambda a, stop: wr.largest_gap(a, stop=stop),
    "free space": lambda a, stop: wr.free_space(a, "p1", "p2", stop=stop),
    "prepare": lambda a, stop: wr.prepare(a, stop=stop),
    "flex": lambda a, stop: wr.flex(a, PULL, stop=stop, search=0),
    "hull": lambda a, stop: wr.flex(a, PULL, model="hull", stop=stop),
    "halfplane": lambda a, stop: wr.flex(a, PULL, model="halfplane", stop=stop),
    "prove": lambda a, stop: wr.flex(a, PULL, prove=1e-4, stop=stop, search=0),
    "rank": lambda a, stop: wr.rank(a, PULL, by="differences", workers=1, stop=stop),
    "tighten": lambda a, stop: wr.tighten(a, PULL, parts=3, workers=1, stop=stop),
    "clearances": lambda a, stop: wr.clearances(a, stop=stop),
    "sweep": lambda a, stop: wr.sweep(a, [0.5, 1.0, 1.5, 2.0], PULL, stop=stop),
    "sample": lambda a, stop: wr.sample(a, 0.05, PULL, workers=1, stop=stop),
}


def lateness(work: Callable[[threading.Event], Any], delay: float) -> float:
    """Processor time between the request to stop and the return [s]; none where it was done before."""
    stop, asked = threading.Event(), []

    def ask() -> None:
        asked.append(time.process_time())
        stop.set()

    timer = threading.Timer(delay, ask)
    timer.start()
    try:
        work(stop)
    except wr.WiggleroomError as error:  # where there is nothing to say yet
        if not any(word in str(error) for word in ("stop", "cut short")):
            raise
    ended = time.process_time()
    timer.cancel()
    timer.join()
    return ended - asked[0] if asked else 0.0


@pytest.mark.parametrize("what", ASKED)
def test_stop_is_honoured_within_a_second(what: str, jigsaw: wr.Assembly) -> None:
    assert lateness(lambda stop: ASKED[what](jigsaw, stop), 0.4) < LATE


@pytest.mark.parametrize("extension", ["svg", "dxf"])
def test_reading_a_large_drawing_stops(extension: str, tmp_path: Path) -> None:
    pieces = wr.patterns.grid(20, 20, joint="revolute", gap=0.01).drawing
    file = tmp_path / f"large.{extension}"
    write_drawing(pieces, file)
    wr.read(DRAWINGS / "pyjigsaw_4x5.svg", gap=1.0)
    stop = AfterSeconds(0.2)
    with pytest.raises(wr.StoppedError):
        wr.read(file, gap=0.01, stop=stop)
    assert time.process_time() - stop.seen < LATE


def test_a_climb_that_is_stopped_still_begins_at_rest() -> None:
    tees = wr.patterns.grid(30, 30, joint="tee", gap=0.01)
    goal = wr.Pull(tees.names[-1], (1, 0))
    wr.flex(wr.patterns.grid(11, 11, joint="tee", gap=0.01), goals=wr.Pull("b11-11", (1, 0)), search=0)
    for seconds in (0.1, 0.15, 0.2, 0.25):
        answer = wr.flex(tees, goal, stop=AfterSeconds(seconds), search=0)
        assert not answer.waypoints[0].any()
        assert answer.objective >= 0


class AfterSeconds:
    """A request to stop after so much processor time; it knows when it was first seen."""

    def __init__(self, seconds: float) -> None:
        self.due, self.seen = time.process_time() + seconds, 0.0

    def is_set(self) -> bool:
        now = time.process_time()
        self.seen = self.seen or (now if now >= self.due else 0.0)
        return now >= self.due


@pytest.fixture(scope="module")
def many_tees() -> wr.Assembly:
    """A thousand blocks: single stages take long; what only large assemblies need has been compiled."""
    few = wr.patterns.grid(11, 11, joint="tee", gap=0.02)
    wr.flex(few, search=0)
    wr.check(few, seconds=1.0)
    return wr.patterns.grid(32, 32, joint="tee", gap=0.02)


@pytest.mark.parametrize("after", [0.2, 0.8])
def test_flex_of_a_thousand_parts_stops_in_any_stage(after: float, jigsaw: wr.Assembly, many_tees: wr.Assembly) -> None:
    stop = AfterSeconds(after)
    answer = wr.flex(many_tees, stop=stop, search=0)
    ended = time.process_time()
    assert not stop.seen or ended - stop.due < LATE
    assert answer.path == "checked"
    if answer.verdict != "stopped":  # the search had ended before the request was seen
        assert answer.objective == pytest.approx(wr.flex(many_tees, search=0).objective, rel=1e-6)


def test_check_of_a_thousand_parts_stops(jigsaw: wr.Assembly, many_tees: wr.Assembly) -> None:
    stop = AfterSeconds(0.5)
    assert wr.check(many_tees, stop=stop).verdict == "unknown"
    assert time.process_time() - stop.due < LATE


def test_an_audit_that_is_asked_to_stop_vouches_for_nothing() -> None:
    pair = wr.patterns.chain(2, joint="tee", gap=0.01)
    waypoints = np.zeros((3, 2, 3))
    waypoints[1:, 1, 0] = 0.002, 0.004
    assert audit_path(pair, waypoints).free
    audit = audit_path(pair, waypoints, stop=AfterSeconds(0.0))
    assert not audit.free
    assert audit.certain == 1


def test_what_was_found_before_the_stop_is_kept(jigsaw: wr.Assembly) -> None:
    grid = wr.patterns.grid(12, 12, joint="tee", gap=0.02)
    seen: list[float] = []
    stop = threading.Event()

    def progress(step: Progress) -> None:
        seen.append(step.objective)
        if len(seen) > 12:  # on the first climb
            stop.set()

    answer = wr.flex(grid, stop=stop, progress=progress, search=0)
    assert answer.verdict == "stopped"
    assert answer.path == "checked"
    assert answer.objective > 0.5 * max(seen)


@pytest.mark.slow
@pytest.mark.parametrize("what", ["check", "largest gap", "prove", "rank", "sample"])
def test_stop_is_honoured_at_any_time(what: str, jigsaw: wr.Assembly) -> None:
    delay = float(np.random.default_rng([0, len(what)]).uniform(0.05, 8.0))
    assert lateness(lambda stop: ASKED[what](jigsaw, stop), delay) < LATE


COMMANDS = ("flex", "check", "gap --holds", "sample --spread 0.05")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs a file that is never read to its end")
@pytest.mark.parametrize("command", COMMANDS)
def test_ctrl_c_while_a_file_is_read_ends_at_once(command: str, tmp_path: Path) -> None:
    """A pipe that nobody writes to is read for ever."""
    os.mkfifo(tmp_path / "endless.svg")
    program = "import sys; from wiggleroom.cli import main; sys.exit(main())"
    asked = [sys.executable, "-c", program, *command.split(), str(tmp_path / "endless.svg")]
    run = subprocess.Popen(asked, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    with (tmp_path / "endless.svg").open("w"):  # opens once it is being read
        run.send_signal(signal.SIGINT)
        _, said = run.communicate(timeout=60)
    assert run.returncode == 3
    assert "interrupted" in said


def test_the_time_limit_holds_while_a_file_is_read() -> None:
    began = time.monotonic()

    def read_for_ever() -> None:
        with interruptible(0.2) as stop, unless_stopped(stop), at_once(stop):
            while time.monotonic() - began < 30.0:
                pass

    with pytest.raises(wr.WiggleroomError, match="after 0"):
        read_for_ever()


# -- what was audited before a stop ----------------------------------------------------------------------------------


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
def test_a_stopped_answer_keeps_what_was_audited_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(context, "GracePeriod", partial(GracePeriod, seconds=0.0))
    stop, whole = AfterSteps(22), wr.flex(grid(), search=0).objective
    found = wr.flex(grid(), search=0, stop=stop, progress=stop)
    assert found.verdict == "stopped"
    assert found.path == "checked"
    assert 0.1 * whole < found.objective <= whole * (1 + 1e-6)
    assert audit_path(grid(), found.waypoints).free
    assert deepest_area(grid(), found.waypoints) < 1e-9
