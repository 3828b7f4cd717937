"""Plans: against an exhaustive search on the grid, and every step by general polygon geometry."""

from __future__ import annotations

import json
import re
import threading
from itertools import pairwise

import numpy as np
import pytest
import shapely
from benchmarks.plan_families import (
    assembled,
    frame_puzzle,
    grid_search,
    latches,
    pinwheel,
    random_tray,
    tray,
    tray_of_squares,
    tumbler_lock,
    turning_room,
)  # fmt: skip

import wiggleroom as wr
from wiggleroom.assembly.assembly import place
from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.report.results.plan_results import plan_result
from wiggleroom.schema.plan_schema import PlanResult
from wiggleroom.search.prepare import survey


def outlines_at(assembly, motion):
    pose = assembly.rest + motion
    shapes = [shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in p.regions]) for p in assembly.parts]
    return [shapely.transform(s, lambda p, q=q: place(p, q)) for s, q in zip(shapes, pose, strict=True)]


def nearest(assembly, path, there, moving, between=20):
    """Largest overlap (area) of any two parts on a path, and least distance of those that move from others, by dense sampling."""
    overlap, least = 0.0, np.inf
    for one, other in pairwise(path):
        for t in np.linspace(0, 1, between):
            at = outlines_at(assembly, one + t * (other - one))
            for i in np.flatnonzero(there):
                for j in np.flatnonzero(there[i + 1 :]) + i + 1:
                    if at[i].distance(at[j]) <= 0:
                        overlap = max(overlap, at[i].intersection(at[j]).area)
                    if (i in moving) != (j in moving):
                        least = min(least, at[i].distance(at[j]))
    return overlap, least


def see_free(found):
    """Every step begins where the one before ended, and nothing overlaps on its path."""
    assembly, last = found.assembly, np.zeros((len(found.assembly.parts), 3))
    gone = set()
    for step in found.steps:
        np.testing.assert_allclose(step.path[0], last, atol=1e-9)
        assert {assembly.names[k] for k in np.flatnonzero(~step.there)} == gone
        moving = {assembly.names.index(n) for n in step.parts}
        overlap, least = nearest(assembly, step.path, step.there, moving)
        assert overlap < 1e-6
        if step.as_one:
            assert step.clearance <= least + 1e-9
        still = [k for k in range(len(last)) if k not in moving]
        assert not np.ptp(step.path[:, still], axis=0).any()
        last, gone = step.path[-1], gone | set(step.leaves)


@pytest.mark.parametrize(("count", "turn"), [(1, 0.0), (3, 0.3)])
def test_nested_latches(count, turn):
    found = wr.plan(latches(count, turn), ["bolt"])
    assert found.verdict == "comes apart"
    assert found.order == (("bolt",),)
    assert found.level == (count + 1,)  # every latch once, then the bolt: fewer do not do
    assert found.moves == count + 1
    see_free(found)
    assert min(step.clearance for step in found.steps) == pytest.approx(0.6, abs=1e-6)


def test_check_finds_nested_latches_too():
    found = wr.check(latches(3))
    assert found.verdict == "comes apart"
    assert not found.escapes[0].path[0].any()
    left = [n != "bolt" for n in found.assembly.names]
    assert not found.escapes[0].path[-1, left].any()  # all others are back at rest


@pytest.mark.slow
@pytest.mark.parametrize("seed", [200, 1085])
def test_random_trays_agree_with_the_grid(seed):
    pieces, wall = random_tray(seed)
    truth, exhausted = grid_search(pieces, wall)
    assert exhausted
    found = wr.plan(tray(pieces, wall))
    gone = {name for parts in found.order for name in parts}
    assert gone >= truth  # by turning more may come out
    assert found.verdict != "unknown"
    see_free(found)


@pytest.mark.slow
def test_a_tray_that_is_locked():
    pieces, wall = random_tray(3)
    assert grid_search(pieces, wall) == (set(), True)
    found = wr.plan(tray(pieces, wall))
    assert (found.verdict, found.steps) == ("interlocked", ())
    assert found.states > 1
    assert found.whole


