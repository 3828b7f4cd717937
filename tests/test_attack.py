"""A short part of the campaign of `python -m benchmarks.attack`, and its judge."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.attack.campaign import read_log, run, save, table
from benchmarks.attack.drawing import assembly, box, cut, part, pull
from benchmarks.attack.families import FAMILIES, draw
from benchmarks.attack.families_solid import FAMILIES as SOLID_FAMILIES
from benchmarks.attack.families_solid import draw_solids
from benchmarks.attack.judge import ask, severe
from benchmarks.attack.judge_solids import SolidGround
from benchmarks.attack.oracle import Ground
from benchmarks.attack.search import Climber
from benchmarks.attack.studies import ask_studies, inward

import wiggleroom as wr


def peg_in_a_hole() -> Ground:
    plate = part("plate", cut(box(0, 0, 4, 4), box(1, 1, 3, 3)), fixed=True)
    return Ground(assembly([plate, part("peg", box(1.5, 1.5, 2.5, 2.5))], [pull("peg", (1, 0))]))


def test_the_judge_finds_an_overlap_between_way_points_and_measures_it() -> None:
    ground = peg_in_a_hole()
    waypoints = np.zeros((3, 2, 3))
    waypoints[1, 1, 0] = 0.5
    assert ground.overlap_on(waypoints) is None
    waypoints[1, 1, 0] = 0.75
    found = ground.overlap_on(waypoints)
    assert found is not None
    assert found.parts == ("plate", "peg")
    turned = np.zeros((2, 2, 3))
    turned[1, 1] = 0.45, 0.45, np.pi  # half a turn in a corner: only the path overlaps
    assert ground.overlap(turned[1]) is None
    assert ground.overlap_on(turned) is not None


def test_the_judge_sees_blocks_that_lie_on_each_other_in_line() -> None:
    blocks = [part("long", box(0, 0, 2, 1), fixed=True), part("short", box(3, 0, 4, 1))]
    ground = Ground(assembly(blocks, [pull("short", (-1, 0))]))
    away = np.zeros((2, 2, 3))
    away[1, 1, 0] = -2.0  # no corner of either is inside the other
    found = ground.overlap_on(away)
    assert found is not None
    assert found.depth > 0.1


def test_the_search_of_the_judge_finds_the_end_of_a_peg() -> None:
    assert Climber(peg_in_a_hole(), 0, 40).search().value == pytest.approx(0.5, abs=1e-4)


def test_the_judge_of_studies_makes_parts_with_other_gaps() -> None:
    smaller = Ground(inward(peg_in_a_hole().made, {"plate": 0.1, "peg": 0.2}))
    plate, peg = (shapes[0] for shapes in smaller.at(np.zeros((1, 2, 3))))
    assert peg.symmetric_difference(box(1.7, 1.7, 2.3, 2.3)).area < 1e-12
    assert plate.symmetric_difference(cut(box(0.1, 0.1, 3.9, 3.9), box(0.9, 0.9, 3.1, 3.1))).area < 1e-12


@pytest.mark.slow
def test_the_judge_of_studies_agrees_with_a_peg_and_sees_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    made = peg_in_a_hole().made
    assert ask_studies("peg", 0, made, 12).wrong == []
    true_rank, true_sweep = wr.rank, wr.sweep

    def twice(*args: object, **more: object) -> wr.Ranking:
        found = true_rank(*args, **more)  # type: ignore[arg-type]
        return replace(found, looser=2 * found.looser, tighter=2 * found.tighter)

    def falling(*args: object, **more: object) -> wr.Sweep:
        found = true_sweep(*args, **more)  # type: ignore[arg-type]
        return replace(found, steps=(found.steps[-1], *found.steps[1:]))

    monkeypatch.setattr(wr, "rank", twice)
    monkeypatch.setattr(wr, "sweep", falling)
    found = ask_studies("peg", 0, made, 12)
    assert {w.split(":")[0] for w in found.wrong} == {"rank", "sweep"}
    assert severe(found)


@pytest.mark.parametrize("kind", range(len(FAMILIES)), ids=lambda k: FAMILIES[k].__name__)
def test_every_family_draws_parts_that_can_be_asked_about(tmp_path: Path, kind: int) -> None:
    name, made = draw(kind)
    assert made is not None
    (tmp_path / f"{name}.json").write_text(json.dumps(made))
    wr.prepare(wr.read(str(tmp_path / f"{name}.json")))
    assert draw(kind)[1] == made  # the same again


@pytest.mark.slow
def test_a_campaign_goes_on_where_it_stopped(tmp_path: Path) -> None:
    assert [f.number for f in run(1, 2, tmp_path, programs=0)] == [2]
    before = (tmp_path / "log.jsonl").read_text()
    assert [f.number for f in run(2, 2, tmp_path, programs=0)] == [2, 3]
    assert (tmp_path / "log.jsonl").read_text().startswith(before)
    assert len(read_log(tmp_path)) == 2
    assert table(read_log(tmp_path)).splitlines()[-1].startswith("| **all** | 2 | 2 |")


@pytest.mark.parametrize("kind", range(len(SOLID_FAMILIES)), ids=lambda k: SOLID_FAMILIES[k].__name__)
def test_every_family_in_space_draws_parts_that_can_be_asked_about(tmp_path: Path, kind: int) -> None:
    _, made = draw_solids(kind)
    drawn = wr.read(str(made.write(tmp_path)))
    ground = SolidGround(made, drawn.reference)
    rest = np.zeros((1, len(made.parts), 6))
    assert ground.overlap(rest) == 0
    free = next(k for k, p in enumerate(made.parts) if not p.fixed)
    held = next(k for k, p in enumerate(made.parts) if p.fixed)
    onto = rest.copy()
    onto[0, free, :3] = ground.pieces[held][0].mean(axis=0) - ground.pieces[free][0].mean(axis=0)
    assert ground.overlap(onto) > 1e-3


def test_a_campaign_in_space_writes_what_it_asks(tmp_path: Path) -> None:
    (found,) = run(1, 9, tmp_path, programs=0, questions="space")
    assert (found.family, found.path, found.wrong) == ("hexagon_keys", "checked", [])
    save(tmp_path, found, "space")
    assert wr.read(str(tmp_path / "hexagon_keys_9" / "assembly.json"))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(0, len(FAMILIES), 4), ids=lambda n: f"{FAMILIES[n].__name__}-{n}")
def test_nothing_that_is_said_is_wrong(number: int) -> None:
    name, made = draw(number)
    assert made is not None
    finding = ask(name, number, made, programs=12)
    assert not severe(finding), finding.wrong
    assert finding.path in ("checked", "")  # "" where the file was refused


def test_the_judge_finds_ways_out_of_its_own_in_space_and_none_of_what_is_locked() -> None:
    found = []
    for number in (71, 17, 1, 15):  # a drawer and a dovetail that are open, two drawers behind rims
        _, made = draw_solids(number)
        reference = np.array([np.vstack(p.pieces()).mean(axis=0) for p in made.parts])
        found.append(
            (made.comes_apart, SolidGround(made, reference).way_out(np.random.default_rng(number), 60) is not None)
        )
    assert [way for _, way in found] == [apart for apart, _ in found]
