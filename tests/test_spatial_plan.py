"""Plans in space: levels against a search over cells, and every step replayed by a collision library."""

from __future__ import annotations

import itertools
import json
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks import spatial_burrs, spatial_overlaps

import wiggleroom as wr
from tests.test_spatial import spatial
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import Step
from wiggleroom.report.page.plan_pictures import write_stills
from wiggleroom.report.results.plan_results import PlanTolerances
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_plan_geometry import SpatialPlanGeometry
from wiggleroom.studies.plan import PlanQuestion

GAP = 0.05


def burr(parts: list[set]) -> wr.Assembly:
    return assemble_spatial(spatial_burrs.assembled(parts, GAP).drawing, fix=("p0",))


def pushed(parts: list[set], place: list[np.ndarray], first: int, step: np.ndarray) -> frozenset[int]:
    """Parts that go along when one moves by a cell, the one that stands too where it would have to."""
    own = {tuple(np.add(v, o)): k for k, (cells, o) in enumerate(zip(parts, place, strict=True)) for v in cells}
    group, todo = {first}, [first]
    while todo:
        k = todo.pop()
        for v in parts[k]:
            other = own.get(tuple(np.add(v, place[k]) + step))
            if other is not None and other not in group:
                group.add(other)
                todo.append(other)
    return frozenset(group)


def first_level(parts: list[set], most: int = 3000) -> int | None:
    """Fewest moves until some parts are away: groups that go any number of cells in one direction; part 0 stands."""
    start = tuple((0, 0, 0) for _ in parts)
    known, todo = {start: 0}, deque([start])
    while todo:
        if len(known) > most:
            return None
        state = todo.popleft()
        place = [np.array(o) for o in state]
        for first, step in itertools.product(range(1, len(parts)), spatial_burrs.STEPS):
            way = np.array(step)
            group = pushed(parts, place, first, way)
            moved = place
            for _ in range(20):
                if 0 in group or pushed(parts, moved, first, way) != group:
                    break
                moved = [o + way if k in group else o for k, o in enumerate(moved)]
                name = tuple(tuple(int(x) for x in o) for o in moved)
                if name not in known:
                    known[name] = known[state] + 1
                    todo.append(name)
            else:
                return known[state] + 1
    return None


def test_the_first_level_of_random_burrs_is_that_of_a_search_over_cells() -> None:
    rng, levels = np.random.default_rng(64), []
    for _ in range(3):
        parts = spatial_burrs.random_burr(rng, 4)
        truth = first_level(parts)
        found = wr.plan(burr(parts))
        if truth is not None:
            levels.append(truth)
            assert found.level[0] == truth
        replayed(found, [spatial_overlaps.voxel_judge(part, GAP / 2) for part in parts])
    assert levels


def replayed(found: Plan, shapes: list[Any]) -> None:
    """Every step of a plan is free for the collision library, and begins where the one before ended."""
    assembly = found.assembly
    for step in found.steps:
        stays = np.flatnonzero(step.there)
        judge = spatial_overlaps.Judge(
            [shapes[k] for k in stays], assembly.reference[stays], [assembly.parts[k].fixed for k in stays]
        )
        assert spatial_overlaps.worst_on(judge, step.path[:, stays]) < spatial_overlaps.SHALLOW
    for one, other in itertools.pairwise(found.steps):
        np.testing.assert_array_equal(one.path[-1], other.path[0])
    assert all((step.path[0] == 0).all() for step in found.steps[:1])


def bolted(folder: Path) -> Path:
    """A drawer in a case behind a bolt: the bolt goes in +x, then the drawer in -y."""
    case = [
        [0, 0, 0, 40, 40, 2], [0, 0, 12, 40, 40, 14], [0, 0, 2, 2, 40, 12], [38, 0, 2, 40, 40, 12],
        [2, 38, 2, 38, 40, 12],
    ]  # fmt: skip
    rails = [[-4, -8, 0, 60, -4, 14], [-4, -4, 0, 0, 0, 14]]
    path = folder / "bolted.json"
    parts = [
        {"name": "case", "boxes": [*case, *rails], "fixed": True},
        {"name": "drawer", "boxes": [[2, 0, 2, 38, 38, 12]]},
        {"name": "bolt", "boxes": [[0, -4, 2, 44, 0, 12]]},
    ]
    path.write_text(json.dumps({"format": "wiggleroom/2", "gap": 0.4, "parts": parts}))
    return path


