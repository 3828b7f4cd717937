"""Files as makers have them: read as their makers expect, with everything said that was assumed or left out."""

from __future__ import annotations

import json
import random
import re
import warnings
from pathlib import Path

import pytest

from tests.makers.by_hand import FINDINGS, LIGHTBURN, STYLES
from tests.makers.by_library import CASES
from tests.makers.case import Case
from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.read import reading
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError

ALL = [*FINDINGS, *STYLES, *LIGHTBURN, *CASES]


@pytest.mark.parametrize("case", ALL, ids=[f"{case.program}: {case.name}" for case in ALL])
def test_read_as_the_maker_expects(case: Case, tmp_path):
    path = tmp_path / case.name
    path.write_bytes(case.data)
    options = dict(case.options)
    gap = options.pop("gap", None)
    try:
        found = reading(path, gap=gap, options=ReadOptions(**options))
    except InputError as problem:
        refused = [line for line in problem.findings if case.refused and case.refused in line]
        if not refused:
            raise
        return
    findings = [*found.findings, *(examine(found.drawing)[1] if found.drawing.parts else ())]
    if case.refused:
        assert any(case.refused in line for line in findings), findings
        return
    said = " ".join(found.drawing.notes)
    assert not findings, (findings, said)
    assert len(found.drawing.parts) == case.parts, said
    assert sum(len(r.holes) for part in found.drawing.parts for r in part.regions) == case.holes, said
    assert {part.name for part in found.drawing.parts} >= set(case.names)
    for words in case.noted:
        assert words in said


BOXES = json.loads((Path(__file__).parent / "makers" / "boxes_py.json").read_text())
"""Parts and holes of boxes.py's generators at default settings, by its own colours: black is cut outside, blue inside.

Counted apart from our reading, in the files' text; where the generator draws a hole in black or an outline as an open
line, by hand.
"""


def from_boxes_py(name: str, style: str) -> bytes:
    warnings.simplefilter("ignore")
    generators = pytest.importorskip("boxes.generators").getAllBoxGenerators()
    generator = next(make for key, make in generators.items() if key.rpartition(".")[2] == name)()
    generator.parseArgs([f"--format={style}"])
    generator.open()
    generator.render()
    data = generator.close()
    return data.getvalue() if hasattr(data, "getvalue") else data


@pytest.mark.parametrize("name", BOXES)
def test_generators_of_boxes_py_at_default_settings(name, tmp_path):
    path = tmp_path / f"{name}.svg"
    path.write_bytes(from_boxes_py(name, "svg"))
    found = reading(path)
    assert not found.findings
    assert [len(found.drawing.parts), sum(len(r.holes) for p in found.drawing.parts for r in p.regions)] == BOXES[name]
    assert any("reference bar of boxes.py" in note for note in found.drawing.notes)


@pytest.mark.parametrize("name", ["ClosedBox", "TypeTray", "UniversalBox"])
def test_generators_of_boxes_py_for_lightburn(name, tmp_path):
    path = tmp_path / f"{name}.lbrn2"
    path.write_bytes(from_boxes_py(name, "lbrn2"))
    found = reading(path)
    assert [len(found.drawing.parts), sum(len(r.holes) for p in found.drawing.parts for r in p.regions)] == BOXES[name]


def mutated(case: Case, lot: random.Random) -> bytes:
    """A file with one thing wrong: cut off, doubled, mirrored, in a wrong unit, or with something gone or changed."""
    data, kind = case.data, lot.choice(("cut", "double", "mirror", "unit", "delete", "bytes", "number"))
    text = data.decode(errors="replace")
    if kind == "cut":
        return data[: lot.randrange(len(data))]
    if kind == "double" and "<svg" in text:
        head, _, body = text.partition("<svg")
        start = body.index(">") + 1
        return f"{head}<svg{body[:start]}{body[start:].rpartition('</svg>')[0]}{body[start:]}".encode()
    if kind == "mirror":
        return re.sub(r'(\bd="M)(\d+)', lambda m: f"{m[1]}-{m[2]}", text).encode()
    if kind == "unit":
        return re.sub(r"mm", lot.choice(("in", "px", "furlong", "")), text).encode()
    if kind == "delete":
        pieces = re.split(r"(?=<)", text)
        del pieces[lot.randrange(len(pieces))]
        return "".join(pieces).encode()
    if kind == "number":
        numbers = list(re.finditer(r"\d+(\.\d+)?", text))
        hit = lot.choice(numbers)
        return (text[: hit.start()] + lot.choice(("1e30", "nan", "-7", "0", "")) + text[hit.end() :]).encode()
    spot = lot.randrange(len(data))
    return data[:spot] + bytes([lot.randrange(256)]) + data[spot + 1 :]


@pytest.mark.parametrize("seed", range(200))
def test_damaged_files_are_read_or_refused_in_plain_lines(seed, tmp_path):
    """Never a traceback; every line of the file that is neither part nor hole is said."""
    lot = random.Random(seed)
    case = lot.choice([case for case in ALL if not case.options])
    path = tmp_path / case.name
    data = mutated(case, lot)
    path.write_bytes(data)
    there = data.count(b"<") >= case.data.count(b"<")  # no element is gone that nobody could miss
    try:
        found = reading(path)
        findings = (*found.findings, *(examine(found.drawing)[1] if found.drawing.parts else ()))
    except InputError as problem:
        findings = problem.findings
    else:
        assert found.drawing.parts or findings
        drawn = sum(len(r.holes) + 1 for part in found.drawing.parts for r in part.regions)
        expected = case.parts + case.holes
        assert not there or drawn >= expected or found.drawing.notes or findings
    assert all(line and "\n" not in line and len(line) < 600 for line in findings)
    assert all("Traceback" not in line for line in findings)
