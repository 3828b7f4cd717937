"""Quick bounds: pockets hold all true slices, what stands beside an answer is never below the truth, and it costs little."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import case_assembly, random_assembly, random_goals, row_of
from tests.oracle import blocks, chain, closed_forms, random_joints
from tests.oracle.slices import Slices
from wiggleroom.assembly.build import assemble
from wiggleroom.bound.dual_bound import quick_bound
from wiggleroom.freespace.outer.local_outer_region import NearSides, local_outer_region
from wiggleroom.freespace.outer.outer_slices import PairMaterial
from wiggleroom.program.objectives import PointMotion
from wiggleroom.report.results.answer_words import bound_sentence
from wiggleroom.search.answer import Bound, with_bound
from wiggleroom.verdict import PathState, Verdict

ROUNDING = 1e-11


def in_hull(points, corners):
    """Whether points lie within the convex hull of corners, as far as 400 directions tell."""
    rng = np.random.default_rng(0)
    direction = rng.standard_normal((400, 3)) / np.ptp(corners, axis=0)
    return ((points @ direction.T).max(0) <= (corners @ direction.T).max(0)).all()


def around(a, b, pivot, clearance):
    """Two parts with the origin at a point."""
    return NearSides(PairMaterial(*(shapely.transform(g, lambda p: p - pivot) for g in (a, b)), clearance))


def holds_all(a, b, D, pivot):
    """Whether a pocket holds the exact slices of the pair; None where there is no pocket."""
    placed = shapely.transform(b, lambda p: p + D)
    made = local_outer_region(around(a, placed, pivot, float(shapely.distance(a, placed))))
    if made is None:
        return None
    truth = Slices(a, b, tuple(D))
    arm = pivot - np.asarray(D)
    for phi in np.linspace(truth.low, truth.high, 15):
        corners = truth.corners(phi)
        c, s = math.cos(phi), math.sin(phi)
        moved = corners + np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]) - arm
        if not in_hull(np.column_stack([moved, np.full(len(moved), phi)]), made.corner):
            return False
    return True


@pytest.mark.parametrize(
    "joint", [pytest.param(j, marks=pytest.mark.slow) if j == "round" else j for j in blocks.JOINTS]
)
def test_pockets_hold_all_true_slices(joint):
    made = blocks.block(joint, 0.01)
    assert holds_all(made, made, (1.0, 0.0), np.array([0.35, 0.0]))


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(k, marks=pytest.mark.slow) for k in range(6, 16))])
def test_pockets_of_random_joints_hold_all_true_slices(seed):
    make = random_joints.peg_pair if seed % 2 else random_joints.tab_pair
    pair = make(seed, (0.004, 0.01, 0.02)[seed % 3], holes=bool(seed % 5 == 0))
    a, b, D = pair.local()
    assert holds_all(a, b, D, np.asarray(D) * 0.8 + 0.01) is not False


def test_what_slides_out_has_no_local_outer_region():
    left, right = shapely.box(0, 0, 1, 1), shapely.box(1.01, 0, 2, 1)
    assert local_outer_region(around(left, right, np.array([1.0, 0.5]), 0.01)) is None


# -- beside an answer ------------------------------------------------------------------------------------------------


def bound_at_any_cost(answer):
    """The quick bound without regard to its work; inf where there is none."""
    found = answer.warm_start
    most = quick_bound(found, found.program.objective, 1e9)
    return math.inf if most is None else most


@pytest.mark.parametrize("joint", blocks.JOINTS)
@pytest.mark.parametrize("n", [2, 10])
def test_chains_against_the_dynamic_programme(joint, n):
    value, accuracy = chain.stored(joint, 0.01, n)
    answer = wr.flex(assemble(row_of([blocks.block(joint, 0.01)] * n), gap=0.0), search=0)
    assert value - accuracy <= bound_at_any_cost(answer) <= 1.1 * value


@pytest.mark.parametrize("name", [f"{k} {c.name}" for k, c in enumerate(closed_forms.bounded())])
def test_closed_forms(name):
    case = list(closed_forms.bounded())[int(name.split()[0])]
    answer = wr.flex(case_assembly(case), search=0)
    assert answer.at_most is None or answer.at_most >= case.value * (1 - ROUNDING)
    assert bound_at_any_cost(answer) >= case.value * (1 - ROUNDING)


def look(seed):
    """No bound lies below a motion that was found and checked, and wrong forces give worse bounds, not wrong ones."""
    assembly = random_assembly(seed)
    answer = wr.flex(assembly, random_goals(assembly, seed), search=0)
    if answer.objective is None or answer.path != "checked":
        assert answer.at_most is None or answer.objective is not None
        return
    assert bound_at_any_cost(answer) >= answer.objective * (1 - ROUNDING)
    found, rng = answer.warm_start, np.random.default_rng(seed)
    if not isinstance(found.program.objective, PointMotion):
        return
    wrong = replace(found.solution, lam=found.solution.lam * rng.uniform(0.5, 1.5, len(found.solution.lam)))
    most = quick_bound(replace(found, solution=wrong), found.program.objective, 1e9)
    assert most is None or most >= answer.objective * (1 - ROUNDING)


@pytest.mark.parametrize("seed", range(0, 40, 7))
def test_no_bound_below_a_checked_motion(seed):
    look(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(400, 406))
def test_no_bound_below_a_checked_motion_often(seed):
    look(seed)


def test_stated_in_json_terminal_and_picture(tmp_path, capsys, command):
    file, out, picture = (tmp_path / name for name in ("grid.json", "out.json", "out.svg"))
    assert command("make", "grid", "4", "4", "--joint", "tee", "--gap", "0.02", "-o", file) == 0
    assert command("flex", file, "--json", out, "--picture", picture) == 0
    said = capsys.readouterr().out
    record = json.loads(out.read_text())
    assert record["bound"]["kind"] == "quick"
    assert record["objective"] <= record["at_most"] <= 1.1 * record["objective"]
    assert record["bound"]["within"] == pytest.approx(record["at_most"] / record["objective"] - 1)
    assert "at most" in said
    assert "quick bound" in said
    assert "proven" not in said
    assert "at most" in picture.read_text()


def test_a_motion_that_its_bound_proves_is_not_searched_further():
    answer = wr.flex(wr.patterns.chain(10, joint="tee", gap=0.02))
    assert answer.verdict == "proven"
    assert answer.bound.kind == "quick"
    assert answer.objective <= answer.at_most <= 1.001 * answer.objective
    assert answer.search.starts == 1


@pytest.mark.parametrize(("nx", "ny", "joint", "gap"), [(4, 3, "tee", 0.02), (6, 5, "swallowtail", 0.01)])
def test_grids_within_a_tenth(nx, ny, joint, gap):
    made = wr.patterns.grid(nx, ny, joint=joint, gap=gap)
    answer = wr.flex(made, wr.Pull(made.names[-1], (0, 1)))
    assert answer.bound.kind == "quick"
    assert answer.objective <= answer.at_most <= 1.1 * answer.objective


def test_many_corners_are_bounded_as_drawn():
    """Outlines were searched a little too large; the bound is about those that were drawn, which move further."""
    made = wr.read("examples/drawings/jointpanel_4x4.svg", gap=0.2, fix=["p-0"])
    answer = wr.flex(made, wr.Pull("p-15", (0, 1)))
    assert answer.verdict == "stationary"
    assert answer.objective <= answer.at_most <= 1.1 * answer.objective


def test_null_where_it_would_cost_more_or_say_too_little():
    for made in (wr.patterns.jigsaw(5, 4, gap=0.02, seed=1), wr.patterns.grid(14, 14, joint="swallowtail", gap=0.01)):
        answer = wr.flex(made, wr.Pull(made.names[-1], (1, 0)), search=0)
        assert answer.at_most is None
        assert answer.bound is None


def test_a_proof_that_finds_nothing_leaves_the_quick_bound():
    answer = wr.flex(wr.patterns.chain(10, joint="tee", gap=0.01))
    done = wr.prove(answer, 0.001, seconds=1e-6)
    assert done.at_most == answer.at_most
    assert done.bound.kind == "quick"
    assert done.bound.why
    assert bound_sentence(done).startswith("at most")
    assert done.bound.why in bound_sentence(done)


def test_a_checked_motion_that_a_bound_meets_is_proven_however_its_search_ended():
    answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01), search=0)
    cut_short = replace(answer, verdict=Verdict.STOPPED, at_most=None, bound=None)
    near = Bound(1.0005 * answer.objective, 5e-4, 0.0)
    assert with_bound(cut_short, near).verdict is Verdict.PROVEN
    assert with_bound(replace(cut_short, path=PathState.NOT_CHECKED), near).verdict is Verdict.STOPPED
    assert with_bound(replace(cut_short, collision_free=False), near).verdict is Verdict.STOPPED
    assert with_bound(cut_short, Bound(1.01 * answer.objective, 1e-2, 0.0)).verdict is Verdict.STOPPED
