"""Importance of gaps, against closed forms and against questions asked again from nothing."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
import shapely
from benchmarks.attack.families import draw
from benchmarks.attack.oracle import Ground
from benchmarks.attack.studies import STUDY_GAP
from scipy.optimize import linprog

import wiggleroom as wr
from tests.flexing import box, part_at, polygon_part, slot
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, JointGap, Pull, Turn
from wiggleroom.sensitivity.dual_face import DualFace
from wiggleroom.sensitivity.rank import ranges, rank_at_once


def three_stops() -> Drawing:
    """A bar in a tray, pushed up onto three blocks at one height, which share its load in many ways; it may slide to either side."""
    blocks = [
        box(name, x - 0.1, 0.0, x + 0.1, 1.0, fixed=True) for name, x in (("left", -4), ("middle", 1), ("right", 3))
    ]
    tray = [(-9, -3), (9, -3), (9, 2), (6.5, 2), (6.5, -1), (-6.5, -1), (-6.5, 2), (-9, 2)]
    parts = box("bar", -6.0, -1.0, 6.0, 0.0), *blocks, polygon_part("tray", tray, fixed=True)
    return Drawing(parts, 0.1, goals=(Pull("bar", (0.0, 1.0), (0.0, -0.5)),))


def table_on_humps() -> Drawing:
    """A table on three humps under a low ceiling, pushed down beside its middle; it may slide further to the right than to the left."""
    humps = [
        polygon_part(name, [(x - 0.7, -2), (x + 0.7, -2), (x + 0.2, 0), (x - 0.2, 0)], fixed=True)
        for name, x in (("left", -6), ("middle", -1), ("right", 4))
    ]
    table = polygon_part("table", [(-8, 0), (8, 0), (8, 2), (1, 2), (1, 6), (-1, 6), (-1, 2), (-8, 2)])
    tray = shapely.box(-12, -5, 12, 10) - shapely.box(-9, -2, 9.5, 7)
    goal = Pull("table", (0.0, -1.0), (0.3, 5.0))
    return Drawing((table, *humps, part_at("tray", tray, fixed=True)), 0.2, goals=(goal,))


def block_at_a_wall() -> Drawing:
    """A block in a tray, pulled against a wall along which it may slide by a quarter of its side, up or down."""
    tray = [(0, -3), (6, -3), (6, 7), (0, 7), (0, 5), (4.4, 5), (4.4, -1), (0, -1)]
    parts = box("wall", -2, -3, 0, 7, fixed=True), box("block", 0, 0, 4, 4), polygon_part("tray", tray, fixed=True)
    return Drawing(parts, 0.1, goals=(Pull("block", (-1.0, 0.0)),))


def ranked(assembly: wr.Assembly, **how: Any) -> wr.Ranking:
    """Importance for the motion that a climb from rest ends at: the differences beside it begin there, too."""
    return wr.rank(wr.flex(assembly, search=0), **how)


def two_stops() -> Drawing:
    """A bar with a slot, stopped by a wall before its nose and by a peg in its slot at the same time."""
    ring = [(0, -2), (10, -2), (10, 2), (0, 2)]
    material = shapely.Polygon(ring, [[(3, -1), (7, -1), (7, 1), (3, 1)]])
    parts = (
        box("wall", 10.5, -1.0, 11.5, 1.0, fixed=True),
        box("peg", 3.5, -0.6, 4.5, 0.6, fixed=True),
        part_at("bar", material, (5.0, 0.0, 0.0)),
    )
    return Drawing(parts, goals=(Pull("bar", (1.0, 0.0)),))


def of(ranking: wr.Ranking, name: str) -> tuple[float, float]:
    """What more and less gap round a part are worth."""
    k = ranking.answer.assembly.names.index(name)
    return float(ranking.looser[k]), float(ranking.tighter[k])


def again(drawing: Drawing, name: str, h: float) -> float:
    """Central difference by the gap round one part, everything worked out from nothing."""
    high, low = (wr.flex(assemble(drawing, offset={name: -s * h / 2}), search=0).objective for s in (1, -1))
    assert high is not None
    assert low is not None
    return (high - low) / (2 * h)


@pytest.mark.parametrize("by", ["duals", "differences"])
def test_only_what_stops_a_block_counts(by: str) -> None:
    ranking = ranked(assemble(slot()), by=by)
    assert ranking.answer.objective == pytest.approx(0.3, abs=1e-6)
    assert of(ranking, "block") == pytest.approx((0.5, 0.5), abs=1e-5)
    assert of(ranking, "right") == pytest.approx((0.5, 0.5), abs=1e-5)
    assert of(ranking, "left") == pytest.approx((0.0, 0.0), abs=1e-5)
    assert ranking.percent.sum() == pytest.approx(100)
    assert ranking.unique.all()


@pytest.mark.parametrize("by", ["duals", "differences"])
def test_two_stops_at_once_differ_on_both_sides(by: str) -> None:
    ranking = ranked(assemble(two_stops()), by=by)
    assert ranking.answer.objective == pytest.approx(0.5, abs=1e-6)
    for stop in ("wall", "peg"):  # loosening one leaves the other; tightening one is felt at once
        assert of(ranking, stop) == pytest.approx((0.0, 0.5), abs=1e-4)
    assert of(ranking, "bar") == pytest.approx((0.5, 0.5), abs=1e-4)
    assert dict(zip(ranking.answer.assembly.names, ranking.unique, strict=True)) == {
        "wall": False,
        "peg": False,
        "bar": True,
    }


def seesaw(foot: float) -> Drawing:
    """A bar pulled down onto two posts with feet of a width, which may slide to either side as far as two stops let its keel."""
    keel = [(-2, 0.5), (-2, 0.02), (-0.1, 0.02), (-0.1, -0.8), (0.1, -0.8), (0.1, 0.02), (2, 0.02), (2, 0.5)]
    posts = []
    for name, x in (("left post", -1.0), ("right post", 1.0)):
        top = [(x + foot / 2, 0.0), (x - foot / 2, 0.0)] if foot else [(x, 0.0)]
        posts.append(polygon_part(name, [(x - 0.1, -1.0), (x + 0.1, -1.0), *top], fixed=True))
    stops = box("left stop", -0.6, -1.0, -0.4, -0.3, fixed=True), box("right stop", 0.4, -1.0, 0.6, -0.3, fixed=True)
    return Drawing((polygon_part("bar", keel), *posts, *stops), goals=(Pull("bar", (0.0, -1.0)),))


def again_one_sided(drawing: Drawing, name: str, h: float) -> float:
    """Difference on one side by the gap round one part, everything worked out from nothing."""
    at, beside = (wr.flex(assemble(drawing, offset={name: -x / 2}), search=0).objective for x in (0.0, h))
    assert at is not None
    assert beside is not None
    return (beside - at) / abs(h)


@pytest.mark.parametrize("foot", [0.1, 0.0])
def test_a_bar_that_may_slide_on_its_posts_lets_each_count_for_what_it_holds_at_either_end(foot: float) -> None:
    """The bar lies anywhere between two stops: with a lower post it goes towards that one, with a higher one away from it."""
    ranking = ranked(assemble(seesaw(foot)))
    for post in ("left post", "right post"):
        looser, tighter = of(ranking, post)
        assert not ranking.unique[ranking.answer.assembly.names.index(post)]
        assert looser == pytest.approx(again_one_sided(seesaw(foot), post, 1e-5), rel=1e-3)
        assert tighter == pytest.approx(-again_one_sided(seesaw(foot), post, -1e-5), rel=1e-3)
        assert looser > tighter > 0
    quick = rank_at_once(ranking.answer)
    for post in ("left post", "right post"):
        assert not quick.unique[ranking.answer.assembly.names.index(post)]
    assert not quick.joint_unique.any()


def joint_again(drawing: Drawing, joint: tuple[str, str], h: float) -> float:
    """Difference on one side by the gap of one joint, everything worked out from nothing."""
    own = replace(drawing, gaps=(JointGap(joint, drawing.gap + h),))
    at, beside = (wr.flex(assemble(each)).objective for each in (drawing, own))
    assert at is not None
    assert beside is not None
    return (beside - at) / h


def test_a_ranking_is_that_of_the_answer_not_of_the_border_of_a_cell(tmp_path: Path) -> None:
    """A wedge that turns until it jams between others: one round in new cells ended lower, held by nothing that touches."""
    made = draw(2505)[1]
    assert made is not None
    path = tmp_path / "wedges.json"
    path.write_text(json.dumps(made | {"gap": STUDY_GAP * Ground(made).size}))
    answer = wr.flex(wr.read(str(path)))
    assert answer.warm_start is not None
    assert answer.warm_start.value == pytest.approx(answer.objective, rel=1e-6)
    ranking = wr.rank(answer)
    assert ranking.tighter.max() > 1.0  # both contacts hold with more than 1 rad per mm


def test_exact_solves_what_is_not_unique_again() -> None:
    ranking = ranked(assemble(two_stops()), exact=True)
    assert of(ranking, "peg") == pytest.approx((0.0, 0.5), abs=1e-4)
    assert ranking.by == "duals"


def test_of_glued_parts_only_the_one_that_touches_counts() -> None:
    parts = (
        box("wall", 10.4, -1.0, 11.0, 3.0, fixed=True),
        box("floor", -1.0, -1.2, 10.2, -0.1, fixed=True),
        box("ceiling", -1.0, 2.1, 10.2, 3.2, fixed=True),
        box("rear", 0.0, 0.0, 5.0, 2.0),
        box("front", 5.0, 0.0, 10.0, 2.0),
    )
    drawing = Drawing(parts, glue=(("rear", "front"),), goals=(Pull("rear", (1.0, 0.0)),))
    ranking = ranked(assemble(drawing))
    assert of(ranking, "front") == pytest.approx((0.5, 0.5), abs=1e-5)
    assert of(ranking, "rear") == pytest.approx((0.0, 0.0), abs=1e-5)


ASSEMBLIES = {
    "jigsaw": lambda: wr.patterns.jigsaw(4, 3, gap=0.012, seed=5),
    "revolute": lambda: wr.patterns.chain(4, joint="revolute", gap=0.02),
    "grid of swallowtails": lambda: wr.patterns.grid(3, 3, joint="swallowtail", gap=0.02),
}


@pytest.mark.parametrize("name", ASSEMBLIES)
def test_multipliers_agree_with_asking_again_from_nothing(name: str) -> None:
    assembly = ASSEMBLIES[name]()
    ranking = ranked(assembly)
    for k in ranking.order[: max(2, len(assembly.parts) // 5)]:
        truth = again(assembly.drawing, assembly.names[k], 0.01 * assembly.gap)
        assert ranking.unique[k]
        assert ranking.looser[k] == pytest.approx(truth, rel=0.02)


def test_all_parts_together_are_worth_what_the_gap_is() -> None:
    drawing = wr.patterns.chain(5, joint="tee", gap=0.02).drawing
    ranking = ranked(assemble(drawing))
    high, low = (wr.flex(assemble(drawing, gap=g), search=0).objective for g in (0.0202, 0.0198))
    assert high is not None
    assert low is not None
    assert ranking.looser.sum() == pytest.approx((high - low) / 0.0004, rel=1e-3)


@pytest.mark.parametrize("by", ["duals", "differences"])
def test_a_bar_that_jams_in_a_slot_is_held_by_its_corners(by: str) -> None:
    """Its turn t ends where two corners touch: height cos t + length sin t = width. The cell of the pair ends there as well."""
    length, height, gap = 4.0, 2.0, 0.02
    frame = shapely.Polygon([(-9, -9), (9, -9), (9, 9), (-9, 9)], [[(-7, -1), (7, -1), (7, 1), (-7, 1)]])
    bar = box("bar", -length / 2, -height / 2, length / 2, height / 2)
    parts = (part_at("frame", frame, (0.0, 0.0, 0.0), fixed=True), bar)
    ranking = wr.rank(assemble(Drawing(parts, gap=gap, goals=(Turn("bar", "ccw"),))), by=by)
    turn = ranking.answer.objective
    assert turn is not None
    long, high = length - gap, height - gap
    assert high * np.cos(turn) + long * np.sin(turn) == pytest.approx(height + gap, abs=1e-7)
    narrower = 1 / (long * np.cos(turn) - high * np.sin(turn))  # of the slot's width, and of the bar's both sides
    smaller = (np.cos(turn) + np.sin(turn)) * narrower
    assert of(ranking, "frame") == pytest.approx((narrower, narrower), rel=1e-4)
    assert of(ranking, "bar") == pytest.approx((smaller, smaller), rel=1e-4)
    assert ranking.virtual == 0.0


def loosened_joint(drawing: Drawing, pair: tuple[str, str], more: float) -> float | None:
    """The largest motion when `gaps` gives one joint more gap [mm]."""
    gaps = {frozenset(j.parts): j for j in drawing.gaps}
    own = gaps.get(frozenset(pair), JointGap(pair, drawing.gap)).gap
    gaps[frozenset(pair)] = JointGap(pair, own + more)
    return wr.flex(assemble(replace(drawing, gaps=tuple(gaps.values())))).objective


def offset_chain() -> Drawing:
    drawing = wr.patterns.chain(4, joint="tee", gap=0.02).drawing
    parts = tuple(replace(p, offset=0.003 if p.name in ("b2", "b3") else 0.0) for p in drawing.parts)
    return replace(drawing, parts=parts)


def glued_grid() -> Drawing:
    drawing = wr.patterns.grid(3, 2, joint="tee", gap=0.02).drawing
    return replace(drawing, glue=(("b2-1", "b3-1"),))


@pytest.mark.parametrize(
    "drawing",
    [
        lambda: replace(
            wr.patterns.chain(4, joint="tee", gap=0.02).drawing,
            gaps=(JointGap(("b2", "b3"), 0.035), JointGap(("b1", "b2"), 0.012)),
        ),
        lambda: replace(wr.patterns.grid(2, 2, joint="tee", gap=0.03).drawing, goals=(Turn("b2-2", "ccw"),)),
        offset_chain,
        pytest.param(glued_grid, marks=pytest.mark.slow),
    ],
    ids=["own gaps", "turn", "offsets", "glued"],
)
def test_a_joint_is_worth_what_a_gap_of_its_own_is(drawing: Callable[[], Drawing]) -> None:
    made = drawing()
    ranking = ranked(assemble(made))
    names = ranking.answer.assembly.names
    h, largest = 0.002 * made.gap, ranking.joint_looser.max()
    assert len(ranking.joints)
    for (a, b), worth in zip(ranking.joints.tolist(), ranking.joint_looser, strict=True):
        high, low = (loosened_joint(made, (names[a], names[b]), s * h) for s in (1, -1))
        assert high is not None
        assert low is not None
        assert worth == pytest.approx((high - low) / (2 * h), rel=5e-4, abs=1e-5 * largest)


def slid(direction: tuple[float, float], gap: float) -> Drawing:
    """A block that slides in a wide slot: one of its ends leaves the stretch of the floor that it faced at rest."""
    frame = shapely.Polygon([(-3, -2), (7, -2), (7, 4), (-3, 4)], [[(-1, 0), (5, 0), (5, 2), (-1, 2)]])
    parts = (part_at("frame", frame, (0.0, 0.0, 0.0), fixed=True), box("block", 0, 0, 4, 2))
    return Drawing(parts, gap=gap, goals=(Pull("block", direction),))


@pytest.mark.parametrize("direction", [(0.5, -1.0), (0.1, 1.0)])
def test_a_block_that_has_slid_off_the_stretch_it_faced_is_held_at_its_end(direction: tuple[float, float]) -> None:
    """With more gap the floor keeps its height beyond the stretch, and the block rests on that step; with less it leaves it."""
    made = slid(direction, 0.02)
    ranking = wr.rank(assemble(made))
    value, h = ranking.answer.objective, 1e-4
    assert value is not None
    sides = [loosened_joint(made, ("frame", "block"), s * h) for s in (1, -1)]
    more, less = ((side or np.nan) - value for side in sides)
    assert (ranking.joint_looser[0], ranking.joint_tighter[0]) == pytest.approx((more / h, -less / h), rel=2e-3)
    assert not ranking.joint_unique[0]
    assert ranking.ends == "whole"


def test_a_joint_counts_at_the_place_where_both_of_its_sides_face_each_other() -> None:
    """A bar on two wide blocks: with more gap in one joint it lies on the way between the ends of where it may slide."""
    slide = 0.05
    tray = [(-9, -3), (9, -3), (9, 2), (6 + slide, 2), (6 + slide, -1), (-6 - slide, -1), (-6 - slide, 2), (-9, 2)]
    blocks = box("left", -4.2, 0.0, -3.8, 1.0, fixed=True), box("right", 1.5, 0.0, 2.5, 1.0, fixed=True)
    parts = box("bar", -6.0, -1.0, 6.0, 0.0), *blocks, polygon_part("tray", tray, fixed=True)
    drawing = Drawing(parts, 0.1, goals=(Pull("bar", (0.0, 1.0), (-0.4, -0.5)),))
    ranking = wr.rank(assemble(drawing))
    names = ranking.answer.assembly.names
    for k, pair in enumerate(ranking.joints.tolist()):
        looser, tighter = (joint_again(drawing, tuple(names[j] for j in pair), h) for h in (2e-3, -2e-3))
        assert ranking.joint_looser[k] == pytest.approx(looser, rel=0.15)
        assert ranking.joint_tighter[k] == pytest.approx(tighter, rel=0.15)


def test_parts_that_face_each_other_nowhere_have_no_joint_to_rank() -> None:
    tip = polygon_part("tip", [(10.0, 5.0), (14.0, 1.0), (14.0, 9.0)], fixed=True)
    rails = box("floor", -20, -3, 20, 0, fixed=True), box("roof", -20, 10, 20, 13, fixed=True)
    drawing = Drawing((box("block", 0, 0, 10, 10), tip, *rails), gap=0.2, goals=(Pull("block", (1.0, 0.0)),))
    ranking = ranked(assemble(drawing))
    block, at_tip = of(ranking, "block"), of(ranking, "tip")
    assert min(*block, *at_tip) > 0.4
    assert not any({"block", "tip"} == {ranking.answer.assembly.names[k] for k in pair} for pair in ranking.joints)
    with pytest.raises(wr.InputError, match="face each other nowhere"):
        loosened_joint(drawing, ("block", "tip"), 0.01)


def test_both_ways_put_the_top_fifth_in_the_same_order() -> None:
    assembly = wr.patterns.jigsaw(5, 4, gap=0.01)
    model = wr.prepare(assembly)
    answer = model.flex()
    duals, differences = wr.rank(answer), wr.rank(answer, by="differences", workers=1)
    top = len(assembly.parts) // 5
    assert (duals.order[:top] == differences.order[:top]).all()
    large = duals.unique & (differences.looser > 0.01 * differences.looser.max())
    assert duals.looser[large] == pytest.approx(differences.looser[large], rel=0.02)


def test_what_has_no_end_cannot_be_ranked() -> None:
    drawing = slot()
    drawing = replace(drawing, parts=drawing.parts[:-1], goals=(Pull("block", (0.0, 1.0)),))
    with pytest.raises(wr.InputError, match="nothing stops the motion"):
        ranked(assemble(drawing))
    with pytest.raises(wr.InputError, match="duals or by differences"):
        ranked(assemble(slot()), by="magic")


@pytest.mark.slow
def test_a_grid_of_1024_blocks_is_ranked() -> None:
    answer = wr.flex(wr.patterns.grid(32, 32, joint="tee", gap=0.01), search=0)
    ranking = wr.rank(answer)
    assert np.isfinite(ranking.looser).all()
    assert ranking.percent.sum() == pytest.approx(100)
    assert answer.assembly.names[ranking.order[0]] == "b1-1"


def test_a_ranking_at_once_is_the_same_where_it_is_unique_and_never_surer() -> None:
    answer = wr.flex(wr.patterns.grid(8, 8, joint="tee", gap=0.01), search=0)
    whole, quick = wr.rank(answer), rank_at_once(answer)
    assert whole.ends == "whole"
    assert (~whole.unique).any()
    assert (whole.unique | ~quick.unique).all()
    slack = 1e-4 * whole.looser.max()  # of the linear programs that find the ends, and of solving again
    np.testing.assert_allclose(quick.by_duals, whole.by_duals, atol=slack)
    assert (whole.looser <= quick.looser + slack).all()
    assert (whole.tighter >= quick.tighter - slack).all()


def test_no_derivative_is_shown_that_is_only_rounding() -> None:
    hole = shapely.box(0, 0, 30, 20).difference(shapely.box(5, 5, 25, 15))
    parts = part_at("tray", hole, fixed=True), box("a", 5, 5, 14, 15), box("b", 14, 5, 22, 15)
    ranking = wr.rank(assemble(Drawing(parts, gap=0.2, goals=(Turn("a", "ccw"),))))
    slopes = np.abs([ranking.looser, ranking.tighter])
    assert slopes.max() > 0.1
    assert ((slopes == 0) | (slopes > 1e-9)).all()


def almost_dependent_face() -> tuple[DualFace, sp.csr_matrix, np.ndarray]:
    """A face whose equations depend on each other but for rounding; linear functions on it; the null space without rounding."""
    rng = np.random.default_rng(3)
    exact = rng.integers(-2, 3, (30, 12)).astype(float) @ rng.integers(-2, 3, (12, 40)).astype(float)
    balance = exact + 1e-11 * rng.standard_normal(exact.shape)
    force = 10.0 ** rng.uniform(-2, 0, 40)
    null = np.linalg.svd(exact)[2][12:].T
    return (
        DualFace(force, sp.csr_matrix(balance), np.zeros((40, 0)), np.zeros(0)),
        sp.csr_matrix(rng.random((6, 40))),
        null,
    )


def test_ranges_are_those_of_the_equations_without_rounding() -> None:
    face, worth, null = almost_dependent_face()
    found = ranges(face, worth)
    for row, ends in zip(worth.toarray(), found, strict=True):
        for sign, end in zip((1.0, -1.0), ends, strict=True):
            asked = linprog(sign * row @ null, A_ub=-null, b_ub=face.force, bounds=(None, None))
            if asked.status == 3:  # nothing bounds it
                assert np.isnan(end)
            else:
                assert end == pytest.approx(row @ face.force + sign * asked.fun, rel=1e-6)
    assert np.isfinite(found).any()


@pytest.mark.slow
def test_solves_that_end_in_another_optimum_say_nothing_of_a_gap() -> None:
    ranking = wr.rank(wr.flex(wr.patterns.grid(12, 12, joint="tee", gap=0.01), search=0), exact=True)
    assert not ranking.unique.all()
    assert (ranking.looser > -1e-6).all()  # more gap never takes motion away
    assert ranking.tighter.max() < 20  # 14.6 by the multipliers, for the part that is pulled


def test_with_more_gap_in_a_joint_a_bar_lies_where_the_least_force_makes_it_worth_most() -> None:
    """With less gap it lies where the largest force of that joint loses least; the best place for the left one lies between those met."""
    ranking = wr.rank(assemble(three_stops()))
    names = ranking.answer.assembly.names
    joints = {frozenset(names[k] for k in pair): k for k, pair in enumerate(ranking.joints.tolist())}
    for stop, met in (("left", 0.9), ("middle", 1.0), ("right", 1.0)):
        k = joints[frozenset(("bar", stop))]
        looser, tighter = (joint_again(three_stops(), ("bar", stop), h) for h in (2e-3, -2e-3))
        assert met * looser - 1e-4 <= ranking.joint_looser[k] <= looser + 1e-4
        assert ranking.joint_tighter[k] == pytest.approx(tighter, rel=5e-3)


def test_the_load_moves_to_the_side_to_which_a_table_slides() -> None:
    """Then the left hump need not carry anything, and at most what it does where the table lies furthest to the right."""
    ranking = wr.rank(assemble(table_on_humps()))
    names = ranking.answer.assembly.names
    joints = {frozenset(names[k] for k in pair): k for k, pair in enumerate(ranking.joints.tolist())}
    for hump in ("left", "middle", "right"):
        k = joints[frozenset(("table", hump))]
        looser, tighter = (joint_again(table_on_humps(), ("table", hump), h) for h in (2e-3, -2e-3))
        assert ranking.joint_looser[k] == pytest.approx(looser, rel=5e-3, abs=1e-4)
        assert ranking.joint_tighter[k] == pytest.approx(tighter, rel=5e-3, abs=1e-4)


def test_less_gap_in_a_joint_is_felt_where_a_block_lies_half_beside_the_stretch_that_it_faced() -> None:
    """A step stands up below the block there: all of the gap is lost, wherever it lies."""
    ranking = wr.rank(assemble(block_at_a_wall()))
    (joint,) = ranking.joints.tolist()
    again = joint_again(block_at_a_wall(), tuple(ranking.answer.assembly.names[k] for k in joint), -2e-3)
    assert again == pytest.approx(1.0, abs=1e-3)
    assert ranking.joint_tighter[0] == pytest.approx(again, abs=1e-3)
    assert ranking.joint_looser[0] <= 1 + 1e-6


def test_bolts_in_line_share_a_load_in_any_way() -> None:
    """Two bolts in line along the pull, each between flat sides of holes: either alone could hold, so both ends are nothing and all."""

    def disc(x: float, r: float) -> list[tuple[float, float]]:
        return [(x + r * np.cos(a), r * np.sin(a)) for a in np.pi / 24 + 2 * np.pi * np.arange(24) / 24]

    parts = []
    for name, fixed in (("plate", True), ("slide", False)):
        material = shapely.Polygon(
            [(-0.8, -0.8), (2.3, -0.8), (2.3, 0.8), (-0.8, 0.8)], [disc(0, 0.34), disc(1.5, 0.34)]
        )
        parts.append(part_at(name, material, (0.75, 0.0, 0.0), fixed=fixed))
    for k, x in enumerate((0.0, 1.5)):
        parts.append(polygon_part(f"bolt{k}", disc(x, 0.3)))
    drawing = Drawing(tuple(parts), ignore=(("plate", "slide"),), goals=(Pull("slide", (1.0, 0.0)),))
    ranking = ranked(assemble(drawing))
    for bolt in ("bolt0", "bolt1"):
        assert of(ranking, bolt) == pytest.approx((0.0, 1.0), abs=1e-3)
