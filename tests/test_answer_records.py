"""The answer as JSON, as a table and as arrays."""

from __future__ import annotations

import io
import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

import wiggleroom as wr
from tests.answers import answer, block, grid, row
from wiggleroom.drawing.model import Part, Pull, Turn
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.provenance import is_own
from wiggleroom.report.findings.flex import finding
from wiggleroom.report.results.finding_text import finding_text
from wiggleroom.report.results.json_results import flex_result, to_json
from wiggleroom.search.answer import Answer
from wiggleroom.verdict import Verdict

KEYS = [
    "format", "verdict", "objective", "at_most", "parts", "collision_free", "deepest_overlap", "path", "contacts",
    "model", "solver", "rounds", "seconds", "notes", "command",
]  # fmt: skip


def test_the_record_keeps_the_contract() -> None:
    case = row(3)
    case = replace(case, motion=np.array([[0, 0, 0], [0.1, -0.0, 0.0], [0.1, 1.2, math.radians(3.4)]]))
    record = json.loads(to_json(flex_result(case)))
    assert list(record) == KEYS
    assert record["format"] == "wiggleroom.flex/1"
    assert record["verdict"] == "optimal"
    assert record["at_most"] is None
    assert record["parts"]["b3"]["dy"] == 1.2
    assert abs(record["parts"]["b3"]["turn_deg"] - 3.4) < 1e-12
    assert record["contacts"] == [{"parts": ["b1", "b2"], "point": [0.5, 0.0], "normal": [0.0, 1.0], "force": 0.7}]
    assert record["seconds"]["total"] == 0.31


def test_nothing_that_json_cannot_say_is_written() -> None:
    case = replace(row(2), motion=np.array([[0, 0, 0], [np.inf, np.nan, 0]]), objective=math.inf)
    record = json.loads(to_json(flex_result(case)), parse_constant=lambda word: 1 / 0)
    assert record["parts"]["b2"] == {"dx": None, "dy": None, "turn_deg": 0.0}


def test_unbounded_says_who_leaves_and_turns() -> None:
    parts = [Part("a", (block(),), fixed=True), Part("b", (block(),), (3, 0, 0))]
    case = answer(parts, [(0, 0, 0), (9, 0, 0)], (Pull("b", (1, 0)),), 9.0, verdict=Verdict.UNBOUNDED, leaves=("b",))
    result = flex_result(case)
    assert result.objective is None
    assert result.leaves == ["b"]
    assert result.turns == []
    assert "nothing stops" in page(replace(case, objective=None))


def page(case: Answer, width: int = 80) -> str:
    out = io.StringIO()
    Console(file=out, width=width, highlight=False, markup=False).print(finding_text(finding(case)))
    return out.getvalue()


def test_the_table_says_it_all_in_80_columns() -> None:
    text = page(grid(12))
    assert max(map(len, text.splitlines())) <= 80
    assert "\x1b" not in text
    for words in (
        "b144 moves 0.24 mm in +x",
        "optimal: every active wall",
        "and 131 more",
        "no overlap",
        "41 iterations",
    ):
        assert words in text
    lines = text.splitlines()
    assert lines[5].split() == ["b144", "0.2383", "0.1192", "0.000"]  # the pulled part comes first
    assert "1 at rest" in text


def test_turns_are_told_in_degrees() -> None:
    parts = [Part("a [b]", (block(),), fixed=True), Part("[red]c", (block(),), (3, 0, 0))]
    text = page(answer(parts, [(0, 0, 0), (0, 0, 0.1)], (Turn("[red]c", weight=2.0),), 0.2))
    assert "[red]c turns 5.73° ccw" in text


def test_several_goals_add_up() -> None:
    case = replace(row(3), goals=(Pull("b3", (0, 1)), Pull("b2", (1, 0), weight=2.0)))
    text = page(case)
    assert "0.3 mm: b3 in +y, b2 in +x" in text
    assert "weight 2" in text


def command(*words):
    code = "import sys; from wiggleroom.cli import main; sys.exit(main())"
    return subprocess.run([sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True)


def test_arrays_say_what_the_json_says(tmp_path):
    file, arrays, record = tmp_path / "row.json", tmp_path / "row.npz", tmp_path / "answer.json"
    file.write_text(write_assembly(wr.patterns.chain(4, joint="tee", gap=0.02).drawing))
    done = command("flex", file, "--arrays", arrays, "--json", record)
    assert done.returncode == 0, done.stderr
    said, found = json.loads(record.read_text()), np.load(arrays)
    assert list(found["names"]) == list(said["parts"])
    for name, motion in zip(found["names"], found["motion"], strict=True):
        part = said["parts"][name]
        assert [part["dx"], part["dy"], part["turn_deg"]] == pytest.approx([*motion[:2], np.degrees(motion[2])])
    assert np.array_equal(found["waypoints"][-1], found["motion"])
    assert not found["waypoints"][0].any()
    assert len(said["contacts"]) == len(found["contact_force"]) > 0
    for k, contact in enumerate(said["contacts"]):
        assert list(found["names"][found["contact_parts"][k]]) == contact["parts"]
        assert list(found["contact_point"][k]) == pytest.approx(contact["point"])
        assert list(found["contact_normal"][k]) == pytest.approx(contact["normal"])
        assert found["contact_force"][k] == pytest.approx(contact["force"])
    assert float(found["objective"]) == said["objective"]
    assert str(found["verdict"]) == said["verdict"]
    assert is_own(arrays)
    content = bytearray(arrays.read_bytes())
    content[len(content) // 2] ^= 1
    arrays.write_bytes(content)
    assert not is_own(arrays)


def test_arrays_are_refused_where_they_cannot_be(tmp_path):
    file = tmp_path / "row.json"
    file.write_text(write_assembly(wr.patterns.chain(2, joint="tee", gap=0.02).drawing))
    done = command("flex", file, "--arrays", tmp_path / "out.txt")
    assert done.returncode == 2
    assert "--arrays" in done.stderr
    assert ".npz" in done.stderr
    assert not (tmp_path / "out.txt").exists()
