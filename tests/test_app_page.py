"""What a page asks and gets: answers are those of the functions that the commands use."""

from __future__ import annotations

import base64
import json
import re
import shlex
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

import wiggleroom as wr
from tests.app_client import Visit
from tests.test_studies_search import corridor
from wiggleroom.cli import main
from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.serve_command import first_request
from wiggleroom.drawing.writers.assembly_writer import write_assembly

PEG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30">'
    '<path id="frame" fill-rule="evenodd" d="M0,0H30V30H0Z M10,10V20H20V10Z"/>'
    '<rect id="peg" x="10" y="10" width="10" height="10"/></svg>'
)
"""A peg of 10 mm in a hole of 10 mm: with a gap g it moves by g each way."""


def chain(gap: float = 0.02) -> bytes:
    return write_assembly(wr.patterns.chain(3, joint="tee", gap=gap).drawing).encode()


def test_a_dropped_file_is_told_as_it_is_drawn_and_asked(page: Visit) -> None:
    told = page.open("chain.json", chain())
    drawing = wr.patterns.chain(3, joint="tee", gap=0.02).drawing
    assert (told["name"], told["gap"], told["unit"]) == ("chain.json", 0.02, "mm")
    assert [p["name"] for p in told["parts"]] == [p.name for p in drawing.parts]
    area = sum(shapely.Polygon(p["rings"][0], p["rings"][1:]).area for p in told["parts"])
    drawn = sum(shapely.Polygon(r.outer, r.holes).area for p in drawing.parts for r in p.regions)
    assert area == pytest.approx(drawn)
    assert told["design"]["fixed"] == ["b1"]
    assert told["design"]["goals"][0]["part"] == "b3"


def test_the_full_answer_is_that_of_flex_and_the_motion_goes_before_it(page: Visit) -> None:
    page.open("chain.json", chain())
    reply = page.ask("flex")
    truth = wr.flex(wr.patterns.chain(3, joint="tee", gap=0.02), search=0)
    assert reply["settled"]
    assert reply["objective"] == pytest.approx(truth.objective, rel=1e-9)
    assert reply["headline"].startswith("b3 moves")
    (path,) = reply["motions"]
    assert np.all(path[0] == 0)
    np.testing.assert_allclose(path[-1], truth.motion, atol=1e-6)


def test_gap_extra_fixed_glue_and_goals_stand_in_place_of_the_files(page: Visit) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.4, "fixed": ["frame"], "goals": [{"part": "peg", "direction": [1, 0], "weight": 2}]}
    reply = page.ask("flex")
    assert reply["objective"] == pytest.approx(2 * 0.4, abs=1e-6)
    assert shapely.Polygon(page.rings[1][0]).area == pytest.approx(9.6**2)
    page.design["extra"] = {"peg": 0.1}  # the peg alone: its own outline moves inward by 0.05
    reply = page.ask("flex")
    assert reply["objective"] == pytest.approx(2 * 0.45, abs=1e-6)
    assert shapely.Polygon(page.rings[1][0]).area == pytest.approx(9.5**2)
    page.told.clear()
    page.ask("flex", shown=reply["shown"])
    assert page.told
    assert not any("rings" in r for r in page.told), "the page shows them"
    page.told.clear()
    page.ask("flex", shown="others")
    assert all("rings" in r for r in page.told)
    page.design["glue"] = [["frame", "peg"]]
    assert "glued" in page.ask("flex")["findings"][0]


def test_what_cannot_be_asked_is_said_in_plain_lines(page: Visit) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.2}
    found = page.ask("flex")["findings"]
    assert len(found) == 2
    assert "nothing is fixed" in found[0]
    assert "--" not in " ".join(found)
    page.design = {"gap": 0.2, "fixed": ["fram"], "goals": [{"part": "peg", "direction": [1, 0]}]}
    assert 'did you mean "frame"' in page.ask("flex")["findings"][0]
    page.design = {"gap": 0.0, "fixed": ["frame"], "goals": [{"part": "peg", "direction": [1, 0]}]}
    assert re.search(r"touch at rest.* give a gap, for example 0\.\d+ mm$", page.ask("flex")["findings"][0])
    page.design = {"gap": 0.2}
    assert page.ask("drag", part="peg", grip=[15, 15], target=[0, 0])["findings"] == [found[0]]
    page.design = {"gap": 40.0, "fixed": ["frame"], "goals": [{"part": "peg", "direction": [1, 0]}]}
    assert "smaller gap" in page.ask("shape")["findings"][0]
    for gap, words in ((1e10, "gap must be 1000000000 or less"), (-1, "gap must be 0 or more")):
        page.design = {"gap": gap}
        assert page.ask("shape")["findings"][0].endswith(words)


