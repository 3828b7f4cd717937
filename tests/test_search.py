"""The search beyond the nearest local optimum, and the complete search of a single body."""

from __future__ import annotations

import json
import threading
from dataclasses import replace

import msgspec
import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import box, part_at, polygon_part
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing, Region
from wiggleroom.freespace.subdivision.largest_motion import MotionBoxes, PulledBody
from wiggleroom.maximise import witness
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.report.results.answer_words import searched
from wiggleroom.report.results.json_results import flex_result
from wiggleroom.search.canonical_frame import canonical_frame
from wiggleroom.search.global_search import search_on
from wiggleroom.search.incumbent import start_at_rest
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.prepare import prepare_as_drawn
from wiggleroom.search.separated_bodies import without_separated
from wiggleroom.solve import interior_point
from wiggleroom.verdict import Verdict

BENT = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
"""Room of a corridor with one bend, one unit wide."""


def bent_corridor(goal, size=0.9):
    """A square in a closed corridor with a bend, pulled."""
    wall = shapely.box(-1, -1, 4, 4) - shapely.Polygon(BENT)
    play = (1 - size) / 2
    parts = [polygon_part("wall", wall, fixed=True), box("peg", 2 + play, play, 2 + play + size, play + size)]
    return assemble(Drawing(tuple(parts), goals=(goal,), gap=0.0))


def test_finds_the_path_round_the_bend_and_proves_it():
    up = wr.Pull("peg", (0, 1))
    near = wr.flex(bent_corridor(up), search=0)
    answer = wr.flex(bent_corridor(up))
    assert near.objective < 0.2  # up against the corridor's side
    assert answer.objective == pytest.approx(2.05, rel=1e-3)  # round the bend and to the end
    assert answer.verdict is Verdict.PROVEN
    assert answer.objective <= answer.at_most <= 1.001 * answer.objective
    assert answer.path == "checked"
    assert audit_path(answer.assembly, answer.waypoints).free


def test_says_how_many_starts_ended_where():
    answer = wr.flex(bent_corridor(wr.Pull("peg", (0, 1))), search=12)
    assert answer.search.starts == 13
    assert 1 <= answer.search.at_value <= 13
    assert answer.search.next_best is None or answer.search.next_best < answer.objective
    assert json.loads(msgspec.json.encode(flex_result(answer)))["search"]["starts"] == 13


def test_same_answer_every_time():
    asked = bent_corridor(wr.Pull("peg", (0.3, 1)))
    one, other = wr.flex(asked), wr.flex(asked)
    assert one.objective == other.objective
    np.testing.assert_array_equal(one.waypoints, other.waypoints)
    assert one.search == other.search


def test_stop_keeps_the_best():
    stop = threading.Event()
    rounds = []

    def watch(progress):
        rounds.append(progress.round)
        if len(rounds) > 60:
            stop.set()

    answer = wr.flex(bent_corridor(wr.Pull("peg", (0, 1))), search=500, stop=stop, progress=watch)
    assert answer.verdict is Verdict.STOPPED
    assert answer.objective > 0.04
    assert answer.path == "checked"


def test_large_assemblies_are_climbed_once():
    answer = wr.flex(wr.patterns.grid(8, 8, joint="tee", gap=0.02))
    assert answer.search.starts == 1


@pytest.mark.parametrize("seed", range(3))
def test_no_sampled_motion_is_worth_more_than_the_proof(seed):
    """Squares of random size in a square room: the truth is a closed form at rest's angle, and samples at all others."""
    rng = np.random.default_rng(seed)
    half, angle = rng.uniform(0.3, 0.45), rng.uniform(0, 2 * np.pi)
    d = np.array([np.cos(angle), np.sin(angle)])
    room = shapely.box(-1, -1, 1, 1) - shapely.box(-0.5, -0.5, 0.5, 0.5)
    peg = shapely.box(-half, -half, half, half)
    boxes = MotionBoxes(PulledBody(1, room, peg, d, np.zeros(2), 0.0), 100_000)
    truth = (0.5 - half) * np.abs(d).sum()
    at_most, path = boxes.beyond(truth * 1.0001, truth * 1.0009, 5_000_000)
    assert truth <= at_most <= truth * 1.0009
    assert path is None
    again, _ = boxes.beyond(truth * 1.2, truth * 1.5, 5_000_000)
    assert again == at_most  # not what was asked about
    at_most, path = boxes.beyond(truth * 0.5, truth * 0.6, 5_000_000)
    assert at_most is None
    assert d @ path[-1, :2] > truth * 0.5


