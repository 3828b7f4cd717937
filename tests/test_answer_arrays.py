"""Answers as numpy arrays: the same as the JSON says, and known as our own file."""

import json
import subprocess
import sys

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.provenance import is_own


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
