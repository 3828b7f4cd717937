"""Questions asked of a cutting sheet: its plates are put together first, and nothing is answered where that is not sure."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("manifold3d")

from benchmarks.sheet_drawings import box, egg_crate, stool

Command = Callable[..., int]


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    """A closed box of which only one assembly is possible."""
    path = tmp_path / "sheet.svg"
    path.write_text(box("box", 75, 52, 38, 3, 8).svg(1))
    return path


def test_flex_of_a_sheet_is_flex_of_what_assemble_writes(command: Command, tmp_path: Path, sheet: Path) -> None:
    question = ("--gap", 0.1, "--fix", "bottom", "--pull", "top:+z", "--pull", "top:+x")
    plates, here, there = (tmp_path / name for name in ("plates.json", "here.json", "there.json"))
    assert command("assemble", sheet, "--thickness", 3, "-o", plates) == 0
    assert command("flex", sheet, "--thickness", 3, *question, "--json", here) == 0
    assert command("flex", plates, *question, "--json", there) == 0
    one, other = (json.loads(path.read_text()) for path in (here, there))
    assert one["dimension"] == 3
    assert one["verdict"] == other["verdict"]
    assert one["objective"] == other["objective"]


def test_a_sheet_that_is_not_sure_is_not_answered(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet, answer = tmp_path / "crate.svg", tmp_path / "answer.json"
    sheet.write_text(egg_crate("crate", [30, 75, 110], [25, 60], 40, 3, 150, 90).svg())
    question = ("--gap", 0.1, "--fix", "x0", "--pull", "x1:+x", "--json", answer)
    assert command("flex", sheet, "--thickness", 3, *question) == 3
    said = capsys.readouterr().err.strip().splitlines()
    assert any("more than one way" in line for line in said)
    assert "is not sure" in said[-1]
    assert all(line.startswith(f"{sheet}: ") for line in said)
    assert not answer.exists()


def test_a_panel_without_a_place_is_named(command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import shapely

    design = stool("stool", 60, 50, 3)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet = tmp_path / "stool.svg"
    sheet.write_text(design.svg())
    assert command("check", sheet, "--thickness", 3, "--gap", 0.1, "--fix", "seat") == 3
    assert "not placed: plain" in capsys.readouterr().err


def test_one_panel_of_a_sheet_may_be_thinner(command: Command, tmp_path: Path, sheet: Path) -> None:
    """The lid of a box sticks in the walls' fingers: a thinner one has more room up and down."""
    moved = []
    for more in ((), ("--thickness", "top:2.6")):
        answer = tmp_path / "answer.json"
        question = ("--gap", 0.1, "--fix", "front,back,left,right,bottom", "--pull", "top:-z")
        assert command("flex", sheet, "--thickness", 3, *more, *question, "--json", answer) == 0
        moved.append(json.loads(answer.read_text())["objective"])
    assert moved[0] > 0
    assert moved[1] == pytest.approx(moved[0] + 0.2, abs=1e-4)  # the middle of the thickness stays where it was


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--thickness", "lid:x"), "it must be a length in mm larger than 0, or NAME:2.8"),
        (("--thickness", "top:2.8"), "the thickness of the material is not known"),
        (("--thickness", "3", "--burn", "-1"), "--burn -1: it must be 0 mm or more"),
        (("--burn", "0.1"), "--burn goes with --thickness"),
        (("--thickness", "3", "--flatten", "0.1"), "--flatten is for parts in the plane"),
        (("--thickness", "3", "--thickness", "topp:2.8"), 'there is no panel "topp"; did you mean "top"?'),
    ],
)
def test_bad_options_of_a_sheet_are_one_line(
    command: Command, sheet: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], said: str
) -> None:
    assert command("flex", sheet, *options, "--gap", 0.1, "--fix", "bottom", "--pull", "top:+z") == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert sum(said in line for line in lines) == 1


def test_an_assembly_file_has_its_thickness_already(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"format": "wiggleroom/2", "parts": [{"name": "a", "boxes": [[0, 0, 0, 4, 2, 2]]}]}')
    assert command("flex", path, "--thickness", 3, "--fix", "a") == 2
    assert "leave them out" in capsys.readouterr().err