def test_a_bar_slides_turns_and_slides_on():
    found = wr.plan(turning_room(0.5), ["bar"])
    assert found.verdict == "comes apart"
    assert found.order[-1] == ("bar",)
    see_free(found)
    assert min(step.clearance for step in found.steps) > 0.5  # at rest all have 0.6
    bar = found.assembly.names.index("bar")
    assert abs(found.path[-1, bar, 2]) == pytest.approx(np.pi / 2, abs=0.2)


def test_a_tray_full_of_squares():
    found = wr.plan(tray(*tray_of_squares(3, 2, 2)))
    assert len(found.order) == 3 * 2 - 2
    see_free(found)


def test_pinwheels_leave_at_once_and_off_their_contacts():
    count = 3
    found = wr.plan(pinwheel(count))
    assert found.verdict == "comes apart"
    assert len(found.steps[0].parts) == count - 1
    see_free(found)
    # at rest neighbours are 0.3 apart, and no path from there has more
    assert found.steps[0].clearance > 0.25
    assert min(step.clearance for step in found.steps) > 0.15


@pytest.mark.parametrize("case", ["latches", "pushed"])
def test_the_ball_of_errors_is_the_largest_under_which_a_step_still_goes(case):
    wall = shapely.box(0, 0, 50, 30) - shapely.box(10, 10, 50, 20)
    pushed = {"wall": wall, "inner": shapely.box(10, 10, 20, 20), "outer": shapely.box(20, 10, 30, 20)}
    assembly, targets = {
        "latches": (latches(2), ["bolt"]), "pushed": (assembled(pushed, "wall"), ["inner"]),
    }[case]  # fmt: skip
    found, random = wr.plan(assembly, targets), np.random.default_rng(1)
    for step in found.steps:
        assert step.as_one
        moving = [assembly.names.index(n) for n in step.parts]

        def overlap(shift, turn=0.0, step=step, moving=moving):
            """Largest overlap on the path of what moves, put wrong by a shift and a turn."""
            worst = 0.0
            for t in np.linspace(0, 1, 15):
                at = outlines_at(found.assembly, step.path[0] + t * (step.path[-1] - step.path[0]))
                others = shapely.union_all([at[k] for k in np.flatnonzero(step.there) if k not in moving])
                mine = shapely.union_all([at[k] for k in moving])
                origin = tuple(np.mean([at[k].centroid.coords[0] for k in moving], axis=0))
                mine = shapely.affinity.rotate(mine, turn, origin=origin, use_radians=True)
                worst = max(worst, shapely.affinity.translate(mine, *shift).intersection(others).area)
            return worst

        angle = random.uniform(0, 2 * np.pi, 12)
        inside = 0.999 * step.room * np.sqrt(random.uniform(0, 1, 12))
        assert all(overlap((r * np.cos(a), r * np.sin(a))) < 1e-9 for r, a in zip(inside, angle, strict=True))
        beyond = 1.05 * step.room
        assert any(
            overlap((beyond * np.cos(a), beyond * np.sin(a))) > 1e-9
            for a in np.arange(24) * np.pi / 12 + assembly.rest[0, 2]
        )
        assert overlap((0.0, 0.0), 0.99 * step.turn_room) < 1e-9
        assert overlap((0.0, 0.0), -0.99 * step.turn_room) < 1e-9


def test_draws_of_a_plan_against_closed_forms():
    # one block in a channel: it goes in where its gap and that of the wall are together more than nothing
    wall = shapely.box(0, 0, 50, 30) - shapely.box(10, 10, 50, 20)
    assembly = assembled({"wall": wall, "block": shapely.box(10, 10, 20, 20)}, "wall", gap=0.2)
    found = wr.plan(assembly)
    assert found.steps[0].clearance == pytest.approx(0.2, abs=1e-9)
    sample = wr.sample_plan(found, wr.Spread(0.2), draws=300, seed=1)
    extra = wr.Spread(0.2).draw(300, 2, 1)
    np.testing.assert_array_equal(sample.clearance > 0, 0.2 + extra.sum(axis=1) / 2 > 0)
    good = sample.clearance > 0
    np.testing.assert_allclose(sample.clearance[good], (0.2 + extra.sum(axis=1) / 2)[good], atol=1e-9)
    assert sum(sample.failing) == (~good).sum()
    ranking = wr.rank_plan(found)
    assert ranking.gain == pytest.approx([0.5, 0.5], abs=1e-6)
    border = wr.smallest_gap(found)
    assert border.works_at < 1e-3
    assert border.fails_at is None


