"""Studies are about the largest motion that a direct question finds, also where a climb from rest ends far below it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from benchmarks.attack.families import draw

import wiggleroom as wr
from tests.flexing import part_at
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing
from wiggleroom.errors import FreeSpaceError
from wiggleroom.maximise import flex
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity import planar_study
from wiggleroom.sensitivity.perturbation import perturbed_objective_anew
from wiggleroom.sensitivity.planar_study import PlanarStudy
from wiggleroom.verdict import Verdict

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


@pytest.mark.slow
def test_draws_whose_climbs_fall_short_are_searched(tmp_path: Path) -> None:
    """A climb from rest leads to the answer here, but in this draw to 3 % less than the end of the answer does.

    Marbles have corners, so local optima lie 0.2 % apart.
    """
    file = tmp_path / "marbles.json"
    file.write_text(json.dumps(draw(91006)[1]))
    assembly = wr.read(str(file), gap=0.0024)
    found = wr.sample(assembly, wr.Spread(0.0012, "uniform"), draws=1, seed=3, workers=1)
    offset = dict(zip(assembly.names, (-found.extra[0] / 2).tolist(), strict=True))
    assert found.value[0] == pytest.approx(wr.flex(assemble(assembly.drawing, offset=offset)).objective, rel=5e-3)


def test_tightening_says_what_is_left_of_the_answer_of_flex() -> None:
    found = wr.tighten(corridor(gap=0.01), parts=1, gap=0.002, draws=2)
    assert found.before.objective == pytest.approx(2.06)
    assert found.after.objective == pytest.approx(2.056)
    assert not wr.tighten(corridor(gap=0.01), limit=1.0, gap=0.002, draws=0).reached


def test_parts_that_get_away_when_they_are_larger_cannot_be_tightened(tmp_path: Path) -> None:
    file = tmp_path / "trees.json"
    file.write_text(json.dumps(draw(91136)[1]))
    with pytest.raises(wr.InputError, match="nothing stops the motion"):
        wr.tighten(wr.read(str(file), gap=0.00288), parts=1, draws=1, workers=1)


def test_a_sweep_goes_through_the_answer_of_flex() -> None:
    gaps = np.array([0.0, 0.01, 0.02])
    assert [s.objective for s in wr.sweep(corridor(), gaps).steps] == pytest.approx(2.05 + gaps)


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


def test_the_path_of_a_larger_gap_is_followed_as_far_as_it_is_free() -> None:
    path = np.zeros((4, 2, 3))
    path[1:, 1, 0], path[2:, 1, 1] = (
        2.1,
        (1.5, 2.06),
    )  # along the corridor and up the shaft, of which 2.05 are left without a gap
    found = replace(flex(corridor(gap=0.02), search=0), waypoints=path, motion=path[-1])
    tight = PlanarStudy(corridor(), corridor().goals)
    kept = tight.followed(found, 1.0)
    assert kept is not None
    assert (kept.objective, kept.verdict) == (pytest.approx(1.5), Verdict.STOPPED)
    assert audit_path(tight.assembly, kept.waypoints).free
    assert tight.followed(found, 1.6) is None
    assert tight.followed(found, 3.0) is None


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


def test_a_part_that_is_gone_is_not_said_to_touch() -> None:
    assembly = wr.patterns.chain(2, joint="tee", gap=0.02)
    found = perturbed_objective_anew(assembly, assembly.goals, np.full(2, assembly.size))
    assert found.verdict is Verdict.NOT_MAKEABLE
    touching = perturbed_objective_anew(assembly, assembly.goals, np.full(2, -0.02))
    assert touching.verdict is Verdict.TOUCHING


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


def test_a_gap_without_free_space_round_rest_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise FreeSpaceError("no free space was found")

    monkeypatch.setattr(planar_study, "flex", refuse)
    (step,) = wr.sweep(wr.patterns.chain(2, joint="tee"), [0.01]).steps
    assert (step.verdict, step.objective) == (Verdict.STOPPED, None)
