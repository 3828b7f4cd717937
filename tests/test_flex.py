"""Questions put to flex: what leaves and what blocks it, contacts, stopping, many questions on one assembly, glue and gaps."""

from __future__ import annotations

import math
import threading
from dataclasses import replace

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flex_truth import Ground, check_safe, climbed, improved, off_outline, unbalanced, value_of
from tests.flexing import about, box, case_assembly, part_at, polygon_part, row_of
from tests.oracle import blocks, closed_forms
from tests.oracle.closed_forms import frame, rectangle, regular
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, JointGap, Pull, Turn, W

CLOSE = 1e-6
SLOT = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 2.1), (4, 2.1), (4, 3.1), (0, 3.1)]  # open to the right, y from 1 to 2.1
FLOOR = box("floor", -2, -1, 2, 0, fixed=True)
BLOCK = box("b", -0.5, 0.01, 0.5, 1.01)


def flex(parts, *goals, gap=0.0, **said):
    """The climb from rest: what the search beyond it adds is tested elsewhere."""
    answer = wr.flex(assemble(Drawing(tuple(parts), goals=goals, gap=gap, **said)), search=0)
    check_safe(answer)
    return answer


def slot(*others):
    return [polygon_part("slot", SLOT, fixed=True), box("peg", 1.05, 1.05, 2.05, 2.05), *others]


def chain(joint="tee", n=3, gap=0.02, **said):
    drawing = replace(row_of([shapely.Polygon(blocks.outline(joint))] * n), gap=gap, **said)
    return assemble(drawing)


# -- what leaves, what turns, what blocks ---------------------------------------------------------------------------


def test_peg_leaves_an_open_slot():
    answer = flex(slot(), Pull("peg", (1, 0)))
    assert (answer.verdict, answer.objective, answer.leaves, answer.turns) == ("unbounded", None, ("peg",), ())
    assert answer.path == "checked"


@pytest.mark.parametrize(("away", "thick"), [(5.0, 1.0), (8.0, 0.01), (200.0, 0.01)])
def test_peg_stops_at_a_wall_outside_the_slot(away, thick):
    wall = box("wall", away, -500, away + thick, 500, fixed=True)
    answer = flex(slot(wall), Pull("peg", (1, 0)))
    assert answer.verdict in ("proven", "optimal")
    assert answer.path == "checked"
    assert answer.objective == pytest.approx(away - 2.05, rel=CLOSE)


def test_peg_pushes_a_loose_part_out_of_the_way():
    answer = flex(slot(box("q", 6, 1, 7, 2)), Pull("peg", (1, 0)))
    assert answer.verdict == "unbounded"
    assert "peg" in answer.leaves


def test_two_parts_that_must_go_together():
    answer = flex([FLOOR, box("a", -0.5, 0.01, 0.5, 1), box("b", -1, 1.01, 1, 2)], Pull("a", (0, 1)))
    assert answer.verdict == "unbounded"
    assert set(answer.leaves) == {"a", "b"}


def test_interlocked_parts_go_together():
    parts = [replace(p, fixed=False) for p in wr.patterns.chain(3, joint="tee", gap=0.02).drawing.parts]
    answer = flex([box("floor", -5, -2, 5, -0.6, fixed=True), *parts], Pull("b2", (0, 1)), gap=0.02)
    assert answer.verdict == "unbounded"
    assert set(answer.leaves) == {"b1", "b2", "b3"}


def bent_channel(*others, width=1.1):
    """Right, then up and out; block and channel's height are 1 and `width`."""
    low = polygon_part("low", [(0, -1), (5, -1), (5, 4), (4, 4), (4, 0), (0, 0)], fixed=True)
    high = polygon_part("high", [(0, width), (4 - width, width), (4 - width, 4), (0, 4)], fixed=True)
    return [low, high, box("b", 0.5, 0.05, 1.5, 1.05), *others]


