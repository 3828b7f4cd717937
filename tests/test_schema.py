"""One description of results: what is generated from it is current, and what commands write keeps to it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from wiggleroom.drawing.readers.assembly_schema import AssemblyFile
from wiggleroom.report.results.json_results import to_json
from wiggleroom.schema.generate import generated, json_schemas, typescript
from wiggleroom.schema.results import RESULTS

TOP = Path(__file__).parents[1]
FRAME = str(TOP / "examples" / "08_peg_in_a_square_hole" / "peg.json")
LATCH = str(TOP / "examples" / "17_does_it_come_apart" / "sequential.json")
COMMANDS = {
    "flex": ["flex", FRAME],
    "check": ["check", FRAME],
    "rank": ["rank", FRAME],
    "tighten": ["tighten", FRAME, "--parts", "1"],
    "sweep": ["sweep", FRAME, "--gaps", "0.1,0.2"],
    "sample": ["sample", FRAME, "--spread", "0.02", "--draws", "5"],
    "check of gaps": ["check", FRAME, "--largest-gap"],
    "plan": ["plan", LATCH, "--sample", "0.02", "--draws", "5", "--rank", "--smallest-gap"],
    "gap": ["gap", FRAME, "--at-most", "0.06", "--kerf", "0.1"],
    "gap that fits": ["gap", FRAME, "--fits", "0.05"],
    "clearances": ["clearances", FRAME],
    "tolerances": ["tolerances", FRAME, "--tolerances", "TABLE"],
    "space": ["space", FRAME, "plate", "peg", "--samples", "10"],
    "parts": ["parts", FRAME],
}
PEG = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40">
<path id="plate" fill="red" fill-rule="evenodd" d="M0 0H40V40H0ZM9.5 9.5V30.5H30.5V9.5Z"/><path id="peg" fill="gray" d="M10 10H30V30H10Z"/>
</svg>"""
TABLE = "part,plus,minus\npeg,0.05,0.05\n"

JOINT = str(TOP / "examples" / "43_mortise_and_tenon" / "joint.json")
LIFT = ["--pull", "rail:+z@120,0,0"]
IN_SPACE = {
    "flex": ["flex", JOINT, *LIFT],
    "a flex that nothing stops": ["flex", JOINT, "--pull", "rail:+x"],
    "check": ["check", JOINT],
    "check of gaps": ["check", JOINT, "--largest-gap"],
    "parts": ["parts", JOINT],
    "rank": ["rank", JOINT, *LIFT],
    "tighten": ["tighten", JOINT, *LIFT, "--parts", "1", "--draws", "0"],
    "sweep": ["sweep", JOINT, *LIFT, "--gaps", "0.2,0.3"],
    "sample": ["sample", JOINT, *LIFT, "--spread", "0.01", "--draws", "2"],
    "gap": ["gap", JOINT, *LIFT, "--at-most", "1"],
    "clearances": ["clearances", JOINT, "--xy", "0.4", "--z", "0.2"],
}
"""Every command that answers in space."""


def structure_of(content: dict[str, Any]) -> type[msgspec.Struct]:
    """The published structure of a result: that of its format and, where there are two, of its dimension."""
    kinds = [kind for kind in RESULTS if kind.__struct_config__.tag == content["format"]]
    own = [kind for kind in kinds if ("dimension" in kind.__struct_fields__) == ("dimension" in content)]
    return own[0] if len(kinds) > 1 else kinds[0]


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
    assert json.loads(msgspec.json.encode(msgspec.convert(content, structure_of(content)))) == content


@pytest.mark.parametrize("kind", COMMANDS)
def test_what_a_command_writes_keeps_to_its_structure(kind: str, command: Callable[..., int], tmp_path: Path) -> None:
    place, table = tmp_path / "answer.json", tmp_path / "table.csv"
    table.write_text(TABLE, encoding="utf-8")
    command(*(str(table) if word == "TABLE" else word for word in COMMANDS[kind]), "--json", str(place))
    content = json.loads(place.read_text(encoding="utf-8"))
    back = json.loads(msgspec.json.encode(msgspec.convert(content, structure_of(content))))
    assert back == content  # nothing that the structure does not know, nothing lost


@pytest.mark.parametrize("kind", ["flex", "check", "sample", "gap that fits", "parts"])
def test_what_was_assumed_is_in_the_notes_of_every_answer(
    kind: str, command: Callable[..., int], tmp_path: Path
) -> None:
    drawing, place, table = tmp_path / "peg.svg", tmp_path / "answer.json", tmp_path / "table.csv"
    drawing.write_text(PEG, encoding="utf-8")
    table.write_text(TABLE, encoding="utf-8")
    words = [{FRAME: str(drawing), LATCH: str(drawing), "TABLE": str(table)}.get(word, word) for word in COMMANDS[kind]]
    asked = () if kind in ("check", "check of gaps", "plan", "space", "parts") else ("--turn", "peg:ccw")
    command(*words, *asked, "--json", str(place))
    assert "1 user unit is taken as 1 mm" in json.loads(place.read_text(encoding="utf-8"))["notes"][0]


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind == "check of gaps")) for kind in IN_SPACE]
)
def test_what_a_command_writes_in_space_keeps_to_its_structure(
    kind: str, command: Callable[..., int], tmp_path: Path
) -> None:
    place = tmp_path / "answer.json"
    command(*IN_SPACE[kind], "--json", str(place))
    text = place.read_text(encoding="utf-8")
    content = json.loads(text)
    assert list(content)[:2] == ["format", "dimension"]
    assert content["dimension"] == 3
    assert to_json(msgspec.convert(content, structure_of(content), strict=True)) == text  # to the letter


@pytest.mark.parametrize("name", ["flex", "check", "parts"])
def test_a_published_schema_holds_for_both_dimensions(name: str) -> None:
    schema = json.loads(json_schemas()[f"wiggleroom.{name}-1.json"])
    kinds = [kind["$ref"].removeprefix("#/$defs/") for kind in schema["anyOf"]]
    assert kinds == [f"{name.title()}Result", f"Spatial{name.title()}Result"]
    assert all(schema["$defs"][kind]["properties"]["format"]["enum"] == [f"wiggleroom.{name}/1"] for kind in kinds)


def test_examples_keep_to_the_schema_of_assembly_files() -> None:
    for path in sorted((TOP / "examples").glob("*/*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(content, dict) and content.get("format") == "wiggleroom/1":
            msgspec.convert(content, AssemblyFile)


def test_a_new_key_shows_in_the_types_of_the_page() -> None:
    assert "at_most: number | null;" in typescript()