def test_a_plan_says_order_moves_and_room(tmp_path: Path) -> None:
    found = wr.plan(wr.read(bolted(tmp_path)))
    assert found.order[0] == ("bolt",)
    assert found.level[0] == 1
    assert all(step.clearance == pytest.approx(0.4, abs=1e-9) for step in found.steps[:1])
    (first, *_) = found.steps
    assert first.as_one
    only = wr.plan(wr.read(bolted(tmp_path)), targets=["bolt"])
    assert only.order == (("bolt",),)
    with pytest.raises(wr.InputError, match="there is no such part"):
        wr.plan(wr.read(bolted(tmp_path)), targets=["nut"])


def test_what_left_as_one_is_taken_apart_further() -> None:
    found = wr.plan(wr.read("examples/44_six_piece_burr/burr.json"))
    assert found.level[0] == 1
    assert found.order[0] == ("key",)
    assert sum(len(parts) == 1 for parts in found.order) >= 4
    assert found.remains == ()


def test_every_step_moves_something() -> None:
    # the door turns in the room on the right, and its path comes to rest on the way
    walls = [
        [[-8, -6, 0], [9, 10, 1]], [[-8, -6, 1], [9, -2, 4]], [[-8, -2, 1], [-6, 10, 4]], [[-6, -2, 3], [9, 10, 4]],
        [[-6, 2, 1], [-2, 10, 3]], [[-2, 7, 1], [9, 10, 3]], [[-1, 2, 1], [0, 7, 3]], [[0, 3, 1], [9, 7, 3]],
        [[5, -2, 1], [9, -1, 3]], [[5, 2, 1], [9, 3, 3]],
    ]  # fmt: skip
    house = {"name": "house", "boxes": [low + high for low, high in walls], "fixed": True}
    found = wr.plan(spatial(house, {"name": "door", "boxes": [[-2, -2, 1, -1, 2, 3]]}, gap=0.1))
    assert found.order == (("door",),)
    assert all(step.parts == ("door",) and step.moves > 0 for step in found.steps)
    assert (np.abs(np.diff(found.path, axis=0)).max(axis=(1, 2)) > 0).all()


def test_a_search_that_came_to_its_end_was_not_cut_short() -> None:
    lid = wr.plan(wr.read("examples/40_box_with_a_lid/box.json"))
    assert (str(lid.verdict), str(lid.certainty), lid.whole) == ("interlocked", "searched", True)
    assert "cut short" not in PlanQuestion.finding((lid, PlanTolerances())).sure[0][1]


def stood(parts: dict[str, list[list[float]]], fixed: str, gap: float, **more: Any) -> wr.Assembly:
    """Parts of boxes, one of which stands."""
    listed = [{"name": name, "boxes": boxes, "fixed": name == fixed} for name, boxes in parts.items()]
    return spatial(*listed, gap=gap, **more)


def falls(assembly: wr.Assembly, down: tuple[float, float, float]) -> set[str]:
    """Names of the parts that fall from rest when nobody holds anything."""
    n = len(assembly.parts)
    gravity = Gravity(SpatialPlanGeometry(assembly).falling(), down)
    fallen = gravity.falling(np.zeros((n, 6)), np.ones(n, dtype=bool), np.zeros(n, dtype=bool))
    return {name for name, f in zip(assembly.names, fallen, strict=True) if f}


FLOOR = [[-40, -40, -10, 40, 40, 0]]


