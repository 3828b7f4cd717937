"""The tables of `bench`: figures against independent truth, and pages that keep what others wrote."""

from __future__ import annotations

import json
import sys
import threading
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.audit import polygon
from tests.oracle import chain as oracle_chain
from tests.oracle.collision import overlaps, pose_depth
from wiggleroom.bench import accuracy, chains, published, speed
from wiggleroom.bench import interlock_table as interlock
from wiggleroom.bench import large_assemblies as large
from wiggleroom.bench import run_one as one
from wiggleroom.bench.accuracy import PAIRS, overlapping
from wiggleroom.bench.puzzles import APART, LOCKED, PUZZLES
from wiggleroom.bench.render import bench_markdown, with_section
from wiggleroom.bench.result import Bench, Column, ResultTable
from wiggleroom.cli import main


def _placed(points: np.ndarray, at: tuple[float, float, float]) -> np.ndarray:
    from tests.oracle.geometry import turn

    return points @ turn(at[2]).T + at[:2]


EXAMPLES = Path(__file__).parents[1] / "examples"
needs_ipopt = pytest.mark.skipif(find_spec("casadi") is None, reason="needs the extra bench")


def figures(found: Bench, **where: object) -> dict:
    (record,) = [r for r in found.records if all(r.get(k) == v for k, v in where.items())]
    return record


def test_the_gallery_and_the_tables_ask_about_the_same_assemblies():
    ours = sorted((Path(wr.__file__).parent / "bench" / "assemblies").glob("*.json"))
    assert len(ours) == 8
    for file in ours:
        assert file.read_bytes() == (EXAMPLES / "17_does_it_come_apart" / file.name).read_bytes()


# collision and accuracy


@pytest.mark.parametrize("name", PAIRS)
def test_collision_agrees_with_the_oracle(name: str) -> None:
    assembly = PAIRS[name]()
    a, b = (polygon(p) for p in assembly.parts)
    D = assembly.rest[1, :2] - assembly.rest[0, :2]
    samples = np.random.default_rng(1).uniform((-0.05, -0.3, -0.1), (0.7, 0.3, 0.1), (3000, 3))
    moved = shapely.transform(a, lambda p: p - D)
    found = overlapping(moved, b, samples)
    assert found.any()
    assert not found.all()
    np.testing.assert_array_equal(found, overlaps(a, b, samples, D))


@pytest.mark.parametrize("name", ["swallowtail"])
def test_models_of_closed_joints(name: str) -> None:
    rows = {r["method"]: r for r in accuracy.of_pair(name, PAIRS[name](), 20_000)}
    for row in rows.values():
        assert sum(row[k] for k in published.CONFUSION_CELLS) == pytest.approx(100)
    assert rows["walls"]["unsafe_samples"] == 0
    assert rows["walls"]["lost_of_free_percent"] <= 0.5
    for hull in accuracy.HULLS:
        assert rows[hull]["accuracy_percent"] > 94  # the paper's on comparable joints
        assert 0 < rows[hull]["to_deg"] < rows["walls"]["to_deg"]


def test_a_run_that_is_stopped_says_so() -> None:
    stop = threading.Event()
    stop.set()
    found = accuracy.accuracy(100, stop=stop)
    assert found.cut
    assert all(r["published"] for r in found.records)
    assert interlock.interlock_table(stop=stop).cut
    assert chains.chains(stop=stop).cut


# published figures


# chains


def test_stored_optima_are_those_of_the_oracle() -> None:
    blocks, true = chains.optima()
    common = [(j, g) for j, g in true if g in oracle_chain.GAPS]
    assert len(common) == 6
    for joint, gap in common:
        assert true[joint, gap] == pytest.approx(oracle_chain.stored(joint, gap, blocks)[0], abs=1e-9)


def test_blocks_are_those_of_the_oracle() -> None:
    from tests.oracle.blocks import block

    for joint in chains.JOINTS:
        ours = polygon(wr.patterns.chain(2, joint, 0.02).parts[0])
        assert shapely.area(shapely.symmetric_difference(ours, block(joint, 0.02))) < 1e-12


def test_methods_against_the_true_optimum() -> None:
    blocks, true = chains.optima()
    chain = wr.patterns.chain(blocks, "swallowtail", 0.015)
    share = {
        name: (method(chain, None)[0] or 0) / true["swallowtail", 0.015] for name, method in chains.METHODS.items()
    }
    assert share["walls"] == pytest.approx(1, abs=1e-6)
    assert share["hull, reference"] < share["hull, joint"] < 0.6
    assert share["half-planes"] == pytest.approx(1, abs=1e-3)
    assert share["physics engine"] == pytest.approx(1, abs=0.02)


# interlock


@pytest.mark.slow
def test_both_truths_are_told_apart() -> None:
    assert {p.truth for p in PUZZLES} == {LOCKED, APART}
    for puzzle in PUZZLES:
        assert interlock.METHODS["walls"](puzzle.assembly(), None) == puzzle.truth, puzzle.name


def test_methods_for_tight_parts_see_no_gap() -> None:
    wedges = [p for p in PUZZLES if p.drawing == "gap"]
    for method in ("first order", "blocking graphs"):
        assert {interlock.METHODS[method](p.assembly(), None) for p in wedges} == {LOCKED}


# speed