@pytest.mark.parametrize("direction", [(1, 1), (1, 0.2), (0.2, 1)])
def test_bent_channel_is_followed_or_the_search_stops_in_it(direction):
    answer = flex(bent_channel(), Pull("b", direction))
    assert answer.path == "checked"
    assert answer.verdict not in ("proven", "optimal") or climbed(
        answer, Ground(answer.assembly)
    ) <= answer.objective * (1 + 1e-5)


def test_wide_bent_channel_is_followed_to_its_lid():
    answer = flex(bent_channel(box("lid", 2, 4.01, 4.5, 5, fixed=True), width=1.6), Pull("b", (1, 1)))
    assert answer.verdict in ("proven", "optimal", "stationary")
    assert answer.objective == pytest.approx((2.5 + 2.96) / math.sqrt(2), rel=CLOSE)


@pytest.mark.parametrize("wall", [0.5, 0.01])
def test_thin_box_holds_a_block(wall):
    shape = shapely.Polygon(rectangle(20 + 2 * wall, 20 + 2 * wall), [rectangle(20, 20)])
    answer = flex([part_at("box", shape, fixed=True), box("b", -0.5, -0.5, 0.5, 0.5)], Pull("b", (1, 0.3)))
    assert answer.objective == pytest.approx(9.5 * 1.3 / math.hypot(1, 0.3), rel=CLOSE)


def test_round_disc_turns_in_a_round_hole():
    hole = part_at("hole", frame(regular(32, 1.05)), fixed=True)
    answer = flex([hole, part_at("disc", shapely.Polygon(regular(32, 1.0)))], Turn("disc", "cw"))
    assert (answer.verdict, answer.leaves, answer.turns) == ("unbounded", (), ("disc",))


def test_polygon_that_nearly_fills_its_hole_does_not_turn():
    """Corner circle 1.0 against apothem 1.004 cos(pi / 32) = 0.9992."""
    hole = part_at("hole", frame(regular(32, 1.004)), fixed=True)
    answer = flex([hole, part_at("disc", shapely.Polygon(regular(32, 1.0)))], Turn("disc"))
    limit = math.pi / 32 - math.acos(1.004 * math.cos(math.pi / 32))
    assert answer.verdict in ("proven", "optimal")
    assert answer.objective == pytest.approx(limit, rel=CLOSE)


@pytest.mark.parametrize(("joint", "point"), [("tee", (0.0, 0.0)), ("round", (-300.0, 200.0)), ("hook", (-30.0, 20.0))])
def test_value_is_the_same_and_the_path_free_wherever_the_reference_points_are(joint, point):
    """Outlines drawn in assembly coordinates, "at" left out: the path between waypoints must be free for these motions too."""
    drawing = chain(joint, 6, 0.03).drawing
    one, other = (wr.flex(assemble(d), search=0) for d in (drawing, about(drawing, point)))
    check_safe(other)
    assert other.objective == pytest.approx(one.objective, rel=CLOSE)


# -- contacts -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", blocks.JOINTS)
@pytest.mark.parametrize(
    "goal", [Pull("b3", (0, 1)), Pull("b3", (1, -2), (2.5, 0.5)), W("b2", (0.3, 0.1, -1.0))], ids=str
)
def test_contacts_balance_the_pull(joint, goal):
    answer = wr.flex(chain(joint), goal, search=0)
    ground = Ground(answer.assembly)
    assert answer.verdict in ("proven", "optimal", "stationary")
    if answer.verdict in ("proven", "optimal"):  # else virtual walls hold it too, which are no contacts
        assert unbalanced(answer, ground) <= 1e-3
    assert off_outline(answer, ground) <= 1e-6 * ground.size
    assert all(math.hypot(*c.normal) == pytest.approx(1, abs=1e-12) for c in answer.contacts)
    assert all(c.force > 0 for c in answer.contacts)


@pytest.mark.parametrize("joint", blocks.JOINTS)
@pytest.mark.parametrize("goal", [W("b2", (0.3, 0.1, -1.0)), Pull("b3", (1, -2), (2.5, 0.5))], ids=str)
def test_small_chain_cannot_be_bettered_nearby(joint, goal):
    """Also where the answer says that a branch is left open."""
    assert improved(wr.flex(chain(joint), goal, search=0)) <= 1e-5