@pytest.mark.parametrize("count", [1, 3])
def test_a_stack_stands_and_falls_upwards(count: int) -> None:
    tower = {f"b{k}": [[-5, -5, 10 * k, 5, 5, 10 * k + 10]] for k in range(count)}
    assert falls(stood({"floor": FLOOR, **tower}, "floor", 0.4), (0, 0, -1)) == set()
    assert falls(stood({"floor": FLOOR, **tower}, "floor", 0.4), (0, 0, 1)) == set(tower)


@pytest.mark.parametrize(("begin", "along"), [(-8, 0), (-5, 1), (-1, 0)])
def test_a_beam_tips_where_its_centroid_is_beyond_its_support(begin: int, along: int) -> None:
    # 16 long, on a block from -5 to 5: it stays as long as its middle does, along either axis
    beam = [begin, -2, 10, begin + 16, 2, 14]
    if along:
        beam = [beam[k] for k in (1, 0, 2, 4, 3, 5)]
    parts = {"floor": FLOOR, "block": [[-5, -5, 0, 5, 5, 10]], "beam": [beam]}
    assert falls(stood(parts, "floor", 0.1), (0, 0, -1)) == (set() if begin + 8 < 5 else {"beam"})


def test_a_table_on_three_legs_needs_the_third() -> None:
    # the top's centroid is outside what two of the legs carry; a denser weight over them holds it
    legs = {
        f"leg{k}": [[x - 2, y - 2, 0, x + 2, y + 2, 20]] for k, (x, y) in enumerate([(-16, -16), (16, -16), (0, 16)])
    }
    top = {"top": [[-20, -20, 20, 20, 20, 23]]}
    assert falls(stood({"floor": FLOOR, **legs, **top}, "floor", 0.1), (0, 0, -1)) == set()
    del legs["leg2"]
    assert falls(stood({"floor": FLOOR, **legs, **top}, "floor", 0.1), (0, 0, -1)) == {"top"}


def test_only_the_lower_one_is_held_while_the_plate_goes() -> None:
    frame = [
        [-30, -10, -20, 40, 10, -10], [-30, -10, -10, -20, 10, 40], [-20, -10, -10, -6, 10, -5],
        [-20, -10, 0, -6, 10, 40],
    ]  # fmt: skip
    frame += [
        [6, -10, 0, 40, 10, 40],
        [6, -10, -10, 40, 10, -5],
        [-30, 10, -20, 40, 14, 40],
        [-30, -14, -20, 40, -10, 40],
    ]
    parts = {
        "frame": frame,
        "plate": [[-20, -10, -5, 30, 10, 0]],
        "low": [[-6, -10, 0, 6, 10, 10]],
        "top": [[-6, -10, 10, 6, 10, 20]],
    }
    assembly = stood(parts, "frame", 0.4)
    found = wr.plan(assembly, ["plate"], gravity=(0, 0, -1))
    assert [step.parts for step in found.steps] == [("plate",)]
    assert found.steps[0].falling == ("low",)
    assert found.gravity == (0, 0, -1)
    assert wr.plan(assembly, ["plate"], gravity=(1, 0, 0)).steps[0].falling == ()
    with pytest.raises(wr.InputError, match="must be a direction"):
        wr.plan(assembly, gravity=(0, 0, 0))


def test_the_clearance_of_a_slide_is_that_of_its_narrowest_place() -> None:
    """A bar passes two posts between samples of its path, 0.37 mm and, turned by 45 degrees, a corner 0.2 mm away from it."""
    posts = [{"name": "posts", "boxes": [[70.1, 5.37, 0, 70.4, 9, 10]], "fixed": True}]
    bar = {"name": "bar", "boxes": [[0, -5, 0, 1, 5, 10]]}
    geometry = SpatialPlanGeometry(spatial(*posts, bar, {"name": "beside", "boxes": [[0, -6, 0, 1, -5.5, 10]]}))
    path = np.zeros((2, 3, 6))
    path[1, 1, 0] = 150.0
    step = Step(("bar",), path, 1, ("bar",), np.ones(3, dtype=bool))
    found = geometry.measured(step)
    assert found.clearance == pytest.approx(0.37, abs=1e-6)
    assert found.held == ("beside",)
    assert found.axis == (-1, 0, 0)
    assert found.turn_room == pytest.approx(0.37 / np.linalg.norm([0.5, 5, 5]), rel=1e-6)


