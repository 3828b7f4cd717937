"""The command line, as its users meet it: every line here starts a process of its own or runs `main` in this one."""

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

from wiggleroom.cli import main
from wiggleroom.cli.asking import goals, names
from wiggleroom.drawing.model import Pull, Turn

Run = Callable[..., tuple[int, str, list[str]]]
PEG = {
    "format": "wiggleroom/1",
    "unit": "mm",
    "parts": [
        {
            "name": "ring",
            "outline": [[0, 0], [30, 0], [30, 20], [0, 20]],
            "holes": [[[5, 5], [25, 5], [25, 15], [5, 15]]],
            "at": [0, 0, 0],
            "fixed": True,
        },
        {"name": "peg", "outline": [[-9, -4], [9, -4], [9, 4], [-9, 4]], "at": [15, 10, 0]},
    ],
}
PROGRAM = [sys.executable, "-c", "import sys; from wiggleroom.cli import main; sys.exit(main())"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with one assembly in it, from which the program runs."""
    (tmp_path / "peg.json").write_text(json.dumps(PEG))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder: Path, command_output: Run) -> Run:
    """Run the program here; exit code, stdout and the lines of stderr."""
    return command_output


def test_flex_answers_in_a_table_json_and_a_picture(run, folder: Path) -> None:
    code, out, err = run("flex", "peg.json", "--pull", "peg:+y", "--json", "a.json", "--picture", "a.svg")
    assert code == 0
    assert "peg moves 1 mm in +y" in out
    assert err == ["answer: a.json", "picture: a.svg"]
    record = json.loads((folder / "a.json").read_text())
    assert record["objective"] == pytest.approx(1.0, abs=1e-6)
    assert record["verdict"] in ("proven", "optimal")
    assert record["collision_free"] is True
    assert record["command"] == "wiggleroom flex peg.json --pull peg:+y --json a.json --picture a.svg"
    assert record["command"] in (folder / "a.svg").read_text()
    assert set(record["seconds"]) >= {"read", "freespace", "solve", "total"}


def test_models_and_objectives_by_option(run) -> None:
    for options, value in (
        (["--pull", "peg:+y", "--model", "hull", "--about", "joint", "--slices", "5"], 1.0),
        (["--pull", "peg:+y", "--model", "halfplane"], 1.0),
        (["--objective", "translation"], 2.0),
        (["--objective", "translation", "--model", "hull", "--solver", "ipopt"], 2.0),
    ):
        code, out, _ = run("flex", "peg.json", *options, "--json", "-")
        record = json.loads(out)
        assert code == 0
        assert record["objective"] == pytest.approx(value, rel=1e-4)
        assert record["model"] == (options[options.index("--model") + 1] if "--model" in options else "walls")
    code, out, _ = run("flex", "peg.json", "--objective", "closer", "--picture", "closer.svg")
    assert code == 0
    assert "neighbours closer" in out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--objective", "closer", "--pull", "peg:+y"], "stands in place of --pull"),
        (["--pull", "peg:+y", "--slices", "5"], "--slices is for --model hull only"),
        (["--pull", "peg:+y", "--model", "hull", "--slices", "1"], "3 or more"),
        (["--pull", "peg:+y", "--model", "halfplane", "--solver", "ipopt"], "leave the solver out"),
    ],
)
def test_options_that_do_not_go_together(run, options: list[str], said: str) -> None:
    code, _, err = run("flex", "peg.json", *options)
    assert code == 2
    assert any(said in line for line in err)


def test_unbounded_is_an_answer(run, folder: Path) -> None:
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    parts = [{"name": n, "outline": square, "at": [x, 0, 0], "fixed": x == 0} for n, x in (("a", 0), ("b", 1.1))]
    (folder / "loose.json").write_text(json.dumps({**PEG, "parts": parts}))
    code, out, _ = run("flex", "loose.json", "--pull", "b:+x", "--json", "-")
    record = json.loads(out)
    assert (code, record["verdict"], record["objective"]) == (0, "unbounded", None)
    assert record["leaves"] == ["b"]


BAD = {
    "unknown command": ["flexx"],
    "unknown flag": ["flex", "peg.json", "--wrong"],
    "missing value": ["flex", "peg.json", "--gap"],
    "missing file": ["flex"],
    "no number": ["flex", "peg.json", "--pull", "peg:+y", "--gap", "wide"],
    "negative gap": ["flex", "peg.json", "--pull", "peg:+y", "--gap", "-1"],
    "no such unit": ["flex", "peg.json", "--pull", "peg:+y", "--unit", "furlong"],
    "no such file": ["flex", "nothing.svg", "--pull", "peg:+y"],
    "nothing pulled": ["flex", "peg.json"],
    "unknown part pulled": ["flex", "peg.json", "--pull", "pig:+y"],
    "no direction": ["flex", "peg.json", "--pull", "peg"],
    "odd direction": ["flex", "peg.json", "--pull", "peg:up"],
    "odd turn": ["flex", "peg.json", "--turn", "peg:left"],
    "no such model": ["flex", "peg.json", "--pull", "peg:+y", "--model", "hulls"],
    "no such solver": ["flex", "peg.json", "--pull", "peg:+y", "--solver", "gurobi"],
    "picture of a kind unknown": ["flex", "peg.json", "--pull", "peg:+y", "--picture", "a.bmp"],
    "picture in no folder": ["flex", "peg.json", "--pull", "peg:+y", "--picture", "none/a.svg"],
    "json over the input": ["flex", "peg.json", "--pull", "peg:+y", "--json", "peg.json"],
    "convert to an unknown kind": ["convert", "peg.json", "a.stl"],
    "unknown pattern": ["make", "heap", "3", "-o", "a.json"],
    "no output": ["make", "grid", "3", "3"],
    "unknown joint": ["make", "grid", "3", "3", "--joint", "glue", "-o", "a.json"],
    "unknown size": ["make", "grid", "3", "3", "--size", "girth=2", "-o", "a.json"],
    "no rows": ["make", "grid", "3", "-o", "a.json"],
    "a chain with rows": ["make", "chain", "3", "3", "-o", "a.json"],
}


@pytest.mark.parametrize("argv", BAD.values(), ids=BAD)
def test_bad_usage_is_one_plain_line(run, folder: Path, argv: list[str]) -> None:
    before = (folder / "peg.json").read_bytes()
    code, out, err = run(*argv)
    assert code == 2
    assert out == ""
    assert len(err) == 1
    assert "Traceback" not in err[0]
    assert "fault" not in err[0]
    assert (folder / "peg.json").read_bytes() == before
    assert [p.name for p in folder.iterdir()] == ["peg.json"]


def test_a_stopped_question_reports_what_it_has(run, monkeypatch: pytest.MonkeyPatch) -> None:
    import dataclasses

    from tests.answers import row
    from wiggleroom.verdict import Verdict

    class Fake:
        @staticmethod
        def flex(assembly, goals, *, stop, **options):
            os.kill(os.getpid(), signal.SIGINT)
            assert next((True for _ in range(500) if stop.is_set() or time.sleep(0.01)), False)
            return dataclasses.replace(row(2), verdict=Verdict.STOPPED, assembly=assembly)

    monkeypatch.setitem(sys.modules, "wiggleroom.maximise", Fake)  # type: ignore[arg-type]
    code, out, err = run("flex", "peg.json", "--pull", "peg:+y")
    assert code == 3
    assert "stopped: stopped before the end" in out
    assert err == ["stopping; Ctrl-C again ends at once"]


def test_a_second_interrupt_ends(run, monkeypatch: pytest.MonkeyPatch) -> None:
    class Fake:
        @staticmethod
        def flex(*_: object, **__: object) -> None:
            for _ in range(2):
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.05)

    monkeypatch.setitem(sys.modules, "wiggleroom.maximise", Fake)  # type: ignore[arg-type]
    code, out, err = run("flex", "peg.json", "--pull", "peg:+y")
    assert code == 3
    assert out == ""
    assert err[-1] == "interrupted"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_fault_of_ours_is_one_line_too(run, monkeypatch: pytest.MonkeyPatch) -> None:
    class Fake:
        @staticmethod
        def flex(*_: object, **__: object) -> None:
            raise ZeroDivisionError

    monkeypatch.setitem(sys.modules, "wiggleroom.maximise", Fake)  # type: ignore[arg-type]
    code, _, err = run("flex", "peg.json", "--pull", "peg:+y")
    assert code == 3
    assert len(err) == 1
    assert "a fault in wiggleroom" in err[0]


def test_convert_keeps_the_answer(run, folder: Path) -> None:
    path = '<path id="{}" d="M{} 0 h10 v4 c3 -2 3 4 0 2 v4 h-10 v-4 c3 2 3 -4 0 -2 z"/>'
    body = "".join(path.format(name, 10 * k) for k, name in enumerate("abc"))
    (folder / "row.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="10mm" viewBox="0 0 30 10">{body}</svg>'
    )
    asked = ["--fix", "a", "--pull", "c:+y", "--json", "-"]
    assert run("convert", "row.svg", "row.json", "--gap", "0.1")[0] == 0
    drawn = json.loads(run("flex", "row.svg", "--gap", "0.1", *asked)[1])
    kept = json.loads(run("flex", "row.json", *asked)[1])
    assert run("convert", "row.svg", "cut.svg", "--gap", "0.1")[0] == 0
    cut = json.loads(run("flex", "cut.svg", *asked)[1])
    assert kept["objective"] == pytest.approx(drawn["objective"], rel=1e-9)
    assert cut["objective"] == pytest.approx(drawn["objective"], rel=1e-3)


@pytest.mark.parametrize(
    ("argv", "parts"),
    [
        (["grid", "3", "2"], 6),
        (["chain", "4", "--joint", "swallowtail", "--size", "neck=0.15", "--gap", "0.02"], 4),
        (["frame", "4", "4", "--pitch", "25"], 12),
        (["jigsaw", "3", "3"], 9),
    ],
)
def test_make_writes_assemblies_that_can_be_drawn(run, folder: Path, argv: list[str], parts: int) -> None:
    assert run("make", *argv, "-o", "made.json") == (0, "", [f"{parts} parts: made.json"])
    record = json.loads((folder / "made.json").read_text())
    assert len(record["parts"]) == parts
    assert run("draw", "made.json", "made.svg")[0] == 0
    assert run("draw", "made.json", "made.png")[0] == 0
    assert (folder / "made.png").read_bytes()[:4] == b"\x89PNG"
    assert f"{parts} parts" in (folder / "made.svg").read_text()


def test_help_says_what_every_command_does(run) -> None:
    code, out, err = run("--help")
    assert (code, err) == (0, [])
    for word in ("flex", "convert", "make", "draw", "largest motion", "exit" if "exit" in out else "Exit"):
        assert word in out
    for command in ("flex", "convert", "draw"):
        _, out, _ = run(command, "--help")
        for option in ("--gap", "--unit", "--flatten", "--fix", "--pull", "--turn"):
            assert option in out
    assert run("--version")[1].strip().count(".") == 2


def test_a_closed_pipe_is_no_error() -> None:
    with subprocess.Popen([*PROGRAM, "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0


def test_names_hold_colons_and_commas() -> None:
    found, wrong = goals(["a:b:+y", "c,d:0.6,0.8@1,-2", "e@f:-x"], ["g:h:cw"])
    assert wrong == []
    assert found == [
        Pull("a:b", (0.0, 1.0)),
        Pull("c,d", (0.6, 0.8), (1.0, -2.0)),
        Pull("e@f", (-1.0, 0.0)),
        Turn("g:h", "cw"),
    ]
    assert names(["a,b,c", "d"], {"a", "b,c", "d"}) == ["a", "b,c", "d"]
    assert names(["x,y"], {"a"}) == ["x", "y"]


@pytest.mark.parametrize("name", ["a.svg", "a.film.svg", "a.html", "a.gif"])
def test_the_ending_says_what_kind_of_picture(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if name.endswith("gif"):
        pytest.importorskip("PIL")
    monkeypatch.setattr(sys, "argv", ["wiggleroom", "flex", "peg.json", "--pull", "peg:+x", "--picture", name])
    assert main() == 0
    data = (folder / name).read_bytes()
    begins = {"a.svg": b"<?xml", "a.film.svg": b"<?xml", "a.html": b"<!DOCTYPE html>", "a.gif": b"GIF89a"}
    assert data.startswith(begins[name])
    assert (b"<animateTransform" in data) == (name == "a.film.svg")


def test_a_missing_extra_is_said_before_the_long_work(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from wiggleroom import errors

    monkeypatch.setattr(errors, "find_spec", lambda name: None)
    monkeypatch.setattr(sys, "argv", ["wiggleroom", "flex", "peg.json", "--pull", "peg:+x", "--picture", "a.mp4"])
    assert main() == 2
    said = capsys.readouterr()
    assert ".[film]" in said.err
    assert said.out == ""
    assert not (folder / "a.mp4").exists()


def test_flex_says_what_other_starts_came_to(run, folder: Path) -> None:
    code, out, _ = run("flex", "peg.json", "--pull", "peg:+y", "--search", "3")
    assert code == 0
    assert "search:  " in out
    code, out, _ = run("flex", "peg.json", "--pull", "peg:+y", "--search", "3", "--json", "-")
    assert 1 <= json.loads(out)["search"]["starts"] <= 4
    code, out, _ = run("flex", "peg.json", "--pull", "peg:+y", "--search", "0", "--json", "-")
    assert "search" not in json.loads(out)
    code, _, err = run("flex", "peg.json", "--pull", "peg:+y", "--search", "-1")
    assert (code, len(err)) == (2, 1)


def test_help_imports_nothing_heavy() -> None:
    heavy = "{'numpy', 'scipy', 'shapely', 'numba', 'msgspec', 'svgelements', 'resvg_py', 'casadi'}"
    code = (
        "import sys; sys.argv = ['wiggleroom', '--help']\n"
        f"from wiggleroom.cli import main; main(); print({heavy} & set(sys.modules), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "set()"