def test_the_smallest_gap_of_a_plan_has_a_state_on_both_sides():
    # the block leaves through a mouth drawn 0.5 narrower than itself, and both give way by the gap: it fits from 0.25 on
    wall = shapely.box(0, 0, 60, 30) - shapely.box(10, 9.5, 60, 20.5) | shapely.box(30, 9, 60, 10.25)
    wall |= shapely.box(30, 19.75, 60, 21)
    assembly = assembled({"wall": wall, "block": shapely.box(12, 10, 22, 20)}, "wall", gap=1.5)
    found = wr.plan(assembly)
    border = wr.smallest_gap(found)
    assert border.fails_at < 0.25 < border.works_at
    assert border.works_at - border.fails_at <= 0.01 * border.works_at
    assert set(border.pair) == {"wall", "block"}


def test_targets():
    assembly = tray(*random_tray(0))
    first = wr.plan(assembly, ["p4"])
    assert "p4" in {name for parts in first.order for name in parts}
    assert len(first.order) <= 2
    with pytest.raises(wr.InputError, match='target "nobody"'):
        wr.plan(assembly, ["nobody"])
    with pytest.raises(wr.InputError, match="stands"):
        wr.plan(assembly, ["tray"])


def test_stopped_at_once_is_unknown():
    stop = threading.Event()
    stop.set()
    found = wr.plan(latches(2), stop=stop)
    assert found.verdict == "unknown"
    assert not found.whole


def test_pushing_counts_as_one_move():
    # two blocks in a row in a channel: the second only leaves by pushing the first, or after it; as a target it pushes
    wall = shapely.box(0, 0, 50, 30) - shapely.box(10, 10, 50, 20)
    parts = {"wall": wall, "inner": shapely.box(10, 10, 20, 20), "outer": shapely.box(20, 10, 30, 20)}
    found = wr.plan(assembled(parts, "wall"), ["inner"])
    assert found.order == (("inner", "outer"),)
    assert found.level == (1,)
    assert found.steps[0].as_one


def test_off_the_lattice_parts_stop_where_edges_line_up():
    # the latch has to stop half way, where its notch lies in front of the bolt
    wall = shapely.box(0, 0, 60, 60) - shapely.box(20, 5, 30.7, 55) - shapely.box(5, 23.3, 60, 33.1)
    latch = shapely.box(20, 5, 30.7, 30) - shapely.box(20, 12.1, 30.7, 22.6)
    bolt = shapely.box(5, 23.8, 19, 32.6)
    found = wr.plan(assembled({"wall": wall, "latch": latch, "bolt": bolt}, "wall", gap=0.3), ["bolt"])
    assert found.verdict == "comes apart"
    assert [step.parts for step in found.steps] == [("latch",), ("bolt",)]
    see_free(found)


def test_swept_distances_are_those_of_dense_samples():
    turn, random = 0.4, np.random.default_rng(4)
    a, b = (shapely.Point(0, 0).buffer(5, quad_segs=2), shapely.box(-3, -2, 4, 2) | shapely.box(-1, -5, 1, 5))
    parts = {"wall": a, "block": shapely.affinity.translate(b, 20, 0)}
    assembly = assembled(parts, "wall", gap=0.0)
    bodies = survey(assembly).bodies
    for _ in range(20):
        path = np.zeros((2, 2, 3))
        path[:, 1, :2] = random.uniform(-10, 15, (2, 2))
        path[:, 1, 2] = random.uniform(-turn, turn, 2)
        got = least_distances(bodies, path, np.ones(2, dtype=bool), np.zeros(0, dtype=np.int64), 30.0)[0, 1]
        from wiggleroom.geometry.rigid_motions import of_parts

        _, truth = nearest(assembly, of_parts(assembly, bodies, path), np.ones(2, dtype=bool), {1}, 200)
        assert got <= truth + 1e-9
        assert got >= truth - 0.15 - 0.01 * truth or truth == 0