def told_differently():
    """A square with a corner cut off in a bent corridor, pulled; and the same, turned, mirrored, in inches and in another order."""
    wall = shapely.box(-1, -1, 4, 4) - shapely.Polygon(BENT)
    peg = shapely.box(2.05, 0.05, 2.95, 0.95) - shapely.Polygon([(2.0, 0.0), (2.3, 0.0), (2.0, 0.2)])
    angle, unit, direction = 0.7, 25.4, np.array([0.3, 1.0])
    axes = unit * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ np.diag([-1.0, 1.0])
    moved = [shapely.transform(shape, lambda p: p @ axes.T + (700.0, -20.0)) for shape in (wall, peg)]
    one = [polygon_part("wall", wall, fixed=True), polygon_part("peg", peg)]
    other = [polygon_part("a", moved[1]), polygon_part("b", moved[0], fixed=True)]
    spots = np.array(one[1].at[:2]), axes @ one[1].at[:2] + (700.0, -20.0)
    goals = wr.Pull("peg", tuple(direction), tuple(spots[0])), wr.Pull("a", tuple(axes @ direction), tuple(spots[1]))
    return [assemble(Drawing(tuple(p), goals=(g,), gap=0.0)) for p, g in zip((one, other), goals, strict=True)], unit


def test_the_same_assembly_told_differently_has_the_same_answer():
    (one, other), unit = told_differently()
    first, second = wr.flex(one), wr.flex(other)
    assert first.verdict == second.verdict
    assert second.objective / unit == pytest.approx(first.objective, rel=1e-9)
    assert audit_path(other, second.waypoints).free
    assert wr.prepare(other).flex().warm_start is not None


def frame(unit):
    """A fixed part round a hole in which a square of side `unit` has little play."""
    hole = shapely.transform(shapely.box(0.93, 0.9, 2.05, 2.1), lambda p: unit * p)
    return polygon_part("frame", shapely.box(0, 0, 3 * unit, 3 * unit) - hole, fixed=True)


def test_a_turn_told_in_another_unit_has_the_same_answer():
    unit = 25.4
    one, other = (
        assemble(Drawing((box("pin", x, x, 2 * x, 2 * x), frame(x)), goals=(wr.Turn("pin", "ccw"),), gap=0.0))
        for x in (1.0, unit)
    )
    assert canonical_frame(one, one.drawing.goals).goals == canonical_frame(other, other.drawing.goals).goals
    first, second = wr.flex(one), wr.flex(other)
    assert second.objective == pytest.approx(first.objective, rel=1e-12)
    forces = [[contact.force for contact in answer.contacts] for answer in (first, second)]
    assert forces[0] == pytest.approx([unit * force for force in forces[1]], rel=1e-6)


def test_an_answer_in_the_assemblys_own_frame_starts_the_next_question():
    (_, other), unit = told_differently()
    ready = wr.prepare(other)
    first = ready.flex()
    again = ready.flex(start=first)
    assert again.objective == pytest.approx(first.objective, abs=1e-6 * unit)


def test_only_what_is_not_proven_may_have_a_better_optimum() -> None:
    answer = wr.flex(wr.patterns.chain(2, joint="tee"), search=0)
    assert "a better local optimum" in searched(replace(answer, verdict=Verdict.OPTIMAL))
    for verdict in (Verdict.PROVEN, Verdict.UNBOUNDED):
        assert searched(replace(answer, verdict=verdict)) == "from rest only"


# -- free bodies in rooms of their own change no answer --------------------------------------------------------------


ROOM = shapely.box(0, 0, 6, 6).difference(shapely.union_all([shapely.box(1, 1, 5, 1.6), shapely.box(1, 4, 5, 4.6)]))
PEG, PEBBLE = shapely.box(1.1, 1.1, 1.6, 1.5), shapely.box(2.1, 4.1, 2.6, 4.5)


def made(*parts: wr.Part, ignore: tuple = (), glue: tuple = ()) -> Assembly:
    return assemble(Drawing(parts, ignore=ignore, glue=glue, goals=(wr.Pull("peg", (1.0, 0.0)),)), gap=0.0)


def fixed_of(assembly: Assembly) -> dict[str, bool]:
    kept = without_separated(wr.prepare(assembly), assembly.goals)
    return {part.name: part.fixed for part in kept.parts}


def plate(hole: shapely.Geometry = ROOM) -> wr.Part:
    return part_at("plate", hole, fixed=True)