def test_what_becomes_of_a_plan_when_gaps_vary(tmp_path: Path) -> None:
    """Closed forms: the bolt has the gap to either side; half of what both its neighbours and it get goes on top."""
    found = wr.plan(wr.read(bolted(tmp_path)), targets=["bolt"])
    sample = wr.sample_plan(found, wr.Spread(0.2), draws=40, seed=3)
    extra = wr.Spread(0.2).draw(40, 3, 3)
    at_rest = np.array([0.4 + (row[a] + row[b]) / 2 for row in extra for a, b in ((0, 1), (0, 2), (1, 2))]).reshape(
        40, 3
    )
    free = at_rest.min(axis=1) > 0
    truth = np.where(free, np.minimum(at_rest[:, 1], at_rest[:, 2]), 0.0)
    assert sample.clearance == pytest.approx(truth, abs=1e-6)
    assert sample.failing[-1] == int((~free).sum())
    ranking = wr.rank_plan(found)
    assert dict(zip(ranking.parts, ranking.gain.round(6).tolist(), strict=True)) == {
        "bolt": 0.5,
        "case": 0.0,
        "drawer": 0.0,
    }
    least = wr.smallest_gap(found)
    assert least.works_at < 1e-3 * 0.4
    assert least.fails_at is None


def test_the_smallest_gap_of_a_plan_has_a_state_on_both_sides() -> None:
    """A bar drawn 0.1 mm too thick on either side passes a slit 1 mm behind it from a gap of 0.1 on."""
    wall = {
        "name": "wall",
        "boxes": [
            [6, -9, 0, 8, -4.9, 10],
            [6, 4.9, 0, 8, 9, 10],
            [-8, 9, 0, 8, 12, 10],
            [-8, -12, 0, 8, -9, 10],
            [-8, -9, -3, 8, 9, 0],
            [-8, -9, 10, 8, 9, 13],
            [-8, -9, 0, -6, 9, 10],
        ],
        "fixed": True,
    }
    bar = {"name": "bar", "boxes": [[-5, -5, 1, 5, 5, 9]]}
    found = wr.plan(spatial(wall, bar, gap=0.4))
    least = wr.smallest_gap(found)
    assert least.fails_at is not None
    assert least.fails_at <= 0.1 <= least.works_at <= 1.011 * least.fails_at
    assert set(least.pair) == {"wall", "bar"}


def test_the_command_of_a_plan_in_space(command: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = bolted(tmp_path)
    words = [
        "--gravity",
        "-z",
        "--sample",
        0.02,
        "--draws",
        5,
        "--rank",
        "--smallest-gap",
        "--json",
        tmp_path / "plan.json",
    ]
    (tmp_path / "stills").mkdir()
    assert command("plan", source, *words, "--stills", tmp_path / "stills") == 0
    told = json.loads((tmp_path / "plan.json").read_text())
    assert told["gravity"] == [0, 0, -1]
    assert told["sample"]["draws"] == 5
    assert {"rank", "smallest_gap"} <= set(told)
    assert len(list((tmp_path / "stills").iterdir())) == len(told["steps"])
    assert "loose parts fall in -z" in capsys.readouterr().out
    assert command("plan", source, "--gravity", "-y,1") == 2


def test_a_still_shows_what_is_there_where_it_is(tmp_path: Path) -> None:
    found = wr.plan(wr.read("examples/44_six_piece_burr/burr.json"))
    assert write_stills(found, tmp_path) == len(found.steps)
    first, second = ((tmp_path / f"step_0{k}.svg").read_text() for k in (1, 2))
    assert found.steps[0].leaves == ("key",)
    assert first.count(">key</text>") == 1
    assert ">key</text>" not in second
    assert f"step 2 of {len(found.steps)}: stick" in second