@needs_ipopt
def test_small_assemblies_are_timed_in_processes_of_their_own() -> None:
    found = speed.speed(40)
    walls, mixed, hull, planes = (figures(found, method=name) for name in one.METHODS)
    for row in (walls, mixed, hull, planes):
        assert row["preprocess_seconds"] + row["solve_seconds"] == pytest.approx(row["total_seconds"], abs=0.01)
        assert row["ended"] in ("proven", "optimal", "stationary")
        assert 50 < row["peak_mb"] < 2000
    assert walls["overlap_mm"] == 0
    assert walls["moves_mm"] == pytest.approx(0.35597, abs=1e-4)  # bracketed by an outer model: 0.3551 to 0.3566
    assert hull["moves_mm"] < walls["moves_mm"]
    assert hull["solver"] == "ipopt"
    assert mixed["moves_mm"] == pytest.approx(hull["moves_mm"], rel=1e-4)
    assert mixed["processor_seconds"] > 0
    assert [r["total_seconds"] for r in found.records if r["published"]] == [1.21, 0.38]


@needs_ipopt
def test_a_limit_is_kept_and_said() -> None:
    case = large.CASES[1]
    row = speed.measure_in_process(case, "half-planes", 0.05)
    assert row["limit_seconds"] == 0.05
    assert "total_seconds" in row["at_least"]
    assert "> " in speed.COLUMNS[4].cell(row)


@pytest.mark.parametrize(
    ("parts", "limit", "word"), [(3, None, "max-parts"), (None, 0.0, "limit"), (None, float("nan"), "limit")]
)
def test_speed_refuses_what_it_cannot_do(parts, limit, word) -> None:
    with pytest.raises(wr.InputError, match=word):
        speed.speed(parts, limit=limit)


# pages


def small(cut: bool = False) -> Bench:
    rows = (
        {"pair": "tee", "method": "walls", "x": 1234.5, "published": False},
        {"pair": "tee", "method": "theirs", "x": None, "published": True},
    )
    sheet = ResultTable("", (Column("pair", "pair"), Column("method", "method"), Column("x", "x %", 1)), rows)
    return Bench("accuracy", "A title", rows, (sheet,), ("A note.",), "wiggleroom bench accuracy", cut)


def test_a_section_is_put_in_the_place_of_the_old_one() -> None:
    page = "# Mine\n\nbefore\n\n" + bench_markdown(small()) + "\n\nafter\n"
    again = with_section(page, "accuracy", bench_markdown(small(cut=True)))
    assert again.startswith("# Mine\n\nbefore\n")
    assert again.endswith("\n\nafter\n")
    assert again.count("A title") == 1
    assert "Stopped before the last line." in again
    assert with_section("", "accuracy", "new") == "new\n"
    assert with_section("# Mine\n", "accuracy", "new") == "# Mine\n\nnew\n"


# command


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["wiggleroom", *words])
    return main()


def test_chains_command_keeps_the_page(tmp_path: Path, monkeypatch, capsys) -> None:
    page, png = tmp_path / "page.md", tmp_path / "out.png"
    page.write_text("# Others wrote this\n")
    monkeypatch.setattr(chains, "METHODS", {"walls": chains.METHODS["walls"]})
    assert run(monkeypatch, "bench", "chains", "--json", "-", "--markdown", str(page), "--picture", str(png)) == 0
    record = json.loads(capsys.readouterr().out)
    shares = [r["share_percent"] for r in record["chains"] if r["method"] == "walls"]
    assert len(shares) == 12
    np.testing.assert_allclose(shares, 100, atol=1e-4)
    assert page.read_text().startswith("# Others wrote this\n\n<!-- bench chains -->\n")
    assert png.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("bench", "nix"), "nix"),
        (("bench", "--picture", "x.svg"), "name one table"),
        (("bench", "accuracy", "--samples", "0"), "at least 1"),
        (("bench", "chains", "--samples", "5"), "only accuracy"),
        (("bench", "speed", "--max-parts", "3"), "smallest assembly"),
        (("bench", "chains", "--markdown", "x.txt"), ".md"),
        (("bench", "chains", "--picture", "x.mp4"), ".svg"),
    ],
)
def test_bad_words_end_with_one_line(words, said, monkeypatch, capsys, tmp_path) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, *words) == 2
    wrong = capsys.readouterr().err
    assert said in wrong
    assert len(wrong.strip().splitlines()) == 1


def test_square_peg_touches_at_the_angle_of_the_closed_form() -> None:
    plate, peg = shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1), shapely.box(-0.9, -0.9, 0.9, 0.9)
    end = 0.5 * np.arcsin((1 / 0.9) ** 2 - 1)  # 0.9 (cos + sin) = 1
    turns = np.array([[0, 0, s * end * f] for s in (1, -1) for f in (0.999999, 1.000001)])
    assert overlapping(plate, peg, turns).tolist() == [False, True, False, True]


@pytest.mark.parametrize("puzzle", [p for p in PUZZLES if p.truth == APART], ids=lambda p: p.name)
def test_what_comes_apart_does_so_along_a_path_without_overlap(puzzle) -> None:
    assembly = puzzle.assembly()
    ready = wr.prepare(assembly)
    answers = (ready.flex(goal) for goal in interlock._goals(assembly))
    answer = next(a for a in answers if a.verdict == "unbounded" and a.leaves)
    parts = [[shapely.transform(polygon(p), lambda q, p=p: _placed(q, p.at)) for _ in (0,)] for p in assembly.parts]
    path = answer.waypoints
    for first, last in pairwise(path):
        for share in np.linspace(0, 1, 5):
            assert pose_depth(parts, assembly.rest[:, :2], first + share * (last - first)) <= 1e-7 * assembly.size
    gone = [assembly.names.index(name) for name in answer.leaves]
    assert np.hypot(*(path[-1, gone, :2]).T).max() > 0.5 * assembly.size