def test_peg_against_two_sides_shares_the_pull():
    """Each side takes up its component of the pull; normals point from the first part into the second."""
    answer = wr.flex(case_assembly(closed_forms.square_shift(1, 0.05, (3, 4))), search=0)
    taken = sum(np.array(c.normal) * c.force * (1 if c.parts[1] == "p1" else -1) for c in answer.contacts)
    assert taken == pytest.approx([-0.6, -0.8], abs=1e-4)


# -- the question ---------------------------------------------------------------------------------------------------


def test_directions_are_normalised_and_weights_multiply():
    assembly = chain()
    one = wr.flex(assembly, Pull("b3", (0, 1)), search=0).objective
    assert wr.flex(assembly, Pull("b3", (0, 17)), search=0).objective == pytest.approx(one, rel=CLOSE)
    assert wr.flex(assembly, Pull("b3", (0, 1), weight=3.0), search=0).objective == pytest.approx(3 * one, rel=CLOSE)
    assert wr.flex(assembly, [Pull("b3", (0, 1))] * 2, search=0).objective == pytest.approx(2 * one, rel=CLOSE)


def test_point_of_a_pull_counts():
    assembly = chain()
    goal = Pull("b3", (0, 1), (2.5, 0.5))
    answer = wr.flex(assembly, goal, search=0)
    assert answer.objective == pytest.approx(float(value_of(assembly, [goal], answer.motion)), abs=1e-13)
    assert answer.objective > wr.flex(assembly, Pull("b3", (0, 1)), search=0).objective


def test_nothing_fixed_or_nothing_pulled_is_an_error():
    loose = replace(chain().drawing, parts=tuple(replace(p, fixed=False) for p in chain().drawing.parts))
    with pytest.raises(wr.InputError, match="fix"):
        wr.flex(assemble(loose), search=0)
    with pytest.raises(wr.InputError, match="pull"):
        wr.flex(assemble(replace(chain().drawing, goals=())), search=0)
    still = replace(chain().drawing, parts=tuple(replace(p, fixed=True) for p in chain().drawing.parts))
    with pytest.raises(wr.InputError):
        wr.flex(assemble(still), search=0)


def test_parts_that_touch_at_rest_are_named():
    with pytest.raises(wr.TouchingError) as error:
        wr.flex(chain(gap=0.0), search=0)
    assert set(error.value.parts) in ({"b1", "b2"}, {"b2", "b3"})
    assert error.value.clearance == pytest.approx(0, abs=1e-12)
    assert "gap" in str(error.value)
    assert "\n" not in str(error.value)


def test_inputs_are_left_alone():
    assembly = chain()
    before = [r.outer.copy() for p in assembly.parts for r in p.regions]
    wr.flex(assembly, search=0)
    after = [r.outer for p in assembly.parts for r in p.regions]
    assert all(np.array_equal(x, y) for x, y in zip(before, after, strict=True))


def test_answers_repeat():
    one, other = wr.flex(chain("hook", 6), search=0), wr.flex(chain("hook", 6), search=0)
    assert np.array_equal(one.motion, other.motion)
    assert one.contacts == other.contacts


# -- stopping, progress ---------------------------------------------------------------------------------------------


class After:
    """Set once it was asked `count` times."""

    def __init__(self, count):
        self.left = count

    def is_set(self):
        self.left -= 1
        return self.left < 0


def test_stopped_before_it_began():
    event = threading.Event()
    event.set()
    answer = wr.flex(wr.patterns.grid(3, 3, gap=0.01), stop=event, search=0)
    check_safe(answer)
    assert answer.verdict == "stopped"
    assert answer.objective >= 0


