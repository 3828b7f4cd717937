"""What people expect of a command line: JSON alone, words that were meant, completion, and no file of theirs lost."""

from __future__ import annotations

import csv
import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.provenance import is_own
from wiggleroom.report.pictures.missing_glyphs import missing_glyphs

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], command: Callable[..., int]
) -> Run:
    """Run the program beside a small chain: exit code, stdout, stderr."""
    write_drawing(wr.patterns.chain(3, joint="tee", gap=0.02).drawing, tmp_path / "chain.json")
    monkeypatch.chdir(tmp_path)

    def here(*words: object) -> tuple[int, str, str]:
        code = command(*words)
        return (code, *capfd.readouterr())

    return here


@pytest.mark.parametrize("words", [["--json"], ["--json", "--gap", "0.03"]])
def test_json_alone_goes_to_stdout(run: Run, words: list[str]) -> None:
    code, out, err = run("flex", "chain.json", *words)
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert told["objective"] == pytest.approx(0.26875 if "--gap" in words else 0.17357, abs=1e-4)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["flx", "chain.json"], "there is no command flx. Did you mean flex?"),
        (["flex", "chain.json", "--gapp", "1"], "Did you mean --gap?"),
        (["flex", "--modle", "hull", "chain.json"], "Did you mean --model?"),
        (["draw", "chain.json", "-o", "chain.svg"], "there is no option -o; draw takes FILE OUT and options"),
        (["draw", "chain.json", "chain.svg", "more"], "unexpected: more; draw takes FILE OUT and options"),
        (["flex", "chain.json", "--gap"], "--gap is given no value; flex takes FILE and options"),
        (["flex", "chain.json", "--fix", "B2"], 'there is no part "B2": did you mean "b2"?'),
        (["make", "gird", "3", "3", "-o", "x.json"], 'Did you mean "grid"?'),
    ],
)
def test_words_that_were_meant(run: Run, words: list[str], said: str) -> None:
    code, out, err = run(*words)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("name", ["out.svg", "out.csv", "out.dxf"])
def test_a_file_of_somebody_else_is_kept_unless_forced(run: Run, name: str) -> None:
    option = {".csv": "--csv", ".json": "--json", ".dxf": "--moved"}.get(Path(name).suffix, "--picture")
    words = ["flex", "chain.json", option, name]
    Path(name).write_bytes(b"somebody's work")
    code, out, err = run(*words)
    assert (code, out) == (2, "")
    assert "--force" in err
    assert Path(name).read_bytes() == b"somebody's work"
    assert run(*words, "--force")[0] == 0
    assert is_own(Path(name))
    assert run(*words)[0] == 0  # our own file is written freely
    changed = Path(name).read_bytes()
    if Path(name).suffix not in (".csv", ".json"):  # these hold no mark, only their kind is known
        Path(name).write_bytes(changed.replace(b"b", b"c", 1))
        assert run(*words)[0] == 2


def test_empty_files_and_devices_are_written(run: Run) -> None:
    Path("out.svg").touch()
    assert run("draw", "chain.json", "out.svg")[0] == 0
    assert run("flex", "chain.json", "--json", "/dev/null")[0] == 0


@pytest.mark.parametrize("kind", ["svg", "dxf", "json"])
def test_moved_parts_lie_where_the_answer_says(run: Run, kind: str) -> None:
    assert run("flex", "chain.json", "--moved", f"moved.{kind}", "--json", "a.json")[0] == 0
    told = json.loads(Path("a.json").read_text())["parts"]
    moved = {p.name: p for p in read_drawing(Path(f"moved.{kind}")).parts}
    for part in wr.read("chain.json").parts:
        x, y, angle = part.at
        turn = angle + np.radians(told[part.name]["turn_deg"])
        c, s = np.cos(turn), np.sin(turn)
        (region,) = part.regions
        want = region.outer @ [[c, s], [-s, c]] + (x + told[part.name]["dx"], y + told[part.name]["dy"])
        there = moved[part.name]
        got = there.regions[0].outer @ _turned(there.at[2]) + there.at[:2]
        shift = want.min(axis=0) - got.min(axis=0) if kind == "svg" else np.zeros(2)  # a page begins at its corner
        assert np.abs(np.sort(got + shift, axis=0) - np.sort(want, axis=0)).max() < 1e-6