def test_json_reads_back_and_reverses():
    found = wr.plan(latches(2))
    import msgspec

    text = msgspec.json.encode(plan_result(found))
    back = msgspec.json.decode(text, type=PlanResult)
    assert json.loads(text)["format"] == "wiggleroom.plan/1"
    assert [s.step for s in back.assembly] == [3, 2, 1]
    assert back.assembly[0].path == back.steps[-1].path[::-1]
    assert back.assembly[0].axis == pytest.approx((-1.0, 0.0))
    assert back.steps[0].clearance == pytest.approx(0.6, abs=1e-6)


def test_command(command, tmp_path, capsys):
    source = tmp_path / "latches.json"
    from wiggleroom.drawing import write_drawing

    write_drawing(latches(2).drawing, source)
    code = command(
        "plan", source, "--target", "bolt", "--json", tmp_path / "plan.json", "--picture", tmp_path / "plan.html",
        "--stills", tmp_path, "--csv", tmp_path / "plan.csv",
    )  # fmt: skip
    assert code == 0
    said = capsys.readouterr().out
    assert "bolt taken out in 3 moves" in said
    assert "1. latch2 moves in +x by 10 mm" in said
    assert json.loads((tmp_path / "plan.json").read_text())["level"] == [3]
    assert (
        command(
            "plan", source, "--target", "bolt", "--sample", "0.1", "--draws", "5", "--rank", "--smallest-gap", "--json"
        )
        == 0
    )
    told = json.loads(capsys.readouterr().out)
    assert told["sample"]["draws"] == 5
    assert told["smallest_gap"]["works_at"] < 0.01
    assert len(told["rank"]) == 4
    assert (tmp_path / "step_03.svg").read_text().count("<text") > 3
    assert (tmp_path / "plan.csv").read_text().startswith("step,point,part")
    assert command("plan", source, "--target", "frame") == 2


def test_films_play(tmp_path):
    found = wr.plan(latches(1))
    found.draw(tmp_path / "plan.film.svg")
    found.draw(tmp_path / "plan.svg")
    assert "animate" in (tmp_path / "plan.film.svg").read_text()
    assert "order of leaving" in (tmp_path / "plan.svg").read_text()


def test_a_frame_of_twenty_parts_and_numbers_that_fit_into_their_discs():
    from wiggleroom.report.page.plan_pictures import picture_of_plan

    found = wr.plan(frame_puzzle())
    assert sum(map(len, found.order)) == 20
    assert found.remains == ()
    svg = picture_of_plan(found)
    marks = re.findall(r'<circle [^>]*r="([\d.]+)"[^>]*/><text [^>]*font-size="([\d.]+)"[^>]*>(\d+)</text>', svg)
    assert {int(number) for _, _, number in marks} == set(range(1, 21))
    assert all(0.64 * len(number) * float(size) < 2 * float(radius) * 0.95 for radius, size, number in marks)


def test_a_part_that_is_named_twice_is_taken_out_once() -> None:
    assembly = turning_room(False)
    assert wr.plan(assembly, ["bar", "bar"]).targets == ("bar",)


def test_trays_full_of_squares():
    for wide, high, holes in ((3, 2, 2), (3, 3, 1)):
        found = wr.plan(tray(*tray_of_squares(wide, high, holes)))
        assert len(found.order) == wide * high - holes
        see_free(found)


def test_a_lock_with_three_tumblers():
    found = wr.plan(tumbler_lock(turn=0.7), ["bolt"])
    assert found.level == (7,)
    see_free(found)
