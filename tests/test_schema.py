"""One description of results: what is generated from it is current, and what commands write keeps to it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from wiggleroom.drawing.assembly_schema import AssemblyFile
from wiggleroom.schema.generate import generated, typescript
from wiggleroom.schema.results import RESULTS

TOP = Path(__file__).parents[1]
FRAME = str(TOP / "examples" / "08_peg_in_a_square_hole" / "peg.json")
COMMANDS = {
    "flex": ["flex", FRAME],
    "check": ["check", FRAME],
    "rank": ["rank", FRAME],
    "tighten": ["tighten", FRAME, "--parts", "1"],
    "sweep": ["sweep", FRAME, "--gaps", "0.1,0.2"],
    "sample": ["sample", FRAME, "--spread", "0.02", "--draws", "5"],
}


@pytest.mark.parametrize("path", generated(TOP), ids=lambda path: path.name)
def test_what_is_generated_is_current(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == generated(TOP)[path]


@pytest.mark.parametrize("more", [("--thickness", "3"), ()])
def test_what_assemble_writes_keeps_to_its_structure(
    more: tuple[str, ...], command: Callable[..., int], tmp_path: Path
) -> None:
    place = tmp_path / "answer.json"
    sheet = TOP / "tests" / "sheets" / "stool_small.svg"
    command("assemble", str(sheet), *more, "-o", str(tmp_path / "out.json"), "--json", str(place))
    content = json.loads(place.read_text(encoding="utf-8"))
    structure = next(k for k in RESULTS if k.__struct_config__.tag == content["format"])
    assert json.loads(msgspec.json.encode(msgspec.convert(content, structure))) == content


@pytest.mark.parametrize("kind", COMMANDS)
def test_what_a_command_writes_keeps_to_its_structure(kind: str, command: Callable[..., int], tmp_path: Path) -> None:
    place = tmp_path / "answer.json"
    command(*COMMANDS[kind], "--json", str(place))
    content = json.loads(place.read_text(encoding="utf-8"))
    structure = next(k for k in RESULTS if k.__struct_config__.tag == content["format"])
    back = json.loads(msgspec.json.encode(msgspec.convert(content, structure)))
    assert back == content  # nothing that the structure does not know, nothing lost


def test_examples_keep_to_the_schema_of_assembly_files() -> None:
    for path in sorted((TOP / "examples").glob("*/*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(content, dict) and content.get("format") == "wiggleroom/1":
            msgspec.convert(content, AssemblyFile)


def test_a_new_key_shows_in_the_types_of_the_page() -> None:
    assert "at_most: number | null;" in typescript()
