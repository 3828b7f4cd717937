"""rank, tighten, sweep and sample on the command line."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import wiggleroom as wr
from wiggleroom.drawing import write_drawing
from wiggleroom.report.pictures import palette

Run = Callable[..., tuple[int, str, list[str]]]
COMMANDS = {
    "rank": [],
    "tighten": ["--parts", "1", "--draws", "2", "--workers", "1"],
    "sweep": ["--gaps", "0.01,0.02"],
    "sample": ["--spread", "0.001", "--draws", "5", "--limit", "1", "--workers", "1"],
}

FILMS = ("p.gif", "p.mp4", "p.film.svg")


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command_output: Run) -> Run:
    """Run the program beside a small chain; exit code, stdout and the lines of stderr."""
    write_drawing(wr.patterns.chain(3, joint="tee", gap=0.02).drawing, tmp_path / "chain.json")
    monkeypatch.chdir(tmp_path)
    return command_output


@pytest.mark.parametrize("command", COMMANDS)
def test_a_study_is_told_to_people_programs_and_in_pictures(run, command: str) -> None:
    code, out, err = run(command, "chain.json", *COMMANDS[command], "--json", "-", "--picture", "p.html")
    assert (code, err) == (0, ["picture: p.html"])
    record = json.loads(out)  # and nothing else
    assert record["format"] == f"wiggleroom.{command}/1"
    assert record["command"].startswith(f"wiggleroom {command} chain.json")
    code, out, err = run(command, "chain.json", *COMMANDS[command], "--json", "out.json", "--picture", "p.svg")
    assert code == 0
    assert "b3" in out
    assert max(map(len, out.splitlines())) <= 80
    assert sorted(err) == ["answer: out.json", "picture: p.svg"]
    for name in ("p.html", "p.svg"):
        assert f"wiggleroom {command} chain.json" in Path(name).read_text()
    colour = {"rank": palette.IMPORTANCE_COLOURS[-1], "tighten": palette.CHOSEN}.get(command)
    assert colour is None or f'fill="{colour}" fill-opacity' in Path("p.svg").read_text()


@pytest.mark.parametrize(("own", "then", "told"), [(0.5, "0.4 mm", True), (0.2, "0.1 mm", False)])
def test_tighten_says_what_joints_with_a_gap_of_their_own_keep(run, own: float, then: str, told: bool) -> None:
    side = [[-5, -5], [5, -5], [5, 5], [-5, 5]]
    tray = {"name": "tray", "outline": [[2 * x, 2 * y] for x, y in side], "holes": [side], "fixed": True}
    made = {
        "format": "wiggleroom/1", "gap": 0.2, "parts": [tray, {"name": "block", "outline": side}],
        "gaps": [{"parts": ["block", "tray"], "gap": own}], "pull": [{"part": "block", "direction": [1, 0]}],
    }  # fmt: skip
    Path("pocket.json").write_text(json.dumps(made))
    out = run("tighten", "pocket.json", "--parts", "2", "--to", "0.1", "--draws", "0")[1]
    assert out.startswith(f"block moves {then} in +x with these parts tighter")
    assert ("those with a larger gap of their own keep what theirs is more" in out) is told


@pytest.mark.parametrize(
    ("command", "name"), [(command, FILMS[k % 3]) for k, command in enumerate(["rank", "space", "draw"])]
)
def test_where_there_is_no_film_it_is_said(run, command: str, name: str) -> None:
    more = {"space": ["b1", "b2", "--picture", name], "draw": [name]}.get(command) or [
        *COMMANDS[command],
        "--picture",
        name,
    ]
    code, out, err = run(command, "chain.json", *more)
    assert (code, out, len(err)) == (2, "", 1)
    assert f"{name}: the name must end in .svg" in err[0]
    assert "films come from flex" in err[0]
    assert not Path(name).exists()


def test_a_proven_band_is_told_everywhere(run) -> None:
    pytest.importorskip("highspy")
    words = ("sweep", "chain.json", "--gaps", "0.01,0.02", "--pull", "b3:+y", "--prove", "0.01")
    code, out, _ = run(*words, "--json", "out.json", "--csv", "out.csv", "--picture", "out.svg")
    assert code == 0
    entries = json.loads(Path("out.json").read_text())["gaps"]
    assert all(e["objective"] <= e["at_most"] <= 1.0101 * e["objective"] for e in entries)
    assert Path("out.csv").read_text().splitlines()[0].endswith("at_most")
    assert 'class="band"' in Path("out.svg").read_text()
    assert "at most" in out
    assert "proven" in out
    assert run("sweep", "chain.json", "--gaps", "0.01", "--prove", "0")[0] == 2


def test_a_sweep_of_gaps_that_cannot_be_made_holds_nothing(run) -> None:
    assert "nothing in this range sets it free" in run("sweep", "chain.json", "--gaps", "0,0.01")[1]
    out = run("sweep", "chain.json", "--gaps", "0,3")[1]
    assert "at none of these gaps is there a motion" in out
    assert "sets it free" not in out


def test_a_limit_out_of_reach_is_no_success(run) -> None:
    code, out, _ = run("tighten", "chain.json", "--limit", "1e-9", "--draws", "0")
    assert code == 3
    assert "not reached" in out


def test_a_sample_of_misfits_alone_has_no_quantiles(run) -> None:
    code, out, _ = run("sample", "chain.json", "--spread", 0.001, "--bias", -0.1, "--draws", 3, "--workers", 1)
    assert code == 0
    assert "in 3 draws parts do not fit" in out
    assert "nan" not in out


def test_ctrl_c_ends_in_order(tmp_path: Path) -> None:
    write_drawing(wr.patterns.frame(40, 40, joint="tee", gap=0.01).drawing, tmp_path / "frame.json")
    words = ["sample", "frame.json", "--spread", "0.001", "--draws", "100000", "--workers", "1"]
    program = [sys.executable, "-c", "import sys; from wiggleroom.cli import main; sys.exit(main())"]
    process = subprocess.Popen(
        [*program, *words], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )  # fmt: skip
    time.sleep(4)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert "Traceback" not in err
    assert process.returncode == 3
    assert "stopping" in err
    # before the first draw is done there is nothing to say
    assert "interrupted" in err or "stopped:" in out


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["rank", "chain.json", "--by", "magic"], "magic"),
        (["rank", "chain.json", "--workers", "0"], "--workers 0"),
        (["rank", "chain.json", "--picture", "p.txt"], "--picture p.txt"),
        (["tighten", "chain.json"], "how many parts"),
        (["tighten", "chain.json", "--parts", "9"], "choose 1 to 3"),
        (["tighten", "chain.json", "--parts", "1", "--to", "1"], "less than the present gap"),
        (["tighten", "chain.json", "--parts", "1", "--draws", "-1"], "--draws -1"),
        (["sweep", "chain.json", "--gaps", "a"], "--gaps a"),
        (["sweep", "chain.json", "--gaps", "1:2:1"], "--gaps 1:2:1"),
        (["sweep", "chain.json", "--gaps", "-1"], "gap -1"),
        (["sample", "chain.json"], "--spread"),
        (["sample", "chain.json", "--spread", "0"], "spread 0"),
        (["sample", "chain.json", "--spread", "0.1", "--sheet", "2"], "correlation 2"),
        (["sample", "chain.json", "--spread", "0.1", "--draws", "0"], "at least 1"),
        (["sample", "chain.json", "--spread", "0.1", "--seed", "-1"], "--seed -1"),
        (["sample", "missing.json", "--spread", "0.1"], "missing.json"),
    ],
)
def test_bad_input_is_one_plain_line(run, argv: list[str], said: str) -> None:
    code, out, err = run(*argv)
    assert (code, out) == (2, "")
    assert len(err) == 1
    assert said in err[0]