def _turned(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize(
    ("words", "heads", "rows"),
    [
        (["flex"], "step,part,dx_mm,dy_mm,turn_deg", 6),
        (["rank"], "kind,name,other,per_mm,tighter_per_mm,percent", 5),
        (["sweep", "--gaps", "0.01,0.02"], "gap,objective,verdict", 2),
        (["sample", "--spread", "0.001", "--draws", "4"], "draw,objective,b1,b2,b3", 4),
        (["tighten", "--parts", "1", "--draws", "0"], "order,part,moved_before_mm,moved_after_mm", 1),
    ],
)
def test_tables(run: Run, words: list[str], heads: str, rows: int) -> None:
    assert run(words[0], "chain.json", *words[1:], "--csv", "t.csv", "--json", "r.json")[0] == 0
    lines = Path("t.csv").read_text().splitlines()
    assert lines[0] == heads
    assert len(lines) >= rows + 1
    assert is_own(Path("t.csv"))
    if words[0] == "flex":
        told = json.loads(Path("r.json").read_text())["parts"]
        last = {row["part"]: row for row in csv.DictReader(lines)}  # later steps replace earlier ones
        assert float(last["b3"]["dy_mm"]) == told["b3"]["dy"]
        assert float(last["b3"]["turn_deg"]) == told["b3"]["turn_deg"]


@pytest.mark.parametrize("words", [["flex"], ["check"], ["sweep"], ["gap", "--at-most", "2.3"]])
def test_time_ends_long_questions_with_an_honest_word(run: Run, words: list[str]) -> None:
    write_drawing(wr.patterns.grid(12, 12, joint="swallowtail", gap=0.02).drawing, Path("large.json"))
    began = time.perf_counter()
    code, out, err = run(words[0], "large.json", *words[1:], "--time", "0.2", "--json")
    assert time.perf_counter() - began < 60
    assert code in (0, 3) if words[0] == "check" else code == 3
    if out:
        told = json.loads(out)
        assert told.get("verdict", "stopped") in ("stopped", "unknown", "interlocked")
        assert told.get("certainty") != "proven" or words[0] == "check"
    else:
        assert "give more --time" in err


def test_letters_that_no_font_has_are_named(run: Run) -> None:
    assert missing_glyphs(["Größe œuvre 3 mm²"]) == ""
    rare = "漢\U000131af\U00012000"  # Chinese, a hieroglyph, cuneiform
    nowhere = missing_glyphs([rare])[:1]
    if not nowhere:
        pytest.skip("fonts of this machine have even these letters")
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">'
    Path("a.svg").write_text(f'{svg}<path id="lid{nowhere}" d="M0 0H10V10H0z"/></svg>', encoding="utf-8")
    _, _, err = run("draw", "a.svg", "a.png")
    assert f"has the letters {nowhere};" in err
    _, _, err = run("draw", "a.svg", "b.svg")
    assert "letters" not in err


def test_odd_numbers_are_doubted(run: Run) -> None:
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" viewBox="0 0 20 10">{2}</svg>'
    two = '<path id="a" fill="red" d="M0 0H10V10H0z"/><path id="b" d="M10 0H20V10H10z"/>'
    Path("a.svg").write_text(svg.format(20, 10, two))
    assert "the gap of 1.5 mm is large beside" in run("draw", "a.svg", "o.svg", "--gap", "1.5")[2]
    assert "large" not in run("draw", "a.svg", "o.svg", "--gap", "0.5")[2]
    Path("a.svg").write_text(svg.format(12000, 6000, two))
    assert "12 m wide" in run("draw", "a.svg", "o.svg")[2]
    Path("a.svg").write_text(svg.format(0.5, 0.25, two))
    assert "0.5 mm wide" in run("draw", "a.svg", "o.svg")[2]
    apart = "".join(f'<path id="p{k}" d="M{7 * k} 0h5v5h-5z"/>' for k in range(3))
    Path("a.svg").write_text(svg.format(20, 10, apart))
    err = run("draw", "a.svg", "o.svg")[2]
    assert "these look like parts on a cutting sheet: 3 of 3 touch nothing" in err
    assert "wiggleroom assemble" in err
    nested = '<path id="tray" fill-rule="evenodd" d="M0 0H20V10H0z M1 1V9H19V1z"/><path id="a" d="M3 3h5v4h-5z"/>'
    Path("a.svg").write_text(svg.format(20, 10, nested))
    assert "sheet" not in run("draw", "a.svg", "o.svg")[2]  # a loose part in a tray is an assembly


def test_a_pull_far_outside_of_its_part_is_told(run: Run) -> None:
    """A bolt drawn away from its origin: what is pulled by default turns with it, and goes further than the bolt."""
    jaw = {
        "name": "jaw",
        "outline": [[0, -4], [20, -4], [20, 16], [0, 16], [0, 10], [10, 10], [10, 2], [0, 2]],
        "fixed": True,
    }
    bolt = {"name": "bolt", "outline": [[-20, 2], [10, 2], [10, 10], [-20, 10]], "at": [0, 0, 0]}
    out = {"format": "wiggleroom/1", "gap": 0.2, "pull": [{"part": "bolt", "direction": [1, 0]}]}
    far = {**bolt, "outline": [[x, y + 12] for x, y in [[-20, 2], [10, 2], [10, 10], [-20, 10]]], "at": [0, -12, 0]}
    for part, told in ((bolt, False), (far, True)):
        Path("a.json").write_text(json.dumps({**out, "parts": [jaw, part]}))
        code, said, err = run("flex", "a.json", "--search", "0")
        assert code == 0
        assert ('"bolt" is pulled at its reference point (0, -12), 14 mm outside of it' in err) is told
    middle = err.rpartition("@")[2].split()[0]
    assert middle == "-5,6"
    _, said, err = run("flex", "a.json", "--pull", f"bolt:+x@{middle}", "--search", "0")
    assert "outside" not in err
    assert "bolt at (-5, 6) moves 0.2" in said


@pytest.mark.parametrize("words", [["fl", "flex"], ["flex", "--pro", "--prove"]])
def test_bash_completes(run: Run, words: list[str]) -> None:
    *typed, wanted = words
    script = run("completion", "bash")[1]
    ask = f'COMP_WORDS=(wiggleroom {" ".join(typed)}); COMP_CWORD={len(typed)}; _wiggleroom; echo "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", f"{script}\n{ask}"], capture_output=True, text=True, check=False)
    assert wanted in done.stdout.split()


@pytest.mark.parametrize(("shell", "word"), [("zsh", "#compdef wiggleroom"), ("fish", "complete -c wiggleroom")])
def test_other_shells(run: Run, shell: str, word: str) -> None:
    code, out, _ = run("completion", shell)
    assert code == 0
    assert word in out
    assert "at-most" in out