def test_commands_say_what_is_on_screen(
    page: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("peg.svg").write_text(PEG, encoding="utf-8")
    page.open("peg.svg", PEG.encode())
    pull = {"part": "peg", "direction": [0.6, 0.8], "point": [20, 20]}
    for more in ({}, {"extra": {"peg": 0.1}}, {"goals": [pull | {"weight": 3}]}):
        page.design = {"gap": 0.4, "fixed": ["frame"], "goals": [pull]} | more
        reply = page.ask("flex")
        if more:
            saved = page.ask("save", what="assembly")
            Path(saved["name"]).write_bytes(base64.b64decode(saved["data"]))
        found = objective(reply["command"], monkeypatch, capsys)
        assert found == pytest.approx(reply["objective"], rel=1e-9)


def test_commands_say_names_that_look_like_options(
    page: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    odd = PEG.replace("frame", "-f, 'r'").replace('id="peg"', 'id="--p:+x@1"')
    Path("a peg.svg").write_text(odd, encoding="utf-8")
    page.open("a peg.svg", odd.encode())
    page.design = {"gap": 0.4, "fixed": ["-f, 'r'"], "goals": [{"part": "--p:+x@1", "turn": "cw"}]}
    reply = page.ask("flex")
    assert objective(reply["command"], monkeypatch, capsys) == pytest.approx(reply["objective"], rel=1e-9)


def test_commands_say_how_the_drawing_was_read(
    page: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = '<path id="stop" stroke="blue" fill="none" d="M10.4,10.4 h2 v2 h-2 Z"/>'
    Path("peg.svg").write_text(PEG.replace("</svg>", f"{scene}</svg>"), encoding="utf-8")
    asked = QuestionOptions(gap=0.4, fix=("frame",), pull=("peg:+x",), skip=("blue",), solid=("@15,15",), join=0.02)
    request = json.loads(first_request("peg.svg", asked))
    page.open("peg.svg", Path("peg.svg").read_bytes(), **{k: request[k] for k in ("design", "skip", "solid", "join")})
    page.design = request["design"]
    reply = page.ask("flex")
    assert "--skip blue --solid @15,15" in reply["command"]
    assert objective(reply["command"], monkeypatch, capsys) == pytest.approx(reply["objective"], rel=1e-9)


def objective(command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> float:
    """What a command finds, by the program itself."""
    words = shlex.split(command)
    assert words[:2] == ["wiggleroom", "flex"]
    monkeypatch.setattr("sys.argv", [*words, "--json", "-"])
    assert main() == 0
    return float(json.loads(capsys.readouterr().out)["objective"])


def test_a_part_is_dragged_as_near_as_its_neighbours_let_it(page: Visit) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.4, "fixed": ["frame"]}
    for target, reached in (((25, 25), (15.4, 15.4)), ((15.1, 0), (15.1, 14.6)), ((15.2, 15.1), (15.2, 15.1))):
        reply = page.ask("drag", part="peg", grip=[15, 15], target=target)
        assert reply["reached"] == pytest.approx(reached, abs=2e-3)
        assert reply["distance"] == pytest.approx(np.hypot(*np.subtract(target, reached)), abs=2e-3)
        assert reply["blocking"] == (["frame"] if target != reached else [])
        np.testing.assert_allclose(reply["motions"][0][0, 1, :2], np.subtract(reached, 15), atol=2e-3)
    assert "no part" in page.ask("drag", part="pig", grip=[15, 15], target=[0, 0])["findings"][0]


def test_nothing_that_is_shown_overlaps(page: Visit) -> None:
    page.open("chain.json", write_assembly(wr.patterns.chain(4, joint="jigsaw", gap=0.03).drawing).encode())
    rng = np.random.default_rng(3)
    names, worst = list(wr.patterns.chain(4).names), 0.0
    for _ in range(6):
        page.design["gap"] = float(rng.uniform(0.02, 0.05))
        page.told.clear()
        page.ask("shape")
        page.until(page.send("drag", part=names[-1], grip=[3, 0], target=rng.normal((3, 0), 0.2).tolist()), "drag")
        page.ask("flex")
        for reply in page.told:
            for motion in (m for path in reply["motions"] for m in path):
                there = [placed(page.rings[k], page, k, motion[k]) for k in range(4)]
                worst = max(worst, *(shapely.intersection(a, b).area for a, b in pairwise(there)))
                assert worst < 1e-7, (reply["kind"], reply.get("settled"), len(reply["motions"][0]), reply.get("path"))
    assert worst < 1e-7  # of parts of 1 mm; motions are sent with seven digits


def placed(rings: list, page: Visit, k: int, motion: np.ndarray) -> shapely.Geometry:
    """A part as the page draws it: its rings at rest, turned about its reference point and moved."""
    at = page.opened["parts"][k]["at"]
    here = shapely.Polygon(rings[0], rings[1:])
    turned = shapely.affinity.rotate(here, motion[2], origin=(at[0], at[1]), use_radians=True)
    return shapely.affinity.translate(turned, motion[0], motion[1])


def test_a_wiggle_goes_there_and_back(page: Visit) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.4, "fixed": ["frame"]}
    reply = page.ask("wiggle")
    assert 1 <= len(reply["modes"]) == len(reply["motions"]) <= 6
    for mode, path in zip(reply["modes"], reply["motions"], strict=True):
        assert mode["parts"] == ["peg"]
        assert np.abs(path[[0, -1]]).max() < 1e-6
        corners = shapely.get_coordinates(shapely.box(-4.8, -4.8, 4.8, 4.8))  # the peg, 9.6 mm
        for x, y, turn in path[:, 1]:
            c, s = np.cos(turn), np.sin(turn)
            assert np.abs(corners @ [[c, s], [-s, c]] + (x, y)).max() < 5.2 + 1e-5  # in the hole, 10.4 mm


def test_what_comes_apart_is_shown_leaving(page: Visit) -> None:
    page.open("row.json", write_assembly(wr.patterns.chain(3, joint="finger", gap=0.1).drawing).encode())
    reply = page.ask("check")
    assert reply["verdict"] == "comes apart"
    assert len(reply["motions"]) == len(reply["escapes"]) > 0
    row = wr.patterns.chain(3, joint="finger", gap=0.1)
    left: set[int] = set()  # out of the game
    for escape, path in zip(reply["escapes"], reply["motions"], strict=True):
        assert "leave" in escape["words"]
        gone = [k for k, name in enumerate(row.names) if name in escape["parts"]]
        straight = (path[-1] - path[-2]) / np.abs(path[-1] - path[-2]).max()
        for motion in [*path, *(path[-1] + far * straight for far in (0.1, 0.3, 1, 3, 10))]:
            there = [moved(row, k, motion[k]) for k in range(3)]
            staying = shapely.union_all([t for k, t in enumerate(there) if k not in {*gone, *left}])
            assert all(shapely.intersection(there[k], staying).area < 1e-6 for k in gone)
        left |= set(gone)


def test_a_plan_is_that_of_plan(page: Visit) -> None:
    row = wr.patterns.chain(3, joint="finger", gap=0.1)
    page.open("row.json", write_assembly(row.drawing).encode())
    reply = page.ask("plan", targets=["b2"], gravity=[0.0, -1.0])
    truth = wr.plan(row, ["b2"], gravity=(0.0, -1.0))
    assert [tuple(step["parts"]) for step in reply["steps"]] == [step.parts for step in truth.steps]
    assert [path.shape[0] > 1 for path in reply["motions"]] == [True] * len(truth.steps)
    assert "--target=b2" in reply["command"]
    assert "--gravity=0,-1" in reply["command"]
    assert page.ask("plan", targets=["nobody"])["kind"] == "failed"


def moved(assembly: wr.Assembly, k: int, motion: np.ndarray) -> shapely.Geometry:
    """Material of a part after a motion about its reference point, by shapely's own transformations."""
    part = assembly.parts[k]
    here = shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in part.regions])
    x, y, turn = np.add(part.at, motion)
    turned = shapely.affinity.rotate(here, turn, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, x, y)


