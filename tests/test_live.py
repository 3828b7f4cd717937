"""Live questions: dragged as near as the parts let it, never through each other, whatever the time and however often."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import box
from tests.oracle import collision
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.geometry.rigid_motions import of_parts


class Now:
    """A stop that is always set."""

    def is_set(self) -> bool:
        return True


JIGSAW = "examples/drawings/pyjigsaw_4x5.svg"


def frame(x0, y0, x1, y1, *rooms, name="frame"):
    """Fixed plate with rooms cut out."""
    outer = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float)
    return Part(name, (Region(outer, tuple(np.array(r, dtype=float)[::-1] for r in rooms)),), (0.0, 0.0, 0.0), True)


def rectangle(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def peg(half=4.0, hole=5.0):
    """A square peg round the origin in a square hole, both half sides given."""
    parts = (frame(-9, -9, 9, 9, rectangle(-hole, -hole, hole, hole)), box("peg", -half, -half, half, half))
    return assemble(Drawing(parts), gap=0.0)


def material(assembly: Assembly, motion):
    """Moved parts as polygons."""
    poses = assembly.rest + motion
    return [
        shapely.union_all(
            [shapely.Polygon(place(r.outer, tuple(p)), [place(h, tuple(p)) for h in r.holes]) for r in part.regions]
        )
        for part, p in zip(assembly.parts, poses, strict=True)
    ]


def overlap(assembly: Assembly, motion) -> float:
    """Largest common area of two moved parts [mm2]."""
    made = np.array(material(assembly, motion))
    a, b = shapely.STRtree(made).query(made)
    return float(shapely.area(shapely.intersection(made[a[a < b]], made[b[a < b]])).max(initial=0.0))


def grip_at(assembly: Assembly, part: str, grip, motion):
    """Where a point of a part is after a motion about reference points."""
    k = assembly.names.index(part)
    x, y, angle = motion[k]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return turn @ (np.asarray(grip) - assembly.rest[k, :2]) + assembly.rest[k, :2] + (x, y)


def free_parts(assembly: Assembly):
    return [p.name for p in assembly.parts if not p.fixed]


@pytest.mark.parametrize(("target", "there"), [((7, 7), (1, 1)), ((0.3, -0.6), (0.3, -0.6)), ((-40, 0.5), (-1, 0.5))])
def test_a_square_peg_goes_into_the_corner_of_its_hole(target, there):
    shot = wr.Live(peg()).drag("peg", (0, 0), target, seconds=30.0)
    assert shot.settled
    np.testing.assert_allclose(shot.reached, there, atol=5e-3)
    assert shot.distance == pytest.approx(np.hypot(*np.subtract(target, shot.reached)))


def test_at_the_stop_the_walls_hold_with_the_pull():
    shot = wr.Live(peg()).drag("peg", (0, 0), (7, 0), seconds=30.0)
    assert shot.blocking == ("frame",)
    push = np.sum([np.multiply(c.force, c.normal) for c in shot.contacts], axis=0)
    np.testing.assert_allclose(push, (-1, 0), atol=0.02)  # frame to peg, against a pull of 1 to the right
    assert all(p == ("frame", "peg") for p in (c.parts for c in shot.contacts))


def test_the_public_goal_agrees_with_the_closed_form():
    answer = wr.flex(peg(), wr.Towards("peg", (7.0, 7.0), (0.0, 0.0)), search=0)
    assert answer.objective == pytest.approx(7**2 * 2 - 6**2 * 2, rel=1e-6)
    inside = wr.flex(peg(), wr.Towards("peg", (0.4, -0.7)), search=0)
    assert inside.objective == pytest.approx(0.4**2 + 0.7**2, rel=1e-4)


@pytest.mark.parametrize("target", [(1.5, 0.4), (1.02, -0.5)])
def test_a_link_is_dragged_as_near_as_a_dense_search_finds(target):
    assembly = wr.patterns.chain(2, joint="swallowtail", gap=0.03)
    grip = (1.4, 0.3)
    shot = wr.Live(assembly).drag("b2", grip, target, seconds=30)
    assert shot.settled
    A, B = material(assembly, np.zeros((2, 3)))
    D = assembly.rest[1, :2]
    B = shapely.transform(B, lambda p: p - D)
    random = np.random.default_rng(3)
    around = [np.zeros(3), shot.motion[1]]
    samples = np.concatenate([m + random.uniform(-s, s, (60_000, 3)) for m in around for s in (0.05, 0.01, 0.001)])
    legal = samples[collision.free(A, B, D, samples, 0.0)]
    assert len(legal) > 1000
    c, s = np.cos(legal[:, 2]), np.sin(legal[:, 2])
    x, y = np.subtract(grip, D)
    there = np.column_stack([c * x - s * y, s * x + c * y]) + D + legal[:, :2]
    best = np.hypot(*(there - target).T).min()
    assert shot.distance - 2e-4 < best < shot.distance + 2e-3


def test_it_does_not_jump_into_the_next_room():
    rooms = rectangle(0, 0, 10, 10), rectangle(11, 0, 21, 10)
    drawing = Drawing((frame(-2, -2, 23, 12, *rooms), box("peg", 2, 2, 6, 6)))
    live = wr.Live(drawing)
    for target in ((16, 5), (18, 8), (12, 5)):
        shot = live.drag("peg", (4, 4), target, seconds=5)
        assert shot.reached[0] <= 8 + 1e-3


def test_it_goes_round_a_corner_in_two_drags_and_back():
    room = [(0, 0), (30, 0), (30, 30), (24, 30), (24, 6), (0, 6)]
    live = wr.Live(Drawing((frame(-2, -2, 33, 33, room), box("peg", 1, 1, 5, 5))))
    for target in ((27, 3), (27, 27), (27, 3), (3, 3)):
        for _ in range(20):
            shot = live.drag("peg", (3, 3), target, seconds=1)
            assert overlap(live.assembly, shot.motion) < 1e-9
            if shot.settled:
                break
        assert shot.distance < 0.03, target


@pytest.mark.parametrize("joint", ["tee", "revolute", "jigsaw"])
def test_there_and_back(joint):
    live = wr.Live(wr.patterns.grid(3, 3, joint=joint, gap=0.02))
    part, grip = live.assembly.names[-1], tuple(live.assembly.rest[-1, :2])
    far = live.drag(part, grip, (grip[0] + 0.5, grip[1] + 0.2), seconds=30)
    assert far.distance > 0.1
    back = live.drag(part, grip, grip, seconds=30)
    assert back.distance < 1e-4
    again = live.drag(part, grip, (grip[0] + 0.5, grip[1] + 0.2), seconds=30)
    assert again.distance == pytest.approx(far.distance, rel=1e-2)


@pytest.mark.parametrize(("seconds", "moves"), [(0.0, 40), (0.02, 40), pytest.param(30.0, 25, marks=pytest.mark.slow)])
def test_no_motion_overlaps_whatever_the_time(seconds, moves):
    assembly = wr.read(JIGSAW, gap=1.0, fix=["p1"])
    live, random = wr.Live(assembly), np.random.default_rng(int(100 * seconds))
    names, best = free_parts(assembly), 0.0
    for _ in range(moves):
        part = str(random.choice(names))
        grip = assembly.rest[assembly.names.index(part), :2] + random.uniform(-5, 5, 2)
        shot = live.drag(part, tuple(grip), tuple(grip + random.uniform(-25, 25, 2)), seconds=seconds)
        assert overlap(assembly, shot.motion) < 1e-9 * assembly.size**2
        np.testing.assert_allclose(grip_at(assembly, part, grip, shot.motion), shot.reached, atol=1e-9)
        best = max(best, np.abs(shot.motion).max())
    assert best > 3.0  # even without time it gets somewhere


def test_asking_again_goes_on_to_the_same_end():
    assembly = wr.patterns.grid(8, 8, joint="tee", gap=0.02)
    part, grip, target = "b8-8", (7.0, 7.0), (9.0, 7.6)
    whole = wr.Live(assembly).drag(part, grip, target, seconds=60)
    live, asked = wr.Live(assembly), 1
    shot = live.drag(part, grip, target, seconds=0)
    while not shot.settled and asked < 200:
        before, asked = shot.distance, asked + 1
        shot = live.drag(part, grip, target, seconds=0)
    assert asked > 1
    assert shot.settled
    assert shot.distance == pytest.approx(whole.distance, rel=5e-3)
    assert shot.distance <= before + 1e-2


@pytest.mark.parametrize("gaps", [(0.021, 0.022, 0.03, 0.04), (0.019, 0.018, 0.0175, 0.01), (0.02, 0.035, 0.011)])
def test_the_slider_finds_what_flex_finds(gaps):
    drawing = wr.patterns.chain(6, joint="tee", gap=0.02).drawing
    live, goal = wr.Live(drawing), wr.Pull("b6", (0, 1))
    for gap in gaps:
        made = live.design(gap=gap)
        assert made.gap == gap
        shot = live.flex(goal, seconds=30)
        assert shot.objective == pytest.approx(wr.flex(assemble(drawing, gap=gap), goal, search=0).objective, rel=2e-3)
        assert overlap(made, shot.motion) < 1e-12
        exact = assemble(drawing, gap=gap)
        for one, other in zip(made.parts, exact.parts, strict=True):
            np.testing.assert_array_equal(one.regions[0].outer, other.regions[0].outer)


@pytest.mark.parametrize("joint", ["jigsaw"])
def test_many_small_slides_do_not_lead_astray(joint):
    """Walls that gave nothing at one gap are not looked at again at the next: what is left out must not add up."""
    drawing = wr.patterns.chain(5, joint=joint, gap=0.02).drawing
    live, goal, random = wr.Live(drawing), wr.Pull("b5", (0, 1)), np.random.default_rng(2)
    live.flex(goal, seconds=60)
    gap = 0.02
    for k in range(30):
        gap *= 1 + random.uniform(-0.04, 0.05)
        made = live.design(gap=gap)
        shot = live.flex(goal, seconds=60)
        assert overlap(made, shot.motion) < 1e-12
        if k % 10 == 9:
            assert shot.objective == pytest.approx(
                wr.flex(assemble(drawing, gap=gap), goal, search=0).objective, rel=3e-3
            )


@pytest.mark.parametrize(("joint", "seconds"), [("jigsaw", 0.0), ("swallowtail", 5e-3)])
def test_a_gap_that_shrinks_overlaps_nothing_whatever_the_time(joint, seconds):
    rng = np.random.default_rng(7)
    made = wr.patterns.chain(4, joint=joint, gap=0.05)
    live, goals = wr.Live(made), made.drawing.goals
    live.flex(goals, seconds=5.0)
    for gap in np.sort(rng.uniform(0.02, 0.05, 8))[::-1]:  # each time the end of a larger gap is near
        live.design(gap=float(gap))
        for _ in range(2):
            assert overlap(live.assembly, live.flex(goals, seconds=seconds).motion) < 1e-9


def test_settle_is_the_answer_of_flex_and_helps_the_next_one():
    drawing = wr.patterns.grid(4, 4, joint="swallowtail", gap=0.02).drawing
    live, goal = wr.Live(drawing), wr.Pull("b4-4", (1, 0))
    live.design()
    live.design(gap=0.021)
    answer = live.settle(goal)
    truth = wr.flex(assemble(drawing, gap=0.021), goal, search=0)
    assert answer.objective == pytest.approx(truth.objective, rel=1e-9)
    assert answer.path == "checked"
    shot = live.flex(goal, seconds=30)
    assert shot.settled
    assert shot.objective == pytest.approx(truth.objective, rel=1e-3)


def test_other_parts_are_fixed_and_glued():
    drawing = wr.patterns.chain(4, joint="tee", gap=0.02).drawing
    live, goal = wr.Live(drawing), wr.Pull("b4", (0, 1))
    long = live.flex(goal, seconds=30).objective
    live.design(fixed=["b1", "b3"])
    short = live.flex(goal, seconds=30).objective
    assert short == pytest.approx(wr.flex(wr.patterns.chain(2, joint="tee", gap=0.02), search=0).objective, rel=2e-3)
    live.design(glue=[["b2", "b3"]])
    assert short < live.flex(goal, seconds=30).objective < long


def test_nothing_stops_what_is_free():
    live = wr.Live(Drawing((box("floor", 0, -2, 20, 0, fixed=True), box("brick", 5, 0.1, 9, 4))))
    shot = live.flex(wr.Pull("brick", (0, 1)), seconds=10)
    assert shot.objective is None
    assert shot.leaves == ("brick",)
    shot = live.drag("brick", (7, 2), (12, 1e6), seconds=10)
    assert np.isfinite(shot.motion).all()
    assert live.drag("brick", (7, 2), (7, -5), seconds=10).reached[1] == pytest.approx(1.9, abs=1e-3)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda live: live.drag("b9", (0, 0), (1, 1)), "b9"),
        (lambda live: live.drag("b1", (0, 0), (1, 1)), "fixed"),
        (lambda live: live.drag("b2", (0, 0), (np.nan, 1)), "finite"),
        (lambda live: live.design(gap=-1), "gap"),
        (lambda live: live.design(gap=0), "touch"),
        (lambda live: live.design(gap=5), "b1"),
        (lambda live: (live.design(fixed=["b3"]), live.flex()), "fixed"),
        (lambda live: live.design(extra={"b7": 1}), "b7"),
        (lambda live: live.design(fixed=["b7"]), "b7"),
        (lambda live: live.design(fixed=["b1", "b2", "b3"]), "every part is fixed"),
        (lambda live: live.design(glue=[["b1", "x"]]), "x"),
        (lambda live: live.wiggle("b1"), "fixed"),
        (lambda live: live.flex(wr.Pull("b3", (0, 0))), "direction"),
    ],
)
def test_bad_questions_are_refused_and_the_design_stays(ask, words):
    live = wr.Live(wr.patterns.chain(3, joint="tee", gap=0.02))
    live.design()
    with pytest.raises(wr.InputError, match=words):
        ask(live)
    live.design()
    assert live.drag("b3", (2, 0), (2, 0.01)).distance < 1e-4


def test_a_slider_has_one_freedom_that_goes_far():
    parts = (frame(-2, -2, 32, 8, rectangle(0, 0, 30, 6)), box("slider", 10, 0.01, 14, 5.99))
    modes = wr.Live(Drawing(parts)).wiggle()
    assert modes[0].ends
    assert modes[0].parts == ("slider",)
    assert modes[0].size == pytest.approx(16, abs=0.1)  # 10 to the left, 16 to the right
    assert all(m.size < 0.2 for m in modes[1:])
    assert np.abs(modes[0].frames[0]).max() == np.abs(modes[0].frames[-1]).max() == 0


@dataclass
class After:
    """Says stop from a certain time of asking on."""

    times: int
    asked: int = 0

    def is_set(self) -> bool:
        self.asked += 1
        return self.asked > self.times


@pytest.mark.parametrize("times", [0, 2])
def test_work_ends_while_free_spaces_are_found(times: int) -> None:
    assembly = wr.patterns.grid(6, 6, joint="jigsaw", gap=0.02)
    several = assemble(assembly.drawing, offset={n: -1e-5 * k for k, n in enumerate(assembly.names)})  # no two alike
    with pytest.raises(wr.StoppedError):
        wr.prepare(several, stop=After(times))
    with pytest.raises(wr.StoppedError):
        wr.free_space(assembly, *assembly.names[:2], stop=After(times))
    assert wr.sweep(assembly, [0.02, 0.03], wr.Pull(assembly.names[-1], (0, 1)), stop=After(times)).steps == ()


def test_a_full_answer_that_was_stopped_can_be_asked_for_again() -> None:
    live = wr.Live(wr.patterns.chain(4, joint="jigsaw", gap=0.02))
    goal = wr.Pull("b4", (0.0, 1.0))
    live.flex(goal)
    live.design(gap=0.021)
    quick = live.flex(goal)
    with pytest.raises(wr.StoppedError):
        live.settle(goal, stop=After(0))
    full = live.settle(goal)
    assert full.objective == pytest.approx(wr.flex(live.assembly, goal, search=0).objective, rel=1e-6)
    assert quick.objective is not None
    assert full.objective is not None
    assert quick.objective <= full.objective * (1 + 1e-6)


def grid_of(side: int) -> wr.Assembly:
    return wr.patterns.grid(side, side, joint="tee", gap=0.02)


@pytest.mark.parametrize("seed", range(1))
def test_with_few_parts_that_give_way_a_drag_is_safe_and_settles_as_with_all(seed):
    random = np.random.default_rng(seed)
    assembly = grid_of(9)
    some, all_of_them = wr.Live(assembly), wr.Live(assembly)
    part = int(random.integers(1, len(assembly.parts)))
    grip, angle = assembly.rest[part, :2], random.uniform(0, 2 * np.pi)
    target = grip + random.uniform(0.01, 0.5) * np.array([np.cos(angle), np.sin(angle)])
    start = "rest"
    for within in (5, 20, 40, None):
        shot = some.drag(assembly.names[part], tuple(grip), tuple(target), start=start, within=within, seconds=60)
        start = "here"
        assert overlap(assembly, shot.motion) < 1e-9
        if shot.settled:
            break
    other = all_of_them.drag(assembly.names[part], tuple(grip), tuple(target), start="rest", seconds=60)
    assert shot.settled
    assert shot.distance == pytest.approx(other.distance, abs=0.02 * assembly.gap)


def test_a_drag_goes_on_where_the_answer_about_finer_outlines_ended():
    jigsaw = wr.read(JIGSAW, gap=1.0, fix=["p1"])
    live, pull = wr.Live(jigsaw), wr.Pull("p20", (1.0, 0.0))
    answer = live.settle(pull)
    grip = jigsaw.rest[jigsaw.names.index("p13"), :2]
    there = grip_at(jigsaw, "p13", grip, answer.motion)
    here = live.drag("p13", tuple(grip), tuple(there), start="answer", goals=pull)
    assert np.abs(here.motion - answer.motion).max() < 0.1 * np.abs(answer.motion).max()
    back = live.drag("p13", tuple(grip), tuple(there - 20.0), seconds=20.0)
    assert back.distance < 0.1
    assert max(overlap(jigsaw, shot.motion) for shot in (here, back)) < 1e-6
    smaller = live.design(gap=1.2)
    assert overlap(smaller, live.drag("p13", tuple(grip), tuple(grip), start="rest").motion) < 1e-6


@pytest.mark.parametrize("seed", [0])
def test_the_next_drag_begins_where_nothing_overlaps_however_short_the_time(seed):
    assembly, random = wr.patterns.grid(5, 5, joint="tee", gap=0.01), np.random.default_rng(seed)
    live, names = wr.Live(assembly), [p.name for p in assembly.parts if not p.fixed]
    for _ in range(6):
        part = random.choice(names)
        at = np.array(assembly.parts[assembly.names.index(part)].at[:2])
        way = random.normal(size=2)
        way *= 0.1 / np.hypot(*way)
        for step in range(1, 8):
            live.drag(part, tuple(at), tuple(at + step * way), seconds=0.0)
            last = live._dragged
            inner = of_parts(last.ready.assembly, last.ready.bodies, last.state.inner[None])[0]
            assert overlap(assembly, inner) == 0


def test_a_stop_leaves_everything_where_it_was_or_further():
    live = wr.Live(wr.patterns.grid(6, 6, joint="tee", gap=0.02))
    shot = live.drag("b6-6", (5.0, 5.0), (6.0, 5.0), stop=Now())
    assert not shot.settled
    assert shot.distance <= 1.0 + 1e-9
    assert not live.flex(wr.Pull("b6-6", (1, 0)), stop=Now()).settled


def test_freedoms_of_a_part_move_it():
    live = wr.Live(wr.patterns.grid(4, 4, joint="tee", gap=0.02))
    for mode in live.wiggle("b3-2", count=2):
        k = live.assembly.names.index("b3-2")
        assert np.abs(mode.frames[:, k]).max() > 0.005
        for shown in mode.frames:
            assert overlap(live.assembly, shown) < 1e-12


def test_glued_parts_and_stacked_sheets_stay_so_among_few():
    assembly = grid_of(6)
    names = assembly.names
    live = wr.Live(assembly)
    live.design(glue=[[names[14], names[15]], [names[20], names[21], names[22]]])
    grip = assembly.rest[14, :2]
    shot = live.drag(names[14], tuple(grip), (grip[0] + 0.05, grip[1] + 0.12), within=6, seconds=60)
    assert overlap(live.assembly, shot.motion) < 1e-9
    turn = shot.motion[14, 2]
    arm = assembly.rest[15, :2] - assembly.rest[14, :2]
    rigid = shot.motion[14, :2] + np.array([[np.cos(turn) - 1, -np.sin(turn)], [np.sin(turn), np.cos(turn) - 1]]) @ arm
    assert shot.motion[15] == pytest.approx([*rigid, turn], abs=1e-9)


def test_only_few_parts_move_and_others_that_hold_are_not_taken_for_fixed():
    live = wr.Live(grid_of(9))
    part = live.assembly.names[40]
    grip = live.assembly.rest[40, :2]
    shot = live.drag(part, tuple(grip), (grip[0] + 0.3, grip[1]), within=9, seconds=60)
    moved = np.abs(shot.motion).max(axis=1) > 0
    assert 1 < moved.sum() <= 9
    assert not shot.settled
    assert shot.blocking == ()
    assert shot.distance > 0.1