@pytest.mark.parametrize("count", [1, 3, 8, 20, 40])
def test_stopped_on_the_way_is_safe(count):
    assembly = wr.patterns.jigsaw(3, 3, gap=0.02, seed=1)
    best = wr.flex(assembly, search=0).objective
    answer = wr.flex(assembly, stop=After(count), search=0)
    check_safe(answer)
    assert answer.verdict == "stopped" or answer.objective == pytest.approx(best, rel=CLOSE)
    assert answer.objective <= best * (1 + 1e-5)
    assert answer.path == "checked"  # cut back to where it is


# -- many questions -------------------------------------------------------------------------------------------------

QUESTIONS = [Pull("b3", (0, 1)), Turn("b2", "cw"), Pull("b2", (1, 1), (1.5, 0.5)), W("b3", (0, -1, 0.5))]


@pytest.mark.parametrize("joint", ["tee", "round"])
def test_prepared_gives_the_same_answers(joint):
    assembly = chain(joint)
    ready = wr.prepare(assembly)
    for goal in [*QUESTIONS, QUESTIONS[0]]:
        mine, fresh = ready.flex(goal, search=0), wr.flex(assembly, goal, search=0)
        assert np.array_equal(mine.motion, fresh.motion)
        assert mine.verdict == fresh.verdict


@pytest.mark.parametrize("goal", QUESTIONS, ids=lambda g: type(g).__name__)
def test_start_from_an_earlier_answer(goal):
    ready = wr.prepare(chain())
    first = ready.flex(QUESTIONS[0], search=0)
    answer = ready.flex(goal, start=first)
    check_safe(answer)
    assert answer.objective == pytest.approx(ready.flex(goal, search=0).objective, rel=CLOSE)


def test_start_of_another_assembly_is_refused():
    other = wr.flex(chain(), search=0)
    with pytest.raises(wr.InputError, match="start"):
        wr.prepare(chain()).flex(QUESTIONS[0], start=other)


# -- glue, ignore, gaps of single joints ----------------------------------------------------------------------------


@pytest.mark.parametrize("goal", [Pull("one", (1, 0.3)), Turn("one"), Pull("one", (0, 1), (0.5, 0.5))], ids=str)
def test_glued_halves_are_one_part(goal):
    hole = part_at("hole", frame(rectangle(1.1, 1.1)), fixed=True)
    whole = flex([hole, box("one", -0.5, -0.5, 0.5, 0.5)], replace(goal))
    halves = [part_at("one", shapely.Polygon(rectangle(0.5, 1, (-0.25, 0)))), box("two", 0, -0.5, 0.5, 0.5)]
    glued = flex([hole, *halves], goal, glue=(("one", "two"),))
    assert glued.objective == pytest.approx(whole.objective, rel=CLOSE)
    assert glued.motion[1, 2] == glued.motion[2, 2]


def test_part_glued_to_a_fixed_one_stands():
    answer = flex(chain().drawing.parts, Pull("b3", (0, 1)), gap=0.02, glue=(("b1", "b2"),))
    two = wr.flex(chain(n=2), search=0)
    assert np.all(answer.motion[1] == 0)
    assert answer.objective == pytest.approx(two.objective, rel=CLOSE)


def test_ignored_parts_pass_through_each_other():
    wall = box("wall", 3, -1, 3.5, 2, fixed=True)
    far = box("far", 9, -90, 9.5, 90, fixed=True)
    stopped = flex([FLOOR, BLOCK, wall, far], Pull("b", (1, 0)))
    assert stopped.objective is None or stopped.objective >= 2.5 * (1 - CLOSE)
    through = flex([FLOOR, BLOCK, wall, far], Pull("b", (1, 0)), ignore=(("wall", "b"), ("b", "floor")))
    assert through.objective == pytest.approx(8.5, rel=CLOSE)


@pytest.mark.parametrize("joint", ["tee", "swallowtail", "hook"])
def test_one_looser_joint_lies_between(joint):
    single, double = (wr.flex(chain(joint, 4, gap), search=0).objective for gap in (0.01, 0.02))
    mixed = wr.flex(chain(joint, 4, 0.01, gaps=(JointGap(("b2", "b3"), 0.02),)), search=0)
    check_safe(mixed)
    assert single * 1.01 < mixed.objective < double * 0.99


