"""Proven bounds: never below the truth, near it where they should be, and safe against rounding."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp
import shapely

import wiggleroom as wr
from tests.flexing import (
    box,
    case_assembly,
    displaced,
    mirrored,
    part_at,
    random_assembly,
    random_goals,
    row_of,
    scaled,
)
from tests.oracle import blocks, chain, closed_forms, random_joints
from tests.oracle.slices import Slices
from wiggleroom.assembly.build import assemble
from wiggleroom.bound.branch_and_bound import BranchAndBound
from wiggleroom.bound.joint_constraints import first_ranges, turn_differences
from wiggleroom.bound.joint_multipliers import MULTIPLIERS, LagrangianBound, goal_weights
from wiggleroom.bound.joint_ranges import RegionCuts, joint_ranges
from wiggleroom.bound.outer_regions import outer_regions
from wiggleroom.bound.trigonometric_envelopes import envelope, support
from wiggleroom.deadline import Deadline, WorkBudget
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.outer.outer_facets import facets
from wiggleroom.freespace.outer.outer_region import with_narrower_intervals
from wiggleroom.program.objectives import PointMotion, objective
from wiggleroom.search.answer import Bound
from wiggleroom.search.prepare import survey

pytest.importorskip("highspy")

BOUNDED = {f"{k} {case.name}": case for k, case in enumerate(closed_forms.bounded())}
LOOSE = ("row of", "24-gon in a square")  # held by joints that do not close: nothing tight is promised
CHAINS = [(joint, gap, n) for joint in blocks.JOINTS for gap in (0.01, 0.03) for n in (2, 10)]
ROUNDING = 1e-12
WHILE = 0.3
"""So long a proof is tried that cannot succeed [s]: the longer, the more it could wrongly cut off."""


@lru_cache(maxsize=1)
def joint_regions(assembly):
    """Outer regions of the joints of an assembly, for all that is asked about it."""
    surveyed = survey(assembly)
    return surveyed, *outer_regions(surveyed, WorkBudget())


def bound_of(assembly, goals, cut, seconds):
    """What a proof says that looks for motions worth more than `cut`, whatever the truth is."""
    surveyed, links, regions = joint_regions(assembly)
    goal = objective(assembly, surveyed.bodies, goals)
    assert isinstance(goal, PointMotion)
    ranges = first_ranges(surveyed.bodies.fixed, links, regions)
    held = surveyed.bodies.fixed[goal.body] | np.isfinite(ranges.far[goal.body])
    if not held.all():
        return math.inf
    budget = WorkBudget(stop=Deadline(seconds))
    return BranchAndBound(surveyed, links, regions, goal, cut, budget, lambda *_: None).run(ranges, cut)


# -- never below the truth -------------------------------------------------------------------------------------------


def look(seed, most=3):
    """A bound that is asked for far too little has to stay above a motion that was found and checked."""
    assembly = random_assembly(seed)
    goals = random_goals(assembly, seed, most)
    answer = wr.flex(assembly, goals, search=0)
    if answer.objective is None:
        assert bound_of(assembly, goals, 1.0, WHILE) == math.inf
        return
    for share in (0.3, 0.97):
        assert bound_of(assembly, goals, share * answer.objective, WHILE) >= answer.objective * (1 - ROUNDING)


@pytest.mark.parametrize("seed", range(0, 30, 6))
def test_no_bound_below_a_checked_motion(seed):
    look(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30, 34))
def test_no_bound_below_a_checked_motion_often(seed):
    look(seed)


@pytest.mark.parametrize("name", BOUNDED)
def test_closed_forms(name):
    case = BOUNDED[name]
    assembly = case_assembly(case)
    low = bound_of(assembly, assembly.goals, 0.5 * case.value, WHILE)
    assert low >= case.value * (1 - ROUNDING)
    loose = name.split(" ", 1)[1].startswith(LOOSE)
    answer = wr.prove(wr.flex(assembly, search=0), 0.001, seconds=WHILE if loose else 600)
    if loose:
        assert answer.at_most is None or answer.at_most >= case.value
    else:
        assert case.value * (1 - ROUNDING) <= answer.at_most <= 1.001 * case.value


@pytest.mark.parametrize(
    ("joint", "gap", "n"),
    [c for c in CHAINS if c[1] == (0.01 if c[2] == 2 else 0.03) and (c[2] == 2 or c[0] in ("tee", "swallowtail"))],
)
def test_chains_against_the_dynamic_programme(joint, gap, n):
    value, accuracy = chain.stored(joint, gap, n)
    assembly = assemble(row_of([blocks.block(joint, gap)] * n), gap=0.0)
    answer = wr.prove(wr.flex(assembly, search=0), 0.01, seconds=600)
    assert value - accuracy <= answer.at_most <= 1.011 * value


@pytest.mark.slow
@pytest.mark.parametrize(("joint", "gap", "n"), [c for c in CHAINS if c[1:] == (0.03, 10)])
def test_chains_within_half_a_per_cent(joint, gap, n):
    value, accuracy = chain.stored(joint, gap, n)
    assembly = assemble(row_of([blocks.block(joint, gap)] * n), gap=0.0)
    for cut in (0.5, 0.999):
        assert bound_of(assembly, assembly.goals, cut * value, WHILE) >= value - accuracy
    # the witness of some of these chains lies below the truth
    assert bound_of(assembly, assembly.goals, 1.003 * value, 60.0) <= 1.005 * value


def one_joint(seed, gap=0.01):
    """A chain of one joint that nobody drew by hand and the largest move of its last block, by exact slices."""
    made = random_joints.tab_pair(seed, gap)
    a, b, D = made.local()
    value = chain.reach(Slices(a, b, tuple(D)), 2, cells=60).value
    drawing = row_of([a, b])
    return assemble(drawing, gap=0.0), value


@pytest.mark.parametrize("seed", range(2))
def test_random_joints_against_exact_slices(seed):
    assembly, value = one_joint(seed)
    assert bound_of(assembly, assembly.goals, 0.6 * value, WHILE) >= value - 1e-10
    assert bound_of(assembly, assembly.goals, 1.005 * value, 20.0) <= 1.006 * value


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 7))
def test_many_random_joints_against_exact_slices(seed):
    assembly, value = one_joint(seed)
    assert bound_of(assembly, assembly.goals, 0.6 * value, WHILE) >= value - 1e-10


# -- the pieces of the argument --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1, 3, pytest.param(2, marks=pytest.mark.slow)])
def test_outer_regions_hold_all_true_slices(seed):
    """Exact slices by an oracle that shares no code lie inside the facets."""
    joint, gap = blocks.JOINTS[seed], (0.01, 0.03)[seed % 2]
    made = blocks.block(joint, gap)
    assembly = assemble(row_of([made, made]), gap=0.0)
    surveyed = survey(assembly)
    links, (region,) = outer_regions(surveyed, WorkBudget())
    pivot = surveyed.bodies.rest[0, :2] + links.arm_a[0]
    truth = Slices(made, made, (1.0, 0.0))
    low, high = region.turns
    assert low <= truth.low
    assert high >= truth.high
    for outer in (region, with_narrower_intervals(region, np.arange(len(region.low)))):
        for phi in np.linspace(truth.low, truth.high, 23):
            corners = truth.corners(phi)
            arm, c, s = pivot - (1.0, 0.0), math.cos(phi), math.sin(phi)
            swing = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]) - arm
            axes = links.axes[0]
            turn = np.array([[math.cos(axes), math.sin(axes)], [-math.sin(axes), math.cos(axes)]])
            points = np.column_stack([(corners + swing) @ turn.T, np.full(len(corners), phi)])
            near = facets(outer, phi - 1e-4, phi + 1e-4)
            for found in (near, facets(outer, -np.inf, np.inf)):
                assert (points @ found.normal.T <= found.offset).all()


@pytest.mark.parametrize("half", [1e-9, 0.7, 3.0, 7.0])
def test_envelopes_hold_at_every_angle(half):
    rng = np.random.default_rng(0)
    middle = rng.uniform(-4, 4, 30)
    rows, most = envelope(middle - half, middle + half)
    t = middle[:, None] + np.linspace(-half, half, 2001)
    curve = np.stack([np.cos(t) - 1, np.sin(t), t], 1)
    assert (rows @ curve <= most[:, :, None]).all()


def test_support_is_the_largest_value():
    rng = np.random.default_rng(1)
    a, b, c, half = *rng.standard_normal((3, 500)), rng.uniform(0, 3.1, 500)
    v = np.linspace(-1, 1, 4001) * half[:, None]
    a, b, c = (k[:, None] for k in (a, b, c))
    seen = (a * np.cos(v) + b * np.sin(v) + c * v).max(1)
    found = support(a[:, 0], b[:, 0], c[:, 0], half)
    assert (found >= seen).all()
    assert (found <= seen + 1e-5).all()


@pytest.mark.parametrize(("seed", "wide"), [(0, 1.0), (1, 3.0)])
def test_any_multipliers_give_a_bound(seed, wide):
    """Weak duality: whatever the multipliers, the bound stays above a motion that was found and checked."""
    rng = np.random.default_rng(seed)
    assembly = wr.patterns.grid(3, 2, joint="tee", gap=0.02)
    answer = wr.flex(assembly, wr.Pull(assembly.names[-1], rng.standard_normal(2)), search=0)
    surveyed = survey(assembly)
    them = surveyed.bodies
    joints, regions = outer_regions(surveyed, WorkBudget())
    turns = turn_differences(joints, regions)
    ranges = first_ranges(them.fixed, joints, regions, turns)
    ranges = replace(ranges, low=wide * ranges.low, high=wide * ranges.high)
    at = joint_ranges(joints, RegionCuts([*regions]), ranges, turns)
    lagrangian = LagrangianBound(them.fixed, joints, at, ranges)
    weights = goal_weights(objective(assembly, them, answer.goals), len(them.fixed))
    size = 10.0 ** rng.uniform(-3, 2, (40, 1, MULTIPLIERS))
    some = rng.random((40, len(joints.a), MULTIPLIERS)) < 0.5
    y = size * some * rng.standard_normal(some.shape)
    y[0] = 0.0
    found = lagrangian.most(np.tile(weights, (40, 1)), np.zeros(40), y)
    assert (found >= answer.objective).all()


def test_neighbourhoods_cut_no_motion_that_is_worth_enough():
    from wiggleroom.bound import neighbourhood_tightening
    from wiggleroom.bound.turn_tightening import Cutoff, Linkage, RelaxationInRanges

    assembly = wr.patterns.grid(4, 3, joint="tee", gap=0.02)
    answer = wr.flex(assembly, wr.Pull(assembly.names[-1], (0, 1)), search=0)
    surveyed = survey(assembly)
    them = surveyed.bodies
    joints, regions = outer_regions(surveyed, WorkBudget())
    turns = turn_differences(joints, regions)
    ranges = first_ranges(them.fixed, joints, regions, turns)
    linkage = Linkage(them.fixed, them.radius, them.rest[:, :2], joints, turns, surveyed.clearance)
    program = RelaxationInRanges(linkage, RegionCuts([*regions]), ranges)
    weights = goal_weights(objective(assembly, them, answer.goals), len(them.fixed))
    most, multipliers, *_ = program.largest(weights, WorkBudget(), interior=True)
    assert most >= answer.objective
    every = np.flatnonzero(~them.fixed)
    for share in (0.9, 0.9999):
        cutoff = Cutoff(weights, share * answer.objective)
        cuts = neighbourhood_tightening.neighbourhood_cuts(program, multipliers, every, cutoff, WorkBudget())
        assert len(cuts.body)
        assert any(len(joined) < len(joints.a) for joined in cuts.joints)
        turned = answer.motion[[them.members[b][0] for b in cuts.body], 2]
        assert (cuts.sign * turned <= cuts.sign * cuts.end).all()


@pytest.mark.parametrize(("sides", "share"), [(3, 0.3), (4, 0.2), (5, 0.1)])
def test_turns_of_one_body_are_bounded_within_a_thousandth(sides, share):
    """A polygon in a larger one alike, about a pin: where it ends follows from one corner and one side."""
    angle = 2 * np.pi * np.arange(sides) / sides
    outside, hole, inner = ((r * np.column_stack([np.cos(angle), np.sin(angle)])) for r in (3.0, 1.0, 1.0 - share))
    frame = shapely.Polygon(outside, [hole])
    parts = (part_at("frame", frame, fixed=True), part_at("peg", shapely.Polygon(inner)))
    assembly = assemble(Drawing(parts, goals=(wr.Turn("peg", "ccw"),)), gap=0.0)
    answer = wr.flex(assembly, search=0)
    proven = wr.prove(answer, 0.001, seconds=600)
    assert answer.objective <= proven.at_most <= 1.001 * answer.objective


@pytest.mark.parametrize("most_iterations", [10_000, 1])
def test_the_dual_program_says_what_another_solver_says(most_iterations, monkeypatch):
    """Also where the simplex method takes more iterations than it may, and an interior-point method answers."""
    from scipy.optimize import linprog

    from wiggleroom.solve import dual_linear_program
    from wiggleroom.solve.dual_linear_program import DualLinearProgram

    monkeypatch.setattr(dual_linear_program, "MIN_ITERATION_LIMIT", most_iterations)
    monkeypatch.setattr(dual_linear_program, "MAX_ITERATIONS_PER_ROW", 0)
    rng = np.random.default_rng(3)
    rows = sp.random(12, 6, 0.5, random_state=3, data_rvs=rng.standard_normal).tocsr()
    x = rng.uniform(-1, 1, 6)
    low, high = rows @ x - rng.uniform(0, 0.1, 12), rows @ x + rng.uniform(0, 0.1, 12)
    low[::3], high[1::3] = -np.inf, np.inf
    program = DualLinearProgram(rows, low, high, np.full(6, -1.0), np.ones(6))
    sides = sp.vstack([rows, -rows]).toarray()
    most = np.concatenate([high, -low])
    last, worth = rng.standard_normal(6), float(rng.standard_normal(6) @ x) - 5
    for more in (False, True):
        if more:
            program = program.with_row(last, worth, WorkBudget())
            sides, most = np.vstack([sides, -last]), np.append(most, -worth)
        for cost in rng.standard_normal((5, 6)):
            y = program.ask(cost)
            real = linprog(-cost, sides[np.isfinite(most)], most[np.isfinite(most)], bounds=(-1, 1))
            assert cost @ program.x == pytest.approx(-real.fun, abs=1e-7)
            assert len(y) == 12 + more


# -- the same question otherwise -------------------------------------------------------------------------------------

OTHERWISE = {
    "mirror": (mirrored, 1.0),
    "thousandfold": (lambda d: scaled(d, 1e3), 1e3),
    "far off": (lambda d: displaced(d, 0.7, (300.0, -200.0)), 1.0),
}


@pytest.mark.parametrize("how", OTHERWISE)
def test_same_chain_otherwise(how):
    change, length = OTHERWISE[how]
    value, _ = chain.stored("swallowtail", 0.02, 5)
    assembly = assemble(change(row_of([blocks.block("swallowtail", 0.02)] * 5)), gap=0.0)
    answer = wr.prove(wr.flex(assembly, search=0), 0.01, seconds=600)
    assert value * length * (1 - 1e-10) <= answer.at_most <= 1.0101 * value * length


# -- asking ----------------------------------------------------------------------------------------------------------


def test_flex_proves_when_asked():
    assembly = wr.patterns.chain(3, joint="tee", gap=0.02)
    plain = wr.flex(assembly, search=0)
    assert plain.bound is None or plain.bound.kind == "quick"
    answer = wr.flex(assembly, prove=0.01, search=0)
    assert answer.bound.kind == "proven"
    assert answer.objective == plain.objective
    assert answer.bound.at_most == answer.at_most
    assert answer.at_most / answer.objective - 1 == pytest.approx(answer.bound.within)
    assert answer.bound.within <= 0.01


def test_what_flies_away_has_no_bound():
    case = next(iter(closed_forms.unbounded()))
    answer = wr.prove(wr.flex(case_assembly(case), search=0), 0.01)
    assert answer.at_most is None
    assert answer.bound.why == "nothing stops the motion"


def test_parts_side_by_side_in_a_tray():
    """Their joints are open, yet a row of them has the play of all gaps between a part and the wall, and no more."""
    count, gap, at = 3, 0.2, np.cumsum([0.0, 12.0, 7.0, 9.0])
    row = [box(f"b{k}", low, 0, high, 10) for k, (low, high) in enumerate(pairwise(at.tolist()))]
    tray = shapely.box(-5, -5, at[-1] + 5, 15).difference(shapely.box(0, 0, at[-1], 10))
    parts = assemble(Drawing((part_at("tray", tray, (0.0, 0.0, 0.0), True), *row)), gap=gap)
    proven = wr.prove(wr.flex(parts, wr.Pull("b0", (1, 0)), search=0), 0.02, seconds=600.0)
    assert count * gap * (1 - 1e-6) <= proven.objective <= proven.at_most <= 1.02 * count * gap


@pytest.mark.filterwarnings("error")
def test_parts_that_fly_off_together_do_not_spoil_the_bound_of_others():
    """Two parts in a tray, and two far away that hold each other and nothing else."""
    gap = 0.2
    tray = shapely.box(-5, -5, 24, 15).difference(shapely.box(0, 0, 19, 10))
    away = [
        replace(p, name=f"far {p.name}", at=(100.0 + p.at[0], 0.0, 0.0), fixed=False)
        for p in wr.patterns.chain(2, joint="swallowtail", gap=gap / 10, pitch=10.0).drawing.parts
    ]
    near = [box("b0", 0, 0, 12, 10), box("b1", 12, 0, 19, 10)]
    parts = assemble(Drawing((part_at("tray", tray, (0.0, 0.0, 0.0), True), *near, *away)), gap=gap)
    proven = wr.prove(wr.flex(parts, wr.Pull("b0", (1, 0)), search=0), 0.02, seconds=600.0)
    assert 2 * gap * (1 - 1e-6) <= proven.objective <= proven.at_most <= 1.02 * 2 * gap


@pytest.mark.parametrize(("within", "seconds"), [(0, 1), (-1, 1), (math.nan, 1), (0.1, 0), (0.1, math.inf)])
def test_numbers_that_make_no_sense(within, seconds):
    answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.02), search=0)
    with pytest.raises(wr.InputError, match="it must be"):
        wr.prove(answer, within, seconds=seconds)


def test_sums_of_squares_are_refused():
    assembly = wr.patterns.chain(2, joint="tee", gap=0.02)
    with pytest.raises(wr.InputError, match="sums of squares"):
        wr.flex(assembly, wr.Translation(), prove=0.01, search=0)


def test_a_short_time_gives_the_best_so_far():
    assembly = wr.patterns.grid(3, 3, joint="tee", gap=0.02)
    answer = wr.flex(assembly, wr.Pull(assembly.names[-1], (0, 1)), prove=1e-6, seconds=1, search=0)
    assert answer.bound.seconds < 10
    assert answer.at_most is None or answer.at_most >= answer.objective


def test_command(tmp_path, capsys, command):
    file, out, picture = (tmp_path / name for name in ("chain.json", "out.json", "out.svg"))
    assert command("make", "chain", "3", "--joint", "tee", "--gap", "0.02", "-o", file) == 0
    assert (
        command("flex", file, "--search", "0", "--prove", "0.01", "--time", "30", "--json", out, "--picture", picture)
        == 0
    )
    said = capsys.readouterr().out
    assert "mm, proven" in said
    assert "mm, proven" in picture.read_text()
    record = json.loads(out.read_text())
    assert record["bound"]["kind"] == "proven"
    assert record["bound"]["within"] == pytest.approx(record["at_most"] / record["objective"] - 1)
    assert record["objective"] <= record["at_most"] <= 1.01 * record["objective"]
    for wrong in (["--time", "0"], ["--prove", "0"], ["--prove", "0.01", "--model", "hull"], ["--prove", "x"]):
        assert command("flex", file, *wrong) == 2
        assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_words_round_outwards():
    from wiggleroom.report.results.answer_words import proven

    answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.02), wr.Pull("b2", (0, 1)), search=0)
    assert proven(replace(answer, at_most=None, bound=None)) == ""
    shown = replace(answer, objective=1.37238, at_most=1.37901, bound=Bound(1.37901, 0.005, 0.1))
    assert proven(shown) == "between 1.3723 and 1.3791 mm, proven"
    assert proven(replace(shown, bound=replace(shown.bound, kind="quick"))) == "at most 1.3791 mm"


@pytest.mark.parametrize(
    ("file", "play", "made", "published"),
    [("fixed", 1.5, (48.5, 51.5), (47, 53)), ("floating", 2.0, (48, 52), (46, 54))],
)
def test_published_fasteners(file, play, made, published):
    """Float of fasteners in clearance holes: the extremes that are published hold, proven."""
    answer = wr.prove(wr.flex(wr.read(f"examples/22_fasteners/{file}.json"), search=0), 0.01, seconds=600)
    assert answer.objective == pytest.approx(play, abs=1e-6)
    assert play - 1e-6 <= answer.at_most <= 1.0101 * play
    low, high = made[0] - answer.objective, made[1] + answer.objective
    assert (low, high) == pytest.approx(published, abs=1e-5)


@pytest.mark.parametrize(("joint", "n", "gap"), [("swallowtail", 12, 0.03), ("revolute", 8, 0.05)])
def test_chains_that_turn_beyond_a_quarter(joint, n, gap):
    made = wr.patterns.chain(n, joint=joint, gap=gap)
    answer = wr.flex(made, wr.Turn(made.names[-1], "ccw"), search=0)
    assert answer.objective > math.pi / 2
    proven = wr.prove(answer, 0.02, seconds=600)
    assert answer.objective <= proven.at_most <= 1.0201 * answer.objective


def test_turns_of_a_window_hold_for_copies_that_differ_a_little():
    """What is proven of a window is proven of every placement: with joints moved by as much as the deviation says, no bound is passed."""
    from wiggleroom.bound.local_windows import deviation, windows

    assembly = wr.patterns.grid(3, 3, joint="tee", gap=0.02)
    surveyed = survey(assembly)
    them = surveyed.bodies
    joints, regions = outer_regions(surveyed, WorkBudget())
    (window, *_) = windows(them.rest[:, :2], joints, surveyed.clearance, 2)
    far = np.array([regions[k].far for k in joints.kind])
    assert deviation(window, joints, far) < 1e-11
    rng, shift = np.random.default_rng(0), 1e-6
    other = np.setdiff1d(window.placed_joints[1], window.joints)
    arm = joints.arm_b.copy()
    arm[other] += shift * rng.uniform(0.5, 1.0, (len(other), 2))
    moved = replace(joints, arm_b=arm)
    apart = deviation(window, moved, far)
    assert 2 * np.hypot(*(arm - joints.arm_b)[other].T).max() <= apart <= 3 * shift
    turns = turn_differences(joints, regions)
    ranges = first_ranges(them.fixed, joints, regions, turns)
    at = joint_ranges(joints, RegionCuts([*regions]), ranges, turns)
    y = rng.standard_normal((5, len(joints.a), MULTIPLIERS))
    weights, none = np.zeros((5, 5 * len(them.fixed))), np.zeros(5)
    plain, wider = (LagrangianBound(them.fixed, joints, at, ranges, d).most(weights, none, y) for d in (0.0, apart))
    assert wider - plain == pytest.approx(apart * np.hypot(y[..., 0], y[..., 1]).sum(1), rel=1e-3)
