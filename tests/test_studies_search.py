"""Studies are about the largest motion that a direct question finds, also where climbs fall short and passages open or close."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flex_truth import Ground
from tests.flexing import box, part_at, polygon_part
from tests.test_studies import caged_bolt, everything, rectangle
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED
from wiggleroom.drawing.model import Drawing, Tolerance
from wiggleroom.maximise import flex
from wiggleroom.report.findings.sample import yield_sentence
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity import planar_study
from wiggleroom.sensitivity.gap_trials import CLIMBED
from wiggleroom.sensitivity.perturbation import perturbed_objective_anew
from wiggleroom.sensitivity.planar_study import PlanarStudy
from wiggleroom.studies.gap import GapQuestion
from wiggleroom.studies.sample import SampleQuestion
from wiggleroom.verdict import Certainty, Verdict

ROOM = shapely.union_all([shapely.box(0, 0, 1, 1.1), shapely.box(0, 0, 3.1, 1), shapely.box(2.1, 0, 3.1, 3)])
SLIDER = shapely.box(0.05, 0.05, 0.95, 0.95)
"""Straight up it meets the roof of its pocket after 0.15 mm; along the corridor and up the shaft it gets 2.05 mm high."""


def corridor(gap: float = 0.0) -> Assembly:
    """A slider in a pocket beside a corridor to a shaft; its clearance is drawn."""
    frame = shapely.box(-1, -1, 4, 4) - ROOM
    parts = (part_at("frame", frame, (0.0, 0.0, 0.0), True), part_at("slider", SLIDER, (0.5, 0.5, 0.0), False))
    return assemble(Drawing(parts, gap=gap, goals=(wr.Pull("slider", (0, 1)),)))


def test_ranking_is_about_the_answer_of_flex() -> None:
    ranking = wr.rank(corridor())
    assert ranking.answer.objective == pytest.approx(2.05)
    assert ranking.importance == pytest.approx([0.5, 0.5], abs=1e-4)


def test_draws_vary_about_the_answer_of_flex() -> None:
    found = wr.sample(corridor(), 0.002, draws=6, seed=1, limit=1.0)
    assert found.value == pytest.approx(2.05 + found.extra.sum(axis=1) / 2, abs=1e-4)
    assert found.good == 0
    assert not found.undecided.any()
    ends = 2.05 + found.extra.min(axis=0).sum() / 2, 2.05 + found.extra.max(axis=0).sum() / 2
    assert (found.tightest, found.loosest) == (pytest.approx(ends[0]), pytest.approx(ends[1]))


def test_tightening_says_what_is_left_of_the_answer_of_flex() -> None:
    found = wr.tighten(corridor(gap=0.01), parts=1, gap=0.002, draws=2)
    assert found.before.objective == pytest.approx(2.06)
    assert found.after.objective == pytest.approx(2.056)
    assert not wr.tighten(corridor(gap=0.01), limit=1.0, gap=0.002, draws=0).reached


def test_a_sweep_goes_through_the_answer_of_flex() -> None:
    gaps = np.array([0.0, 0.01, 0.02])
    assert [s.objective for s in wr.sweep(corridor(), gaps).steps] == pytest.approx(2.05 + gaps)


def test_what_was_proven_of_larger_parts_is_not_of_smaller_ones() -> None:
    assembly = wr.patterns.chain(2, joint="tee", gap=0.02)
    found = replace(flex(assembly, search=0), verdict=Verdict.PROVEN, at_most=1.0)
    study = PlanarStudy(assembly, assembly.goals)
    for share, verdict in ((0.9, Verdict.STOPPED), (1 - 1e-9, Verdict.OPTIMAL)):
        lower = replace(found, verdict=Verdict.OPTIMAL, objective=share * found.objective)
        carried = study.in_place_of(lower, found)
        assert (carried.verdict, carried.at_most, carried.objective) == (verdict, None, found.objective)


@pytest.mark.slow
def test_the_gap_for_a_motion_is_about_the_answer_of_flex() -> None:
    found = wr.allowable_gap(corridor(gap=0.01), at_most=2.055)  # climbs from rest end at 0.16
    assert found.gap == pytest.approx(0.005, rel=0.01)


@pytest.mark.slow
def test_draws_do_not_go_through_parts(tmp_path: Path) -> None:
    """A bolt holds three plates: the moved walls of one draw lead past a plate, to 3.5 mm in place of 0.31."""
    heights = {"first": (0.0, 0.518, 3.569), "second": (1.1, 0.688, 3.18), "third": (2.199, 0.611, 3.362)}
    parts = [
        {
            "name": name, "at": [0, 0, 0], "fixed": name == "first",
            "outlines": [
                {"outline": [[x, -3], [x + 1, -3], [x + 1, -slot], [x, -slot]]},
                {"outline": [[x, slot], [x + 1, slot], [x + 1, top], [x, top]]},
            ],
        }
        for name, (x, slot, top) in heights.items()
    ]  # fmt: skip
    bolt = shapely.union_all(
        [shapely.box(-0.6, -1, -0.1, 1), shapely.box(-0.1, -0.481, 3.673, 0.481), shapely.box(3.673, -1, 4.173, 1)]
    )
    parts.append({"name": "bolt", "at": [0, 0, 0], "outline": shapely.get_coordinates(bolt)[:-1].tolist()})
    pull = {"part": "third", "direction": [-0.612, -0.791]}
    file = tmp_path / "plates.json"
    file.write_text(json.dumps({"format": "wiggleroom/1", "unit": "mm", "parts": parts, "pull": [pull]}))
    found = wr.sample(wr.read(str(file)), 0.002, draws=3, seed=1, workers=1)
    assert found.value == pytest.approx(found.answer.objective, rel=0.03)


def test_a_draw_goes_on_from_an_optimum_that_is_the_lower_one_without_variation() -> None:
    """From rest and from the end of the answer alone this draw was 3.9 % low."""
    assembly = wr.patterns.chain(2, joint="swallowtail", gap=0.04)
    pull = wr.Pull("b2", (-0.774, 0.633))
    found = wr.sample(assembly, 0.006, pull, draws=2, seed=2, workers=1)
    off = {name: -float(e) / 2 for name, e in zip(assembly.names, found.extra[1], strict=True)}
    direct = wr.flex(assemble(assembly.drawing, offset=off), pull)
    assert direct.objective is not None
    assert found.value[1] > 0.98 * direct.objective


def test_a_gap_at_which_parts_overlap_is_one_at_which_they_touch() -> None:
    drawing = wr.patterns.chain(2, joint="tee", gap=0.04).drawing
    larger = assemble(replace(drawing, parts=tuple(replace(p, offset=0.01) for p in drawing.parts)))
    tight, loose = wr.sweep(larger, [0.01, 0.04]).steps
    assert tight.verdict is Verdict.TOUCHING
    assert loose.verdict.ends


def test_a_question_that_is_wrong_at_every_gap_is_refused() -> None:
    assembly = wr.patterns.chain(3, joint="tee", gap=0.02)
    a, b, c = assembly.names
    wrong = assemble(replace(assembly.drawing, glue=((b, c),), ignore=((a, b),)))
    with pytest.raises(wr.InputError, match="covers only some parts"):
        wr.sweep(wrong, [0.01, 0.02])
    with pytest.raises(wr.InputError, match="covers only some parts"):
        wr.allowable_gap(wrong, at_most=0.1)


# -- passages that open or close as gaps vary ------------------------------------------------------------------------


def test_draws_in_which_a_way_out_opens_are_found() -> None:
    """The bolt leaves where both deviations are more than 0.1 mm together; without, it moves by the gap and half of them."""
    found = wr.sample(caged_bolt(), 0.06, draws=24, seed=4, limit=1.0, workers=1)
    together = found.extra.sum(axis=1)
    assert 0 < (together > 0.1).sum() < 24
    assert not found.undecided[found.value > 1.0].any()
    fits = ~np.isnan(found.value) & ~found.undecided
    assert ((found.value > 1.0) == (together > 0.1))[fits].all()
    assert found.undecided.sum() <= 2
    assert SampleQuestion.finding(found).record().loosest == "unbounded"


def shafts() -> wr.Assembly:
    """A slider that gets 0.15 mm up from rest, 0.9 mm in one shaft, and 2.05 mm in another behind a neck that is 0.04 mm wider than it."""
    pocket, corridor, shaft = (0, 0, 1, 1.1), (0, 0, 2.1, 1), (1.1, 0, 2.1, 1.85)
    neck, higher = (2.0, 0.03, 2.4, 0.97), (2.3, 0, 3.3, 3)
    room = shapely.union_all([shapely.box(*corners) for corners in (pocket, corridor, shaft, neck, higher)])
    parts = (
        part_at("frame", shapely.box(-1, -1, 5, 4) - room, (0.0, 0.0, 0.0), True),
        part_at("slider", shapely.box(0.05, 0.05, 0.95, 0.95), (0.5, 0.5, 0.0), False),
    )
    return assemble(wr.Drawing(parts, goals=(wr.Pull("slider", (0, 1)),)))


@pytest.mark.slow
def test_draws_in_which_a_passage_closes_still_move_as_far_as_the_tightest_of_them() -> None:
    found = wr.sample(shafts(), wr.Spread(0.005, "uniform", bias=-0.03), draws=6, seed=1, limit=0.5, workers=1)
    assert found.answer.objective == pytest.approx(2.05)
    assert found.good == 0
    assert found.tightest == pytest.approx(0.9 + found.extra.min(axis=0).sum() / 2, abs=1e-5)
    assert (found.value >= found.tightest - 1e-9).all()


def test_draws_that_are_not_decided_widen_the_yield(monkeypatch: pytest.MonkeyPatch) -> None:
    from wiggleroom.sensitivity import searched_draws

    monkeypatch.setattr(searched_draws, "MAX_SEARCHES", 0)
    monkeypatch.setattr(PlanarStudy, "followed", lambda *_: None)
    found = wr.sample(caged_bolt(), 0.06, draws=24, seed=4, limit=1.0, workers=1)
    opened = found.extra.sum(axis=1) > 0.1
    assert found.undecided[opened & (found.value <= 1.0)].all()
    share, low, high = found.yields
    truth = 1 - np.mean(opened | np.isnan(found.value))
    assert share <= truth <= share + found.undecided.sum() / 24
    assert low <= share + 1e-9
    assert high > truth
    assert yield_sentence(found).startswith("at least ")


@pytest.mark.slow
def test_the_largest_gap_for_a_motion_lies_below_the_gap_at_which_a_way_out_opens() -> None:
    """Straight on the bolt moves by the gap; from a gap of 0.1 mm on it leaves by the mouth."""
    found = wr.allowable_gap(caged_bolt(), at_most=0.5)
    assert found.gap is not None
    assert found.beyond is not None
    assert found.gap <= 0.1 * (1 + 1e-6)
    assert 0.1 * (1 - 1e-9) <= found.beyond < 0.1003
    assert found.beyond - found.gap < 0.011 * found.beyond
    (trial,) = [t for t in found.trials if t.gap == found.beyond]
    made = assemble(found.assembly.drawing, gap=found.beyond)
    assert Ground(made).free_of_overlap(trial.answer.waypoints).all()
    (kept,) = [t for t in found.trials if t.gap == found.gap]
    assert kept.verdict != CLIMBED


def test_what_was_climbed_is_not_called_optimal() -> None:
    found = wr.allowable_gap(wr.patterns.chain(2, joint="tee", gap=0.02), at_most=0.1)
    said = {trial.gap: trial.verdict for trial in GapQuestion.finding(found).record().trials}
    assert said[found.searched_gap] in ("optimal", "proven")
    assert CLIMBED in said.values()
    for trial in found.trials:
        searched = trial.answer is not None and trial.answer.search is not None
        assert searched or trial.verdict not in ("optimal", "proven", "stationary")


def test_the_path_out_is_followed_to_the_gap_at_which_it_opens() -> None:
    wide = caged_bolt()
    loose = PlanarStudy(assemble(wide.drawing, gap=0.2), wide.goals)
    answer = loose.with_room(loose.answer(UNLIMITED), np.inf, UNLIMITED)
    for gap, free in ((0.15, True), (0.0999, False)):
        there = PlanarStudy(assemble(wide.drawing, gap=gap), wide.goals).followed(answer, np.inf)
        assert (there is not None) is free
        if there is not None:
            assert there.objective is None
            assert Ground(there.assembly).free_of_overlap(there.waypoints).all()


def stacks() -> wr.Assembly:
    """P below a, which a frame stops, and below c and d, which another one stops a little sooner."""
    frames = [
        wr.Part(name, (wr.Region(rectangle(-15, -10, 15, top), (rectangle(-5, 0, 5, roof)[::-1],)),), fixed=True)
        for name, top, roof in (("F1", 35, 20.6), ("F2", 45, 30.41))
    ]
    bars = [box(name, -5, y, 5, y + 10) for name, y in (("P", 0), ("a", 10), ("c", 10), ("d", 20))]
    ignore = (("F1", "F2"), ("F1", "c"), ("F1", "d"), ("F2", "a"), ("a", "c"), ("a", "d"))
    return assemble(wr.Drawing((*frames, *bars), 0.2, goals=(wr.Pull("P", (0, 1)),), ignore=ignore))


def test_the_best_pair_is_taken_where_all_are_tried() -> None:
    best = min(everything(stacks(), 2, 0.09).values())
    found = wr.tighten(stacks(), parts=2, draws=15, workers=1)
    assert found.chosen_by == "all"
    assert len(found.random) == 15
    assert found.after.objective == pytest.approx(best, rel=1e-6)
    assert set(found.chosen) == {"c", "d"}


@pytest.mark.slow
def test_no_choice_at_random_is_better_than_the_one_that_is_taken() -> None:
    found = wr.tighten(stacks(), parts=2, draws=4, seed=1, workers=1)
    assert found.after.objective <= np.nanmin(found.random) * (1 + 1e-3)
    by_rank = wr.tighten(stacks(), parts=2, draws=0)
    assert by_rank.chosen_by == "rank"
    assert found.after.objective <= by_rank.after.objective
    assert (found.chosen_by == "draws") == (set(found.chosen) != set(by_rank.chosen))


def divider() -> wr.Drawing:
    """A wall 3.8 mm thick in a slot of 3.5 mm, in its middle."""
    wall = [(0, 0), (48, 0), (48, 40), (51.5, 40), (51.5, 0), (100, 0), (100, 60), (0, 60)]
    return wr.Drawing((polygon_part("wall", wall, fixed=True), box("divider", 47.85, -20, 51.65, 39.8)))


@pytest.mark.parametrize(("larger", "truth"), [(0.0, 0.15), (0.1, 0.35)])
def test_the_gap_that_fits_is_found_from_parts_that_overlap(larger: float, truth: float) -> None:
    found = wr.allowable_gap(assemble(divider(), overlapping=True), fits=larger)
    assert found.gap == pytest.approx(truth, rel=2e-6)
    assert "as drawn, not shifted" in GapQuestion.finding(found).title
    with pytest.raises(wr.InputError, match="overlap"):
        assemble(divider())


def test_the_command_answers_for_parts_that_overlap(command_output, tmp_path: Path) -> None:
    from wiggleroom.drawing import write_drawing

    write_drawing(divider(), tmp_path / "divider.json")
    code, out, _ = command_output("gap", tmp_path / "divider.json", "--fits", 0)
    assert code == 0
    assert out.startswith("smallest gap 0.15 mm: as drawn, not shifted")
    assert command_output("gap", tmp_path / "divider.json", "--holds")[0] == 2


def test_what_is_proven_does_not_depend_on_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = wr.patterns.chain(3, joint="tee", gap=0.02)
    some = [Tolerance(("b2",), 0.001, 0.001)]
    worst = wr.worst_case(chain, some).loosest.objective
    ticks = count(0.0, 1000.0)  # a quarter of an hour passes whenever the clock is looked at
    monkeypatch.setattr(time, "monotonic", lambda: next(ticks))
    kept = wr.worst_case(chain, some, limit=1.05 * worst)
    assert (kept.keeps, kept.certainty) == (True, Certainty.PROVEN)
    found = wr.allowable_gap(wr.patterns.chain(2, joint="tee", gap=0.02), at_most=0.1)
    assert found.certainty is Certainty.PROVEN


def test_a_sweep_never_falls_where_searches_are_cut_short(monkeypatch: pytest.MonkeyPatch) -> None:
    def cut_short(question: Assembly, goals: tuple, **_: Any) -> Answer:
        found = flex(question, goals, search=0)
        share = 1.0 if question.gap < 0.015 else 0.1
        return replace(found, verdict=Verdict.STOPPED, objective=share * found.objective, warm_start=None)

    monkeypatch.setattr(planar_study, "flex", cut_short)
    tight, loose = wr.sweep(wr.patterns.chain(2, joint="tee"), [0.01, 0.02]).steps
    assert loose.objective == tight.objective
    assert loose.verdict is Verdict.STOPPED
    assert audit_path(loose.answer.assembly, loose.answer.waypoints).free


def test_a_part_that_is_gone_is_not_said_to_touch() -> None:
    assembly = wr.patterns.chain(2, joint="tee", gap=0.02)
    found = perturbed_objective_anew(assembly, assembly.goals, np.full(2, assembly.size))
    assert found.verdict is Verdict.NOT_MAKEABLE
    touching = perturbed_objective_anew(assembly, assembly.goals, np.full(2, -0.02))
    assert touching.verdict is Verdict.TOUCHING