def test_a_body_in_a_room_of_its_own_is_left_out() -> None:
    assembly = made(plate(), part_at("peg", PEG), part_at("pebble", PEBBLE))
    assert fixed_of(assembly) == {"plate": True, "peg": False, "pebble": True}
    alone = wr.flex(made(plate(), part_at("peg", PEG)))
    answer = wr.flex(assembly)
    assert answer.verdict == alone.verdict == "proven"
    assert answer.objective == pytest.approx(alone.objective, rel=1e-7)
    assert answer.at_most == pytest.approx(alone.at_most, rel=1e-7)
    assert not answer.motion[2].any()
    assert answer.assembly.parts[2].fixed is False
    further = wr.flex(wr.prepare(assembly), wr.Pull("peg", (0.0, 1.0)))
    assert further.verdict == "proven"


@pytest.mark.parametrize(
    "case",
    {
        "same room": made(plate(), part_at("peg", PEG), part_at("pebble", shapely.box(3, 1.1, 3.5, 1.5))),
        "a way between the rooms": made(
            plate(ROOM.difference(shapely.box(4.6, 1.1, 4.9, 4.5))), part_at("peg", PEG), part_at("pebble", PEBBLE)
        ),
        "the wall is passed": made(plate(), part_at("peg", PEG), part_at("pebble", PEBBLE), ignore=(("plate", "pebble"),)),
        "glue reaches into both": made(
            plate(), part_at("peg", PEG), part_at("pebble", PEBBLE), part_at("stone", shapely.box(4, 1.1, 4.4, 1.5)),
            glue=(("pebble", "stone"),),
        ),
        "both are pulled": assemble(
            Drawing(
                (plate(), part_at("peg", PEG), part_at("pebble", PEBBLE)),
                goals=(wr.Pull("peg", (1.0, 0.0)), wr.Turn("pebble", "ccw")),
            ),
            gap=0.0,
        ),
        "everybody counts": assemble(
            Drawing((plate(), part_at("peg", PEG), part_at("pebble", PEBBLE)), goals=(wr.Translation(),)), gap=0.0
        ),
    }.items(),
    ids=lambda case: case[0],
)  # fmt: skip
def test_who_may_meet_what_is_pulled_is_kept(case: tuple[str, Assembly]) -> None:
    assembly = case[1]
    assert [part.fixed for part in without_separated(wr.prepare(assembly), assembly.goals).parts] == [
        part.fixed for part in assembly.parts
    ]


# -- large assemblies ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ready():
    return prepare_as_drawn(wr.patterns.grid(6, 5, joint="tee", gap=0.02))


@pytest.fixture(scope="module")
def program(ready):
    return build_program(ready.bodies, ready.cells, ready.objective(ready.assembly.goals), length=ready.clearance)


def shuffled(assembly, rng):
    """The same parts in another order."""
    drawing = assembly.drawing
    return assemble(replace(drawing, parts=tuple(drawing.parts[k] for k in rng.permutation(len(drawing.parts)))))


def mirrored(assembly):
    """Left and right exchanged; the pull goes up as before."""

    def turned_over(region):
        flip = np.array([-1.0, 1.0])
        return Region(region.outer[::-1] * flip, tuple(hole[::-1] * flip for hole in region.holes))

    drawing = assembly.drawing
    parts = tuple(
        replace(part, regions=tuple(map(turned_over, part.regions)), at=(-part.at[0], part.at[1], -part.at[2]))
        for part in drawing.parts
    )
    return assemble(replace(drawing, parts=parts))


def test_order_and_handedness_of_the_parts_change_nothing():
    assembly = wr.patterns.grid(14, 13, joint="tee", gap=0.01)
    rng = np.random.default_rng(1)
    values = [witness(one).objective for one in (assembly, shuffled(assembly, rng), mirrored(assembly))]
    assert max(values) / min(values) - 1 < 1e-4


def test_no_end_that_was_met_is_better_than_the_answer():
    ready = wr.prepare(wr.patterns.chain(2, joint="tee", gap=0.01))
    goal = ready.objective(ready.assembly.drawing.goals)
    first = LocalSearch(ready, goal, interior_point.solve, THOROUGH)
    first.improve(start_at_rest(ready))
    best = first.best.value
    first.best = replace(first.best, value=best * (1 - 5e-5))  # a little below an end that other climbs meet
    further, _ = search_on(first, 8)
    assert further.best.value == pytest.approx(best, rel=1e-6)