@pytest.mark.parametrize(("far", "thick"), [(10.0, 0.01), (1000.0, 1.0)])
def test_wall_far_away_stops_a_block_from_the_floor(far, thick):
    answer = flex([FLOOR, BLOCK, box("wall", -3 * far, far, 3 * far, far + thick, fixed=True)], Pull("b", (0, 1)))
    assert answer.path == "checked"
    if answer.verdict in ("proven", "optimal"):
        assert answer.objective == pytest.approx(far - 1.01, rel=CLOSE)
    else:  # it may also go round the wall
        assert answer.verdict == "unbounded"
        assert np.abs(answer.waypoints[:, 1, 0]).max() > 3 * far - 1


@pytest.mark.parametrize("direction", [(1, 1), (1, 0.2)])
def test_wide_bent_channel_is_followed_out(direction):
    """No place in it where the block is held against the pull."""
    answer = flex(bent_channel(width=1.6), Pull("b", direction))
    assert (answer.verdict, answer.leaves) == ("unbounded", ("b",))


@pytest.mark.parametrize("wall", [0.5, 0.01])
def test_blocks_in_a_thin_box_push_or_pass_each_other(wall):
    shape = shapely.Polygon(rectangle(20 + 2 * wall, 20 + 2 * wall), [rectangle(20, 20)])
    loose = [box("b", -0.5, -0.5, 0.5, 0.5), box("c", 2, -0.5, 3, 0.5), box("d", 5, -0.6, 6, 0.4)]
    answer = flex([part_at("box", shape, fixed=True), *loose], Pull("b", (1, 0)))
    assert answer.verdict in ("proven", "optimal", "stationary")
    assert 7.5 * (1 - CLOSE) <= answer.objective <= 9.5 * (1 + CLOSE)


def test_loose_part_between_peg_and_wall_is_pushed_or_passed():
    answer = flex(slot(box("q", 6, 1, 7, 2.1), box("wall", 12, -40, 12.2, 40, fixed=True)), Pull("peg", (1, 0)))
    if answer.verdict == "unbounded":  # the peg has found the way round the wall
        assert answer.path == "checked"
    else:
        assert answer.verdict in ("proven", "optimal", "stationary")
        assert 8.95 * (1 - CLOSE) <= answer.objective <= 9.95 * (1 + CLOSE)


def test_block_between_two_plates_turns_without_end_where_they_are_wide_apart():
    answer = flex([FLOOR, box("top", -2, 2, 2, 3, fixed=True), box("b", -0.5, 0.5, 0.5, 1.5)], Turn("b"))
    assert answer.verdict == "unbounded"
    assert answer.turns == ("b",)


def test_glued_links_move_as_one_however_they_are_gapped():
    """A chain of four with its last two blocks glued: the same as with one long last block."""
    profile = blocks.PROFILES["tee"]
    parts = row_of([shapely.Polygon(blocks.outline("tee"))] * 4).parts
    tab, pocket = profile + np.array([1.5, 0]), profile[::-1] + np.array([3.5, 0])
    long = [(1.5, -0.5), (3.5, -0.5), *pocket, (3.5, 0.5), (1.5, 0.5), *tab]
    single = (*parts[:2], part_at("b3", shapely.Polygon(long), (2.0, 0.0, 0.0)))
    goal = Pull("b3", (0, 1), (3.0, 0.0))
    glued = flex(parts, goal, gap=0.02, glue=(("b3", "b4"),))
    assert glued.objective == pytest.approx(flex(single, goal, gap=0.02).objective, rel=CLOSE)


def test_negative_weight_pulls_the_other_way():
    assembly = chain("hook")
    down = wr.flex(assembly, Pull("b3", (0, -1)), search=0).objective
    assert wr.flex(assembly, Pull("b3", (0, 1), weight=-1.0), search=0).objective == pytest.approx(down, rel=CLOSE)