def test_a_sweep_comes_gap_by_gap(page: Visit) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.4, "fixed": ["frame"], "goals": [{"part": "peg", "direction": [0, 1]}]}
    number = page.send("sweep", gaps=[0.3, 0.1, 0.2])
    page.told.clear()
    whole = page.until(number, "sweep")
    steps = [r for r in page.told if r["kind"] == "step"]
    assert [s["gap"] for s in steps] == [0.1, 0.2, 0.3] == [s["gap"] for s in whole["steps"]]
    for step in steps:
        assert step["objective"] == pytest.approx(step["gap"], abs=1e-6)
        assert step["motions"][0][0, 1, 1] == pytest.approx(step["gap"], abs=1e-6)
    assert whole["lost"] is None


def test_a_free_space_is_a_closed_solid_of_the_right_volume(page: Visit) -> None:
    page.open("chain.json", chain())
    reply = page.ask("space", a="b1", b="b2")
    points = np.frombuffer(base64.b64decode(reply["vertices"]), "<f4").reshape(-1, 3).astype(float)
    faces = np.frombuffer(base64.b64decode(reply["triangles"]), "<u4").reshape(-1, 3)
    a, b, c = (points[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6  # of a closed surface, by the divergence theorem
    space = wr.free_space(wr.patterns.chain(3, joint="tee", gap=0.02), "b1", "b2")
    angles = np.degrees([s.angle for s in space.slices])
    areas = np.array([s.area for s in space.slices])
    truth = float(((areas[1:] + areas[:-1]) / 2 * np.diff(angles)).sum())
    assert volume == pytest.approx(truth, rel=0.01)
    assert reply["range_deg"] == pytest.approx(np.degrees(space.angles))
    assert "open" not in reply


def test_a_bound_lies_above_the_answer(page: Visit) -> None:
    pytest.importorskip("highspy")
    page.open("chain.json", write_assembly(wr.patterns.chain(2, joint="tee", gap=0.01).drawing).encode())
    found = page.ask("flex")["objective"]
    reply = page.ask("prove", share=0.05, seconds=30)
    assert found <= reply["at_most"] <= 1.05 * found * (1 + 1e-9)
    assert "proven" in reply["words"]
    shown = [r for r in page.told if r["kind"] == "flex"][-1]
    assert shown["id"] == reply["id"], "what is shown takes the bound, too"
    assert shown["at_most"] == reply["at_most"]
    assert any(fact.endswith("proven") and fact.startswith("between") for fact in shown["facts"])
    assert page.ask("flex")["at_most"] == reply["at_most"]


@pytest.mark.parametrize(
    ("what", "begins"),
    [
        ("svg", b"<?xml"),
        ("png", b"\x89PNG"),
        ("gif", b"GIF89a"),
        ("html", b"<!DOCTYPE html>"),
        ("json", b'{\n  "format": "wiggleroom.flex/1"'),
        ("assembly", b'{\n"format": "wiggleroom/1"'),
        ("cut-svg", b"<svg"),
        ("cut-dxf", b"999\nMade with wiggleroom "),
    ],
)
def test_what_is_saved_is_what_it_says(page: Visit, what: str, begins: bytes) -> None:
    page.open("chain.json", chain())
    reply = page.ask("save", what=what)
    assert base64.b64decode(reply["data"]).startswith(begins)
    assert reply["name"].startswith("chain")


@pytest.mark.parametrize("searched", [False, True])
def test_the_command_in_a_saved_answer_gives_that_answer(
    page: Visit, searched: bool, tmp_path: Path, command: Callable[..., int]
) -> None:
    made = wr.patterns.chain(8, joint="tee", gap=0.02)
    file, out = tmp_path / "chain.json", tmp_path / "answer.json"
    file.write_text(write_assembly(made.drawing))
    page.open("chain.json", file.read_bytes(), path=str(file))
    page.ask("flex")
    if searched:
        page.ask("rank")
    saved = json.loads(base64.b64decode(page.ask("save", what="json")["data"]))
    assert ("--search" in saved["command"]) is not searched
    assert ("search" in saved) is searched
    assert command(*shlex.split(saved["command"])[1:], "--json", out) == 0
    found = json.loads(out.read_text())
    assert found["objective"] == pytest.approx(saved["objective"], rel=1e-8)
    assert found.get("search") == saved.get("search")


def test_a_cutting_sheet_is_told_from_parts_that_lie_together(page: Visit) -> None:
    row = wr.patterns.chain(3, joint="finger", gap=0.1).drawing
    assert not page.open("row.json", write_assembly(row).encode())["apart"]
    assert not page.open("peg.svg", PEG.encode())["apart"]
    far = replace(row, parts=tuple(replace(p, at=(3 * p.at[0], *p.at[1:])) for p in row.parts))
    assert page.open("sheet.json", write_assembly(far).encode())["apart"]


def test_what_is_suggested_in_space_is_not_locked(page: Visit) -> None:
    """The lid lies on the case and may only shift: by the gap, in x as in y."""
    box = Path(__file__).parents[1] / "examples" / "40_box_with_a_lid" / "box.json"
    told = page.open("box.json", box.read_bytes())
    assert told["pulled"]["part"] == "lid"
    assert told["pulled"]["direction"][2] == 0
    page.design["goals"] = [told["pulled"]]
    reply = page.ask("flex")
    assert reply["objective"] == pytest.approx(told["gap"], rel=1e-3)
    page.design["goals"] = [told["pulled"] | {"direction": [0, 0, 1]}]
    reply = page.ask("flex")
    assert reply["objective"] == pytest.approx(0, abs=1e-6)
    assert reply["contacts"] == [], "the lock holds it, no contact does"


def test_no_dot_is_suggested(page: Visit) -> None:
    """A square of 0.05 mm beside the frame lies farther out than the peg, and is no part that somebody pulls."""
    dot = '<path d="M 45 15 h 0.05 v 0.05 h -0.05 z"/></svg>'
    hollow = PEG.replace("</svg>", dot)
    assert hollow != PEG
    told = page.open("peg.svg", hollow.encode())
    assert len(told["parts"]) == 3
    assert told["pulled"]["part"] == "peg"


@pytest.mark.parametrize("asked", ["bound", "sample"])
def test_studies_speak_of_the_answer_that_is_shown(page: Visit, asked: str) -> None:
    """A climb from rest ends in the pocket; the search gets up the shaft, and the page is told before anything is said of it."""
    pytest.importorskip("highspy")
    page.open("corridor.json", write_assembly(corridor(gap=0.01).drawing).encode())
    assert page.ask("flex")["objective"] == pytest.approx(0.16)
    page.told.clear()
    more = {
        "sample": {"of": "sample", "options": {"spread": 0.002, "draws": 4}},
    }
    kind = {"sample": "study"}.get(asked, asked)
    reply = page.until(page.send(kind, **more.get(asked, {})), kind)
    assert reply["kind"] == kind
    (shown,) = [r for r in page.told if r["kind"] == "flex"]
    assert shown["id"] == reply["id"]
    assert shown["objective"] == pytest.approx(2.06)
    assert shown["motions"][0][-1][1][1] == pytest.approx(2.06)
    if asked == "sample":
        (numbers,) = [one["rows"] for one in reply["study"]["sections"] if one["title"] == "In numbers"]
        assert numbers[0] == ["without variation", pytest.approx(shown["objective"])]
    page.told.clear()
    page.ask(kind, **more.get(asked, {}))
    assert not [r for r in page.told if r["kind"] == "flex"], "it is shown already"
    assert page.ask("flex")["objective"] >= shown["objective"]


def test_the_sample_of_a_cutting_sheet_is_a_box(page: Visit) -> None:
    pytest.importorskip("manifold3d")
    told = page.until(page.send("open", name="sheet", sample=True, data=""))
    assert told["apart"]
    assert len(told["parts"]) == 5
    reply = page.ask("assemble", thickness=3.0, hints={})
    assert reply["certainty"] == "sure"
    assert {panel["state"] for panel in reply["panels"]} == {"placed"}
    assert len(reply["joints"]) == 8


def test_the_state_of_a_pair_lies_in_its_free_space(page: Visit) -> None:
    page.open("chain.json", chain())
    page.ask("flex")
    reply = page.ask("space", a="b2", b="b3")
    x, y, turn = reply["state"]
    near = min(reply["slices"], key=lambda s: abs(s["angle_deg"] - turn))
    region = shapely.union_all([shapely.Polygon(r) for r in near["rings"]])
    assert region.buffer(0.05 * np.sqrt(region.area)).contains(shapely.Point(x, y))
    assert np.hypot(x, y) > 0 or turn != 0


def test_a_saved_cut_is_the_outline_with_the_gap_applied(page: Visit, tmp_path: Path) -> None:
    page.open("peg.svg", PEG.encode())
    page.design = {"gap": 0.4, "extra": {"peg": 0.1}}
    reply = page.ask("save", what="cut-svg")
    (tmp_path / "cut.svg").write_bytes(base64.b64decode(reply["data"]))
    back = wr.read(tmp_path / "cut.svg")
    peg = back.parts[back.names.index("peg")].regions[0]
    assert shapely.Polygon(peg.outer).area == pytest.approx(9.5**2)
